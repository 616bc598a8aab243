/* smooth_kernel: distances to the voxels of a mask, and separable Gaussian filters (label smoothing). */
#include "grids/labels/smooth_kernel.h"

#include <string.h>

#include "base/simd.h"
#if ISO_LANES > 4
#include <immintrin.h>
#endif

enum { REACH = ISO_LABEL_REACH };

/* ---- bytes from 0 to 255 */

typedef uint8_t byte_lanes __attribute__((vector_size(4 * ISO_LANES)));
enum { BYTES = sizeof(byte_lanes) };

ISO_INLINE byte_lanes load_bytes(const uint8_t *from) {
    byte_lanes loaded;
    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

ISO_INLINE void store_bytes(uint8_t *to, byte_lanes bytes) {
    memcpy(to, &bytes, sizeof bytes);
}

ISO_INLINE byte_lanes least_bytes(byte_lanes a, byte_lanes b) {
#if ISO_LANES == 16
    return (byte_lanes)_mm512_min_epu8((__m512i)a, (__m512i)b);
#elif ISO_LANES == 8
    return (byte_lanes)_mm256_min_epu8((__m256i)a, (__m256i)b);
#else
    const byte_lanes less = (byte_lanes)(a < b);
    return (a & less) | (b & ~less);
#endif
}

/* ---- sets of a row's voxels */

/* Half as many labels as there are bytes in a vector. */
typedef uint16_t label_lanes __attribute__((vector_size(4 * ISO_LANES)));
typedef uint8_t half_byte_lanes __attribute__((vector_size(2 * ISO_LANES)));

ISO_INLINE label_lanes load_labels(const uint16_t *from) {
    label_lanes loaded;
    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

/* Which of 2 * ISO_LANES pairs of labels are equal. */
ISO_INLINE uint64_t equal_labels(label_lanes a, label_lanes b) {
#if ISO_LANES == 16
    return _mm512_cmpeq_epu16_mask((__m512i)a, (__m512i)b);
#else
    const label_lanes equal = (label_lanes)(a == b);
    const half_byte_lanes bytes = __builtin_convertvector(equal, half_byte_lanes);
#if ISO_LANES == 8
    return (uint32_t)_mm_movemask_epi8((__m128i)bytes);
#else
    uint64_t eight;
    memcpy(&eight, &bytes, sizeof eight);
    /* (the highest bit of each byte, gathered in the highest byte) */
    return (eight & 0x8080808080808080u) * 0x0002040810204081u >> 56;
#endif
#endif
}

ISO_INLINE uint64_t first_bits(int n) {
    return n >= 64 ? ~UINT64_C(0) : (UINT64_C(1) << n) - 1;
}

static uint64_t equal(const uint16_t *row, int n, uint16_t label) {
    uint64_t set = 0;
    const label_lanes all = label - (label_lanes){0};
    for (int i = 0; i < n; i += 2 * ISO_LANES) set |= equal_labels(load_labels(row + i), all) << i;
    return set & first_bits(n);
}

static uint64_t differ(const uint16_t *a, const uint16_t *b, int n) {
    uint64_t set = 0;
    for (int i = 0; i < n; i += 2 * ISO_LANES)
        set |= equal_labels(load_labels(a + i), load_labels(b + i)) << i;
    return ~set & first_bits(n);
}

static void present(uint16_t *row, int n) {
    for (int i = 0; i < n; i += 2 * ISO_LANES) {
        const label_lanes ones = (label_lanes)(load_labels(row + i) != 0) & 1;
        memcpy(row + i, &ones, sizeof ones);
    }
}

static void mask(const uint16_t *row, int n, uint16_t label, uint8_t *mask) {
    for (int i = 0; i < n; i += 2 * ISO_LANES) {
        const label_lanes same = (label_lanes)(load_labels(row + i) == label);
        const half_byte_lanes bytes = __builtin_convertvector(~same, half_byte_lanes);
        memcpy(mask + i, &bytes, sizeof bytes);
    }
}

/* to[i] = all of from[i - above * step] .. from[i + below * step], as far as there are these n words. */
ISO_INLINE void join(const uint64_t *from, ptrdiff_t n, ptrdiff_t step, int below, int above, uint64_t *to) {
    memcpy(to, from, (size_t)n * sizeof *to);
    for (int k = 1; k <= below; k++)
        for (ptrdiff_t i = 0; i < n - k * step; i++) to[i] |= from[i + k * step];
    for (int k = 1; k <= above; k++)
        for (ptrdiff_t i = k * step; i < n; i++) to[i] |= from[i - k * step];
}

static void spread(const uint64_t *from, int ny, int nz, int below, int above, uint64_t *work, uint64_t *to) {
    const ptrdiff_t rows = (ptrdiff_t)ny * nz;
    for (ptrdiff_t i = 0; i < rows; i++) {
        uint64_t set = from[i];
        for (int k = 1; k <= above; k++) set |= from[i] << k;
        for (int k = 1; k <= below; k++) set |= from[i] >> k;
        to[i] = set;
    }
    for (int z = 0; z < nz; z++) join(to + (ptrdiff_t)z * ny, ny, 1, below, above, work + (ptrdiff_t)z * ny);
    join(work, rows, ny, below, above, to);
}

/* ---- what is needed */

/* Rows are needed up to `radius` * `step` from those that are. */
static void widen(const iso_label_box *box, int from, ptrdiff_t step, int radius, int to) {
    const int edge = box->margin + REACH;
    const ptrdiff_t rows = (ptrdiff_t)(box->n[1] + 2 * edge) * (box->n[2] + 2 * edge);
    for (ptrdiff_t i = 0; i < rows; i += BYTES) {
        byte_lanes lo = load_bytes(box->lo[from] + i), hi = ~load_bytes(box->hi[from] + i);
        for (int k = 1; k <= radius; k++) {
            lo = least_bytes(lo, least_bytes(load_bytes(box->lo[from] + i + k * step),
                                             load_bytes(box->lo[from] + i - k * step)));
            hi = least_bytes(hi, least_bytes(~load_bytes(box->hi[from] + i + k * step),
                                             ~load_bytes(box->hi[from] + i - k * step)));
        }
        store_bytes(box->lo[to] + i, lo);
        store_bytes(box->hi[to] + i, ~hi);
    }
    memset(box->lo[to] + rows, UINT8_MAX, ISO_LABEL_GUARD);
    memset(box->hi[to] + rows, 0, ISO_LABEL_GUARD);
}

static void needs(const iso_label_box *box) {
    const ptrdiff_t pitch = box->n[1] + 2 * (box->margin + REACH);
    widen(box, ISO_LABEL_RESULTS, 1, box->radius, ISO_LABEL_Z_PASS);
    widen(box, ISO_LABEL_Z_PASS, pitch, box->radius, ISO_LABEL_DISTANCES);
    widen(box, ISO_LABEL_DISTANCES, 1, REACH, ISO_LABEL_Z_SQUARES);
    widen(box, ISO_LABEL_Z_SQUARES, pitch, REACH, ISO_LABEL_MASK);
}

/* The voxels lo .. hi - 1 of a row that a step needs, counted as those of the distances, of rows that are
 * `more` voxels longer; false: none. */
ISO_INLINE bool needed(const iso_label_box *box, int step, int y, int z, int more, int *lo, int *hi) {
    const int edge = box->margin + REACH;
    const ptrdiff_t row = (ptrdiff_t)(z + edge) * (box->n[1] + 2 * edge) + y + edge;
    *lo = box->lo[step][row] + box->margin - box->radius;
    *hi = box->hi[step][row] + box->margin + box->radius + more;
    return box->hi[step][row] != 0;
}

/* ---- distances */

/* Squared distances of a voxel to the nearest one on the other side of the label's border, with the side: d
 * inside, ~d outside. */
typedef int8_t side_lanes __attribute__((vector_size(4 * ISO_LANES)));

ISO_INLINE side_lanes load_sides(const int8_t *from) {
    side_lanes loaded;
    memcpy(&loaded, from, sizeof loaded);
    return loaded;
}

ISO_INLINE side_lanes least_side(side_lanes a, side_lanes b) {
#if ISO_LANES == 16
    return (side_lanes)_mm512_min_epi8((__m512i)a, (__m512i)b);
#elif ISO_LANES == 8
    return (side_lanes)_mm256_min_epi8((__m256i)a, (__m256i)b);
#else
    const side_lanes less = (side_lanes)(a < b);
    return (a & less) | (b & ~less);
#endif
}

ISO_INLINE side_lanes not_negative(side_lanes a) {
#if ISO_LANES == 16
    return (side_lanes)_mm512_max_epi8((__m512i)a, _mm512_setzero_si512());
#elif ISO_LANES == 8
    return (side_lanes)_mm256_max_epi8((__m256i)a, _mm256_setzero_si256());
#else
    return a & ~(side_lanes)(a < 0);
#endif
}

/* Of bytes from 0 to 6. */
ISO_INLINE byte_lanes square_of(byte_lanes a) {
#if ISO_LANES > 4
    const __m128i squares = _mm_setr_epi8(0, 1, 4, 9, 16, 25, 36, 0, 0, 0, 0, 0, 0, 0, 0, 0);
#endif
#if ISO_LANES == 16
    return (byte_lanes)_mm512_shuffle_epi8(_mm512_broadcast_i32x4(squares), (__m512i)a);
#elif ISO_LANES == 8
    return (byte_lanes)_mm256_shuffle_epi8(_mm256_broadcastsi128_si256(squares), (__m256i)a);
#else
    return a * a;
#endif
}

/* The squared distances along z of `n` voxels, `step` apart: of the first and last REACH of them they are not
 * written. A voxel beside one of the other side is 1 from it; one beside another of its side is 1 farther. */
ISO_INLINE void column_squares(const uint8_t *mask, ptrdiff_t step, int n, int8_t *to) {
    const byte_lanes most = REACH + 1 - (byte_lanes){0};
    byte_lanes before[ISO_LABEL_ROW], last = load_bytes(mask), far = {0};
    for (int i = 0; i < n; i++) {
        const byte_lanes here = load_bytes(mask + i * step);
        far = least_bytes((far & (byte_lanes)(here == last)) + 1, most);
        before[i] = far;
        last = here;
    }
    far = (byte_lanes){0};
    for (int i = n - 1; i >= REACH; i--) {
        const byte_lanes here = load_bytes(mask + i * step);
        far = least_bytes((far & (byte_lanes)(here == last)) + 1, most);
        last = here;
        if (i >= n - REACH) continue;
        const byte_lanes side = square_of(least_bytes(far, before[i])) ^ here;
        memcpy(to + i * step, &side, sizeof side);
    }
}

/* A part of a row of the squared distances along one axis and those before: neighbours lie `step` apart. */
ISO_INLINE side_lanes least_squares(const int8_t *in, ptrdiff_t step) {
    const side_lanes here = load_sides(in), outside = (side_lanes)(here < 0);
    side_lanes least = here ^ outside;
    for (int k = 1; k <= REACH; k++) {
        const side_lanes near =
            least_side(load_sides(in + k * step) ^ outside, load_sides(in - k * step) ^ outside);
        least = least_side(least, not_negative(near) + (int8_t)(k * k));
    }
    return least ^ outside;
}

/* The rows first .. end - 1 along z of one y whose squared distances along z are needed, and the voxels of
 * them: lo .. hi - 1. */
typedef struct column {
    int first, end, lo, hi;
} column;

ISO_INLINE bool needed_column(const iso_label_box *box, int y, column *c) {
    const int m = box->margin;
    int lo, hi;
    *c = (column){0, 0, INT32_MAX, INT32_MIN};
    for (int z = -m; z < box->n[2] + m; z++) {
        if (!needed(box, ISO_LABEL_Z_SQUARES, y, z, 2 * REACH, &lo, &hi)) continue;
        if (c->lo == INT32_MAX) c->first = z;
        c->end = z + 1;
        c->lo = lo < c->lo ? lo : c->lo;
        c->hi = hi > c->hi ? hi : c->hi;
    }
    return c->lo < c->hi;
}

static void squares(const uint8_t *mask, const iso_label_box *box, int8_t *work, int8_t *squares) {
    const int m = box->margin, far[3] = {box->n[0] + 2 * m, box->n[1] + 2 * m, box->n[2] + 2 * m},
              all[2] = {far[0] + 2 * REACH, far[1] + 2 * REACH};
    const ptrdiff_t slice = (ptrdiff_t)all[0] * all[1];
    int8_t row_in[2 * ISO_LABEL_ROW + ISO_LABEL_SLACK];
    int lo, hi;
    for (int y = -m - REACH; y < far[1] - m + REACH; y++) {
        column c;
        if (!needed_column(box, y, &c)) continue;
        const ptrdiff_t first = (c.first + m) * slice + (ptrdiff_t)(y + m + REACH) * all[0];
        for (int x = c.lo; x < c.hi; x += BYTES)
            column_squares(mask + first + x, slice, c.end - c.first + 2 * REACH, work + first + x);
    }
    for (int z = -m; z < far[2] - m; z++)
        for (int y = -m; y < far[1] - m; y++) {
            if (!needed(box, ISO_LABEL_DISTANCES, y, z, 2 * REACH, &lo, &hi)) continue;
            const ptrdiff_t from = (z + m + REACH) * slice + (ptrdiff_t)(y + m + REACH) * all[0],
                            to = ((ptrdiff_t)(z + m) * far[1] + y + m) * far[0];
            for (int x = lo; x < hi; x += BYTES) {
                const side_lanes part = least_squares(work + from + x, all[0]);
                memcpy(row_in + x, &part, sizeof part);
            }
            hi -= 2 * REACH;
            for (int x = lo; x < hi; x += BYTES) {
                const side_lanes part = least_squares(row_in + x + REACH, 1);
                memcpy(squares + to + x, &part, sizeof part);
            }
        }
}

static void signed_distance(const int8_t *squares, const iso_label_box *box, float *distance) {
    const int m = box->margin, far[2] = {box->n[0] + 2 * m, box->n[1] + 2 * m};
    const vf half = v_set(0.5f);
    const vi last_inside = v_seti(INT8_MAX);
    int lo, hi;
    for (int z = -m; z < box->n[2] + m; z++)
        for (int y = -m; y < box->n[1] + m; y++) {
            if (!needed(box, ISO_LABEL_DISTANCES, y, z, 0, &lo, &hi)) continue;
            const ptrdiff_t row = ((ptrdiff_t)(z + m) * far[1] + y + m) * far[0];
            for (ptrdiff_t i = row + lo; i < row + hi; i += ISO_LANES) {
                const vi byte = v_load_u8((const uint8_t *)squares + i);
                const vm outside = v_lti(last_inside, byte);
                const vi square = v_selecti(outside, v_seti(UINT8_MAX) - byte, byte);
                const vf root = v_sqrt(v_to_float(square)) - half;
                v_store(distance + i, v_select(outside, v_set(0) - root, root));
            }
        }
}

/* ---- filters */

ISO_INLINE vf pair_at(const float *in, ptrdiff_t step) {
    return v_load(in + step) + v_load(in - step);
}

/* A Gaussian of the values around `in`. */
ISO_INLINE vf gaussian_at(const float *in, ptrdiff_t step, int radius, const vf *w) {
    vf sum = w[0] * v_load(in);
    for (int k = 1; k <= radius; k++) sum = sum + w[k] * pair_at(in, k * step);
    return sum;
}

ISO_INLINE void filter_of(const float *distance, const iso_label_box *box, int first, int second,
                          const iso_label_filter *f, float *work, float *out) {
    const int m = box->margin, r = box->radius, *n = box->n, far[2] = {n[0] + 2 * m, n[1] + 2 * m};
    const ptrdiff_t slice = (ptrdiff_t)far[0] * far[1], size = slice * n[2] + ISO_LABEL_SLACK;
    float *z_done[2] = {work, work + size}, *y_done[2] = {work + 2 * size, work + 3 * size};
    int lo, hi;
    vf w[2][ISO_LABEL_RADIUS + 1]; /* (as vectors of their own, which no store of results can change) */
    for (int k = 0; k <= second; k++) w[0][k] = v_set(f->w[0][k]), w[1][k] = v_set(f->w[1][k]);
    for (int z = 0; z < n[2]; z++)
        for (int y = -m; y < n[1] + m; y++) {
            if (!needed(box, ISO_LABEL_Z_PASS, y, z, 0, &lo, &hi)) continue;
            const ptrdiff_t row = z * slice + (ptrdiff_t)(y + m) * far[0];
            for (ptrdiff_t i = row + lo; i < row + hi; i += ISO_LANES) {
                const float *in = distance + i + m * slice;
                vf a = w[0][0] * v_load(in), b = w[1][0] * v_load(in);
                for (int k = 1; k <= second; k++) {
                    const vf pair = pair_at(in, k * slice);
                    if (k <= first) a = a + w[0][k] * pair;
                    b = b + w[1][k] * pair;
                }
                v_store(z_done[0] + i, a);
                v_store(z_done[1] + i, b);
            }
        }
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            if (!needed(box, ISO_LABEL_RESULTS, y, z, 0, &lo, &hi)) continue;
            const ptrdiff_t from = z * slice + (ptrdiff_t)(y + m) * far[0],
                            row = ((ptrdiff_t)z * n[1] + y) * far[0];
            for (int x = lo; x < hi; x += ISO_LANES) {
                v_store(y_done[0] + row + x, gaussian_at(z_done[0] + from + x, far[0], first, w[0]));
                v_store(y_done[1] + row + x, gaussian_at(z_done[1] + from + x, far[0], second, w[1]));
            }
            const vf forth = v_set(1 + f->back), back = v_set(f->back);
            for (int x = lo + r; x < hi - r; x += ISO_LANES) {
                const vf a = gaussian_at(y_done[0] + row + x, 1, first, w[0]),
                         b = gaussian_at(y_done[1] + row + x, 1, second, w[1]);
                v_store(out + ((ptrdiff_t)z * n[1] + y) * n[0] + x - m, forth * a - back * b);
            }
        }
}

/* (Constant radii let the compiler unroll the loops over the weights.) */
static void filter(const float *distance, const iso_label_box *box, const iso_label_filter *f, float *work,
                   float *out) {
    if (f->radius[0] == 5) filter_of(distance, box, 5, 7, f, work, out);
    if (f->radius[0] == 3) filter_of(distance, box, 3, 4, f, work, out);
}

/* ---- what is kept of them */

ISO_INLINE vm lanes_of(uint64_t set, int x) {
    return v_from_mask((uint32_t)(set >> x & first_bits(ISO_LANES)));
}

static void keep(uint64_t set, const uint16_t *row, uint16_t label, const float *field, const float *distance,
                 float *own, float *loss, float *other, float *best) {
    for (int x = 0; x < ISO_LABEL_ROW && set >> x; x += ISO_LANES) {
        if (!(set >> x & first_bits(ISO_LANES))) continue;
        const vm kept = lanes_of(set, x), mine = v_and(kept, v_eqi(v_load_u16(row + x), v_seti(label))),
                 others = v_andnot(kept, mine);
        const vf value = v_load(field + x), far = v_load(distance + x), was_best = v_load(best + x),
                 was_other = v_load(other + x);
        v_store(best + x, v_select(kept, v_max(value, was_best), was_best));
        v_store(own + x, v_select(mine, value, v_load(own + x)));
        v_store(loss + x, v_select(mine, far - value, v_load(loss + x)));
        v_store(other + x, v_select(others, v_max(value, was_other), was_other));
    }
}

static void keep_pair(uint64_t set, const uint16_t *row, uint16_t label, float least, const float *field,
                      const float *distance, float *own, float *loss, float *other, float *const best[2]) {
    for (int x = 0; x < ISO_LABEL_ROW && set >> x; x += ISO_LANES) {
        if (!(set >> x & first_bits(ISO_LANES))) continue;
        const vm kept = lanes_of(set, x), mine = v_eqi(v_load_u16(row + x), v_seti(label));
        const vf value = v_load(field + x), opposite = v_set(0) - value, lost = v_load(distance + x) - value,
                 at_least = v_set(least);
        v_store(best[0] + x, v_select(kept, v_max(value, at_least), v_load(best[0] + x)));
        v_store(best[1] + x, v_select(kept, v_max(opposite, at_least), v_load(best[1] + x)));
        v_store(own + x, v_select(kept, v_select(mine, value, opposite), v_load(own + x)));
        v_store(loss + x, v_select(kept, v_select(mine, lost, v_set(0) - lost), v_load(loss + x)));
        v_store(other + x,
                v_select(kept, v_max(v_select(mine, opposite, value), at_least), v_load(other + x)));
    }
}

static void fill(uint64_t set, float value, float *row) {
    for (int x = 0; x < ISO_LABEL_ROW && set >> x; x += ISO_LANES)
        v_store(row + x, v_select(lanes_of(set, x), v_set(value), v_load(row + x)));
}

static uint64_t thin(const float *own, const float *other, const float *loss, int n, float change,
                     float most) {
    uint64_t set = 0;
    for (int x = 0; x < n; x += ISO_LANES)
        set |= (uint64_t)v_mask(v_or(v_lt(v_load(own + x), v_load(other + x) - v_set(change)),
                                     v_lt(v_set(most), v_load(loss + x))))
               << x;
    return set & first_bits(n);
}

static uint64_t weak(const float *own, const float *other, const float *weight, int n, float lead,
                     float more) {
    uint64_t set = 0;
    for (int x = 0; x < n; x += ISO_LANES) {
        vf least = v_load(other + x) + v_set(lead);
        if (weight) least = least + v_load(weight + x) * v_set(more);
        set |= (uint64_t)v_mask(v_lt(v_load(own + x), least)) << x;
    }
    return set & first_bits(n);
}

const iso_smooth_kernel ISO_KERNEL_NAME(iso_smooth_kernel) = {
    equal,           differ, present, spread,    needs, mask, squares,
    signed_distance, filter, keep,    keep_pair, fill,  thin, weak};
