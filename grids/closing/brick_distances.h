/* brick_distances: the distances of all voxels of a brick from the triangles near it, triangle by triangle.
 * This is many times faster than a search for each voxel: of the voxels that a triangle reaches
 * (grids/closing/triangle_reach.h), those for which it may be the nearest are found with floats, several at a
 * time, and only for them the distance is computed in double precision. */
#ifndef ISO_GRIDS_CLOSING_BRICK_DISTANCES_H
#define ISO_GRIDS_CLOSING_BRICK_DISTANCES_H

#include "grids/closing/triangle_tree.h"
#include "grids/hgrid.h"

/* The voxels of a brick: voxel (x, y, z) lies at origin + voxel * (at + (x, y, z)), mm. */
typedef struct iso_brick_place {
    const double *origin; /* borrowed */
    double voxel;
    int at[3];
} iso_brick_place;

static inline iso_vec3 iso_brick_voxel(const iso_brick_place *brick, int voxel) {
    const int x = voxel % ISO_BRICK, y = voxel / ISO_BRICK % ISO_BRICK, z = voxel / (ISO_BRICK * ISO_BRICK);
    return iso_vec3_make(brick->origin[0] + brick->voxel * (brick->at[0] + x),
                         brick->origin[1] + brick->voxel * (brick->at[1] + y),
                         brick->origin[2] + brick->voxel * (brick->at[2] + z));
}

/* Sets the squared distances (mm2) of the voxels of a brick from the nearest triangle, at most that of `band`
 * voxels: what iso_triangle_tree_nearest finds, but for the last bits, and the same on every machine.
 * `nearest`, if not NULL, is set to these triangles, NULL where none is within the band; they are borrowed
 * from the tree. Thread-safe. */
void iso_brick_distances(const iso_triangle_tree *tree, const iso_brick_place *brick, double band,
                         double squared[ISO_BRICK_VOXELS],
                         const iso_tree_triangle *nearest[ISO_BRICK_VOXELS]);

#endif
