/* dab_kernel: edits of a brick (dab.h). */
#include <math.h>

#include "base/simd.h"
#include "grids/grid.h"
#include "sculpt/brush/dab.h"
#include "sculpt/field/stencil_simd.h"

/* A dab in floats, with the centre relative to a brick's first voxel. `segment` goes from the centre to
 * `from`. */
typedef struct iso_local_dab {
    float centre[3], segment[3], axis[3][3], plane;
    int number; /* in the touch */
} iso_local_dab;

/* The dabs that can change the brick. */
typedef struct iso_local_dabs {
    int count;
    iso_local_dab dab[ISO_DAB_MAX];
} iso_local_dabs;

static void make_local_dabs(const iso_dabs *dabs, const int brick[3], iso_local_dabs *local) {
    int near[ISO_DAB_MAX];
    local->count = iso_dabs_find_near(dabs, brick, near);
    for (int i = 0; i < local->count; i++) {
        const iso_dab *dab = &dabs->dab[near[i]];
        iso_local_dab *out = &local->dab[i];
        out->number = near[i];
        out->plane = (float)dab->plane + dabs->depth;
        for (int k = 0; k < 3; k++) {
            out->centre[k] = (float)(dab->centre[k] - ISO_BRICK * (double)brick[k]);
            out->segment[k] = (float)(dab->from[k] - dab->centre[k]);
            for (int a = 0; a < 3; a++) out->axis[a][k] = (float)dab->axis[a][k];
        }
    }
}

/* Returns the signed distance from a voxel to one stamp, in voxels of the field. Where the stamp stores no
 * distance it returns INFINITY (outside) or -INFINITY (inside). */
static float stamp_distance(const iso_dabs *dabs, const iso_local_dab *dab, const float voxel[3]) {
    const iso_grid stamp = {.hgrid = (iso_hgrid *)dabs->stamp}; /* only read */
    const iso_transform *transform = &dabs->stamp->transform;
    const double scale = transform->spacing[0] * (double)dabs->radius_voxels;
    const double far = (double)dabs->stamp->band * 0.999;
    double p[3];
    for (int a = 0; a < 3; a++) {
        p[a] = -transform->origin[a] / transform->spacing[a];
        for (int k = 0; k < 3; k++) p[a] += (double)(dab->axis[a][k] * (voxel[k] - dab->centre[k])) / scale;
        if (!(p[a] >= 0 && p[a] <= dabs->stamp->dims[a] - 1)) return INFINITY; /* outside the stamp's grid */
    }
    const double d = iso_grid_sample(&stamp, iso_vec3_make(p[0], p[1], p[2]));
    return (float)(d >= far ? INFINITY : d <= -far ? -INFINITY : d * scale);
}

/* Computes for all voxels of a brick the signed distance to the nearest of the stamps. */
static void stamp_distances(const iso_dabs *dabs, const iso_local_dabs *local, float *out) {
    for (int at = 0; at < ISO_BRICK_VOXELS; at++) {
        const float voxel[3] = {(float)(at % ISO_BRICK), (float)(at / ISO_BRICK % ISO_BRICK),
                                (float)(at / ISO_BRICK_ROWS)};
        out[at] = INFINITY;
        for (int i = 0; i < local->count; i++) {
            const float distance = stamp_distance(dabs, &local->dab[i], voxel);
            if (distance < out[at]) out[at] = distance;
        }
    }
}

/* ISO_LANES three-dimensional vectors, as three SIMD vectors of components. */
typedef struct vf_vector {
    vf x, y, z;
} vf_vector;

/* Returns the positions, relative to the dab's centre, of the ISO_LANES voxels of a row that begin at `x`. */
ISO_INLINE vf_vector position_from_dab(const iso_local_dab *dab, int row, int x) {
    vf_vector p;
    p.x = v_to_float(v_lanes() + v_seti(x)) - v_set(dab->centre[0]);
    p.y = v_set((float)(row % ISO_BRICK) - dab->centre[1]);
    p.z = v_set((float)(row / ISO_BRICK) - dab->centre[2]);
    return p;
}

ISO_INLINE vf dot(const vf_vector *p, const float axis[3]) {
    return p->x * v_set(axis[0]) + p->y * v_set(axis[1]) + p->z * v_set(axis[2]);
}

ISO_INLINE vf length3(vf x, vf y, vf z) {
    return v_sqrt(x * x + y * y + z * z);
}

/* Returns the signed distance to a box. a, b and c say for each axis by how much the position lies beyond the
 * box's sides (negative: between the sides; -INFINITY: the box is infinite along the axis). */
ISO_INLINE vf box_distance(vf a, vf b, vf c) {
    const vf zero = v_set(0);
    const vf outside = length3(v_max(a, zero), v_max(b, zero), v_max(c, zero));
    return outside + v_min(v_max(a, v_max(b, c)), zero);
}

ISO_INLINE vf capsule_distance(const iso_local_dab *dab, const vf_vector *p, float radius) {
    const float *s = dab->segment; /* from the centre to the other end */
    const float square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    vf t = dot(p, s) / v_set(square > 0 ? square : 1);
    t = v_min(v_max(t, v_set(0)), v_set(1));
    return length3(p->x - t * v_set(s[0]), p->y - t * v_set(s[1]), p->z - t * v_set(s[2])) - v_set(radius);
}

ISO_INLINE vf solid_distance(const iso_dabs *dabs, const iso_local_dab *dab, const vf_vector *p) {
    const float r = dabs->radius_voxels, aspect = r * dabs->aspect;
    if (dabs->solid == ISO_SOLID_SPHERE) return length3(p->x, p->y, p->z) - v_set(r);
    if (dabs->solid == ISO_SOLID_CAPSULE) return capsule_distance(dab, p, r);
    const vf x = dot(p, dab->axis[0]), y = dot(p, dab->axis[1]), z = dot(p, dab->axis[2]);
    if (dabs->solid == ISO_SOLID_BOX)
        return box_distance(v_abs(x) - v_set(r), v_abs(y) - v_set(aspect), v_abs(z) - v_set(aspect));
    const vf ring = v_sqrt(x * x + y * y) - v_set(r);
    if (dabs->solid == ISO_SOLID_CYLINDER)
        return box_distance(ring, v_abs(z) - v_set(aspect), v_set(-INFINITY));
    return v_sqrt(ring * ring + z * z) - v_set(aspect); /* the torus */
}

/* Returns the falloff of a deforming touch at a distance, in voxels, from its centre; 0 beyond the radius. */
ISO_INLINE vf falloff(const iso_dabs *dabs, vf distance) {
    const vf t = distance / v_set(dabs->radius_voxels), zero = v_set(0), one = v_set(1);
    vf w = one;
    if (dabs->falloff == ISO_FALLOFF_SMOOTH) {
        const vf s = one - t * t;
        w = s * s;
    } else if (dabs->falloff == ISO_FALLOFF_LINEAR)
        w = one - t;
    return v_select(v_lt(t, one), w, zero);
}

/* Returns the weight of a deforming touch there: falloff times strength. */
ISO_INLINE vf weight(const iso_dabs *dabs, vf distance) {
    return falloff(dabs, distance) * v_set(dabs->strength);
}

/* Interpolates linearly. Exchanging a with b and t with 1 - t gives the same bits, so that mirrored fields
 * stay mirrored. */
ISO_INLINE vf mix(vf a, vf b, vf t) {
    return a * (v_set(1) - t) + b * t;
}

/* Returns the heights of a picture (0 .. 1) at positions relative to the dab; 0 beside it. */
ISO_INLINE vf height_at(const iso_heights *h, float radius, const iso_local_dab *dab, const vf_vector *p) {
    const float scale = 0.5f * (float)(h->width > h->height ? h->width : h->height) / radius;
    const vf zero = v_set(0), low = v_set(0.5f * (float)(h->width + 1)),
             top = v_set(0.5f * (float)(h->height + 1));
    const vf x = v_min(v_max(low + dot(p, dab->axis[0]) * v_set(scale), zero),
                       v_set((float)h->width + 0.999f)),
             y = v_min(v_max(top - dot(p, dab->axis[1]) * v_set(scale), zero),
                       v_set((float)h->height + 0.999f));
    const vf column = v_to_float(v_trunc(x)), row = v_to_float(v_trunc(y)), across = x - column,
             down = y - row;
    const vi at = v_trunc(row * v_set((float)(h->width + 2)) + column);
    const float *below = h->value + h->width + 2;
    return mix(mix(v_gather(h->value, at), v_gather(h->value + 1, at), across),
               mix(v_gather(below, at), v_gather(below + 1, at), across), down);
}

/* Returns the weight of a dab at positions relative to it. `heights`: there are any (so that loops are
 * compiled apart for brushes without). */
ISO_INLINE vf dab_weight(const iso_dabs *dabs, const iso_local_dab *dab, const vf_vector *p, bool heights) {
    const vf w = weight(dabs, length3(p->x, p->y, p->z));
    return heights ? w * height_at(dabs->heights, dabs->radius_voxels, dab, p) : w;
}

/* Returns the distance to the union of the field f and the solid s. With a blend width, the crease between
 * the two is filleted where f is inside the band. */
ISO_INLINE vf unite(const iso_dabs *dabs, vf f, vf s) {
    const vf plain = v_min(s, f);
    if (!(dabs->blend_voxels > 0)) return plain;
    const vf blend = v_set(dabs->blend_voxels);
    const vf h = v_max(blend - v_abs(f - s), v_set(0)) / blend;
    return v_select(v_lt(v_abs(f), v_set(dabs->band)), plain - h * h * blend * v_set(0.25f), plain);
}

ISO_INLINE vf clamped(vf value, float band) {
    return v_min(v_max(value, v_set(-band)), v_set(band));
}

/* Returns the value of a function of the position at the voxels x of a row. */
ISO_INLINE vf along_row(const float f[4], int row, vf x) {
    const float y = (float)(row % ISO_BRICK), z = (float)(row / ISO_BRICK);
    return v_set(f[0]) * x + v_set(f[1] * y + (f[2] * z + f[3]));
}

/* Returns the squared distance from the voxels x of a row to a side of an outline. */
ISO_INLINE vf side_square(const iso_local_side *side, int row, vf x) {
    const vf plane = along_row(side->plane, row, x), zero = v_set(0),
             beyond = v_max(
                 zero - v_min(along_row(side->limit[0], row, x), along_row(side->limit[1], row, x)), zero);
    return plane * plane + beyond * beyond;
}

/* Returns the voxels x of a row, as bits, from which a line to the right of the viewer's picture crosses a
 * side. */
ISO_INLINE uint32_t crossings(const iso_local_side *side, int row, vf x) {
    const vf zero = v_set(0);
    const uint32_t first = v_mask(v_lt(zero, along_row(side->level[0], row, x))),
                   second = v_mask(v_lt(zero, along_row(side->level[1], row, x))),
                   left = v_mask(v_lt(zero, along_row(side->plane, row, x)));
    return (first ^ second) & (side->rises ? left : ~left);
}

/* Computes for all voxels of a brick the signed distance to what an outline removes. */
static void outline_distances(const iso_outline *outline, const int brick[3], float *out) {
    iso_local_outline local;
    iso_outline_localize(outline, brick, &local);
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int first = 0; first < ISO_BRICK; first += ISO_LANES) {
            const vf x = v_to_float(v_lanes() + v_seti(first)), zero = v_set(0);
            vf least = v_set(INFINITY);
            uint32_t within = local.within ? ~0u : 0;
            for (int i = 0; i < local.count && !local.plane; i++) {
                const iso_local_side *side = &local.side[i];
                if (side->near) least = v_min(least, side_square(side, row, x));
                if (side->crossed) within ^= crossings(side, row, x);
            }
            if (local.pyramid) within &= v_mask(v_lt(zero, along_row(local.depth, row, x)));
            const vf distance = v_sqrt(least);
            v_store(out + row * ISO_BRICK + first,
                    local.plane ? along_row(local.side[0].plane, row, x)
                                : v_select(v_from_mask(local.inverted ? ~within : within), zero - distance,
                                           distance));
        }
}

static void edit_solid(const iso_dabs *dabs, const int brick[3], const iso_local_dabs *local,
                       const iso_stencil *phi, float *out) {
    float distances[ISO_BRICK_VOXELS]; /* of solids that are not made of formulas */
    const bool made = dabs->outline || dabs->solid == ISO_SOLID_STAMP;
    if (dabs->outline)
        outline_distances(dabs->outline, brick, distances);
    else if (made)
        stamp_distances(dabs, local, distances);
    const int solids = made ? 0 : local->count;
    const bool carve = dabs->tool == ISO_TOOL_CARVE || dabs->tool == ISO_TOOL_BLEND_CARVE;
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            vf s = made ? v_load(distances + row * ISO_BRICK + x) : v_set(INFINITY);
            for (int i = 0; i < solids; i++) {
                const vf_vector p = position_from_dab(&local->dab[i], row, x);
                s = v_min(s, solid_distance(dabs, &local->dab[i], &p));
            }
            const vf f = v_load(phi->self + row * ISO_BRICK + x), zero = v_set(0);
            const vf united = carve ? zero - unite(dabs, zero - f, s) : unite(dabs, f, s);
            v_store(out + row * ISO_BRICK + x, clamped(united, dabs->band));
        }
}

/* Adds up what the mirror images of a touch do, in pairs of images, so that their order does not change the
 * rounded sum. */
ISO_INLINE vf sum_mirrored(const iso_local_dabs *local, const vf part[ISO_MIRRORED_MAX]) {
    vf sum[ISO_MIRRORED_MAX];
    if (local->count == 1) return part[0] + v_set(0);
    for (int i = 0; i < ISO_MIRRORED_MAX; i++) sum[i] = v_set(0);
    for (int i = 0; i < local->count; i++) sum[local->dab[i].number] = part[i];
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

/* Rounds to 2^-16 voxel. Sums with voxel indices, and of what radial images do, are then exact, so that the
 * order of images does not change them. */
ISO_INLINE vf snap(vf shift) {
    return v_to_float(v_trunc(shift * v_set(65536))) * v_set(1.0f / 65536);
}

/* The weights of the radial images of a touch at some voxels. */
typedef struct weights {
    vf sum, most;
} weights;

ISO_INLINE weights no_weights(void) {
    return (weights){v_set(0), v_set(0)};
}

ISO_INLINE void add_weight(weights *all, vf weight) {
    const vf snapped = snap(weight);
    all->sum += snapped;
    all->most = v_max(all->most, snapped);
}

/* The factor by which the sum of what the images do becomes their mean by weight, times the largest weight.
 */
ISO_INLINE vf factor_of(const weights *all) {
    return all->most / v_max(all->sum, v_set(1.0f / 65536));
}

/* Returns by how much INFLATE, DEFLATE or FLATTEN to CLAY change voxels with the values f, in voxels, with
 * the weight w. p: their positions relative to the dab. */
ISO_INLINE vf distance_change(const iso_dabs *dabs, const iso_local_dab *dab, const vf_vector *p, vf w,
                              vf f) {
    if (dabs->tool == ISO_TOOL_INFLATE) return v_set(0) - w;
    if (dabs->tool == ISO_TOOL_DEFLATE) return w;
    const vf plane = clamped(dot(p, dab->axis[2]) - v_set(dab->plane), dabs->band), zero = v_set(0);
    const vf change = w * (plane - f);
    if (dabs->tool == ISO_TOOL_FLATTEN) return change;
    return dabs->tool == ISO_TOOL_SCRAPE ? v_max(change, zero) : v_min(change, zero); /* FILL and CLAY add */
}

ISO_INLINE vf dab_change(const iso_dabs *dabs, const iso_local_dab *dab, int row, int x, bool heights, vf f) {
    const vf_vector p = position_from_dab(dab, row, x);
    return distance_change(dabs, dab, &p, dab_weight(dabs, dab, &p, heights), f);
}

ISO_INLINE vf mirrored_change(const iso_dabs *dabs, const iso_local_dabs *local, int row, int x, bool heights,
                              vf f) {
    vf part[ISO_MIRRORED_MAX];
    if (local->count == 1) return dab_change(dabs, &local->dab[0], row, x, heights, f) + v_set(0);
    for (int i = 0; i < local->count; i++) part[i] = dab_change(dabs, &local->dab[i], row, x, heights, f);
    return sum_mirrored(local, part);
}

ISO_INLINE vf averaged_change(const iso_dabs *dabs, const iso_local_dabs *local, int row, int x, bool heights,
                              vf f) {
    weights all = no_weights();
    vf sum = v_set(0);
    for (int i = 0; i < local->count; i++) {
        const vf_vector p = position_from_dab(&local->dab[i], row, x);
        const vf w = dab_weight(dabs, &local->dab[i], &p, heights);
        sum += snap(distance_change(dabs, &local->dab[i], &p, w, f));
        add_weight(&all, w);
    }
    return sum * factor_of(&all);
}

ISO_INLINE void offset_rows(const iso_dabs *dabs, const iso_local_dabs *local, const iso_stencil *phi,
                            float *out, bool averaged, bool heights) {
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const vf f = v_load(phi->self + row * ISO_BRICK + x);
            const vf change = averaged ? averaged_change(dabs, local, row, x, heights, f)
                                       : mirrored_change(dabs, local, row, x, heights, f);
            const vf made = clamped(f + change, dabs->band);
            v_store(out + row * ISO_BRICK + x, v_select(v_lt(v_abs(f), v_set(dabs->band)), made, f));
        }
}

static void edit_offset(const iso_dabs *dabs, const iso_local_dabs *local, const iso_stencil *phi,
                        float *out) {
    if (!dabs->averaged && !dabs->heights)
        offset_rows(dabs, local, phi, out, false, false);
    else
        offset_rows(dabs, local, phi, out, dabs->averaged, dabs->heights != NULL);
}

/* Returns by how much the mean of the six face neighbours exceeds a voxel's value (a sixth of the Laplacian).
 * Returns 0 unless all seven values are distances inside the band. */
ISO_INLINE vf mean_excess(const iso_stencil *phi, int row, int x, float band) {
    const row_site site = site_of(phi, row, x);
    const voxel_faces f = faces_of(&site);
    vf sum = v_set(-6) * f.self, most = v_abs(f.self);
    for (int axis = 0; axis < 3; axis++) {
        sum += f.low[axis] + f.high[axis];
        most = v_max(most, v_max(v_abs(f.low[axis]), v_abs(f.high[axis])));
    }
    return v_select(v_lt(most, v_set(band)), sum * v_set(1.0f / 6), v_set(0));
}

ISO_INLINE void smooth_rows(const iso_dabs *dabs, const iso_local_dabs *local, const iso_stencil *phi,
                            float *out, bool heights) {
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            vf w = v_set(0);
            for (int i = 0; i < local->count; i++) {
                const vf_vector p = position_from_dab(&local->dab[i], row, x);
                w = v_max(w, dab_weight(dabs, &local->dab[i], &p, heights));
            }
            const vf f = v_load(phi->self + row * ISO_BRICK + x);
            v_store(out + row * ISO_BRICK + x, f + w * mean_excess(phi, row, x, dabs->band));
        }
}

static void edit_smooth(const iso_dabs *dabs, const iso_local_dabs *local, const iso_stencil *phi,
                        float *out) {
    if (dabs->heights)
        smooth_rows(dabs, local, phi, out, true);
    else
        smooth_rows(dabs, local, phi, out, false);
}

static void edit(const iso_dabs *dabs, const int brick[3], const iso_stencil *phi, float *out) {
    iso_local_dabs local;
    make_local_dabs(dabs, brick, &local);
    if (iso_tool_is_set_operation(dabs->tool))
        edit_solid(dabs, brick, &local, phi, out);
    else if (dabs->tool == ISO_TOOL_SMOOTH)
        edit_smooth(dabs, &local, phi, out);
    else
        edit_offset(dabs, &local, phi, out);
}

/* ---- warps */

/* The displacements of ISO_LANES voxels by the dabs of a touch: of mirror images each one's, of radial images
 * their sum and weights. */
typedef struct ex_shifts {
    vf x[ISO_MIRRORED_MAX], y[ISO_MIRRORED_MAX], z[ISO_MIRRORED_MAX];
    weights all;
} ex_shifts;

ISO_INLINE void begin_shifts(const iso_dabs *dabs, ex_shifts *s) {
    if (dabs->averaged) s->x[0] = s->y[0] = s->z[0] = v_set(0);
    s->all = no_weights();
}

/* Adds the displacement (x, y, z) by dab `i`, which acts with the weight w. */
ISO_INLINE void add_shift(const iso_dabs *dabs, ex_shifts *s, int i, vf w, const vf_vector *shift) {
    if (!dabs->averaged) {
        s->x[i] = shift->x;
        s->y[i] = shift->y;
        s->z[i] = shift->z;
        return;
    }
    s->x[0] += snap(shift->x);
    s->y[0] += snap(shift->y);
    s->z[0] += snap(shift->z);
    add_weight(&s->all, w);
}

ISO_INLINE vf_vector sum_shifts(const iso_dabs *dabs, const iso_local_dabs *local, const ex_shifts *s) {
    vf_vector p;
    if (dabs->averaged) {
        const vf factor = factor_of(&s->all);
        p.x = s->x[0] * factor;
        p.y = s->y[0] * factor;
        p.z = s->z[0] * factor;
        return p;
    }
    p.x = sum_mirrored(local, s->x);
    p.y = sum_mirrored(local, s->y);
    p.z = sum_mirrored(local, s->z);
    return p;
}

/* PINCH and CREASE: returns the displacement to the position at which a voxel's new value is sampled. The
 * position lies farther from the axis of the dab than the voxel, so that the surface moves towards the axis;
 * for CREASE it also lies farther along the axis, so that the surface moves against its normal, in a narrower
 * groove. */
ISO_INLINE vf_vector pinch(const iso_dabs *dabs, const iso_local_dabs *local, int row, int x) {
    ex_shifts s;
    begin_shifts(dabs, &s);
    for (int i = 0; i < local->count; i++) {
        const vf_vector p = position_from_dab(&local->dab[i], row, x);
        const float *axis = local->dab[i].axis[2];
        const vf at = falloff(dabs, length3(p.x, p.y, p.z)), n = dot(&p, axis);
        const vf w = at * v_set(dabs->strength), groove = at * at * v_set(dabs->depth);
        const vf_vector shift = {w * (p.x - n * v_set(axis[0])) + groove * v_set(axis[0]),
                                 w * (p.y - n * v_set(axis[1])) + groove * v_set(axis[1]),
                                 w * (p.z - n * v_set(axis[2])) + groove * v_set(axis[2])};
        add_shift(dabs, &s, i, at, &shift);
    }
    return sum_shifts(dabs, local, &s);
}

/* MOVE and SNAKE_HOOK: returns the displacement to the position at which a voxel's new value is sampled.
 * The surface is moved by a flow: a velocity field whose centre moves from the stroke's first sample
 * (SNAKE_HOOK: from the previous sample) to the current one. The voxel is followed back along the flow in
 * steps of an eighth of the radius, so that the warp never folds. */
ISO_INLINE vf_vector trace_back(const iso_dabs *dabs, const iso_local_dabs *local, int steps, int row,
                                int x) {
    vf_vector shift = {v_set(0), v_set(0), v_set(0)};
    const float part = 1 / (float)steps;
    for (int k = 0; k < steps; k++) {
        ex_shifts s;
        begin_shifts(dabs, &s);
        for (int i = 0; i < local->count; i++) {
            const float *path = local->dab[i].segment;
            const float back =
                ((float)k + 0.5f) * part; /* 0: centre at the current sample, 1: at the first */
            const vf_vector p = position_from_dab(&local->dab[i], row, x);
            const vf all = weight(dabs, length3(p.x + shift.x - v_set(back * path[0]),
                                                p.y + shift.y - v_set(back * path[1]),
                                                p.z + shift.z - v_set(back * path[2]))),
                     w = v_set(part) * all;
            const vf_vector step = {w * v_set(path[0]), w * v_set(path[1]), w * v_set(path[2])};
            add_shift(dabs, &s, i, all, &step);
        }
        const vf_vector sum = sum_shifts(dabs, local, &s);
        shift.x += sum.x;
        shift.y += sum.y;
        shift.z += sum.z;
    }
    return shift;
}

static bool warp(const iso_dabs *dabs, const int brick[3], iso_warp *warp) {
    iso_local_dabs local;
    make_local_dabs(dabs, brick, &local);
    const int steps = iso_dabs_steps(dabs);
    uint32_t moved = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const vf_vector shift = iso_tool_is_drag(dabs->tool) ? trace_back(dabs, &local, steps, row, x)
                                                                 : pinch(dabs, &local, row, x);
            const vf length = v_abs(shift.x) + v_abs(shift.y) + v_abs(shift.z);
            moved |= v_mask(v_lt(v_set(0), length));
            const int at = row * ISO_BRICK + x;
            v_store(warp->position[0] + at, v_to_float(v_lanes() + v_seti(x)) + snap(shift.x));
            v_store(warp->position[1] + at, v_set((float)(row % ISO_BRICK)) + snap(shift.y));
            v_store(warp->position[2] + at, v_set((float)(row / ISO_BRICK)) + snap(shift.z));
        }
    return moved != 0;
}

static void sample(const iso_warp *warp, const iso_field_window *window, float *out) {
    const int step_y = window->size[0], step_z = window->size[0] * window->size[1];
    for (int at = 0; at < ISO_BRICK_VOXELS; at += ISO_LANES) {
        vi index = v_seti(0);
        vf part[3];
        for (int axis = 0; axis < 3; axis++) {
            const vf p = v_load(warp->position[axis] + at) - v_set((float)window->lo[axis]);
            const vi whole = v_floor(p);
            part[axis] = p - v_to_float(whole);
            index += whole * v_seti(axis == 0 ? 1 : axis == 1 ? step_y : step_z);
        }
        vf row[4];
        for (int i = 0; i < 4; i++) {
            const float *from = window->values + (i & 1) * step_y + (i >> 1) * step_z;
            row[i] = mix(v_gather(from, index), v_gather(from + 1, index), part[0]);
        }
        v_store(out + at, mix(mix(row[0], row[1], part[1]), mix(row[2], row[3], part[1]), part[2]));
    }
}

static bool find_changes(const float *before, const iso_voxel_bits *masked, float *values,
                         iso_voxel_bits *changed) {
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint32_t bits = 0;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const int at = row * ISO_BRICK + x;
            const vf old = v_load(before + at), made = v_load(values + at);
            const uint32_t kept = masked ? (uint32_t)masked->row[row] >> x : 0;
            if (masked) v_store(values + at, v_select(v_from_mask(kept), old, made));
            const vm same = v_eqi(v_bits(old), v_bits(made));
            bits |= (~(v_mask(same) | kept) & ((1u << ISO_LANES) - 1)) << x;
        }
        changed->row[row] = (uint16_t)bits;
        any |= bits;
    }
    return any != 0;
}

static void find_band(const float *values, float band, iso_voxel_bits *inside) {
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint32_t bits = 0;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES)
            bits |= v_mask(v_lt(v_abs(v_load(values + row * ISO_BRICK + x)), v_set(band))) << x;
        inside->row[row] = (uint16_t)bits;
    }
}

ISO_INLINE vi load_colors(const uint32_t *colors, int at) {
    return colors ? v_loadi((const int32_t *)colors + at) : v_seti(0);
}

static void set_colors(const uint32_t *from, const iso_voxel_bits *inside, const iso_voxel_bits *set,
                       uint32_t color, uint32_t *out) {
    const vi own = v_seti((int32_t)color);
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const int at = row * ISO_BRICK + x;
            const vi made = v_selecti(v_from_mask((uint32_t)set->row[row] >> x), own, load_colors(from, at));
            v_storei((int32_t *)out + at,
                     v_selecti(v_from_mask((uint32_t)inside->row[row] >> x), made, v_seti(0)));
        }
}

static bool find_recolored(const uint32_t *before, const uint32_t *colors, iso_voxel_bits *changed) {
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint32_t bits = 0;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const int at = row * ISO_BRICK + x;
            const vm same = v_eqi(load_colors(before, at), load_colors(colors, at));
            bits |= (~v_mask(same) & ((1u << ISO_LANES) - 1)) << x;
        }
        changed->row[row] = (uint16_t)bits;
        any |= bits;
    }
    return any != 0;
}

const iso_dab_kernel ISO_KERNEL_NAME(iso_dab_kernel) = {edit,      warp,       sample,        find_changes,
                                                        find_band, set_colors, find_recolored};
