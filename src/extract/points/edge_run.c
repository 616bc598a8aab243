/* edge_run: finds runs of neighbouring blocks in a list of bricks, prefetches what they read, and extracts
 * their points with the edge kernel. Blocks of a run are classified together, so that whole rows of voxels
 * are read in order. */
#include "extract/points/edge_run.h"

#include "base/kernel_units.h"
#include "grids/brick_index.h"

const iso_edge_kernel *iso_edge_kernel_get(iso_type type, iso_cpu_level level) {
    switch (type) {
    case ISO_UINT8:
        return ISO_KERNEL_UNIT(iso_edge_kernel_uint8, level);
    case ISO_INT16:
        return ISO_KERNEL_UNIT(iso_edge_kernel_int16, level);
    case ISO_UINT16:
        return ISO_KERNEL_UNIT(iso_edge_kernel_uint16, level);
    default:
        return ISO_KERNEL_UNIT(iso_edge_kernel_float, level);
    }
}

void iso_edge_source_prepare(iso_edge_source *source) {
    for (int row = 0; row < ISO_EDGE_ROW_NAMES; row++)
        source->row_offset[row] =
            (row & 31) * source->stride_y + (row >> 5 & 31) * source->stride_z + !!(row & ISO_EDGE_FACE);
}

void iso_edge_context_init(iso_edge_context *context, const iso_rgrid *grid, const iso_threshold *surface) {
    *context = (iso_edge_context){
        .grid = grid,
        .kernel = iso_edge_kernel_get(grid->type, iso_cpu_best()),
        .source = {.data = grid->data,
                   .stride_y = grid->stride_y,
                   .stride_z = grid->stride_z,
                   .dims = {grid->dims[0], grid->dims[1], grid->dims[2]},
                   .isovalue_ceil = surface->isovalue_ceil,
                   .residual = surface->residual,
                   .level_set = surface->normal_sign > 0},
    };
    iso_edge_source_prepare(&context->source);
}

/* Whether the kernel can work on float voxels of this range: no NaN or infinity, no overflow of differences.
 */
static bool range_fits_kernel(iso_brick_range range) {
    return range.finite && range.lo > -1e30f && range.hi < 1e30f;
}

/* Whether the kernel can extract a brick. Its edges and their gradients depend on the 27 bricks around it. */
static bool brick_fits_kernel(const iso_brick_set *set, const iso_rgrid *grid, const int brick[3]) {
    if (grid->type != ISO_FLOAT32) return true;
    const iso_brick_index *index = grid->index;
    if (!index || !iso_brick_index_current(index)) return false;
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = brick[axis] > 0 ? brick[axis] - 1 : 0;
        hi[axis] = brick[axis] + 1 < set->bricks[axis] ? brick[axis] + 1 : brick[axis];
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (!range_fits_kernel(
                        iso_brick_index_range(index, iso_brick_index_number(index, (int[3]){x, y, z}))))
                    return false;
    return true;
}

/* ---- finding runs */

/* The row groups of a brick that can have crossed edges; all, if there is no index that is up to date. */
static uint16_t active_groups(const iso_edge_walk *walk, uint32_t brick) {
    const iso_brick_index *index = walk->grid->index;
    if (!index || !iso_brick_index_current(index)) return ISO_EDGE_WHOLE.groups;
    return (uint16_t)iso_brick_index_groups(index, brick, walk->source->isovalue_ceil);
}

/* Finds the longest run that starts at the next brick. found->bricks is 0 if the kernel cannot extract that
 * brick. */
static void find_run(const iso_edge_walk *walk, iso_edge_brick_run *found) {
    *found = (iso_edge_brick_run){.blocks = 0};
    for (size_t i = walk->next; i < walk->count; i++) {
        int brick[3];
        iso_brick_set_coordinates(walk->set, walk->bricks[i], brick);
        const int at[3] = {brick[0] / ISO_EDGE_BRICKS * ISO_EDGE_BLOCK_X, brick[1] * ISO_BRICK,
                           brick[2] * ISO_BRICK};
        if (!found->bricks)
            for (int axis = 0; axis < 3; axis++) found->origin[axis] = at[axis];
        if (at[1] != found->origin[1] || at[2] != found->origin[2]) return;
        const int block = (at[0] - found->origin[0]) / ISO_EDGE_BLOCK_X;
        if (block > found->blocks || block >= ISO_EDGE_RUN_BLOCKS) return;
        if (!brick_fits_kernel(walk->set, walk->grid, brick)) return;
        found->blocks = block + 1;
        found->active[block].bricks |= (uint8_t)(1u << brick[0] % ISO_EDGE_BRICKS);
        found->active[block].groups |= active_groups(walk, walk->bricks[i]);
        found->bricks++;
    }
}

/* For functions that only prefetch: gcc would take them for pure functions and drop the calls. */
#ifdef __clang__
#define PREFETCHER __attribute__((noinline))
#else
#define PREFETCHER __attribute__((noipa))
#endif

/* Prefetches the voxels of a run into the second-level cache. (The first level has fewer buffers for lines
 * that are on their way.) */
PREFETCHER static void prefetch_run(const iso_edge_walk *walk, const iso_edge_brick_run *found) {
    const ptrdiff_t size = (ptrdiff_t)iso_type_size(walk->grid->type);
    const iso_edge_source *source = walk->source;
    const char *origin =
        (const char *)source->data +
        (found->origin[0] + found->origin[1] * source->stride_y + found->origin[2] * source->stride_z) * size;
    int most[3]; /* by axis: voxels of the grid after the run's first one */
    for (int axis = 0; axis < 3; axis++) most[axis] = source->dims[axis] - 1 - found->origin[axis];
    for (int b = 0; b < found->blocks; b++) {
        const iso_edge_active active = found->active[b];
        if (!active.bricks) continue;
        const int from = (b * ISO_EDGE_BRICKS + __builtin_ctz(active.bricks)) * ISO_BRICK,
                  end = (b * ISO_EDGE_BRICKS + 32 - __builtin_clz(active.bricks)) * ISO_BRICK;
        const ptrdiff_t last = (end < most[0] ? end : most[0]) * size;
        for (int z = 0; z < ISO_EDGE_SIDE && z <= most[2]; z++)
            for (uint32_t rows = iso_edge_rows_read(active, z); rows; rows &= rows - 1) {
                const int y = __builtin_ctz(rows);
                if (y > most[1]) break;
                const char *row = origin + (y * source->stride_y + z * source->stride_z) * size;
                for (ptrdiff_t at = from * size; at < last; at += 64) __builtin_prefetch(row + at, 0, 2);
                __builtin_prefetch(row + last, 0, 2);
            }
    }
}

/* Whether a run has few active rows: prefetching pays only for such runs. */
static bool is_sparse(const iso_edge_brick_run *found) {
    int groups = 0;
    for (int b = 0; b < found->blocks; b++) groups += __builtin_popcount(found->active[b].groups);
    return groups <= ISO_ROW_GROUPS / 2 * found->blocks;
}

/* Prefetches the brick index's entries of the bricks that follow the bricks from .. end - 1 of the list. */
static void prefetch_index(const iso_edge_walk *walk, size_t from, size_t end) {
    enum { BRICKS = 8 };
    if (!walk->grid->index) return;
    for (size_t i = from + BRICKS; i < end + BRICKS && i < walk->count; i++)
        iso_brick_index_fetch(walk->grid->index, walk->bricks[i]);
}

const iso_edge_brick_run *iso_edge_walk_next(iso_edge_walk *walk) {
    while (walk->next < walk->count && walk->end - walk->first < ISO_EDGE_AHEAD) {
        iso_edge_brick_run *found = &walk->run[walk->end++ % (ISO_EDGE_AHEAD + 1)];
        find_run(walk, found);
        const size_t next = walk->next + (found->bricks ? found->bricks : 1);
        prefetch_index(walk, walk->next, next);
        if (is_sparse(found)) prefetch_run(walk, found);
        walk->next = next;
    }
    return walk->first < walk->end ? &walk->run[walk->first++ % (ISO_EDGE_AHEAD + 1)] : NULL;
}

/* ---- extracting runs */

/* Limits of blocks and points that are listed before points are computed. Edges of several runs are listed
 * first, because each call for few points is expensive. */
enum { RUN_BLOCKS = 2 * ISO_EDGE_RUN_BLOCKS, RUN_POINTS = 2048 };

typedef struct run_scratch {
    iso_edge_words words;
    iso_edge_block blocks[RUN_BLOCKS];
    iso_edge_task tasks[RUN_BLOCKS];
} run_scratch;

size_t iso_edge_run_scratch_bytes(void) {
    return (sizeof(run_scratch) + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
}

/* The blocks whose edges are listed and whose points are not computed yet. */
typedef struct edge_run {
    const iso_edge_context *context;
    run_scratch *scratch;
    iso_brick_sink *sink;
    const uint32_t *bricks; /* the list of bricks, from the first one of these blocks on */
    int blocks;
    size_t points;
} edge_run;

/* Lists the edges of another run of blocks. */
static void list_run_edges(edge_run *run, const iso_edge_brick_run *found) {
    iso_edge_words *words = &run->scratch->words;
    iso_edge_block *blocks = run->scratch->blocks + run->blocks;
    words->blocks = found->blocks;
    for (int b = 0; b < found->blocks; b++) words->active[b] = found->active[b];
    for (int axis = 0; axis < 3; axis++) blocks[0].origin[axis] = found->origin[axis];
    run->context->kernel->list_edges(&run->context->source, words, blocks);
    for (int b = 0; b < found->blocks; b++)
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) run->points += blocks[b].points[k];
    run->blocks += found->blocks;
}

/* Sets the task of a block, whose points are written from `room` on; returns the end of its points. */
static char *set_task(const iso_edge_context *context, const iso_edge_block *block, char *room,
                      iso_edge_task *task) {
    const size_t item_bytes = context->floats ? sizeof(iso_surfel) : sizeof(iso_point);
    *task = (iso_edge_task){.origin = {block->origin[0], block->origin[1], block->origin[2]}};
    for (int axis = 0; axis < 3; axis++) {
        const iso_edge_list *list = &block->axes[axis];
        task->axes[axis] = (iso_edge_entries){list->mask, list->row, list->count};
    }
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        if (context->floats)
            task->output.surfels[k] = (iso_surfel *)room;
        else
            task->output.packed[k] = (iso_point *)room;
        room += block->points[k] * item_bytes;
    }
    return room;
}

/* Writes the curvatures of a block's points from `curvatures` on; returns the end of what was written. */
static iso_curvature *make_curvatures(const iso_edge_context *context, const iso_edge_block *block,
                                      const iso_edge_output *output, iso_curvature *curvatures) {
    const iso_threshold surface = {.isovalue_ceil = context->source.isovalue_ceil,
                                   .normal_sign = context->source.level_set ? 1 : -1};
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        if (!block->points[k]) continue;
        const int brick[3] = {block->origin[0] / ISO_BRICK + k, block->origin[1] / ISO_BRICK,
                              block->origin[2] / ISO_BRICK};
        const iso_curvature_source source = iso_curvature_source_grid(context->grid, brick, &surface);
        const iso_curvature_points points = {output->packed[k], output->surfels[k], block->points[k]};
        iso_curvatures_of_edges(&source, &points, curvatures);
        curvatures += block->points[k];
    }
    return curvatures;
}

/* Computes the points of the listed blocks and passes their bricks to the sink. */
static void compute_blocks(edge_run *run) {
    const int count = run->blocks;
    const bool with_curvature = run->context->curvature;
    char *room = count ? iso_brick_sink_room(run->sink, 0, run->points) : NULL;
    iso_curvature *curvatures =
        room && with_curvature ? iso_brick_sink_room(run->sink, 1, run->points) : NULL;
    run->blocks = 0;
    run->points = 0;
    if (!room || (with_curvature && !curvatures)) return;
    for (int b = 0; b < count; b++) {
        const iso_edge_block *block = &run->scratch->blocks[b];
        room = set_task(run->context, block, room, &run->scratch->tasks[b]);
        for (int k = 0; k < ISO_EDGE_BRICKS; k++)
            if (block->bricks >> k & 1)
                iso_brick_sink_add(run->sink, *run->bricks++,
                                   &(iso_brick_output){.count = {block->points[k]}});
    }
    run->context->kernel->compute_points(&run->context->source, run->scratch->tasks, count);
    for (int b = 0; b < count && curvatures; b++)
        curvatures = make_curvatures(run->context, &run->scratch->blocks[b], &run->scratch->tasks[b].output,
                                     curvatures);
}

void iso_edge_run(const iso_edge_context *context, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink) {
    edge_run run = {.context = context, .scratch = scratch, .sink = sink, .bricks = bricks};
    iso_edge_walk walk = {
        .grid = context->grid, .source = &context->source, .set = set, .bricks = bricks, .count = count};
    for (const iso_edge_brick_run *found; (found = iso_edge_walk_next(&walk));) {
        if (run.blocks + found->blocks > RUN_BLOCKS || !found->bricks) compute_blocks(&run);
        if (iso_brick_sink_failed(sink)) return;
        if (!found->bricks) {
            iso_brick_sink_extract(sink, *run.bricks++);
            continue;
        }
        list_run_edges(&run, found);
        if (run.points >= RUN_POINTS) compute_blocks(&run);
    }
    compute_blocks(&run);
}
