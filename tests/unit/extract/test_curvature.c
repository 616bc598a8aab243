/* shapes: against surfaces whose curvature is known, against a reference in double that knows no bricks, and
 * every instruction set against the plainest. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "extract/points/points.h"
#include "extract_support.h"
#include "grids/scenes/scenes.h"

/* A point of a view in index coordinates, with its shape as a matrix. */
typedef struct bent_point {
    iso_vec3 position, normal;
    double s[3][3], u[3], v[3], tilt[2];
} bent_point;

static bent_point get_point(const iso_point_view *view, const iso_point_span *span, uint32_t i) {
    const iso_surfel surfel = iso_point_view_get(view, span->first + i);
    bent_point point;
    float u[3], v[3], entry[3], tilt[2];
    iso_curvature_unpack(view->curvatures[span->first + i], entry, tilt);
    const double uu = (double)entry[0], uv = (double)entry[1], vv = (double)entry[2];
    iso_curvature_frame(surfel.normal, u, v);
    for (int k = 0; k < 3; k++) {
        point.u[k] = (double)u[k];
        point.v[k] = (double)v[k];
    }
    for (int k = 0; k < 2; k++) point.tilt[k] = (double)tilt[k];
    point.position =
        iso_vec3_make(16 * span->brick[0] + surfel.position[0], 16 * span->brick[1] + surfel.position[1],
                      16 * span->brick[2] + surfel.position[2]);
    point.normal = iso_vec3_make(surfel.normal[0], surfel.normal[1], surfel.normal[2]);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            point.s[r][c] = uu * u[r] * u[c] + uv * (u[r] * v[c] + v[r] * u[c]) + vv * v[r] * v[c];
    return point;
}

static double largest_difference(double a[3][3], double b[3][3]) {
    double most = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) most = fmax(most, fabs(a[r][c] - b[r][c]));
    return most;
}

static void frames_are_right_handed_and_unit(void **state) {
    (void)state;
    test_random random = {5};
    for (int i = 0; i < 2000; i++) {
        iso_vec3 n =
            iso_vec3_unit(iso_vec3_make(test_random_real(&random, -1, 1), test_random_real(&random, -1, 1),
                                        i % 3 ? test_random_real(&random, -1, 1) : 0));
        if (i < 2) n = iso_vec3_make(0, 0, i ? -1 : 1);
        const float normal[3] = {(float)n.x, (float)n.y, (float)n.z};
        float u[3], v[3];
        iso_curvature_frame(normal, u, v);
        const iso_vec3 uu = iso_vec3_make(u[0], u[1], u[2]), vv = iso_vec3_make(v[0], v[1], v[2]);
        const iso_vec3 off = iso_vec3_sub(iso_vec3_cross(uu, vv), n);
        assert_true(iso_vec3_length(off) < 1e-5);
        assert_true(fabs(iso_vec3_length(uu) - 1) < 1e-5 && fabs(iso_vec3_dot(uu, vv)) < 1e-5);
    }
}

static void packing_clamps_and_rounds(void **state) {
    (void)state;
    const iso_curvature small = iso_curvature_pack(0.5f, -0.25f, 0.125f);
    assert_int_equal(small.uu, 4000);
    assert_int_equal(small.uv, -1984); /* multiples of 32 */
    assert_int_equal(small.vv, 992);
    const iso_curvature large = iso_curvature_pack(30, 0, -40); /* norm 50 becomes 4 */
    assert_int_equal(large.uu, 19200);
    assert_int_equal(large.uv, 0);
    assert_int_equal(large.vv, -25600);
    const float odd[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        const iso_curvature none = iso_curvature_pack(odd[i], 1, 1);
        assert_true(none.uu == 0 && none.uv == 0 && none.vv == 0);
    }
}

/* ---- analytic surfaces */

/* The shape operator of a scene's surface at p (0: not there, near an edge of the solid, say). */
typedef int analytic(double size, iso_vec3 p, iso_vec3 n, double s[3][3]);

static void add_outer(double s[3][3], iso_vec3 a, double k) {
    const double v[3] = {a.x, a.y, a.z};
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) s[r][c] += k * v[r] * v[c];
}

static iso_vec3 from_centre(double size, iso_vec3 p) {
    const double c = floor(size / 2) - 0.5;
    return iso_vec3_sub(p, iso_vec3_make(c, c, c));
}

static int sphere_shape(double size, iso_vec3 p, iso_vec3 n, double s[3][3]) {
    (void)p, (void)n;
    const double k = 1 / (0.4 * size);
    memset(s, 0, 9 * sizeof(double));
    for (int i = 0; i < 3; i++) s[i][i] = k;
    const iso_vec3 out = iso_vec3_unit(from_centre(size, p));
    add_outer(s, out, -k);
    return 1;
}

/* Flat along the axis, round about it; the caps are flat. Not within 3 voxels of a rim. */
static int cylinder_shape(double size, iso_vec3 p, iso_vec3 n, double s[3][3]) {
    const iso_vec3 axis = iso_vec3_unit(iso_vec3_make(0.35, 0.25, 0.9)), q = from_centre(size, p);
    const double along = iso_vec3_dot(q, axis), half = 0.32 * size, radius = 0.2 * size;
    const iso_vec3 radial = iso_vec3_sub(q, iso_vec3_scale(axis, along));
    memset(s, 0, 9 * sizeof(double));
    if (fabs(fabs(along) - half) < 3 && iso_vec3_length(radial) > radius - 3) return 0;
    if (fabs(iso_vec3_dot(n, axis)) < 0.5)
        add_outer(s, iso_vec3_cross(axis, iso_vec3_unit(radial)), 1 / radius);
    return 1;
}

static int torus_shape(double size, iso_vec3 p, iso_vec3 n, double s[3][3]) {
    const double tube = 0.1 * size;
    const iso_vec3 q = from_centre(size, p);
    const double across = sqrt(q.x * q.x + q.y * q.y);
    const iso_vec3 out = iso_vec3_make(q.x / across, q.y / across, 0),
                   round = iso_vec3_make(-out.y, out.x, 0);
    memset(s, 0, 9 * sizeof(double));
    add_outer(s, round, iso_vec3_dot(n, out) / across);
    add_outer(s, iso_vec3_cross(n, round), 1 / tube);
    return 1;
}

static void check_analytic(const char *name, int size, analytic *shape, double tolerance) {
    for (int dense = 0; dense < 2; dense++)
        for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++)
            for (int floats = 0; floats < 2; floats++) {
                iso_grid grid = {0};
                const iso_scene_opts scene = {.size = size, .dense = dense};
                assert_int_equal(iso_scene_create(name, &scene, &grid, NULL, NULL), ISO_OK);
                const iso_points_opts opts = {
                    .primitive = (iso_primitive)primitive, .floats = floats, .curvature = true};
                iso_point_set *set = test_point_set(&grid, &opts);
                iso_point_view view = iso_point_set_view(set);
                size_t checked = 0;
                for (size_t k = 0; k < view.span_count; k++)
                    for (uint32_t i = 0; i < view.spans[k].count; i++) {
                        bent_point p = get_point(&view, &view.spans[k], i);
                        double wanted[3][3];
                        if (!shape(size, p.position, p.normal, wanted)) continue;
                        checked++;
                        double off = largest_difference(p.s, wanted);
                        /* a dense level set does not say that its far values are clamped; edge points' shapes
                         * follow the trilinear surface, which lies an eighth of its curvature off */
                        const int times = dense && primitive == ISO_PRIMITIVE_FOOT ? 10
                                          : primitive == ISO_PRIMITIVE_EDGE        ? 3
                                                                                   : 1;
                        if (off > times * tolerance)
                            fail_msg("%s: off by %g at %g %g %g (%s, %s)", name, off, p.position.x,
                                     p.position.y, p.position.z, iso_primitive_name(opts.primitive),
                                     dense ? "dense" : "sparse");
                    }
                assert_true(checked > 1000);
                iso_point_set_destroy(set);
                iso_grid_destroy(&grid);
            }
}

static void curvatures_of_known_surfaces(void **state) {
    (void)state;
    check_analytic("sphere", 48, sphere_shape, 0.004);
    check_analytic("cylinder", 80, cylinder_shape, 0.006);
    check_analytic("torus", 100, torus_shape, 0.012);
}

/* ---- edge points against a reference */

/* Beyond the border, values go on linearly. */
static double wide_value(const iso_grid *grid, int x, int y, int z) {
    const int *dims = iso_grid_dims(grid);
    int at[3] = {x, y, z};
    for (int k = 0; k < 3; k++) {
        if (at[k] >= 0 && at[k] < dims[k]) continue;
        if (dims[k] == 1) {
            at[k] = 0;
            return wide_value(grid, at[0], at[1], at[2]);
        }
        const int edge = at[k] < 0 ? 0 : dims[k] - 1, step = at[k] < 0 ? 1 : -1,
                  beyond = at[k] < 0 ? -at[k] : at[k] - edge;
        at[k] = edge;
        const double here = wide_value(grid, at[0], at[1], at[2]);
        at[k] = edge + step;
        return here + beyond * (here - wide_value(grid, at[0], at[1], at[2]));
    }
    return iso_grid_at(grid, x, y, z);
}

static void voxel_bend(const iso_grid *grid, const int p[3], double g[3], double h[3][3]) {
    static const int unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
#define AT(v) wide_value(grid, p[0] + (v)[0], p[1] + (v)[1], p[2] + (v)[2])
    for (int i = 0; i < 3; i++) {
        const int *a = unit[i], low[3] = {-a[0], -a[1], -a[2]}, zero[3] = {0, 0, 0};
        g[i] = (AT(a) - AT(low)) / 2;
        h[i][i] = AT(a) + AT(low) - 2 * AT(zero);
        for (int j = 0; j < i; j++) {
            const int *b = unit[j];
            int v[4][3];
            for (int k = 0; k < 3; k++) {
                v[0][k] = a[k] + b[k];
                v[1][k] = a[k] - b[k];
                v[2][k] = b[k] - a[k];
                v[3][k] = -a[k] - b[k];
            }
            h[i][j] = h[j][i] = (AT(v[0]) - AT(v[1]) - AT(v[2]) + AT(v[3])) / 4;
        }
    }
#undef AT
}

/* The ends of the edge that a point is on; returns its axis. */
static int edge_of(const bent_point *point, int low[3], int high[3], double *along) {
    const double at[3] = {point->position.x, point->position.y, point->position.z};
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(at[k] - rint(at[k])) > fabs(at[axis] - rint(at[axis]))) axis = k;
    for (int k = 0; k < 3; k++) low[k] = high[k] = (int)(k == axis ? floor(at[k]) : rint(at[k]));
    high[axis]++;
    *along = at[axis] - low[axis];
    return axis;
}

/* There, points may count for the edge beyond. */
static bool is_at_voxel(const bent_point *point) {
    int low[3], high[3];
    double along;
    edge_of(point, low, high, &along);
    return along < 1e-3 || along > 1 - 1e-3;
}

/* How far the surface goes on from an edge to one side; less than 0: not known. */
static double reference_end(const iso_grid *grid, const int edge[2][3], int axis, int step, double isovalue) {
    double end = -1;
    for (int k = 0; k < 2; k++) {
        int to[3] = {edge[k][0], edge[k][1], edge[k][2]};
        to[axis] += step;
        if (to[axis] < 0 || to[axis] >= iso_grid_dims(grid)[axis]) return -1;
        const double a = (double)iso_grid_at(grid, edge[k][0], edge[k][1], edge[k][2]),
                     b = (double)iso_grid_at(grid, to[0], to[1], to[2]);
        if ((a >= isovalue) != (b >= isovalue)) end = fmax(end, (a - isovalue) / (a - b));
    }
    return end < 0 ? 1 : end;
}

/* Returns how many of the ends are before the next edge. */
static size_t check_ends(const iso_grid *grid, const bent_point *point, double isovalue, unsigned ends) {
    int edge[2][3], slot = 0;
    size_t turns = 0;
    double along;
    const int axis = edge_of(point, edge[0], edge[1], &along);
    if (is_at_voxel(point)) return 0;
    assert_int_equal(ends >> ISO_CURVATURE_AXIS_BIT & ISO_CURVATURE_AXIS_MASK, axis + 1);
    for (int k = 0; k < 3; k++)
        for (int step = -1; step <= 1 && k != axis; step += 2) {
            const double wanted = reference_end(grid, edge, k, step, isovalue),
                         got = (ends >> (ISO_CURVATURE_EXTENT_BITS * slot++) & ISO_CURVATURE_EXTENT_STEPS) /
                               (double)ISO_CURVATURE_EXTENT_STEPS;
            turns += wanted >= 0 && got < 1;
            if (wanted >= 0 && (got < wanted - 1e-3 || got > wanted + 1.001 / ISO_CURVATURE_EXTENT_STEPS))
                fail_msg("ends at %g along %d, not %g", got, step * (k + 1), wanted);
        }
    return turns;
}

/* How the surface lies against the normal where the slope along its edge is not what the gradient has there.
 */
static void reference_lean(const iso_grid *grid, const bent_point *point, int axis, double rise,
                           const double gradient[3], double tilt[2]) {
    double length = 0;
    for (int k = 0; k < 3; k++) length += gradient[k] * gradient[k];
    const double outward = iso_grid_is_level_set(grid) ? 1 : -1,
                 off = outward * (rise - gradient[axis]) / sqrt(length),
                 slope = copysign(fmax(fabs(off) - 0.15, 0), off);
    const double normal[3] = {point->normal.x, point->normal.y, point->normal.z};
    const double along = 1 + slope * normal[axis], lean = slope * along / fmax(along * along, 1e-4),
                 scale = lean * fmax(1 - lean * lean / 16, 0);
    tilt[0] = scale * point->u[axis];
    tilt[1] = scale * point->v[axis];
}

/* The shape at an edge point, from where it lies, and its tilt before the fit. */
static void reference_shape(const iso_grid *grid, const bent_point *point, double s[3][3], double tilt[2]) {
    int low[3], high[3];
    double t;
    const int axis = edge_of(point, low, high, &t);
    double g[2][3], h[2][3][3], gradient[3], length = 0;
    voxel_bend(grid, low, g[0], h[0]);
    voxel_bend(grid, high, g[1], h[1]);
    for (int k = 0; k < 3; k++) {
        gradient[k] = g[0][k] + t * (g[1][k] - g[0][k]);
        length += gradient[k] * gradient[k];
    }
    length = sqrt(length);
    const double rise =
        wide_value(grid, high[0], high[1], high[2]) - wide_value(grid, low[0], low[1], low[2]);
    reference_lean(grid, point, axis, rise, gradient, tilt);
    const double n[3] = {point->normal.x, point->normal.y, point->normal.z};
    double tangent[3][3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) tangent[r][c] = (r == c) - n[r] * n[c];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            s[r][c] = 0;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    s[r][c] += tangent[r][i] * (h[0][i][j] + t * (h[1][i][j] - h[0][i][j])) * tangent[j][c];
            s[r][c] *= (iso_grid_is_level_set(grid) ? 1 : -1) / length;
        }
}

/* Where the surface leaves the face between an edge and the one a step to its side, from the edge's first
 * end: along the edge, and to that side. */
static void leave_face(const iso_grid *grid, const int edge[2][3], int axis, int step, double isovalue,
                       double *along, double *off) {
    double f[4];
    for (int k = 0; k < 4; k++) {
        int at[3] = {edge[k & 1][0], edge[k & 1][1], edge[k & 1][2]};
        if (k > 1) at[axis] += step;
        f[k] = wide_value(grid, at[0], at[1], at[2]) - isovalue;
    }
    const bool first = (f[0] >= 0) != (f[2] >= 0), second = (f[1] >= 0) != (f[3] >= 0);
    const double saddle = (f[0] * f[3] - f[1] * f[2]) / (f[0] + f[3] - f[1] - f[2]);
    const int end = first && second ? (saddle > 0) == (f[0] >= 0) : second;
    *off = step * (first || second ? f[end] / (f[end] - f[end + 2]) : 1);
    *along = first || second ? end : f[2] / (f[2] - f[3]);
}

/* Gaussian elimination; x holds the right side, then the answer. */
static void solve(double m[5][5], double x[5]) {
    for (int p = 0; p < 5; p++)
        for (int r = 0; r < 5; r++) {
            const double times = m[r][p] / m[p][p];
            if (r == p) continue;
            for (int c = 0; c < 5; c++) m[r][c] -= times * m[p][c];
            x[r] -= times * x[p];
        }
    for (int p = 0; p < 5; p++) x[p] /= m[p][p];
}

/* Moves a shape to pass near where the surface leaves the faces around its edge: the normal equations of the
 * five unknowns. */
static void fit_reference(const iso_grid *grid, const bent_point *point, double isovalue, double s[3][3],
                          double tilt[2]) {
    int edge[2][3];
    double t, m[5][5] = {{0}}, x[5] = {0}, trace = 0, square = 0;
    const int axis = edge_of(point, edge[0], edge[1], &t);
    const double likely[5] = {0.14, 0.14, 0.32, 0.32, 0.32};
    const double normal[3] = {point->normal.x, point->normal.y, point->normal.z};
    for (int k = 0; k < 9; k++) {
        trace += k % 4 ? 0 : s[k / 3][k % 3];
        square += s[k / 3][k % 3] * s[k / 3][k % 3];
    }
    const double most = fmax((trace + sqrt(fmax(2 * square - trace * trace, 0))) / 2, 0);
    for (int side = 0; side < 6; side++) {
        double q[3] = {0}, along, u = 0, v = 0, n = 0, off = 0;
        if (side / 2 == axis) continue;
        leave_face(grid, edge, side / 2, side % 2 ? 1 : -1, isovalue, &along, &q[side / 2]);
        q[axis] = along - t;
        for (int k = 0; k < 3; k++) {
            u += q[k] * point->u[k];
            v += q[k] * point->v[k];
            n += q[k] * normal[k];
            for (int c = 0; c < 3; c++) off += q[k] * s[k][c] * q[c] / 2;
        }
        off += n + tilt[0] * u + tilt[1] * v + most * n * n / 2;
        const double a[5] = {u, v, u * u / 2, u * v, v * v / 2};
        for (int r = 0; r < 5; r++) {
            x[r] -= a[r] * off / (0.17 * 0.17);
            for (int c = 0; c < 5; c++) m[r][c] += a[r] * a[c] / (0.17 * 0.17);
        }
    }
    for (int k = 0; k < 5; k++) m[k][k] += 1 / (likely[k] * likely[k]);
    solve(m, x);
    for (int k = 0; k < 2; k++) tilt[k] = fmax(fmin(tilt[k] + x[k], 0.8), -0.8);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            s[r][c] += x[2] * point->u[r] * point->u[c] + x[4] * point->v[r] * point->v[c] +
                       x[3] * (point->u[r] * point->v[c] + point->v[r] * point->u[c]);
}

static void clamp_shape(double s[3][3]) {
    double norm = 0;
    for (int k = 0; k < 9; k++) norm += s[k / 3][k % 3] * s[k / 3][k % 3];
    norm = sqrt(norm);
    for (int k = 0; k < 9 && norm > (double)ISO_CURVATURE_MOST; k++)
        s[k / 3][k % 3] *= (double)ISO_CURVATURE_MOST / norm;
    if (!isfinite(norm)) memset(s, 0, 9 * sizeof(double));
}

static size_t check_against_reference(const iso_grid *grid, const iso_point_view *view, double isovalue) {
    size_t checked = 0, turns = 0;
    for (size_t k = 0; k < view->span_count; k++)
        for (uint32_t i = 0; i < view->spans[k].count; i++) {
            bent_point point = get_point(view, &view->spans[k], i);
            double wanted[3][3], tilt[2] = {0, 0};
            turns += check_ends(grid, &point, isovalue, view->curvatures[view->spans[k].first + i].extents);
            if (is_at_voxel(&point)) continue;
            reference_shape(grid, &point, wanted, tilt);
            fit_reference(grid, &point, isovalue, wanted, tilt);
            clamp_shape(wanted);
            double off = largest_difference(point.s, wanted);
            for (int n = 0; n < 2; n++) {
                const double step = 2 * sqrt(0.8 * fabs(tilt[n])) / 63 + 0.8 / (63 * 63);
                off = fmax(off, fabs(point.tilt[n] - tilt[n]) > 0.55 * step + 2e-3 ? 1 : 0);
            }
            /* (rounding of entries is 2e-3, of what they are multiples of) */
            if (off > 3.5e-3)
                fail_msg("off by %g at %g %g %g", off, point.position.x, point.position.y, point.position.z);
            checked++;
        }
    assert_true(turns * 2 >= checked || checked < 100);
    return checked;
}

static void edge_shapes_match_the_reference(void **state) {
    (void)state;
    static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    test_random random = {3};
    size_t checked = 0;
    for (int round = 0; round < 48; round++) {
        int dims[3];
        test_random_dims(&random, round % 6 ? 2 : 1, round % 8 == 7 ? 70 : 20, dims);
        iso_grid grid = test_rgrid(dims, types[round % 4]);
        test_fill(&grid, TEST_SMOOTH, &random);
        grid.rgrid->level_set = round % 5 == 0;
        const iso_points_opts opts = {
            .isovalue = 100.3, .primitive = ISO_PRIMITIVE_EDGE, .floats = true, .curvature = true};
        iso_point_set *set = test_point_set(&grid, &opts);
        iso_point_view view = iso_point_set_view(set);
        checked += check_against_reference(&grid, &view, opts.isovalue);
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    assert_true(checked > 20000);
}

/* Points at a voxel are taken for points of an edge that begins there (their brick's last: ends there). Where
 * the surface does not cross that edge, nothing is known of where it goes on. */
static void points_at_voxels_have_the_ends_of_crossed_edges(void **state) {
    (void)state;
    test_random random = {21};
    size_t crossed = 0, uncrossed = 0;
    for (int round = 0; round < 4; round++) {
        iso_grid grid = test_rgrid((int[3]){40, 37, 35}, ISO_UINT8);
        test_fill(&grid, TEST_SMOOTH, &random);
        const iso_points_opts opts = {
            .isovalue = 100, .primitive = ISO_PRIMITIVE_EDGE, .floats = true, .curvature = true};
        iso_point_set *set = test_point_set(&grid, &opts);
        const iso_point_view view = iso_point_set_view(set);
        for (size_t n = 0; n < view.span_count; n++)
            for (uint32_t i = 0; i < view.spans[n].count; i++) {
                const iso_point_span *span = &view.spans[n];
                const bent_point point = get_point(&view, span, i);
                const iso_vec3 p = point.position;
                if (p.x != rint(p.x) || p.y != rint(p.y) || p.z != rint(p.z)) continue;
                const int ends = view.curvatures[span->first + i].extents,
                          axis = (ends >> ISO_CURVATURE_AXIS_BIT & ISO_CURVATURE_AXIS_MASK) - 1;
                int low[3] = {(int)p.x, (int)p.y, (int)p.z}, high[3];
                if (axis < 0) {
                    assert_true(point.tilt[0] == 0 && point.tilt[1] == 0);
                    uncrossed++;
                    continue;
                }
                if (low[axis] == 16 * span->brick[axis] + 16) low[axis]--;
                memcpy(high, low, sizeof high);
                high[axis]++;
                const bool below = wide_value(&grid, low[0], low[1], low[2]) < 100,
                           above = wide_value(&grid, high[0], high[1], high[2]) < 100;
                if (below == above)
                    fail_msg("ends along %d at %d %d %d, which is not crossed", axis, low[0], low[1], low[2]);
                crossed++;
            }
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    assert_true(crossed > 50 && uncrossed > 50);
}

/* How many points' discs do without 0 .. 3 quarters of their size. */
static void count_lost(const iso_grid *grid, size_t lost[4]) {
    const iso_points_opts opts = {.isovalue = 100, .primitive = ISO_PRIMITIVE_EDGE, .curvature = true};
    iso_point_set *set = test_point_set(grid, &opts);
    const iso_point_view view = iso_point_set_view(set);
    const size_t count = iso_point_view_count(&view);
    for (size_t i = 0; i < count; i++) lost[view.curvatures[i].extents >> ISO_CURVATURE_SHRINK_BIT]++;
    iso_point_set_destroy(set);
}

/* Quadrics are the surface of a ball of any size that voxels can show, and not that of noise. */
static void only_discs_far_from_their_surface_are_smaller(void **state) {
    (void)state;
    test_random random = {22};
    iso_grid grid = test_rgrid((int[3]){24, 24, 24}, ISO_UINT8);
    for (int radius = 2; radius <= 8; radius++) {
        size_t lost[4] = {0};
        for (int z = 0; z < 24; z++)
            for (int y = 0; y < 24; y++)
                for (int x = 0; x < 24; x++) {
                    const double r = sqrt((x - 12.) * (x - 12) + (y - 12.) * (y - 12) + (z - 12.) * (z - 12));
                    test_set(&grid, x, y, z, fmin(fmax(100.5 + 20 * (radius - r), 0), 255));
                }
        count_lost(&grid, lost);
        assert_true(lost[0] > 50 && lost[1] + lost[2] + lost[3] == 0);
    }
    size_t lost[4] = {0};
    test_fill(&grid, TEST_NOISE, &random);
    count_lost(&grid, lost);
    print_message("quarters lost by discs of noise: %zu %zu %zu %zu\n", lost[0], lost[1], lost[2], lost[3]);
    assert_true(lost[0] > 1000 && lost[1] + lost[2] + lost[3] > 10);
    iso_grid_destroy(&grid);
}

/* Values that are not finite, and no gradient at all, make flat points. */
static void odd_values_are_flat(void **state) {
    (void)state;
    iso_grid grid = test_rgrid((int[3]){20, 20, 20}, ISO_FLOAT32);
    for (int z = 0; z < 20; z++)
        for (int y = 0; y < 20; y++)
            for (int x = 0; x < 20; x++)
                test_set(&grid, x, y, z, 150 - 8 * sqrt((x - 9.) * (x - 9) + (y - 9.) * (y - 9)));
    test_set(&grid, 15, 9, 9, NAN);
    test_set(&grid, 3, 9, 9, INFINITY);
    const iso_points_opts opts = {.isovalue = 100, .floats = true, .curvature = true};
    iso_point_set *set = test_point_set(&grid, &opts);
    iso_point_view view = iso_point_set_view(set);
    size_t flat = 0, bent = 0;
    for (size_t k = 0; k < view.span_count; k++)
        for (uint32_t i = 0; i < view.spans[k].count; i++) {
            const iso_curvature shape = view.curvatures[view.spans[k].first + i];
            const bent_point point = get_point(&view, &view.spans[k], i);
            bool near = false;
            for (int end = 0; end < 2; end++)
                near |= fabs(point.position.x - (end ? 15 : 3)) < 3 && fabs(point.position.y - 9) < 3 &&
                        fabs(point.position.z - 9) < 3;
            const bool none = shape.uu == 0 && shape.uv == 0 && shape.vv == 0;
            assert_true(near || !none);
            flat += none;
            bent += !none;
        }
    assert_true(flat > 2 && bent > 300);
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
}

/* ---- variants */

static void check_levels(const iso_grid *grid, const iso_points_opts *opts) {
    assert_int_equal(iso_cpu_limit(ISO_CPU_GENERIC), ISO_CPU_GENERIC);
    iso_point_set *plain = test_point_set(grid, opts);
    iso_point_view a = iso_point_set_view(plain);
    assert_non_null(a.curvatures);
    for (int level = ISO_CPU_AVX2; level <= ISO_CPU_AVX512; level++) {
        if (iso_cpu_limit((iso_cpu_level)level) != (iso_cpu_level)level) continue;
        iso_point_set *other = test_point_set(grid, opts);
        iso_point_view b = iso_point_set_view(other);
        test_same_points(&a, &b);
        iso_point_set_destroy(other);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_point_set_destroy(plain);
}

static void same_bytes_for_every_instruction_set(void **state) {
    (void)state;
    static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    test_random random = {9};
    for (int round = 0; round < 16; round++) {
        iso_grid grid = test_rgrid((int[3]){70, 37, 35}, types[round % 4]);
        test_fill(&grid, round / 8 ? TEST_NOISE : TEST_SMOOTH, &random);
        check_levels(&grid, &(iso_points_opts){.isovalue = 100, .floats = round / 4 % 2, .curvature = true});
        iso_grid_destroy(&grid);
    }
    for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
        iso_grid grid = test_ball_grid(50, iso_vec3_make(24, 25, 23.3), 15, 0);
        test_stamp_ball(&grid, &(test_ball){iso_vec3_make(30, 36, 30), 4, 1});
        check_levels(&grid, &(iso_points_opts){.primitive = (iso_primitive)primitive, .curvature = true});
        iso_grid_destroy(&grid);
    }
}

/* Packed points differ from floats by their rounding only. */
static void packed_points_have_the_same_shapes(void **state) {
    (void)state;
    test_random random = {13};
    iso_grid grid = test_rgrid((int[3]){60, 40, 50}, ISO_UINT16);
    test_fill(&grid, TEST_SMOOTH, &random);
    iso_points_opts opts = {.isovalue = 100, .curvature = true};
    iso_point_set *packed = test_point_set(&grid, &opts);
    opts.floats = true;
    iso_point_set *floats = test_point_set(&grid, &opts);
    iso_point_view a = iso_point_set_view(packed), b = iso_point_set_view(floats);
    assert_int_equal(a.span_count, b.span_count);
    for (size_t k = 0; k < a.span_count; k++) {
        assert_int_equal(a.spans[k].count, b.spans[k].count);
        for (uint32_t i = 0; i < a.spans[k].count; i++) {
            bent_point p = get_point(&a, &a.spans[k], i), q = get_point(&b, &b.spans[k], i);
            assert_true(is_at_voxel(&q) || largest_difference(p.s, q.s) < 0.02);
        }
    }
    iso_point_set_destroy(packed);
    iso_point_set_destroy(floats);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_right_handed_and_unit),
        cmocka_unit_test(packing_clamps_and_rounds),
        cmocka_unit_test(curvatures_of_known_surfaces),
        cmocka_unit_test(edge_shapes_match_the_reference),
        cmocka_unit_test(points_at_voxels_have_the_ends_of_crossed_edges),
        cmocka_unit_test(only_discs_far_from_their_surface_are_smaller),
        cmocka_unit_test(odd_values_are_flat),
        cmocka_unit_test(same_bytes_for_every_instruction_set),
        cmocka_unit_test(packed_points_have_the_same_shapes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
