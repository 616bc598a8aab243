/* platform: the interface of EGL, OSMesa and window contexts. Inside render/gl only. */
#ifndef ISO_RENDER_GL_PLATFORM_H
#define ISO_RENDER_GL_PLATFORM_H

#include "render/gl/context.h"

/* Any function; cast to its own type before calling. */
typedef void (*iso_gl_function)(void);

typedef struct iso_gl_platform iso_gl_platform;
struct iso_gl_platform {
    void *library; /* of dlopen, never closed */
    void *display, *context, *pixels;
    iso_gl_window window;
    bool shared; /* other code draws with the context too: its OpenGL state must be restored after use */
    iso_gl_function (*address)(const iso_gl_platform *platform, const char *name);
    bool (*enter)(const iso_gl_platform *platform);
    void (*leave)(const iso_gl_platform *platform);
    void (*destroy)(iso_gl_platform *platform);
};

/* Create core profile contexts of at least this version; major 0: any version that the driver has. The
 * context is not current afterwards. ISO_ERR_BACKEND. */
iso_status iso_gl_egl_open(const iso_gl_context_opts *opts, int major, int minor, iso_gl_platform *platform,
                           iso_error *error);
iso_status iso_gl_osmesa_open(const iso_gl_context_opts *opts, int major, int minor,
                              iso_gl_platform *platform, iso_error *error);
/* Wraps the window's own context, whatever its version. */
void iso_gl_window_open(const iso_gl_context_opts *opts, iso_gl_platform *platform);

/* dlopen of `name`, from the folder ISO_GL_LIBRARY_PATH when that is set. ISO_ERR_BACKEND with the loader's
 * message. */
iso_status iso_gl_library_open(const char *name, void **library, iso_error *error);
/* NULL: the library has no such symbol. */
iso_gl_function iso_gl_library_symbol(void *library, const char *name);

#endif
