/* edge_run: lists of bricks of an rgrid through the edge kernel, in runs of neighbouring blocks. Internal to
 * extract. */
#ifndef ISO_EXTRACT_EDGE_RUN_H
#define ISO_EXTRACT_EDGE_RUN_H

#include "extract/brick.h"
#include "extract/edge_kernel.h"
#include "extract/shape.h"
#include "grids/brick_set.h"

/* What runs need to know; made once per surface. */
typedef struct iso_edge_runner {
    const iso_rgrid *grid;
    const iso_edge_kernel *kernel;
    iso_edge_source source;
    bool floats; /* surfels instead of packed points */
    bool shapes; /* with each point, in the sink's second array */
} iso_edge_runner;

/* With `floats` and `shapes` off. */
void iso_edge_runner_init(iso_edge_runner *runner, const iso_rgrid *grid, const iso_surface *surface);

/* Bricks of a list that lie in neighbouring blocks of one row; bit k of `asked`: brick k of the block. */
enum { ISO_EDGE_STRETCH = 8 };
typedef struct iso_edge_stretch {
    int first_block, row[2]; /* in blocks along x; brick y and z */
    int blocks;
    unsigned asked[ISO_EDGE_STRETCH];
    size_t bricks;
} iso_edge_stretch;

/* The longest stretch that starts at the first brick; 0 bricks when the kernel cannot do that one. */
iso_edge_stretch iso_edge_stretch_find(const iso_rgrid *grid, const iso_brick_set *set,
                                       const uint32_t *bricks, size_t count);

size_t iso_edge_run_scratch_bytes(void);

/* Does `count` ascending bricks; those whose stencils see a NaN or infinite voxel go to
 * iso_brick_sink_extract. `scratch` holds iso_edge_run_scratch_bytes() bytes, 8-byte aligned. */
void iso_edge_run(const iso_edge_runner *runner, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink);

#endif
