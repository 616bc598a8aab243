/* brick_range_kernel: finds the ranges of row groups, in plain C that the compiler vectorises. */
#include "grids/brick_range_kernel.h"

#include "base/kernel.h"
#include "base/numbers.h"

#define LINE_ITEMS(type) (ISO_GROUPS_SIDE * BATCH_BYTES / (int)sizeof(type) + LINES * COLUMN_SLACK)

/* Reads a slice once, row by row, without using the values. The hardware prefetcher recognises this order; it
 * would not recognise that of the kernels, which read many rows at once. */
static inline void touch_slice(const void *slice, const range_box *box, size_t size) {
    for (int y = 0; y < box->n[1]; y++)
        for (size_t byte = 0; byte < (size_t)box->n[0] * size; byte += 64)
            (void)*((const volatile char *)slice + (ptrdiff_t)size * y * box->stride_y + byte);
}

/* What is found: the range of all voxels of a type, or (`finite`) of the finite floats. */
#ifndef ISO_VARIANT
#define ISO_VARIANT float
#endif
/* The type that voxels are read as: floats are read as integers. */
#define T_uint8 uint8_t
#define T_int16 int16_t
#define T_uint16 uint16_t
#define T_float float_bits
#define T_finite float_bits
#define ISO_T ISO_PASTE(T, ISO_VARIANT)
/* The least and the largest value of ISO_T. */
#define LEAST_uint8 0
#define LEAST_int16 INT16_MIN
#define LEAST_uint16 0
#define LEAST_float INT32_MIN
#define LEAST_finite INT32_MIN
#define ISO_LEAST ISO_PASTE(LEAST, ISO_VARIANT)
#define MOST_uint8 UINT8_MAX
#define MOST_int16 INT16_MAX
#define MOST_uint16 UINT16_MAX
#define MOST_float INT32_MAX
#define MOST_finite INT32_MAX
#define ISO_MOST ISO_PASTE(MOST, ISO_VARIANT)
/* The key of a voxel for finding the minimum and the maximum, and the value of a key. */
#define IS_KEY_uint8 0
#define IS_KEY_int16 0
#define IS_KEY_uint16 0
#define IS_KEY_float 1
#define IS_KEY_finite 2
#if ISO_PASTE(IS_KEY, ISO_VARIANT) == 0
#define ISO_LOW(v) (v)
#define ISO_HIGH(v) (v)
#define ISO_VALUE(v) (v)
#else
static inline float value_of_key(int32_t key) {
    const int32_t bits = key_of_bits(key);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#define ISO_VALUE value_of_key
#if ISO_PASTE(IS_KEY, ISO_VARIANT) == 1
#define ISO_LOW key_of_bits
#define ISO_HIGH key_of_bits
#else
static inline bool is_finite_key(int32_t key) {
    return (key >= LEAST_KEY) & (key <= LARGEST_KEY);
}

/* Return the key of a finite float. Other floats get the key that has no effect on a minimum (finite_low) or
 * a maximum (finite_high). */
static inline int32_t finite_low(int32_t bits) {
    const int32_t key = key_of_bits(bits);
    return is_finite_key(key) ? key : INT32_MAX;
}
static inline int32_t finite_high(int32_t bits) {
    const int32_t key = key_of_bits(bits);
    return is_finite_key(key) ? key : INT32_MIN;
}

#define ISO_LOW finite_low
#define ISO_HIGH finite_high
#endif
#endif

#define ISO_SMALLER(a, b) ((a) < (b) ? (a) : (b))
#define ISO_LARGER(a, b) ((a) > (b) ? (a) : (b))

/* Running minima and maxima. A line holds them for each x, over a group of ISO_GROUP_ROWS + 1 rows in y of
 * the slices seen so far; there is one line for each group. Items after the grid's last x change no minimum
 * or maximum: they hold the largest value as the minimum and the smallest as the maximum. */
typedef struct range_lines {
    ISO_T lo[LINE_ITEMS(ISO_T)], hi[LINE_ITEMS(ISO_T)];
} range_lines;

static void clear(int items, range_lines *lines) {
    for (int i = 0; i < items; i++) lines->lo[i] = ISO_MOST;
    for (int i = 0; i < items; i++) lines->hi[i] = ISO_LEAST;
}

/* Sets a line to the minima and maxima over five rows, with one store for five loads. With `fold`, the values
 * that the line holds already count too; without, they are overwritten. */
ISO_INLINE void fold_five(const ISO_T *const row[5], int n, ISO_T *restrict lo, ISO_T *restrict hi,
                          bool fold) {
    const ISO_T *a = row[0], *b = row[1], *c = row[2], *d = row[3], *e = row[4];
    for (int x = 0; x < n; x++) {
        const ISO_T low = ISO_SMALLER(ISO_LOW(a[x]), ISO_LOW(b[x])),
                    least = ISO_SMALLER(ISO_LOW(c[x]), ISO_LOW(d[x]));
        const ISO_T high = ISO_LARGER(ISO_HIGH(a[x]), ISO_HIGH(b[x])),
                    most = ISO_LARGER(ISO_HIGH(c[x]), ISO_HIGH(d[x]));
        const ISO_T four = ISO_SMALLER(low, least), above = ISO_LARGER(high, most);
        const ISO_T five = ISO_SMALLER(four, ISO_LOW(e[x])), top = ISO_LARGER(above, ISO_HIGH(e[x]));
        lo[x] = fold ? ISO_SMALLER(five, lo[x]) : five;
        hi[x] = fold ? ISO_LARGER(top, hi[x]) : top;
    }
}

/* Sets the lines to the minima and maxima over the rows of a slice. With `fold`, the values that the lines
 * hold already count too; without, they are overwritten. A group that ends beyond the grid reads the grid's
 * last row again. */
static void fold_slice(const ISO_T *slice, const range_box *box, bool fold, range_lines *lines) {
    const int last = box->n[1] - 1;
    touch_slice(slice, box, sizeof *slice);
    for (int g = 0; g < box->lines && g * ISO_GROUP_ROWS <= last; g++) {
        ISO_T *lo = lines->lo + g * box->pitch, *hi = lines->hi + g * box->pitch;
        const ISO_T *row[ISO_GROUP_ROWS + 1];
        for (int y = 0; y <= ISO_GROUP_ROWS; y++)
            row[y] = slice + iso_min_int(g * ISO_GROUP_ROWS + y, last) * box->stride_y;
        if (fold)
            fold_five(row, box->n[0], lo, hi, true);
        else
            fold_five(row, box->n[0], lo, hi, false);
    }
}

static void join(int items, const range_lines *restrict from, range_lines *restrict to) {
    for (int i = 0; i < items; i++) to->lo[i] = ISO_SMALLER(to->lo[i], from->lo[i]);
    for (int i = 0; i < items; i++) to->hi[i] = ISO_LARGER(to->hi[i], from->hi[i]);
}

/* Sets low and high of each column to the minimum and maximum of that column and the seven after it. Three
 * steps of doubling would be slower: each step would have to wait for the stores of the step before. */
static void eights(const ISO_T *restrict lo, const ISO_T *restrict hi, int n, ISO_T *restrict low,
                   ISO_T *restrict high) {
    for (int x = 0; x < n; x++) {
        const ISO_T a = ISO_SMALLER(lo[x], lo[x + 1]), b = ISO_SMALLER(lo[x + 2], lo[x + 3]),
                    c = ISO_SMALLER(lo[x + 4], lo[x + 5]), d = ISO_SMALLER(lo[x + 6], lo[x + 7]);
        const ISO_T four = ISO_SMALLER(a, b), last = ISO_SMALLER(c, d);
        low[x] = ISO_SMALLER(four, last);
    }
    for (int x = 0; x < n; x++) {
        const ISO_T a = ISO_LARGER(hi[x], hi[x + 1]), b = ISO_LARGER(hi[x + 2], hi[x + 3]),
                    c = ISO_LARGER(hi[x + 4], hi[x + 5]), d = ISO_LARGER(hi[x + 6], hi[x + 7]);
        const ISO_T four = ISO_LARGER(a, b), last = ISO_LARGER(c, d);
        high[x] = ISO_LARGER(four, last);
    }
}

/* Sets the ranges of the row groups of all lines. A group has 17 columns: those of two results of `eights`
 * and one more. z: number of the first line's group. */
static void groups(const range_lines *lines, const range_box *box, int z, range_values *values) {
    _Alignas(64) ISO_T low[BATCH_BYTES / sizeof(ISO_T)], high[BATCH_BYTES / sizeof(ISO_T)];
    for (int line = 0; line < box->lines; line++) {
        const int first = line * box->pitch, brick = line / ISO_GROUPS_SIDE * box->bricks,
                  group = z + line % ISO_GROUPS_SIDE;
        eights(lines->lo + first, lines->hi + first, box->bricks * ISO_BRICK, low, high);
        for (int b = 0; b < box->bricks; b++) {
            const ISO_T *l = low + b * ISO_BRICK, *h = high + b * ISO_BRICK;
            const ISO_T lo = ISO_SMALLER(l[0], l[8]), hi = ISO_LARGER(h[0], h[8]);
            values->lo[group][brick + b] = ISO_VALUE(ISO_SMALLER(lo, l[9]));
            values->hi[group][brick + b] = ISO_VALUE(ISO_LARGER(hi, h[9]));
        }
    }
}

/* Computes the ranges of all row groups of a batch. A slice between two groups belongs to both. */
void ISO_KERNEL_NAME(ISO_PASTE(iso_range, ISO_VARIANT))(const void *data, const range_box *box,
                                                        range_values *values) {
    _Alignas(64) range_lines part[2];
    range_lines *lines = &part[0], *next = &part[1];
    const int items = box->lines * box->pitch;
    const ISO_T *slice = data;
    clear(items, lines);
    clear(items, next);
    fold_slice(slice, box, false, lines);
    for (int z = 0; z < ISO_BRICK && z < box->n[2]; z += ISO_GROUP_ROWS) {
        for (int k = z + 1; k < z + ISO_GROUP_ROWS && k < box->n[2]; k++)
            fold_slice(slice += box->stride_z, box, true, lines);
        if (z + ISO_GROUP_ROWS < box->n[2]) {
            fold_slice(slice += box->stride_z, box, false, next);
            join(items, next, lines);
        }
        groups(lines, box, z, values);
        range_lines *swap = lines;
        lines = next;
        next = swap;
    }
}
