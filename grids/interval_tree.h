/* interval_tree: which of many intervals hold a value, in time proportional to the answer (Cignoni, Marino,
 * Montani, Puppo and Scopigno 1997, "Speeding Up Isosurface Extraction Using Interval Trees", after
 * Edelsbrunner 1980).
 *
 * Interval i is lo[i] < value <= hi[i]. The tree is static: it copies the ends and is built anew when they
 * change. Queries are thread-safe. Internal to grids. */
#ifndef ISO_GRIDS_INTERVAL_TREE_H
#define ISO_GRIDS_INTERVAL_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* One end of an interval, and the interval. */
typedef struct iso_interval_end {
    float at;
    uint32_t interval;
} iso_interval_end;

/* The nodes are the distinct upper ends in ascending order, numbered from 1 as a perfect binary tree in
 * symmetric order: the root is the largest power of two, a node's level is its number of trailing zeros. An
 * interval lies at the topmost node whose split it holds, in both lists. */
typedef struct iso_interval_tree {
    uint32_t count;          /* intervals that hold any value */
    uint32_t nodes;          /* distinct upper ends */
    float *splits;           /* [1 .. nodes] */
    uint32_t *starts;        /* [1 .. nodes + 1], where the node's part of the lists begins */
    iso_interval_end *lower; /* a node's intervals by ascending lower end */
    iso_interval_end *upper; /* and by descending upper end */
} iso_interval_tree;

/* Replaces *tree (zero-initialised at first) by one over `total` intervals, those with lo < hi; the ends must
 * not be NaN. Linear time. ISO_ERR_NOMEM leaves it as it was. */
iso_status iso_interval_tree_build(iso_interval_tree *tree, const float *lo, const float *hi, uint32_t total,
                                   iso_error *error);
void iso_interval_tree_free(iso_interval_tree *tree);

/* Part of an answer: every interval in it holds the value. */
typedef struct iso_interval_run {
    const iso_interval_end *ends;
    size_t count;
} iso_interval_run;

enum { ISO_INTERVAL_RUNS = 32 };

/* The intervals that hold `value`, as runs in the tree's lists; returns the number of runs. Each level of the
 * tree gives at most one, and costs one look beyond it. *looks grows by the entries looked at. */
int iso_interval_tree_query(const iso_interval_tree *tree, float value,
                            iso_interval_run runs[ISO_INTERVAL_RUNS], size_t *looks);

size_t iso_interval_tree_bytes(const iso_interval_tree *tree);

#endif
