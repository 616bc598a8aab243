/* splat_simd: adds large discs, one at a time, to all tiles that they cover: a vector of pixels is
 * intersected at once. Averaging of what lies near the front is that of surface splatting (Zwicker et al.
 * 2001; Botsch et al. 2005), in one pass or two (iso_discs_pass). */
#ifndef ISO_RENDER_DISCS_SPLAT_SIMD_H
#define ISO_RENDER_DISCS_SPLAT_SIMD_H

#include "render/discs/scatter_simd.h"

enum { TILE_FLOATS = ISO_SUMS * ISO_LANES };

/* Number of the tile that contains pixel (x, y) of the view. */
ISO_INLINE size_t tile_number(const iso_discs_patch *patch, int x, int y) {
    const size_t row = (size_t)((y - patch->first[1]) / TILE_ROWS);
    return row * patch->tiles + (size_t)((x - patch->first[0]) / ISO_DISCS_TILE);
}

/* Adds a disc to the sums of pixels; a hit is where far < 1. A hit more than the disc's thickness behind
 * the front is ignored; a hit more than the thickness before the front replaces the sums. Front-facing and
 * flipped back-facing discs are never mixed: at silhouettes both are close together, and the mean of their
 * normals would face the eye. Within the thickness of the front, a front-facing disc replaces flipped
 * ones, and a flipped disc is ignored where there are front-facing ones. */
ISO_INLINE void add_disc(const iso_discs_params *params, const vf *disc, vf depth, vf far, rf_sums *sums) {
    vf *const to = sums->value;
    const vf thickness = ISO_DISCS_THICKNESS * disc[ISO_DISC_RADIUS];
    const vm there = v_lt(sums->front, v_set(ISO_NOWHERE)), before = v_lt(depth, sums->front - thickness),
             near = v_le(depth, sums->front + thickness);
    const vm flipped = v_lt(disc[ISO_DISC_SIDE], v_set(0)), was_flipped = v_lt(to[ISO_SUM_SIDE], v_set(0));
    const vm loses = v_and(there, v_andnot(flipped, was_flipped)),
             wins = v_and(there, v_andnot(was_flipped, flipped));
    const vm joins = v_and(v_lt(far, v_set(1)), v_or(before, v_andnot(near, loses)));
    const vm fresh = v_and(joins, v_or(before, wins));
    if (v_mask(fresh))
        for (int k = 0; k < ISO_SUMS; k++) to[k] = v_select(fresh, v_set(0), to[k]);
    const vf weight = v_select(joins, gaussian(far), v_set(0));
    const vf nearest = params->first ? sums->front : v_min(depth, sums->front);
    sums->front = v_select(joins, v_select(fresh, depth, nearest), sums->front);
    to[ISO_SUM_WEIGHT] += weight;
    for (int k = ISO_SUM_NX; k <= ISO_SUM_Z; k++) to[k] += weight * disc[ISO_DISC_LIT_X + k - ISO_SUM_NX];
    to[ISO_SUM_DEPTH] += weight * depth;
}

/* The same for filtered discs. A hit covers its pixel when it lies on the disc; else the pixel lies only in
 * the low-pass filter. Pixels that are not covered have an outer front instead of a front. Hits that do not
 * cover their pixel are added by the rules above to pixels that are not covered; to those that are, only
 * within the thickness of the front, which they do not move. The first hit that covers a pixel begins its
 * front, and replaces the sums unless it is within the thickness of the outer front. */
ISO_INLINE void add_filtered_disc(const vf *disc, vf depth, vf far, vm covers, vf *outer, rf_sums *sums) {
    vf *const to = sums->value;
    const vf thickness = ISO_DISCS_THICKNESS * disc[ISO_DISC_RADIUS];
    const vm hit = v_lt(far, v_set(1)), covered = v_lt(sums->front, v_set(ISO_NOWHERE));
    const vf front = v_select(covered, sums->front, *outer);
    const vm reaches = v_le(depth, front + thickness), near = v_and(reaches, v_le(front - thickness, depth));
    const vm flipped = v_lt(disc[ISO_DISC_SIDE], v_set(0)), was_flipped = v_lt(to[ISO_SUM_SIDE], v_set(0));
    const vm other = v_and(near, v_or(v_andnot(flipped, was_flipped), v_andnot(was_flipped, flipped))),
             keep = v_andnot(near, other);
    const vm first = v_andnot(v_and(hit, covers), covered), inner = v_andnot(v_and(hit, covered), covers),
             usual = v_andnot(v_andnot(hit, first), inner);
    const vm joins =
        v_or(first, v_or(v_and(inner, keep), v_and(usual, v_andnot(reaches, v_and(other, flipped)))));
    const vm fresh = v_andnot(joins, keep);
    const vf nearest = v_select(v_andnot(v_lt(front, depth), v_or(other, first)), front, depth);
    if (v_mask(fresh))
        for (int k = 0; k < ISO_SUMS; k++) to[k] = v_select(fresh, v_set(0), to[k]);
    const vf weight = v_select(joins, gaussian(far) * disc[ISO_DISC_SHARE], v_set(0));
    const vm moves = v_andnot(joins, inner);
    sums->front = v_select(v_and(moves, covers), nearest, sums->front);
    *outer = v_select(v_andnot(moves, covers), nearest, *outer);
    to[ISO_SUM_WEIGHT] += weight;
    for (int k = ISO_SUM_NX; k <= ISO_SUM_Z; k++) to[k] += weight * disc[ISO_DISC_LIT_X + k - ISO_SUM_NX];
    to[ISO_SUM_DEPTH] += weight * depth;
}

/* The front pass: lowers the fronts of the pixels of tile number `tile` that a disc hits; a hit is where
 * far < 1. */
ISO_INLINE void lower_tile_fronts(const iso_discs_patch *patch, size_t tile, const vf *disc, vf depth,
                                  vf far) {
    const vf thickness = ISO_DISCS_THICKNESS * disc[ISO_DISC_RADIUS];
    const vm hit = v_lt(far, v_set(1)), flipped = v_lt(disc[ISO_DISC_SIDE], v_set(0)),
             facing = v_andnot(hit, flipped);
    float *const planes[4] = {patch->front, patch->flipped, patch->facing, patch->facing_reach};
    const vf values[4] = {depth, depth, depth, depth - thickness};
    const vm lowered[4] = {hit, v_and(hit, flipped), facing, facing};
    for (int k = 0; k < 4; k++) {
        float *const at = planes[k] + tile * ISO_LANES;
        const vf old = v_load(at);
        v_store(at, v_select(lowered[k], v_min(values[k], old), old));
    }
}

/* The sum pass: adds a disc to the sums of the pixels of tile number `tile` where it is near the front. */
ISO_INLINE void add_front_disc(const iso_discs_patch *patch, size_t tile, const vf *disc, vf depth, vf far,
                               vm covers, vf share, rf_sums *sums) {
    vf *const to = sums->value;
    const vf thickness = ISO_DISCS_THICKNESS * disc[ISO_DISC_RADIUS];
    const vm flipped = v_lt(disc[ISO_DISC_SIDE], v_set(0)),
             wanted = v_lt(v_load(patch->flipped + tile * ISO_LANES),
                           v_load(patch->facing_reach + tile * ISO_LANES)),
             other = v_or(v_andnot(flipped, wanted), v_andnot(wanted, flipped));
    const vm near =
        v_and(v_le(depth, sums->front + thickness), v_or(covers, v_le(sums->front - thickness, depth)));
    const vm joins = v_andnot(v_and(v_lt(far, v_set(1)), near), other);
    const vf weight = v_select(joins, gaussian(far) * share, v_set(0));
    to[ISO_SUM_WEIGHT] += weight;
    for (int k = ISO_SUM_NX; k <= ISO_SUM_Z; k++) to[k] += weight * disc[ISO_DISC_LIT_X + k - ISO_SUM_NX];
    to[ISO_SUM_DEPTH] += weight * depth;
}

/* Tiles that a disc hits, with depths and distances (rf_hit.far), waiting to be added. Whether a disc hits
 * a tile cannot be predicted: intersecting many tiles without a branch and adding the hits afterwards is
 * much faster than branching for each tile. */
enum { WAITING_TILES = 32 };
typedef struct rf_waiting_tiles {
    uint32_t count;
    size_t tile[WAITING_TILES];
    vf depth[WAITING_TILES], far[WAITING_TILES];
    vm covers[WAITING_TILES]; /* of filtered discs only */
} rf_waiting_tiles;

/* Adds a disc to the sums of the tiles that it hits, and empties the list of waiting tiles. */
ISO_INLINE void add_waiting_tiles(const iso_discs_params *params, const iso_discs_patch *patch,
                                  const vf *disc, const bool filtered, rf_waiting_tiles *shares) {
    for (uint32_t i = 0; i < shares->count; i++) {
        if (params->pass == ISO_DISCS_FRONT_PASS) {
            lower_tile_fronts(patch, shares->tile[i], disc, shares->depth[i], shares->far[i]);
            continue;
        }
        float *at = patch->sums + shares->tile[i] * TILE_FLOATS,
              *front = patch->front + shares->tile[i] * ISO_LANES;
        rf_sums sums;
        sums.front = v_load(front);
        ISO_UNROLL for (int k = 0; k < ISO_SUMS; k++) sums.value[k] = v_load(at + k * ISO_LANES);
        if (params->pass == ISO_DISCS_SUM_PASS) {
            const vm covers = filtered ? shares->covers[i] : v_lt(shares->far[i], v_set(1));
            add_front_disc(patch, shares->tile[i], disc, shares->depth[i], shares->far[i], covers,
                           filtered ? disc[ISO_DISC_SHARE] : v_set(1), &sums);
        } else if (filtered) {
            float *outer_front = patch->outer_front + shares->tile[i] * ISO_LANES;
            vf outer = v_load(outer_front);
            add_filtered_disc(disc, shares->depth[i], shares->far[i], shares->covers[i], &outer, &sums);
            v_store(outer_front, outer);
        } else {
            add_disc(params, disc, shares->depth[i], shares->far[i], &sums);
        }
        v_store(front, sums.front);
        ISO_UNROLL for (int k = 0; k < ISO_SUMS; k++) v_store(at + k * ISO_LANES, sums.value[k]);
    }
    shares->count = 0;
}

/* add_waiting_tiles with and without the low-pass filter: functions of their own, which all discs share. */
ISO_STEP static void add_plain_tiles(const iso_discs_params *params, const iso_discs_patch *patch,
                                     const vf *disc, rf_waiting_tiles *shares) {
    add_waiting_tiles(params, patch, disc, false, shares);
}
ISO_STEP static void add_filtered_tiles(const iso_discs_params *params, const iso_discs_patch *patch,
                                        const vf *disc, rf_waiting_tiles *shares) {
    add_waiting_tiles(params, patch, disc, true, shares);
}

/* Adds one disc, whose values fill vectors, to the tiles that `cover` allows. `filtered`: with the low-pass
 * filter; `exact`: intersect with each pixel's own ray; `cut`: clip the disc to its box. */
ISO_INLINE void splat_disc(const iso_discs_params *params, const iso_discs_patch *patch, const vf *disc,
                           const rf_cover *cover, const bool curved, const bool filtered, const bool exact,
                           bool cut) {
    const int32_t *box = cover->box;
    const vm all = v_eqi(v_seti(0), v_seti(0)), how = exact ? all : v_andnot(all, all);
    const vf thickness = ISO_DISCS_THICKNESS * disc[ISO_DISC_RADIUS];
    const vi lane_x = v_lanes() & (ISO_DISCS_TILE - 1), lane_y = v_lanes() / ISO_DISCS_TILE;
    const int first_y = box[1] - (box[1] - patch->first[1]) % TILE_ROWS;
    rf_waiting_tiles shares;
    shares.count = 0;
    for (int y = first_y; y <= box[3]; y += TILE_ROWS) {
        int span[2];
        if (!cover_columns(cover, y, y + TILE_ROWS - 1, exact, span)) continue;
        const vi rows = lane_y + y;
        const vf line = v_to_float(rows + params->target->view->above) + 0.5f;
        const vf dy = line - disc[ISO_DISC_ROW];
        const rf_row row = start_row(disc, curved, dy, ray_slope(params, 1, line));
        int x = span[0] & ~(ISO_DISCS_TILE - 1);
        for (size_t tile = tile_number(patch, x, y); x <= span[1]; x += ISO_DISCS_TILE, tile++) {
            const vi columns = lane_x + x;
            const vf column = v_to_float(columns) + 0.5f, dx = column - disc[ISO_DISC_COLUMN];
            rf_hit hit = intersect(params, disc, curved, &row, dx, ray_slope(params, 0, column), how);
            if (cut) clip_to_boxes(params, disc, &hit);
            if (filtered) shares.covers[shares.count] = filter_hits(params, disc, dx, dy, &hit);
            if (cut && params->cuts) cut_hits(params, disc, &hit);
            if (exact || !curved) { /* the other discs have no hits outside their bounds */
                const vi out = (columns - box[0]) | (box[2] - columns) | (rows - box[1]) | (box[3] - rows);
                hit.far = v_select(v_lti(out, v_seti(0)), v_set(1), hit.far);
            }
            /* the depth of a miss may be NaN */
            const vm met = v_lt(hit.far, v_set(1));
            const vf depth = disc[ISO_DISC_Z] + v_select(met, hit.q[2], v_set(0));
            vm joins = met;
            if (params->pass != ISO_DISCS_FRONT_PASS)
                joins = v_and(met, v_le(depth, v_load(patch->front + tile * ISO_LANES) + thickness));
            if (patch->limit) {
                const vm before = v_le(depth, v_load(patch->limit + tile * ISO_LANES) + thickness);
                hit.far = v_select(before, hit.far, v_set(1));
                joins = v_and(joins, before);
            }
            const uint32_t i = shares.count;
            shares.tile[i] = tile;
            shares.depth[i] = depth;
            shares.far[i] = hit.far;
            shares.count += v_mask(joins) != 0;
            if (shares.count == WAITING_TILES)
                (filtered ? add_filtered_tiles : add_plain_tiles)(params, patch, disc, &shares);
        }
    }
    if (shares.count) (filtered ? add_filtered_tiles : add_plain_tiles)(params, patch, disc, &shares);
}

/* Adds the discs of a vector, one after the other. */
ISO_INLINE void splat_discs(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                            const bool filtered, rf_disc *discs) {
    rf_bounds bounds;
    const vm live = bound_discs(params, patch, curved, filtered, discs, &bounds);
    const uint32_t exact = v_mask(bounds.exact), cuts = v_mask(discs->clipped);
    float value[ISO_DISC_VALUES][ISO_LANES];
    int32_t box[4][ISO_LANES];
    ISO_UNROLL for (int k = 0; k < ISO_DISC_VALUES; k++) v_store(value[k], discs->value[k]);
    for (int k = 0; k < 2; k++) {
        v_storei(box[k], bounds.lo[k]);
        v_storei(box[2 + k], bounds.hi[k]);
    }
    for (uint32_t left = v_mask(live); left; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        const rf_cover cover = {.box = {box[0][lane], box[1][lane], box[2][lane], box[3][lane]},
                                .x = value[ISO_DISC_COLUMN][lane] - 0.5f,
                                .y = value[ISO_DISC_ROW][lane] - 0.5f - (float)params->target->view->above,
                                .radius = value[ISO_DISC_PIXELS][lane]};
        vf disc[ISO_DISC_VALUES];
        ISO_UNROLL for (int k = 0; k < ISO_DISC_VALUES; k++) disc[k] = v_set(value[k][lane]);
        const bool cut = cuts >> lane & 1;
        if (exact >> lane & 1)
            splat_disc(params, patch, disc, &cover, curved, filtered, true, cut);
        else
            splat_disc(params, patch, disc, &cover, curved, filtered, false, cut);
    }
}

ISO_INLINE void splat_curved(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    splat_discs(params, patch, true, false, discs);
}

ISO_INLINE void splat_flat(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    splat_discs(params, patch, false, false, discs);
}

ISO_INLINE void splat_filtered(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs) {
    splat_discs(params, patch, false, true, discs);
}

static void splat_block(const iso_discs_params *params, const iso_discs_patch *patch, uint32_t block) {
    if (iso_discs_use_curvature(params, &params->blocks[block]))
        make_discs(params, patch, block, true, false, splat_curved);
    else if (iso_discs_use_filter(params, &params->blocks[block]))
        make_discs(params, patch, block, false, true, splat_filtered);
    else
        make_discs(params, patch, block, false, false, splat_flat);
}

static void resolve_tiles(const iso_discs_params *params, const iso_discs_patch *patch) {
    const int width = params->target->view->width;
    const vi lane_x = v_lanes() & (ISO_DISCS_TILE - 1), lane_y = v_lanes() / ISO_DISCS_TILE;
    for (int y = patch->first[1]; y <= patch->last[1]; y += TILE_ROWS)
        for (int x = patch->first[0]; x <= patch->last[0]; x += ISO_DISCS_TILE) {
            const size_t tile = tile_number(patch, x, y);
            const float *from = patch->sums + tile * TILE_FLOATS;
            rf_sums sums;
            sums.front = v_load(patch->front + tile * ISO_LANES);
            if (!v_mask(v_lt(sums.front, v_set(ISO_NOWHERE)))) continue;
            ISO_UNROLL for (int k = 0; k < ISO_SUMS; k++) sums.value[k] = v_load(from + k * ISO_LANES);
            const vf column = v_to_float(lane_x + x) + 0.5f,
                     row = v_to_float(lane_y + (y + params->target->view->above)) + 0.5f;
            const rf_samples samples = resolve_sums(params, &sums, false, column, row);
            rf_stored stored;
            store_samples(&samples, &stored);
            const int right = patch->last[0] - x + 1, count = right < ISO_DISCS_TILE ? right : ISO_DISCS_TILE;
            for (int line = 0; line < TILE_ROWS && y + line <= patch->last[1]; line++)
                write_some_samples(params, (size_t)(y + line) * (size_t)width + (size_t)x,
                                   line * ISO_DISCS_TILE, count, &stored);
        }
}

static void load_limits_tiles(const iso_discs_params *params, const iso_discs_patch *patch) {
    const iso_gbuffer *g = params->target->gbuffer;
    for (int y = patch->first[1]; y <= patch->last[1]; y++)
        for (int x = patch->first[0]; x <= patch->last[0]; x++) {
            const int lane =
                (y - patch->first[1]) % TILE_ROWS * ISO_DISCS_TILE + (x - patch->first[0]) % ISO_DISCS_TILE;
            patch->limit[tile_number(patch, x, y) * ISO_LANES + (size_t)lane] =
                g->depth[(size_t)y * (size_t)g->width + (size_t)x];
        }
}

static void find_deepest_tiles(const iso_discs_patch *patch, float *deepest) {
    const float *front = patch->front;
    for (int y = 0; y <= patch->last[1] - patch->first[1]; y += TILE_ROWS)
        for (int x = 0; x < (int)patch->stride; x += ISO_DISCS_TILE, front += ISO_LANES)
            note_deepest(patch, x, y, ISO_LANES, front, deepest);
}

#endif
