/* level_set: hgrids out to .vdb files, from meshes and other grids, and into other frames. */
#ifndef ISO_GRIDS_LEVEL_SET_H
#define ISO_GRIDS_LEVEL_SET_H

#include "base/parallel.h"
#include "base/progress.h"
#include "grids/closing/closed_mesh.h"
#include "grids/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a grid as a level set of class "level set" that OpenVDB's tools, Blender and Houdini read: float,
 * world distances, background band * voxel size, the transform as it is (a .vdb keeps its own axes). `name`
 * is the grid's. Through base/file.h: the file appears whole or not at all. The voxels must be cubes
 * (ISO_ERR_USAGE). ISO_ERR_WRITE; ISO_ERR_UNSUPPORTED without OpenVDB's module. Cancelled: ISO_ERR_IO, and
 * no file. */
iso_status iso_level_set_write_vdb(const char *path, const iso_hgrid *grid, const char *name,
                                   const iso_progress *progress, iso_error *error);

/* The grid that a mesh is put into: whole bricks of cubic voxels along the world's axes, the mesh's box in
 * the middle with at least `margin` voxels around it. */
typedef struct iso_mesh_sampling {
    double voxel; /* mm */
    int margin;
    iso_pool *pool;               /* borrowed; NULL: the calling thread */
    const iso_progress *progress; /* told from any thread; cancelled: ISO_ERR_IO */
} iso_mesh_sampling;

/* The level set, with a band of 3 voxels, of the solid that a mesh encloses (grids/closing/closed_mesh.h).
 * The same for every number of threads. The time is that of a search in the mesh's tree for each voxel of the
 * band, O(log n) each for n triangles. `path` is for messages.
 *
 * The voxels' volume is compared with the mesh's. ISO_ERR_EMPTY: less than half of it would be left, as the
 * voxels are too large for parts that thin. ISO_ERR_FORMAT: they differ by more than voxels explain.
 * ISO_ERR_LIMIT when the grid would be too large, ISO_ERR_NOMEM. */
iso_status iso_level_set_from_mesh(const char *path, const iso_closed_mesh *mesh,
                                   const iso_mesh_sampling *frame, iso_hgrid **grid, iso_error *error);

/* How a grid becomes a level set. */
typedef struct iso_resampling {
    double isovalue;              /* stored: of an hgrid, voxels */
    double voxel;                 /* mm; 0: the grid's smallest spacing */
    int margin;                   /* voxels around it */
    iso_pool *pool;               /* borrowed; NULL: the calling thread */
    const iso_progress *progress; /* told from any thread; cancelled: ISO_ERR_IO */
} iso_resampling;

/* A field with the sides of any grid at any voxel size: cubic voxels along the grid's own axes, whole bricks,
 * a band of 3. Inside is at or above the isovalue, below it for a level set, never beyond the grid and never
 * where a value is not finite. Voxels hold the value less the isovalue, scaled (all by the same factor) and
 * clamped below the band: it is no distance field before it is redistanced.
 * ISO_ERR_EMPTY when nothing is inside or nothing outside. */
iso_status iso_level_set_from_grid(const char *path, const iso_grid *from, const iso_resampling *how,
                                   iso_hgrid **grid, iso_error *error);

/* A new grid of `dims` voxels whose voxel i is voxel i - offset of `from`, its transform moved along; beyond
 * `from` its outermost voxels are repeated. As iso_hgrid_create. */
iso_status iso_level_set_resize(const iso_hgrid *from, const int offset[3], const int dims[3],
                                iso_hgrid **out, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
