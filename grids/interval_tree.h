/* interval_tree: finds the intervals that contain a value, in time proportional to their number (Cignoni,
 * Marino, Montani, Puppo and Scopigno 1997, "Speeding Up Isosurface Extraction Using Interval Trees", after
 * Edelsbrunner 1980).
 *
 * Interval i contains the values with lo[i] < value <= hi[i]. The tree is static: it copies the ends of the
 * intervals and must be rebuilt when they change. Queries are thread-safe. Internal to grids. */
#ifndef ISO_GRIDS_INTERVAL_TREE_H
#define ISO_GRIDS_INTERVAL_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* One end of an interval, and the number of the interval. */
typedef struct iso_interval_end {
    float at;
    uint32_t interval;
} iso_interval_end;

/* The nodes of the tree are the distinct upper ends of the intervals in ascending order (splits). They are
 * numbered from 1 as a perfect binary tree in symmetric order: the root is the largest power of two, and the
 * level of a node is the number of trailing zeros of its number. An interval is stored at the topmost node
 * whose split it contains, in both lists. */
typedef struct iso_interval_tree {
    uint32_t count;          /* intervals that are not empty */
    uint32_t nodes;          /* number of nodes: of distinct upper ends of intervals */
    float *splits;           /* [1 .. nodes]: the upper end that each node stands for */
    uint32_t *starts;        /* [1 .. nodes + 1]: where the intervals of each node begin in both lists */
    iso_interval_end *lower; /* the intervals of each node by ascending lower end */
    iso_interval_end *upper; /* the intervals of each node by descending upper end */
} iso_interval_tree;

/* Replaces *tree (zero-initialised at first) by a tree over those of `total` intervals with lo < hi; the ends
 * must not be NaN. Linear time. ISO_ERR_NOMEM: *tree is as before. */
iso_status iso_interval_tree_build(iso_interval_tree *tree, const float *lo, const float *hi, uint32_t total,
                                   iso_error *error);
void iso_interval_tree_free(iso_interval_tree *tree);

/* A part of the result: a range of one of the tree's lists whose intervals all contain the value. */
typedef struct iso_interval_run {
    const iso_interval_end *ends;
    size_t count;
} iso_interval_run;

enum { ISO_INTERVAL_RUNS = 32 };

/* Finds the intervals that contain `value` and returns the number of runs: at most one for each level of the
 * tree. Adds the number of list entries that were read to *looks. */
int iso_interval_tree_query(const iso_interval_tree *tree, float value,
                            iso_interval_run runs[ISO_INTERVAL_RUNS], size_t *looks);

size_t iso_interval_tree_bytes(const iso_interval_tree *tree);

#endif
