/* Implements copy-on-write snapshots of a level set. iso_snapshot_copy copies the cells in order. When the
 * writer is about to change a cell that iso_snapshot_copy has not reached yet, the writer copies this cell
 * first. A mutex keeps the two from copying the same cell at the same time. */
#include "sculpt/field/snapshot.h"

#include <pthread.h>
#include <string.h>

#include "base/memory.h"

/* Cells between two reports of progress. */
enum { PROGRESS_CELLS = 4096 };

struct iso_snapshot {
    int dims[3], cells[3];
    size_t count;
    float band;
    iso_transform transform;
    int32_t *state; /* by cell: the grid's entry when the snapshot was made */
    float **chunk;  /* copy of the brick pool's table, which moves when the pool grows; chunks do not move */
    pthread_mutex_t mutex;
    /* protected by the mutex: */
    float **copy;  /* by cell: values that the writer preserved; NULL: the grid's brick is unchanged, or
                      iso_snapshot_copy has copied the cell */
    size_t copies; /* number of preserved cells */
    size_t next;   /* iso_snapshot_copy has copied all cells before this one */
    bool failed;   /* out of memory: some old values are lost */
};

enum { BRICK_BYTES = ISO_BRICK_VOXELS * sizeof(float) };

iso_status iso_snapshot_create(const iso_hgrid *grid, iso_snapshot **out, iso_error *error) {
    iso_snapshot *snapshot = iso_alloc_zero(1, sizeof *snapshot);
    if (!snapshot) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of the field");
    pthread_mutex_init(&snapshot->mutex, NULL);
    memcpy(snapshot->dims, grid->dims, sizeof snapshot->dims);
    memcpy(snapshot->cells, grid->cells, sizeof snapshot->cells);
    snapshot->count = iso_hgrid_cell_count(grid);
    snapshot->band = grid->band;
    snapshot->transform = grid->transform;
    snapshot->state = iso_alloc(snapshot->count * sizeof *snapshot->state);
    snapshot->copy = iso_alloc_zero(snapshot->count, sizeof *snapshot->copy);
    const size_t chunks = grid->pool.chunk_count;
    snapshot->chunk = iso_alloc((chunks + 1) * sizeof *snapshot->chunk);
    if (!snapshot->state || !snapshot->copy || !snapshot->chunk) {
        iso_snapshot_destroy(snapshot);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of the field");
    }
    memcpy(snapshot->state, grid->cell, snapshot->count * sizeof *snapshot->state);
    if (chunks) memcpy(snapshot->chunk, grid->pool.chunk, chunks * sizeof *snapshot->chunk);
    *out = snapshot;
    return ISO_OK;
}

void iso_snapshot_destroy(iso_snapshot *snapshot) {
    if (!snapshot) return;
    for (size_t i = 0; snapshot->copies; i++) {
        snapshot->copies -= snapshot->copy[i] != NULL;
        iso_free(snapshot->copy[i]);
    }
    iso_free(snapshot->copy);
    iso_free(snapshot->state);
    iso_free(snapshot->chunk);
    pthread_mutex_destroy(&snapshot->mutex);
    iso_free(snapshot);
}

static const float *brick_of(const iso_snapshot *snapshot, size_t cell) {
    const int32_t number = snapshot->state[cell];
    return snapshot->chunk[number / ISO_POOL_CHUNK] + (size_t)(number % ISO_POOL_CHUNK) * ISO_BRICK_VOXELS;
}

void iso_snapshot_preserve(iso_snapshot *snapshot, uint32_t cell) {
    if (snapshot->state[cell] < 0) return;
    pthread_mutex_lock(&snapshot->mutex);
    if (cell >= snapshot->next && !snapshot->copy[cell]) {
        snapshot->copy[cell] = iso_alloc(BRICK_BYTES);
        if (snapshot->copy[cell]) memcpy(snapshot->copy[cell], brick_of(snapshot, cell), BRICK_BYTES);
        snapshot->copies += snapshot->copy[cell] != NULL;
        snapshot->failed |= !snapshot->copy[cell];
    }
    pthread_mutex_unlock(&snapshot->mutex);
}

/* Copies the values that a cell had when the snapshot was made. Returns false if some values are lost,
 * because there was no memory to preserve them. */
static bool copy_brick(iso_snapshot *snapshot, size_t cell, float *brick) {
    pthread_mutex_lock(&snapshot->mutex);
    const float *values = snapshot->copy[cell] ? snapshot->copy[cell] : brick_of(snapshot, cell);
    memcpy(brick, values, BRICK_BYTES);
    snapshot->copies -= snapshot->copy[cell] != NULL;
    iso_free(snapshot->copy[cell]);
    snapshot->copy[cell] = NULL;
    snapshot->next = cell + 1;
    const bool sound = !snapshot->failed;
    pthread_mutex_unlock(&snapshot->mutex);
    return sound;
}

static iso_status copy_cells(iso_snapshot *snapshot, const iso_progress *progress, iso_hgrid *grid,
                             iso_error *error) {
    for (size_t cell = 0; cell < snapshot->count; cell++) {
        if (cell % PROGRESS_CELLS == 0)
            ISO_TRY(iso_progress_tell(progress, "the field", (double)cell / (double)snapshot->count, error));
        grid->cell[cell] = snapshot->state[cell] < 0 ? snapshot->state[cell] : ISO_CELL_OUTSIDE;
        if (snapshot->state[cell] < 0) continue;
        const size_t x = (size_t)snapshot->cells[0], y = (size_t)snapshot->cells[1];
        float *brick;
        ISO_TRY(
            iso_hgrid_split(grid, (int)(cell % x), (int)(cell / x % y), (int)(cell / x / y), &brick, error));
        if (!copy_brick(snapshot, cell, brick))
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of the field");
    }
    return ISO_OK;
}

/* Makes iso_snapshot_preserve copy nothing from now on. */
static void stop_preserving(iso_snapshot *snapshot) {
    pthread_mutex_lock(&snapshot->mutex);
    snapshot->next = snapshot->count;
    pthread_mutex_unlock(&snapshot->mutex);
}

iso_status iso_snapshot_copy(iso_snapshot *snapshot, const iso_progress *progress, iso_hgrid **out,
                             iso_error *error) {
    iso_hgrid *grid = NULL;
    iso_status status = iso_hgrid_create(snapshot->dims, snapshot->band, &snapshot->transform, &grid, error);
    if (status == ISO_OK) status = copy_cells(snapshot, progress, grid, error);
    stop_preserving(snapshot);
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}
