/* triangle_strips: turns the triangles of one brick into triangle strips with restarts (Baerentzen and
 * Christensen 2003, section 5). The gl engine draws them; isocompare reports how many indices they save. */
#ifndef ISO_RENDER_RASTER_TRIANGLE_STRIPS_H
#define ISO_RENDER_RASTER_TRIANGLE_STRIPS_H

#include "base/memory.h"
#include "base/primitives.h"

enum {
    ISO_TRIANGLE_STRIP_ROOM = 4, /* most indices per triangle: a strip of one triangle and its restart */
    ISO_TRIANGLE_STRIP_RESTART = 0xFFFF /* ends a strip: GL_PRIMITIVE_RESTART_FIXED_INDEX of 16 bits */
};

/* Working memory, reused from brick to brick. Zero-initialise; free with iso_triangle_strips_free. */
typedef struct iso_triangle_strips {
    iso_buffer indices, work;
} iso_triangle_strips;

/* Makes strips that contain every triangle of the span once, with its winding, and restarts between them. The
 * result is the first *count items of iso_triangle_strips_indices. ISO_ERR_NOMEM. */
iso_status iso_triangle_strips_make(iso_triangle_strips *strips, const iso_mesh_view *mesh,
                                    const iso_mesh_span *span, size_t *count, iso_error *error);
const uint16_t *iso_triangle_strips_indices(const iso_triangle_strips *strips);
void iso_triangle_strips_free(iso_triangle_strips *strips);

#endif
