#include "sculpt/session/hold.h"

#include <pthread.h>
#include <string.h>

#include "base/memory.h"

/* Cells between two looks at the progress. */
enum { TELL = 4096 };

struct iso_hold {
    int dims[3], cells[3];
    size_t count;
    float band;
    iso_transform transform;
    int32_t *state; /* by cell, as it was */
    float **chunk;  /* the pool's table, which moves when the pool grows; chunks do not */
    pthread_mutex_t mutex;
    /* under the mutex */
    float **copy;        /* by cell; NULL: the grid's brick is as it was, or was taken */
    size_t copies, next; /* `next`: cells before this one were taken */
    bool failed;
};

enum { BRICK_BYTES = ISO_BRICK_VOXELS * sizeof(float) };

iso_status iso_hold_create(const iso_hgrid *grid, iso_hold **out, iso_error *error) {
    iso_hold *hold = iso_alloc_zero(1, sizeof *hold);
    if (!hold) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of the field");
    pthread_mutex_init(&hold->mutex, NULL);
    memcpy(hold->dims, grid->dims, sizeof hold->dims);
    memcpy(hold->cells, grid->cells, sizeof hold->cells);
    hold->count = iso_hgrid_cell_count(grid);
    hold->band = grid->band;
    hold->transform = grid->transform;
    hold->state = iso_alloc(hold->count * sizeof *hold->state);
    hold->copy = iso_alloc_zero(hold->count, sizeof *hold->copy);
    const size_t chunks = grid->pool.chunk_count;
    hold->chunk = iso_alloc((chunks + 1) * sizeof *hold->chunk);
    if (!hold->state || !hold->copy || !hold->chunk) {
        iso_hold_destroy(hold);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of the field");
    }
    memcpy(hold->state, grid->cell, hold->count * sizeof *hold->state);
    if (chunks) memcpy(hold->chunk, grid->pool.chunk, chunks * sizeof *hold->chunk);
    *out = hold;
    return ISO_OK;
}

void iso_hold_destroy(iso_hold *hold) {
    if (!hold) return;
    for (size_t i = 0; hold->copies; i++) {
        hold->copies -= hold->copy[i] != NULL;
        iso_free(hold->copy[i]);
    }
    iso_free(hold->copy);
    iso_free(hold->state);
    iso_free(hold->chunk);
    pthread_mutex_destroy(&hold->mutex);
    iso_free(hold);
}

static const float *brick_of(const iso_hold *hold, size_t cell) {
    const int32_t number = hold->state[cell];
    return hold->chunk[number / ISO_POOL_CHUNK] + (size_t)(number % ISO_POOL_CHUNK) * ISO_BRICK_VOXELS;
}

void iso_hold_keep(iso_hold *hold, uint32_t cell) {
    if (hold->state[cell] < 0) return;
    pthread_mutex_lock(&hold->mutex);
    if (cell >= hold->next && !hold->copy[cell]) {
        hold->copy[cell] = iso_alloc(BRICK_BYTES);
        if (hold->copy[cell]) memcpy(hold->copy[cell], brick_of(hold, cell), BRICK_BYTES);
        hold->copies += hold->copy[cell] != NULL;
        hold->failed |= !hold->copy[cell];
    }
    pthread_mutex_unlock(&hold->mutex);
}

/* The values as they were; false: they are lost. */
static bool take_brick(iso_hold *hold, size_t cell, float *brick) {
    pthread_mutex_lock(&hold->mutex);
    const float *values = hold->copy[cell] ? hold->copy[cell] : brick_of(hold, cell);
    memcpy(brick, values, BRICK_BYTES);
    hold->copies -= hold->copy[cell] != NULL;
    iso_free(hold->copy[cell]);
    hold->copy[cell] = NULL;
    hold->next = cell + 1;
    const bool sound = !hold->failed;
    pthread_mutex_unlock(&hold->mutex);
    return sound;
}

static iso_status take_cells(iso_hold *hold, const iso_progress *progress, iso_hgrid *grid,
                             iso_error *error) {
    for (size_t cell = 0; cell < hold->count; cell++) {
        if (cell % TELL == 0)
            ISO_TRY(iso_progress_tell(progress, "the field", (double)cell / (double)hold->count, error));
        grid->cell[cell] = hold->state[cell] < 0 ? hold->state[cell] : ISO_CELL_OUTSIDE;
        if (hold->state[cell] < 0) continue;
        const size_t x = (size_t)hold->cells[0], y = (size_t)hold->cells[1];
        float *brick;
        ISO_TRY(
            iso_hgrid_split(grid, (int)(cell % x), (int)(cell / x % y), (int)(cell / x / y), &brick, error));
        if (!take_brick(hold, cell, brick))
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of the field");
    }
    return ISO_OK;
}

/* Nothing is kept any more. */
static void finish(iso_hold *hold) {
    pthread_mutex_lock(&hold->mutex);
    hold->next = hold->count;
    pthread_mutex_unlock(&hold->mutex);
}

iso_status iso_hold_take(iso_hold *hold, const iso_progress *progress, iso_hgrid **out, iso_error *error) {
    iso_hgrid *grid = NULL;
    iso_status status = iso_hgrid_create(hold->dims, hold->band, &hold->transform, &grid, error);
    if (status == ISO_OK) status = take_cells(hold, progress, grid, error);
    finish(hold);
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}
