/* common_simd: the steps shared by scatter_simd.h and splat_simd.h: selecting the points of a block whose
 * discs may be visible in a patch, making discs of them, and resolving sums into samples (the method is
 * described in discs.h). `curved` and `flat` are constants for the compiler. */
#ifndef ISO_RENDER_DISCS_COMMON_SIMD_H
#define ISO_RENDER_DISCS_COMMON_SIMD_H

#include "render/discs/disc_simd.h"

/* A vector of pixels: their sums (ISO_SUM or ISO_FLAT) and front depths. */
typedef struct rf_sums {
    vf value[ISO_SUMS], front;
} rf_sums;

/* ---- from sums to the picture */

/* Adds to the summed normals the change of the normal from the discs' centres to the hits: the mean shape
 * operator times the mean offset, reduced where the shape operators are probably noise. Replaces the sums
 * of shape operators by their means; `inverse` is 1 / the weight. `column` and `row`: pixels of the whole
 * picture. */
ISO_INLINE void add_curvature_term(const iso_discs_params *params, vf *sum, vf inverse, vf column, vf row) {
    vf turn[3], q[3];
    const vf pixel =
        params->orthographic ? sum[ISO_SUM_WEIGHT] * (1 / params->focal) : sum[ISO_SUM_DEPTH] * params->slope;
    for (int k = ISO_SUM_XX; k <= ISO_SUM_ZZ; k++) sum[k] *= inverse;
    /* weighted sum of the offsets from the discs' centres to the hits */
    q[0] = (column - params->axis[0]) * pixel - sum[ISO_SUM_X];
    q[1] = (row - params->axis[1]) * pixel - sum[ISO_SUM_Y];
    q[2] = sum[ISO_SUM_DEPTH] - sum[ISO_SUM_Z];
    /* `alike`: 1 when all shape operators are equal, less when they differ; `small`: 1 when they are small */
    const float noisy = ISO_DISCS_NOISY_CURVATURE * params->voxels_per_mm;
    const vf norm = squared_norm(sum + ISO_SUM_XX);
    const vf alike = norm / v_max(sum[ISO_SUM_SQUARE] * inverse, v_set(1e-30f)),
             small = 1 / (1 + norm * (1 / (noisy * noisy)));
    apply_operator(sum + ISO_SUM_XX, q, turn);
    for (int k = 0; k < 3; k++) sum[ISO_SUM_NX + k] += alike * small * turn[k];
}

/* The samples of a vector of pixels. */
typedef struct rf_samples {
    vf depth, normal[3]; /* depth: ISO_NOWHERE where there is no disc; normal: unit, view space */
    vi color;            /* as in iso_gbuffer.color, if points or all discs have colours */
} rf_samples;

ISO_INLINE vi resolve_colors(const iso_discs_params *params, const vf *sum, vf inverse) {
    vi color = v_seti((int32_t)((uint32_t)(params->target->surface + 1) << 24));
    for (int k = 0; k < 3; k++)
        color |= v_trunc(v_min(sum[ISO_SUM_RED + k] * inverse + 0.5f, v_set(255))) << 8 * k;
    return color;
}

/* Computes the samples of a vector of pixels from their sums. */
ISO_INLINE rf_samples resolve_sums(const iso_discs_params *params, rf_sums *sums, const bool flat, vf column,
                                   vf row) {
    rf_samples out;
    vf *const sum = sums->value, square = v_set(0);
    const vm there = v_lt(sums->front, v_set(ISO_NOWHERE));
    const vf inverse = 1 / v_select(there, sum[ISO_SUM_WEIGHT], v_set(1));
    if (!flat && !params->colored) add_curvature_term(params, sum, inverse, column, row);
    out.color =
        !flat && params->colored ? resolve_colors(params, sum, inverse) : v_seti((int32_t)params->color);
    for (int k = 0; k < 3; k++) {
        out.normal[k] = sum[ISO_SUM_NX + k] + 0.0f;
        square += out.normal[k] * out.normal[k];
    }
    const vm none = v_le(square, v_set(1e-20f));
    vf scale = 1 / v_sqrt(v_select(none, v_set(1), square));
    if (!params->cull)
        scale = v_select(v_lt(sum[flat ? ISO_FLAT_SIDE : ISO_SUM_SIDE], v_set(0)), -scale, scale);
    for (int k = 0; k < 3; k++) out.normal[k] = v_select(none, v_set(k == 2 ? -1 : 0), out.normal[k] * scale);
    out.depth = v_select(there, sum[flat ? ISO_FLAT_DEPTH : ISO_SUM_DEPTH] * inverse, v_set(ISO_NOWHERE));
    return out;
}

/* Samples in memory, so that some of them can be written. */
typedef struct rf_stored {
    float depth[ISO_LANES], normal[3][ISO_LANES];
    int32_t color[ISO_LANES];
} rf_stored;

ISO_INLINE void store_samples(const rf_samples *samples, rf_stored *stored) {
    v_store(stored->depth, samples->depth);
    for (int k = 0; k < 3; k++) v_store(stored->normal[k], samples->normal[k]);
    v_storei(stored->color, samples->color);
}

/* Writes `count` of the samples, from `from` on, into a row of the gbuffer where they are nearer. */
ISO_INLINE void write_some_samples(const iso_discs_params *params, size_t at, int from, int count,
                                   const rf_stored *samples) {
    const iso_gbuffer *g = params->target->gbuffer;
    for (int i = from; i < from + count; i++, at++) {
        if (!(samples->depth[i] < g->depth[at] && samples->depth[i] < ISO_NOWHERE)) continue;
        g->depth[at] = samples->depth[i];
        for (int k = 0; k < 3; k++) g->normal[k][at] = samples->normal[k][i];
        g->surface[at] = params->target->surface;
        if (params->colored || params->color) g->color[at] = (uint32_t)samples->color[i];
    }
}

/* The same for a whole vector. */
ISO_INLINE void write_samples(const iso_discs_params *params, size_t at, const rf_samples *samples) {
    const iso_gbuffer *g = params->target->gbuffer;
    const vf there = v_load(g->depth + at);
    const vm nearer = v_and(v_lt(samples->depth, there), v_lt(samples->depth, v_set(ISO_NOWHERE)));
    if (!v_mask(nearer)) return;
    v_store(g->depth + at, v_select(nearer, samples->depth, there));
    for (int k = 0; k < 3; k++) {
        float *plane = g->normal[k] + at;
        v_store(plane, v_select(nearer, samples->normal[k], v_load(plane)));
    }
    v_store_u8(g->surface + at,
               v_selecti(nearer, v_seti(params->target->surface), v_load_u8(g->surface + at)));
    if (!params->colored && !params->color) return;
    int32_t *color = (int32_t *)g->color + at;
    v_storei(color, v_selecti(nearer, samples->color, v_loadi(color)));
}

/* ---- bounds of discs in the picture */

/* Columns and rows of the view that a vector of discs may cover. */
typedef struct rf_bounds {
    vi lo[2], hi[2];
    vm exact; /* discs so near to the eye that rays must not be taken as parallel */
} rf_bounds;

/* How far discs reach on both sides of their centres along an axis of the picture, in mm at their depth: the
 * projection of a flat disc plus that of the height by which a curved one departs from it. `ray`: the ray's
 * direction along the axis. */
ISO_INLINE vf projected_reach(const vf *disc, int axis, vf ray) {
    const vf along = disc[ISO_DISC_NX + axis] - ray * disc[ISO_DISC_NZ], whole = 1 + ray * ray,
             longest = 0.5f + 0.5f * whole; /* sqrt(whole) at least */
    const vf r = disc[ISO_DISC_RADIUS], cap = v_min(v_sqrt(disc[ISO_DISC_SQUARE]) * r * 0.5f, v_set(1));
    const vf square = disc[ISO_DISC_NX] * disc[ISO_DISC_NX] + disc[ISO_DISC_NY] * disc[ISO_DISC_NY] +
                      disc[ISO_DISC_NZ] * disc[ISO_DISC_NZ];
    const vf flat = v_sqrt(v_max(whole - along * along / square, v_set(0)));
    return r * v_min(flat + v_abs(along) * cap, longest) * 1.03f;
}

/* The same in pixels for flat discs, with the low-pass filter if they are `filtered`; not beyond the circles
 * that contain them. Perspective widens a disc by the more the larger it is for its depth. */
ISO_INLINE vf flat_reach(const vf *disc, const bool filtered, int axis, vf ray) {
    const float low_pass = ISO_DISCS_LOW_PASS;
    const vf along = disc[ISO_DISC_NX + axis] - ray * disc[ISO_DISC_NZ];
    const vf flat = v_sqrt(v_max(1 + ray * ray - along * along, v_set(0))),
             wider = 1.01f + 2 * disc[ISO_DISC_RADIUS] * disc[ISO_DISC_FLAT_NEAR];
    vf reach = disc[ISO_DISC_RADIUS] * disc[ISO_DISC_SCALE] * flat * wider;
    if (filtered) reach = v_sqrt(reach * reach + low_pass * low_pass);
    return v_min(reach, disc[ISO_DISC_PIXELS]);
}

/* Bounds discs in the patch; returns the live ones whose bounds are not empty. */
ISO_INLINE vm bound_discs(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                          const bool filtered, const rf_disc *discs, rf_bounds *out) {
    const vf *disc = discs->value;
    vm live = discs->live;
    const int above = params->target->view->above;
    for (int k = 0; k < 2; k++) {
        const int lo = patch->first[k], hi = patch->last[k];
        const vf at = disc[ISO_DISC_COLUMN + k] - (k ? (float)above + 0.5f : 0.5f);
        const vf ray = ray_slope(params, k, disc[ISO_DISC_COLUMN + k]),
                 reach = curved ? projected_reach(disc, k, ray) * disc[ISO_DISC_SCALE]
                                : flat_reach(disc, filtered, k, ray);
        const vf first = v_max(at - reach, v_set((float)lo)), last = v_min(at + reach, v_set((float)hi));
        out->lo[k] = -v_floor(-v_min(first, v_set((float)hi + 1)));
        out->hi[k] = v_floor(v_max(last, v_set((float)lo - 1)));
        live = v_andnot(live, v_lti(out->hi[k], out->lo[k]));
    }
    const float exact = curved ? ISO_DISCS_EXACT : ISO_DISCS_FLAT_EXACT;
    out->exact = v_andnot(live, v_le(disc[ISO_DISC_RADIUS], disc[ISO_DISC_Z] * exact));
    if (params->orthographic) out->exact = v_andnot(live, live);
    return live;
}

/* ---- points to discs */

/* The state of making discs from the points of a block, a vector at a time. */
typedef struct rf_batch {
    const iso_point_block *block;
    rf_lanes lanes;
    rf_points points;
    rf_disc discs;
    /* Points that may be visible wait here until they fill a vector: how many, their numbers in the block,
     * the words of packed points, and their curvatures. */
    uint32_t waiting;
    int32_t number[2 * ISO_LANES], word[2][2 * ISO_LANES], curvature[2][2 * ISO_LANES];
} rf_batch;

/* The live discs that are not hidden by what has been drawn. The patch is columns lo[0] .. hi[0] and rows
 * lo[1] .. hi[1] of the whole picture. */
ISO_INLINE vm find_unhidden(const iso_discs_patch *patch, const rf_disc *discs, const int lo[2],
                            const int hi[2]) {
    vi cell[2];
    for (int k = 0; k < 2; k++) {
        const vf at = discs->value[ISO_DISC_COLUMN + k], last = v_set((float)hi[k]);
        cell[k] = (v_trunc(v_max(v_min(at, last), v_set((float)lo[k]))) - lo[k]) >> patch->shift;
    }
    const vf hidden = v_gather(patch->hidden, cell[1] * patch->cells + cell[0]);
    return v_and(discs->live, v_le(discs->value[ISO_DISC_Z], hidden));
}

/* Whether waiting points must be read from memory again by their numbers: they are surfels, or have radii or
 * colours. */
ISO_INLINE bool must_read_again(const iso_discs_params *params) {
    return !params->points->packed || params->points->radii || params->colored;
}

/* Whether discs of a block may be so small that they contain no pixel's centre. */
ISO_INLINE bool is_tiny(const iso_point_block *block) {
    return block->radius[0] * (ISO_DISCS_BALL / ISO_DISC_RADII) < 0.6f;
}

/* Reads a vector of the block's points from `i` on and adds those that may be visible in the patch to the
 * waiting ones. */
ISO_INLINE void select_points(const iso_discs_params *params, const iso_discs_patch *patch, const bool curved,
                              const bool filtered, uint32_t i, rf_batch *batch) {
    const iso_point_block *block = batch->block;
    const int above = params->target->view->above;
    const int lo[2] = {patch->first[0], patch->first[1] + above},
              hi[2] = {patch->last[0], patch->last[1] + above};
    rf_lanes lanes;
    rf_points points = batch->points;
    rf_disc discs;
    points.live = read_points(params, block, i, &lanes);
    decode_positions(params, &lanes, &points);
    project_centres(params, block, filtered, &points, &discs);
    discs.live = overlaps(&discs, lo, hi, !filtered && is_tiny(block));
    if (patch->hidden) discs.live = find_unhidden(patch, &discs, lo, hi);
    const uint32_t live = v_mask(discs.live), at = batch->waiting;
    if (!live) return;
    if (must_read_again(params)) v_compressi(batch->number + at, discs.live, v_lanes() + (int32_t)i);
    for (int k = 0; k < 2 && params->points->packed; k++)
        v_compressi(batch->word[k] + at, discs.live, v_loadi(lanes.word[k]));
    if (curved) read_curvatures(params, block, i, &lanes);
    for (int k = 0; k < 2 && curved; k++)
        v_compressi(batch->curvature[k] + at, discs.live, v_loadi(lanes.curvature[k]));
    batch->waiting += (uint32_t)__builtin_popcount(live);
}

/* Moves the points that have waited longest into the lanes: a whole vector, or all if there are fewer. */
ISO_INLINE void load_waiting(const iso_discs_params *params, const bool curved, rf_batch *batch) {
    rf_lanes *lanes = &batch->lanes;
    const uint32_t count = batch->waiting < ISO_LANES ? batch->waiting : ISO_LANES;
    if (count < ISO_LANES) memset(lanes, 0, sizeof *lanes);
    if (must_read_again(params)) {
        for (uint32_t lane = 0; lane < count; lane++)
            read_point(params, batch->block, (uint32_t)batch->number[lane], (int)lane, lanes);
        v_storei(batch->number, v_loadi(batch->number + ISO_LANES));
    }
    for (int k = 0; k < 2 && params->points->packed; k++) {
        v_storei(lanes->word[k], v_loadi(batch->word[k]));
        v_storei(batch->word[k], v_loadi(batch->word[k] + ISO_LANES));
    }
    for (int k = 0; k < 2 && curved; k++) {
        v_storei(lanes->curvature[k], v_loadi(batch->curvature[k]));
        v_storei(batch->curvature[k], v_loadi(batch->curvature[k] + ISO_LANES));
    }
    batch->points.live = v_lti(v_lanes(), v_seti((int32_t)count));
    batch->waiting -= count;
}

/* Makes complete discs of the points in the lanes. */
ISO_INLINE void make_batch(const iso_discs_params *params, const bool curved, const bool filtered,
                           rf_batch *batch) {
    rf_facing facing;
    decode_positions(params, &batch->lanes, &batch->points);
    project_centres(params, batch->block, filtered, &batch->points, &batch->discs);
    orient_discs(params, &batch->lanes, &batch->discs, &facing);
    complete_discs(params, curved, &batch->lanes, &facing, &batch->discs);
    for (int k = 0; k < 3 && params->colored; k++)
        batch->discs.value[ISO_DISC_RED + k] = v_load(batch->lanes.color[k]);
    set_boxes(params, curved, &batch->lanes, &batch->points, &batch->discs);
    if (params->cuts) cut_discs(params, params->centres, &batch->discs);
}

/* select_points and make_batch for each kind of disc: functions of their own, which all ways of adding discs
 * share. */
#define MAKE_STEPS(name, curved, filtered)                                                                   \
    ISO_STEP static void select_##name(const iso_discs_params *params, const iso_discs_patch *patch,         \
                                       uint32_t i, rf_batch *batch) {                                        \
        select_points(params, patch, curved, filtered, i, batch);                                            \
    }                                                                                                        \
    ISO_STEP static void make_##name(const iso_discs_params *params, rf_batch *batch) {                      \
        make_batch(params, curved, filtered, batch);                                                         \
    }
MAKE_STEPS(curved, true, false)
MAKE_STEPS(flat, false, false)
MAKE_STEPS(filtered, false, true)
#undef MAKE_STEPS

/* Whether all points of a block lie in the patch and none is known to be hidden, so that none need be
 * sorted out. */
ISO_INLINE bool block_fits(const iso_discs_params *params, const iso_discs_patch *patch, const bool filtered,
                           const iso_point_block *block) {
    bool whole = !patch->hidden && (filtered || !is_tiny(block)) && block->depth[0] >= params->near;
    for (int k = 0; k < 2; k++) {
        const int32_t *pixels = k ? block->row : block->column;
        const float axis = params->axis[k] - (k ? (float)params->target->view->above : 0);
        whole &= (float)pixels[0] + axis >= (float)patch->first[k] &&
                 (float)pixels[1] + axis <= (float)patch->last[k];
    }
    return whole;
}

/* Whether discs of a block may reach the grid's border. */
ISO_INLINE bool may_reach_border(const iso_discs_params *params, const iso_point_block *block) {
    const float reach =
        params->radius * (params->ball[0] + params->ball[1]) * params->voxels_per_mm * 1.01f * block->scale;
    bool far = params->points->packed && !params->points->radii;
    for (int k = 0; k < 3; k++) {
        const float low = (float)block->brick[k] * ISO_BRICK + params->first_step;
        far &= low >= reach &&
               low + ISO_POINT_COORDINATE_STEPS * params->voxels_per_step <= params->border[k] - reach;
    }
    return params->has_border && !far;
}

/* The type of functions that add a vector of complete discs to the patch. */
typedef void rf_add(const iso_discs_params *params, const iso_discs_patch *patch, rf_disc *discs);

/* Makes discs of the points of block `number` that may be visible in the patch and passes them to `take`,
 * in their order. */
ISO_INLINE void make_discs(const iso_discs_params *params, const iso_discs_patch *patch, uint32_t number,
                           const bool curved, const bool filtered, rf_add *take) {
    rf_batch batch;
    batch.block = &params->blocks[number];
    batch.waiting = 0;
    batch.points.scale = batch.block->scale;
    batch.points.near_border = may_reach_border(params, batch.block);
    for (int k = 0; k < 3; k++) {
        batch.points.corner[k] = v_set(params->corner[number][k]);
        batch.points.voxel[k] = v_set((float)batch.block->brick[k] * ISO_BRICK + params->first_step);
    }
    const bool whole = block_fits(params, patch, filtered, batch.block);
    const uint32_t count = batch.block->count;
    const bool counted = params->pass != ISO_DISCS_FRONT_PASS;
    patch->counts->tested += counted ? count : 0;
    for (uint32_t i = 0; i < count || batch.waiting;) {
        if (whole) {
            batch.points.live = read_points(params, batch.block, i, &batch.lanes);
            if (curved) read_curvatures(params, batch.block, i, &batch.lanes);
            i += ISO_LANES;
        } else {
            for (; batch.waiting < ISO_LANES && i < count; i += ISO_LANES)
                (curved ? select_curved : filtered ? select_filtered : select_flat)(params, patch, i, &batch);
            if (!batch.waiting) break;
            load_waiting(params, curved, &batch);
        }
        if (counted) patch->counts->drawn += (uint64_t)__builtin_popcount(v_mask(batch.points.live));
        (curved ? make_curved : filtered ? make_filtered : make_flat)(params, &batch);
        take(params, patch, &batch.discs);
    }
}

#endif
