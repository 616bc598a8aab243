/* edge_run: extracts edge points of a list of an rgrid's bricks with the edge kernel, in runs of neighbouring
 * blocks. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_EDGE_RUN_H
#define ISO_EXTRACT_POINTS_EDGE_RUN_H

#include "extract/brick.h"
#include "extract/points/curvature.h"
#include "extract/points/edge_kernel.h"
#include "grids/brick_set.h"

/* What the extraction of one surface needs: the grid, the kernel and its source. Prepared once per
 * surface. */
typedef struct iso_edge_context {
    const iso_rgrid *grid;
    const iso_edge_kernel *kernel;
    iso_edge_source source;
    bool floats;    /* surfels instead of packed points */
    bool curvature; /* computes a curvature for each point, in the sink's second array */
} iso_edge_context;

/* Prepares a context; sets `floats` and `curvature` to false, which the caller may change. Borrows the
 * grid. */
void iso_edge_context_init(iso_edge_context *context, const iso_rgrid *grid, const iso_threshold *surface);

/* A run of bricks: bricks of a list that lie in neighbouring blocks of one row, with the row groups that can
 * have crossed edges. */
enum { ISO_EDGE_RUN_BLOCKS = 8 };
typedef struct iso_edge_brick_run {
    int origin[3]; /* of the first block, in voxels */
    int blocks;
    iso_edge_active active[ISO_EDGE_RUN_BLOCKS];
    size_t bricks; /* number of bricks; 0: one brick, which the kernel cannot extract */
} iso_edge_brick_run;

/* Divides an ascending list of bricks into runs. Runs are found up to ISO_EDGE_AHEAD runs before they are
 * returned, and their voxels are prefetched meanwhile. The caller sets grid, source, set, bricks and count,
 * all borrowed, and the rest to 0. */
enum { ISO_EDGE_AHEAD = 4 };
typedef struct iso_edge_walk {
    const iso_rgrid *grid;
    const iso_edge_source *source;
    const iso_brick_set *set;
    const uint32_t *bricks;
    size_t count;
    size_t next; /* first brick that is not in a run yet */
    size_t first,
        end; /* runs first .. end - 1 are found but not returned yet; run n is at run[n % its size] */
    iso_edge_brick_run run[ISO_EDGE_AHEAD + 1];
} iso_edge_walk;

/* The next run, valid until the next call; NULL after the last one. */
const iso_edge_brick_run *iso_edge_walk_next(iso_edge_walk *walk);

size_t iso_edge_run_scratch_bytes(void);

/* Extracts `count` bricks of an ascending list. Bricks whose stencils include a NaN or infinite voxel are
 * passed to iso_brick_sink_extract. `scratch` holds iso_edge_run_scratch_bytes() bytes, 8-byte aligned. */
void iso_edge_run(const iso_edge_context *context, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink);

#endif
