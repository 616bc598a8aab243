/* triangles: prepares a mesh from a file for drawing: gives it normals and cuts it into spans. */
#ifndef ISO_RENDER_RASTER_TRIANGLES_H
#define ISO_RENDER_RASTER_TRIANGLES_H

#include "base/primitives.h"
#include "base/status.h"

/* A mesh with three vertices of its own for each triangle. Zero-initialise; iso_triangle_spans_free. */
typedef struct iso_triangle_spans {
    iso_surfel *vertices; /* owned; world mm */
    uint16_t (*triangles)[3];
    iso_mesh_span *spans;
    size_t span_count;
    uint32_t *numbers; /* the number of each triangle in the file; NULL: none was left out */
} iso_triangle_spans;

/* A corner's normal is the mean, weighted by area, of the normals of the triangles around its position that
 * are bent by less than 60 degrees against the corner's own triangle. Curved surfaces are thus shaded
 * smoothly and edges stay sharp, also where a file repeats the vertices of every triangle, as .stl does.
 * Triangles without an area are left out. Takes 78 bytes for each triangle (82 if some were left out), and 48
 * more during the call. ISO_ERR_LIMIT: 2^32 / 3 triangles or more; ISO_ERR_NOMEM. */
iso_status iso_triangle_spans_make(const iso_triangles *mesh, iso_triangle_spans *spans, iso_error *error);
void iso_triangle_spans_free(iso_triangle_spans *spans);

/* Returns a view of the spans, which it borrows until they are freed. The transform is the identity: index
 * coordinates are mm. */
iso_mesh_view iso_triangle_spans_view(const iso_triangle_spans *spans);

#endif
