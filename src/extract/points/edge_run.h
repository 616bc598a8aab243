/* edge_run: lists of bricks of an rgrid through the edge kernel, in runs of neighbouring blocks. Internal to
 * extract. */
#ifndef ISO_EXTRACT_POINTS_EDGE_RUN_H
#define ISO_EXTRACT_POINTS_EDGE_RUN_H

#include "extract/brick.h"
#include "extract/points/curvature.h"
#include "extract/points/edge_kernel.h"
#include "grids/brick_set.h"

/* What runs need to know; made once per surface. */
typedef struct iso_edge_context {
    const iso_rgrid *grid;
    const iso_edge_kernel *kernel;
    iso_edge_source source;
    bool floats;    /* surfels instead of packed points */
    bool curvature; /* with each point, in the sink's second array */
} iso_edge_context;

/* Sets `floats` and `curvature` to false. */
void iso_edge_context_init(iso_edge_context *context, const iso_rgrid *grid, const iso_threshold *surface);

/* Bricks of a list that lie in neighbouring blocks of one row, and which of their rows are looked at. */
enum { ISO_EDGE_RUN_BLOCKS = 8 };
typedef struct iso_edge_brick_run {
    int origin[3]; /* of the first block, in voxels */
    int blocks;
    iso_edge_active active[ISO_EDGE_RUN_BLOCKS];
    size_t bricks; /* 0: one that the kernel cannot do */
} iso_edge_brick_run;

/* A list of bricks, ascending, as stretches: they are found some time before their turn, so that what they
 * read is in the cache by then. Everything is borrowed. */
enum { ISO_EDGE_AHEAD = 4 };
typedef struct iso_edge_walk {
    const iso_rgrid *grid;
    const iso_edge_source *source;
    const iso_brick_set *set;
    const uint32_t *bricks;
    size_t count;
    size_t next;       /* first brick that is not in a run yet; 0 at first, like the two below */
    size_t first, end; /* stretches that are found, in a ring */
    iso_edge_brick_run run[ISO_EDGE_AHEAD + 1];
} iso_edge_walk;

/* The next run, valid until the next call; NULL after the last one. */
const iso_edge_brick_run *iso_edge_walk_next(iso_edge_walk *walk);

size_t iso_edge_run_scratch_bytes(void);

/* Does `count` ascending bricks; those whose stencils see a NaN or infinite voxel go to
 * iso_brick_sink_extract. `scratch` holds iso_edge_run_scratch_bytes() bytes, 8-byte aligned. */
void iso_edge_run(const iso_edge_context *context, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink);

#endif
