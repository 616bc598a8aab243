/* caps_kernel: vectors of doubles, half as many as floats. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/kernel.h"
#include "scene/caps_kernel.h"

#if ISO_LANES == 8
#include <immintrin.h>
#endif

enum { LANES = ISO_LANES / 2 };

typedef double vd __attribute__((vector_size(8 * LANES)));
typedef int64_t vl __attribute__((vector_size(8 * LANES)));
typedef int32_t vh __attribute__((vector_size(4 * LANES)));
typedef uint32_t vu __attribute__((vector_size(4 * LANES)));

ISO_INLINE vd set(double value) {
    return value - (vd){0};
}

ISO_INLINE void store(double *to, vd value) {
    memcpy(to, &value, sizeof value);
}

ISO_INLINE vd choose(vl mask, vd a, vd b) {
    return (vd)(((vl)a & mask) | ((vl)b & ~mask));
}

ISO_INLINE vd at_columns(const iso_cap_linear *l, vd x) {
    return set(l->first) + x * set(l->next);
}

/* Whole numbers as doubles. (The compiler's own conversion takes four instructions with AVX2.) */
ISO_INLINE vd real(vh whole) {
#if ISO_LANES == 8
    return (vd)_mm256_cvtepi32_pd((__m128i)whole);
#else
    return __builtin_convertvector(whole, vd);
#endif
}

/* Loads two neighbours along x of all lanes. `type` is a constant; the first voxels, in bytes. */
ISO_INLINE void load_pairs(iso_type type, const char *const voxel[LANES], ptrdiff_t step, vd pair[2]) {
    typedef uint16_t vb __attribute__((vector_size(2 * LANES)));
    typedef float vs __attribute__((vector_size(4 * LANES)));
    if (type == ISO_UINT8) {
        vb both;
        for (int lane = 0; lane < LANES; lane++) {
            const uint8_t *v = (const uint8_t *)voxel[lane] + step;
            both[lane] = (uint16_t)(v[0] | v[1] << 8);
        }
        const vh wide = __builtin_convertvector(both, vh);
        pair[0] = real(wide & 255);
        pair[1] = real(wide >> 8);
    } else if (type == ISO_FLOAT32) {
        vs first, second;
        for (int lane = 0; lane < LANES; lane++) {
            const float *v = (const float *)voxel[lane] + step;
            first[lane] = v[0];
            second[lane] = v[1];
        }
        pair[0] = __builtin_convertvector(first, vd);
        pair[1] = __builtin_convertvector(second, vd);
    } else {
        vh both;
        for (int lane = 0; lane < LANES; lane++) {
            const uint16_t *v = (const uint16_t *)voxel[lane] + step;
            both[lane] = (int32_t)(v[0] | (uint32_t)v[1] << 16);
        }
        const vh high = both >> 16;
        pair[0] = real(type == ISO_INT16 ? (vh)((vh)((vu)both << 16) >> 16) : both & 0xffff);
        pair[1] = real(type == ISO_INT16 ? high : high & 0xffff);
    }
}

/* Loads the corners of the cells of all lanes, the least coordinates first, x fastest. */
ISO_INLINE void load_corners(const iso_rgrid *grid, iso_type type, const int32_t cell[3][LANES],
                             vd corner[8]) {
    const ptrdiff_t y = grid->stride_y, z = grid->stride_z;
    const int bytes = type == ISO_UINT8 ? 1 : type == ISO_FLOAT32 ? 4 : 2;
    const char *voxel[LANES];
    for (int lane = 0; lane < LANES; lane++)
        voxel[lane] =
            (const char *)grid->data + bytes * (cell[0][lane] + cell[1][lane] * y + cell[2][lane] * z);
    load_pairs(type, voxel, 0, corner);
    load_pairs(type, voxel, y, corner + 2);
    load_pairs(type, voxel, z, corner + 4);
    load_pairs(type, voxel, y + z, corner + 6);
}

/* The value at `place` of each lane, trilinear; NAN in the lanes that are not `within` the bounds. */
ISO_INLINE vd sample(const iso_cap_row *row, iso_type type, const vd place[3], vl within) {
    int32_t cell[3][LANES];
    vd part[3], c[8];
    for (int axis = 0; axis < 3; axis++) {
        const vd in = choose(within, place[axis], set(row->origin[axis])), most = set(row->last[axis] - 1);
        const vd low = choose(in < most, in, most);
        const vh whole = __builtin_convertvector(low, vh);
        const vh from = whole - row->origin[axis];
        memcpy(cell[axis], &from, sizeof from);
        part[axis] = place[axis] - real(whole);
    }
    load_corners(row->grid, type, cell, c);
    vd side[4];
    for (int k = 0; k < 4; k++) side[k] = c[2 * k] + part[0] * (c[2 * k + 1] - c[2 * k]);
    const vd near = side[0] + part[1] * (side[1] - side[0]), far = side[2] + part[1] * (side[3] - side[2]);
    const vd value = near + part[2] * (far - near);
    return choose(within & (value - value == set(0)), value, set((double)NAN));
}

ISO_INLINE void draw(const iso_cap_row *row, iso_type type, int x, int count, iso_cap_block *block) {
    vd column;
    for (int lane = 0; lane < LANES; lane++) column[lane] = x + lane;
    for (int i = 0; i < count; i += LANES, column += set(LANES)) {
        const vd slope = at_columns(&row->slope, column), inverse = set(1) / slope,
                 depth = at_columns(&row->depth, column) * inverse;
        const vl meets = (slope > set(0)) & (depth > set(row->near));
        store(block->depth + i, choose(meets, depth, set((double)INFINITY)));
        vd place[3];
        vl within = meets;
        for (int axis = 0; axis < 3; axis++) {
            place[axis] = at_columns(&row->place[axis], column) * inverse;
            within &= place[axis] >= set(row->low[axis]);
            within &= place[axis] <= set(row->high[axis]);
            store(block->place[axis] + i, place[axis]);
        }
        if (row->grid) store(block->value + i, sample(row, type, place, within));
    }
}

/* The function iso_cap_kernel. */
void ISO_KERNEL_NAME(iso_cap_kernel)(const iso_cap_row *row, int x, int count, iso_cap_block *block) {
    const iso_type type = row->grid ? row->grid->type : ISO_FLOAT32;
    if (type == ISO_UINT8)
        draw(row, ISO_UINT8, x, count, block);
    else if (type == ISO_INT16)
        draw(row, ISO_INT16, x, count, block);
    else if (type == ISO_UINT16)
        draw(row, ISO_UINT16, x, count, block);
    else
        draw(row, ISO_FLOAT32, x, count, block);
}

/* ---- painting */

typedef float vs __attribute__((vector_size(4 * LANES)));

ISO_INLINE void write_lanes(void *to, vh mask, vh value) {
    vh was;
    memcpy(&was, to, sizeof was);
    const vh mixed = (value & mask) | (was & ~mask);
    memcpy(to, &mixed, sizeof mixed);
}

ISO_INLINE vd load(const double *from) {
    vd value;
    memcpy(&value, from, sizeof value);
    return value;
}

/* The colours of values, as in iso_gray_at. */
ISO_INLINE vh grays_of(const iso_cap_paint *paint, vd value) {
    const vd at =
        (value * set(paint->scale) + set(paint->offset) - set(paint->low)) / set(paint->high - paint->low);
    const vd low = choose(at < set(0), set(0), at), part = choose(low > set(1), set(1), low);
    return __builtin_convertvector(part * set(255) + set(0.5), vh) * 0x010101;
}

/* The function iso_cap_painter. */
int ISO_KERNEL_NAME(iso_cap_painter)(const iso_cap_block *block, int count, const iso_cap_paint *paint,
                                     const iso_cap_samples *samples) {
    int i = 0;
    for (; i + LANES <= count; i += LANES) {
        vs drawn;
        memcpy(&drawn, samples->depth + i, sizeof drawn);
        const vd depth = load(block->depth + i), value = load(block->value + i);
        const vl inside = paint->level_set ? value < set(paint->isovalue) : value >= set(paint->isovalue);
        const vl wide = inside & (depth <= __builtin_convertvector(drawn, vd));
        const vh mask = __builtin_convertvector(wide, vh);
        int any = 0;
        for (int lane = 0; lane < LANES; lane++) any |= mask[lane];
        if (!any) continue;
        write_lanes(samples->depth + i, mask, (vh) __builtin_convertvector(depth, vs));
        for (int k = 0; k < 3; k++)
            write_lanes(samples->normal[k] + i, mask, (vh)(paint->normal[k] - (vs){0}));
        /* (what is not painted can be no number) */
        const vh gray = paint->shows ? grays_of(paint, choose(wide, value, set(paint->low))) : (vh){0};
        const vh color = paint->shows ? gray : (int32_t)paint->color - (vh){0};
        write_lanes(samples->color + i, mask, color | (int32_t)paint->surface);
        for (int lane = 0; lane < LANES; lane++)
            if (mask[lane]) samples->surface[i + lane] = (uint8_t)paint->number;
    }
    return i;
}
