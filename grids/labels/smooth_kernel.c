/* smooth_kernel: distances to the voxels of a mask, and separable Gaussian filters (label smoothing). */
#include "grids/labels/smooth_kernel.h"

#include <string.h>

#include "base/simd.h"

/* Bytes from 0 to 127. */
typedef int8_t byte_lanes __attribute__((vector_size(4 * ISO_LANES)));

ISO_INLINE byte_lanes load_bytes(const uint8_t *from) {
    byte_lanes loaded;
    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

ISO_INLINE byte_lanes least_bytes(byte_lanes a, byte_lanes b) {
    const byte_lanes less = (byte_lanes)(a < b);
    return (a & less) | (b & ~less);
}

/* Half as many labels as there are bytes in a vector. */
typedef uint16_t label_lanes __attribute__((vector_size(4 * ISO_LANES)));
typedef uint8_t half_byte_lanes __attribute__((vector_size(2 * ISO_LANES)));

static void mask(const uint16_t *row, int n, uint16_t label, uint8_t *mask) {
    const uint16_t of_others = ISO_LABEL_FAR_SQUARE;
    for (int i = 0; i < n; i += 2 * ISO_LANES) {
        label_lanes numbers;
        memcpy(&numbers, row + i, sizeof numbers);
        const label_lanes equal = (label_lanes)(numbers == label);
        const half_byte_lanes bytes = __builtin_convertvector(~equal & of_others, half_byte_lanes);
        memcpy(mask + i, &bytes, sizeof bytes);
    }
}

/* One row of the squared distances along one axis: the neighbours of out[i] lie `step` apart. */
ISO_INLINE void squares_row(const uint8_t *in, ptrdiff_t step, int n, uint8_t *out) {
    for (int i = 0; i < n; i += (int)sizeof(byte_lanes)) {
        byte_lanes least = load_bytes(in + i);
        least = least_bytes(least, (least ^ least) + (int8_t)ISO_LABEL_FAR_SQUARE);
        for (int k = 1; k <= ISO_LABEL_REACH; k++) {
            const int8_t square = (int8_t)(k * k);
            least = least_bytes(least, load_bytes(in + i + k * step) + square);
            least = least_bytes(least, load_bytes(in + i - k * step) + square);
        }
        memcpy(out + i, &least, sizeof least);
    }
}

/* How many rows of a pass are one long row: rows that are as long before and after it follow each other. */
ISO_INLINE int joined_rows(const int m[3], const int n[3]) {
    return m[0] == n[0] ? n[1] : 1;
}

/* `from` has the size m; what is at `first` is that much away from its ends along the axis of `step`. */
static void squares_pass(const uint8_t *from, const int m[3], const int n[3], const int first[3],
                         ptrdiff_t step, uint8_t *to) {
    const int joined = joined_rows(m, n);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y += joined) {
            const ptrdiff_t row = ((ptrdiff_t)(z + first[2]) * m[1] + y + first[1]) * m[0] + first[0];
            squares_row(from + row, step, joined * n[0], to + ((ptrdiff_t)z * n[1] + y) * n[0]);
        }
}

static void squares(const uint8_t *in, const int n[3], uint8_t *work, uint8_t *far) {
    enum { R = ISO_LABEL_REACH };
    const int all[3] = {n[0] + 2 * R, n[1] + 2 * R, n[2] + 2 * R}, z_done[3] = {all[0], all[1], n[2]},
              y_done[3] = {all[0], n[1], n[2]};
    uint8_t *second = work + (ptrdiff_t)all[0] * all[1] * all[2];
    squares_pass(in, all, z_done, (const int[3]){0, 0, R}, (ptrdiff_t)all[0] * all[1], work);
    squares_pass(work, z_done, y_done, (const int[3]){0, R, 0}, all[0], second);
    squares_pass(second, y_done, n, (const int[3]){R, 0, 0}, 1, far);
}

static void signed_distance(const uint8_t *to_outside, const uint8_t *to_inside, size_t count, float *out) {
    for (size_t i = 0; i < count; i += ISO_LANES) {
        /* (one of the two is 0) */
        const vf outside = v_to_float(v_load_u8(to_outside + i)),
                 inside = v_to_float(v_load_u8(to_inside + i)), half = v_set(0.5f);
        const vf in = v_sqrt(outside) - half, out_of = half - v_sqrt(inside);
        v_store(out + i, v_select(v_lt(v_set(0), outside), in, out_of));
    }
}

ISO_INLINE void filter_row(const float *row, ptrdiff_t step, int n, int radius, const float *w, float *out) {
    vf weight[ISO_LABEL_RADIUS + 1];
    for (int k = 0; k <= radius; k++) weight[k] = v_set(w[k]);
    for (int x = 0; x < n; x += ISO_LANES) {
        vf sum = weight[0] * v_load(row + x);
        for (int k = 1; k <= radius; k++)
            sum = sum + weight[k] * (v_load(row + x + k * step) + v_load(row + x - k * step));
        v_store(out + x, sum);
    }
}

ISO_INLINE void filter_pass(const float *from, const int m[3], const int n[3], const int first[3],
                            ptrdiff_t step, int radius, const float *w, float *to) {
    const int joined = joined_rows(m, n);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y += joined) {
            const ptrdiff_t row = ((ptrdiff_t)(z + first[2]) * m[1] + y + first[1]) * m[0] + first[0];
            filter_row(from + row, step, joined * n[0], radius, w, to + ((ptrdiff_t)z * n[1] + y) * n[0]);
        }
}

ISO_INLINE void filter_of(const float *in, const int n[3], int margin, int radius, const float *w,
                          float *work, float *out) {
    const int m = margin;
    const int all[3] = {n[0] + 2 * m, n[1] + 2 * m, n[2] + 2 * m}, z_done[3] = {all[0], all[1], n[2]},
              y_done[3] = {all[0], n[1], n[2]};
    float *second = work + (ptrdiff_t)all[0] * all[1] * n[2];
    filter_pass(in, all, z_done, (const int[3]){0, 0, m}, (ptrdiff_t)all[0] * all[1], radius, w, work);
    filter_pass(work, z_done, y_done, (const int[3]){0, m, 0}, all[0], radius, w, second);
    filter_pass(second, y_done, n, (const int[3]){m, 0, 0}, 1, radius, w, out);
}

/* (A constant radius lets the compiler unroll the loop over the weights.) */
static void filter(const float *in, const int n[3], int margin, int radius, const float *w, float *work,
                   float *out) {
    if (radius == 3) filter_of(in, n, margin, 3, w, work, out);
    if (radius == 4) filter_of(in, n, margin, 4, w, work, out);
    if (radius == 5) filter_of(in, n, margin, 5, w, work, out);
    if (radius == 7) filter_of(in, n, margin, 7, w, work, out);
}

const iso_smooth_kernel ISO_KERNEL_NAME(iso_smooth_kernel) = {mask, squares, signed_distance, filter};
