/* flat_simd: adds small flat discs, one at a time, to the pixels that they may cover: a tile of
 * ISO_DISCS_TILE columns at once, which begins at the disc's own first pixel. A vector of discs that all
 * cover two columns and rows at most are intersected together, and their hits added one by one. Where the
 * discs of a patch are all flat, a pixel's sums are adjacent: weight and normal, then its colour if there
 * is one; depths lie in a plane. */
#ifndef ISO_RENDER_DISCS_FLAT_SIMD_H
#define ISO_RENDER_DISCS_FLAT_SIMD_H

#include "render/discs/common_simd.h"

/* A tile has as many rows as a vector holds. */
enum { TILE_ROWS = ISO_LANES / ISO_DISCS_TILE };

typedef float rf_four __attribute__((vector_size(16)));

ISO_INLINE rf_four load_four(const float *from) {
    rf_four four;
    memcpy(&four, from, sizeof four);
    return four;
}

ISO_INLINE void store_four(float *to, rf_four four) {
    memcpy(to, &four, sizeof four);
}

/* ---- rows of four values in a plane with `stride` values in a row, as a vector; the same four values in
 * every row; and adding `record` times each lane of `weight` to the four sums of a tile's pixels */

#if ISO_LANES == 4
ISO_INLINE vf load_rows(const float *from, size_t stride) {
    (void)stride;
    return v_load(from);
}
ISO_INLINE void store_rows(float *to, size_t stride, vf value) {
    (void)stride;
    v_store(to, value);
}
ISO_INLINE vf repeat_four(rf_four four) {
    return four;
}
ISO_INLINE void add_to_tile(float *sums, size_t stride, vf record, vf weight) {
    (void)stride;
    ISO_UNROLL for (int k = 0; k < 4; k++) {
        float *to = sums + 4 * k;
        store_four(to, load_four(to) + record * weight[k]);
    }
}
#elif ISO_LANES == 8
ISO_INLINE vf load_rows(const float *from, size_t stride) {
    return (vf)_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(from)), _mm_loadu_ps(from + stride),
                                    1);
}
ISO_INLINE void store_rows(float *to, size_t stride, vf value) {
    _mm_storeu_ps(to, _mm256_castps256_ps128((__m256)value));
    _mm_storeu_ps(to + stride, _mm256_extractf128_ps((__m256)value, 1));
}
ISO_INLINE vf repeat_four(rf_four four) {
    return (vf)_mm256_broadcast_ps((const __m128 *)&four);
}
ISO_INLINE void add_to(float *to, vf value) {
    v_store(to, v_load(to) + value);
}
ISO_INLINE void add_to_tile(float *sums, size_t stride, vf record, vf weight) {
    float *next = sums + 4 * stride;
    add_to(sums, record * __builtin_shufflevector(weight, weight, 0, 0, 0, 0, 1, 1, 1, 1));
    add_to(sums + 8, record * __builtin_shufflevector(weight, weight, 2, 2, 2, 2, 3, 3, 3, 3));
    add_to(next, record * __builtin_shufflevector(weight, weight, 4, 4, 4, 4, 5, 5, 5, 5));
    add_to(next + 8, record * __builtin_shufflevector(weight, weight, 6, 6, 6, 6, 7, 7, 7, 7));
}
#else
ISO_INLINE vf load_rows(const float *from, size_t stride) {
    __m512 rows = _mm512_castps128_ps512(_mm_loadu_ps(from));
    rows = _mm512_insertf32x4(rows, _mm_loadu_ps(from + stride), 1);
    rows = _mm512_insertf32x4(rows, _mm_loadu_ps(from + 2 * stride), 2);
    return (vf)_mm512_insertf32x4(rows, _mm_loadu_ps(from + 3 * stride), 3);
}
ISO_INLINE void store_rows(float *to, size_t stride, vf value) {
    _mm_storeu_ps(to, _mm512_castps512_ps128((__m512)value));
    _mm_storeu_ps(to + stride, _mm512_extractf32x4_ps((__m512)value, 1));
    _mm_storeu_ps(to + 2 * stride, _mm512_extractf32x4_ps((__m512)value, 2));
    _mm_storeu_ps(to + 3 * stride, _mm512_extractf32x4_ps((__m512)value, 3));
}
ISO_INLINE vf repeat_four(rf_four four) {
    return (vf)_mm512_broadcast_f32x4((__m128)four);
}
ISO_INLINE void add_to(float *to, vf value) {
    v_store(to, v_load(to) + value);
}
#define LANES_OF_ROW(k)                                                                                      \
    k, k, k, k, k + 1, k + 1, k + 1, k + 1, k + 2, k + 2, k + 2, k + 2, k + 3, k + 3, k + 3, k + 3
ISO_INLINE void add_to_tile(float *sums, size_t stride, vf record, vf weight) {
    add_to(sums, record * __builtin_shufflevector(weight, weight, LANES_OF_ROW(0)));
    add_to(sums + 4 * stride, record * __builtin_shufflevector(weight, weight, LANES_OF_ROW(4)));
    add_to(sums + 8 * stride, record * __builtin_shufflevector(weight, weight, LANES_OF_ROW(8)));
    add_to(sums + 12 * stride, record * __builtin_shufflevector(weight, weight, LANES_OF_ROW(12)));
}
#undef LANES_OF_ROW
#endif

/* ---- a disc and its pixels */

ISO_INLINE vf lane_of(const vf *value, int lane) {
    return v_set(((const float *)value)[lane]);
}

/* The values of one disc in every lane, or of a vector of discs; `values`: all of them (ISO_DISC). */
typedef struct rf_flat {
    vf column, row, depth, thickness, most, near;
    vf x, y, xx, xy, yy;
    vf soft_xx, soft_xy, soft_yy, share;
    bool cut; /* boxes or bodies may clip them */
    const vf *values;
    int lane; /* number of the one disc in these */
} rf_flat;

/* The values of disc number `lane` of a vector, or of all if it is not `one`. */
ISO_INLINE rf_flat take_flat(const rf_disc *discs, const bool one, int lane, const bool filtered) {
#define VALUE(name) (one ? lane_of(&discs->value[name], lane) : discs->value[name])
    rf_flat flat = {.column = VALUE(ISO_DISC_COLUMN),
                    .row = VALUE(ISO_DISC_ROW),
                    .depth = VALUE(ISO_DISC_Z),
                    .thickness = ISO_DISCS_THICKNESS * VALUE(ISO_DISC_RADIUS),
                    .most = VALUE(ISO_DISC_RADIUS) + VALUE(ISO_DISC_PIXEL) * ISO_DISCS_LOW_PASS_DEPTH,
                    .near = VALUE(ISO_DISC_FLAT_NEAR),
                    .x = VALUE(ISO_DISC_FLAT_X),
                    .y = VALUE(ISO_DISC_FLAT_Y),
                    .xx = VALUE(ISO_DISC_FLAT_XX),
                    .xy = VALUE(ISO_DISC_FLAT_XY),
                    .yy = VALUE(ISO_DISC_FLAT_YY),
                    .values = discs->value,
                    .lane = one ? lane : -1};
    if (!filtered) return flat;
    flat.soft_xx = VALUE(ISO_DISC_SOFT_XX);
    flat.soft_xy = VALUE(ISO_DISC_SOFT_XY);
    flat.soft_yy = VALUE(ISO_DISC_SOFT_YY);
    flat.share = VALUE(ISO_DISC_SHARE);
#undef VALUE
    return flat;
}

/* Pixels, those of a tile or one of each disc of a vector: which ones are hit, and which of these hits
 * cover their pixels (of filtered discs: else the pixel lies in the low-pass filter only); their depths,
 * and the weights of hits. */
typedef struct rf_tile {
    vm hits, covers;
    vf depth, weight;
} rf_tile;

/* Which pixels lie inside of a disc's box, and which ones are left by bodies. */
typedef struct rf_clipped {
    vm inside, left;
} rf_clipped;

/* Clips discs, all of `values` or number `lane` of them. (dx, dy): pixels from the centre; `behind`: mm of
 * the hits behind it. */
ISO_STEP static rf_clipped clip_flat(const iso_discs_params *params, const vf *values, int lane,
                                     const bool filtered, vf dx, vf dy, vf behind) {
    vf disc[ISO_DISC_VALUES];
    for (int k = 0; k < ISO_DISC_VALUES; k++) disc[k] = lane < 0 ? values[k] : lane_of(&values[k], lane);
    const vf off[2] = {dx, dy}, none = v_set(0),
             most = disc[ISO_DISC_RADIUS] + disc[ISO_DISC_PIXEL] * ISO_DISCS_LOW_PASS_DEPTH;
    rf_hit hit = {.q[2] = behind, .far = none};
    for (int k = 0; k < 2; k++)
        hit.q[k] =
            off[k] * disc[ISO_DISC_PIXEL] + behind * ray_slope(params, k, off[k] + disc[ISO_DISC_COLUMN + k]);
    clip_to_boxes(params, disc, &hit);
    const vm inside = v_lt(hit.far, v_set(1));
    hit.far = none;
    if (filtered) hit.q[2] = v_max(v_min(behind, most), -most);
    cut_hits(params, disc, &hit);
    return (rf_clipped){inside, v_lt(hit.far, v_set(1))};
}

/* Sets `far` of hits outside of their discs' balls to 1, all of `values` or number `lane` of them. */
ISO_STEP static vf keep_in_balls(const iso_discs_params *params, const vf *values, int lane, vf dx, vf dy,
                                 vf behind, vf far) {
    vf disc[ISO_DISC_VALUES];
    for (int k = 0; k < ISO_DISC_VALUES; k++) disc[k] = lane < 0 ? values[k] : lane_of(&values[k], lane);
    const vf off[2] = {dx, dy};
    vf q[3] = {[2] = behind};
    for (int k = 0; k < 2; k++)
        q[k] =
            off[k] * disc[ISO_DISC_PIXEL] + behind * ray_slope(params, k, off[k] + disc[ISO_DISC_COLUMN + k]);
    return v_select(leaves_ball(disc, q), v_set(1), far);
}

/* Intersects discs with the rays of pixels that are (dx, dy) from their centres. `row`: start_row's. */
ISO_INLINE rf_tile intersect_flat(const iso_discs_params *params, const rf_flat *disc, const bool filtered,
                                  vf dx, vf dy, const rf_row *row) {
    const vf depth = dx * disc->x + row->b, nearer = 1 / v_max(1 - depth * disc->near, v_set(1e-15f)),
             at = depth * nearer;
    vf far = (dx * (row->c1 + disc->xx * dx) + row->c0) * (nearer * nearer), behind = at;
    if (params->anisotropic) far = keep_in_balls(params, disc->values, disc->lane, dx, dy, at, far);
    rf_tile tile = {.hits = v_lt(far, v_set(1)), .covers = v_lt(far, v_set(1))};
    if (filtered) {
        far = dx * (disc->soft_xx * dx + disc->soft_xy * dy) + disc->soft_yy * dy * dy;
        behind = v_max(v_min(behind, disc->most), -disc->most);
        tile.hits = v_lt(far, v_set(1));
    }
    if (disc->cut) { /* what is outside of the box is not covered, but may lie in the low-pass filter */
        const rf_clipped clipped = clip_flat(params, disc->values, disc->lane, filtered, dx, dy, at);
        tile.covers = v_and(tile.covers, clipped.inside);
        tile.hits = v_and(tile.hits, filtered ? clipped.left : v_and(clipped.inside, clipped.left));
    }
    if (filtered && params->widened) tile.covers = tile.hits;
    tile.weight = filtered ? gaussian(far) * disc->share : gaussian(far);
    tile.depth = disc->depth + v_select(tile.hits, behind, v_set(0));
    return tile;
}

/* What each of a vector of discs adds to sums before weighting, and to those of colours. */
typedef struct rf_shares {
    float sum[ISO_LANES][4], color[ISO_LANES][4];
} rf_shares;

ISO_INLINE void make_shares(const iso_discs_params *params, const vf *disc, rf_shares *shares) {
    const vf sum[4] = {v_set(1), disc[ISO_DISC_LIT_X], disc[ISO_DISC_LIT_Y], disc[ISO_DISC_LIT_Z]},
             color[4] = {disc[ISO_DISC_RED], disc[ISO_DISC_RED + 1], disc[ISO_DISC_RED + 2], v_set(0)};
    v_store4(shares->sum[0], 4, sum);
    if (params->colored) v_store4(shares->color[0], 4, color);
}

/* A disc that is added to a tile: what it adds before weighting, in every four lanes. */
typedef struct rf_added {
    size_t at; /* index of the tile's first pixel in the patch */
    vf sum, color, thickness;
    bool flipped;
} rf_added;

/* ---- adding a disc to a tile */

/* Empties the sums of some pixels of a tile. */
ISO_INLINE void empty_pixels(const iso_discs_patch *patch, size_t at, uint32_t pixels) {
    for (; pixels; pixels &= pixels - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(pixels);
        const size_t to = at + lane / ISO_DISCS_TILE * patch->stride + lane % ISO_DISCS_TILE;
        store_four(patch->sums + 4 * to, (rf_four){0});
        store_four(patch->colors + 4 * to, (rf_four){0});
        patch->depths[to] = 0;
    }
}

/* Adds a disc to the sums of a tile's pixels; `colored`: discs have colours of their own. */
ISO_INLINE void add_to_sums(const iso_discs_patch *patch, const rf_added *disc, const rf_tile *tile, vm joins,
                            const bool colored) {
    const vf weight = v_select(joins, tile->weight, v_set(0));
    float *depths = patch->depths + disc->at;
    store_rows(depths, patch->stride, load_rows(depths, patch->stride) + weight * tile->depth);
    add_to_tile(patch->sums + 4 * disc->at, patch->stride, disc->sum, weight);
    if (colored) add_to_tile(patch->colors + 4 * disc->at, patch->stride, disc->color, weight);
}

/* Adds a disc by the rules of add_disc in splat_simd.h. */
ISO_INLINE void add_plain(const iso_discs_params *params, const iso_discs_patch *patch, const rf_added *disc,
                          const rf_tile *tile) {
    float *const fronts = patch->front + disc->at, *const sides = patch->sides + disc->at;
    const size_t stride = patch->stride;
    const vf front = load_rows(fronts, stride), depth = tile->depth;
    const vm before = v_lt(depth, front - disc->thickness), near = v_le(depth, front + disc->thickness);
    vm joins = v_and(tile->hits, near), fresh = before;
    if (!params->cull) {
        const vf side = load_rows(sides, stride);
        const vm was_flipped = v_lt(side, v_set(0));
        if (disc->flipped)
            joins = v_and(joins, v_or(before, was_flipped));
        else
            fresh = v_or(before, was_flipped);
        store_rows(sides, stride, v_select(joins, v_set(disc->flipped ? -1 : 1), side));
    }
    fresh = v_and(joins, fresh);
    const vf nearest = params->first ? front : v_min(depth, front);
    store_rows(fronts, stride, v_select(joins, v_select(fresh, depth, nearest), front));
    empty_pixels(patch, disc->at, v_mask(v_and(fresh, v_lt(front, v_set(ISO_NOWHERE)))));
    add_to_sums(patch, disc, tile, joins, params->colored);
}

/* The same by those of add_filtered_disc. Pixels that are covered have no outer front. */
ISO_INLINE void add_filtered(const iso_discs_params *params, const iso_discs_patch *patch,
                             const rf_added *disc, const rf_tile *tile) {
    float *const fronts = patch->front + disc->at, *const outers = patch->outer_front + disc->at,
                 *const sides = patch->sides + disc->at;
    const size_t stride = patch->stride;
    const vf nowhere = v_set(ISO_NOWHERE), depth = tile->depth;
    vf front = load_rows(fronts, stride), outer = load_rows(outers, stride);
    const vf before = v_min(front, outer);
    const vm covers = tile->covers, covered = v_lt(front, nowhere), first = v_andnot(covers, covered),
             inner = v_andnot(covered, covers), there = v_lt(before, nowhere);
    const vm reaches = v_le(depth, before + disc->thickness);
    vm may = reaches, keep = v_and(reaches, v_le(before - disc->thickness, depth)),
       other = v_andnot(may, may);
    if (!params->cull) {
        const vm was_flipped = v_lt(load_rows(sides, stride), v_set(0));
        other = disc->flipped ? v_andnot(keep, was_flipped) : v_and(keep, was_flipped);
        keep = v_andnot(keep, other);
        if (disc->flipped) may = v_andnot(may, other);
    }
    const vm joins = v_and(tile->hits, v_or(first, v_andnot(may, v_andnot(inner, keep)))),
             shown = v_and(joins, covers);
    if (!params->cull) {
        const vm replaces = v_andnot(v_and(joins, other), inner);
        front = v_select(replaces, nowhere, front);
        outer = v_select(replaces, nowhere, outer);
        store_rows(sides, stride, v_select(joins, v_set(disc->flipped ? -1 : 1), load_rows(sides, stride)));
    }
    store_rows(fronts, stride, v_min(front, v_select(shown, depth, nowhere)));
    outer = v_min(outer, v_select(v_andnot(joins, covered), depth, nowhere));
    store_rows(outers, stride, v_select(shown, nowhere, outer));
    empty_pixels(patch, disc->at, v_mask(v_and(v_andnot(joins, keep), there)));
    add_to_sums(patch, disc, tile, joins, params->colored);
}

/* The front pass: lowers the fronts of pixels. */
ISO_INLINE void lower_rows(const iso_discs_params *params, const iso_discs_patch *patch, const rf_added *disc,
                           const rf_tile *tile) {
    const vf hit = v_select(tile->hits, tile->depth, v_set(ISO_NOWHERE));
    const size_t stride = patch->stride;
    float *const fronts = patch->front + disc->at,
                 *const own = (disc->flipped ? patch->flipped : patch->facing) + disc->at,
                 *const reaches = patch->facing_reach + disc->at;
    store_rows(fronts, stride, v_min(hit, load_rows(fronts, stride)));
    store_rows(own, stride, v_min(hit, load_rows(own, stride)));
    if (disc->flipped || params->cull) return;
    store_rows(reaches, stride, v_min(hit - disc->thickness, load_rows(reaches, stride)));
}

/* The sum pass: adds a disc where it is near the front. */
ISO_INLINE void add_near_front(const iso_discs_params *params, const iso_discs_patch *patch,
                               const rf_added *disc, const rf_tile *tile) {
    const size_t stride = patch->stride;
    const vf front = load_rows(patch->front + disc->at, stride);
    vm joins = v_and(v_and(tile->hits, v_le(tile->depth, front + disc->thickness)),
                     v_or(tile->covers, v_le(front - disc->thickness, tile->depth)));
    if (!params->cull) {
        const vm flipped = v_lt(load_rows(patch->sides + disc->at, stride), v_set(0));
        joins = disc->flipped ? v_and(joins, flipped) : v_andnot(joins, flipped);
    }
    add_to_sums(patch, disc, tile, joins, params->colored);
}

/* ---- adding the hits of small discs to single pixels, by the same rules */

/* FEW: pixels of the box of a small disc, at most 2 x 2. AT_ONCE: hits that are listed without a branch
 * between them. */
enum { SMALL = 2, FEW = SMALL * SMALL, AT_ONCE = 4 };

/* Hits of a vector of discs; arrays are indexed by step * ISO_LANES + lane, where step k is the k-th pixel of
 * each disc's box. */
typedef struct rf_few {
    float depth[FEW * ISO_LANES], weight[FEW * ISO_LANES]; /* weight: negative if the pixel is not covered */
    int32_t at[FEW * ISO_LANES];                           /* index of the pixel in the patch */
    float thickness[ISO_LANES];
    uint64_t hits; /* bit lane * FEW + step is set where a disc is hit */
} rf_few;

/* Moves bit k of 16 to bit FEW * k. */
static inline uint64_t spread(uint64_t bits) {
    bits = (bits | bits << 24) & 0x000000ff000000ffu;
    bits = (bits | bits << 12) & 0x000f000f000f000fu;
    bits = (bits | bits << 6) & 0x0303030303030303u;
    return (bits | bits << 3) & 0x1111111111111111u;
}

/* Lists the numbers of hits, disc by disc; returns how many. AT_ONCE items are written at a time, the last
 * ones in excess. */
ISO_INLINE uint32_t list_few_hits(uint64_t few, int32_t *list) {
    const uint32_t end = (uint32_t)__builtin_popcountll(few);
    for (uint32_t count = 0; count < end; count += AT_ONCE)
        for (uint32_t k = 0; k < AT_ONCE; k++, few &= few - 1) {
            const uint32_t bit = (uint32_t)__builtin_ctzll(few | (uint64_t)1 << 63);
            list[count + k] = (int32_t)(bit % FEW * ISO_LANES + bit / FEW);
        }
    return end;
}

/* Adds a hit to the sums of a pixel, which count as 0 unless `keep`. */
ISO_INLINE void add_share(const iso_discs_patch *patch, int32_t at, const rf_shares *shares, uint32_t lane,
                          const bool colored, float depth, float weight, bool keep) {
    typedef int32_t four_bits __attribute__((vector_size(16)));
    const four_bits kept = -(int32_t)keep - (four_bits){0};
    float *const sums = patch->sums + 4 * (ptrdiff_t)at, *const colors = patch->colors + 4 * (ptrdiff_t)at;
    store_four(sums, (rf_four)((four_bits)load_four(sums) & kept) + weight * load_four(shares->sum[lane]));
    if (colored)
        store_four(colors,
                   (rf_four)((four_bits)load_four(colors) & kept) + weight * load_four(shares->color[lane]));
    patch->depths[at] = (keep ? patch->depths[at] : 0) + weight * depth;
}

/* Adds hit number `which` (step * ISO_LANES + lane), as add_plain and add_filtered do. */
ISO_INLINE void add_hit_once(const iso_discs_params *params, const iso_discs_patch *patch, const rf_few *few,
                             uint32_t which, const rf_shares *shares, bool flipped, const bool filtered) {
    const uint32_t lane = which % ISO_LANES;
    const float depth = few->depth[which], thickness = few->thickness[lane], weight = few->weight[which];
    const int32_t at = few->at[which];
    float *const front = patch->front + at, *const outer = patch->outer_front + at;
    const bool covers = weight > 0, covered = *front < ISO_NOWHERE;
    const float before = !filtered || covered ? *front : *outer;
    const bool behind = !(depth <= before + thickness), near = !behind && depth >= before - thickness;
    const bool same = params->cull || !near || (patch->sides[at] < 0) == flipped, keep = near && same;
    if (!filtered) {
        if (behind || (!same && flipped)) return;
        *front = keep && params->first ? before : keep && before < depth ? before : depth;
    } else if (covers == covered) {
        if (behind || (!same && flipped)) return;
        *(covered ? front : outer) = same && before < depth ? before : depth;
    } else if (covers) {
        *front = depth;
        *outer = ISO_NOWHERE;
    } else if (!keep) {
        return;
    }
    if (!params->cull) patch->sides[at] = flipped ? -1 : 1;
    add_share(patch, at, shares, lane, params->colored, depth, fabsf(weight), keep);
}

ISO_INLINE void lower_front(const iso_discs_patch *patch, int32_t at, bool flipped, float depth,
                            float thickness) {
    float *const own = (flipped ? patch->flipped : patch->facing) + at, *const front = patch->front + at,
                 *const reach = patch->facing_reach + at;
    *front = depth < *front ? depth : *front;
    *own = depth < *own ? depth : *own;
    if (!flipped) *reach = depth - thickness < *reach ? depth - thickness : *reach;
}

/* Whether a hit is near the front of its pixel, and on the side that faces the eye there. */
ISO_INLINE bool is_near_front(const iso_discs_patch *patch, int32_t at, bool flipped, bool covers,
                              float depth, float thickness) {
    const float front = patch->front[at];
    return depth <= front + thickness && (covers || depth >= front - thickness) &&
           (patch->sides[at] < 0) == flipped;
}

/* Adds hits, disc by disc. `flipped`: a bit for each lane. */
ISO_INLINE void add_few_hits(const iso_discs_params *params, const iso_discs_patch *patch, const rf_few *few,
                             const rf_shares *shares, uint32_t flipped, const iso_discs_pass pass,
                             const bool filtered) {
    int32_t list[FEW * ISO_LANES + AT_ONCE];
    const uint32_t count = list_few_hits(few->hits, list);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t which = (uint32_t)list[i], lane = which % ISO_LANES;
        const bool away = flipped >> lane & 1;
        const float depth = few->depth[which], thickness = few->thickness[lane], weight = few->weight[which];
        const int32_t at = few->at[which];
        if (patch->limit && !(depth <= patch->limit[at] + thickness)) continue;
        if (pass == ISO_DISCS_ONE_PASS)
            add_hit_once(params, patch, few, which, shares, away, filtered);
        else if (pass == ISO_DISCS_FRONT_PASS)
            lower_front(patch, at, away, depth, thickness);
        else if (is_near_front(patch, at, away, weight > 0, depth, thickness))
            add_share(patch, at, shares, lane, params->colored, depth, fabsf(weight), true);
    }
}

/* Intersects discs with the pixels of their boxes, of at most SMALL columns and rows. */
ISO_INLINE void intersect_few(const iso_discs_params *params, const iso_discs_patch *patch,
                              const rf_disc *discs, const rf_bounds *bounds, const bool filtered,
                              rf_few *few) {
    rf_flat all = take_flat(discs, false, 0, filtered);
    all.cut = v_mask(discs->clipped);
    v_store(few->thickness, all.thickness);
    few->hits = 0;
    const vm live = discs->live;
    const bool wide = v_mask(v_and(live, v_lti(bounds->lo[0], bounds->hi[0]))),
               high = v_mask(v_and(live, v_lti(bounds->lo[1], bounds->hi[1])));
    const vi corner =
        (bounds->lo[1] - patch->first[1]) * (int32_t)patch->stride + bounds->lo[0] - patch->first[0];
    const float above = (float)params->target->view->above + 0.5f;
    for (int y = 0; y <= high; y++) {
        const vm in = v_andnot(live, v_lti(bounds->hi[1], bounds->lo[1] + y));
        const vf dy = v_to_float(bounds->lo[1] + y) + above - all.row;
        const rf_row row = {.b = all.y * dy, .c0 = all.yy * dy * dy, .c1 = all.xy * dy};
        for (int x = 0; x <= wide; x++) {
            const int step = y * SMALL + x;
            const vf dx = v_to_float(bounds->lo[0] + x) + 0.5f - all.column;
            const rf_tile hit = intersect_flat(params, &all, filtered, dx, dy, &row);
            const vm hits = v_and(hit.hits, v_andnot(in, v_lti(bounds->hi[0], bounds->lo[0] + x)));
            v_store(few->depth + step * ISO_LANES, hit.depth);
            v_store(few->weight + step * ISO_LANES, v_select(hit.covers, hit.weight, -hit.weight));
            v_storei(few->at + step * ISO_LANES, corner + (y * (int32_t)patch->stride + x));
            few->hits |= spread(v_mask(hits)) << step;
        }
    }
}

/* ---- a vector of discs */

/* Adds a disc to the tiles of its box: first column and row of the view, last column and row. */
ISO_INLINE void add_flat_disc(const iso_discs_params *params, const iso_discs_patch *patch,
                              const rf_flat *disc, const int32_t box[4], rf_added *added,
                              const iso_discs_pass pass, const bool filtered) {
    const vi lane_x = v_lanes() & (ISO_DISCS_TILE - 1), lane_y = v_lanes() / ISO_DISCS_TILE;
    const float above = (float)params->target->view->above + 0.5f;
    for (int y = box[1]; y <= box[3]; y += TILE_ROWS) {
        const vi below = v_seti(box[3] - y) - lane_y;
        const vf dy = v_to_float(lane_y + y) + above - disc->row;
        const rf_row row = {.b = disc->y * dy, .c0 = disc->yy * dy * dy, .c1 = disc->xy * dy};
        added->at = (size_t)(y - patch->first[1]) * patch->stride + (size_t)(box[0] - patch->first[0]);
        for (int x = box[0]; x <= box[2]; x += ISO_DISCS_TILE, added->at += ISO_DISCS_TILE) {
            const vf dx = v_to_float(lane_x + x) + 0.5f - disc->column;
            rf_tile tile = intersect_flat(params, disc, filtered, dx, dy, &row);
            const vi beside = v_seti(box[2] - x) - lane_x;
            tile.hits = v_andnot(tile.hits, v_lti(below | beside, v_seti(0)));
            if (patch->limit) {
                const vf limit = load_rows(patch->limit + added->at, patch->stride);
                tile.hits = v_and(tile.hits, v_le(tile.depth, limit + disc->thickness));
            }
            if (pass == ISO_DISCS_FRONT_PASS)
                lower_rows(params, patch, added, &tile);
            else if (pass == ISO_DISCS_SUM_PASS)
                add_near_front(params, patch, added, &tile);
            else if (filtered)
                add_filtered(params, patch, added, &tile);
            else
                add_plain(params, patch, added, &tile);
        }
    }
}

/* Whether the boxes of all live discs have at most SMALL columns and rows. */
ISO_INLINE bool are_small(const rf_bounds *bounds, vm live) {
    const vi columns = bounds->hi[0] - bounds->lo[0], rows = bounds->hi[1] - bounds->lo[1];
    const vm large = v_or(v_lti(v_seti(SMALL - 1), columns), v_lti(v_seti(SMALL - 1), rows));
    return !v_mask(v_and(live, large));
}

/* Adds a vector of discs to the patch, in their order. */
ISO_INLINE void add_flat_discs(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs,
                               const iso_discs_pass pass, const bool filtered) {
    rf_bounds bounds;
    const vf *value = discs->value, most = v_set((ISO_DISCS_BOX - 1) / 2);
    discs->live = v_and(bound_discs(params, patch, false, filtered, discs, &bounds),
                        v_le(value[ISO_DISC_PIXELS], most));
    if (!v_mask(discs->live)) return;
    const iso_discs_patch own = *patch;
    const uint32_t flipped = v_mask(v_lt(value[ISO_DISC_SIDE], v_set(0))), cut = v_mask(discs->clipped);
    rf_shares shares;
    make_shares(params, value, &shares);
    int32_t box[4][ISO_LANES];
    for (int k = 0; k < 2; k++) {
        v_storei(box[k], bounds.lo[k]);
        v_storei(box[2 + k], bounds.hi[k]);
    }
    if (are_small(&bounds, discs->live)) {
        rf_few few;
        intersect_few(params, patch, discs, &bounds, filtered, &few);
        add_few_hits(params, &own, &few, &shares, flipped, pass, filtered);
        return;
    }
    for (uint32_t left = v_mask(discs->live); left; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        rf_flat disc = take_flat(discs, true, lane, filtered);
        disc.cut = cut >> lane & 1;
        rf_added added = {.sum = repeat_four(load_four(shares.sum[lane])),
                          .thickness = disc.thickness,
                          .flipped = flipped >> lane & 1};
        if (params->colored) added.color = repeat_four(load_four(shares.color[lane]));
        const int32_t whole[4] = {box[0][lane], box[1][lane], box[2][lane], box[3][lane]};
        add_flat_disc(params, &own, &disc, whole, &added, pass, filtered);
    }
}

/* add_flat_discs of each pass: functions of their own, so that points are read and projected by one. */
#define FLAT_DISCS(name, pass, filtered)                                                                     \
    ISO_STEP static void name(const iso_discs_params *params, const iso_discs_patch *patch,                  \
                              rf_disc *discs) {                                                              \
        add_flat_discs(params, patch, discs, pass, filtered);                                                \
    }
FLAT_DISCS(add_plain_once, ISO_DISCS_ONE_PASS, false)
FLAT_DISCS(add_plain_fronts, ISO_DISCS_FRONT_PASS, false)
FLAT_DISCS(add_plain_sums, ISO_DISCS_SUM_PASS, false)
FLAT_DISCS(add_filtered_once, ISO_DISCS_ONE_PASS, true)
FLAT_DISCS(add_filtered_fronts, ISO_DISCS_FRONT_PASS, true)
FLAT_DISCS(add_filtered_sums, ISO_DISCS_SUM_PASS, true)
#undef FLAT_DISCS

ISO_INLINE void scatter_flat(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    (params->pass == ISO_DISCS_FRONT_PASS ? add_plain_fronts
     : params->pass == ISO_DISCS_SUM_PASS ? add_plain_sums
                                          : add_plain_once)(params, patch, discs);
}

ISO_INLINE void scatter_filtered(const iso_discs_params *params, const iso_discs_patch *patch,
                                 rf_disc *discs) {
    (params->pass == ISO_DISCS_FRONT_PASS ? add_filtered_fronts
     : params->pass == ISO_DISCS_SUM_PASS ? add_filtered_sums
                                          : add_filtered_once)(params, patch, discs);
}

/* ---- centres */

/* Adds the centres of a vector of discs, each to the pixel that contains it, all with the same weight.
 * Centres are drawn in two passes. */
ISO_INLINE void scatter_centres(const iso_discs_params *params, const iso_discs_patch *patch,
                                rf_disc *discs) {
    const vf *value = discs->value;
    const int above[2] = {0, params->target->view->above};
    vi at[2]; /* column and row in the patch */
    for (int k = 0; k < 2; k++) {
        const vf centre = value[ISO_DISC_COLUMN + k];
        const int first = patch->first[k] + above[k], end = patch->last[k] + above[k] + 1;
        discs->live =
            v_and(discs->live, v_and(v_le(v_set((float)first), centre), v_lt(centre, v_set((float)end))));
        at[k] = v_trunc(v_select(discs->live, centre, v_set((float)first))) - first;
    }
    int32_t index[ISO_LANES];
    float depth[ISO_LANES], thickness[ISO_LANES];
    rf_shares shares;
    make_shares(params, value, &shares);
    v_storei(index, at[1] * (int32_t)patch->stride + at[0]);
    v_store(depth, value[ISO_DISC_Z]);
    v_store(thickness,
            ISO_DISCS_THICKNESS * value[ISO_DISC_RADIUS] + ISO_DISCS_CENTRES_DEPTH * value[ISO_DISC_PIXEL]);
    const uint32_t flipped = v_mask(v_lt(value[ISO_DISC_SIDE], v_set(0)));
    for (uint32_t left = v_mask(discs->live); left; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        const bool away = flipped >> lane & 1;
        const float z = depth[lane], thick = thickness[lane];
        const int32_t to = index[lane];
        if (patch->limit && !(z <= patch->limit[to] + thick)) continue;
        if (params->pass == ISO_DISCS_FRONT_PASS)
            lower_front(patch, to, away, z, thick);
        else if (is_near_front(patch, to, away, true, z, thick))
            add_share(patch, to, &shares, (uint32_t)lane, params->colored, z, 1, true);
    }
}

/* Loads sums and fronts of a vector of pixels from index `at` on. */
ISO_INLINE void load_flat_pixels(const iso_discs_patch *patch, size_t at, const bool colored, rf_sums *sums) {
    int32_t index[ISO_LANES];
    v_storei(index, v_lanes() * 4);
    for (int k = 4; k < ISO_SUMS; k++) sums->value[k] = v_set(0);
    v_load4(patch->sums + 4 * at, index, 1, sums->value);
    if (colored) v_load4(patch->colors + 4 * at, index, 1, sums->value + ISO_SUM_RED);
    sums->value[colored ? ISO_SUM_SIDE : ISO_FLAT_SIDE] = v_load(patch->sides + at);
    sums->value[colored ? ISO_SUM_DEPTH : ISO_FLAT_DEPTH] = v_load(patch->depths + at);
    sums->front = v_load(patch->front + at);
}

#endif
