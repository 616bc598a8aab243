/* mesh_measure: what a mesh encloses, and whether it is closed. */
#ifndef ISO_EXTRACT_MESH_MEASURE_H
#define ISO_EXTRACT_MESH_MEASURE_H

#include "base/parallel.h"
#include "extract/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_mesh_measures {
    size_t vertices; /* that a triangle uses */
    size_t edges;    /* pairs of vertices that a triangle's side joins */
    size_t triangles;
    size_t parts; /* pieces that share no vertex */
    /* Sides of triangles without their opposite: each edge counts by how many more triangles run along it in
     * one direction than in the other. 0: the mesh is closed. */
    size_t open_edges;
    size_t crowded_edges; /* with more than two triangles: they may be there also when the mesh is closed */
    int64_t euler;        /* Euler characteristic: vertices - edges + triangles; 2 for a ball, 0 for a ring */
    double area;          /* mm2 */
    double volume;        /* mm3, enclosed; NaN when the mesh is open */
} iso_mesh_measures;

/* Of a welded mesh in index coordinates whose triangles are counter-clockwise seen from outside. The same
 * bits for every number of threads. `pool` may be NULL. ISO_ERR_LIMIT above 2^31 - 1 vertices, ISO_ERR_NOMEM.
 */
iso_status iso_weld_measure(const iso_weld *weld, const iso_transform *transform, iso_pool *pool,
                            iso_mesh_measures *measures, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
