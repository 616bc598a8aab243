/* strips: turns the triangles of one brick into triangle strips with restarts. Inside render/gl only. */
#ifndef ISO_RENDER_GL_STRIPS_H
#define ISO_RENDER_GL_STRIPS_H

#include "base/memory.h"
#include "base/primitives.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    ISO_GL_STRIP_ROOM = 4,  /* most indices per triangle: a strip of one triangle and its restart */
    ISO_GL_RESTART = 0xFFFF /* GL_PRIMITIVE_RESTART_FIXED_INDEX of 16 bits */
};

/* Working memory, reused from brick to brick. Zero-initialise; free with iso_gl_strips_free. */
typedef struct iso_gl_strips {
    iso_buffer indices, work;
} iso_gl_strips;

/* Makes strips that contain every triangle of the span once, with its winding, and restarts between them. The
 * result is the first *count items of iso_gl_strips_indices. ISO_ERR_NOMEM. */
iso_status iso_gl_strips_make(iso_gl_strips *strips, const iso_mesh_view *mesh, const iso_mesh_span *span,
                              size_t *count, iso_error *error);
const uint16_t *iso_gl_strips_indices(const iso_gl_strips *strips);
void iso_gl_strips_free(iso_gl_strips *strips);

#ifdef __cplusplus
}
#endif
#endif
