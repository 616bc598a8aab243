/* scene_tree: a procedural tree, as lines and as triangles of the same shape, for comparisons of the two
 * (Marroquim, Kraus and Cavalcanti 2008, figures 13 and 19, whose model is not free).
 *
 * Source: Weber and Penn 1995, "Creation and rendering of realistic trees" (SIGGRAPH), simplified: stems of
 * four levels that curve, taper and carry the stems of the next level at the golden angle; no splitting, no
 * pruning. The same tree on every machine. */
#ifndef ISO_TESTS_SCENE_TREE_H
#define ISO_TESTS_SCENE_TREE_H

#include "base/lines.h"
#include "base/primitives.h"

/* A stem is a line of tubes, with rings of three vertices around each of its vertices as triangles. A leaf
 * is a ribbon of four vertices, or four triangles. World mm, z up, about 1000 mm high, standing on the
 * origin. All owned; zero-initialise, iso_scene_tree_free. */
typedef struct iso_scene_tree {
    iso_lines wood, leaves; /* with radii; leaves with normals */
    iso_triangles wood_mesh, leaf_mesh;
} iso_scene_tree;

typedef struct iso_scene_tree_opts {
    double size;   /* part of the branches on each of three levels that are grown, 0 .. 1; 0: all of them,
                      some 57,000 segments of wood and 50,000 leaves */
    uint64_t seed; /* another one gives another tree */
} iso_scene_tree_opts;

/* `opts` NULL: defaults. ISO_ERR_NOMEM; `tree` is empty then. */
iso_status iso_scene_tree_make(const iso_scene_tree_opts *opts, iso_scene_tree *tree, iso_error *error);
void iso_scene_tree_free(iso_scene_tree *tree);

#endif
