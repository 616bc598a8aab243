/* See mesh_kernel.h for the kernel and edge_run.h for stretches of bricks. */
#include "extract/mesh/mesh_run.h"

#include "extract/points/edge_run.h"

typedef struct run_scratch {
    iso_edge_words words;
    iso_mesh_block block;
} run_scratch;

size_t iso_mesh_run_scratch_bytes(void) {
    return (sizeof(run_scratch) + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
}

static iso_edge_source source_of(const iso_threshold *surface) {
    return (iso_edge_source){
        .isovalue = surface->at, .rest = surface->rest, .level_set = surface->outward > 0};
}

void iso_mesh_runner_init(iso_mesh_runner *runner, const iso_grid *grid, const iso_threshold *surface) {
    *runner = (iso_mesh_runner){.grid = grid->rgrid, .surface = *surface};
    runner->kernel = iso_mesh_kernel_get(iso_cpu_best());
    runner->window_edges = iso_edge_kernel_get(ISO_FLOAT32, iso_cpu_best());
    runner->window_source = source_of(surface);
    runner->window_source.stride_y = ISO_STEP_Y;
    runner->window_source.stride_z = ISO_STEP_Z;
    iso_edge_source_prepare(&runner->window_source);
    if (!runner->grid) return;
    runner->edges = iso_edge_kernel_get(runner->grid->type, iso_cpu_best());
    runner->source = source_of(surface);
    runner->source.data = runner->grid->data;
    runner->source.stride_y = runner->grid->stride_y;
    runner->source.stride_z = runner->grid->stride_z;
    for (int axis = 0; axis < 3; axis++) runner->source.dims[axis] = runner->grid->dims[axis];
    iso_edge_source_prepare(&runner->source);
}

/* ---- runs of an rgrid */

/* Room for the block's wanted bricks, one after another. */
static bool block_room(const iso_mesh_block *block, iso_brick_sink *sink, iso_mesh_output *output) {
    size_t vertices = 0, triangles = 0;
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        vertices += block->own[k] + block->far[k];
        triangles += block->triangles[k];
    }
    iso_surfel *vertex = iso_brick_sink_room(sink, 0, vertices);
    iso_edge_key *key = iso_brick_sink_room(sink, 1, vertices);
    uint16_t(*triangle)[3] = iso_brick_sink_room(sink, ISO_SPAN_ARRAYS, triangles + ISO_TRIANGLE_SLACK);
    if (!vertex || !key || !triangle) return false;
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        output->vertices[k] = vertex;
        output->keys[k] = key;
        output->triangles[k] = triangle;
        vertex += block->own[k] + block->far[k];
        key += block->own[k] + block->far[k];
        triangle += block->triangles[k];
    }
    return true;
}

static bool run_stretch(const iso_mesh_runner *runner, const iso_edge_stretch *stretch,
                        const uint32_t *bricks, run_scratch *scratch, iso_brick_sink *sink) {
    iso_mesh_block *block = &scratch->block;
    for (int axis = 0; axis < 3; axis++) block->origin[axis] = stretch->origin[axis];
    scratch->words.blocks = stretch->blocks;
    for (int b = 0; b < stretch->blocks; b++) scratch->words.wanted[b] = stretch->wanted[b];
    runner->edges->classify(&runner->source, block->origin, &scratch->words);
    for (int b = 0; b < stretch->blocks; b++, block->origin[0] += ISO_EDGE_BLOCK_X) {
        iso_mesh_output output;
        block->bricks = stretch->wanted[b].bricks;
        runner->kernel->list(&runner->source, &scratch->words, b, block);
        if (!block_room(block, sink, &output)) return false;
        iso_mesh_kernel_fill(runner->kernel, runner->edges, &runner->source, block, &output);
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
            if (!(block->bricks >> k & 1)) continue;
            const iso_brick_output made = {.count = {block->own[k] + block->far[k], block->triangles[k]},
                                           .own = block->own[k]};
            iso_brick_sink_add(sink, *bricks++, &made);
        }
    }
    return true;
}

void iso_mesh_run(const iso_mesh_runner *runner, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink) {
    iso_edge_walk walk = {
        .grid = runner->grid, .source = &runner->source, .set = set, .bricks = bricks, .count = count};
    for (const iso_edge_stretch *stretch; (stretch = iso_edge_walk_next(&walk));) {
        if (iso_brick_sink_failed(sink)) return;
        if (!stretch->bricks) {
            iso_brick_sink_extract(sink, *bricks++);
            continue;
        }
        if (!run_stretch(runner, stretch, bricks, scratch, sink)) return;
        bricks += stretch->bricks;
    }
}

/* ---- one window */

static bool window_fits(const iso_brick_window *window) {
    unsigned outside = 0;
    for (int i = 0; i < ISO_WINDOW_VOXELS; i++) outside |= !(fabsf(window->values[i]) < 1e30f);
    return !outside;
}

/* The words of a block whose first brick is the window's; what follows repeats its last voxel. */
static void classify_window(const iso_brick_window *window, float isovalue, iso_edge_words *words) {
    words->blocks = 1;
    words->wanted[0] = ISO_EDGE_WHOLE;
    for (int z = 0; z < ISO_EDGE_SIDE; z++)
        for (int y = 0; y < ISO_EDGE_SIDE; y++) {
            const float *row = window->values + iso_window_index(0, y, z);
            uint32_t bits = 0;
            for (int x = 0; x < ISO_EDGE_SIDE; x++) bits |= (uint32_t)(row[x] >= isovalue) << x;
            const uint64_t last = bits >> ISO_BRICK;
            words->bits[0][z * ISO_EDGE_SIDE + y] = bits | (0 - last) << ISO_BRICK;
            words->bits[1][z * ISO_EDGE_SIDE + y] = last;
        }
}

void iso_mesh_run_window(const iso_mesh_runner *runner, const iso_brick_window *window, void *scratch,
                         iso_brick_mesh *mesh) {
    if (!window_fits(window)) {
        iso_marching_cubes(window, &runner->surface, mesh);
        return;
    }
    run_scratch *run = scratch;
    iso_edge_source source = runner->window_source;
    source.data = window->values + iso_window_index(0, 0, 0);
    for (int axis = 0; axis < 3; axis++) {
        source.first[axis] = window->first[axis];
        source.dims[axis] = window->last[axis] + 1;
        run->block.origin[axis] = 0;
    }
    run->block.bricks = 1;
    classify_window(window, source.isovalue, &run->words);
    runner->kernel->list(&source, &run->words, 0, &run->block);
    const iso_mesh_output output = {{mesh->vertices}, {mesh->keys}, {mesh->triangles}};
    iso_mesh_kernel_fill(runner->kernel, runner->window_edges, &source, &run->block, &output);
    mesh->own_count = run->block.own[0];
    mesh->vertex_count = run->block.own[0] + run->block.far[0];
    mesh->triangle_count = run->block.triangles[0];
}
