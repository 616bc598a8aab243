/* context: OpenGL contexts without a window, found at run time, and the contexts of windows.
 *
 * Nothing of GL, EGL or OSMesa is linked: libEGL.so.1 and libOSMesa.so.8 are loaded when a context is asked
 * for, from the folder that ISO_GL_LIBRARY_PATH names if it is set. Several contexts of all kinds can live in
 * one process. They stay loaded until the process ends: EGL does not count the users of a display, and
 * drivers do not stand being unloaded.
 *
 * A context is used by one thread at a time. Functions that use one make it current while they run and leave
 * none current: a caller with a context of its own makes that current again. Only a window's stays current,
 * and its state is as it was, but that what shaders read by numbered slots (uniform and storage buffers,
 * textures and images) is unbound: others draw there too. */
#ifndef ISO_RENDER_GL_CONTEXT_H
#define ISO_RENDER_GL_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_gl_kind {
    ISO_GL_EGL_DEVICE,      /* EGL_EXT_platform_device: a GPU by its number, with or without a display */
    ISO_GL_EGL_SURFACELESS, /* EGL_MESA_platform_surfaceless: what Mesa thinks best */
    ISO_GL_OSMESA,          /* Mesa's software renderer without EGL (until Mesa 25.1) */
    ISO_GL_WINDOW           /* a window's, which is there already */
} iso_gl_kind;
enum { ISO_GL_KINDS = 3 }; /* that need no window */

/* A window with an OpenGL context, opened by other means (GLFW): it is kept, and must outlive our context. */
typedef struct iso_gl_window {
    void *window;
    void (*make_current)(void *window);
    void (*(*address)(const char *name))(void); /* NULL: there is no such function */
} iso_gl_window;

typedef struct iso_gl_context iso_gl_context;

typedef struct iso_gl_context_opts {
    iso_gl_kind kind;
    int device;           /* ISO_GL_EGL_DEVICE: 0 .. the number of devices - 1 */
    bool debug;           /* asks the driver to say more; slower. A window's has been asked or not */
    iso_gl_window window; /* ISO_GL_WINDOW */
} iso_gl_context_opts;

/* Core profile 4.5 or later, or ISO_ERR_BACKEND with the driver's words. iso_gl_context_destroy when done. */
iso_status iso_gl_context_create(const iso_gl_context_opts *opts, iso_gl_context **context, iso_error *error);
/* Engines on it must be gone. NULL is fine. */
void iso_gl_context_destroy(iso_gl_context *context);

/* The best that EGL has: the first device that is a GPU; without one, unless `hardware_only`, Mesa's software
 * renderer. ISO_ERR_BACKEND says why there is none. */
iso_status iso_gl_context_open_egl(bool hardware_only, iso_gl_context **context, iso_error *error);

/* An EGL device as EGL tells of it before it is used. */
typedef struct iso_gl_device {
    bool software;
} iso_gl_device;

/* At most `capacity` devices; *count is how many there are. ISO_ERR_BACKEND without EGL or its devices. */
iso_status iso_gl_devices(iso_gl_device *devices, int capacity, int *count, iso_error *error);

/* Texts are the context's. */
typedef struct iso_gl_info {
    const char *name; /* "egl device 0", "egl surfaceless", "osmesa", "window" */
    const char *vendor, *renderer, *version;
    bool hardware; /* the renderer is none of the software renderers that are known */
} iso_gl_info;
iso_gl_info iso_gl_context_info(const iso_gl_context *context);

/* What the driver's debug output said so far, above notifications; `first` is "" when there was nothing. */
typedef struct iso_gl_messages {
    size_t count;
    const char *first;
} iso_gl_messages;
iso_gl_messages iso_gl_context_messages(const iso_gl_context *context);

/* Whether `renderer` is a software renderer: llvmpipe, softpipe, swrast, SwiftShader, Windows' GDI. */
bool iso_gl_renderer_is_software(const char *renderer);

#ifdef __cplusplus
}
#endif
#endif
