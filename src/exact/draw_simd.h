/* draw_simd: draws octants of cells: the functions of an iso_exact_kernel. */
#ifndef ISO_EXACT_DRAW_SIMD_H
#define ISO_EXACT_DRAW_SIMD_H

#include "exact/outlined_cells_simd.h"

/* Lists pairs of a cell with those pixels of the vector `keys` (y << 16 | x) whose bits in `lanes` are set.
 * owner: in each lane, the index of the cell's record in floats. */
ISO_INLINE void add_pairs(iso_exact_scratch *scratch, uint32_t lanes, vi keys, vi owner) {
    v_compressi(scratch->pixel + scratch->pairs, v_from_mask(lanes), keys);
    v_storei(scratch->owner + scratch->pairs, owner);
    scratch->pairs += __builtin_popcount(lanes);
}

/* Lists the pairs of a cell whose box is at most 4 x 4 pixels with the free pixels of the box. A vector holds
 * pixels of several rows of the box. */
ISO_INLINE void pair_small(iso_exact_scratch *scratch, const int box[4], vi owner) {
    const int word = box[0] >> 6, shift = box[0] & 63, last = box[3] - box[2];
    const uint64_t *row = scratch->open + (ptrdiff_t)(box[2] - scratch->rows.first) * scratch->words + word;
    const uint32_t columns = (2u << (box[1] - box[0])) - 1;
    uint32_t bits = 0;
    for (int y = 0; y < 4; y++) { /* for a row beyond the box: reads the last row, and drops its bits */
        const uint64_t *open = row + (ptrdiff_t)(y < last ? y : last) * scratch->words;
        const uint32_t some = (uint32_t)(open[0] >> shift | open[1] << 1 << (63 - shift)) & columns;
        bits |= (y <= last ? some : 0) << 4 * y;
    }
    const vi lanes = v_lanes(), keys = ((lanes >> 2) << 16) + (lanes & 3);
    for (int part = 0; part < 16; part += ISO_LANES) {
        const uint32_t some = bits >> part & ((1u << ISO_LANES) - 1);
        const int32_t key = (box[2] + part / 4) << 16 | box[0];
        add_pairs(scratch, some, keys + key, owner);
    }
}

/* Lists the pairs of a cell of any size with the free pixels of its box, row by row; tests the listed pairs
 * whenever there are ISO_EXACT_LIST or more. */
ISO_INLINE void pair_rows(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                          const int box[4], vi owner, bool general) {
    const uint32_t every = (1u << ISO_LANES) - 1;
    for (int y = box[2]; y <= box[3]; y++) {
        const uint64_t *row = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words;
        for (int x = box[0]; x <= box[1]; x += 64) {
            uint64_t open = open_pixels(row, x);
            if (box[1] - x < 63) open &= ((uint64_t)2 << (box[1] - x)) - 1;
            for (int32_t key = y << 16 | x; open; open >>= ISO_LANES, key += ISO_LANES)
                add_pairs(scratch, (uint32_t)open & every, v_lanes() + key, owner);
            if (general) scratch->general = scratch->pairs;
            if (scratch->pairs >= ISO_EXACT_LIST) test_pairs(projection, scratch, false);
        }
    }
}

/* Draws cell number `cell`, by the way that fits its size. The pairs of a small cell may stay listed, to be
 * tested together with those of the next cells. */
ISO_INLINE void draw_cell(const iso_exact_projection *projection, iso_exact_scratch *scratch, int cell) {
    const int box[4] = {scratch->box[0][cell], scratch->box[1][cell], scratch->box[2][cell],
                        scratch->box[3][cell]};
    const bool general = scratch->flags[cell] || scratch->octant_projection.near ||
                         scratch->octant_projection.clip || (scratch->cuts && scratch->is_cut[cell]);
    if (scratch->outlined && !general) {
        draw_outlined_cell(projection, scratch, box, cell);
        return;
    }
    if (scratch->large) {
        draw_large_cell(projection, scratch, box, cell, general);
        if (ISO_EXACT_LAYERED && scratch->outlined) flush_octant(projection, scratch);
        return;
    }
    const vi owner = v_seti(cell * RECORD_FLOATS);
    if (box[1] - box[0] < 4 && box[3] - box[2] < 4) {
        pair_small(scratch, box, owner);
        if (general) scratch->general = scratch->pairs;
    } else {
        pair_rows(projection, scratch, box, owner, general);
    }
    if (scratch->pairs >= ISO_EXACT_BATCH) test_pairs(projection, scratch, false);
}

/* ---- an octant */

/* Shrinks the rectangle `clip`, which has free pixels, to those: cells outside of it are hidden. */
ISO_INLINE void shrink_to_open(const iso_exact_scratch *scratch, int clip[4]) {
    const int first = clip[0] >> 6, last = clip[1] >> 6;
    const uint64_t from = ~(uint64_t)0 << (clip[0] & 63), to = ~(uint64_t)0 >> (63 - (clip[1] & 63));
    int box[4] = {INT_MAX, -1, INT_MAX, -1};
    for (int y = clip[2]; y <= clip[3]; y++) {
        const uint64_t *row = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words;
        for (int word = first; word <= last; word++) {
            const uint64_t open =
                row[word] & (word == first ? from : ~(uint64_t)0) & (word == last ? to : ~(uint64_t)0);
            if (!open) continue;
            const int low = word * 64 + __builtin_ctzll(open), high = word * 64 + 63 - __builtin_clzll(open);
            box[0] = low < box[0] ? low : box[0];
            box[1] = high > box[1] ? high : box[1];
            box[2] = y < box[2] ? y : box[2];
            box[3] = y;
        }
    }
    memcpy(clip, box, sizeof box);
}

/* Prefetches the data that drawing an octant reads first. */
ISO_INLINE void fetch_octant(const iso_exact_projection *projection, const iso_exact_visible *visible) {
    const iso_exact_octant *octant = &iso_exact_octants(projection->exact)[visible->octant];
    const char *corners = visible->corners;
    __builtin_prefetch(octant);
    __builtin_prefetch(&octant->cells);
    for (int line = 0; line < 12; line++) __builtin_prefetch(corners + 64 * line);
}

/* Draws the cells of an octant front to back, if the octant has free pixels in the band. */
ISO_STEP static void draw_octant(const iso_exact_projection *projection, const iso_exact_visible *visible,
                                 iso_exact_scratch *scratch) {
    if (!iso_exact_is_open(scratch, &visible->box, scratch->clip)) return;
    shrink_to_open(scratch, scratch->clip);
    scratch->span = &iso_exact_spans(projection->exact)[visible->span];
    if (!ISO_EXACT_LAYERED && projection->paint && projection->paint->keys)
        scratch->place = iso_exact_place(projection, scratch->span->brick);
    scratch->octant = &iso_exact_octants(projection->exact)[visible->octant];
    scratch->corners = visible->corners;
    scratch->octant_projection = iso_exact_project_octant(projection, scratch->span, scratch->octant);
    scratch->large =
        scratch->octant_projection.near || scratch->octant_projection.cell_pixels > ISO_EXACT_LARGE_CELL;
    list_cells(scratch);
    set_fields(projection, scratch);
    if (scratch->octant_projection.near)
        iso_exact_project_near_cells(projection, scratch);
    else
        project_far_cells(projection, scratch);
    scratch->cuts = 0;
    if (projection->clip) iso_exact_cut_octant(projection, scratch);
    scratch->bounded = has_outlines(projection, &scratch->octant_projection);
    scratch->outlined = scratch->bounded && scratch->octant_projection.cell_pixels >= ISO_EXACT_OUTLINED_CELL;
    if (ISO_EXACT_LAYERED && scratch->outlined) flush_hits(projection, scratch); /* patches do not wait */
    if (scratch->bounded) outline_cells(projection, scratch);
    rank_cells(projection, scratch);
    for (int word = 0; word < ISO_EXACT_SIDE; word++)
        for (uint64_t drawable = scratch->drawable[word]; drawable; drawable &= drawable - 1)
            draw_cell(projection, scratch, scratch->cell_of[word * 64 + __builtin_ctzll(drawable)]);
    if (scratch->pairs) test_pairs(projection, scratch, true);
}

/* iso_exact_kernel.draw. Draws each octant after it has prefetched the data of the next visible one. */
static void draw(const iso_exact_projection *projection, const iso_exact_visible *visible, int count,
                 iso_exact_scratch *scratch) {
    const iso_exact_visible *next = NULL;
    for (int i = 0; i < count; i++) {
        int clip[4];
        if (!iso_exact_is_open(scratch, &visible[i].box, clip)) continue;
        fetch_octant(projection, &visible[i]);
        if (next) draw_octant(projection, next, scratch);
        next = &visible[i];
    }
    if (next) draw_octant(projection, next, scratch);
}

#endif
