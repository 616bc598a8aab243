/* internal: how the engine enters, checks and leaves a context. Inside render/gl only. */
#ifndef ISO_RENDER_GL_INTERNAL_H
#define ISO_RENDER_GL_INTERNAL_H

#include "render/gl/platform.h"
#include "render/gl/state.h"

enum { ISO_GL_TEXT = 256 };

struct iso_gl_context {
    iso_gl_platform platform;
    GladGLContext *gl;  /* owned */
    iso_gl_state found; /* a shared context's state at iso_gl_enter, restored by iso_gl_leave */
    char name[32], vendor[ISO_GL_TEXT], renderer[ISO_GL_TEXT], version[ISO_GL_TEXT];
    size_t message_count;
    char message[ISO_GL_TEXT]; /* the first of them */
    char failure[ISO_GL_TEXT]; /* first error or undefined behaviour that the driver reported since
                                  iso_gl_enter */
    bool lost;                 /* never reset: a driver reports the loss of a context only once */
};

/* Makes the context current and, if it is shared, saves its state. ISO_ERR_BACKEND; always when the
 * context is lost. */
iso_status iso_gl_enter(iso_gl_context *context, iso_error *error);
/* Reports what went wrong since iso_gl_enter: ISO_ERR_NOMEM (GPU memory) or ISO_ERR_BACKEND. Call it
 * between the steps of long work, so that an error stops the work early. */
iso_status iso_gl_check(iso_gl_context *context, iso_error *error);
/* Restores a shared context's state or makes the context not current, then returns `status`; if that is
 * ISO_OK, the result of iso_gl_check. A lost context is reported in any case. */
iso_status iso_gl_leave(iso_gl_context *context, iso_status status, iso_error *error);

#endif
