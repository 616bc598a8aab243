/* mesh_buried: distances in a solid whose mesh has surfaces inside of it, as where parts overlap. */
#ifndef ISO_GRIDS_CLOSING_MESH_BURIED_H
#define ISO_GRIDS_CLOSING_MESH_BURIED_H

#include "base/parallel.h"
#include "grids/closing/closed_mesh.h"
#include "grids/hgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* `grid` has the distances to the mesh's triangles, and the right signs. Those of inside voxels whose nearest
 * triangle is inside the solid become distances to the solid's surface, to about 0.05 voxel. Does nothing
 * where there is no such surface. ISO_ERR_NOMEM: some bricks are done. */
iso_status iso_mesh_remove_buried(iso_hgrid *grid, const iso_closed_mesh *mesh, iso_pool *pool,
                                  iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
