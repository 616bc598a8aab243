/* isosculpt in a build without GLFW and Dear ImGui. */
#include "apps/isosculpt/isosculpt.h"

iso_status isosculpt_window(const isosculpt_settings *settings, iso_pool *pool, iso_error *error) {
    (void)settings;
    (void)pool;
    return iso_fail(error, ISO_ERR_BACKEND,
                    "built without GLFW and Dear ImGui: use --replay FILE --headless");
}
