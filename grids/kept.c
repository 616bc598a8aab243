/* kept: slabs of slices, one task each. A voxel is a corner of a crossed cell, or one of its neighbours is:
 * that depends on cells of four layers, which each slab finds again at its ends. */
#include "grids/kept.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "grids/threshold.h"

enum { SLAB = 16 };

typedef struct job {
    const iso_rgrid *grid;
    float low, high;     /* thresholds, stored: a voxel is between them if low <= v < high */
    double below, above; /* what replaces others */
    char *out;
    size_t plane; /* voxels of a slice */
    _Atomic size_t kept;
    _Atomic bool failed;
} job;

/* Of a voxel or the corners of a cell. */
enum { BELOW_HIGH = 1, AT_LOW = 2, NOT_FINITE = 4, CROSSED = BELOW_HIGH | AT_LOW };

static void classify(const job *j, int z, uint8_t *classes) {
    const int *dims = j->grid->dims;
    for (int y = 0; y < dims[1]; y++)
        for (int x = 0; x < dims[0]; x++) {
            const float v = iso_rgrid_at(j->grid, x, y, z);
            classes[(size_t)y * (size_t)dims[0] + (size_t)x] =
                (uint8_t)((v < j->high ? BELOW_HIGH : 0) | (v >= j->low ? AT_LOW : 0) |
                          (isfinite(v) ? 0 : NOT_FINITE));
        }
}

/* Marks in `corners` of two slices the corners of the crossed cells between them. */
static void mark_cells(const job *j, const uint8_t *lower, const uint8_t *upper, uint8_t *lower_corners,
                       uint8_t *upper_corners) {
    const int nx = j->grid->dims[0], ny = j->grid->dims[1];
    for (int y = 0; y + 1 < ny; y++)
        for (int x = 0; x + 1 < nx; x++) {
            const size_t i[4] = {(size_t)y * (size_t)nx + (size_t)x, (size_t)y * (size_t)nx + (size_t)x + 1,
                                 (size_t)(y + 1) * (size_t)nx + (size_t)x,
                                 (size_t)(y + 1) * (size_t)nx + (size_t)x + 1};
            int any = 0;
            for (int k = 0; k < 4; k++) any |= lower[i[k]] | upper[i[k]];
            for (int k = 0; k < 4 && any == CROSSED; k++) lower_corners[i[k]] = upper_corners[i[k]] = 1;
        }
}

static bool is_near(const job *j, const uint8_t *corners[3], int x, int y, size_t i) {
    const int nx = j->grid->dims[0], ny = j->grid->dims[1];
    return corners[1][i] || corners[0][i] || corners[2][i] || (x > 0 && corners[1][i - 1]) ||
           (x + 1 < nx && corners[1][i + 1]) || (y > 0 && corners[1][i - (size_t)nx]) ||
           (y + 1 < ny && corners[1][i + (size_t)nx]);
}

static void store(const job *j, size_t at, double value) {
    switch (j->grid->type) {
    case ISO_UINT8:
        ((uint8_t *)j->out)[at] = (uint8_t)value;
        break;
    case ISO_INT16:
        ((int16_t *)j->out)[at] = (int16_t)value;
        break;
    case ISO_UINT16:
        ((uint16_t *)j->out)[at] = (uint16_t)value;
        break;
    default:
        ((float *)j->out)[at] = (float)value;
    }
}

/* Writes slice z. corners: of slices z - 1, z and z + 1. */
static void write_slice(job *j, int z, const uint8_t *corners[3]) {
    const int *dims = j->grid->dims;
    size_t kept = 0, i = 0;
    for (int y = 0; y < dims[1]; y++)
        for (int x = 0; x < dims[0]; x++, i++) {
            const float v = iso_rgrid_at(j->grid, x, y, z);
            const bool near = is_near(j, corners, x, y, i);
            kept += near;
            store(j, (size_t)z * j->plane + i,
                  near || !isfinite(v) || (v >= j->low && v < j->high) ? (double)v
                  : v < j->low                                         ? j->below
                                                                       : j->above);
        }
    j->kept += kept;
}

/* iso_task: slices index * SLAB on. The corners of slice k lie at corners + k % 4; all of them are known when
 * the cells on both of its sides are marked. */
static void copy_slab(void *context, size_t index, int worker) {
    (void)worker;
    job *j = context;
    const int nz = j->grid->dims[2], begin = (int)index * SLAB, end = begin + SLAB < nz ? begin + SLAB : nz;
    uint8_t *block = iso_alloc(6 * j->plane), *classes[2] = {block, block ? block + j->plane : NULL};
    if (!block) {
        j->failed = true;
        return;
    }
    uint8_t *corners = block + 2 * j->plane;
    memset(corners, 0, 4 * j->plane);
    /* Slice z is written when the corners of z + 1, and so the cells up to z + 2, are known. */
    for (int z = begin - 2; z < end + 2; z++) {
        uint8_t *upper = corners + (size_t)((z + 4) & 3) * j->plane;
        memset(upper, 0, j->plane); /* of slice z - 4, which is no longer needed */
        if (z >= 0 && z < nz) classify(j, z, classes[z & 1]);
        if (z > 0 && z > begin - 2 && z < nz)
            mark_cells(j, classes[(z - 1) & 1], classes[z & 1], corners + (size_t)((z + 3) & 3) * j->plane,
                       upper);
        const uint8_t *around[3];
        for (int k = 0; k < 3; k++) around[k] = corners + (size_t)((z + 1 + k) & 3) * j->plane;
        if (z - 2 >= begin) write_slice(j, z - 2, around);
    }
    iso_free(block);
}

/* The least value of the type at or above a threshold, or the greatest below it. */
static double value_at(iso_type type, float threshold) {
    return type == ISO_FLOAT32 ? threshold : iso_integer_threshold(threshold);
}
static double value_below(iso_type type, float threshold) {
    return type == ISO_FLOAT32 ? nextafterf(threshold, -INFINITY) : iso_integer_threshold(threshold) - 1;
}

iso_status iso_kept_copy(const iso_rgrid *grid, double low, double high, void *out, size_t *kept,
                         iso_pool *pool, iso_error *error) {
    const iso_grid any = {.rgrid = (iso_rgrid *)grid};
    job j = {.grid = grid,
             .low = iso_threshold_of(&any, low).isovalue_ceil,
             .high = iso_threshold_of(&any, high).isovalue_ceil,
             .out = out,
             .plane = (size_t)grid->dims[0] * (size_t)grid->dims[1]};
    j.below = value_below(grid->type, j.low);
    j.above = value_at(grid->type, j.high);
    iso_parallel_for(pool, ((size_t)grid->dims[2] + SLAB - 1) / SLAB, copy_slab, &j);
    if (kept) *kept = j.kept;
    return j.failed ? iso_fail(error, ISO_ERR_NOMEM, "out of memory for the voxels of a page") : ISO_OK;
}
