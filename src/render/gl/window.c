/* window: the platform of a context that belongs to a window. The window created the context and continues to
 * use it: iso_gl_leave leaves it current, and it is not destroyed here. */
#include "render/gl/platform.h"

static iso_gl_function find_window_function(const iso_gl_platform *platform, const char *name) {
    return platform->window.address(name);
}

static bool enter_window(const iso_gl_platform *platform) {
    platform->window.make_current(platform->window.window);
    return true;
}

static void leave_window(const iso_gl_platform *platform) {
    (void)platform;
}

static void destroy_window(iso_gl_platform *platform) {
    (void)platform;
}

void iso_gl_window_open(const iso_gl_context_opts *opts, iso_gl_platform *platform) {
    *platform = (iso_gl_platform){.window = opts->window,
                                  .shared = true,
                                  .address = find_window_function,
                                  .enter = enter_window,
                                  .leave = leave_window,
                                  .destroy = destroy_window};
}
