/* Neighbouring blocks are classified together, so that whole rows stream from memory; see edge_kernel.h. */
#include "extract/edge_run.h"

#include "grids/brick_index.h"

typedef struct run_scratch {
    iso_edge_words words;
    iso_edge_block blocks[ISO_EDGE_STRETCH];
} run_scratch;

size_t iso_edge_run_scratch_bytes(void) {
    return (sizeof(run_scratch) + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
}

void iso_edge_runner_init(iso_edge_runner *runner, const iso_rgrid *grid, const iso_surface *surface) {
    *runner = (iso_edge_runner){
        .grid = grid,
        .kernel = iso_edge_kernel_get(grid->type, iso_cpu_best()),
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

iso_edge_stretch iso_edge_stretch_find(const iso_rgrid *grid, const iso_brick_set *set,
                                       const uint32_t *bricks, size_t count) {
    iso_edge_stretch found = {0};
    for (size_t i = 0; i < count; i++) {
        int brick[3];
        iso_brick_set_coordinates(set, bricks[i], brick);
        int block = brick[0] / ISO_EDGE_BRICKS;
        if (i == 0) {
            found.first_block = block;
            found.row[0] = brick[1];
            found.row[1] = brick[2];
        }
        if (brick[1] != found.row[0] || brick[2] != found.row[1]) break;
        int number = block - found.first_block;
        if (number > found.blocks || number >= ISO_EDGE_STRETCH || !kernel_can(set, grid, brick)) break;
        found.blocks = number + 1;
        found.asked[number] |= 1u << brick[0] % ISO_EDGE_BRICKS;
        found.bricks++;
    }
    return found;
}

/* Lists the points of the run's bricks; returns how many. */
static size_t count_run(const iso_edge_runner *runner, const iso_edge_stretch *asked, run_scratch *scratch) {
    iso_edge_block *blocks = scratch->blocks;
    scratch->words.blocks = asked->blocks;
    for (int b = 0; b < asked->blocks; b++) {
        blocks[b].origin[0] = (asked->first_block + b) * ISO_EDGE_BLOCK_X;
        blocks[b].origin[1] = asked->row[0] * ISO_BRICK;
        blocks[b].origin[2] = asked->row[1] * ISO_BRICK;
    }
    runner->kernel->count(&runner->source, &scratch->words, blocks);
    size_t total = 0;
    for (int b = 0; b < asked->blocks; b++) {
        bool others = false;
        for (int k = 0; k < ISO_EDGE_BRICKS; k++)
            others |= blocks[b].points[k] && !(asked->asked[b] >> k & 1);
        if (others) iso_edge_block_keep(&blocks[b], asked->asked[b]);
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) total += blocks[b].points[k];
    }
    return total;
}

/* Shapes of a block's points; returns where the next block's go. */
static iso_shape *fill_shapes(const iso_edge_runner *runner, const iso_edge_block *block,
                              const iso_edge_output *output, iso_shape *shapes) {
    const float outward = runner->source.level_set ? 1 : -1;
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        if (!block->points[k]) continue;
        const int brick[3] = {block->origin[0] / ISO_BRICK + k, block->origin[1] / ISO_BRICK,
                              block->origin[2] / ISO_BRICK};
        const iso_shape_source source = iso_shape_source_grid(runner->grid, brick, outward);
        const iso_shape_points points = {output->packed[k], output->surfels[k], block->points[k]};
        iso_shapes_of_edges(&source, &points, shapes);
        shapes += block->points[k];
    }
    return shapes;
}

static void fill_run(const iso_edge_runner *runner, const iso_edge_stretch *asked, const uint32_t *bricks,
                     run_scratch *scratch, size_t total, iso_brick_sink *sink) {
    size_t item_bytes = runner->floats ? sizeof(iso_surfel) : sizeof(iso_point);
    char *room = iso_brick_sink_room(sink, 0, total);
    iso_shape *shapes = room && runner->shapes ? iso_brick_sink_room(sink, 1, total) : NULL;
    if (!room || (runner->shapes && !shapes)) return;
    for (int b = 0; b < asked->blocks; b++) {
        const iso_edge_block *block = &scratch->blocks[b];
        iso_edge_output output = {0};
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
            if (runner->floats)
                output.surfels[k] = (iso_surfel *)room;
            else
                output.packed[k] = (iso_point *)room;
            room += block->points[k] * item_bytes;
            if (asked->asked[b] >> k & 1)
                iso_brick_sink_add(sink, *bricks++, &(iso_brick_output){.count = {block->points[k]}});
        }
        runner->kernel->fill(&runner->source, block, &output);
        if (shapes) shapes = fill_shapes(runner, block, &output, shapes);
    }
}

void iso_edge_run(const iso_edge_runner *runner, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink) {
    for (size_t i = 0; i < count && !iso_brick_sink_failed(sink);) {
        iso_edge_stretch asked = iso_edge_stretch_find(runner->grid, set, bricks + i, count - i);
        if (!asked.bricks) {
            iso_brick_sink_extract(sink, bricks[i++]);
            continue;
        }
        size_t total = count_run(runner, &asked, scratch);
        fill_run(runner, &asked, bricks + i, scratch, total, sink);
        i += asked.bricks;
    }
}
