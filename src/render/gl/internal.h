/* internal: a context as the engine uses it. Inside render/gl only. */
#ifndef ISO_RENDER_GL_INTERNAL_H
#define ISO_RENDER_GL_INTERNAL_H

#include "render/gl/platform.h"
#include "render/gl/state.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_GL_TEXT = 256 };

struct iso_gl_context {
    iso_gl_platform platform;
    GladGLContext *gl;  /* owned */
    iso_gl_state found; /* of a context that is shared, as it was on entering */
    char name[32], vendor[ISO_GL_TEXT], renderer[ISO_GL_TEXT], version[ISO_GL_TEXT];
    size_t message_count;
    char message[ISO_GL_TEXT]; /* the first */
    char failure[ISO_GL_TEXT]; /* the first message that means that a picture may be wrong, since enter */
    bool lost;                 /* for good: drivers tell of it once */
};

/* Makes the context current. ISO_ERR_BACKEND, of a lost context always. */
iso_status iso_gl_enter(iso_gl_context *context, iso_error *error);
/* What went wrong since iso_gl_enter: ISO_ERR_NOMEM (of the GPU), ISO_ERR_BACKEND. For work in many steps. */
iso_status iso_gl_check(iso_gl_context *context, iso_error *error);
/* Leaves none current and returns `status`, unless that is ISO_OK and iso_gl_check finds something. */
iso_status iso_gl_leave(iso_gl_context *context, iso_status status, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
