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

/* The box of the middle coordinates. `values` has room for SAMPLES numbers. */
static iso_box find_middle(const iso_glyphs *glyphs, double *values) {
    const size_t step = glyphs->count / SAMPLES + 1;
    iso_vec3 lo = glyphs->origin, hi = glyphs->origin;
    for (int axis = 0; axis < 3; axis++) {
        size_t count = 0;
        for (size_t i = 0; i < glyphs->count; i += step) values[count++] = (double)glyphs->positions[i][axis];
        qsort(values, count, sizeof *values, iso_compare_doubles);
        const size_t out = (size_t)(LEFT_OUT * (double)count);
        *coordinate(&lo, axis) += values[out];
        *coordinate(&hi, axis) += values[count - 1 - out];
    }
    return (iso_box){lo, hi};
}

static double diagonal_of(const iso_box *box) {
    return iso_vec3_length(iso_vec3_sub(box->hi, box->lo));
}

/* The box of the points that are at most half its diagonal away from the middle. */
static void frame_middle(const iso_glyphs *glyphs, const iso_box *middle, iso_box *box, size_t *outside) {
    const double reach = diagonal_of(middle) / 2;
    const iso_vec3 more = {reach, reach, reach};
    const iso_box around = {iso_vec3_sub(middle->lo, more), iso_vec3_add(middle->hi, more)};
    *box = iso_box_empty();
    *outside = 0;
    for (size_t i = 0; i < glyphs->count; i++) {
        if (iso_glyph_is_inside(glyphs, i, &around))
            iso_box_add(box, iso_glyph_position(glyphs, i));
        else
            ++*outside;
    }
}

iso_status iso_cloud_frame(const iso_glyphs *glyphs, iso_box *box, size_t *outside, iso_error *error) {
    double *values = iso_alloc(SAMPLES * sizeof *values);
    if (!values) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a sample of the points");
    const iso_box middle = find_middle(glyphs, values);
    iso_free(values);
    *box = iso_glyphs_bounds(glyphs);
    *outside = 0;
    if (diagonal_of(&middle) > 0 && diagonal_of(box) > LARGEST * diagonal_of(&middle))
        frame_middle(glyphs, &middle, box, outside);
    return ISO_OK;
}
