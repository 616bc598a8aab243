/* chunk_walk: visits the chunks of a volume that an isosurface crosses, one after the other, so that the
 * volume need not be in memory (grids/chunk_source.h). The chunks divide the volume's bricks into boxes of
 * the same size.
 *
 * The first visit reads all chunks, to find out which ones the surface crosses; ranges of blocks that are
 * known from an earlier run (grids/block_ranges.h) save this. */
#ifndef ISO_GRIDS_CHUNK_WALK_H
#define ISO_GRIDS_CHUNK_WALK_H

#include "base/progress.h"
#include "grids/block_ranges.h"
#include "grids/chunk_source.h"

typedef struct iso_chunk_walk iso_chunk_walk;

typedef struct iso_chunk_walk_opts {
    const iso_chunk_source *source; /* borrowed until destroy */
    double isovalue;                /* physical */
    int side;                       /* voxels along a chunk's side, rounded up to whole bricks; 0: 128 */
    /* Ranges of the volume's blocks: those that are known save reading, those that become known are entered.
     * Borrowed until destroy; NULL: none are kept. */
    iso_block_ranges *ranges;
    iso_pool *pool;
    iso_progress_fn *progress; /* of each visit; cancels: ISO_ERR_IO. NULL is fine */
    void *progress_context;
} iso_chunk_walk_opts;

/* ISO_ERR_USAGE: the isovalue is not finite; ISO_ERR_NOMEM. */
iso_status iso_chunk_walk_create(const iso_chunk_walk_opts *opts, iso_chunk_walk **walk, iso_error *error);
void iso_chunk_walk_destroy(iso_chunk_walk *walk);

/* Which chunks are visited: part `part` of `parts`, from 1. Chunks lie along a Morton curve that is cut into
 * pieces with about equally many crossed blocks, the same in every process. {1, 1}: all chunks. */
typedef struct iso_chunk_share {
    int part, parts;
} iso_chunk_share;

/* Calls `visit` for each chunk of the share that the surface crosses. `number`: of the chunk, 0 .. chunks -
 * 1; `grid`: its voxels, for the call only. When `visit` fails, its status is returned. When it fails with
 * ISO_ERR_NOMEM, it must have changed nothing: it is called again if the source has memory to give back.
 * ISO_ERR_NOMEM and errors of reading. */
typedef struct iso_chunk_visit {
    size_t number;
    const iso_grid_chunk *chunk; /* with ranges that tell which bricks are crossed */
    iso_rgrid *grid;
} iso_chunk_visit;
typedef iso_status iso_chunk_visitor(void *context, const iso_chunk_visit *visit, iso_error *error);
iso_status iso_chunk_walk_visit(iso_chunk_walk *walk, iso_chunk_share share, iso_chunk_visitor *visit,
                                void *context, iso_error *error);

/* Calls `visit` in the same way for each chunk of the share that is wanted, whether the surface crosses it or
 * not; the chunk then has no ranges. `wants` is given the range of its values if that is known, or NULL. */
typedef bool iso_chunk_chooser(void *context, const iso_grid_chunk *chunk, const iso_brick_range *range);
iso_status iso_chunk_walk_visit_wanted(iso_chunk_walk *walk, iso_chunk_share share, iso_chunk_chooser *wants,
                                       iso_chunk_visitor *visit, void *context, iso_error *error);

/* Reads the ranges of every `parts`th chunk whose blocks are not known, from chunk part - 1 on, so that
 * several processes read a volume together; they then exchange the walk's ranges. Errors of reading. */
iso_status iso_chunk_walk_read_ranges(iso_chunk_walk *walk, iso_chunk_share share, iso_error *error);

/* How the volume is cut into chunks. */
const iso_chunk_cuts *iso_chunk_walk_cuts(const iso_chunk_walk *walk);

/* The options that the walk was created with. */
const iso_chunk_walk_opts *iso_chunk_walk_opts_of(const iso_chunk_walk *walk);

typedef struct iso_chunk_totals {
    uint64_t bytes_read;     /* of voxels, by all visits so far */
    uint64_t bytes_crossed;  /* of the voxels of the chunks that were visited, each once */
    uint64_t bytes_decoded;  /* of the voxels of tiles, each as often as it was decoded; 0: no tiles */
    size_t chunks, crossed;  /* numbers of chunks, and of those that were visited */
    size_t nonfinite_blocks; /* blocks of 64^3 voxels with some that are not finite */
} iso_chunk_totals;
/* Complete after a visit of all chunks. */
iso_chunk_totals iso_chunk_walk_stats(const iso_chunk_walk *walk);

#endif
