/* curvature_kernel: shape operators from derivatives, the fit of the quadric, and the extents and sizes of
 * discs. The method is described in curvature.h. */
#include "extract/points/curvature_kernel.h"

#include "base/point_code_simd.h"
#include "base/simd.h"

/* Gradient and Hessian at a voxel, along the axes a, b, c; the Hessian's entries are aa bb cc ab ac bc. */
typedef struct cv_derivatives {
    vf g[3], h[6];
} cv_derivatives;

ISO_INLINE vf value(const iso_curvature_batch *batch, int which, uint32_t i, const bool floats) {
    vi bits = v_loadi(batch->value[which] + i);
    return floats ? v_floats(bits) : v_to_float(bits);
}

/* For each end of an edge: where the values around this end are in the batch, in the order of the values
 * around HERE. */
static const uint8_t voxel_offsets[2][ISO_CURVATURE_VOXEL] = {
    {ISO_CURVATURE_HERE, ISO_CURVATURE_A0, ISO_CURVATURE_A1, ISO_CURVATURE_B0, ISO_CURVATURE_B1,
     ISO_CURVATURE_C0, ISO_CURVATURE_C1, ISO_CURVATURE_A0B0, ISO_CURVATURE_A1B0, ISO_CURVATURE_A0B1,
     ISO_CURVATURE_A1B1, ISO_CURVATURE_A0C0, ISO_CURVATURE_A1C0, ISO_CURVATURE_A0C1, ISO_CURVATURE_A1C1,
     ISO_CURVATURE_B0C0, ISO_CURVATURE_B1C0, ISO_CURVATURE_B0C1, ISO_CURVATURE_B1C1},
    {ISO_CURVATURE_A1, ISO_CURVATURE_HERE, ISO_CURVATURE_A2, ISO_CURVATURE_A1B0, ISO_CURVATURE_A1B1,
     ISO_CURVATURE_A1C0, ISO_CURVATURE_A1C1, ISO_CURVATURE_B0, ISO_CURVATURE_A2B0, ISO_CURVATURE_B1,
     ISO_CURVATURE_A2B1, ISO_CURVATURE_C0, ISO_CURVATURE_A2C0, ISO_CURVATURE_C1, ISO_CURVATURE_A2C1,
     ISO_CURVATURE_A1B0C0, ISO_CURVATURE_A1B1C0, ISO_CURVATURE_A1B0C1, ISO_CURVATURE_A1B1C1},
};

/* Computes derivatives by central differences at the lower (end = 0) or upper (1) end of an edge; at a voxel,
 * `end` is 0. */
ISO_INLINE cv_derivatives derivatives_at(const iso_curvature_batch *batch, int end, uint32_t i,
                                         const bool floats) {
    vf v[ISO_CURVATURE_VOXEL];
    for (int k = 0; k < ISO_CURVATURE_VOXEL; k++) v[k] = value(batch, voxel_offsets[end][k], i, floats);
    cv_derivatives derivatives;
    const vf here = v[ISO_CURVATURE_HERE] + v[ISO_CURVATURE_HERE];
    for (int k = 0; k < 3; k++) {
        const vf low = v[ISO_CURVATURE_A0 + 2 * k], high = v[ISO_CURVATURE_A1 + 2 * k];
        derivatives.g[k] = (high - low) * 0.5f;
        derivatives.h[k] = low + high - here;
        const vf *corner = v + ISO_CURVATURE_A0B0 + 4 * k;
        derivatives.h[3 + k] = (corner[0] - corner[1] - corner[2] + corner[3]) * 0.25f;
    }
    return derivatives;
}

/* Recomputes each mixed derivative at a voxel that depends on a clamped value. If one diagonal of the four
 * diagonal neighbours has a clamped value, the derivative comes from the other diagonal alone. */
ISO_INLINE void repair_mixed_derivatives(const iso_curvature_batch *batch, uint32_t i, float band,
                                         cv_derivatives *derivatives) {
    static const uint8_t corners[3] = {ISO_CURVATURE_A0B0, ISO_CURVATURE_A0C0, ISO_CURVATURE_B0C0};
    static const uint8_t sides[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int k = 0; k < 3; k++) {
        vf v[4];
        for (int n = 0; n < 4; n++) v[n] = value(batch, corners[k] + n, i, true);
        const vf both = derivatives->h[sides[k][0]] + derivatives->h[sides[k][1]];
        const vf here = value(batch, ISO_CURVATURE_HERE, i, true);
        const vf twice = here + here;
        const vf main = (v[0] + v[3] - twice - both) * 0.5f, other = (both + twice - v[1] - v[2]) * 0.5f;
        const vf most_main = v_max(v_abs(v[0]), v_abs(v[3])), most_other = v_max(v_abs(v[1]), v_abs(v[2]));
        derivatives->h[3 + k] = v_select(v_le(v_set(band), most_other), main, derivatives->h[3 + k]);
        derivatives->h[3 + k] = v_select(v_le(v_set(band), most_main), other, derivatives->h[3 + k]);
    }
}

/* Returns normal_sign / |g|; 0 where the gradient vanishes or overflows. */
ISO_INLINE vf per_gradient(const vf g[3], float normal_sign) {
    vf sum = v_abs(g[0]) + v_abs(g[1]) + v_abs(g[2]);
    vm usable = v_and(v_lt(v_set(1e-30f), sum), v_lt(sum, v_set(1e30f)));
    vf scale = 1 / v_select(usable, sum, v_set(1)), square = v_set(0);
    for (int k = 0; k < 3; k++) square += (g[k] * scale) * (g[k] * scale);
    return v_select(usable, normal_sign * scale / v_sqrt(v_select(usable, square, v_set(1))), v_set(0));
}

/* A point's normal and tangents (iso_curvature_frame), with components along a, b, c. */
typedef struct cv_axes {
    vf n[3], u[3], v[3];
} cv_axes;

ISO_INLINE cv_axes axes_at(const iso_curvature_params *params, const iso_curvature_batch *batch, uint32_t i) {
    const int a = params->axis, order[3] = {a, a == 0 ? 1 : 0, a == 2 ? 1 : 2};
    vf n[3], u[3], v[3];
    cv_axes axes;
    if (params->packed)
        unpack_normals(v_loadi(batch->octahedral + i), n);
    else
        for (int k = 0; k < 3; k++) n[k] = v_load(batch->normal[k] + i);
    make_tangents(n, u, v);
    for (int k = 0; k < 3; k++) {
        axes.n[k] = n[order[k]];
        axes.u[k] = u[order[k]];
        axes.v[k] = v[order[k]];
    }
    return axes;
}

/* Computes the entries uu, uv, vv of the shape operator P H P / |g|. */
ISO_INLINE void shape_operator(const cv_axes *axes, float normal_sign, const cv_derivatives *derivatives,
                               vf out[3]) {
    const vf *u = axes->u, *v = axes->v, *h = derivatives->h;
    const vf hu[3] = {h[0] * u[0] + h[3] * u[1] + h[4] * u[2], h[3] * u[0] + h[1] * u[1] + h[5] * u[2],
                      h[4] * u[0] + h[5] * u[1] + h[2] * u[2]};
    const vf hv[3] = {h[0] * v[0] + h[3] * v[1] + h[4] * v[2], h[3] * v[0] + h[1] * v[1] + h[5] * v[2],
                      h[4] * v[0] + h[5] * v[1] + h[2] * v[2]};
    vf scale = per_gradient(derivatives->g, normal_sign);
    out[0] = (u[0] * hu[0] + u[1] * hu[1] + u[2] * hu[2]) * scale;
    out[1] = (v[0] * hu[0] + v[1] * hu[1] + v[2] * hu[2]) * scale;
    out[2] = (v[0] * hv[0] + v[1] * hv[1] + v[2] * hv[2]) * scale;
}

/* Encodes the tilt as two numbers of ISO_CURVATURE_TILT_BITS (7) bits each. */
ISO_INLINE vi encode_tilt(const vf tilt[2]) {
    vi bits = v_seti(0);
    for (int k = 0; k < 2; k++) {
        const vf size = v_min(v_abs(tilt[k]) * (1 / ISO_CURVATURE_TILT_MOST), v_set(1));
        const vi steps = v_trunc(v_sqrt(size) * ISO_CURVATURE_TILT_STEPS + 0.5f);
        const vi whole = v_selecti(v_lt(tilt[k], v_set(0)), v_seti(0) - steps, steps);
        bits |= (whole & (2 * ISO_CURVATURE_TILT_STEPS + 1)) << (ISO_CURVATURE_TILT_BITS * k);
    }
    return bits;
}

/* Stores curvatures s (uu, uv, vv) as iso_curvature_pack does, with the tilt in their low bits. */
ISO_INLINE void pack_curvature(iso_curvature_batch *batch, uint32_t i, const vf s[3], const vf tilt[2]) {
    vf norm = v_sqrt(s[0] * s[0] + 2 * (s[1] * s[1]) + s[2] * s[2]);
    vm sound = v_lt(norm, v_set(1e15f)), large = v_lt(v_set(ISO_CURVATURE_MOST), norm);
    vf scale = v_select(large, ISO_CURVATURE_MOST / norm, v_set(1));
    int32_t *const to[3] = {batch->uu + i, batch->uv + i, batch->vv + i};
    const int low = (1 << ISO_CURVATURE_LOW_BITS) - 1;
    const vi bits = encode_tilt(tilt);
    for (int k = 0; k < 3; k++) {
        vf steps = v_select(sound, s[k] * scale, v_set(0)) *
                   (1 / (ISO_CURVATURE_STEP * (1 << ISO_CURVATURE_LOW_BITS)));
        const vi entry = v_trunc(steps + 2048.5f) - 2048;
        v_storei(to[k], entry << ISO_CURVATURE_LOW_BITS | (bits >> (ISO_CURVATURE_LOW_BITS * k) & low));
    }
}

/* The values on each side of an edge, down and up along b, then along c, as indices in batch->value: at the
 * ends of the parallel edge on that side, with which the edge bounds a face; then at three voxels that are
 * diagonal to the edge's lower end, beside that face or below it. */
enum { FACE_VALUES = 2, SIDE_VALUES = 5 };
static const int sides[4][SIDE_VALUES] = {
    {ISO_CURVATURE_B0, ISO_CURVATURE_A1B0, ISO_CURVATURE_B0C0, ISO_CURVATURE_B0C1, ISO_CURVATURE_A0B0},
    {ISO_CURVATURE_B1, ISO_CURVATURE_A1B1, ISO_CURVATURE_B1C0, ISO_CURVATURE_B1C1, ISO_CURVATURE_A0B1},
    {ISO_CURVATURE_C0, ISO_CURVATURE_A1C0, ISO_CURVATURE_B0C0, ISO_CURVATURE_B1C0, ISO_CURVATURE_A0C0},
    {ISO_CURVATURE_C1, ISO_CURVATURE_A1C1, ISO_CURVATURE_B0C1, ISO_CURVATURE_B1C1, ISO_CURVATURE_A0C1}};

/* Computes how far the surface continues from an edge to one side (iso_curvature.extents), in the face
 * between the edge and the parallel edge on that side: as far as the point where it crosses one of the two
 * edges that join them, or to the parallel edge. That is 0 where a voxel of the edge has the isovalue, as
 * many have in volumes of integers, and the surface only touches the face there. If a diagonal voxel is
 * inside, the surface continues in cells beside the face, where the disc must cover it: then it is 1. */
ISO_INLINE vi extent_towards(const iso_curvature_params *params, const iso_curvature_batch *batch,
                             const int side[SIDE_VALUES], uint32_t i, const bool floats) {
    const vf at = v_set(params->isovalue_ceil), zero = v_set(0), one = v_set(1);
    vf end = v_set(-1);
    for (int k = 0; k < FACE_VALUES; k++) {
        const vf from = value(batch, k ? ISO_CURVATURE_A1 : ISO_CURVATURE_HERE, i, floats),
                 to = value(batch, side[k], i, floats);
        const vm differ = v_or(v_and(v_le(at, from), v_lt(to, at)), v_and(v_lt(from, at), v_le(at, to)));
        const vf t = (from - at) / v_select(differ, from - to, one);
        end = v_select(differ, v_max(end, t), end);
    }
    vm beside = v_lt(zero, zero);
    for (int k = FACE_VALUES; k < SIDE_VALUES; k++)
        beside = v_or(beside, v_le(at, value(batch, side[k], i, floats)));
    const vm ends = v_andnot(v_and(v_le(zero, end), v_lt(end, one)), v_and(v_le(end, zero), beside));
    return v_trunc(v_select(ends, end, one) * ISO_CURVATURE_EXTENT_STEPS + 0.9999f);
}

/* Sets batch->extents of edge points, with the edge's axis in it; 0 for lanes whose edge is not crossed. */
ISO_INLINE void find_extents(const iso_curvature_params *params, iso_curvature_batch *batch, uint32_t i,
                             vm crossed, const bool floats) {
    vi ends = v_seti((params->axis + 1) << ISO_CURVATURE_AXIS_BIT);
    for (int k = 0; k < 4; k++)
        ends |= extent_towards(params, batch, sides[k], i, floats) << (ISO_CURVATURE_EXTENT_BITS * k);
    v_storei(batch->extents + i, v_selecti(crossed, ends, v_seti(0)));
}

/* Returns whether one of two values (relative to the isovalue) is at or above the isovalue and the other is
 * below. */
ISO_INLINE vm differ(vf a, vf b) {
    const vf zero = v_set(0);
    return v_or(v_and(v_le(zero, a), v_lt(b, zero)), v_and(v_lt(a, zero), v_le(zero, b)));
}

/* Finds the point where the surface leaves the face to one side of an edge: *off voxels to that side, *along
 * voxels from the edge's lower end along a. f: the values minus the isovalue at the edge's two ends, then at
 * their neighbours. In a face that the surface crosses twice, the sign at the saddle point decides which
 * crossings are connected (Nielson and Hamann 1991, "The asymptotic decider"). */
ISO_INLINE void face_exit(const vf f[4], vf *off, vf *along) {
    const vm beside[2] = {differ(f[0], f[2]), differ(f[1], f[3])};
    const vf saddle = (f[0] * f[3] - f[1] * f[2]) * (f[0] + f[3] - f[1] - f[2]), zero = v_set(0);
    const vm split =
        v_or(v_and(v_le(zero, f[0]), v_lt(zero, saddle)), v_and(v_lt(f[0], zero), v_le(saddle, zero)));
    const vm high = v_or(v_andnot(beside[1], beside[0]), v_and(v_and(beside[0], beside[1]), split));
    const vm aside = v_or(beside[0], beside[1]);
    const vf from = v_select(high, f[1], f[0]), to = v_select(high, f[3], f[2]);
    const vf t = from / v_select(aside, from - to, v_set(1)),
             across = f[2] / v_select(aside, v_set(1), f[2] - f[3]);
    *off = v_select(aside, t, v_set(1));
    *along = v_select(aside, v_select(high, v_set(1), zero), across);
}

/* Solves M x = r for a positive definite matrix M by its LDL^T decomposition. Only the lower triangle of m is
 * read, and it is overwritten; x replaces r. */
ISO_INLINE void solve(vf m[4][4], vf r[4]) {
    vf l[4][4], inverse[4];
    for (int q = 0; q < 4; q++) {
        inverse[q] = 1 / m[q][q];
        for (int p = q + 1; p < 4; p++) {
            l[p][q] = m[p][q] * inverse[q];
            for (int k = q + 1; k <= p; k++) m[p][k] -= l[p][q] * m[k][q];
        }
    }
    for (int p = 1; p < 4; p++)
        for (int k = 0; k < p; k++) r[p] -= l[p][k] * r[k];
    for (int p = 0; p < 4; p++) r[p] *= inverse[p];
    for (int p = 2; p >= 0; p--)
        for (int k = p + 1; k < 4; k++) r[p] -= l[k][p] * r[k];
}

/* Standard deviations of the fit: of the tilt, of the entries of the shape operator (1 / voxel), and of the
 * distance of an observed point from the quadric (voxels), which is not 0 because the surface is a different
 * quadric in the neighbouring cells. */
#define LIKELY_TILT 0.14f
#define LIKELY_CURVATURE 0.32f
#define LIKELY_OFFSET 0.17f

/* The field's slope along an edge and the gradient's component along that edge differ even on smooth
 * surfaces: differences up to this share of the gradient's length do not change the tilt. */
#define SMOOTH_SLOPE 0.15f
/* The slope of the surface against the normal from which on the tilt is not corrected; the correction fades
 * towards it. */
#define MAX_SLOPE 4.0f

/* Computes the tilt from which the fit starts. Normals come from gradients `g` over two voxels, which miss
 * thin and sharp features. The trilinear field is linear along the edge, with a known slope; the part of its
 * difference from g's component that exceeds SMOOTH_SLOPE is taken to be a tilt of the surface. */
ISO_INLINE void initial_tilt(const iso_curvature_params *params, const iso_curvature_batch *batch,
                             const cv_axes *axes, const vf g[3], uint32_t i, vf tilt[2], const bool floats) {
    const vf rise = value(batch, ISO_CURVATURE_A1, i, floats) - value(batch, ISO_CURVATURE_HERE, i, floats),
             off = (rise - g[0]) * per_gradient(g, params->normal_sign),
             more = v_max(v_abs(off) - SMOOTH_SLOPE, v_set(0)),
             slope = v_select(v_lt(off, v_set(0)), -more, more);
    const vf along = 1 + slope * axes->n[0], /* the corrected gradient's component along the normal */
        initial_tilt = slope * along / v_max(along * along, v_set(1e-4f)),
             scale = initial_tilt *
                     v_max(1 - initial_tilt * initial_tilt * (1 / (MAX_SLOPE * MAX_SLOPE)), v_set(0));
    tilt[0] = scale * axes->u[0];
    tilt[1] = scale * axes->v[0];
}

/* Returns the coefficient of n^2 in the quadric (render/discs/discs.h): the larger principal curvature,
 * or 0 if it is negative. */
ISO_INLINE vf curvature_along(const vf s[3]) {
    const vf apart = v_sqrt((s[0] - s[2]) * (s[0] - s[2]) + 4 * (s[1] * s[1]));
    return v_max(s[0] + s[2] + apart, v_set(0)) * 0.5f;
}

/* Adds an observation to the fit: the surface passes through the point q, given in the coordinates u, v, n of
 * the point's tangents and normal. Sets its row `out` of the design matrix, scaled by the priors, and returns
 * the residual. */
ISO_INLINE vf set_observation(const vf q[3], const vf tilt[2], const vf s[3], vf out[5]) {
    const vf u = q[0], v = q[1], n = q[2];
    const vf normal_curvature = curvature_along(s);
    const vf uu = 0.5f * u * u, uv = u * v, vv = 0.5f * v * v;
    out[0] = LIKELY_TILT * u;
    out[1] = LIKELY_TILT * v;
    out[2] = LIKELY_CURVATURE * uu;
    out[3] = LIKELY_CURVATURE * uv;
    out[4] = LIKELY_CURVATURE * vv;
    return -(n + tilt[0] * u + tilt[1] * v + s[0] * uu + s[1] * uv + s[2] * vv +
             0.5f * normal_curvature * n * n);
}

/* Changes the tilt and the shape operator s so that the quadric n.q + q.Sq / 2 = 0 passes near the four
 * points where the surface leaves the faces beside the edge. Returns the lanes whose edge the surface crosses
 * (a point exactly at a voxel may belong to another edge); the other lanes keep s and get tilt 0. */
ISO_INLINE vm fit_quadric(const iso_curvature_params *params, const iso_curvature_batch *batch,
                          const cv_axes *axes, uint32_t i, vf s[3], vf tilt[2], const bool floats) {
    vf a[4][5], m[4][4], r[4], x[5], f[4], size = v_set(0);
    for (int k = 0; k < 2; k++)
        f[k] = value(batch, k ? ISO_CURVATURE_A1 : ISO_CURVATURE_HERE, i, floats) - params->isovalue_ceil;
    for (int p = 0; p < 4; p++) {
        vf off, along, q[3];
        for (int k = 0; k < 2; k++) f[2 + k] = value(batch, sides[p][k], i, floats) - params->isovalue_ceil;
        face_exit(f, &off, &along);
        along -= v_load(batch->along + i);
        off = p & 1 ? off : -off;
        const int side = 1 + p / 2;
        q[0] = axes->u[0] * along + axes->u[side] * off;
        q[1] = axes->v[0] * along + axes->v[side] * off;
        q[2] = axes->n[0] * along + axes->n[side] * off;
        r[p] = set_observation(q, tilt, s, a[p]);
        for (int k = 0; k <= p; k++) {
            m[p][k] = v_set(p == k ? LIKELY_OFFSET * LIKELY_OFFSET : 0);
            for (int n = 0; n < 5; n++) m[p][k] += a[p][n] * a[k][n];
        }
    }
    solve(m, r);
    for (int k = 0; k < 5; k++) {
        x[k] = (k < 2 ? LIKELY_TILT : LIKELY_CURVATURE) *
               (a[0][k] * r[0] + a[1][k] * r[1] + a[2][k] * r[2] + a[3][k] * r[3]);
        size += v_abs(k < 2 ? tilt[k] + x[k] : x[k]);
    }
    const vm crossed = differ(f[0], f[1]), usable = v_and(crossed, v_lt(size, v_set(100)));
    for (int k = 0; k < 2; k++) tilt[k] = v_select(usable, tilt[k] + x[k], v_set(0));
    for (int k = 0; k < 3; k++) s[k] += v_select(usable, x[2 + k], v_set(0));
    return crossed;
}

/* ---- shrinking discs that leave the surface */

/* The values minus the isovalue at the corners of the four cells around an edge. */
typedef struct cv_cells {
    vf at[2][3][3]; /* [a][b][c]; the edge runs from [0][1][1] to [1][1][1] */
} cv_cells;

ISO_INLINE cv_cells cells_at(const iso_curvature_params *params, const iso_curvature_batch *batch, uint32_t i,
                             const bool floats) {
    static const uint8_t voxel[2][3][3] = {
        {{ISO_CURVATURE_B0C0, ISO_CURVATURE_B0, ISO_CURVATURE_B0C1},
         {ISO_CURVATURE_C0, ISO_CURVATURE_HERE, ISO_CURVATURE_C1},
         {ISO_CURVATURE_B1C0, ISO_CURVATURE_B1, ISO_CURVATURE_B1C1}},
        {{ISO_CURVATURE_A1B0C0, ISO_CURVATURE_A1B0, ISO_CURVATURE_A1B0C1},
         {ISO_CURVATURE_A1C0, ISO_CURVATURE_A1, ISO_CURVATURE_A1C1},
         {ISO_CURVATURE_A1B1C0, ISO_CURVATURE_A1B1, ISO_CURVATURE_A1B1C1}}};
    cv_cells cells;
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 3; b++)
            for (int c = 0; c < 3; c++)
                cells.at[a][b][c] = value(batch, voxel[a][b][c], i, floats) - params->isovalue_ceil;
    return cells;
}

/* Returns the trilinear field at p, in voxels from the edge's lower end along a, b, c. */
ISO_INLINE vf field(const cv_cells *cells, const vf p[3]) {
    const vf zero = v_set(0), b = v_abs(p[1]), c = v_abs(p[2]);
    const vm up_b = v_le(zero, p[1]), up_c = v_le(zero, p[2]);
    vf end[2];
    for (int a = 0; a < 2; a++) {
        const vf(*const f)[3] = cells->at[a];
        vf row[3]; /* interpolated along c; only one of the outer two rows is used */
        for (int k = 0; k < 3; k++) row[k] = f[k][1] + c * (v_select(up_c, f[k][2], f[k][0]) - f[k][1]);
        end[a] = row[1] + b * (v_select(up_b, row[2], row[0]) - row[1]);
    }
    return end[0] + p[0] * (end[1] - end[0]);
}

/* The disc of a point, and the box in a, b, c (relative to the point) to which the renderer clips it.
 * `along`: the point's position on its edge. */
typedef struct cv_disc {
    cv_axes axes;
    vf s[3], normal_curvature, tilt[2], along, low[3], high[3];
} cv_disc;

#define DISC_RADIUS 0.9f    /* voxels, of a disc that is not shrunk (the renderer's are 0.85 to 1) */
#define DISC_TOLERANCE 0.2f /* voxels by which a disc may lie outside the surface */
#define DISC_OVERLAP 0.08f  /* voxels by which discs are drawn beyond their extents */
/* Share of a disc's area that may lie farther outside than DISC_TOLERANCE. With a smaller share, gaps show
 * between discs. */
#define DISC_OUTSIDE_SHARE 0.28f
/* Curvature, 1 / voxel: discs of smaller curvature are never shrunk. They fit well enough or, on the stair
 * steps of binary volumes, are needed to fill gaps. */
#define DISC_CURVED 1.8f

/* Makes the discs of a vector of points, whose extents are already in the batch. */
ISO_INLINE cv_disc disc_at(const iso_curvature_batch *batch, const cv_axes *axes, uint32_t i, const vf s[3],
                           const vf tilt[2]) {
    cv_disc disc = {.axes = *axes, .along = v_load(batch->along + i)};
    memcpy(disc.s, s, sizeof disc.s);
    memcpy(disc.tilt, tilt, sizeof disc.tilt);
    disc.normal_curvature = curvature_along(s);
    disc.low[0] = -(disc.along + DISC_OVERLAP);
    disc.high[0] = 1 - disc.along + DISC_OVERLAP;
    const vi ends = v_loadi(batch->extents + i);
    for (int k = 0; k < 4; k++) {
        const vf end = v_to_float(ends >> (ISO_CURVATURE_EXTENT_BITS * k) & ISO_CURVATURE_EXTENT_STEPS) *
                           (1.0f / ISO_CURVATURE_EXTENT_STEPS) +
                       DISC_OVERLAP;
        if (k & 1)
            disc.high[1 + k / 2] = end;
        else
            disc.low[1 + k / 2] = -end;
    }
    return disc;
}

/* Returns whether the disc, at x and y from its point along u and v, lies outside the surface by more than
 * DISC_TOLERANCE. *in: whether the disc has a point there. (Parts that lie too far inside are hidden by other
 * discs.) */
ISO_INLINE vm is_outside(const iso_curvature_params *params, const cv_cells *cells, const cv_disc *disc,
                         float x, float y, vm *in) {
    const vf *s = disc->s, *u = disc->axes.u, *v = disc->axes.v, *n = disc->axes.n, zero = v_set(0);
    const vf su = s[0] * x + s[1] * y, sv = s[1] * x + s[2] * y;
    const vf c = disc->tilt[0] * x + disc->tilt[1] * y + 0.5f * (su * x + sv * y);
    const vf under = 1 - 2 * (disc->normal_curvature * c), up = -2 * c / (1 + v_sqrt(v_max(under, zero)));
    const vf m[3] = {disc->tilt[0] + su, disc->tilt[1] + sv,
                     1 + disc->normal_curvature * up}; /* the disc's normal */
    const vf back = DISC_TOLERANCE / v_sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    vf at[3], behind[3];
    *in = v_and(v_le(zero, under), v_le(up * up, v_set(DISC_RADIUS * DISC_RADIUS - x * x - y * y)));
    for (int k = 0; k < 3; k++) {
        at[k] = u[k] * x + v[k] * y + n[k] * up;
        behind[k] = at[k] - back * (u[k] * m[0] + v[k] * m[1] + n[k] * m[2]);
        *in = v_and(*in, v_and(v_le(disc->low[k], at[k]), v_le(at[k], disc->high[k])));
    }
    at[0] += disc->along;
    behind[0] += disc->along;
    return v_and(v_lt(zero, field(cells, at) * params->normal_sign),
                 v_lt(zero, field(cells, behind) * params->normal_sign));
}

/* Returns by how many quarters of its radius (0 .. 3) a disc must shrink so that at most DISC_OUTSIDE_SHARE
 * of its area is outside. Samples the disc on four rings of eight points. */
ISO_INLINE vi shrink_quarters(const iso_curvature_params *params, const iso_curvature_batch *batch,
                              const cv_axes *axes, uint32_t i, const vf s[3], const vf tilt[2],
                              const bool floats) {
    const float h = 0.70710678f,
                ways[8][2] = {{1, 0}, {h, h}, {0, 1}, {-h, h}, {-1, 0}, {-h, -h}, {0, -1}, {h, -h}};
    const vf norm = s[0] * s[0] + 2 * (s[1] * s[1]) + s[2] * s[2], zero = v_set(0);
    const vm bent = v_lt(v_set(DISC_CURVED * DISC_CURVED), norm);
    if (!v_mask(bent)) return v_seti(0);
    const cv_cells cells = cells_at(params, batch, i, floats);
    const cv_disc disc = disc_at(batch, axes, i, s, tilt);
    vf all = zero, outside = zero;
    vi shrink = v_seti(3);
    for (int quarter = 0; quarter < 4; quarter++) {
        const float r = ((float)quarter + 0.86f) / 4 * DISC_RADIUS, area = (float)(2 * quarter + 1);
        for (int k = 0; k < 8; k++) {
            vm in;
            const vm off = is_outside(params, &cells, &disc, r * ways[k][0], r * ways[k][1], &in);
            all += v_select(in, v_set(area), zero);
            outside += v_select(v_and(in, off), v_set(area), zero);
        }
        shrink = v_selecti(v_le(outside, all * DISC_OUTSIDE_SHARE), v_seti(3 - quarter), shrink);
    }
    return v_selecti(bent, shrink, v_seti(0));
}

/* Computes the curvatures, extents and sizes of discs of edge points. floats: `value` holds floats, not
 * integers. */
ISO_INLINE void edges_typed(const iso_curvature_params *params, iso_curvature_batch *batch,
                            const bool floats) {
    for (uint32_t i = 0; i < batch->count; i += ISO_LANES) {
        cv_derivatives low = derivatives_at(batch, 0, i, floats), high = derivatives_at(batch, 1, i, floats);
        const cv_axes axes = axes_at(params, batch, i);
        vf t = v_load(batch->along + i), s[3], tilt[2];
        for (int k = 0; k < 3; k++) low.g[k] += t * (high.g[k] - low.g[k]);
        for (int k = 0; k < 6; k++) low.h[k] += t * (high.h[k] - low.h[k]);
        shape_operator(&axes, params->normal_sign, &low, s);
        initial_tilt(params, batch, &axes, low.g, i, tilt, floats);
        const vm crossed = fit_quadric(params, batch, &axes, i, s, tilt, floats);
        pack_curvature(batch, i, s, tilt);
        find_extents(params, batch, i, crossed, floats);
        const vi shrink = shrink_quarters(params, batch, &axes, i, s, tilt, floats);
        v_storei(batch->extents + i, v_loadi(batch->extents + i) |
                                         v_selecti(crossed, shrink << ISO_CURVATURE_SHRINK_BIT, v_seti(0)));
    }
}

static void edges(const iso_curvature_params *params, iso_curvature_batch *batch) {
    if (params->floats)
        edges_typed(params, batch, true);
    else
        edges_typed(params, batch, false);
}

/* Replaces the shape operator S at a distance d from the surface by that of the surface, S (1 - d S)^-1;
 * leaves it unchanged where 1 - d S is nearly singular. */
ISO_INLINE void carry_to_surface(vf distance, vf s[3]) {
    vf m[3] = {1 - distance * s[0], -(distance * s[1]), 1 - distance * s[2]};
    vf determinant = m[0] * m[2] - m[1] * m[1];
    vm regular = v_and(v_lt(v_set(0.1f), determinant), v_lt(v_set(0.1f), m[0] + m[2]));
    vf scale = 1 / v_select(regular, determinant, v_set(1));
    vf moved[3] = {(s[0] * m[2] - s[1] * m[1]) * scale, (s[1] * m[0] - s[0] * m[1]) * scale,
                   (s[2] * m[0] - s[1] * m[1]) * scale};
    for (int k = 0; k < 3; k++) s[k] = v_select(regular, moved[k], s[k]);
}

static void voxels(const iso_curvature_params *params, iso_curvature_batch *batch) {
    for (uint32_t i = 0; i < batch->count; i += ISO_LANES) {
        cv_derivatives derivatives = derivatives_at(batch, 0, i, true);
        const cv_axes axes = axes_at(params, batch, i);
        vf s[3];
        repair_mixed_derivatives(batch, i, params->band, &derivatives);
        shape_operator(&axes, params->normal_sign, &derivatives, s);
        carry_to_surface(v_load(batch->along + i), s);
        pack_curvature(batch, i, s, (const vf[2]){v_set(0), v_set(0)});
        v_storei(batch->extents + i, v_seti(0));
    }
}

const iso_curvature_kernel ISO_KERNEL_NAME(iso_curvature_kernel) = {.edges = edges, .voxels = voxels};
