/* rectilinear: steps of coordinates, and interpolation. */
#include "grids/volume/rectilinear.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

void iso_rectilinear_take_cells(iso_rectilinear *r) {
    for (int axis = 0; axis < 3; axis++) {
        double *at = r->axis[axis];
        for (int i = 0; i + 1 < r->count[axis]; i++) at[i] = 0.5 * (at[i] + at[i + 1]);
        if (r->count[axis] > 1) r->count[axis]--;
    }
}

/* The smallest and largest step of an axis; false: its coordinates do not rise. */
static bool steps_of(const double *at, int count, double *least, double *most) {
    *least = HUGE_VAL;
    *most = 0;
    for (int i = 1; i < count; i++) {
        const double step = at[i] - at[i - 1];
        if (!(step > 0 && isfinite(step))) return false;
        *least = fmin(*least, step);
        *most = fmax(*most, step);
    }
    return isfinite(at[0]);
}

/* Whether coordinates lie on even steps, but for a thousandth of one, or for the rounding of floats. */
static bool is_even(const double *at, int count, double step) {
    const double noise = fmax(1e-3 * step, 2 * (double)FLT_EPSILON * fmax(fabs(at[0]), fabs(at[count - 1])));
    for (int i = 1; i < count; i++)
        if (fabs(at[i] - at[0] - i * step) > noise) return false;
    return true;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median of the steps; 0: no memory. */
static double median_step(const double *at, int count) {
    double *steps = iso_alloc((size_t)count * sizeof *steps);
    if (!steps) return 0;
    for (int i = 1; i < count; i++) steps[i - 1] = at[i] - at[i - 1];
    qsort(steps, (size_t)count - 1, sizeof *steps, compare);
    const double median = steps[(count - 1) / 2];
    iso_free(steps);
    return median;
}

/* Sets the voxels and spacing of an uneven axis: its smallest step, or the median one where that makes more
 * than four times as many voxels. */
static iso_status describe_axis(const char *path, const double *at, int count, int axis, double least,
                                iso_volume_info *info, bool *median, iso_error *error) {
    const double length = at[count - 1] - at[0];
    double step = least;
    if (length / least > 4.0 * count) {
        step = median_step(at, count);
        if (step == 0) return iso_fail_memory(error, path);
        *median = true;
    }
    const double steps = ceil(length / step * (1 - 1e-6));
    if (!(steps < INT_MAX))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its steps on axis %d, from %g on, are too uneven", path,
                        axis, least);
    info->dims[axis] = (int)steps + 1;
    info->transform.spacing[axis] = length / steps;
    return ISO_OK;
}

iso_status iso_rectilinear_describe(const char *path, const iso_rectilinear *r, iso_volume_info *info,
                                    bool *even, iso_error *error) {
    const int before[3] = {info->dims[0], info->dims[1], info->dims[2]};
    double spread = 0;
    bool median = false;
    *even = true;
    for (int axis = 0; axis < 3; axis++) {
        const double *at = r->axis[axis];
        const int count = r->count[axis];
        double least, most;
        if (!at) continue;
        if (!steps_of(at, count, &least, &most))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: its coordinates on axis %d do not rise", path, axis);
        if (count > 1) info->transform.spacing[axis] = (at[count - 1] - at[0]) / (count - 1);
        if (count < 3 || is_even(at, count, info->transform.spacing[axis])) continue;
        ISO_TRY(describe_axis(path, at, count, axis, least, info, &median, error));
        spread = fmax(spread, most / least);
        *even = false;
    }
    if (*even) return ISO_OK;
    info->type = ISO_FLOAT32;
    info->bytes = 0;
    iso_volume_note(info,
                    "resampled from %d x %d x %d voxels to the %s step on each axis (steps differ by "
                    "%.3g times)",
                    before[0], before[1], before[2], median ? "smallest or median" : "smallest", spread);
    return ISO_OK;
}

/* Of an even step along an axis: the voxel before it, and how far it is to the next one. */
typedef struct place {
    int before;
    double part;
} place;

static place *places_of(const iso_rectilinear *r, const iso_volume_info *info, int axis) {
    place *places = iso_alloc((size_t)info->dims[axis] * sizeof *places);
    const double *at = r->axis[axis];
    const int last = r->count[axis] - 1;
    if (!at) {
        for (int i = 0; places && i < info->dims[axis]; i++) places[i] = (place){i, 0};
        return places;
    }
    for (int i = 0, before = 0; places && i < info->dims[axis]; i++) {
        const double x = i == info->dims[axis] - 1 ? at[last] : at[0] + i * info->transform.spacing[axis];
        while (before + 1 < last && at[before + 1] <= x) before++;
        const double step = last ? at[before + 1] - at[before] : 1;
        places[i] = (place){before, fmin(1, fmax(0, (x - at[before]) / step))};
    }
    return places;
}

typedef struct resampling {
    const iso_grid *from;
    const iso_rgrid *to;
    place *places[3];
} resampling;

static void resample_slice(void *context, size_t z, int worker) {
    const resampling *r = context;
    const int *dims = r->to->dims, *last = iso_grid_dims(r->from);
    const place pz = r->places[2][z];
    (void)worker;
    for (int y = 0; y < dims[1]; y++) {
        const place py = r->places[1][y];
        float *row = (float *)r->to->data + y * r->to->stride_y + (ptrdiff_t)z * r->to->stride_z;
        for (int x = 0; x < dims[0]; x++) {
            const place px = r->places[0][x];
            double sum = 0;
            for (int k = 0; k < 8; k++) {
                const int at[3] = {px.before + (k & 1), py.before + (k >> 1 & 1), pz.before + (k >> 2)};
                const double weight = (k & 1 ? px.part : 1 - px.part) * (k & 2 ? py.part : 1 - py.part) *
                                      (k & 4 ? pz.part : 1 - pz.part);
                if (weight > 0 && at[0] < last[0] && at[1] < last[1] && at[2] < last[2])
                    sum += weight * (double)iso_grid_at(r->from, at[0], at[1], at[2]);
            }
            row[x] = (float)sum;
        }
    }
}

iso_status iso_rectilinear_resample(const char *path, const iso_rectilinear *r, const iso_grid *from,
                                    const iso_volume_info *info, iso_pool *pool, iso_grid *to,
                                    iso_error *error) {
    resampling job = {.from = from};
    iso_status status = iso_format_create(path, info, NULL, to, error);
    for (int axis = 0; axis < 3 && status == ISO_OK; axis++) {
        job.places[axis] = places_of(r, info, axis);
        if (!job.places[axis]) status = iso_fail_memory(error, path);
    }
    if (status == ISO_OK) {
        job.to = to->rgrid;
        iso_parallel_for(pool, (size_t)info->dims[2], resample_slice, &job);
    } else {
        iso_grid_destroy(to);
    }
    for (int axis = 0; axis < 3; axis++) iso_free(job.places[axis]);
    return status;
}

void iso_rectilinear_free(iso_rectilinear *r) {
    for (int axis = 0; axis < 3; axis++) iso_free(r->axis[axis]);
    *r = (iso_rectilinear){.count = {0, 0, 0}};
}
