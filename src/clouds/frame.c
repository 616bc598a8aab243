/* frame: finds the middle of the points by their sorted coordinates. */
#include "clouds/frame.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/numbers.h"

enum { SAMPLES = 50000, LARGEST = 3 }; /* points that are looked at; how many times as large a box may be */
static const double LEFT_OUT = 0.02;   /* part of the coordinates at each end that is not in the middle */

static double *coordinate(iso_vec3 *v, int axis) {
    return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z;
}

/* The box of the middle coordinates. `values` has room for SAMPLES numbers of each axis. */
static iso_box find_middle(const iso_point_source *source, double *values) {
    const size_t step = source->count / SAMPLES + 1;
    size_t count = 0;
    iso_vec3 lo = source->origin, hi = source->origin;
    for (size_t i = 0; i < source->count; i += step, count++) {
        float p[3];
        iso_point_column_get(&source->positions, i, p);
        for (int axis = 0; axis < 3; axis++) values[axis * SAMPLES + count] = (double)p[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        double *sorted = values + axis * SAMPLES;
        qsort(sorted, count, sizeof *sorted, iso_compare_doubles);
        const size_t out = (size_t)(LEFT_OUT * (double)count);
        *coordinate(&lo, axis) += sorted[out];
        *coordinate(&hi, axis) += sorted[count - 1 - out];
    }
    return (iso_box){lo, hi};
}

static double diagonal_of(const iso_box *box) {
    return iso_vec3_length(iso_vec3_sub(box->hi, box->lo));
}

static iso_vec3 place_of(const iso_point_source *source, const float p[3]) {
    return iso_vec3_add(source->origin, iso_vec3_make((double)p[0], (double)p[1], (double)p[2]));
}

/* The box of the points that are at most half its diagonal away from the middle. */
static void frame_middle(const iso_point_source *source, const iso_box *middle, iso_box *box,
                         size_t *outside) {
    const double reach = diagonal_of(middle) / 2;
    const iso_vec3 more = {reach, reach, reach};
    const iso_box around = {iso_vec3_sub(middle->lo, more), iso_vec3_add(middle->hi, more)};
    *box = iso_box_empty();
    *outside = 0;
    for (size_t i = 0; i < source->count; i++) {
        float position[3];
        iso_point_column_get(&source->positions, i, position);
        const iso_vec3 p = place_of(source, position);
        if (iso_position_is_inside(p, &around))
            iso_box_add(box, p);
        else
            ++*outside;
    }
}

iso_status iso_cloud_frame(const iso_point_source *source, const iso_point_survey *survey, iso_box *box,
                           size_t *outside, iso_error *error) {
    double *values = iso_alloc(3 * SAMPLES * sizeof *values);
    if (!values) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a sample of the points");
    const iso_box middle = find_middle(source, values);
    iso_free(values);
    *box = (iso_box){place_of(source, survey->lo), place_of(source, survey->hi)};
    *outside = 0;
    if (diagonal_of(&middle) > 0 && diagonal_of(box) > LARGEST * diagonal_of(&middle))
        frame_middle(source, &middle, box, outside);
    return ISO_OK;
}
