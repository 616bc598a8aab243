/* scene_build: fills a grid with the bricks of a solid, in parallel, with the same result for any number of
 * threads. */
#include <string.h>

#include "base/memory.h"
#include "grids/scenes/scene_parts.h"

/* Bricks are computed in batches of this size and then stored in the order of their cells, so that their
 * numbers do not depend on threads, and bricks that turn out to be empty take no memory. */
enum { BATCH = 256 };
/* The state of a cell that may contain part of the band; no brick number or other state has this value. */
#define UNDECIDED INT32_MIN

typedef struct build {
    const iso_scene_solid *solid;
    int cells; /* cells along each side */
    int32_t *state;
    const uint32_t *near;
    float *bricks; /* BATCH bricks; one brick for each worker when the grid is dense */
    char *scratch; /* working memory, one for each worker */
    size_t stride; /* bytes of one scratch */
    float *voxels; /* the voxels of a dense grid */
} build;

static void cell_of(const build *b, size_t index, int cell[3]) {
    size_t side = (size_t)b->cells;
    cell[0] = (int)(index % side);
    cell[1] = (int)(index / side % side);
    cell[2] = (int)(index / side / side);
}

static void classify_row(void *context, size_t row, int worker) {
    (void)worker;
    build *b = context;
    for (size_t i = row * (size_t)b->cells; i < (row + 1) * (size_t)b->cells; i++) {
        int cell[3];
        cell_of(b, i, cell);
        int32_t state = b->solid->classify(b->solid->self, cell);
        b->state[i] = state ? state : UNDECIDED;
    }
}

static void fill_brick(void *context, size_t index, int worker) {
    build *b = context;
    int cell[3];
    cell_of(b, b->near[index], cell);
    b->solid->fill(b->solid->self, cell, b->scratch + (size_t)worker * b->stride,
                   b->bricks + index * ISO_BRICK_VOXELS);
}

static int is_constant(const float *brick) {
    for (int i = 1; i < ISO_BRICK_VOXELS; i++)
        if (brick[i] != brick[0]) return 0;
    return 1;
}

static iso_status store(iso_hgrid *grid, const int cell[3], const float *brick, iso_error *error) {
    if ((brick[0] == grid->band || brick[0] == -grid->band) && is_constant(brick)) {
        int32_t state = brick[0] > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
        iso_hgrid_coalesce(grid, cell[0], cell[1], cell[2], state);
        return ISO_OK;
    }
    float *target;
    ISO_TRY(iso_hgrid_split(grid, cell[0], cell[1], cell[2], &target, error));
    memcpy(target, brick, ISO_BRICK_VOXELS * sizeof *brick);
    return ISO_OK;
}

static iso_status fill_near(build *b, iso_hgrid *grid, size_t count, iso_pool *pool, iso_error *error) {
    const uint32_t *all = b->near;
    for (size_t first = 0; first < count; first += BATCH) {
        size_t now = count - first < BATCH ? count - first : BATCH;
        b->near = all + first;
        iso_parallel_for(pool, now, fill_brick, b);
        for (size_t i = 0; i < now; i++) {
            int cell[3];
            cell_of(b, b->near[i], cell);
            ISO_TRY(store(grid, cell, b->bricks + i * ISO_BRICK_VOXELS, error));
        }
    }
    return ISO_OK;
}

/* Classifies all cells of `grid`, lists those near the surface, and fills them. */
static iso_status build_sparse(build *b, iso_hgrid *grid, iso_pool *pool, iso_error *error) {
    size_t rows = (size_t)b->cells * (size_t)b->cells, total = rows * (size_t)b->cells, count = 0;
    b->state = grid->cell;
    iso_parallel_for(pool, rows, classify_row, b);
    uint32_t *near = iso_alloc(total * sizeof *near);
    for (size_t i = 0; i < total; i++) {
        if (grid->cell[i] != UNDECIDED) continue;
        grid->cell[i] = ISO_CELL_OUTSIDE;
        if (near) near[count++] = (uint32_t)i;
    }
    b->near = near;
    iso_status status = near && b->bricks && b->scratch
                            ? fill_near(b, grid, count, pool, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the bricks of a scene");
    iso_free(near);
    return status;
}

static void fill_dense(void *context, size_t index, int worker) {
    build *b = context;
    int cell[3];
    cell_of(b, index, cell);
    float *brick = b->bricks + (size_t)worker * ISO_BRICK_VOXELS;
    int32_t state = b->solid->classify(b->solid->self, cell);
    if (state) {
        float value = (float)(state == ISO_CELL_INSIDE ? -ISO_SCENE_BAND : ISO_SCENE_BAND);
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) brick[i] = value;
    } else {
        b->solid->fill(b->solid->self, cell, b->scratch + (size_t)worker * b->stride, brick);
    }
    int size = b->solid->size, first[3], n[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = cell[axis] * ISO_BRICK;
        n[axis] = size - first[axis] < ISO_BRICK ? size - first[axis] : ISO_BRICK;
    }
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            size_t row = (size_t)(first[2] + z) * (size_t)size + (size_t)(first[1] + y);
            memcpy(b->voxels + row * (size_t)size + first[0], brick + (z * ISO_BRICK + y) * ISO_BRICK,
                   (size_t)n[0] * sizeof *brick);
        }
}

static iso_status make_grid(build *b, const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    const int dims[3] = {b->solid->size, b->solid->size, b->solid->size};
    if (!opts->dense) {
        ISO_TRY(iso_hgrid_create(dims, (float)ISO_SCENE_BAND, NULL, &grid->hgrid, error));
        return build_sparse(b, grid->hgrid, opts->pool, error);
    }
    if (!b->bricks || !b->scratch)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the bricks of a scene");
    iso_rgrid_desc desc = {.dims = {dims[0], dims[1], dims[2]}, .type = ISO_FLOAT32, .level_set = 1};
    ISO_TRY(iso_rgrid_create(&desc, &grid->rgrid, error));
    b->voxels = grid->rgrid->data;
    size_t cells = (size_t)b->cells;
    iso_parallel_for(opts->pool, cells * cells * cells, fill_dense, b);
    return ISO_OK;
}

iso_status iso_scene_build(const iso_scene_solid *solid, const iso_scene_opts *opts, iso_grid *out,
                           iso_error *error) {
    size_t workers = (size_t)iso_pool_threads(opts->pool);
    size_t bricks = opts->dense ? workers : BATCH;
    build b = {.solid = solid, .cells = (solid->size - 1) / ISO_BRICK + 1};
    b.stride = (solid->scratch_bytes / ISO_ALIGNMENT + 1) * ISO_ALIGNMENT;
    b.bricks = iso_alloc(bricks * ISO_BRICK_VOXELS * sizeof *b.bricks);
    b.scratch = iso_alloc(workers * b.stride);
    iso_grid grid = {0};
    iso_status status = make_grid(&b, opts, &grid, error);
    iso_free(b.bricks);
    iso_free(b.scratch);
    if (status != ISO_OK)
        iso_grid_destroy(&grid);
    else
        *out = grid;
    return status;
}

void iso_scene_sines(const iso_scene_axis *axis, double *out) {
    for (int i = 0; i < axis->count; i++)
        iso_sincos(axis->rate * (axis->first + i + 0.5) + axis->phase, &out[2 * i], &out[2 * i + 1]);
}
