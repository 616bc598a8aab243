/* mesh_measure: area, enclosed volume, connected pieces and Euler characteristic of a mesh, and whether it is
 * closed. */
#ifndef ISO_EXTRACT_MESH_MESH_MEASURE_H
#define ISO_EXTRACT_MESH_MESH_MEASURE_H

#include "base/parallel.h"
#include "extract/mesh/mesh.h"
#include "isopoint.h"

/* Measures a welded mesh in index coordinates, whose triangles are counter-clockwise seen from outside; the
 * results are in mm. The same bits for every number of threads. `pool` may be NULL. ISO_ERR_LIMIT above 2^31
 * - 1 vertices, ISO_ERR_NOMEM. */
iso_status iso_weld_measure(const iso_weld *weld, const iso_transform *transform, iso_pool *pool,
                            iso_mesh_measures *measures, iso_error *error);

#endif
