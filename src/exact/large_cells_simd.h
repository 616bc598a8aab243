/* large_cells_simd: cells that cover many pixels (more than ISO_EXACT_LARGE_CELL) are tested one at a time.
 * Their pixels are listed by windows of up to 64 pixels of a row, so that the pixels that hit are marked as
 * no longer free with a few mask operations. */
#ifndef ISO_EXACT_LARGE_CELLS_SIMD_H
#define ISO_EXACT_LARGE_CELLS_SIMD_H

#include "exact/cell_outlines_simd.h"
#include "exact/kernel_simd.h"

/* Marks the pixels of scratch->window that show the cell (scratch->hit_bits) as no longer free. */
ISO_INLINE void claim_windows(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const iso_gbuffer *gbuffer = projection->target->gbuffer;
    int pair = 0;
    for (int i = 0; i < scratch->windows; i++) {
        const iso_exact_row_window *window = &scratch->window[i];
        const uint64_t *hit_bits = scratch->hit_bits + (pair >> 6);
        const int from = pair & 63, x = window->pixel & 0xffff, y = window->pixel >> 16;
        pair += __builtin_popcountll(window->listed);
        const uint64_t pixels =
            deposit(hit_bits[0] >> from | hit_bits[1] << 1 << (63 - from), window->listed);
        if (!pixels) continue;
        uint64_t *open = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words + (x >> 6);
        open[0] &= ~(pixels << (x & 63));
        open[1] &= ~(pixels >> 1 >> (63 - (x & 63)));
        const ptrdiff_t at = (ptrdiff_t)y * gbuffer->width + x;
        fetch_pixels(projection, at + __builtin_ctzll(pixels), at + 63 - __builtin_clzll(pixels));
    }
}

/* Tests all listed pairs, which belong to one large cell, queues those whose pixel shows it, and empties the
 * list. */
ISO_STEP static void test_large_cell(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_hits *hits = &scratch->hits;
    const int before = hits->count;
    memset(scratch->hit_bits, 0, sizeof scratch->hit_bits);
    for (int first = 0; first < scratch->pairs; first += ISO_LANES) {
        const uint64_t hit_bits =
            scratch->general ? test_vector(projection, scratch, first, (ex_test_kind){true, true, true})
                             : test_vector(projection, scratch, first, (ex_test_kind){true, true, false});
        scratch->hit_bits[first >> 6] |= hit_bits << (first & 63);
    }
    if (hits->count > before) {
        const int cell = scratch->owner[0] / RECORD_FLOATS;
        const int32_t slot =
            scratch->slot[cell] >= 0 ? scratch->slot[cell] : reserve_slot(projection, scratch, cell);
        for (int i = before; i < hits->count; i += ISO_LANES) v_storei(hits->slot + i, v_seti(slot));
        if (ISO_EXACT_LAYERED)
            fetch_lists(scratch, before);
        else
            claim_windows(projection, scratch);
        flush_if_full(projection, scratch);
    }
    scratch->pairs = scratch->general = scratch->windows = 0;
}

/* Lists the pairs of a cell with the pixels of a row from `pixel` (y << 16 | x) on whose bits in `open` are
 * set. */
ISO_INLINE void pair_window(iso_exact_scratch *scratch, uint64_t open, int32_t pixel) {
    scratch->window[scratch->windows++] = (iso_exact_row_window){open, pixel};
    for (; open; open >>= ISO_LANES, pixel += ISO_LANES) {
        const uint32_t lanes = (uint32_t)open & ((1u << ISO_LANES) - 1);
        v_compressi(scratch->pixel + scratch->pairs, v_from_mask(lanes), v_lanes() + pixel);
        scratch->pairs += __builtin_popcount(lanes);
    }
}

/* Tests a large cell against the free pixels among the columns x .. x + 63 of its box (x0 x1 y0 y1). general:
 * with the general test; bounded: within its outline. */
ISO_INLINE void test_columns(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                             const int box[4], int x, int cell, bool general, bool bounded) {
    const uint64_t columns = box[1] - x < 63 ? ((uint64_t)2 << (box[1] - x)) - 1 : ~(uint64_t)0;
    const uint64_t *row = scratch->open + (ptrdiff_t)(box[2] - scratch->rows.first) * scratch->words;
    int32_t first[ISO_LANES], last[ISO_LANES];
    for (int y = box[2]; y <= box[3]; y++, row += scratch->words) {
        const int n = (y - box[2]) % ISO_LANES;
        if (bounded && !n) row_ends(scratch, cell, x, y, first, last);
        uint64_t open = open_pixels(row, x) & columns;
        if (bounded) open &= pixels_between(first[n], last[n]);
        if (!open) continue;
        pair_window(scratch, open, y << 16 | x);
        if (scratch->pairs >= ISO_EXACT_LARGE_LIST) {
            test_large_cell(projection, scratch);
            scratch->general = general;
        }
    }
}

/* Tests a large cell against the free pixels of its box. */
ISO_INLINE void draw_large_cell(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                const int box[4], int cell, bool general) {
    scratch->owner[0] = cell * RECORD_FLOATS;
    scratch->general = general;
    for (int x = box[0]; x <= box[1]; x += 64) {
        if (scratch->bounded && !general)
            test_columns(projection, scratch, box, x, cell, false, true);
        else
            test_columns(projection, scratch, box, x, cell, general, false);
    }
    if (scratch->pairs) test_large_cell(projection, scratch);
    scratch->general = 0;
}

#endif
