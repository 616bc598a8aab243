/* A delta: a bit for each row with a changed voxel; of each of these rows the changed voxels (16 bits); four
 * bits for each of these voxels, which say whether it becomes +band, -band or a distance; and then, of each
 * distance, how far it is from a prediction, in as many steps of four bits as its code says. The prediction
 * is that of Ibarria et al. 2003 (the Lorenzo predictor): a corner of a cube of voxels from the others. */
#include "sculpt/field/cell_delta.h"

#include <string.h>

/* PADDING: bytes after the last ones, so that eight can be read at any place. */
enum { ROW_BYTES = ISO_BRICK_ROWS / 8, PADDING = 8, OUTSIDE = 0, INSIDE = 1, DISTANCE = 2 };

/* The bits of the voxels of a row that differ. */
static uint16_t find_row(const float *before, const float *after) {
    uint32_t a[ISO_BRICK], b[ISO_BRICK], bits = 0;
    memcpy(a, before, sizeof a);
    memcpy(b, after, sizeof b);
    for (int x = 0; x < ISO_BRICK; x++) bits |= (uint32_t)(a[x] != b[x]) << x;
    return (uint16_t)bits;
}

/* What the rows below and behind a row of a brick predict of it. */
static void predict_row(const float *brick, int row, float base[ISO_BRICK]) {
    const float *self = brick + row * ISO_BRICK, *below = self - ISO_BRICK, *behind = self - ISO_BRICK_ROWS,
                *both = behind - ISO_BRICK;
    const bool has_below = row % ISO_BRICK > 0, has_behind = row >= ISO_BRICK;
    if (has_below && has_behind)
        for (int x = 0; x < ISO_BRICK; x++) base[x] = below[x] + behind[x] - both[x];
    else if (has_below || has_behind)
        memcpy(base, has_below ? below : behind, ISO_BRICK * sizeof *base);
    else
        memset(base, 0, ISO_BRICK * sizeof *base);
}

/* The bits of the prediction of a voxel of a row, in the order of numbers. */
static uint32_t predict(const float *self, const float base[ISO_BRICK], int x) {
    const float value = x ? base[x] + (self[x - 1] - base[x - 1]) : base[0],
                is = value == value ? value : 0; /* (not a number: its bits might depend on the compiler) */
    uint32_t bits;
    memcpy(&bits, &is, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

static float value_of(uint32_t bits) {
    float value;
    bits = bits >> 31 ? bits & ~(1u << 31) : ~bits;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Eight bytes as a number, the same on every machine; compilers make one instruction of each. */
static uint64_t get_eight(const uint8_t *bytes) {
    uint64_t value = 0;
    for (int i = 0; i < PADDING; i++) value |= (uint64_t)bytes[i] << 8 * i;
    return value;
}
static void put_eight(uint8_t *bytes, uint64_t value) {
    for (int i = 0; i < PADDING; i++) bytes[i] = (uint8_t)(value >> 8 * i);
}

/* Numbers of up to eight times four bits, which begin at the four bits `at`; they are written one after the
 * other. */
static void put_fours(uint8_t *bytes, size_t at, uint64_t value) {
    const uint64_t before = at % 2 ? bytes[at / 2] & 15u : 0;
    put_eight(bytes + at / 2, value << 4 * (at % 2) | before);
}
static uint64_t get_fours(const uint8_t *bytes, size_t at, unsigned steps) {
    return get_eight(bytes + at / 2) >> 4 * (at % 2) & ((1ull << 4 * steps) - 1);
}

size_t iso_cell_delta_pack(const float *before, const float *after, float band, uint8_t *bytes) {
    uint8_t rows[ROW_BYTES] = {0}, codes[ISO_BRICK_VOXELS / 2 + PADDING],
            values[ISO_BRICK_VOXELS * 4 + PADDING];
    const float inside = -band;
    size_t size = ROW_BYTES, count = 0, fours = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const float *a = before + row * ISO_BRICK, *b = after + row * ISO_BRICK;
        float base[ISO_BRICK];
        if (memcmp(a, b, ISO_BRICK * sizeof *a) == 0) continue;
        const uint16_t bits = find_row(a, b);
        rows[row / 8] = (uint8_t)(rows[row / 8] | 1u << row % 8);
        memcpy(bytes + size, &bits, sizeof bits);
        size += sizeof bits;
        predict_row(after, row, base);
        for (unsigned left = bits; left; left &= left - 1, count++) {
            const int x = __builtin_ctz(left);
            if (memcmp(b + x, &band, sizeof band) == 0 || memcmp(b + x, &inside, sizeof inside) == 0) {
                put_fours(codes, count, b[x] > 0 ? OUTSIDE : INSIDE);
                continue;
            }
            const uint32_t way = bits_of(b[x]) - predict(b, base, x);
            const uint32_t code = way << 1 ^ (way >> 31 ? ~0u : 0u); /* small for small differences */
            const unsigned steps = code ? (35 - (unsigned)__builtin_clz(code)) / 4 : 0;
            put_fours(values, fours, code);
            put_fours(codes, count, DISTANCE + steps);
            fours += steps;
        }
    }
    if (!count) return 0;
    memcpy(bytes, rows, sizeof rows);
    memcpy(bytes + size, codes, (count + 1) / 2);
    size += (count + 1) / 2;
    memcpy(bytes + size, values, (fours + 1) / 2);
    size += (fours + 1) / 2;
    memset(bytes + size, 0, PADDING);
    return size + PADDING;
}

/* The number of rows of a delta, and of its voxels. */
static size_t count_rows(const uint8_t *bytes) {
    size_t count = 0;
    for (int i = 0; i < ROW_BYTES; i++) count += (size_t)__builtin_popcount(bytes[i]);
    return count;
}

static size_t count_voxels(const uint8_t *bytes, size_t rows) {
    size_t count = 0;
    for (size_t i = 0; i < rows; i++) {
        uint16_t bits;
        memcpy(&bits, bytes + ROW_BYTES + i * sizeof bits, sizeof bits);
        count += (size_t)__builtin_popcount(bits);
    }
    return count;
}

void iso_cell_delta_apply(const uint8_t *bytes, size_t size, float band, float *brick) {
    if (!size) return;
    const size_t rows = count_rows(bytes), voxels = count_voxels(bytes, rows);
    const uint8_t *at = bytes + ROW_BYTES, *codes = at + rows * sizeof(uint16_t),
                  *values = codes + (voxels + 1) / 2;
    size_t number = 0, fours = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint16_t bits;
        float base[ISO_BRICK], *out = brick + row * ISO_BRICK;
        if (!(bytes[row / 8] >> row % 8 & 1)) continue;
        memcpy(&bits, at, sizeof bits);
        at += sizeof bits;
        predict_row(brick, row, base);
        for (unsigned left = bits; left; left &= left - 1, number++) {
            const int x = __builtin_ctz(left);
            const unsigned code = (unsigned)get_fours(codes, number, 1);
            if (code < DISTANCE) {
                out[x] = code == INSIDE ? -band : band;
                continue;
            }
            uint32_t way = (uint32_t)get_fours(values, fours, code - DISTANCE);
            fours += code - DISTANCE;
            way = way >> 1 ^ (way & 1 ? ~0u : 0u);
            out[x] = value_of(predict(out, base, x) + way);
        }
    }
}

void iso_cell_delta_add_bits(const uint8_t *bytes, size_t size, iso_voxel_bits *bits) {
    const uint8_t *at = bytes + ROW_BYTES;
    for (int row = 0; size && row < ISO_BRICK_ROWS; row++) {
        uint16_t row_bits;
        if (!(bytes[row / 8] >> row % 8 & 1)) continue;
        memcpy(&row_bits, at, sizeof row_bits);
        at += sizeof row_bits;
        bits->row[row] |= row_bits;
    }
}
