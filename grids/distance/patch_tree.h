/* patch_tree: a bounding volume hierarchy over the patches of the isosurface of a grid: the pieces of the
 * trilinear surface that lie in one cell each. Internal to grids/distance. */
#ifndef ISO_GRIDS_DISTANCE_PATCH_TREE_H
#define ISO_GRIDS_DISTANCE_PATCH_TREE_H

#include <stdint.h>

#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/distance/cell_patch.h"
#include "grids/grid.h"

/* A triangle of the mesh, and by how much, mm, the surface may be nearer than it. */
typedef struct iso_patch_triangle {
    float corners[3][3], slack;
} iso_patch_triangle;

/* A connected piece of the surface in a cell. Positions are in mm, relative to the grid's origin, which keeps
 * floats small. */
typedef struct iso_patch {
    float corners[8];   /* the grid's values, as those of iso_cell_patch_make */
    float lo[3], hi[3]; /* the surface's box */
    int cell[3];
    uint32_t first, count; /* its triangles */
} iso_patch;

typedef struct iso_patch_node {
    float lo[3], hi[3];
} iso_patch_node;

/* A complete binary tree: the children of node i are 2 i + 1 and 2 i + 2, and the patches, in the order of a
 * Morton curve, are divided evenly among the leaves. Immutable. */
typedef struct iso_patch_tree {
    iso_affine affine;
    iso_cell_metric metric;
    double isovalue; /* stored */
    iso_patch_triangle *triangles;
    iso_patch *patches;
    iso_patch_node *nodes;
    size_t count, leaves; /* of patches; 2^depth */
    int depth;
} iso_patch_tree;
enum { ISO_PATCH_TREE_DEEPEST = 32 };

/* mesh: the Marching Cubes mesh of the grid's isosurface, in index coordinates; isovalue: stored. *tree is
 * zeroed, and freed by the caller whatever happens. ISO_ERR_EMPTY: no cell has a surface; ISO_ERR_NOMEM. */
iso_status iso_patch_tree_create(const iso_grid *grid, double isovalue, const iso_triangles *mesh,
                                 iso_pool *pool, iso_patch_tree *tree, iso_error *error);
void iso_patch_tree_free(iso_patch_tree *tree);

/* The number of a leaf's first patch. */
static inline size_t iso_patch_tree_leaf(const iso_patch_tree *tree, size_t leaf) {
    return tree->count * leaf >> tree->depth; /* the product is below 2^64 */
}

/* A patch as one of its cell. */
iso_cell_patch iso_patch_field(const iso_patch_tree *tree, const iso_patch *patch);
/* A position relative to the grid's origin, mm, as one in a patch's cell. */
void iso_patch_to_cell(const iso_patch_tree *tree, const iso_patch *patch, iso_vec3 place, double at[3]);

#endif
