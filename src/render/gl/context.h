/* context: OpenGL contexts without a window, found at run time, and contexts of windows.
 *
 * Nothing of GL, EGL or OSMesa is linked: libEGL.so.1 and libOSMesa.so.8 are loaded when a context is
 * created, from the folder ISO_GL_LIBRARY_PATH if that is set. Several contexts of all kinds can exist in
 * one process. The libraries stay loaded until the process ends: EGL does not count the users of a
 * display, and drivers do not survive being unloaded.
 *
 * A context is used by one thread at a time. Functions that use a context make it current while they run
 * and leave no context current; a caller with its own context makes that current again. A window's context
 * stays current and its state is restored, except that the numbered slots used by shaders (uniform and
 * storage buffers, textures, images) are unbound. */
#ifndef ISO_RENDER_GL_CONTEXT_H
#define ISO_RENDER_GL_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

typedef enum iso_gl_kind {
    ISO_GL_EGL_DEVICE,      /* EGL_EXT_platform_device: a GPU by its number, with or without a display */
    ISO_GL_EGL_SURFACELESS, /* EGL_MESA_platform_surfaceless: the device that Mesa chooses */
    ISO_GL_OSMESA,          /* Mesa's software renderer without EGL (until Mesa 25.1) */
    ISO_GL_WINDOW           /* the existing context of a window */
} iso_gl_kind;
enum { ISO_GL_KINDS = 3 }; /* that need no window */

/* A window with an OpenGL context that the caller opened (with GLFW). Borrowed: it must outlive our
 * context. */
typedef struct iso_gl_window {
    void *window;
    void (*make_current)(void *window);
    void (*(*address)(const char *name))(void); /* address of an OpenGL function; NULL: none of this name */
} iso_gl_window;

typedef struct iso_gl_context iso_gl_context;

typedef struct iso_gl_context_opts {
    iso_gl_kind kind;
    int device;           /* ISO_GL_EGL_DEVICE: 0 .. the number of devices - 1 */
    bool debug;           /* asks the driver for debug output; slower. Ignored for windows */
    iso_gl_window window; /* ISO_GL_WINDOW */
} iso_gl_context_opts;

/* A core profile 4.5 or later; destroy with iso_gl_context_destroy. ISO_ERR_BACKEND with the driver's
 * message. */
iso_status iso_gl_context_create(const iso_gl_context_opts *opts, iso_gl_context **context, iso_error *error);
/* Engines that use the context must have been destroyed. NULL is fine. */
void iso_gl_context_destroy(iso_gl_context *context);

/* The best context that EGL offers: on the first device that is a GPU, else (unless `hardware_only`) on
 * Mesa's software renderer. ISO_ERR_BACKEND says why there is none. */
iso_status iso_gl_context_open_egl(bool hardware_only, iso_gl_context **context, iso_error *error);

/* What EGL says of a device before it is used. */
typedef struct iso_gl_device {
    bool software;
} iso_gl_device;

/* Lists EGL's devices, at most `capacity`; *count is how many there are. ISO_ERR_BACKEND without EGL or its
 * device extensions. */
iso_status iso_gl_devices(iso_gl_device *devices, int capacity, int *count, iso_error *error);

/* The texts belong to the context. */
typedef struct iso_gl_info {
    const char *name; /* "egl device 0", "egl surfaceless", "osmesa", "window" */
    const char *vendor, *renderer, *version;
    bool hardware; /* not one of the software renderers that iso_gl_renderer_is_software knows */
} iso_gl_info;
iso_gl_info iso_gl_context_info(const iso_gl_context *context);

/* Messages of the driver's debug output so far, without notifications; `first` is "" when there are none. */
typedef struct iso_gl_messages {
    size_t count;
    const char *first;
} iso_gl_messages;
iso_gl_messages iso_gl_context_messages(const iso_gl_context *context);

/* Whether `renderer` is a software renderer: llvmpipe, softpipe, swrast, SwiftShader, Windows' GDI. */
bool iso_gl_renderer_is_software(const char *renderer);

#endif
