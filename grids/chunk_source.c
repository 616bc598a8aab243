/* chunk_source: chunks of a volume that is in memory, and visits of all chunks. */
#include "grids/chunk_source.h"

#include <string.h>

#include "base/numbers.h"
#include "grids/grid.h"

static iso_status view_chunk(void *context, const iso_grid_chunk *chunk, iso_pool *pool, iso_rgrid **grid,
                             iso_error *error) {
    (void)pool;
    return iso_grid_chunk_view(context, chunk, grid, error);
}

iso_chunk_source iso_chunk_source_of(const iso_rgrid *grid) {
    iso_chunk_source source = {.type = grid->type,
                               .scale = grid->scale,
                               .offset = grid->offset,
                               .transform = grid->transform,
                               .level_set = grid->level_set,
                               .read = view_chunk,
                               .context = (void *)(uintptr_t)grid};
    memcpy(source.dims, grid->dims, sizeof source.dims);
    return source;
}

/* ---- all chunks */

/* The visit that is being made. */
typedef struct visit {
    const iso_chunk_source *source;
    iso_pool *pool;
    iso_chunk_voxels_visitor *visit;
    void *context;
} visit;

/* Takes the halo off a chunk's grid. *first: its first voxel in the volume. */
static iso_status crop_to_box(const iso_grid_chunk *chunk, iso_rgrid *grid, int first[3], iso_error *error) {
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = chunk->box.first[axis] * ISO_BRICK;
        const int origin = chunk->origin[axis] * ISO_BRICK,
                  end = iso_min_int(chunk->box.end[axis] * ISO_BRICK, chunk->dims[axis]);
        lo[axis] = first[axis] - origin;
        hi[axis] = end - 1 - origin;
    }
    return iso_rgrid_crop(grid, lo, hi, error);
}

static iso_status visit_chunk(const visit *v, const iso_grid_chunk *chunk, iso_error *error) {
    iso_rgrid *grid = NULL;
    int first[3];
    ISO_TRY(v->source->read(v->source->context, chunk, v->pool, &grid, error));
    iso_status status = crop_to_box(chunk, grid, first, error);
    if (status == ISO_OK) status = v->visit(v->context, grid, first, error);
    iso_rgrid_destroy(grid);
    if (v->source->rest) v->source->rest(v->source->context);
    return status;
}

iso_status iso_chunk_source_visit(const iso_chunk_source *source, int side, iso_chunk_turns turns,
                                  iso_pool *pool, iso_chunk_voxels_visitor *visitor, void *context,
                                  iso_error *error) {
    const visit v = {source, pool, visitor, context};
    const int bricks = (side - 1) / ISO_BRICK + 1;
    size_t counts[3];
    for (int axis = 0; axis < 3; axis++)
        counts[axis] = (size_t)((source->dims[axis] - 1) / (bricks * ISO_BRICK) + 1);
    for (size_t n = (size_t)turns.turn; n < counts[0] * counts[1] * counts[2]; n += (size_t)turns.turns) {
        const int x = (int)(n % counts[0]) * bricks, y = (int)(n / counts[0] % counts[1]) * bricks,
                  z = (int)(n / counts[0] / counts[1]) * bricks;
        const iso_brick_box box = {{x, y, z}, {x + bricks, y + bricks, z + bricks}};
        iso_grid_chunk chunk;
        iso_grid_chunk_make(source->dims, &source->transform, &box, &chunk);
        ISO_TRY(visit_chunk(&v, &chunk, error));
    }
    return ISO_OK;
}

typedef struct nonfinite_sum {
    iso_pool *pool;
    size_t count;
} nonfinite_sum;

static iso_status add_nonfinite(void *context, const iso_rgrid *grid, const int first[3], iso_error *error) {
    nonfinite_sum *sum = context;
    const iso_grid handle = {.rgrid = (iso_rgrid *)(uintptr_t)grid};
    (void)first, (void)error;
    sum->count += iso_grid_count_nonfinite(&handle, sum->pool);
    return ISO_OK;
}

iso_status iso_chunk_source_count_nonfinite(const iso_chunk_source *source, int side, iso_pool *pool,
                                            size_t *count, iso_error *error) {
    nonfinite_sum sum = {pool, 0};
    ISO_TRY(iso_chunk_source_visit(source, side, (iso_chunk_turns){0, 1}, pool, add_nonfinite, &sum, error));
    *count = sum.count;
    return ISO_OK;
}
