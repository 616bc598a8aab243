/* ray_cell_simd: decides for vectors of pairs of a pixel and a cell whether the pixel's ray crosses the
 * surface in the cell. The ray is clipped to the cell (its chord); the field along the chord is a cubic
 * (Parker et al. 1998), whose sign changes are counted by those of its Bernstein coefficients. The general
 * test also handles ties (faces that equal the isovalue), the near plane and cells next to the eye; the plain
 * test leaves these out. */
#ifndef ISO_EXACT_RAY_CELL_SIMD_H
#define ISO_EXACT_RAY_CELL_SIMD_H

#include "exact/clip_simd.h"
#include "exact/kernel_simd.h"

/* Cubics cut at their critical points into three monotone pieces, 0 .. first .. second .. 1. */
typedef struct ex_pieces {
    vf first, second, value1, value2; /* where the middle piece begins and ends, and the values there */
    vm in[3];                         /* whether each piece changes its sign */
} ex_pieces;

/* Cuts a cubic at its critical points. end_state: the bits of the cubic's value at 1, of which only the sign
 * is used. */
ISO_INLINE void cut_cubic(const vf f[4], vi end_state, ex_pieces *p) {
    const vf zero = v_set(0), one = v_set(1), triple = 3 * f[3];
    const vf root = v_sqrt(v_max(f[2] * f[2] - triple * f[1], zero));
    const vf sum = -(f[2] + v_floats(v_bits(root) | (v_bits(f[2]) & INT32_MIN)));
    const vf a = v_min(v_max(sum / triple, zero), one), b = v_min(v_max(f[1] / sum, zero), one);
    p->first = v_min(a, b);
    p->second = v_max(a, b);
    p->value1 = ((f[3] * p->first + f[2]) * p->first + f[1]) * p->first + f[0];
    p->value2 = ((f[3] * p->second + f[2]) * p->second + f[1]) * p->second + f[0];
    const vi state0 = v_bits(f[0]), state1 = v_bits(p->value1), state2 = v_bits(p->value2);
    p->in[0] = v_lti(state0 ^ state1, v_seti(0));
    p->in[1] = v_lti(state1 ^ state2, v_seti(0));
    p->in[2] = v_lti(state2 ^ end_state, v_seti(0));
}

/* Replaces chord and cubic, in the lanes `which`, by their piece from `low` to `high`, where the cubic has
 * the value `value` at `low`. */
ISO_INLINE void take_piece(vm which, vf low, vf high, vf value, ex_chord *chord) {
    vf *f = chord->f;
    const vf width = high - low, triple = 3 * f[3];
    const vf slope = (triple * low + (f[2] + f[2])) * low + f[1], bend = triple * low + f[2];
    f[0] = v_select(which, value, f[0]);
    f[1] = v_select(which, slope * width, f[1]);
    f[2] = v_select(which, bend * width * width, f[2]);
    f[3] = v_select(which, f[3] * width * width * width, f[3]);
    for (int i = 0; i < 3; i++) {
        chord->entry[i] = v_select(which, chord->entry[i] + low * chord->step[i], chord->entry[i]);
        chord->step[i] = v_select(which, chord->step[i] * width, chord->step[i]);
    }
    chord->depth = v_select(which, chord->depth + low * chord->length, chord->depth);
    chord->length = v_select(which, chord->length * width, chord->length);
}

/* For the lanes `which`, whose cubic may change its sign more than once: replaces chord and cubic by the
 * first monotone piece that changes sign. Returns the lanes that have such a piece. */
ISO_INLINE vm first_monotone_piece(vm which, vi end_state, ex_chord *chord) {
    ex_pieces p;
    cut_cubic(chord->f, end_state, &p);
    const vf zero = v_set(0), one = v_set(1);
    const vf low = v_select(p.in[0], zero, v_select(p.in[1], p.first, p.second)),
             high = v_select(p.in[0], p.first, v_select(p.in[1], p.second, one)),
             value = v_select(p.in[0], chord->f[0], v_select(p.in[1], p.value1, p.value2));
    take_piece(which, low, high, value, chord);
    return v_and(which, v_or(p.in[0], v_or(p.in[1], p.in[2])));
}

/* The lanes whose cubic changes its sign exactly once in [0, 1], as its Bernstein coefficients do. *more:
 * lanes whose coefficients change sign several times, so that the cubic may have any number of changes. *end:
 * the bits of the cubic's value at 1, of which only the sign counts. 0 counts as positive: at or above the
 * isovalue. */
ISO_INLINE vm single_changes(const ex_ties *ties, const ex_chord *chord, vm *more, vi *end) {
    const vf *f = chord->f;
    const vf b1 = 3 * f[0] + f[1], b2 = b1 + (f[1] + f[2]); /* three times the inner Bernstein coefficients */
    const vi start = v_bits(f[0]);
    *end = v_bits((f[0] + f[1]) + (f[2] + f[3]));
    if (ties) *end = v_selecti(v_andnot(ties->exit, ties->touching), v_seti(0), *end);
    const vi d1 = start ^ v_bits(b1), d2 = start ^ v_bits(b2), d3 = start ^ *end;
    const vm any = v_and(chord->meets, v_lti(d1 | d2 | d3, v_seti(0)));
    const vm once = v_and(any, v_lti(d3 & ~(d1 & ~d2), v_seti(0)));
    *more = v_andnot(any, once);
    return once;
}

/* The lanes whose cubic changes its sign; the chord is then cut to a piece with one change. */
ISO_INLINE vm changes(const ex_ties *ties, ex_chord *chord) {
    vm more;
    vi end;
    const vm once = single_changes(ties, chord, &more, &end);
    return v_mask(more) ? v_or(once, first_monotone_piece(more, end, chord)) : once;
}

/* The lanes whose change of sign may lie just outside the cell, so that false_hits must be called: at one
 * end of the chord the value is at or above the isovalue, but very small compared to the value at the
 * other end. */
ISO_INLINE vm may_be_false(const ex_chord *chord) {
    const vf *f = chord->f, end = (f[0] + f[1]) + (f[2] + f[3]);
    return v_lt(v_max(f[0], end) * 1024, -v_min(f[0], end));
}

/* The lanes, as bits, in which the field is certainly below the isovalue in the whole cell. Tests enlarge
 * cells by ISO_EXACT_WIDER, and continue the cell's cubic there. Where the field falls just short of the
 * isovalue at a face, the continued cubic can cross it outside the cell, although the neighbour's field does
 * not: that crossing is false. Dropping it opens no hole: a true rise through the isovalue at a face is also
 * found by the cell behind the face, and where the field falls through the isovalue it was above it before.
 */
ISO_STEP static uint32_t false_hits(const iso_exact_projection *projection, const iso_exact_scratch *scratch,
                                    int first) {
    const float rounding = 4e-7f; /* of the field, by the sum of its coefficients */
    const bool large = scratch->large;
    const float *shift = scratch->record[scratch->owner[0] / RECORD_FLOATS].shift;
    const vf zero = v_set(0), one = v_set(1);
    ex_cells cells;
    ex_chord chord;
    if (large)
        load_cells(scratch, first, (ex_test_kind){true, true, false}, &cells);
    else
        load_cells(scratch, first, (ex_test_kind){false, false, false}, &cells);
    make_chords(projection, &scratch->octant_projection, v_loadi(scratch->pixel + first), &cells, &chord,
                NULL);
    set_cubic(cells.field, &chord);
    vf sum = zero, low = zero, high = one; /* the part of the chord between the cell's faces */
    for (int k = 0; k < 8; k++) sum += v_abs(cells.field[k]);
    for (int k = 0; k < 3; k++) {
        const vf entry = large ? chord.entry[k] + shift[k] : chord.entry[k];
        const vf a = (-one - entry) / chord.step[k], b = (one - entry) / chord.step[k];
        low = v_max(v_min(a, b), low);
        high = v_min(v_max(a, b), high);
    }
    const vf *f = chord.f, width = high - low;
    const vf start = ((f[3] * low + f[2]) * low + f[1]) * low + f[0],
             end = ((f[3] * high + f[2]) * high + f[1]) * high + f[0],
             start_slope = (3 * f[3] * low + 2 * f[2]) * low + f[1],
             end_slope = (3 * f[3] * high + 2 * f[2]) * high + f[1];
    const vf inner = v_max(3 * start + start_slope * width, 3 * end - end_slope * width);
    const vf most = v_max(v_max(3 * start, 3 * end), inner); /* 3 * the largest Bernstein coefficient */
    return v_mask(v_and(v_le(zero, width), v_lt(most, -3 * rounding * sum)));
}

/* The lanes whose cells need only the plain test. */
ISO_INLINE vm needs_no_general_test(const iso_exact_octant_projection *octant_projection,
                                    const ex_cells *cells) {
    return v_eqi(octant_projection->near || octant_projection->clip ? v_seti(1) : cells->flags, v_seti(0));
}

/* The lanes of `mask` without those whose change of sign is false (false_hits). Which pairs share a vector
 * depends on the instruction set and the band, so that a lane's result must not depend on the other lanes:
 * those in doubt are selected one by one. */
ISO_INLINE vm without_false_hits(const iso_exact_projection *projection, const iso_exact_scratch *scratch,
                                 int first, ex_test_kind test_kind, const ex_cells *cells,
                                 const ex_chord *chord, vm mask) {
    vm doubt = v_and(mask, may_be_false(chord));
    if (test_kind.general) doubt = v_and(doubt, needs_no_general_test(&scratch->octant_projection, cells));
    if (!v_mask(doubt)) return mask;
    return v_andnot(mask, v_and(doubt, v_from_mask(false_hits(projection, scratch, first))));
}

/* Queues the pairs of the lanes `mask`, whose cubics change sign once. flags: of the pairs' cells; needed
 * when layers are listed. */
ISO_INLINE void queue_pairs(iso_exact_scratch *scratch, int first, ex_test_kind test_kind,
                            const ex_chord *chord, vm mask, vi flags) {
    iso_exact_hits *hits = &scratch->hits;
    const float *shift = scratch->record[scratch->owner[0] / RECORD_FLOATS].shift;
    const int n = hits->count;
    for (int k = 0; k < 4; k++) v_compress(hits->cubic[k] + n, mask, chord->f[k]);
    for (int k = 0; k < 3; k++) {
        v_compress(hits->entry[k] + n, mask, test_kind.large ? chord->entry[k] + shift[k] : chord->entry[k]);
        v_compress(hits->step[k] + n, mask, chord->step[k]);
    }
    v_compress(hits->depth + n, mask, chord->depth);
    v_compress(hits->length + n, mask, chord->length);
    v_compressi(hits->pixel + n, mask, v_loadi(scratch->pixel + first));
    if (ISO_EXACT_LAYERED) v_compressi(hits->word + n, mask, flags);
    /* `slot` holds the offset of the cell's record until claim_pixels replaces it by the slot */
    if (!test_kind.large) v_compressi(hits->slot + n, mask, v_loadi(scratch->owner + first));
    hits->count = n + __builtin_popcount(v_mask(mask));
}

/* Reports the pixels of the lanes `which` as doubtful: their cubics nearly touch the isovalue between two
 * crossings, so that rounding decides whether these are found. rounding: of the cubics' values. */
ISO_STEP static void doubt_touching(iso_exact_scratch *scratch, int first, vm which, const ex_pieces *p,
                                    vf rounding) {
    const vf zero = v_set(0), one = v_set(1);
    const vm touches1 =
                 v_and(v_lt(v_abs(p->value1), rounding), v_and(v_lt(zero, p->first), v_lt(p->first, one))),
             touches2 =
                 v_and(v_lt(v_abs(p->value2), rounding), v_and(v_lt(zero, p->second), v_lt(p->second, one)));
    for (uint32_t lanes = v_mask(v_and(which, v_or(touches1, touches2))); lanes; lanes &= lanes - 1) {
        const int32_t pixel = scratch->pixel[first + __builtin_ctz(lanes)];
        iso_layer_doubt(scratch->lists, pixel & 0xffff, (pixel >> 16) - scratch->rows.first);
    }
}

/* Queues all crossings of a vector of pairs, some of which (`more`) may cross the surface several times; pair
 * by pair, as a vector can hold the same pixel with two cells. once: the pairs that cross once; end: as in
 * cut_cubic; rounding: of the cubics' values. */
ISO_STEP static void queue_pieces(iso_exact_scratch *scratch, int first, ex_test_kind test_kind,
                                  const ex_chord *chord, vm once, vm more, vi end, vi flags, vf rounding) {
    const vf zero = v_set(0), one = v_set(1);
    ex_pieces p;
    cut_cubic(chord->f, end, &p);
    doubt_touching(scratch, first, more, &p, rounding);
    ex_chord piece[3] = {*chord, *chord, *chord};
    take_piece(more, zero, p.first, chord->f[0], &piece[0]); /* where there is one crossing: all */
    take_piece(more, p.first, p.second, p.value1, &piece[1]);
    take_piece(more, p.second, one, p.value2, &piece[2]);
    const uint32_t crossed[3] = {v_mask(v_or(once, v_and(more, p.in[0]))), v_mask(v_and(more, p.in[1])),
                                 v_mask(v_and(more, p.in[2]))};
    for (uint32_t lanes = crossed[0] | crossed[1] | crossed[2]; lanes; lanes &= lanes - 1) {
        const uint32_t lane = lanes & (0 - lanes);
        for (int k = 0; k < 3; k++)
            if (crossed[k] & lane)
                queue_pairs(scratch, first, test_kind, &piece[k], v_from_mask(lane), flags);
    }
}

/* Queues every crossing of the lanes `present` of a vector of pairs; returns the lanes that have some. */
ISO_INLINE uint32_t queue_crossings(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                    int first, ex_test_kind test_kind, const ex_cells *cells,
                                    const ex_chord *chord, const ex_ties *ties, vm present) {
    vm more;
    vi end;
    const vi flags = test_kind.general ? cells->flags : v_seti(0);
    const vm once = single_changes(ties, chord, &more, &end);
    vm mask = v_and(present, v_or(once, more));
    if (!v_mask(mask)) return 0;
    mask = without_false_hits(projection, scratch, first, test_kind, cells, chord, mask);
    if (v_mask(v_and(more, mask))) {
        vf sum = v_set(0);
        for (int k = 0; k < 8; k++) sum += v_abs(cells->field[k]);
        queue_pieces(scratch, first, test_kind, chord, v_and(once, mask), v_and(more, mask), end, flags,
                     ISO_EXACT_ROUNDING * sum);
    } else {
        queue_pairs(scratch, first, test_kind, chord, mask, flags);
    }
    return v_mask(mask);
}

/* The first crossings of a vector of pairs that bodies cut; returns the lanes that have one. Their chords are
 * collected piece by piece and queued together, because a vector can hold the same pixel with two cells, the
 * nearer one first. */
ISO_INLINE uint32_t queue_first_of_pieces(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                          int first, ex_test_kind test_kind, const ex_cells *cells,
                                          const ex_chord *chord, const ex_ties *ties, const ex_rest *rest,
                                          vm present) {
    ex_chord found = *chord;
    vm hits = v_lti(v_seti(1), v_seti(0));
    for (int i = 0; i < rest->pieces; i++) {
        ex_chord piece;
        ex_ties ends;
        cut_chord(cells, chord, ties, rest->low[i], rest->high[i], &piece, &ends);
        vm hit = v_and(v_andnot(present, hits), changes(&ends, &piece));
        if (!v_mask(hit)) continue;
        hit = without_false_hits(projection, scratch, first, test_kind, cells, &piece, hit);
        take_chord(hit, &piece, &found);
        hits = v_or(hits, hit);
    }
    if (v_mask(hits)) queue_pairs(scratch, first, test_kind, &found, hits, v_seti(0));
    return v_mask(hits);
}

/* Queues every crossing of a vector of pairs that bodies cut, pair by pair where a ray is in several pieces;
 * returns the lanes that have some. */
ISO_INLINE uint32_t queue_all_of_pieces(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                        int first, ex_test_kind test_kind, const ex_cells *cells,
                                        const ex_chord *chord, const ex_ties *ties, const ex_rest *rest,
                                        vm present) {
    uint32_t crossed = 0, lanes = rest->pieces > 1 ? v_mask(present) : 1;
    for (; lanes; lanes &= lanes - 1) {
        const vm some = rest->pieces > 1 ? v_from_mask(lanes & (0 - lanes)) : present;
        for (int i = 0; i < rest->pieces; i++) {
            ex_chord piece;
            ex_ties ends;
            cut_chord(cells, chord, ties, rest->low[i], rest->high[i], &piece, &ends);
            crossed |= queue_crossings(projection, scratch, first, test_kind, cells, &piece, &ends, some);
        }
    }
    return crossed;
}

/* The same as test_vector, for pairs that bodies may cut. */
ISO_STEP static uint32_t test_cut_vector(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                         int first, ex_test_kind test_kind) {
    ex_cells cells;
    ex_chord chord;
    ex_ties ties;
    ex_rest rest;
    load_cells(scratch, first, test_kind, &cells);
    make_chords(projection, &scratch->octant_projection, v_loadi(scratch->pixel + first), &cells, &chord,
                &ties);
    cut_rays(scratch, first, test_kind, &chord, &rest);
    const vm present = v_lti(v_lanes(), v_seti(scratch->pairs - first));
    if (ISO_EXACT_LAYERED)
        return queue_all_of_pieces(projection, scratch, first, test_kind, &cells, &chord, &ties, &rest,
                                   present);
    return queue_first_of_pieces(projection, scratch, first, test_kind, &cells, &chord, &ties, &rest,
                                 present);
}

/* Tests the vector of pairs from number `first` on and queues those whose pixel shows the cell; returns their
 * lanes as bits. */
ISO_INLINE uint32_t test_vector(const iso_exact_projection *projection, iso_exact_scratch *scratch, int first,
                                ex_test_kind test_kind) {
    if (test_kind.general && scratch->cuts) return test_cut_vector(projection, scratch, first, test_kind);
    ex_cells cells;
    ex_chord chord;
    ex_ties ties;
    load_cells(scratch, first, test_kind, &cells);
    make_chords(projection, &scratch->octant_projection, v_loadi(scratch->pixel + first), &cells, &chord,
                test_kind.general ? &ties : NULL);
    set_cubic(cells.field, &chord);
    if (test_kind.general) apply_ties(&ties, &chord);
    const vm present = v_lti(v_lanes(), v_seti(scratch->pairs - first));
    if (ISO_EXACT_LAYERED)
        return queue_crossings(projection, scratch, first, test_kind, &cells, &chord,
                               test_kind.general ? &ties : NULL, present);
    vm mask = v_and(present, changes(test_kind.general ? &ties : NULL, &chord));
    mask = without_false_hits(projection, scratch, first, test_kind, &cells, &chord, mask);
    const uint32_t hit_bits = v_mask(mask);
    if (hit_bits) queue_pairs(scratch, first, test_kind, &chord, mask, v_seti(0));
    return hit_bits;
}

/* Computes and writes the queued hits if there are ISO_EXACT_HITS or more; the octant's cells then lose their
 * slots. */
ISO_INLINE void flush_if_full(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    if (scratch->hits.count >= ISO_EXACT_HITS) flush_octant(projection, scratch);
}

/* Marks the pixels of the hits from `first` on as no longer free. A hit whose pixel an earlier, nearer hit
 * has taken gets depth INFINITY. */
ISO_STEP static void claim_pixels(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                  int first) {
    const iso_gbuffer *gbuffer = projection->target->gbuffer;
    iso_exact_hits *hits = &scratch->hits;
    if (ISO_EXACT_LAYERED) fetch_lists(scratch, first);
    for (int i = first; i < hits->count; i++) {
        const int32_t pixel = hits->pixel[i], x = pixel & 0xffff, y = pixel >> 16;
        const int cell = hits->slot[i] / RECORD_FLOATS;
        const ptrdiff_t at = (ptrdiff_t)y * gbuffer->width + x;
        uint64_t *open = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words + (x >> 6);
        const uint64_t bit = (uint64_t)1 << (x & 63);
        if (!ISO_EXACT_LAYERED) {
            if (!(*open & bit)) hits->depth[i] = INFINITY; /* not written by write_hits and paint_hits */
            *open &= ~bit;
        }
        hits->slot[i] =
            scratch->slot[cell] >= 0 ? scratch->slot[cell] : reserve_slot(projection, scratch, cell);
        fetch_pixel(projection, at);
    }
    flush_if_full(projection, scratch);
}

/* Tests the listed pairs of pixel and cell. With `all`, every pair; else only full vectors of ISO_LANES
 * pairs, and the rest moves to the front of the list. */
ISO_STEP static void test_pairs(const iso_exact_projection *projection, iso_exact_scratch *scratch,
                                bool all) {
    const int end = all ? scratch->pairs : scratch->pairs / ISO_LANES * ISO_LANES;
    int first = 0;
    if (all && scratch->pairs)
        v_storei(scratch->owner + scratch->pairs, v_seti(scratch->owner[scratch->pairs - 1]));
    while (first < end) {
        const int before = scratch->hits.count;
        for (; first < end && scratch->hits.count < ISO_EXACT_HITS; first += ISO_LANES) {
            const bool general = first < scratch->general,
                       same = scratch->owner[first] == scratch->owner[first + ISO_LANES - 1];
            if (general)
                test_vector(projection, scratch, first, (ex_test_kind){false, false, true});
            else if (same)
                test_vector(projection, scratch, first, (ex_test_kind){true, false, false});
            else
                test_vector(projection, scratch, first, (ex_test_kind){false, false, false});
        }
        claim_pixels(projection, scratch, before);
    }
    const int left = first < scratch->pairs ? scratch->pairs - first : 0;
    v_storei(scratch->pixel, v_loadi(scratch->pixel + first));
    v_storei(scratch->owner, v_loadi(scratch->owner + first));
    scratch->pairs = left;
    scratch->general = scratch->general > first ? scratch->general - first : 0;
}

#endif
