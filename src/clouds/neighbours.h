/* neighbours: finds the nearest neighbours of points with a k-d tree (Friedman, Bentley and Finkel 1977, "An
 * algorithm for finding best matches in logarithmic expected time").
 *
 * The tree is balanced: each node divides its points at their median along the longest side of the box
 * around them, until a leaf holds at most ISO_TREE_LEAF points. It stores the points in the order of its
 * leaves; the place of a point in that order is its *slot*. Points with near slots are near each other, so
 * whatever looks at all points one after the other should do so by slots.
 *
 * The tree depends on the points and their order only, not on the number of threads. Internal. Building uses
 * a pool; afterwards any number of threads may search. */
#ifndef ISO_CLOUDS_NEIGHBOURS_H
#define ISO_CLOUDS_NEIGHBOURS_H

#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"

enum { ISO_TREE_LEAF = 12, ISO_NEIGHBOURS_MOST = 32 };

/* A point of the tree. */
typedef struct iso_tree_point {
    float position[3];
    uint32_t index; /* in the array that the tree was made of */
} iso_tree_point;

/* Zero-initialise; free with iso_tree_free. */
typedef struct iso_tree {
    iso_tree_point *points; /* by slot */
    size_t count;
    int depth; /* the tree has 2^depth leaves */
    float
        *splits; /* of inner node i (1 is the root; 2 i and 2 i + 1 are the children of i): the coordinate */
    uint8_t *axes; /* .. and the axis where it divides its points */
} iso_tree;

typedef struct iso_neighbour {
    float square; /* of the distance */
    uint32_t slot;
} iso_neighbour;

/* Makes a tree of positions, which must be finite; they are copied. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^31
 * points or more. */
iso_status iso_tree_make(const float (*positions)[3], size_t count, iso_pool *pool, iso_tree *tree,
                         iso_error *error);
void iso_tree_free(iso_tree *tree);

/* Finds the `most` nearest neighbours of the point in a slot, without the point itself, nearest first. `most`
 * is 1 .. ISO_NEIGHBOURS_MOST. Returns how many there are: fewer if the tree has no more points. Which of
 * several points at the same distance are found is not specified, but the same for every call. */
int iso_tree_nearest(const iso_tree *tree, size_t slot, int most, iso_neighbour *found);
/* The same for any position: finds the `most` nearest points. */
int iso_tree_nearest_to(const iso_tree *tree, const float position[3], int most, iso_neighbour *found);

#endif
