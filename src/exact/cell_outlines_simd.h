/* cell_outlines_simd: prepares large cells. Three pairs of lines (iso_exact_outline) bound the pixels of a
 * row whose rays can meet the surface in the cell. Where a cell covers hundreds of pixels, iso_exact_rays
 * holds the linear maps from pixels to rays, and whether the cell is flat. */
#ifndef ISO_EXACT_CELL_OUTLINES_SIMD_H
#define ISO_EXACT_CELL_OUTLINES_SIMD_H

#include "exact/kernel_simd.h"
#include "exact/ray_cell_simd.h"

/* A vector of cells and their rays; see iso_exact_rays. Components 0 .. 2 are u, v, w. Component 3 is the
 * linear part of the field, as if it were a fourth axis: on the surface it differs from -field[0] by at most
 * half[3]. */
typedef struct ex_rays {
    vf field[8], place[2], scale, half[4];
    vf along[4];          /* direction of the ray through the reference point, per mm of depth */
    vf most[4];           /* upper bound of the magnitude of any ray's direction */
    vf right[4], down[4]; /* change of a ray's position at the reference depth per pixel to the right, down */
    vf turn;              /* change of a ray's direction per change of that position */
} ex_rays;

/* Computes the rays of the vector of cells from number i on. */
ISO_INLINE void load_rays(const iso_exact_projection *projection, const iso_exact_scratch *scratch, int i,
                          ex_rays *r) {
    const iso_exact_octant_projection *octant_projection = &scratch->octant_projection;
    /* a bound, with margin, of the surface's distance in depth from the reference point, mm */
    const float depth = (float)(2 * projection->half_depth);
    int32_t index[ISO_LANES];
    vf number[16];
    v_storei(index, v_lanes() * RECORD_FLOATS);
    v_load4(scratch->record[i].field, index, 4, number);
    for (int k = 0; k < 8; k++) r->field[k] = number[k];
    for (int k = 0; k < 2; k++) r->place[k] = number[8 + k];
    r->scale = number[10];
    r->turn = projection->per_focal / r->scale;
    const vf sx = (r->place[0] + octant_projection->off_axis[0]) * projection->per_focal,
             sy = (r->place[1] + octant_projection->off_axis[1]) * projection->per_focal;
    const vf *k = r->field, *h = r->half;
    r->along[3] = r->most[3] = r->right[3] = r->down[3] = v_set(0);
    for (int axis = 0; axis < 3; axis++) {
        const float right = projection->ray[0][axis], down = projection->ray[1][axis];
        r->half[axis] = number[12 + axis] + 1e-4f;
        r->right[axis] = r->scale * right;
        r->down[axis] = r->scale * down;
        r->along[axis] = projection->ray[2][axis] + (sx * right + sy * down);
        const vf other = 1.1f * r->turn * (v_abs(r->along[axis]) * depth + 2);
        r->most[axis] = v_abs(r->along[axis]) + other;
        r->right[3] += k[1 + axis] * r->right[axis];
        r->down[3] += k[1 + axis] * r->down[axis];
        r->along[3] += k[1 + axis] * r->along[axis];
        r->most[3] += v_abs(k[1 + axis]) * other;
    }
    r->most[3] += v_abs(r->along[3]);
    r->half[3] = 1.001f * ((v_abs(k[4]) * h[0] * h[1] + v_abs(k[5]) * h[1] * h[2]) +
                           (v_abs(k[6]) + v_abs(k[7]) * h[1]) * (h[0] * h[2])) +
                 (1e-6f * v_abs(k[0]) + 1e-5f * (v_abs(k[1]) + v_abs(k[2]) + v_abs(k[3]))); /* rounding */
}

/* Sets the pairs of lines that bound a cell's pixels. Along a ray, the position on an axis and the linear
 * part of the field are linear in depth. Eliminating the depth leaves a combination of both that is linear in
 * the pixel's position, and that the cell's extent on the axis and the bound of the linear part on the
 * surface bound: two parallel lines in the picture, for each axis. (The same for two axes would bound the
 * pixels whose rays meet the cell; of the pixels within these lines it would leave out one of a hundred.) */
ISO_INLINE void set_outline(const ex_rays *r, iso_exact_outline *outline) {
    enum { STEP = sizeof(iso_exact_outline) / sizeof(float) };
    const vf zero = v_set(0), *a = r->along, along = a[3] - r->turn * r->field[0];
    vf slope[4] = {zero, zero, zero, zero}, low[4] = {zero, zero, zero, zero},
       high[4] = {zero, zero, zero, zero};
    for (int n = 0; n < ISO_EXACT_LINES; n++) {
        const vf x = along * r->right[n] - a[n] * r->right[3], y = along * r->down[n] - a[n] * r->down[3],
                 most = r->half[n] * r->most[3] + r->half[3] * r->most[n];
        /* a line that is nearly parallel to the rows is left out, because rounding would move its ends far */
        const vf least = 1e-2f * (v_abs(along) * (v_abs(r->right[n]) + v_abs(r->down[n])) +
                                  v_abs(a[n]) * (v_abs(r->right[3]) + v_abs(r->down[3])));
        const vm cuts = v_lt(least, v_abs(x));
        const vf by = 1 / x, middle = a[n] * r->field[0] * by, half = most * v_abs(by);
        slope[n] = v_select(cuts, -(y * by), zero);
        low[n] = v_select(cuts, middle - half, v_set(-1e8f));
        high[n] = v_select(cuts, middle + half, v_set(1e8f));
    }
    v_store4(outline->slope, STEP, slope);
    v_store4(outline->low, STEP, low);
    v_store4(outline->high, STEP, high);
}

/* Sets `rays` of a vector of cells, with the decision whether each is flat. A cell is flat if, in the box
 * that Newton's method can reach, the field's slope along rays keeps its sign and changes so little that the
 * method converges (each step, also one with the slope of the first step, leaves less than 5/8 of the
 * distance to the root), and if the slope is large enough for roots to be exact. */
ISO_INLINE void set_ray_maps(const ex_rays *r, vi flags, iso_exact_rays *rays) {
    enum { STEP = sizeof(iso_exact_rays) / sizeof(float) };
    const vf *k = r->field, *a = r->along, *most = r->most, zero = v_set(0), one = v_set(1);
    const vf k4 = v_abs(k[4]), k5 = v_abs(k[5]), k6 = v_abs(k[6]), k7 = v_abs(k[7]);
    const vf largest = v_max(v_max(most[0], most[1]), most[2]);
    const vf least_rate = (v_abs(a[3]) + v_abs(a[3])) - most[3];
    const vf reach = r->half[3] / least_rate + 1e-4f / largest;
    vm fits = v_and(v_eqi(flags, v_seti(0)), v_lt(zero, least_rate));
    vf far[3], other[3], sum = zero; /* far: half extents of the box that Newton's method stays in */
    for (int i = 0; i < 3; i++) {
        far[i] = r->half[i] + reach * most[i];
        fits = v_and(fits, v_le(far[i], v_set(2)));
        other[i] = most[i] - v_abs(a[i]);
    }
    for (int i = 0; i < 8; i++) sum += v_abs(k[i]);
    const vf change =
        (v_abs(a[1] * k[4] + a[2] * k[6]) + (other[1] * k4 + other[2] * k6)) * far[0] +
        (v_abs(a[0] * k[4] + a[2] * k[5]) + (other[0] * k4 + other[2] * k5)) * far[1] +
        (v_abs(a[1] * k[5] + a[0] * k[6]) + (other[1] * k5 + other[0] * k6)) * far[2] +
        k7 * (most[0] * (far[1] * far[2]) + most[1] * (far[0] * far[2]) + most[2] * (far[0] * far[1]));
    const vf slope = least_rate - change;
    const vf bend = 2 * ((k4 + k7 * far[2]) * (most[0] * most[1]) + (k5 + k7 * far[0]) * (most[1] * most[2]) +
                         (k6 + k7 * far[1]) * (most[0] * most[2]));
    fits = v_and(fits, v_and(v_le(bend * reach, 0.5f * slope), v_lt(0.04f * sum * largest, slope)));
    const vf first[4] = {r->right[0], r->right[1], r->right[2], r->turn},
             second[4] = {r->down[0], r->down[1], r->down[2], reach}, third[4] = {a[0], a[1], a[2], a[3]},
             fourth[4] = {5e-6f / largest, v_select(fits, one, zero), zero, zero};
    v_store4(rays->right, STEP, first);
    v_store4(rays->down, STEP, second);
    v_store4(rays->along, STEP, third);
    v_store4(&rays->close, STEP, fourth);
}

/* Sets `outline`, and `rays` where they are needed, of an octant's cells. */
ISO_STEP static void outline_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    for (int i = 0; i < scratch->octant->cells; i += ISO_LANES) {
        ex_rays rays;
        load_rays(projection, scratch, i, &rays);
        set_outline(&rays, &scratch->outline[i]);
        if (scratch->outlined) set_ray_maps(&rays, v_loadi(scratch->flags + i), &scratch->rays[i]);
    }
}

/* For ISO_LANES rows from `y` on: the first and the last of the 64 pixels from `x` on whose rays can meet the
 * surface in a cell, 0 .. 63. A row without such pixels gets first = 63 and last = 0. */
ISO_INLINE void row_ends(const iso_exact_scratch *scratch, int cell, int x, int y, int32_t *first,
                         int32_t *last) {
    const iso_exact_outline *outline = &scratch->outline[cell];
    const float *place = scratch->record[cell].place;
    const int *origin = scratch->octant_projection.origin;
    const vf row = v_to_float(v_lanes() + (y - origin[1])) - place[1];
    const float shift = place[0] - (float)(x - origin[0]);
    vf low = v_set(-1e8f), high = v_set(1e8f);
    for (int n = 0; n < ISO_EXACT_LINES; n++) {
        const vf middle = outline->slope[n] * row;
        low = v_max(outline->low[n] + middle, low);
        high = v_min(outline->high[n] + middle, high);
    }
    low = v_min(v_max(low + (shift - 0.05f), v_set(0)), v_set(64));
    high = v_max(v_min(high + (shift + 0.05f), v_set(63)), v_set(-1));
    const vi from = -v_floor(-low), to = v_floor(high);
    const vm none = v_lti(to, from);
    v_storei(first, v_selecti(none, v_seti(63), from));
    v_storei(last, v_selecti(none, v_seti(0), to));
}

/* The pixels first .. last of 64, as row_ends sets them, as bits. */
ISO_INLINE uint64_t pixels_between(int32_t first, int32_t last) {
    return ~(uint64_t)0 << first & ~(uint64_t)0 >> (63 - last);
}

#endif
