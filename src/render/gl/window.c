/* Contexts of windows: somebody else's, found in use and left in use. */
#include "render/gl/platform.h"

static iso_gl_function address(const iso_gl_platform *platform, const char *name) {
    return platform->window.address(name);
}

static bool enter(const iso_gl_platform *platform) {
    platform->window.make_current(platform->window.window);
    return true;
}

/* It stays current, and stays there. */
static void leave(const iso_gl_platform *platform) {
    (void)platform;
}

static void destroy(iso_gl_platform *platform) {
    (void)platform;
}

void iso_gl_window_open(const iso_gl_context_opts *opts, iso_gl_platform *platform) {
    *platform = (iso_gl_platform){.window = opts->window,
                                  .shared = true,
                                  .address = address,
                                  .enter = enter,
                                  .leave = leave,
                                  .destroy = destroy};
}
