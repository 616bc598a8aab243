/* scatter_simd: adds small discs, a vector of discs at a time. All discs of the vector are intersected with
 * the rays of the first pixel of their boxes, then of the second, and so on; afterwards the hits are added to
 * the sums of single pixels, disc by disc. */
#ifndef ISO_RENDER_DISCS_SCATTER_SIMD_H
#define ISO_RENDER_DISCS_SCATTER_SIMD_H

#include "render/discs/common_simd.h"

/* STEPS: pixels of a scattered disc's box, at most; WORDS: 32-bit words with a bit for
 * each. */
enum { STEPS = ISO_DISCS_BOX * ISO_DISCS_BOX, WORDS = (STEPS + 31) / 32 };
/* AT_ONCE: hits that are listed without a branch between them. FEW: steps of which one 64-bit word has the
 * bits of all lanes. */
enum { AT_ONCE = 4, FEW = 4 };

/* Moves bit k of 16 to bit FEW * k. */
static inline uint64_t spread(uint64_t bits) {
    bits = (bits | bits << 24) & 0x000000ff000000ffu;
    bits = (bits | bits << 12) & 0x000f000f000f000fu;
    bits = (bits | bits << 6) & 0x0303030303030303u;
    return (bits | bits << 3) & 0x1111111111111111u;
}

/* Adds `weight` times a record of `size` (8 or 16) floats to a pixel's sums, which count as 0 unless
 * `keep`. The record's last float is replaced by `depth`. */
#if ISO_LANES == 4
ISO_INLINE void add_record(float *sums, const float *record, const int size, float depth, float weight,
                           bool keep) {
    const vi kept = v_seti(-(int32_t)keep);
    const vf w = v_set(weight);
    for (int k = 0; k < size; k += 4) {
        const vf old = v_floats(v_bits(v_load(sums + k)) & kept);
        vf value = v_load(record + k);
        if (k + 4 == size) value[3] = depth;
        v_store(sums + k, old + w * value);
    }
}
#else
/* Eight floats of a record; `last`: the record ends with them. */
ISO_INLINE void add_eight(float *sums, const float *record, bool last, float depth, float weight, bool keep) {
    const __m256i kept = _mm256_set1_epi32(-(int32_t)keep);
    const __m256 old = _mm256_and_ps(_mm256_loadu_ps(sums), _mm256_castsi256_ps(kept));
    __m256 value = _mm256_loadu_ps(record);
    if (last) value = _mm256_blend_ps(value, _mm256_set1_ps(depth), 0x80);
    _mm256_storeu_ps(sums, _mm256_add_ps(old, _mm256_mul_ps(_mm256_set1_ps(weight), value)));
}

ISO_INLINE void add_record(float *sums, const float *record, const int size, float depth, float weight,
                           bool keep) {
#if ISO_LANES == 16
    if (size == 16) {
        const __m512 old = _mm512_maskz_loadu_ps((__mmask16) - (int32_t)keep, sums);
        const __m512 value = _mm512_mask_broadcastss_ps((__m512)v_load(record), 0x8000, _mm_set_ss(depth));
        v_store(sums, (vf)old + v_set(weight) * (vf)value);
        return;
    }
#endif
    for (int k = 0; k < size; k += 8) add_eight(sums + k, record + k, k + 8 == size, depth, weight, keep);
}
#endif

/* The values that each of a vector of discs adds to a pixel's sums, before weighting, except depth. */
typedef struct rf_records {
    _Alignas(64) float value[ISO_LANES][ISO_SUMS];
} rf_records;

ISO_INLINE void make_records(const vf *disc, const bool flat, rf_records *records) {
    const vf zero = v_set(0);
    const vf first[4] = {v_set(1), disc[ISO_DISC_LIT_X], disc[ISO_DISC_LIT_Y], disc[ISO_DISC_LIT_Z]},
             side[4] = {disc[ISO_DISC_SIDE], zero, zero, zero},
             last[4] = {disc[ISO_DISC_X], disc[ISO_DISC_Y], disc[ISO_DISC_Z], zero};
    v_store4(records->value[0], ISO_SUMS, first);
    v_store4(records->value[0] + 4, ISO_SUMS, flat ? side : disc + ISO_DISC_XX);
    if (flat) return;
    v_store4(records->value[0] + 8, ISO_SUMS, disc + ISO_DISC_YZ);
    v_store4(records->value[0] + 12, ISO_SUMS, last);
}

/* Hits of a vector of discs. Step k is the k-th pixel of each disc's box; arrays are indexed by
 * step * ISO_LANES + lane. */
typedef struct rf_hits {
    float weight[STEPS * ISO_LANES]; /* negative where the pixel lies in the low-pass filter only */
    float depth[STEPS * ISO_LANES];
    int32_t at[STEPS * ISO_LANES]; /* index of the pixel in the patch */
    vi corner;                     /* index of the first pixel of each box */
    int steps, words;              /* number of steps; words of `hits` in use, 0: `few` is used */
    vi hits[WORDS];                /* bit step % 32 of word step / 32 is set where a disc is hit */
    uint64_t few;                  /* the same for at most FEW steps: bit lane * FEW + step */
} rf_hits;

/* Intersects the discs with the pixels of row at[1] of their boxes, of at[0] columns, from step at[2] on. */
ISO_INLINE void intersect_row(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                              const bool filtered, const rf_disc *discs, const rf_bounds *bounds,
                              const int at[3], rf_hits *out) {
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
        if (filtered) {
            const vm covered = filter_hits(params, disc, dx, dy, &hit);
            if (params->cuts && v_mask(cut)) cut_hits(params, disc, &hit);
            const vf weight = gaussian(hit.far) * disc[ISO_DISC_SHARE];
            v_store(out->weight + step * ISO_LANES, v_select(covered, weight, -weight));
        } else {
            if (params->cuts && v_mask(cut)) cut_hits(params, disc, &hit);
            v_store(out->weight + step * ISO_LANES, gaussian(hit.far));
        }
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
 * */
ISO_INLINE void add_hit(const iso_discs_params *params, const iso_discs_patch *patch, const rf_hits *m,
                        uint32_t which, const bool flat, const rf_adder *discs) {
    const int size = flat ? ISO_FLAT_SUMS : ISO_SUMS;
    const uint32_t lane = which % ISO_LANES;
    const float depth = m->depth[which], thickness = discs->thickness[lane];
    const int32_t at = m->at[which];
    float *sums = patch->sums + (ptrdiff_t)at * size;
    const float front = patch->front[at];
    if (!(depth <= front + thickness)) return;
    if (patch->limit && !(depth <= patch->limit[at] + thickness)) return;
    /* a pixel without discs has its front far behind: the sums, which are undefined, are not kept */
    bool keep = depth >= front - thickness;
    float nearest = depth < front && !(params->first && keep) ? depth : front;
    if (!params->cull && keep && (sums[flat ? ISO_FLAT_SIDE : ISO_SUM_SIDE] < 0) != (discs->side[lane] < 0)) {
        if (discs->side[lane] < 0) return;
        keep = false;
        nearest = depth;
    }
    patch->front[at] = nearest;
    add_record(sums, discs->records.value[lane], size, depth, m->weight[which], keep);
}

/* The same for filtered discs, by the rules of add_filtered_disc in splat_simd.h. */
ISO_INLINE void add_filtered_hit(const iso_discs_params *params, const iso_discs_patch *patch,
                                 const rf_hits *m, uint32_t which, const bool flat, const rf_adder *discs) {
    const int size = flat ? ISO_FLAT_SUMS : ISO_SUMS;
    const uint32_t lane = which % ISO_LANES;
    const float depth = m->depth[which], thickness = discs->thickness[lane], weight = m->weight[which];
    const int32_t at = m->at[which];
    if (patch->limit && !(depth <= patch->limit[at] + thickness)) return;
    float *sums = patch->sums + (ptrdiff_t)at * size;
    const bool covers = weight > 0, covered = patch->front[at] < ISO_NOWHERE;
    const float front = covered ? patch->front[at] : patch->outer_front[at];
    const bool behind = !(depth <= front + thickness), near = !behind && depth >= front - thickness;
    const bool flipped = discs->side[lane] < 0,
               same = params->cull || !near || (sums[flat ? ISO_FLAT_SIDE : ISO_SUM_SIDE] < 0) == flipped;
    const bool keep = near && same;
    if (covers == covered) {
        if (behind || (!same && flipped)) return;
        (covered ? patch->front : patch->outer_front)[at] = same && front < depth ? front : depth;
    } else if (covers) {
        patch->front[at] = depth;
    } else if (!keep) {
        return;
    }
    add_record(sums, discs->records.value[lane], size, depth, fabsf(weight), keep);
}

/* The front pass: lowers the fronts of the pixel of hit number `which`. */
ISO_INLINE void lower_fronts(const iso_discs_patch *patch, const rf_hits *m, uint32_t which,
                             const rf_adder *discs) {
    const uint32_t lane = which % ISO_LANES;
    const float depth = m->depth[which], thickness = discs->thickness[lane];
    const int32_t at = m->at[which];
    if (patch->limit && !(depth <= patch->limit[at] + thickness)) return;
    float *const side = (discs->side[lane] < 0 ? patch->flipped : patch->facing) + at;
    *side = fminf(*side, depth);
    patch->front[at] = fminf(patch->front[at], depth);
    if (discs->side[lane] > 0) patch->facing_reach[at] = fminf(patch->facing_reach[at], depth - thickness);
}

/* The sum pass: adds hit number `which` to its pixel if it is near the pixel's front. */
ISO_INLINE void add_front_hit(const iso_discs_patch *patch, const rf_hits *m, uint32_t which, const bool flat,
                              const rf_adder *discs) {
    const int size = flat ? ISO_FLAT_SUMS : ISO_SUMS;
    const uint32_t lane = which % ISO_LANES;
    const float depth = m->depth[which], thickness = discs->thickness[lane], weight = m->weight[which];
    const int32_t at = m->at[which];
    const float front = patch->front[at];
    if (!(depth <= front + thickness) || (weight < 0 && depth < front - thickness)) return;
    if (patch->limit && !(depth <= patch->limit[at] + thickness)) return;
    if ((discs->side[lane] < 0) != (patch->flipped[at] < patch->facing_reach[at])) return;
    add_record(patch->sums + (ptrdiff_t)at * size, discs->records.value[lane], size, depth, fabsf(weight),
               true);
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

/* The same from the bits of rf_hits.few. AT_ONCE items are written at a time, the last ones in excess. */
ISO_INLINE uint32_t list_few_hits(uint64_t few, int32_t *list) {
    const uint32_t end = (uint32_t)__builtin_popcountll(few);
    for (uint32_t count = 0; count < end; count += AT_ONCE)
        for (uint32_t k = 0; k < AT_ONCE; k++, few &= few - 1) {
            const uint32_t bit = (uint32_t)__builtin_ctzll(few | (uint64_t)1 << 63);
            list[count + k] = (int32_t)(bit % FEW * ISO_LANES + bit / FEW);
        }
    return end;
}

/* Adds all hits to their pixels, disc by disc. */
ISO_INLINE void add_hits(const iso_discs_params *params, const iso_discs_patch *patch, const bool flat,
                         const bool filtered, const rf_disc *discs, const rf_hits *found) {
    rf_adder adder;
    int32_t list[STEPS * ISO_LANES + ISO_LANES];
    make_records(discs->value, flat, &adder.records);
    vf thickness = ISO_DISCS_THICKNESS * discs->value[ISO_DISC_RADIUS];
    if (params->centres) thickness += ISO_DISCS_CENTRES_DEPTH * discs->value[ISO_DISC_PIXEL];
    v_store(adder.thickness, thickness);
    v_store(adder.side, discs->value[ISO_DISC_SIDE]);
    const uint32_t count = found->words ? list_hits(found, list) : list_few_hits(found->few, list);
    for (uint32_t i = 0; i < count; i++)
        if (params->pass == ISO_DISCS_FRONT_PASS)
            lower_fronts(patch, found, (uint32_t)list[i], &adder);
        else if (params->pass == ISO_DISCS_SUM_PASS)
            add_front_hit(patch, found, (uint32_t)list[i], flat, &adder);
        else if (filtered)
            add_filtered_hit(params, patch, found, (uint32_t)list[i], flat, &adder);
        else
            add_hit(params, patch, found, (uint32_t)list[i], flat, &adder);
}

/* add_hits for each kind of disc: functions of their own, which several ways of scattering share. */
#define ADD_HITS(name, flat, filtered)                                                                       \
    ISO_STEP static void name(const iso_discs_params *params, const iso_discs_patch *patch,                  \
                              const rf_disc *discs, const rf_hits *found) {                                  \
        add_hits(params, patch, flat, filtered, discs, found);                                               \
    }
ADD_HITS(add_mixed_hits, false, false)
ADD_HITS(add_flat_hits, true, false)
ADD_HITS(add_filtered_mixed_hits, false, true)
ADD_HITS(add_filtered_hits, true, true)
#undef ADD_HITS

ISO_INLINE void add_hits_of(const iso_discs_params *params, const iso_discs_patch *patch, const bool flat,
                            const bool filtered, const rf_disc *discs, const rf_hits *found) {
    if (flat && filtered)
        add_filtered_hits(params, patch, discs, found);
    else if (flat)
        add_flat_hits(params, patch, discs, found);
    else if (filtered)
        add_filtered_mixed_hits(params, patch, discs, found);
    else
        add_mixed_hits(params, patch, discs, found);
}

/* The number of columns (axis 0) or rows (axis 1) of the largest box of a live disc. */
ISO_INLINE int largest_box(const rf_bounds *bounds, int axis, vm live) {
    int most = 1;
    while (v_mask(v_and(live, v_lti(bounds->lo[axis] + (most - 1), bounds->hi[axis])))) most++;
    return most;
}

/* Adds a vector of discs to the patch. */
ISO_INLINE void scatter_discs(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                              const bool flat, const bool filtered, rf_disc *discs) {
    rf_bounds bounds;
    rf_hits found;
    discs->live = bound_discs(params, patch, curved, discs, &bounds);
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
        intersect_row(params, patch, curved, filtered, discs, &bounds, at, &found);
    }
    add_hits_of(params, patch, flat, filtered, discs, &found);
}

ISO_INLINE void scatter_curved(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    scatter_discs(params, patch, true, false, false, discs);
}

ISO_INLINE void scatter_flat(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    scatter_discs(params, patch, false, true, false, discs);
}

/* Flat discs in a patch that has curved ones too. */
ISO_INLINE void scatter_mixed(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    scatter_discs(params, patch, false, false, false, discs);
}

ISO_INLINE void scatter_filtered(const iso_discs_params *params, const iso_discs_patch *patch,
                                 rf_disc *discs) {
    scatter_discs(params, patch, false, true, true, discs);
}

ISO_INLINE void scatter_filtered_mixed(const iso_discs_params *params, const iso_discs_patch *patch,
                                       rf_disc *discs) {
    scatter_discs(params, patch, false, false, true, discs);
}

/* Adds the centres of a vector of discs, each to the pixel that contains it, all with the same weight. */
ISO_INLINE void scatter_centres(const iso_discs_params *params, const iso_discs_patch *patch, const bool flat,
                                rf_disc *discs) {
    const int above[2] = {0, params->target->view->above};
    vi at[2]; /* column and row in the patch */
    for (int k = 0; k < 2; k++) {
        const vf centre = discs->value[ISO_DISC_COLUMN + k];
        const int first = patch->first[k] + above[k], end = patch->last[k] + above[k] + 1;
        discs->live =
            v_and(discs->live, v_and(v_le(v_set((float)first), centre), v_lt(centre, v_set((float)end))));
        at[k] = v_trunc(v_select(discs->live, centre, v_set((float)first))) - first;
    }
    rf_hits found;
    found.steps = 1;
    found.words = 0;
    found.few = spread(v_mask(discs->live));
    v_store(found.weight, v_set(1));
    v_store(found.depth, discs->value[ISO_DISC_Z]);
    v_storei(found.at, at[1] * (int32_t)patch->stride + at[0]);
    add_hits_of(params, patch, flat, false, discs, &found);
}

ISO_INLINE void scatter_plain_centres(const iso_discs_params *params, const iso_discs_patch *patch,
                                      rf_disc *discs) {
    scatter_centres(params, patch, true, discs);
}

ISO_INLINE void scatter_colored_centres(const iso_discs_params *params, const iso_discs_patch *patch,
                                        rf_disc *discs) {
    scatter_centres(params, patch, false, discs);
}

static void scatter_block(const iso_discs_params *params, const iso_discs_patch *patch, uint32_t block) {
    const bool filtered = iso_discs_use_filter(params, &params->blocks[block]);
    if (params->centres && patch->flat) /* as if filtered: discs between the centres of pixels are kept */
        make_discs(params, patch, block, false, true, scatter_plain_centres);
    else if (params->centres)
        make_discs(params, patch, block, false, true, scatter_colored_centres);
    else if (patch->flat && filtered)
        make_discs(params, patch, block, false, true, scatter_filtered);
    else if (patch->flat)
        make_discs(params, patch, block, false, false, scatter_flat);
    else if (filtered)
        make_discs(params, patch, block, false, true, scatter_filtered_mixed);
    else if (iso_discs_use_curvature(params, &params->blocks[block]))
        make_discs(params, patch, block, true, false, scatter_curved);
    else
        make_discs(params, patch, block, false, false, scatter_mixed);
}

/* Loads sums and fronts of a vector of pixels from index `at` on. */
ISO_INLINE void load_pixels(const iso_discs_patch *patch, size_t at, const bool flat, rf_sums *sums) {
    const int size = flat ? ISO_FLAT_SUMS : ISO_SUMS;
    int32_t index[ISO_LANES];
    v_storei(index, v_lanes() * size);
    v_load4(patch->sums + at * (size_t)size, index, size / 4, sums->value);
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
        load_pixels(patch, at, flat, &sums);
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
        if (patch->flat)
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
