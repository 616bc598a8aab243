/* disc_simd: second-order discs: how a vector of points becomes discs, and where rays hit discs. The method
 * is described in discs.h. Part of the kernel of discs.
 *
 * In this file d is the direction of a ray, (x, y, 1), n a disc's normal, S its shape operator as xx, xy,
 * xz, yy, yz, zz, and q a position relative to a disc's centre. `curved` (the discs have curvature, not flat)
 * is a constant for the compiler. */
#ifndef ISO_RENDER_DISCS_DISC_SIMD_H
#define ISO_RENDER_DISCS_DISC_SIMD_H

#include <assert.h>
#include <string.h>

#include "base/point_code_simd.h"
#include "base/simd.h"
#include "render/discs/discs_numbers.h"
#include "render/discs/kernel.h"

/* Before loops over the values of a disc or over sums: unrolled, these stay in registers. Compilers do not
 * unroll so many iterations by themselves. */
#define ISO_UNROLL _Pragma("GCC unroll 32")

/* The pixels that a disc may cover: those of columns box[0] .. box[2] and rows box[1] .. box[3] of the view
 * that lie in a circle. Pixel (i, j) has its centre at (i, j). */
typedef struct rf_cover {
    int32_t box[4];
    float x, y, radius; /* the circle */
} rf_cover;

/* Sets span[0] .. span[1] to the columns that the disc may cover in rows first .. last; false: none. `whole`:
 * all columns of the box. */
static inline bool cover_columns(const rf_cover *cover, int first, int last, bool whole, int span[2]) {
    span[0] = cover->box[0];
    span[1] = cover->box[2];
    if (whole) return true;
    const float above = (float)first - cover->y, below = cover->y - (float)last;
    const float off = above > 0 ? above : below > 0 ? below : 0;
    const float square = cover->radius * cover->radius - off * off;
    if (!(square >= 0)) return false;
    const float half = sqrtf(square);
    const float lo = cover->x - half, hi = cover->x + half;
    if (lo > (float)span[0]) span[0] = (int)lo;
    if (hi < (float)span[1]) span[1] = (int)hi;
    return span[0] <= span[1];
}

/* ISO_LANES points as read from memory. */
typedef struct rf_lanes {
    int32_t word[2][ISO_LANES];                   /* packed points: low and high half */
    float at[3][ISO_LANES], normal[3][ISO_LANES]; /* surfels */
    int32_t curvature[2][ISO_LANES];              /* iso_curvature: low and high half */
    float radius[ISO_LANES];                      /* when points have radii of their own */
    float color[3][ISO_LANES];                    /* when they have colours */
} rf_lanes;

typedef struct rf_points {
    vf at[3];         /* positions in steps from the block's first step */
    vf corner[3];     /* the block's first step in view space, mm */
    vf voxel[3];      /* and in index coordinates */
    vf radius;        /* of the points, mm */
    float scale;      /* of the shared radius */
    bool near_border; /* their discs may reach the grid's border */
    vm live;          /* lanes with a point */
} rf_points;

typedef struct rf_disc {
    vf value[ISO_DISC_VALUES];
    vm live;    /* lanes with a disc that may be visible */
    vm clipped; /* discs that their boxes or bodies (params->cut) may clip */
} rf_disc;

/* ---- reading points */

/* Reads point i of a block, without its curvature, into a lane. */
ISO_INLINE void read_point(const iso_discs_params *params, const iso_point_block *block, uint32_t i, int lane,
                           rf_lanes *to) {
    const iso_point_view *points = params->points;
    const size_t at = block->first + i;
    if (points->packed) {
        const uint64_t bits = points->packed[at].bits;
        to->word[0][lane] = (int32_t)(uint32_t)bits;
        to->word[1][lane] = (int32_t)(uint32_t)(bits >> 32);
    } else {
        for (int k = 0; k < 3; k++) {
            to->at[k][lane] = points->surfels[at].position[k];
            to->normal[k][lane] = points->surfels[at].normal[k];
        }
    }
    if (points->radii) to->radius[lane] = points->radii[at];
    for (int k = 0; k < 3 && params->colored; k++) to->color[k][lane] = points->colors[at][k];
}

/* Reads the curvatures of up to ISO_LANES points of a block from `i` on. */
ISO_INLINE void read_curvatures(const iso_discs_params *params, const iso_point_block *block, uint32_t i,
                                rf_lanes *to) {
    const iso_curvature *from = params->points->curvatures + block->first + i;
    const uint32_t left = block->count - i, count = left < ISO_LANES ? left : ISO_LANES;
    float curvature[2 * ISO_LANES];
    if (count < ISO_LANES) {
        memset(curvature, 0, sizeof curvature);
        memcpy(curvature, from, count * sizeof *from);
        from = (const iso_curvature *)curvature;
    }
    const vf first = v_load((const float *)from), second = v_load((const float *)from + ISO_LANES);
    v_storei(to->curvature[0], v_bits(v_even(first, second)));
    v_storei(to->curvature[1], v_bits(v_odd(first, second)));
}

/* Reads up to ISO_LANES points of a block from `i` on; returns the lanes that have one. */
ISO_INLINE vm read_points(const iso_discs_params *params, const iso_point_block *block, uint32_t i,
                          rf_lanes *to) {
    const uint32_t left = block->count - i, count = left < ISO_LANES ? left : ISO_LANES;
    if (count == ISO_LANES && params->points->packed && !params->colored) {
        const float *from = (const float *)(params->points->packed + block->first + i);
        const vf first = v_load(from), second = v_load(from + ISO_LANES);
        v_storei(to->word[0], v_bits(v_even(first, second)));
        v_storei(to->word[1], v_bits(v_odd(first, second)));
        for (uint32_t lane = 0; lane < ISO_LANES && params->points->radii; lane++)
            to->radius[lane] = params->points->radii[block->first + i + lane];
    } else {
        if (count < ISO_LANES) memset(to, 0, sizeof *to);
        for (uint32_t lane = 0; lane < count; lane++) read_point(params, block, i + lane, (int)lane, to);
    }
    return v_lti(v_lanes(), v_seti((int32_t)count));
}

/* Decodes positions and radii. */
ISO_INLINE void decode_positions(const iso_discs_params *params, const rf_lanes *lanes, rf_points *out) {
    if (params->points->packed) {
        unpack_points(v_loadi(lanes->word[0]), v_loadi(lanes->word[1]), out->at);
    } else {
        for (int k = 0; k < 3; k++) out->at[k] = v_load(lanes->at[k]);
    }
    out->radius = params->points->radii ? v_max(v_load(lanes->radius) * v_set(params->radii_scale), v_set(0))
                                        : v_set(params->radius * out->scale);
}

/* Decodes unit normals in index space; false where a point's normal is zero or not finite. */
ISO_INLINE vm decode_normals(const iso_discs_params *params, const rf_lanes *lanes, vf normal[3]) {
    if (params->points->packed) {
        unfold_normals(v_loadi(lanes->word[1]) >> ISO_POINT_NORMAL_BIT, normal);
    } else {
        for (int k = 0; k < 3; k++) normal[k] = v_load(lanes->normal[k]);
    }
    const vf square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    const vm there = v_and(v_lt(v_set(1e-20f), square), v_lt(square, v_set(1e20f)));
    const vf per_length = 1 / v_sqrt(v_select(there, square, v_set(1)));
    for (int k = 0; k < 3; k++) normal[k] = v_select(there, normal[k], v_set(k == 2)) * per_length;
    return there;
}

/* ---- projection */

/* Sets the centres of discs in view space and in the picture, their radii and scales. Points nearer than
 * the near plane are no longer live. */
ISO_INLINE void project_centres(const iso_discs_params *params, const iso_point_block *block,
                                const bool filtered, const rf_points *points, rf_disc *out) {
    vf *const to = out->value;
    for (int k = 0; k < 3; k++) {
        const float *m = params->step + 3 * k;
        to[ISO_DISC_X + k] =
            m[0] * points->at[0] + m[1] * points->at[1] + m[2] * points->at[2] + points->corner[k];
    }
    out->live = v_and(points->live, v_le(v_set(params->near), to[ISO_DISC_Z]));
    to[ISO_DISC_Z] = v_select(out->live, to[ISO_DISC_Z], v_set(1));
    const vf scale = params->orthographic ? v_set(params->focal) : params->focal / to[ISO_DISC_Z],
             most = v_set(1 << 24);
    for (int k = 0; k < 2; k++)
        to[ISO_DISC_COLUMN + k] = v_max(v_min(to[ISO_DISC_X + k] * scale + params->axis[k], most), -most);
    vf reach = v_set(params->ball[0]);
    if (block->radius[1] > params->grow_from) { /* conservative: discs are larger than their points */
        const vf wide = (points->radius * scale - params->grow_from) * params->grow;
        reach += v_max(v_min(wide, v_set(1)), v_set(0)) * params->ball[1];
    }
    to[ISO_DISC_SCALE] = scale;
    to[ISO_DISC_PIXEL] = params->orthographic ? v_set(1 / params->focal) : to[ISO_DISC_Z] * params->slope;
    to[ISO_DISC_RADIUS] = points->radius * reach;
    to[ISO_DISC_PIXELS] = v_min(to[ISO_DISC_RADIUS] * scale * params->slant, most);
    const float low_pass = ISO_DISCS_LOW_PASS;
    if (filtered)
        to[ISO_DISC_PIXELS] = v_sqrt(to[ISO_DISC_PIXELS] * to[ISO_DISC_PIXELS] + low_pass * low_pass);
}

/* The live discs whose circles overlap columns lo[0] .. hi[0] and rows lo[1] .. hi[1] of the whole picture.
 * `tiny`: circles may lie between pixels' centres; such discs are left out. */
ISO_INLINE vm overlaps(const rf_disc *disc, const int lo[2], const int hi[2], const bool tiny) {
    vm live = disc->live;
    const vf reach = disc->value[ISO_DISC_PIXELS];
    vf square = v_set(0);
    for (int k = 0; k < 2; k++) {
        const vf at = disc->value[ISO_DISC_COLUMN + k] - 0.5f;
        live =
            v_and(live, v_and(v_le(v_set((float)lo[k]), at + reach), v_le(at - reach, v_set((float)hi[k]))));
        if (!tiny) continue;
        const vf off = v_to_float(v_floor(at + 0.5f)) - at;
        square += off * off;
    }
    return tiny ? v_and(live, v_le(square, reach * reach)) : live;
}

/* Returns x (axis 0) or y (axis 1) of the direction of the ray through column or row `pixel` of the whole
 * picture. */
ISO_INLINE vf ray_slope(const iso_discs_params *params, int axis, vf pixel) {
    return (pixel - params->axis[axis]) * params->slope;
}

/* Transforms normals and tangents from index to view space. */
ISO_INLINE void transform_vectors(const iso_discs_params *params, const vf from[3], vf to[3]) {
    const float *m = params->normal;
    for (int k = 0; k < 3; k++) to[k] = m[3 * k] * from[0] + m[3 * k + 1] * from[1] + m[3 * k + 2] * from[2];
}

/* a.Mb with the matrix M of params->metric, whose entries off the diagonal are stored doubled. */
ISO_INLINE vf metric_product(const iso_discs_params *params, const vf a[3], const vf b[3]) {
    const float *m = params->metric;
    return a[0] * (m[0] * b[0] + 0.5f * m[1] * b[1] + 0.5f * m[2] * b[2]) +
           a[1] * (0.5f * m[1] * b[0] + m[3] * b[1] + 0.5f * m[4] * b[2]) +
           a[2] * (0.5f * m[2] * b[0] + 0.5f * m[4] * b[1] + m[5] * b[2]);
}

/* Adds the entries xx xy xz yy yz zz of the outer product of two vectors. */
ISO_INLINE void add_product(const vf a[3], const vf b[3], vf *to) {
    int i = 0;
    for (int r = 0; r < 3; r++)
        for (int c = r; c < 3; c++) to[i++] += a[r] * b[c];
}

/* Computes S d. */
ISO_INLINE void apply_operator(const vf *s, const vf d[3], vf out[3]) {
    out[0] = s[0] * d[0] + s[1] * d[1] + s[2] * d[2];
    out[1] = s[1] * d[0] + s[3] * d[1] + s[4] * d[2];
    out[2] = s[2] * d[0] + s[4] * d[1] + s[5] * d[2];
}

/* Returns the squared Frobenius norm of S. */
ISO_INLINE vf squared_norm(const vf *s) {
    return s[0] * s[0] + s[3] * s[3] + s[5] * s[5] + 2 * (s[1] * s[1] + s[2] * s[2] + s[4] * s[4]);
}

/* The 16-bit entries uu, uv and vv of iso_curvature; their low bits store the tilt. */
ISO_INLINE void unpack_entries(const rf_lanes *lanes, vi entry[3]) {
    const vi low = v_loadi(lanes->curvature[0]), high = v_loadi(lanes->curvature[1]);
    entry[0] = low << 16 >> 16;
    entry[1] = low >> 16;
    entry[2] = high << 16 >> 16;
}

/* The field `extents` of iso_curvature. */
ISO_INLINE vi unpack_extents(const rf_lanes *lanes) {
    return v_loadi(lanes->curvature[1]) >> 16 & 0xffff;
}

/* Computes S in view space, with the curvature along the normal (discs.h), from the entries uu, uv, vv.
 * `normal` is unit; `uu` and `vv` are the tangents u and v transformed to view space, not unit. */
ISO_INLINE void make_shape_operators(const vi packed[3], const vf normal[3], const vf uu[3], const vf vv[3],
                                     vf per_length, vf *s) {
    const vf step = per_length * (ISO_CURVATURE_STEP * (1 << ISO_CURVATURE_LOW_BITS));
    vf entry[3];
    for (int k = 0; k < 6; k++) s[k] = v_set(0);
    for (int k = 0; k < 3; k++) entry[k] = v_to_float(packed[k] >> ISO_CURVATURE_LOW_BITS) * step;
    vf p[3], r[3];
    for (int k = 0; k < 3; k++) {
        p[k] = entry[0] * uu[k] + entry[1] * vv[k];
        r[k] = entry[1] * uu[k] + entry[2] * vv[k];
    }
    add_product(uu, p, s);
    add_product(vv, r, s);
    const vf trace = s[0] + s[3] + s[5];
    const vf apart = v_sqrt(v_max(2 * squared_norm(s) - trace * trace, v_set(0)));
    const vf most = v_max(trace + apart, v_set(0)) * 0.5f;
    for (int k = 0; k < 3; k++) p[k] = most * normal[k];
    add_product(normal, p, s);
}

/* How a vector of discs is oriented towards the eye. */
typedef struct rf_facing {
    vf normal[3], per_length; /* unit normal in index space; 1 / its length after params->normal */
    vf along, d[2];           /* n.d; direction (d[0], d[1], 1) of the ray to the centre */
    vm back_facing;           /* n.d > 0 */
    vm surely_away;           /* back-facing by so much that curvature does not make the disc visible */
} rf_facing;

/* Compares discs' normals with the rays to their centres. */
ISO_INLINE void compare_with_rays(const vf *disc, rf_facing *out) {
    const vf *const d = out->d;
    out->along = disc[ISO_DISC_NX] * d[0] + disc[ISO_DISC_NY] * d[1] + disc[ISO_DISC_NZ];
    /* just beyond a silhouette, a surface that curves towards the eye can still be seen */
    out->back_facing = v_lt(v_set(0), out->along);
    out->surely_away = v_and(out->back_facing, v_lt((d[0] * d[0] + d[1] * d[1] + 1) * ISO_DISCS_BACK_FACING,
                                                    out->along * out->along));
}

/* Sets the discs' normals. With culling, discs that surely face away are no longer live. */
ISO_INLINE void orient_discs(const iso_discs_params *params, const rf_lanes *lanes, rf_disc *disc,
                             rf_facing *out) {
    vf *const to = disc->value, view[3], *const d = out->d;
    disc->live = v_and(disc->live, decode_normals(params, lanes, out->normal));
    transform_vectors(params, out->normal, view);
    out->per_length = v_set(params->per_length);
    if (!(params->per_length > 0))
        out->per_length = 1 / v_sqrt(view[0] * view[0] + view[1] * view[1] + view[2] * view[2]);
    for (int k = 0; k < 3; k++) to[ISO_DISC_NX + k] = to[ISO_DISC_LIT_X + k] = view[k] * out->per_length;
    for (int k = 0; k < 2; k++) d[k] = ray_slope(params, k, to[ISO_DISC_COLUMN + k]);
    compare_with_rays(to, out);
    if (params->cull) disc->live = v_andnot(disc->live, out->surely_away);
}

/* Adds the tilt of iso_curvature to normals in view space; `axis`: the tangents in view space. */
ISO_INLINE void add_tilt(const vi packed[3], const vf axis[2][3], vf per_length, vf normal[3]) {
    const int low = (1 << ISO_CURVATURE_LOW_BITS) - 1, unused = 32 - ISO_CURVATURE_TILT_BITS;
    const float step = ISO_CURVATURE_TILT_MOST / (float)(ISO_CURVATURE_TILT_STEPS * ISO_CURVATURE_TILT_STEPS);
    vi bits = packed[0] & low;
    for (int k = 1; k < 3; k++) bits |= (packed[k] & low) << (ISO_CURVATURE_LOW_BITS * k);
    for (int k = 0; k < 2; k++) {
        const vf steps = v_to_float(bits << (unused - ISO_CURVATURE_TILT_BITS * k) >> unused);
        const vf size = steps * v_abs(steps) * (step * per_length);
        for (int i = 0; i < 3; i++) normal[i] += size * axis[k][i];
    }
}

/* Applies tilt and shape operator of iso_curvature. */
ISO_INLINE void apply_curvature(const iso_discs_params *params, const rf_lanes *lanes, rf_facing *facing,
                                vf *disc) {
    vi packed[3];
    vf index[2][3], axis[2][3];
    unpack_entries(lanes, packed);
    make_tangents(facing->normal, index[0], index[1]);
    for (int k = 0; k < 2; k++) transform_vectors(params, index[k], axis[k]);
    add_tilt(packed, (const vf(*)[3])axis, facing->per_length, disc + ISO_DISC_NX);
    compare_with_rays(disc, facing);
    make_shape_operators(packed, disc + ISO_DISC_LIT_X, axis[0], axis[1], facing->per_length,
                         disc + ISO_DISC_XX);
    disc[ISO_DISC_SQUARE] = squared_norm(disc + ISO_DISC_XX);
}

/* Computes the ISO_DISC_FLAT values: the intersection of flat discs with rays parallel to d; `along` is
 * n.d. */
ISO_INLINE void set_flat_values(const iso_discs_params *params, const vf d[2], vf along, vf *disc) {
    const vm small = v_le(disc[ISO_DISC_RADIUS], disc[ISO_DISC_Z] * ISO_DISCS_FLAT_EXACT);
    disc[ISO_DISC_FLAT_NEAR] = v_select(small, v_set(0), disc[ISO_DISC_SCALE] * params->slope);
    const vf inverse = 1 / v_max(-along, v_set(1e-6f)), x = disc[ISO_DISC_NX] * inverse,
             y = disc[ISO_DISC_NY] * inverse;
    const vf pixel = disc[ISO_DISC_PIXEL], scale = pixel * pixel * disc[ISO_DISC_INVERSE];
    disc[ISO_DISC_FLAT_X] = x * pixel;
    disc[ISO_DISC_FLAT_Y] = y * pixel;
    /* how the hit moves in the disc's plane, per mm to the right and downwards at the centre's depth */
    const vf u[3] = {1 + x * d[0], x * d[1], x}, v[3] = {y * d[0], 1 + y * d[1], y};
    if (params->anisotropic) {
        disc[ISO_DISC_FLAT_XX] = metric_product(params, u, u) * scale;
        disc[ISO_DISC_FLAT_XY] = metric_product(params, u, v) * (scale + scale);
        disc[ISO_DISC_FLAT_YY] = metric_product(params, v, v) * scale;
    } else {
        disc[ISO_DISC_FLAT_XX] = (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) * scale;
        disc[ISO_DISC_FLAT_XY] = (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) * (scale + scale);
        disc[ISO_DISC_FLAT_YY] = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * scale;
    }
}

/* Convolves the Gaussians of flat discs with that of the low-pass filter: sets the ISO_DISC_SOFT values.
 * `along` is n.d. With weights exp(-2 q), q = x.Cx, the filter is exp(-2 x.x / f), f = LOW_PASS^2. The
 * inverse of C^-1 + f is (C + f det C) / (1 + f trace C + f^2 det C), and the weight falls with the root of
 * the ratio of areas.
 *
 * The root of det C is a pixel's area on the disc's plane in squared radii. Computed from the entries of C,
 * it would be lost in rounding for discs seen edge-on. If voxels are not cubes, that area is a lower bound.
 */
ISO_INLINE void convolve(const iso_discs_params *params, vf along, vf *disc) {
    const float f = ISO_DISCS_LOW_PASS * ISO_DISCS_LOW_PASS;
    const vf xx = disc[ISO_DISC_FLAT_XX], xy = disc[ISO_DISC_FLAT_XY], yy = disc[ISO_DISC_FLAT_YY];
    const vf pixel = disc[ISO_DISC_PIXEL],
             area = pixel * pixel * disc[ISO_DISC_INVERSE] / v_max(v_abs(along), v_set(1e-6f));
    vf det = area * area;
    if (params->anisotropic) det = v_max(xx * yy - 0.25f * (xy * xy), det);
    det *= f;
    const vf scale = 1 / (1 + (xx + yy + det) * f);
    disc[ISO_DISC_SOFT_XX] = (xx + det) * scale;
    disc[ISO_DISC_SOFT_XY] = xy * scale;
    disc[ISO_DISC_SOFT_YY] = (yy + det) * scale;
    disc[ISO_DISC_SHARE] = v_sqrt(scale);
}

/* Sets the remaining values of discs. Back-facing discs are no longer live (params->cull) or are flipped. */
ISO_INLINE void complete_discs(const iso_discs_params *params, const bool curved, const rf_lanes *lanes,
                               rf_facing *facing, rf_disc *disc) {
    vf *const to = disc->value, curve = v_set(0), sd[3] = {curve, curve, curve};
    const vf d[3] = {facing->d[0], facing->d[1], v_set(1)}, near = to[ISO_DISC_SCALE] * params->slope;
    to[ISO_DISC_SIDE] = v_set(1);
    if (curved)
        to[ISO_DISC_RADIUS] *= 1 - v_to_float(unpack_extents(lanes) >> ISO_CURVATURE_SHRINK_BIT) * 0.25f;
    to[ISO_DISC_INVERSE] = 1 / (to[ISO_DISC_RADIUS] * to[ISO_DISC_RADIUS]);
    if (curved) {
        apply_curvature(params, lanes, facing, to);
        apply_operator(to + ISO_DISC_XX, d, sd);
        curve = d[0] * sd[0] + d[1] * sd[1] + sd[2];
        to[ISO_DISC_BX] = to[ISO_DISC_NX] * near + sd[0];
        to[ISO_DISC_BY] = to[ISO_DISC_NY] * near + sd[1];
        to[ISO_DISC_B0] = facing->along;
        to[ISO_DISC_A] = curve;
    } else {
        for (int k = ISO_DISC_XX; k <= ISO_DISC_SQUARE; k++) to[k] = v_set(0);
    }
    const vm flipped = v_andnot(facing->back_facing, v_andnot(v_lt(v_set(0), curve), facing->surely_away));
    if (params->cull) {
        disc->live = v_andnot(disc->live, flipped);
    } else {
        const vf side = v_select(flipped, v_set(-1), v_set(1));
        for (int k = ISO_DISC_NX; k <= ISO_DISC_ZZ; k++) to[k] *= side;
        for (int k = ISO_DISC_B0; curved && k <= ISO_DISC_A; k++) to[k] *= side;
        to[ISO_DISC_SIDE] = side;
    }
    if (!curved) set_flat_values(params, d, -v_abs(facing->along), to);
    if (!curved && params->filtered) convolve(params, facing->along, to);
}

/* ---- boxes that clip discs */

/* Narrows the boxes of edge points at `at` (index coordinates) to the extents of iso_curvature: along the
 * edge as far as the edge reaches, along the other axes as far as the surface continues in the cells
 * beside the edge, each plus ISO_DISCS_BEYOND_END. Only where the surface curves by
 * ISO_DISCS_TURNING_CURVATURE or more. */
ISO_INLINE void apply_extents(const iso_discs_params *params, const rf_lanes *lanes, const vf at[3],
                              vf *disc) {
    const vi extents = unpack_extents(lanes),
             axis = extents >> ISO_CURVATURE_AXIS_BIT & ISO_CURVATURE_AXIS_MASK;
    const float turning = ISO_DISCS_TURNING_CURVATURE * params->voxels_per_mm;
    const vm clipped =
        v_and(v_lti(v_seti(0), extents), v_lt(v_set(turning * turning), disc[ISO_DISC_SQUARE]));
    if (!v_mask(clipped)) return;
    const vf step = v_set(1.0f / ISO_CURVATURE_EXTENT_STEPS);
    vf extent[4];
    for (int k = 0; k < 4; k++)
        extent[k] =
            v_to_float(extents >> (ISO_CURVATURE_EXTENT_BITS * k) & ISO_CURVATURE_EXTENT_STEPS) * step;
    /* sides[k]: how far the disc may reach down and up along index axis k, unless the edge is along k */
    const vm first = v_eqi(axis, v_seti(1));
    const vf middle[2] = {v_select(first, extent[0], extent[2]), v_select(first, extent[1], extent[3])};
    const vf *const sides[3] = {extent, middle, extent + 2};
    for (int k = 0; k < 3; k++) {
        const vm own = v_eqi(axis, v_seti(k + 1));
        /* at a voxel, rounding of packed points may have moved the point to the edge on the other side */
        vf below = at[k] - v_to_float(v_floor(at[k])), above = 1 - below;
        below = v_select(v_lt(below, v_set(ISO_DISCS_AT_VOXEL)), v_set(1), below);
        above = v_select(v_lt(above, v_set(ISO_DISCS_AT_VOXEL)), v_set(1), above);
        const vf low = v_select(own, below, sides[k][0]), high = v_select(own, above, sides[k][1]);
        disc[ISO_DISC_LOW_X + k] = v_select(clipped, -(low + ISO_DISCS_BEYOND_END), disc[ISO_DISC_LOW_X + k]);
        disc[ISO_DISC_HIGH_X + k] = v_select(clipped, high + ISO_DISCS_BEYOND_END, disc[ISO_DISC_HIGH_X + k]);
    }
}

/* Sets the boxes of complete discs: their balls, narrowed by extents and the grid's border. */
ISO_INLINE void set_boxes(const iso_discs_params *params, const bool curved, const rf_lanes *lanes,
                          const rf_points *points, rf_disc *discs) {
    vf *const disc = discs->value, at[3];
    const vf reach = disc[ISO_DISC_RADIUS] * params->voxels_per_mm;
    for (int k = 0; k < 3; k++) {
        at[k] = points->at[k] * params->voxels_per_step + points->voxel[k];
        disc[ISO_DISC_LOW_X + k] = -reach;
        disc[ISO_DISC_HIGH_X + k] = reach;
    }
    if (curved) apply_extents(params, lanes, at, disc);
    discs->clipped = v_lt(reach, reach);
    for (int k = 0; k < 3; k++) {
        vf *const low = &disc[ISO_DISC_LOW_X + k], *const high = &disc[ISO_DISC_HIGH_X + k];
        if (points->near_border) {
            *low = v_max(*low, -at[k]);
            *high = v_min(*high, params->border[k] - at[k]);
        }
        discs->clipped = v_or(discs->clipped, v_or(v_lt(-reach, *low), v_lt(*high, reach)));
    }
}

/* ---- bodies that cut discs */

/* Whether balls around `at` (view space, mm) lie in a body: all of them where `radius` is above 0, some part
 * where it is below 0. */
ISO_INLINE vm in_body(const iso_discs_cut *body, const vf at[3], vf radius) {
    if (!body->faces) {
        const vf x = at[0] - body->centre[0], y = at[1] - body->centre[1], z = at[2] - body->centre[2];
        const vf most = v_max(body->radius - radius, v_set(0));
        return v_lt(x * x + y * y + z * z, most * most);
    }
    vm in = v_eqi(v_seti(0), v_seti(0));
    for (int i = 0; i < body->faces; i++) {
        const float *f = body->face[i];
        in = v_and(in, v_lt(f[0] * at[0] + f[1] * at[1] + f[2] * at[2] + radius, v_set(f[3])));
    }
    return in;
}

/* Leaves out discs that bodies cut away, of `centres` all whose centres they cut away, and marks those that
 * bodies may cut. */
ISO_INLINE void cut_discs(const iso_discs_params *params, const bool centres, rf_disc *discs) {
    const vf *at = discs->value + ISO_DISC_X;
    const vf reach =
        centres ? v_set(0) : discs->value[ISO_DISC_RADIUS] * 1.01f + 4 * discs->value[ISO_DISC_PIXEL];
    for (int i = 0; i < params->cuts; i++) {
        const bool keeps = params->cut[i].keeps;
        const vm all = in_body(&params->cut[i], at, reach), some = in_body(&params->cut[i], at, -reach);
        discs->live = keeps ? v_and(discs->live, some) : v_andnot(discs->live, all);
        discs->clipped = v_or(discs->clipped, v_andnot(some, all));
    }
}

/* ---- rays */

/* Where the ray through a pixel hits a disc. */
typedef struct rf_hit {
    vf q[3]; /* the hit relative to the disc's centre, mm */
    vf far;  /* its squared distance from the centre in squared radii; 1 or more, or NaN: no hit */
} rf_hit;

/* The terms of the intersection that are the same for all pixels of a row: the row's offset y from the
 * disc's centre, mm at its depth; y of the rays' direction; and the coefficients of intersect that
 * do not depend on x. */
typedef struct rf_row {
    vf y, ray, b, c0, c1;
} rf_row;

/* Computes the terms of the row `dy` pixels below the disc's centre. `ray`: y of the direction of the row's
 * rays. */
ISO_INLINE rf_row start_row(const vf *disc, const bool curved, vf dy, vf ray) {
    rf_row row = {.y = dy * disc[ISO_DISC_PIXEL], .ray = ray};
    if (curved) {
        const vf nx = disc[ISO_DISC_NX] + disc[ISO_DISC_NX], ny = disc[ISO_DISC_NY] + disc[ISO_DISC_NY],
                 xy = disc[ISO_DISC_XY] + disc[ISO_DISC_XY];
        row.b = disc[ISO_DISC_B0] + disc[ISO_DISC_BY] * row.y;
        row.c0 = row.y * (ny + disc[ISO_DISC_YY] * row.y);
        row.c1 = nx + xy * row.y;
    } else {
        row.b = disc[ISO_DISC_FLAT_Y] * dy;
        row.c0 = disc[ISO_DISC_FLAT_YY] * dy * dy;
        row.c1 = disc[ISO_DISC_FLAT_XY] * dy;
    }
    return row;
}

/* Measures the distance of a hit with params->metric, where voxels are not cubes. */
ISO_INLINE void measure_in_voxels(const iso_discs_params *params, const vf *disc, rf_hit *hit) {
    const vf square = metric_product(params, hit->q, hit->q);
    hit->far = v_select(v_lt(hit->far, v_set(1)), square * disc[ISO_DISC_INVERSE], hit->far);
}

/* Whether a hit of a disc that is large for its depth lies outside of its ball: where voxels are not cubes,
 * params->metric may be less than the distance in mm. */
ISO_INLINE vm leaves_ball(const vf *disc, const vf q[3]) {
    const vf square = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) * disc[ISO_DISC_INVERSE];
    return v_andnot(v_lt(v_set(0), disc[ISO_DISC_FLAT_NEAR]), v_lt(square, v_set(1)));
}

/* Sets the hit to the position on a ray `depth` mm behind the disc's centre. `at`: the ray's offset from
 * the centre at the centre's depth; `ray`: x and y of its direction. */
ISO_INLINE void hit_at_depth(const iso_discs_params *params, const vf *disc, const vf at[2], const vf ray[2],
                             vf depth, rf_hit *hit) {
    for (int k = 0; k < 2; k++) hit->q[k] = at[k] + depth * ray[k];
    hit->q[2] = depth;
    const vf square = hit->q[0] * hit->q[0] + hit->q[1] * hit->q[1] + depth * depth;
    hit->far = square * disc[ISO_DISC_INVERSE];
    if (params->anisotropic) measure_in_voxels(params, disc, hit);
}

/* Intersects a disc with the ray through the pixel of a row that is `dx` pixels right of the disc's centre:
 * the nearer root of n.q + q.Sq / 2 = 0, for flat discs the root of n.q = 0. Curved discs in `exact` lanes
 * are so near to the eye that each pixel's own ray is used, whose direction has x `ray_x`; for the others
 * rays are taken as parallel. A flat disc at depth z that a parallel ray hits at q is hit by the pixel's own
 * ray at q / (1 - q_z / z).
 *
 * With q = e + t d, where e is the offset of the ray at the centre's depth, the quadric is t^2 A / 2 + t B +
 * C / 2 = 0 with A = d.Sd, B = n.d + e.Sd, C = 2 n.e + e.Se, and the nearer root is t = C / (sqrt(B^2 - A C)
 * - B). */
ISO_INLINE rf_hit intersect(const iso_discs_params *params, const vf *disc, const bool curved,
                            const rf_row *row, vf dx, vf ray_x, vm exact) {
    rf_hit hit;
    const vf at[2] = {dx * disc[ISO_DISC_PIXEL], row->y}, ray[2] = {ray_x, row->ray};
    if (curved) {
        vf a = disc[ISO_DISC_A], b = row->b + disc[ISO_DISC_BX] * at[0];
        if (v_mask(exact)) {
            const vf along = disc[ISO_DISC_NX] * ray[0] + disc[ISO_DISC_NY] * ray[1] + disc[ISO_DISC_NZ];
            vf sd[3];
            apply_operator(disc + ISO_DISC_XX, (const vf[3]){ray[0], ray[1], v_set(1)}, sd);
            a = v_select(exact, ray[0] * sd[0] + ray[1] * sd[1] + sd[2], a);
            b = v_select(exact, along + at[0] * sd[0] + at[1] * sd[1], b);
        }
        const vf c = at[0] * (row->c1 + disc[ISO_DISC_XX] * at[0]) + row->c0;
        hit_at_depth(params, disc, at, ray, c / (v_sqrt(b * b - a * c) - b), &hit);
        return hit;
    }
    const vf depth = dx * disc[ISO_DISC_FLAT_X] + row->b,
             nearer = 1 / v_max(1 - depth * disc[ISO_DISC_FLAT_NEAR], v_set(1e-15f));
    hit.q[2] = depth * nearer;
    for (int k = 0; k < 2; k++) hit.q[k] = at[k] + hit.q[2] * ray[k];
    hit.far = (dx * (row->c1 + disc[ISO_DISC_FLAT_XX] * dx) + row->c0) * (nearer * nearer);
    if (params->anisotropic) hit.far = v_select(leaves_ball(disc, hit.q), v_set(1), hit.far);
    return hit;
}

/* Extends the hits of a flat disc to those of the disc convolved with the low-pass filter: `far` becomes
 * the distance in the latter. Returns the hits that cover their pixels. (dx, dy): pixels from the disc's
 * centre. The plane of a disc seen edge-on is hit anywhere: the depth is bounded. */
ISO_INLINE vm filter_hits(const iso_discs_params *params, const vf *disc, vf dx, vf dy, rf_hit *hit) {
    const vf most = disc[ISO_DISC_RADIUS] + disc[ISO_DISC_PIXEL] * ISO_DISCS_LOW_PASS_DEPTH,
             far = dx * (disc[ISO_DISC_SOFT_XX] * dx + disc[ISO_DISC_SOFT_XY] * dy) +
                   disc[ISO_DISC_SOFT_YY] * dy * dy;
    const vm covers = v_lt(params->widened ? far : hit->far, v_set(1));
    hit->far = far;
    hit->q[2] = v_max(v_min(hit->q[2], most), -most);
    return covers;
}

/* Removes hits outside the disc's box. */
ISO_INLINE void clip_to_boxes(const iso_discs_params *params, const vf *disc, rf_hit *hit) {
    const float *m = params->normal; /* the inverse of index to view space, transposed */
    for (int k = 0; k < 3; k++) {
        const vf at = m[k] * hit->q[0] + m[3 + k] * hit->q[1] + m[6 + k] * hit->q[2];
        const vm outside = v_or(v_lt(at, disc[ISO_DISC_LOW_X + k]), v_lt(disc[ISO_DISC_HIGH_X + k], at));
        hit->far = v_select(outside, v_set(1), hit->far);
    }
}

/* Removes hits that bodies cut away. */
ISO_INLINE void cut_hits(const iso_discs_params *params, const vf *disc, rf_hit *hit) {
    vf at[3];
    for (int k = 0; k < 3; k++) at[k] = disc[ISO_DISC_X + k] + hit->q[k];
    for (int i = 0; i < params->cuts; i++) {
        const vm in = in_body(&params->cut[i], at, v_set(0));
        hit->far = params->cut[i].keeps ? v_select(in, hit->far, v_set(1)) : v_select(in, v_set(1), hit->far);
    }
}

/* exp(-2 q) for q in 0 .. 1, within 0.0025. */
ISO_INLINE vf gaussian(vf q) {
    return 1 + q * (ISO_DISCS_GAUSS_1 + q * (ISO_DISCS_GAUSS_2 + q * ISO_DISCS_GAUSS_3));
}

#endif
