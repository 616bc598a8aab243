/* mesh_buried: corrects the distances in a solid whose mesh has surfaces inside it, as overlapping parts
 * have. */
#ifndef ISO_GRIDS_CLOSING_MESH_BURIED_H
#define ISO_GRIDS_CLOSING_MESH_BURIED_H

#include "base/parallel.h"
#include "grids/closing/closed_mesh.h"
#include "grids/hgrid.h"

/* `grid` has distances to the mesh's triangles, with the right signs. The distances of inside voxels whose
 * nearest triangle lies inside the solid are replaced by distances to the solid's surface, with an error of
 * about 0.05 voxel. ISO_ERR_NOMEM: only some bricks are corrected. */
iso_status iso_mesh_remove_buried(iso_hgrid *grid, const iso_closed_mesh *mesh, iso_pool *pool,
                                  iso_error *error);

#endif
