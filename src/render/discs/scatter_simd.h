/* scatter_simd: adds small discs of patches in which some discs are curved, a vector of discs at a time.
 * All discs of the vector are intersected with the rays of the first pixel of their boxes, then of the
 * second, and so on; afterwards the hits are added to the sums of single pixels, disc by disc. */
#ifndef ISO_RENDER_DISCS_SCATTER_SIMD_H
#define ISO_RENDER_DISCS_SCATTER_SIMD_H

#include "render/discs/flat_simd.h"

/* STEPS: pixels of a scattered disc's box, at most; WORDS: 32-bit words with a bit for each. */
enum { STEPS = ISO_DISCS_BOX * ISO_DISCS_BOX, WORDS = (STEPS + 31) / 32 };
/* Adds `weight` times a record to a pixel's sums, which count as 0 unless `keep`. The record's last float is
 * replaced by `depth`. */
#if ISO_LANES == 16
ISO_INLINE void add_record(float *sums, const float *record, float depth, float weight, bool keep) {
    const __m512 old = _mm512_maskz_loadu_ps((__mmask16) - (int32_t)keep, sums);
    const __m512 value = _mm512_mask_broadcastss_ps((__m512)v_load(record), 0x8000, _mm_set_ss(depth));
    v_store(sums, (vf)old + v_set(weight) * (vf)value);
}
#else
ISO_INLINE void add_record(float *sums, const float *record, float depth, float weight, bool keep) {
    const vi kept = v_seti(-(int32_t)keep);
    const vf w = v_set(weight);
    for (int k = 0; k < ISO_SUMS; k += ISO_LANES) {
        const vf old = v_floats(v_bits(v_load(sums + k)) & kept);
        vf value = v_load(record + k);
        if (k + ISO_LANES == ISO_SUMS) value[ISO_LANES - 1] = depth;
        v_store(sums + k, old + w * value);
    }
}
#endif

/* The values that each of a vector of discs adds to a pixel's sums, before weighting, except depth. */
typedef struct rf_records {
    _Alignas(64) float value[ISO_LANES][ISO_SUMS];
} rf_records;

ISO_INLINE void make_records(const vf *disc, rf_records *records) {
    const vf first[4] = {v_set(1), disc[ISO_DISC_LIT_X], disc[ISO_DISC_LIT_Y], disc[ISO_DISC_LIT_Z]},
             last[4] = {disc[ISO_DISC_X], disc[ISO_DISC_Y], disc[ISO_DISC_Z], v_set(0)};
    v_store4(records->value[0], ISO_SUMS, first);
    v_store4(records->value[0] + 4, ISO_SUMS, disc + ISO_DISC_XX);
    v_store4(records->value[0] + 8, ISO_SUMS, disc + ISO_DISC_YZ);
    v_store4(records->value[0] + 12, ISO_SUMS, last);
}

/* Hits of a vector of discs. Step k is the k-th pixel of each disc's box; arrays are indexed by
 * step * ISO_LANES + lane. */
typedef struct rf_hits {
    float weight[STEPS * ISO_LANES];
    float depth[STEPS * ISO_LANES];
    int32_t at[STEPS * ISO_LANES]; /* index of the pixel in the patch */
    vi corner;                     /* index of the first pixel of each box */
    int steps, words;              /* number of steps; words of `hits` in use, 0: `few` is used */
    vi hits[WORDS];                /* bit step % 32 of word step / 32 is set where a disc is hit */
    uint64_t few;                  /* the same for at most FEW steps: bit lane * FEW + step */
} rf_hits;

/* Intersects the discs with the pixels of row at[1] of their boxes, of at[0] columns, from step at[2] on. */
ISO_INLINE void intersect_row(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                              const rf_disc *discs, const rf_bounds *bounds, const int at[3], rf_hits *out) {
    const vf *disc = discs->value;
    const vi y = bounds->lo[1] + at[1];
    const vf first = v_to_float(bounds->lo[0]) + 0.5f,
             line = v_to_float(y + params->target->view->above) + 0.5f;
    const vm live = v_andnot(discs->live, v_lti(bounds->hi[1], y)), cut = discs->clipped;
    const vf dy = line - disc[ISO_DISC_ROW];
    const rf_row row = start_row(disc, curved, dy, ray_slope(params, 1, line));
    for (int x = 0, step = at[2]; x < at[0]; x++, step++) {
        const vf column = first + (float)x; /* exact: small multiples of 0.5 */
        const vf dx = column - disc[ISO_DISC_COLUMN];
        rf_hit hit = intersect(params, disc, curved, &row, dx, ray_slope(params, 0, column), bounds->exact);
        if (v_mask(cut)) clip_to_boxes(params, disc, &hit);
        if (params->cuts && v_mask(cut)) cut_hits(params, disc, &hit);
        v_store(out->weight + step * ISO_LANES, gaussian(hit.far));
        v_store(out->depth + step * ISO_LANES, disc[ISO_DISC_Z] + hit.q[2]);
        v_storei(out->at + step * ISO_LANES, out->corner + (at[1] * (int32_t)patch->stride + x));
        const vm hits =
            v_and(v_andnot(live, v_lti(bounds->hi[0], bounds->lo[0] + x)), v_lt(hit.far, v_set(1)));
        const vi bit = v_seti((int32_t)((uint32_t)1 << (step & 31)));
        if (out->words)
            out->hits[step >> 5] |= v_selecti(hits, bit, v_seti(0));
        else
            out->few |= spread(v_mask(hits)) << step;
    }
}

/* The values of a vector of discs with which their hits are added. */
typedef struct rf_adder {
    rf_records records;
    float thickness[ISO_LANES], side[ISO_LANES];
} rf_adder;

/* Adds hit number `which` (step * ISO_LANES + lane) to its pixel, by the rules of add_disc in splat_simd.h.
 */
ISO_INLINE void add_hit(const iso_discs_params *params, const iso_discs_patch *patch, const rf_hits *m,
                        uint32_t which, const rf_adder *discs) {
    const uint32_t lane = which % ISO_LANES;
    const float depth = m->depth[which], thickness = discs->thickness[lane];
    const int32_t at = m->at[which];
    float *sums = patch->sums + (ptrdiff_t)at * ISO_SUMS;
    const float front = patch->front[at];
    if (!(depth <= front + thickness)) return;
    if (patch->limit && !(depth <= patch->limit[at] + thickness)) return;
    /* a pixel without discs has its front far behind: the sums, which are undefined, are not kept */
    bool keep = depth >= front - thickness;
    float nearest = depth < front && !(params->first && keep) ? depth : front;
    if (!params->cull && keep && (sums[ISO_SUM_SIDE] < 0) != (discs->side[lane] < 0)) {
        if (discs->side[lane] < 0) return;
        keep = false;
        nearest = depth;
    }
    patch->front[at] = nearest;
    add_record(sums, discs->records.value[lane], depth, m->weight[which], keep);
}

/* Lists the numbers of all hits, disc by disc; returns how many. */
ISO_INLINE uint32_t list_hits(const rf_hits *found, int32_t *list) {
    uint32_t hits[WORDS][ISO_LANES], count = 0;
    for (int k = 0; k < found->words; k++) v_storei((int32_t *)hits[k], found->hits[k]);
    for (int lane = 0; lane < ISO_LANES; lane++)
        for (int step = 0; step < found->steps; step += ISO_LANES) {
            const uint32_t some = hits[step / 32][lane] >> (step % 32) & (uint32_t)((1 << ISO_LANES) - 1);
            const vi which = (v_lanes() + step) * ISO_LANES + lane;
            v_compressi(list + count, v_from_mask(some), which);
            count += (uint32_t)__builtin_popcount(some);
        }
    return count;
}

/* Adds all hits to their pixels, disc by disc. */
ISO_STEP static void add_hits(const iso_discs_params *params, const iso_discs_patch *patch,
                              const rf_disc *discs, const rf_hits *found) {
    rf_adder adder;
    int32_t list[STEPS * ISO_LANES + ISO_LANES];
    make_records(discs->value, &adder.records);
    v_store(adder.thickness, ISO_DISCS_THICKNESS * discs->value[ISO_DISC_RADIUS]);
    v_store(adder.side, discs->value[ISO_DISC_SIDE]);
    const uint32_t count = found->words ? list_hits(found, list) : list_few_hits(found->few, list);
    for (uint32_t i = 0; i < count; i++) add_hit(params, patch, found, (uint32_t)list[i], &adder);
}

/* The number of columns (axis 0) or rows (axis 1) of the largest box of a live disc. */
ISO_INLINE int largest_box(const rf_bounds *bounds, int axis, vm live) {
    int most = 1;
    while (v_mask(v_and(live, v_lti(bounds->lo[axis] + (most - 1), bounds->hi[axis])))) most++;
    return most;
}

/* Adds a vector of discs to the patch. */
ISO_INLINE void scatter_discs(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                              rf_disc *discs) {
    rf_bounds bounds;
    rf_hits found;
    discs->live = bound_discs(params, patch, curved, false, discs, &bounds);
    /* A disc can be larger than its block's `radius` only when it is not between the picture's sides at
     * its depth: it would cover hardly anything. */
    const vf most = v_set((ISO_DISCS_BOX - 1) / 2);
    discs->live = v_and(discs->live, v_le(discs->value[ISO_DISC_PIXELS], most));
    if (!v_mask(discs->live)) return;
    const int columns = largest_box(&bounds, 0, discs->live), rows = largest_box(&bounds, 1, discs->live);
    assert(columns * rows <= STEPS);
    found.corner = (bounds.lo[1] - patch->first[1]) * (int32_t)patch->stride + bounds.lo[0] - patch->first[0];
    found.steps = columns * rows;
    found.words = found.steps <= FEW ? 0 : (found.steps + 31) / 32;
    found.few = 0;
    for (int k = 0; k < found.words; k++) found.hits[k] = v_seti(0);
    for (int y = 0; y < rows; y++) {
        const int at[3] = {columns, y, y * columns};
        intersect_row(params, patch, curved, discs, &bounds, at, &found);
    }
    add_hits(params, patch, discs, &found);
}

ISO_INLINE void scatter_curved(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    scatter_discs(params, patch, true, discs);
}

/* Flat discs in a patch that has curved ones too. */
ISO_INLINE void scatter_mixed(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    scatter_discs(params, patch, false, discs);
}

static void scatter_block(const iso_discs_params *params, const iso_discs_patch *patch, uint32_t block) {
    if (params->centres) /* as if filtered: discs between the centres of pixels are kept */
        make_discs(params, patch, block, false, true, scatter_centres);
    else if (patch->flat && iso_discs_use_filter(params, &params->blocks[block]))
        make_discs(params, patch, block, false, true, scatter_filtered);
    else if (patch->flat)
        make_discs(params, patch, block, false, false, scatter_flat);
    else if (iso_discs_use_curvature(params, &params->blocks[block]))
        make_discs(params, patch, block, true, false, scatter_curved);
    else
        make_discs(params, patch, block, false, false, scatter_mixed);
}

/* Loads sums and fronts of a vector of pixels from index `at` on. */
ISO_INLINE void load_pixels(const iso_discs_patch *patch, size_t at, rf_sums *sums) {
    int32_t index[ISO_LANES];
    v_storei(index, v_lanes() * ISO_SUMS);
    v_load4(patch->sums + at * ISO_SUMS, index, ISO_SUMS / 4, sums->value);
    sums->front = v_load(patch->front + at);
}

ISO_INLINE void resolve_row(const iso_discs_params *params, const iso_discs_patch *patch, const bool flat,
                            int y) {
    const int width = params->target->view->width;
    const vf row = v_set((float)(y + params->target->view->above) + 0.5f);
    for (int x = patch->first[0]; x <= patch->last[0]; x += ISO_LANES) {
        const size_t at = (size_t)(y - patch->first[1]) * patch->stride + (size_t)(x - patch->first[0]),
                     to = (size_t)y * (size_t)width + (size_t)x;
        const int left = patch->last[0] - x + 1;
        if (!v_mask(v_lt(v_load(patch->front + at), v_set(ISO_NOWHERE)))) continue;
        rf_sums sums;
        if (patch->flat)
            load_flat_pixels(patch, at, !flat, &sums);
        else
            load_pixels(patch, at, &sums);
        const vf column = v_to_float(v_lanes() + x) + 0.5f;
        const rf_samples samples = resolve_sums(params, &sums, flat, column, row);
        if (left >= ISO_LANES) {
            write_samples(params, to, &samples);
            continue;
        }
        rf_stored stored;
        store_samples(&samples, &stored);
        write_some_samples(params, to, 0, left, &stored);
    }
}

static void resolve_pixels(const iso_discs_params *params, const iso_discs_patch *patch) {
    for (int y = patch->first[1]; y <= patch->last[1]; y++)
        if (patch->flat && !params->colored)
            resolve_row(params, patch, true, y);
        else
            resolve_row(params, patch, false, y);
}

/* Updates deepest[cell] by `count` fronts of pixels that lie in one cell, that of column x and row y of
 * the patch. */
ISO_INLINE void note_deepest(const iso_discs_patch *patch, int x, int y, int count, const float *front,
                             float *deepest) {
    float *to = &deepest[(y >> patch->shift) * patch->cells + (x >> patch->shift)], most = *to;
    for (int i = 0; i < count; i++) most = front[i] > most ? front[i] : most;
    *to = most;
}

static void find_deepest_pixels(const iso_discs_patch *patch, float *deepest) {
    const int rows = patch->last[1] - patch->first[1] + 1, side = 1 << patch->shift;
    for (int y = 0; y < rows; y += side)
        for (int x = 0; x < (int)patch->stride; x += ISO_LANES_MAX) {
            vf most[ISO_LANES_MAX / ISO_LANES];
            for (int k = 0; k < ISO_LANES_MAX / ISO_LANES; k++) most[k] = v_set(-ISO_NOWHERE);
            for (int row = y; row < y + side && row < rows; row++)
                for (int k = 0; k < ISO_LANES_MAX / ISO_LANES; k++)
                    most[k] = v_max(most[k], v_load(patch->front + (size_t)row * patch->stride +
                                                    (size_t)(x + k * ISO_LANES)));
            float all[ISO_LANES_MAX];
            for (int k = 0; k < ISO_LANES_MAX / ISO_LANES; k++) v_store(all + k * ISO_LANES, most[k]);
            note_deepest(patch, x, y, 8, all, deepest);
            note_deepest(patch, x + 8, y, 8, all + 8, deepest);
        }
}

#endif
