/* mesh_run: passes runs of bricks (edge_run.h) and windows to the mesh kernel (mesh_kernel.h), block by
 * block. */
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
    return (iso_edge_source){.isovalue_ceil = surface->isovalue_ceil,
                             .residual = surface->residual,
                             .level_set = surface->normal_sign > 0};
}

void iso_mesh_context_init(iso_mesh_context *context, const iso_grid *grid, const iso_threshold *surface) {
    *context = (iso_mesh_context){.grid = grid->rgrid, .surface = *surface};
    context->kernel = iso_mesh_kernel_get(iso_cpu_best());
    context->window_edges = iso_edge_kernel_get(ISO_FLOAT32, iso_cpu_best());
    context->window_source = source_of(surface);
    context->window_source.stride_y = ISO_STEP_Y;
    context->window_source.stride_z = ISO_STEP_Z;
    iso_edge_source_prepare(&context->window_source);
    if (!context->grid) return;
    context->edges = iso_edge_kernel_get(context->grid->type, iso_cpu_best());
    context->source = source_of(surface);
    context->source.data = context->grid->data;
    context->source.stride_y = context->grid->stride_y;
    context->source.stride_z = context->grid->stride_z;
    for (int axis = 0; axis < 3; axis++) context->source.dims[axis] = context->grid->dims[axis];
    iso_edge_source_prepare(&context->source);
}

/* ---- runs of an rgrid */

/* Gets memory from the sink for the results of a block's wanted bricks; returns false if there is none. */
static bool reserve_output(const iso_mesh_block *block, iso_brick_sink *sink, iso_mesh_output *output) {
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

static bool extract_run(const iso_mesh_context *context, const iso_edge_brick_run *run,
                        const uint32_t *bricks, run_scratch *scratch, iso_brick_sink *sink) {
    iso_mesh_block *block = &scratch->block;
    for (int axis = 0; axis < 3; axis++) block->origin[axis] = run->origin[axis];
    scratch->words.blocks = run->blocks;
    for (int b = 0; b < run->blocks; b++) scratch->words.active[b] = run->active[b];
    context->edges->classify_voxels(&context->source, block->origin, &scratch->words);
    for (int b = 0; b < run->blocks; b++, block->origin[0] += ISO_EDGE_BLOCK_X) {
        iso_mesh_output output;
        block->bricks = run->active[b].bricks;
        context->kernel->list_block(&context->source, &scratch->words, b, block);
        if (!reserve_output(block, sink, &output)) return false;
        iso_mesh_kernel_build(context->kernel, context->edges, &context->source, block, &output);
        for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
            if (!(block->bricks >> k & 1)) continue;
            const iso_brick_output made = {.count = {block->own[k] + block->far[k], block->triangles[k]},
                                           .own = block->own[k]};
            iso_brick_sink_add(sink, *bricks++, &made);
        }
    }
    return true;
}

void iso_mesh_run(const iso_mesh_context *context, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink) {
    iso_edge_walk walk = {
        .grid = context->grid, .source = &context->source, .set = set, .bricks = bricks, .count = count};
    for (const iso_edge_brick_run *run; (run = iso_edge_walk_next(&walk));) {
        if (iso_brick_sink_failed(sink)) return;
        if (!run->bricks) {
            iso_brick_sink_extract(sink, *bricks++);
            continue;
        }
        if (!extract_run(context, run, bricks, scratch, sink)) return;
        bricks += run->bricks;
    }
}

/* ---- one window */

/* Whether the kernel can work on the window: no NaN or infinity, no overflow of differences. */
static bool window_fits(const iso_brick_window *window) {
    unsigned outside = 0;
    for (int i = 0; i < ISO_WINDOW_VOXELS; i++) outside |= !(fabsf(window->values[i]) < 1e30f);
    return !outside;
}

/* Sets `words` to the inside bits of a window's voxels, as the first brick of a block; the bits after the
 * brick's last voxel repeat that voxel. */
static void classify_window(const iso_brick_window *window, float isovalue, iso_edge_words *words) {
    words->blocks = 1;
    words->active[0] = ISO_EDGE_WHOLE;
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

void iso_mesh_run_window(const iso_mesh_context *context, const iso_brick_window *window, void *scratch,
                         iso_brick_mesh *mesh) {
    if (!window_fits(window)) {
        iso_marching_cubes(window, &context->surface, mesh);
        return;
    }
    run_scratch *run = scratch;
    iso_edge_source source = context->window_source;
    source.data = window->values + iso_window_index(0, 0, 0);
    for (int axis = 0; axis < 3; axis++) {
        source.first[axis] = window->first[axis];
        source.dims[axis] = window->last[axis] + 1;
        run->block.origin[axis] = 0;
    }
    run->block.bricks = 1;
    classify_window(window, source.isovalue_ceil, &run->words);
    context->kernel->list_block(&source, &run->words, 0, &run->block);
    const iso_mesh_output output = {{mesh->vertices}, {mesh->keys}, {mesh->triangles}};
    iso_mesh_kernel_build(context->kernel, context->window_edges, &source, &run->block, &output);
    mesh->owned_count = run->block.own[0];
    mesh->vertex_count = run->block.own[0] + run->block.far[0];
    mesh->triangle_count = run->block.triangles[0];
}
