/* level_set: hgrids out to .vdb files, and into other frames. */
#ifndef ISO_GRIDS_LEVEL_SET_H
#define ISO_GRIDS_LEVEL_SET_H

#include "grids/hgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a grid as a level set of class "level set" that OpenVDB's tools, Blender and Houdini read: float,
 * world distances, background band * voxel size, the transform as it is (a .vdb keeps its own axes). `name`
 * is the grid's. Through base/file.h: the file appears whole or not at all. The voxels must be cubes
 * (ISO_ERR_USAGE). ISO_ERR_WRITE; ISO_ERR_UNSUPPORTED without OpenVDB's module. */
iso_status iso_level_set_write_vdb(const char *path, const iso_hgrid *grid, const char *name,
                                   iso_error *error);

/* A new grid of `dims` voxels whose voxel i is voxel i - offset of `from`, its transform moved along; beyond
 * `from` its outermost voxels are repeated. As iso_hgrid_create. */
iso_status iso_level_set_reframe(const iso_hgrid *from, const int offset[3], const int dims[3],
                                 iso_hgrid **out, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
