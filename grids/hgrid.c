/* Implements the two-level grid of Baerentzen and Christensen 2003, section 3: the pool of bricks, splitting,
 * coalescing and cropping. */
#include "grids/hgrid.h"

#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"

static iso_status add_chunk(iso_brick_pool *pool, iso_error *error) {
    if (pool->chunk_count == pool->chunk_room) {
        size_t room = pool->chunk_room ? 2 * pool->chunk_room : 16;
        float **table = iso_alloc(room * sizeof *table);
        if (!table) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu chunks of bricks", room);
        if (pool->chunk) memcpy(table, pool->chunk, pool->chunk_count * sizeof *table);
        iso_free(pool->chunk);
        pool->chunk = table;
        pool->chunk_room = room;
    }
    float *chunk = iso_alloc(ISO_POOL_CHUNK * ISO_BRICK_VOXELS * sizeof(float));
    if (!chunk)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory: no room for more than %zu bricks", pool->used);
    pool->chunk[pool->chunk_count++] = chunk;
    return ISO_OK;
}

static iso_status allocate_brick(iso_hgrid *grid, int32_t *number, iso_error *error) {
    iso_brick_pool *pool = &grid->pool;
    if (pool->first_free >= 0) {
        *number = pool->first_free;
        memcpy(&pool->first_free, iso_hgrid_brick(grid, *number), sizeof pool->first_free);
    } else {
        if ((size_t)pool->next == pool->chunk_count * ISO_POOL_CHUNK) ISO_TRY(add_chunk(pool, error));
        *number = pool->next++;
    }
    pool->used++;
    return ISO_OK;
}

static void release_brick(iso_hgrid *grid, int32_t number) {
    memcpy(iso_hgrid_brick(grid, number), &grid->pool.first_free, sizeof grid->pool.first_free);
    grid->pool.first_free = number;
    grid->pool.used--;
}

static iso_status check_arguments(const int dims[3], float band, const iso_transform *transform,
                                  iso_error *error) {
    for (int axis = 0; axis < 3; axis++) {
        if (dims[axis] < 1)
            return iso_fail(error, ISO_ERR_FORMAT, "a level set of %d x %d x %d voxels has none", dims[0],
                            dims[1], dims[2]);
        if (dims[axis] > ISO_HGRID_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "a level set of %d x %d x %d voxels is over %d along %c",
                            dims[0], dims[1], dims[2], ISO_HGRID_MAX, "xyz"[axis]);
    }
    if (band != 0 && !(band >= 3 && isfinite(band)))
        return iso_fail(error, ISO_ERR_USAGE, "a narrow band of %g voxels is below 3", (double)band);
    if (transform && iso_transform_is_singular(transform))
        return iso_fail(error, ISO_ERR_FORMAT, "spacing and direction do not span the space");
    return ISO_OK;
}

iso_status iso_hgrid_create(const int dims[3], float band, const iso_transform *transform, iso_hgrid **out,
                            iso_error *error) {
    ISO_TRY(check_arguments(dims, band, transform, error));
    iso_hgrid *grid = iso_alloc_zero(1, sizeof *grid);
    if (!grid) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a level set");
    for (int axis = 0; axis < 3; axis++) {
        grid->dims[axis] = dims[axis];
        grid->cells[axis] = (dims[axis] - 1) / ISO_BRICK + 1;
    }
    grid->band = band == 0 ? 3 : band;
    grid->transform = transform ? *transform : iso_transform_identity();
    grid->pool.first_free = -1;
    iso_status status = iso_change_log_create(grid->cells, &grid->log, error);
    size_t cells = iso_hgrid_cell_count(grid);
    if (status == ISO_OK) grid->cell = iso_alloc(cells * sizeof *grid->cell);
    if (status == ISO_OK && !grid->cell)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu cells", cells);
    if (status != ISO_OK) {
        iso_hgrid_destroy(grid);
        return status;
    }
    for (size_t i = 0; i < cells; i++) grid->cell[i] = ISO_CELL_OUTSIDE;
    *out = grid;
    return ISO_OK;
}

void iso_hgrid_destroy(iso_hgrid *grid) {
    if (!grid) return;
    for (size_t i = 0; i < grid->pool.chunk_count; i++) iso_free(grid->pool.chunk[i]);
    iso_free(grid->pool.chunk);
    iso_free(grid->cell);
    iso_change_log_destroy(grid->log);
    iso_free(grid);
}

iso_status iso_hgrid_split_unset(iso_hgrid *grid, int cx, int cy, int cz, iso_error *error) {
    int32_t *cell = &grid->cell[iso_hgrid_cell_index(grid, cx, cy, cz)];
    return *cell >= 0 ? ISO_OK : allocate_brick(grid, cell, error);
}

iso_status iso_hgrid_split(iso_hgrid *grid, int cx, int cy, int cz, float **brick, iso_error *error) {
    const size_t cell = iso_hgrid_cell_index(grid, cx, cy, cz);
    const int32_t state = grid->cell[cell];
    ISO_TRY(iso_hgrid_split_unset(grid, cx, cy, cz, error));
    *brick = iso_hgrid_brick(grid, grid->cell[cell]);
    for (int i = 0; i < ISO_BRICK_VOXELS && state < 0; i++) (*brick)[i] = iso_hgrid_empty_value(grid, state);
    return ISO_OK;
}

void iso_hgrid_reserve(iso_hgrid *grid, int bricks) {
    iso_brick_pool *pool = &grid->pool;
    enum { PAGE = 4096 / sizeof(float) };
    if (pool->ready < pool->next) pool->ready = pool->next;
    for (; pool->ready < pool->next + bricks; pool->ready++) {
        if ((size_t)pool->ready == pool->chunk_count * ISO_POOL_CHUNK && add_chunk(pool, NULL) != ISO_OK)
            return;
        float *voxels = iso_hgrid_brick(grid, pool->ready);
        for (int i = 0; i < ISO_BRICK_VOXELS; i += PAGE) voxels[i] = 0;
    }
}

void iso_hgrid_coalesce(iso_hgrid *grid, int cx, int cy, int cz, int32_t state) {
    int32_t *cell = &grid->cell[iso_hgrid_cell_index(grid, cx, cy, cz)];
    if (*cell >= 0) release_brick(grid, *cell);
    *cell = state;
}

/* Coalesces a cell if its voxels inside the grid are all +band or all -band. */
static void prune_cell(iso_hgrid *grid, int cx, int cy, int cz) {
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, cx, cy, cz)];
    if (number < 0) return;
    const float *brick = iso_hgrid_brick(grid, number);
    float value = brick[0];
    if (value != grid->band && value != -grid->band) return;
    int nx = iso_min_int(ISO_BRICK, grid->dims[0] - cx * ISO_BRICK);
    int ny = iso_min_int(ISO_BRICK, grid->dims[1] - cy * ISO_BRICK);
    int nz = iso_min_int(ISO_BRICK, grid->dims[2] - cz * ISO_BRICK);
    for (int z = 0; z < nz; z++)
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++)
                if (brick[(z * ISO_BRICK + y) * ISO_BRICK + x] != value) return;
    iso_hgrid_coalesce(grid, cx, cy, cz, value > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE);
}

void iso_hgrid_prune(iso_hgrid *grid) {
    for (int cz = 0; cz < grid->cells[2]; cz++)
        for (int cy = 0; cy < grid->cells[1]; cy++)
            for (int cx = 0; cx < grid->cells[0]; cx++) prune_cell(grid, cx, cy, cz);
}

size_t iso_hgrid_brick_count(const iso_hgrid *grid) {
    return grid->pool.used;
}

size_t iso_hgrid_bytes(const iso_hgrid *grid) {
    const iso_brick_pool *pool = &grid->pool;
    return sizeof *grid + iso_hgrid_cell_count(grid) * sizeof *grid->cell + iso_change_log_bytes(grid->log) +
           pool->chunk_count * ISO_POOL_CHUNK * ISO_BRICK_VOXELS * sizeof(float) +
           pool->chunk_room * sizeof *pool->chunk;
}

iso_status iso_hgrid_mark_changed(iso_hgrid *grid, const int lo[3], const int hi[3], iso_error *error) {
    int last[3];
    for (int axis = 0; axis < 3; axis++) last[axis] = iso_min_int(hi[axis], grid->dims[axis] - 1);
    iso_change_log_begin(grid->log);
    return iso_change_log_add(grid->log, lo, last, error);
}

/* Returns the common entry of all cells that contain voxels of first .. last, or 0 if one has a brick or the
 * entries differ. */
static int32_t common_state(const iso_hgrid *grid, const int first[3], const int last[3]) {
    int32_t state = 0;
    for (int z = first[2] / ISO_BRICK; z <= last[2] / ISO_BRICK; z++)
        for (int y = first[1] / ISO_BRICK; y <= last[1] / ISO_BRICK; y++)
            for (int x = first[0] / ISO_BRICK; x <= last[0] / ISO_BRICK; x++) {
                int32_t cell = grid->cell[iso_hgrid_cell_index(grid, x, y, z)];
                if (cell >= 0 || (state && state != cell)) return 0;
                state = cell;
            }
    return state;
}

/* Fills cell c of `cropped` with voxels of `grid`, beginning with voxel lo + 16 c. */
static iso_status crop_cell(const iso_hgrid *grid, const int lo[3], const int c[3], iso_hgrid *cropped,
                            iso_error *error) {
    int first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = lo[axis] + c[axis] * ISO_BRICK;
        last[axis] = iso_min_int(first[axis] + ISO_BRICK, lo[axis] + cropped->dims[axis]) - 1;
    }
    int32_t state = common_state(grid, first, last);
    if (state) {
        iso_hgrid_coalesce(cropped, c[0], c[1], c[2], state);
        return ISO_OK;
    }
    float *brick;
    ISO_TRY(iso_hgrid_split(cropped, c[0], c[1], c[2], &brick, error));
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++) {
            float *row = brick + ((z - first[2]) * ISO_BRICK + y - first[1]) * ISO_BRICK;
            for (int x = first[0]; x <= last[0]; x++) row[x - first[0]] = iso_hgrid_at(grid, x, y, z);
        }
    prune_cell(cropped, c[0], c[1], c[2]);
    return ISO_OK;
}

static iso_status crop_cells(const iso_hgrid *grid, const int lo[3], iso_hgrid *cropped, iso_error *error) {
    int c[3];
    for (c[2] = 0; c[2] < cropped->cells[2]; c[2]++)
        for (c[1] = 0; c[1] < cropped->cells[1]; c[1]++)
            for (c[0] = 0; c[0] < cropped->cells[0]; c[0]++) ISO_TRY(crop_cell(grid, lo, c, cropped, error));
    return ISO_OK;
}

iso_status iso_hgrid_crop(const iso_hgrid *grid, const int lo[3], const int hi[3], iso_hgrid **out,
                          iso_error *error) {
    int dims[3];
    ISO_TRY(iso_crop_dims(grid->dims, lo, hi, dims, error));
    const iso_transform transform = iso_transform_shift(&grid->transform, lo);
    iso_hgrid *cropped = NULL;
    ISO_TRY(iso_hgrid_create(dims, grid->band, &transform, &cropped, error));
    iso_status status = crop_cells(grid, lo, cropped, error);
    if (status != ISO_OK) {
        iso_hgrid_destroy(cropped);
        return status;
    }
    *out = cropped;
    return ISO_OK;
}

iso_status iso_hgrid_copy_cells(const iso_hgrid *from, iso_hgrid *to, iso_error *error) {
    const int lo[3] = {0, 0, 0}, hi[3] = {to->dims[0] - 1, to->dims[1] - 1, to->dims[2] - 1};
    if (memcmp(from->dims, to->dims, sizeof to->dims) || from->band != to->band)
        return iso_fail(error, ISO_ERR_USAGE, "level sets of different shapes");
    ISO_TRY(iso_hgrid_mark_changed(to, lo, hi, error));
    for (int z = 0; z < to->cells[2]; z++)
        for (int y = 0; y < to->cells[1]; y++)
            for (int x = 0; x < to->cells[0]; x++) {
                int32_t state = from->cell[iso_hgrid_cell_index(from, x, y, z)];
                float *brick;
                if (state < 0) {
                    iso_hgrid_coalesce(to, x, y, z, state);
                    continue;
                }
                ISO_TRY(iso_hgrid_split(to, x, y, z, &brick, error));
                memcpy(brick, iso_hgrid_brick(from, state), ISO_BRICK_VOXELS * sizeof(float));
            }
    return ISO_OK;
}
