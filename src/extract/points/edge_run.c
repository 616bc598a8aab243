/* Neighbouring blocks are classified together, so that whole rows stream from memory; see edge_kernel.h. */
#include "extract/points/edge_run.h"

#include "grids/brick_index.h"

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

/* Whether the kernel's arithmetic holds for float voxels of this range: no NaN or infinity, no overflow of
 * differences. */
static bool fits(iso_brick_range range) {
    return range.finite && range.lo > -1e30f && range.hi < 1e30f;
}

/* Whether the kernel can do a brick: its edges and their gradients read voxels of the 27 bricks around it. */
static bool kernel_can(const iso_brick_set *set, const iso_rgrid *grid, const int brick[3]) {
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
                if (!fits(iso_brick_index_range(index, iso_brick_index_number(index, (int[3]){x, y, z}))))
                    return false;
    return true;
}

/* ---- which stretches */

/* The rows of a brick that can have edges: without an index that is up to date, all. */
static uint16_t groups_of(const iso_edge_walk *walk, uint32_t brick) {
    const iso_brick_index *index = walk->grid->index;
    if (!index || !iso_brick_index_current(index)) return ISO_EDGE_WHOLE.groups;
    return (uint16_t)iso_brick_index_groups(index, brick, walk->source->isovalue_ceil);
}

/* The longest found that starts at the next brick. */
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
        if (!kernel_can(walk->set, walk->grid, brick)) return;
        found->blocks = block + 1;
        found->active[block].bricks |= (uint8_t)(1u << brick[0] % ISO_EDGE_BRICKS);
        found->active[block].groups |= groups_of(walk, walk->bricks[i]);
        found->bricks++;
    }
}

/* A call that gcc cannot see into: fetching has no effect that it knows of, and is dropped with all around
 * it. */
#ifdef __clang__
#define FETCHER __attribute__((noinline))
#else
#define FETCHER __attribute__((noipa))
#endif

/* Fetches into the second cache what a found will read. (Into the first, half as many lines are under way
 * at a time.) */
FETCHER static void prefetch_run(const iso_edge_walk *walk, const iso_edge_brick_run *found) {
    const ptrdiff_t size = (ptrdiff_t)iso_type_size(walk->grid->type);
    const iso_edge_source *source = walk->source;
    const char *origin =
        (const char *)source->data +
        (found->origin[0] + found->origin[1] * source->stride_y + found->origin[2] * source->stride_z) * size;
    int most[3]; /* voxels after the origin */
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

/* Where most rows are read, they are in the cache by the time that this would find out. */
static bool is_sparse(const iso_edge_brick_run *found) {
    int groups = 0;
    for (int b = 0; b < found->blocks; b++) groups += __builtin_popcount(found->active[b].groups);
    return groups <= ISO_ROW_GROUPS / 2 * found->blocks;
}

/* What the index knows of bricks that come later still. */
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

/* ---- what is made of them */

/* Stretches are gathered until there is work enough: small ones cost much each. */
enum { RUN_BLOCKS = 2 * ISO_EDGE_RUN_BLOCKS, RUN_POINTS = 2048 };

typedef struct run_scratch {
    iso_edge_words words;
    iso_edge_block blocks[RUN_BLOCKS];
    iso_edge_task jobs[RUN_BLOCKS];
} run_scratch;

size_t iso_edge_run_scratch_bytes(void) {
    return (sizeof(run_scratch) + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
}

/* A run under way: blocks that are counted. */
typedef struct edge_run {
    const iso_edge_context *context;
    run_scratch *scratch;
    iso_brick_sink *sink;
    const uint32_t *bricks; /* the first one of those blocks */
    int blocks;
    size_t points;
} edge_run;

static void count_run(edge_run *run, const iso_edge_brick_run *found) {
    iso_edge_words *words = &run->scratch->words;
    iso_edge_block *blocks = run->scratch->blocks + run->blocks;
    words->blocks = found->blocks;
    for (int b = 0; b < found->blocks; b++) words->active[b] = found->active[b];
    for (int axis = 0; axis < 3; axis++) blocks[0].origin[axis] = found->origin[axis];
    run->context->kernel->count(&run->context->source, words, blocks);
    for (int b = 0; b < found->blocks; b++)
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) run->points += blocks[b].points[k];
    run->blocks += found->blocks;
}

/* Where the points of a block go, from `room` on; returns where those of the next do. */
static char *make_task(const iso_edge_context *context, const iso_edge_block *block, char *room,
                       iso_edge_task *job) {
    const size_t item_bytes = context->floats ? sizeof(iso_surfel) : sizeof(iso_point);
    *job = (iso_edge_task){.origin = {block->origin[0], block->origin[1], block->origin[2]}};
    for (int axis = 0; axis < 3; axis++) {
        const iso_edge_list *list = &block->axes[axis];
        job->axes[axis] = (iso_edge_entries){list->mask, list->row, list->count};
    }
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        if (context->floats)
            job->output.surfels[k] = (iso_surfel *)room;
        else
            job->output.packed[k] = (iso_point *)room;
        room += block->points[k] * item_bytes;
    }
    return room;
}

/* Shapes of a block's points; returns where the next block's go. */
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

/* Makes the points of the blocks that are counted. */
static void fill_blocks(edge_run *run) {
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
        room = make_task(run->context, block, room, &run->scratch->jobs[b]);
        for (int k = 0; k < ISO_EDGE_BRICKS; k++)
            if (block->bricks >> k & 1)
                iso_brick_sink_add(run->sink, *run->bricks++,
                                   &(iso_brick_output){.count = {block->points[k]}});
    }
    run->context->kernel->fill(&run->context->source, run->scratch->jobs, count);
    for (int b = 0; b < count && curvatures; b++)
        curvatures = make_curvatures(run->context, &run->scratch->blocks[b], &run->scratch->jobs[b].output,
                                     curvatures);
}

void iso_edge_run(const iso_edge_context *context, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink) {
    edge_run run = {.context = context, .scratch = scratch, .sink = sink, .bricks = bricks};
    iso_edge_walk walk = {
        .grid = context->grid, .source = &context->source, .set = set, .bricks = bricks, .count = count};
    for (const iso_edge_brick_run *found; (found = iso_edge_walk_next(&walk));) {
        if (run.blocks + found->blocks > RUN_BLOCKS || !found->bricks) fill_blocks(&run);
        if (iso_brick_sink_failed(sink)) return;
        if (!found->bricks) {
            iso_brick_sink_extract(sink, *run.bricks++);
            continue;
        }
        count_run(&run, found);
        if (run.points >= RUN_POINTS) fill_blocks(&run);
    }
    fill_blocks(&run);
}
