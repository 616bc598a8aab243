/* gl/refined: the refined reconstruction (render/refined/refined.h) by OpenGL. Inside render/gl only. */
#ifndef ISO_RENDER_GL_REFINED_H
#define ISO_RENDER_GL_REFINED_H

#include "render/gl/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws points, whose blocks have been looked at, over what is in the buffer ISO_GL_STORE_PICTURE, which has
 * the view's size; with the context current. `room` is memory to work with. ISO_ERR_NOMEM, ISO_ERR_BACKEND.
 */
iso_status iso_gl_draw_refined(const iso_gl_surface *shape, const iso_view *view, int surface,
                               iso_buffer *room, iso_error *error);

/* Bytes that it takes from the GPU for pictures of so many samples. */
uint64_t iso_gl_discs_bytes(uint64_t samples);
void iso_gl_discs_free(iso_gl_discs *discs, const GladGLContext *gl);

#ifdef __cplusplus
}
#endif
#endif
