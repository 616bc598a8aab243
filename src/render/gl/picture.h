/* picture: the buffer ISO_GL_STORE_PICTURE, which has the planes of a gbuffer (shaders/picture.glsl). Inside
 * render/gl only; the context must be current. */
#ifndef ISO_RENDER_GL_PICTURE_H
#define ISO_RENDER_GL_PICTURE_H

#include "render/gl/surface.h"

/* Sets depth to INFINITY and surface to ISO_SURFACE_NONE, the other planes to 0. planes:
 * ISO_GL_PICTURE_PLANES, or one more with colours. */
void iso_gl_picture_clear(const iso_gl_engine *engine, size_t planes, size_t samples);

/* Writes samples of a gbuffer, from sample `start` on, into the picture, to be drawn over. room: working
 * memory. ISO_ERR_NOMEM. */
iso_status iso_gl_picture_write(const iso_gl_engine *engine, size_t planes, const iso_gbuffer *from,
                                size_t start, size_t samples, iso_buffer *room, iso_error *error);

/* Reads the picture back into a gbuffer, from sample `start` on. room: working memory. ISO_ERR_NOMEM. */
iso_status iso_gl_picture_read(const iso_gl_engine *engine, size_t planes, const iso_gbuffer *to,
                               size_t start, size_t samples, iso_buffer *room, iso_error *error);

#endif
