/* block_ranges: collects the ranges of bricks into those of blocks. */
#include "grids/block_ranges.h"

#include <math.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "base/primitives.h"

static int brick_count(const iso_block_ranges *ranges, int axis, int block) {
    const int first = block * ISO_BLOCK_BRICKS - ranges->before[axis];
    return iso_min_int(first + ISO_BLOCK_BRICKS, ranges->bricks[axis]) - (first > 0 ? first : 0);
}

static size_t number_of(const iso_block_ranges *ranges, int x, int y, int z) {
    return ((size_t)z * (size_t)ranges->blocks[1] + (size_t)y) * (size_t)ranges->blocks[0] + (size_t)x;
}

iso_status iso_block_ranges_create(const int dims[3], const int before[3], iso_block_ranges *ranges,
                                   iso_error *error) {
    *ranges = (iso_block_ranges){.count = 1};
    for (int axis = 0; axis < 3; axis++) {
        ranges->bricks[axis] = (dims[axis] - 1) / ISO_BRICK + 1;
        ranges->before[axis] = before ? before[axis] : 0;
        ranges->blocks[axis] = (ranges->bricks[axis] + ranges->before[axis] - 1) / ISO_BLOCK_BRICKS + 1;
        ranges->count *= (size_t)ranges->blocks[axis];
    }
    ranges->unknown = ranges->count;
    ranges->lo = iso_alloc(ranges->count * sizeof *ranges->lo);
    ranges->hi = iso_alloc(ranges->count * sizeof *ranges->hi);
    ranges->states = iso_alloc_zero(ranges->count, 1);
    if (!ranges->lo || !ranges->hi || !ranges->states) {
        iso_block_ranges_free(ranges);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the ranges of %d x %d x %d voxels", dims[0],
                        dims[1], dims[2]);
    }
    for (size_t i = 0; i < ranges->count; i++) {
        ranges->lo[i] = INFINITY;
        ranges->hi[i] = -INFINITY;
    }
    return ISO_OK;
}

void iso_block_ranges_free(iso_block_ranges *ranges) {
    iso_free(ranges->lo);
    iso_free(ranges->hi);
    iso_free(ranges->states);
    *ranges = (iso_block_ranges){0};
}

static void add_brick(iso_block_ranges *ranges, const int brick[3], const iso_brick_range *range) {
    int block[3], whole = 1;
    for (int axis = 0; axis < 3; axis++) {
        block[axis] = (brick[axis] + ranges->before[axis]) / ISO_BLOCK_BRICKS;
        whole *= brick_count(ranges, axis, block[axis]);
    }
    const size_t number = number_of(ranges, block[0], block[1], block[2]);
    uint8_t *state = &ranges->states[number];
    if (*state & ISO_BLOCK_KNOWN) return;
    if (range->lo < ranges->lo[number]) ranges->lo[number] = range->lo;
    if (range->hi > ranges->hi[number]) ranges->hi[number] = range->hi;
    if (!range->finite) *state |= ISO_BLOCK_NONFINITE;
    if ((*state & ISO_BLOCK_BRICKS_SEEN) + 1 < whole) {
        ++*state;
        return;
    }
    *state = (uint8_t)((*state & ISO_BLOCK_NONFINITE) | ISO_BLOCK_KNOWN);
    ranges->unknown--;
}

void iso_block_ranges_add(iso_block_ranges *ranges, const iso_brick_box *box, const iso_brick_range *bricks) {
    for (int z = box->first[2]; z < box->end[2]; z++)
        for (int y = box->first[1]; y < box->end[1]; y++)
            for (int x = box->first[0]; x < box->end[0]; x++)
                add_brick(ranges, (const int[3]){x, y, z}, bricks++);
}

/* The blocks that overlap a box: first .. last on each axis. */
static void blocks_of(const iso_block_ranges *ranges, const iso_brick_box *box, int first[3], int last[3]) {
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = (box->first[axis] + ranges->before[axis]) / ISO_BLOCK_BRICKS;
        last[axis] = (box->end[axis] - 1 + ranges->before[axis]) / ISO_BLOCK_BRICKS;
    }
}

bool iso_block_ranges_of(const iso_block_ranges *ranges, const iso_brick_box *box, iso_brick_range *range) {
    int first[3], last[3];
    blocks_of(ranges, box, first, last);
    *range = (iso_brick_range){INFINITY, -INFINITY, true};
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++) {
                const size_t number = number_of(ranges, x, y, z);
                if (!(ranges->states[number] & ISO_BLOCK_KNOWN)) return false;
                if (ranges->lo[number] < range->lo) range->lo = ranges->lo[number];
                if (ranges->hi[number] > range->hi) range->hi = ranges->hi[number];
                range->finite &= !(ranges->states[number] & ISO_BLOCK_NONFINITE);
            }
    return true;
}

uint32_t iso_block_ranges_crossed(const iso_block_ranges *ranges, const iso_brick_box *box, float isovalue) {
    int first[3], last[3];
    uint32_t count = 0;
    blocks_of(ranges, box, first, last);
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++)
            for (int x = first[0]; x <= last[0]; x++) {
                const size_t number = number_of(ranges, x, y, z);
                count += ranges->lo[number] < isovalue && isovalue <= ranges->hi[number];
            }
    return count;
}

/* The number of bricks of a block. */
static uint64_t whole_of(const iso_block_ranges *ranges, size_t number) {
    const size_t columns = (size_t)ranges->blocks[0], rows = (size_t)ranges->blocks[1];
    const int block[3] = {(int)(number % columns), (int)(number / columns % rows),
                          (int)(number / columns / rows)};
    uint64_t whole = 1;
    for (int axis = 0; axis < 3; axis++) whole *= (uint64_t)brick_count(ranges, axis, block[axis]);
    return whole;
}

void iso_block_ranges_counts(const iso_block_ranges *ranges, size_t first, size_t count, uint64_t *bricks,
                             uint64_t *nonfinite) {
    for (size_t i = 0; i < count; i++) {
        const uint8_t state = ranges->states[first + i];
        bricks[i] = state & ISO_BLOCK_KNOWN ? whole_of(ranges, first + i) : state & ISO_BLOCK_BRICKS_SEEN;
        nonfinite[i] = (state & ISO_BLOCK_NONFINITE) != 0;
    }
}

void iso_block_ranges_set_counts(iso_block_ranges *ranges, size_t first, size_t count, const uint64_t *bricks,
                                 const uint64_t *nonfinite) {
    for (size_t i = 0; i < count; i++) {
        uint8_t *state = &ranges->states[first + i];
        const bool was_known = *state & ISO_BLOCK_KNOWN, is_known = bricks[i] >= whole_of(ranges, first + i);
        *state =
            (uint8_t)((is_known ? ISO_BLOCK_KNOWN : bricks[i]) | (nonfinite[i] ? ISO_BLOCK_NONFINITE : 0));
        if (is_known && !was_known) ranges->unknown--;
    }
}
