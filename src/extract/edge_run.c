/* Neighbouring blocks are classified together, so that whole rows stream from memory; see edge_kernel.h. */
#include "extract/edge_run.h"

#include "grids/brick_index.h"

/* Stretches are gathered until there is work enough: small ones cost much each. */
enum { RUN_BLOCKS = 2 * ISO_EDGE_STRETCH, RUN_POINTS = 2048 };

typedef struct run_scratch {
    iso_edge_words words;
    iso_edge_block blocks[RUN_BLOCKS];
    iso_edge_job jobs[RUN_BLOCKS];
} run_scratch;

size_t iso_edge_run_scratch_bytes(void) {
    return (sizeof(run_scratch) + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
}

void iso_edge_runner_init(iso_edge_runner *runner, const iso_rgrid *grid, const iso_surface *surface,
                          bool floats) {
    *runner = (iso_edge_runner){
        .grid = grid,
        .kernel = iso_edge_kernel_get(grid->type, iso_cpu_best()),
        .floats = floats,
        .source = {.data = grid->data,
                   .stride_y = grid->stride_y,
                   .stride_z = grid->stride_z,
                   .dims = {grid->dims[0], grid->dims[1], grid->dims[2]},
                   .isovalue = surface->at,
                   .rest = surface->rest,
                   .level_set = surface->outward > 0},
    };
    iso_edge_source_prepare(&runner->source);
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

/* The rows of a brick that can have edges: without an index that is up to date, all. */
static uint16_t groups_of(const iso_edge_bricks *list, uint32_t brick) {
    const iso_brick_index *index = list->grid->index;
    if (!index || !iso_brick_index_current(index)) return ISO_EDGE_WHOLE.groups;
    return (uint16_t)iso_brick_index_groups(index, brick, list->isovalue);
}

iso_edge_stretch iso_edge_stretch_find(const iso_edge_bricks *list, size_t first) {
    iso_edge_stretch found = {0};
    for (size_t i = first; i < list->count; i++) {
        int brick[3];
        iso_brick_set_coordinates(list->set, list->bricks[i], brick);
        int block = brick[0] / ISO_EDGE_BRICKS;
        if (i == first) {
            found.first_block = block;
            found.row[0] = brick[1];
            found.row[1] = brick[2];
        }
        if (brick[1] != found.row[0] || brick[2] != found.row[1]) break;
        int number = block - found.first_block;
        if (number > found.blocks || number >= ISO_EDGE_STRETCH) break;
        if (!kernel_can(list->set, list->grid, brick)) break;
        found.blocks = number + 1;
        found.wanted[number].bricks |= (uint8_t)(1u << brick[0] % ISO_EDGE_BRICKS);
        found.wanted[number].groups |= groups_of(list, list->bricks[i]);
        found.bricks++;
    }
    return found;
}

/* Lists the points of a stretch's bricks; returns how many. */
static size_t count_stretch(const iso_edge_runner *runner, const iso_edge_stretch *asked,
                            iso_edge_words *words, iso_edge_block *blocks) {
    words->blocks = asked->blocks;
    for (int b = 0; b < asked->blocks; b++) words->wanted[b] = asked->wanted[b];
    blocks[0].origin[0] = asked->first_block * ISO_EDGE_BLOCK_X;
    blocks[0].origin[1] = asked->row[0] * ISO_BRICK;
    blocks[0].origin[2] = asked->row[1] * ISO_BRICK;
    runner->kernel->count(&runner->source, words, blocks);
    size_t total = 0;
    for (int b = 0; b < asked->blocks; b++)
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) total += blocks[b].points[k];
    return total;
}

/* Where the points of a block go, from `room` on; returns where those of the next do. */
static char *make_job(const iso_edge_runner *runner, const iso_edge_block *block, char *room,
                      iso_edge_job *job) {
    const size_t item_bytes = runner->floats ? sizeof(iso_surfel) : sizeof(iso_point);
    *job = (iso_edge_job){.origin = {block->origin[0], block->origin[1], block->origin[2]}};
    for (int axis = 0; axis < 3; axis++) {
        const iso_edge_list *list = &block->axes[axis];
        job->axes[axis] = (iso_edge_entries){list->mask, list->row, list->count};
    }
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        if (runner->floats)
            job->output.surfels[k] = (iso_surfel *)room;
        else
            job->output.packed[k] = (iso_point *)room;
        room += block->points[k] * item_bytes;
    }
    return room;
}

static void fill_blocks(const iso_edge_runner *runner, const uint32_t *bricks, int count, size_t total,
                        run_scratch *scratch, iso_brick_sink *sink) {
    char *room = iso_brick_sink_room(sink, 0, total);
    if (!room) return;
    for (int b = 0; b < count; b++) {
        const iso_edge_block *block = &scratch->blocks[b];
        room = make_job(runner, block, room, &scratch->jobs[b]);
        for (int k = 0; k < ISO_EDGE_BRICKS; k++)
            if (block->bricks >> k & 1)
                iso_brick_sink_add(sink, *bricks++, &(iso_brick_output){.count = {block->points[k]}});
    }
    runner->kernel->fill(&runner->source, scratch->jobs, count);
}

/* As many stretches from `first` on as are done together; returns how many bricks they have. */
static size_t run_some(const iso_edge_runner *runner, const iso_edge_bricks *list, size_t first,
                       run_scratch *scratch, iso_brick_sink *sink) {
    size_t i = first, total = 0;
    int blocks = 0;
    while (i < list->count && total < RUN_POINTS && blocks <= RUN_BLOCKS - ISO_EDGE_STRETCH) {
        const iso_edge_stretch asked = iso_edge_stretch_find(list, i);
        if (!asked.bricks) break;
        total += count_stretch(runner, &asked, &scratch->words, scratch->blocks + blocks);
        blocks += asked.blocks;
        i += asked.bricks;
    }
    if (blocks) fill_blocks(runner, list->bricks + first, blocks, total, scratch, sink);
    return i - first;
}

void iso_edge_run(const iso_edge_runner *runner, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink) {
    const iso_edge_bricks list = {runner->grid, set, bricks, count, runner->source.isovalue};
    for (size_t i = 0; i < count && !iso_brick_sink_failed(sink);) {
        const size_t done = run_some(runner, &list, i, scratch, sink);
        if (!done) iso_brick_sink_extract(sink, bricks[i]);
        i += done ? done : 1;
    }
}
