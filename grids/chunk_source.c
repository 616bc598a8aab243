/* chunk_source: chunks of a volume that is in memory, and visits of all chunks. */
#include "grids/chunk_source.h"

#include <math.h>
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

/* ---- cuts */

/* Whole tiles of about `side` voxels, if tiles are not larger than that. */
static int choose_pitch(int side, int tile) {
    if (tile < 1 || tile > side) return side;
    const int pitch = side / tile * tile;
    return pitch < ISO_BRICK ? (ISO_BRICK - 1) / tile * tile + tile : pitch;
}

void iso_chunk_cuts_make(const iso_chunk_source *source, int side, iso_chunk_cuts *cuts) {
    *cuts = (iso_chunk_cuts){.above = source->tile[0] ? ISO_CHUNK_ABOVE : 0};
    side = (side - 1) / ISO_BRICK * ISO_BRICK + ISO_BRICK;
    for (int axis = 0; axis < 3; axis++) {
        const int dim = source->dims[axis], pitch = choose_pitch(side, source->tile[axis]);
        int before = source->in_tile[axis] % pitch;
        while (pitch - before < ISO_BRICK + cuts->above) before -= pitch; /* the first chunk is larger */
        cuts->bricks[axis] = (dim - 1) / ISO_BRICK + 1;
        cuts->pitch[axis] = pitch;
        cuts->before[axis] = before;
        cuts->counts[axis] = dim + before > 0 ? (dim + before - 1) / pitch + 1 : 1;
        for (int number = 0; number < cuts->counts[axis]; number++) {
            const int bricks = iso_chunk_cut(cuts, axis, number + 1) - iso_chunk_cut(cuts, axis, number);
            if (bricks > cuts->most[axis]) cuts->most[axis] = bricks;
        }
    }
}

int iso_chunk_cut(const iso_chunk_cuts *cuts, int axis, int number) {
    if (number <= 0) return 0;
    if (number >= cuts->counts[axis]) return cuts->bricks[axis];
    return (number * cuts->pitch[axis] - cuts->before[axis] - cuts->above) / ISO_BRICK;
}

int iso_chunk_with(const iso_chunk_cuts *cuts, int axis, int brick) {
    const int end = (brick + 1) * ISO_BRICK - 1 + cuts->before[axis] + cuts->above;
    return iso_min_int(end < 0 ? 0 : end / cuts->pitch[axis], cuts->counts[axis] - 1);
}

size_t iso_chunk_cuts_count(const iso_chunk_cuts *cuts) {
    return (size_t)cuts->counts[0] * (size_t)cuts->counts[1] * (size_t)cuts->counts[2];
}

iso_brick_box iso_chunk_box(const iso_chunk_cuts *cuts, size_t number) {
    iso_brick_box box;
    for (int axis = 0; axis < 3; axis++) {
        const int at = (int)(number % (size_t)cuts->counts[axis]);
        number /= (size_t)cuts->counts[axis];
        box.first[axis] = iso_chunk_cut(cuts, axis, at);
        box.end[axis] = iso_chunk_cut(cuts, axis, at + 1);
    }
    return box;
}

void iso_chunk_source_blocks(const iso_chunk_source *source, int before[3]) {
    enum { BLOCK = 64 };
    for (int axis = 0; axis < 3; axis++) {
        const int tile = source->tile[axis];
        const bool agrees = tile && (tile % BLOCK == 0 || (BLOCK % tile == 0 && tile >= ISO_BRICK));
        before[axis] = agrees && source->in_tile[axis] % BLOCK == 0;
    }
}

/* ---- all chunks */

/* The visit that is being made. */
typedef struct visit {
    const iso_chunk_source *source;
    iso_pool *pool;
    iso_chunk_voxels_visitor *visit;
    void *context;
    iso_rgrid *constant; /* a chunk whose voxels all have this value, for others like it; NULL: none */
    float value;
} visit;

/* The voxels of a chunk without its halo, of the volume. */
static void voxels_of(const iso_grid_chunk *chunk, int first[3], int end[3]) {
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = chunk->box.first[axis] * ISO_BRICK;
        end[axis] = iso_min_int(chunk->box.end[axis] * ISO_BRICK, chunk->dims[axis]);
    }
}

/* Takes the halo off a chunk's grid. */
static iso_status crop_to_box(const iso_grid_chunk *chunk, iso_rgrid *grid, iso_error *error) {
    int lo[3], hi[3];
    voxels_of(chunk, lo, hi);
    for (int axis = 0; axis < 3; axis++) {
        const int origin = chunk->origin[axis] * ISO_BRICK;
        lo[axis] -= origin;
        hi[axis] -= 1 + origin;
    }
    return iso_rgrid_crop(grid, lo, hi, error);
}

/* Whether all voxels of a chunk are known to be *value, and grids may be kept. */
static bool is_constant(const iso_chunk_source *source, const iso_grid_chunk *chunk, float *value) {
    return source->is_constant && !source->rest && source->is_constant(source->context, chunk, value);
}

/* Whether the chunk's voxels are those of v->constant. */
static bool is_like_last(const visit *v, const iso_grid_chunk *chunk) {
    float value;
    int first[3], end[3];
    if (!v->constant) return false;
    voxels_of(chunk, first, end);
    for (int axis = 0; axis < 3; axis++)
        if (v->constant->dims[axis] != end[axis] - first[axis]) return false;
    return is_constant(v->source, chunk, &value) && memcmp(&value, &v->value, sizeof value) == 0;
}

static iso_status visit_chunk(visit *v, const iso_grid_chunk *chunk, iso_error *error) {
    iso_rgrid *grid = NULL;
    int first[3], end[3];
    float value;
    voxels_of(chunk, first, end);
    if (is_like_last(v, chunk)) return v->visit(v->context, v->constant, first, true, error);
    const bool constant = is_constant(v->source, chunk, &value);
    ISO_TRY(v->source->read(v->source->context, chunk, v->pool, &grid, error));
    iso_status status = crop_to_box(chunk, grid, error);
    if (status == ISO_OK) status = v->visit(v->context, grid, first, constant, error);
    if (status == ISO_OK && constant) {
        iso_rgrid_destroy(v->constant);
        v->constant = grid;
        v->value = value;
    } else {
        iso_rgrid_destroy(grid);
    }
    if (v->source->rest) v->source->rest(v->source->context);
    return status;
}

iso_status iso_chunk_source_visit(const iso_chunk_source *source, int side, iso_chunk_turns turns,
                                  iso_pool *pool, iso_chunk_voxels_visitor *visitor, void *context,
                                  iso_error *error) {
    visit v = {.source = source, .pool = pool, .visit = visitor, .context = context};
    const size_t step = (size_t)turns.turns;
    iso_status status = ISO_OK;
    iso_chunk_cuts cuts;
    iso_chunk_cuts_make(source, side, &cuts);
    const size_t count = iso_chunk_cuts_count(&cuts);
    for (size_t number = (size_t)turns.turn; status == ISO_OK && number < count; number += step) {
        const iso_brick_box box = iso_chunk_box(&cuts, number);
        iso_grid_chunk chunk;
        iso_grid_chunk_make(source->dims, &source->transform, &box, &chunk);
        chunk.bare = true;
        status = visit_chunk(&v, &chunk, error);
    }
    iso_rgrid_destroy(v.constant);
    return status;
}

typedef struct nonfinite_sum {
    iso_pool *pool;
    size_t count;
} nonfinite_sum;

static iso_status add_nonfinite(void *context, const iso_rgrid *grid, const int first[3], bool constant,
                                iso_error *error) {
    nonfinite_sum *sum = context;
    const iso_grid handle = {.rgrid = (iso_rgrid *)(uintptr_t)grid};
    (void)first, (void)error;
    if (!constant || !isfinite(iso_rgrid_at(grid, 0, 0, 0)))
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
