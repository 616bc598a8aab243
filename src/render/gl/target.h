/* target: the framebuffers that surfaces, and lines and glyphs, are drawn into. Internal to gl. */
#ifndef ISO_RENDER_GL_TARGET_H
#define ISO_RENDER_GL_TARGET_H

#include "render/gl/internal.h"

/* A framebuffer with two colour textures, of which the first is ISO_GL_NORMAL_DEPTH (shared.h), and a depth
 * texture. At least as large as the part of the picture that is drawn; replaced when it must grow. */
typedef struct iso_gl_target {
    int width, height;
    unsigned framebuffer, colors[2], depth;
} iso_gl_target;

/* Makes the target at least `width` x `height` pixels large; `format` is that of its second colour texture.
 * The context must be current. ISO_ERR_BACKEND: the driver has no such framebuffer; the target is empty. */
iso_status iso_gl_target_ensure(iso_gl_target *target, const iso_gl_context *context, unsigned format,
                                int width, int height, iso_error *error);

/* Deletes the framebuffer and its textures. The context must be current. */
void iso_gl_target_free(iso_gl_target *target, const GladGLContext *gl);

#endif
