/* vectors: counting and interpolating grids of vectors and tensors. */
#include "grids/vectors.h"

#include <math.h>

#include "base/memory.h"

void iso_vectors_free(iso_vectors *vectors) {
    iso_free(vectors->values);
    *vectors = (iso_vectors){.values = NULL};
}

size_t iso_vectors_count(const iso_vectors *vectors) {
    return (size_t)vectors->dims[0] * (size_t)vectors->dims[1] * (size_t)vectors->dims[2];
}

/* ---- totals */

/* The square of a vector's length, or of a tensor's Frobenius norm, to which entries beside the diagonal add
 * twice. */
static double square_of(const float *v, int components) {
    static const double weights[2][ISO_TENSOR_COMPONENTS] = {{1, 1, 1, 0, 0, 0}, {1, 2, 2, 1, 2, 1}};
    const double *weight = weights[components == ISO_TENSOR_COMPONENTS];
    double sum = 0;
    for (int k = 0; k < components; k++) sum += weight[k] * (double)v[k] * (double)v[k];
    return sum;
}

typedef struct measuring {
    const iso_vectors *vectors;
    iso_vectors_totals *slices;
} measuring;

static void measure_slice(void *context, size_t index, int worker) {
    (void)worker;
    const measuring *m = context;
    const iso_vectors *vectors = m->vectors;
    const size_t count = (size_t)vectors->dims[0] * (size_t)vectors->dims[1];
    iso_vectors_totals totals = {0};
    for (size_t i = index * count; i < (index + 1) * count; i++) {
        const double square =
            square_of(vectors->values + i * (size_t)vectors->components, vectors->components);
        totals.missing += isnan(square);
        totals.zero += square == 0;
        totals.usable += square > 0;
        if (square > totals.longest) totals.longest = square;
    }
    m->slices[index] = totals;
}

iso_status iso_vectors_measure(const iso_vectors *vectors, iso_pool *pool, iso_vectors_totals *totals,
                               iso_error *error) {
    const size_t count = (size_t)vectors->dims[2];
    measuring m = {vectors, iso_alloc(count * sizeof *m.slices)};
    if (!m.slices) return iso_fail_memory(error, "vectors");
    iso_parallel_for(pool, count, measure_slice, &m);
    *totals = (iso_vectors_totals){0};
    for (size_t i = 0; i < count; i++) {
        totals->usable += m.slices[i].usable;
        totals->zero += m.slices[i].zero;
        totals->missing += m.slices[i].missing;
        totals->longest = fmax(totals->longest, m.slices[i].longest);
    }
    totals->longest = sqrt(totals->longest);
    iso_free(m.slices);
    return ISO_OK;
}

/* ---- interpolation */

/* How far a position may lie beyond the outermost voxels, in voxels: far more than the rounding error of a
 * position that was converted from world coordinates. */
static const double TOLERANCE = 1e-6;

/* Finds the two voxels around a position on an axis, and the position's distance from the lower one; returns
 * false outside the grid. A position on the last voxel belongs to the cell before it. On an axis with one
 * voxel, both are this voxel. */
static bool split(double position, int size, int voxels[2], double *part) {
    const int last = size - 1;
    if (!(position >= -TOLERANCE && position <= last + TOLERANCE)) return false;
    position = fmin(fmax(position, 0), last);
    voxels[0] = position < last ? (int)position : last - (last > 0);
    voxels[1] = voxels[0] + (last > 0);
    *part = position - voxels[0];
    return true;
}

bool iso_vectors_sample(const iso_vectors *vectors, const double index[3], const double *along,
                        double value[3]) {
    int at[3][2];
    double part[3], corner[8][3];
    for (int axis = 0; axis < 3; axis++)
        if (!split(index[axis], vectors->dims[axis], at[axis], &part[axis])) return false;
    for (int c = 0; c < 8; c++) {
        const float *v = iso_vectors_at(vectors, at[0][c & 1], at[1][c >> 1 & 1], at[2][c >> 2]);
        double sign = 1;
        if (along && (double)v[0] * along[0] + (double)v[1] * along[1] + (double)v[2] * along[2] < 0)
            sign = -1;
        for (int k = 0; k < 3; k++) corner[c][k] = sign * (double)v[k];
    }
    for (int axis = 0, half = 4; axis < 3; axis++, half /= 2)
        for (int c = 0; c < half; c++)
            for (int k = 0; k < 3; k++)
                corner[c][k] = corner[2 * c][k] + part[axis] * (corner[2 * c + 1][k] - corner[2 * c][k]);
    for (int k = 0; k < 3; k++) value[k] = corner[0][k];
    return !isnan(value[0]);
}
