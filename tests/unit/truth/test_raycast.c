/* truth: the ray caster against analysis, against dense sampling, and against itself. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "extract/mesh/mesh.h"
#include "truth/raycast.h"
#include "view_support.h"

/* ---- volumes */

static iso_grid make_rgrid(int nx, int ny, int nz, iso_type type, const iso_transform *transform) {
    const iso_rgrid_desc desc = {.dims = {nx, ny, nz}, .type = type, .transform = transform};
    iso_grid grid = {0};
    iso_error error = {0};
    test_ok(iso_rgrid_create(&desc, &grid.rgrid, &error), &error);
    return grid;
}

static void set_voxel(const iso_grid *grid, int x, int y, int z, double value) {
    const iso_rgrid *rgrid = grid->rgrid;
    ptrdiff_t i = x + y * rgrid->stride_y + z * rgrid->stride_z;
    switch (rgrid->type) {
    case ISO_UINT8:
        ((uint8_t *)rgrid->data)[i] = (uint8_t)value;
        break;
    case ISO_INT16:
        ((int16_t *)rgrid->data)[i] = (int16_t)value;
        break;
    case ISO_UINT16:
        ((uint16_t *)rgrid->data)[i] = (uint16_t)value;
        break;
    default:
        ((float *)rgrid->data)[i] = (float)value;
    }
}

typedef double field_fn(int x, int y, int z, void *context);

static void fill_rgrid(const iso_grid *grid, field_fn *field, void *context) {
    const int *dims = grid->rgrid->dims;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) set_voxel(grid, x, y, z, field(x, y, z, context));
}

static double noise_field(int x, int y, int z, void *context) {
    (void)x, (void)y, (void)z;
    return uniform(context);
}

/* Few integers, so that many voxels equal the isovalue and whole cells are constant. */
static double step_field(int x, int y, int z, void *context) {
    (void)x, (void)y, (void)z;
    return floor(4 * uniform(context));
}

static double holes_field(int x, int y, int z, void *context) {
    (void)x, (void)y, (void)z;
    double value = uniform(context), kind = uniform(context);
    return kind < 0.02   ? (double)NAN
           : kind < 0.03 ? (double)INFINITY
           : kind < 0.04 ? -(double)INFINITY
                         : value;
}

/* ---- views */

/* Views that do not cut the volume. */
enum { WHOLE_VIEWS = TEST_CUT };

static iso_view make_view(const iso_grid *grid, test_view kind, int size, uint32_t *seed) {
    return test_view_make(
        grid, kind, size,
        iso_vec3_unit(iso_vec3_make(uniform(seed) - 0.5, uniform(seed) - 0.5, uniform(seed) - 0.5)));
}

static iso_gbuffer cast(const iso_grid *grid, double isovalue, const iso_view *view, iso_pool *pool) {
    iso_gbuffer gbuffer;
    iso_raycaster *caster;
    iso_error error = {0};
    test_ok(iso_gbuffer_create(view->width, view->height, &gbuffer, &error), &error);
    iso_gbuffer_clear(&gbuffer);
    test_ok(iso_raycaster_create(grid, isovalue, pool, &caster, &error), &error);
    const iso_target target = {view, &gbuffer, pool, 3, NULL};
    test_ok(iso_draw_raycast(&target, caster, &error), &error);
    iso_raycaster_destroy(caster);
    for (int i = 0; i < view->width * view->height; i++)
        assert_int_equal(gbuffer.surface[i], isfinite(gbuffer.depth[i]) ? 3 : ISO_SURFACE_NONE);
    return gbuffer;
}

/* ---- dense sampling */

/* A sample's ray in index coordinates, and the part of it that lies in the grid beyond the near plane. */
typedef struct index_ray {
    iso_vec3 origin, direction;
    double from, to;
} index_ray;

static index_ray make_ray(const iso_grid *grid, const iso_view *view, int x, int y) {
    iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    index_ray ray;
    iso_vec3 origin, direction;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    ray.origin = iso_affine_point_to_index(&affine, origin);
    ray.direction = iso_affine_vector_to_index(&affine, direction);
    const double o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
    const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
    ray.from = view->near;
    ray.to = DBL_MAX;
    for (int axis = 0; axis < 3; axis++) {
        double last = iso_grid_dims(grid)[axis] - 1;
        if (fabs(d[axis]) < 1e-14) {
            if (o[axis] < 0 || o[axis] > last) ray.to = -DBL_MAX;
            continue;
        }
        double a = -o[axis] / d[axis], b = (last - o[axis]) / d[axis];
        ray.from = fmax(ray.from, fmin(a, b));
        ray.to = fmin(ray.to, fmax(a, b));
    }
    return ray;
}

static double ray_value(const iso_grid *grid, const index_ray *ray, double t) {
    return iso_grid_sample(grid, iso_vec3_add(ray->origin, iso_vec3_scale(ray->direction, t)));
}

static const double STEP = 1.0 / 128; /* voxels */

/* The first change of state between neighbouring finite samples: in (*low, *high]. Samples within rounding of
 * the isovalue are on neither side: they only widen the interval. */
static bool first_change(const iso_grid *grid, const index_ray *ray, double isovalue, double *low,
                         double *high) {
    if (!(ray->from < ray->to)) return false;
    double length = (ray->to - ray->from) * iso_vec3_length(ray->direction);
    int steps = (int)ceil(length / STEP), before = 0; /* 0: not known */
    for (int i = 0; i <= steps; i++) {
        *high = ray->from + (ray->to - ray->from) * i / steps;
        double value = ray_value(grid, ray, *high);
        int side = !isfinite(value) ? 0 : value >= isovalue ? 1 : -1;
        if (side && fabs(value - isovalue) < 1e-12) continue;
        if (side && before && side != before) return true;
        *low = *high;
        before = side;
    }
    return false;
}

typedef struct test_verdict {
    size_t rays, hits;
    size_t missed; /* the ray caster has no hit, or a later one */
    size_t extra;  /* it has an earlier one: a pair of crossings between two samples, if it is one */
    size_t wrong;  /* an earlier one where the field is not at the isovalue, or does not cross it */
} test_verdict;

/* Whether the field goes through the isovalue near t (or at least reaches it): what a hit must be. The depth
 * is a float, so a neighbourhood of a few of its steps is searched. */
static bool is_crossing(const iso_grid *grid, const index_ray *ray, double isovalue, double t) {
    double reach = 1e-5 / iso_vec3_length(ray->direction) + 4e-7 * fabs(t);
    int above = 0, below = 0;
    for (int i = -64; i <= 64; i++) {
        double at = fmin(fmax(t + reach * i / 64, ray->from), ray->to);
        double value = ray_value(grid, ray, at);
        above |= value >= isovalue - 1e-5;
        below |= value < isovalue + 1e-5;
    }
    return above && below;
}

static void judge(const iso_grid *grid, double isovalue, const iso_view *view, test_verdict *verdict) {
    iso_gbuffer gbuffer = cast(grid, isovalue, view, NULL);
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            index_ray ray = make_ray(grid, view, x, y);
            double low = 0, high = 0, depth = (double)gbuffer.depth[y * view->width + x];
            bool expected = first_change(grid, &ray, isovalue, &low, &high), hit = isfinite(depth);
            double slack = 1e-6 * fabs(depth) + 1e-6; /* the depth is a float */
            verdict->rays++;
            verdict->hits += hit;
            if (expected && (!hit || depth > high + slack))
                verdict->missed++;
            else if (hit && (!expected || depth < low - slack))
                verdict->extra++;
            if (hit && !is_crossing(grid, &ray, isovalue, depth)) verdict->wrong++;
        }
    iso_gbuffer_free(&gbuffer);
}

static void check_verdict(const test_verdict *verdict, const char *name, double most_extra) {
    print_message("    %s: %zu rays, %zu hits, %zu missed, %zu between samples, %zu wrong\n", name,
                  verdict->rays, verdict->hits, verdict->missed, verdict->extra, verdict->wrong);
    assert_true(verdict->hits > verdict->rays / 10);
    assert_int_equal(verdict->missed, 0);
    assert_int_equal(verdict->wrong, 0);
    assert_true((double)verdict->extra <= most_extra * (double)verdict->hits);
}

static void noise_agrees_with_dense_sampling(void **state) {
    (void)state;
    uint32_t seed = 11;
    for (int kind = 0; kind < TEST_TRANSFORMS; kind++) {
        test_verdict verdict = {0};
        iso_transform transform = test_transform(kind);
        for (int view_kind = 0; view_kind < WHOLE_VIEWS; view_kind++) {
            iso_grid grid = make_rgrid(9, 7, 8, ISO_FLOAT32, &transform);
            fill_rgrid(&grid, noise_field, &seed);
            iso_view view = make_view(&grid, view_kind, 40, &seed);
            judge(&grid, 0.6, &view, &verdict);
            iso_grid_destroy(&grid);
        }
        check_verdict(&verdict, "noise", 0.005);
    }
}

/* Integers 0 .. 3 with the isovalue at, between and outside them, in every type. */
static void every_type_agrees_with_dense_sampling(void **state) {
    (void)state;
    uint32_t seed = 12;
    static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    for (int type = 0; type < 4; type++) {
        test_verdict between = {0}, at = {0};
        for (int view_kind = 0; view_kind < WHOLE_VIEWS; view_kind++) {
            iso_transform transform = test_transform(view_kind);
            iso_grid grid = make_rgrid(6, 9, 7, types[type], &transform);
            fill_rgrid(&grid, step_field, &seed);
            iso_view view = make_view(&grid, view_kind, 30, &seed);
            judge(&grid, 2, &view, &at);
            judge(&grid, 2.3, &view, &between);
            iso_grid_destroy(&grid);
        }
        check_verdict(&between, iso_type_name(types[type]), 0.005);
        /* faces and edges that are at the isovalue are touched, above all those in the border */
        check_verdict(&at, "isovalue on voxels", 0.1);
    }
}

static void cells_with_nan_are_empty(void **state) {
    (void)state;
    uint32_t seed = 13;
    test_verdict verdict = {0};
    for (int view_kind = 0; view_kind < WHOLE_VIEWS; view_kind++) {
        iso_transform transform = test_transform(view_kind);
        iso_grid grid = make_rgrid(18, 9, 8, ISO_FLOAT32, &transform);
        fill_rgrid(&grid, holes_field, &seed);
        iso_view view = make_view(&grid, view_kind, 40, &seed);
        judge(&grid, 0.7, &view, &verdict);
        iso_gbuffer gbuffer = cast(&grid, 0.7, &view, NULL);
        for (int i = 0; i < 40 * 40; i++)
            for (int axis = 0; axis < 3 && isfinite(gbuffer.depth[i]); axis++)
                assert_true(isfinite(gbuffer.normal[axis][i]));
        iso_gbuffer_free(&gbuffer);
        iso_grid_destroy(&grid);
    }
    /* before a border of empty cells the last part of a step is not sampled */
    check_verdict(&verdict, "with NaN and infinities", 0.015);
}

/* ---- analysis */

typedef struct test_ball {
    iso_vec3 centre; /* world */
    double radius;
    iso_affine affine;
    double sign; /* +1: a distance; -1: high inside */
} test_ball;

static double ball_field(int x, int y, int z, void *context) {
    const test_ball *b = context;
    iso_vec3 p = iso_affine_point(&b->affine, iso_vec3_make(x, y, z));
    return b->sign * (iso_vec3_length(iso_vec3_sub(p, b->centre)) - b->radius);
}

/* A world sphere under every transform and view, as density and as level set: depth and normal of the
 * analytic one up to the trilinear field's own error, about h^2 / (4 R) for voxels of size h. */
static void a_sphere_is_a_sphere(void **state) {
    (void)state;
    uint32_t seed = 3;
    for (int round = 0; round < 2 * TEST_TRANSFORMS * 2; round++) {
        iso_transform transform = test_transform(round % TEST_TRANSFORMS);
        iso_grid grid = make_rgrid(58, 40, 44, ISO_FLOAT32, &transform);
        iso_affine affine = iso_transform_affine(&transform);
        test_ball b = {iso_affine_point(&affine, iso_vec3_make(28.3, 19.1, 21.7)), 16, affine,
                       round / TEST_TRANSFORMS % 2 ? 1 : -1};
        grid.rgrid->level_set = b.sign > 0;
        fill_rgrid(&grid, ball_field, &b);
        iso_view view = make_view(&grid, round % 2 ? TEST_PERSPECTIVE : TEST_ORTHOGRAPHIC, 64, &seed);
        iso_gbuffer gbuffer = cast(&grid, 0, &view, NULL);
        size_t hits = 0;
        for (int y = 0; y < 64; y++)
            for (int x = 0; x < 64; x++) {
                iso_vec3 o, d;
                iso_view_ray(&view, x + 0.5, y + 0.5, &o, &d);
                iso_vec3 to = iso_vec3_sub(o, b.centre);
                double dd = iso_vec3_dot(d, d), half = iso_vec3_dot(to, d);
                double nearest2 = iso_vec3_dot(to, to) - half * half / dd;
                double root2 = (b.radius * b.radius - nearest2) / dd,
                       depth = (double)gbuffer.depth[64 * y + x];
                if (nearest2 < 0.9 * b.radius * b.radius) {
                    hits++;
                    double wanted = -half / dd - sqrt(root2);
                    if (!(fabs(depth - wanted) < 0.2)) fail_msg("depth %g, wanted %g", depth, wanted);
                    iso_vec3 world = iso_vec3_sub(iso_vec3_add(o, iso_vec3_scale(d, wanted)), b.centre);
                    iso_vec3 normal = iso_view_vector(&view, iso_vec3_unit(world));
                    iso_vec3 got = iso_gbuffer_normal(&gbuffer, (size_t)(64 * y + x));
                    double cosine = iso_vec3_dot(normal, got);
                    if (!(cosine > 0.999)) fail_msg("normal off by %g degrees", acos(cosine) * 180 / ISO_PI);
                    assert_true(fabs(iso_vec3_length(got) - 1) < 1e-6);
                } else if (nearest2 > 1.05 * b.radius * b.radius)
                    assert_true(depth == (double)INFINITY);
            }
        assert_true(hits > 300);
        iso_gbuffer_free(&gbuffer);
        iso_grid_destroy(&grid);
    }
}

/* A product of three linear functions is its own trilinear interpolant: the depth is exact to a float. */
static double saddle_field(int x, int y, int z, void *context) {
    (void)context;
    return (x - 3.5) * (y - 4.25) * (z - 2.75);
}

static void depth_is_exact_to_a_float(void **state) {
    (void)state;
    uint32_t seed = 21;
    iso_transform transform = test_transform(1);
    iso_grid grid = make_rgrid(9, 10, 8, ISO_FLOAT32, &transform);
    fill_rgrid(&grid, saddle_field, NULL);
    iso_view view = make_view(&grid, TEST_PERSPECTIVE, 64, &seed);
    iso_gbuffer gbuffer = cast(&grid, 1.5, &view, NULL);
    double worst = 0;
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 64; x++) {
            index_ray ray = make_ray(&grid, &view, x, y);
            double t = (double)gbuffer.depth[64 * y + x], step = 1e-6;
            if (!isfinite(t)) continue;
            iso_vec3 p = iso_vec3_add(ray.origin, iso_vec3_scale(ray.direction, t));
            iso_vec3 q = iso_vec3_add(ray.origin, iso_vec3_scale(ray.direction, t + step));
            double value = (p.x - 3.5) * (p.y - 4.25) * (p.z - 2.75) - 1.5;
            double slope = ((q.x - 3.5) * (q.y - 4.25) * (q.z - 2.75) - 1.5 - value) / step;
            /* grazing rays: the distance is bounded by the second derivative, not by the slope */
            if (fabs(slope) > 0.5) worst = fmax(worst, fabs(value / slope) / t);
        }
    print_message("    worst relative depth error %.2g\n", worst);
    assert_true(worst > 0 && worst < 1e-7);
    iso_gbuffer_free(&gbuffer);
    iso_grid_destroy(&grid);
}

/* ---- planes of voxels */

typedef struct test_wall {
    int axis, plane;
    bool thin; /* 1 on the plane and 0 elsewhere, instead of rising by 1 a voxel */
} test_wall;

static double wall_field(int x, int y, int z, void *context) {
    const test_wall *w = context;
    int at = w->axis == 0 ? x : w->axis == 1 ? y : z;
    return w->thin ? at == w->plane : fmax(0, at - w->plane + 1);
}

/* A wall exactly in a plane of voxels, seen along its axis with samples on voxel planes and between:
 * every ray of the closed box hits, at exactly that depth. A thin wall has no gradient there: the normal
 * is minus the ray. */
static void a_wall_in_a_voxel_plane_has_no_holes(void **state) {
    (void)state;
    enum { N = 40, SAMPLES = 2 * N - 1 }; /* most bricks are skipped */
    for (int round = 0; round < 12; round++) {
        test_wall w = {round % 3, 5 + 31 * (round % 2), round >= 6};
        bool up = round / 3 % 2;
        iso_transform identity = iso_transform_identity();
        iso_grid grid = make_rgrid(N, N, N, ISO_UINT8, &identity);
        fill_rgrid(&grid, wall_field, &w);
        iso_view view = test_axis_view(w.axis, up, 0.5, 0, SAMPLES);
        iso_gbuffer gbuffer = cast(&grid, 1, &view, NULL);
        for (int i = 0; i < SAMPLES * SAMPLES; i++) {
            double wanted = up ? w.plane : -w.plane;
            if (gbuffer.depth[i] != (float)wanted)
                fail_msg("round %d sample %d: depth %g, wanted %g", round, i, (double)gbuffer.depth[i],
                         wanted);
            float facing = w.thin || up ? -1 : 1; /* low values lie before the wall, or behind it */
            assert_true(gbuffer.normal[0][i] == 0 && gbuffer.normal[1][i] == 0 &&
                        gbuffer.normal[2][i] == facing);
        }
        iso_gbuffer_free(&gbuffer);
        iso_grid_destroy(&grid);
    }
}

/* A surface in the outermost plane of voxels is seen by every ray that comes in through it. */
static void a_wall_in_the_border_is_seen(void **state) {
    (void)state;
    uint32_t seed = 71;
    size_t through = 0;
    for (int round = 0; round < 36; round++) {
        test_wall w = {round % 3, round / 3 % 2 * 18, true};
        iso_transform transform = test_transform(round / 6 % TEST_TRANSFORMS);
        iso_grid grid = make_rgrid(19, 19, 19, ISO_UINT8, &transform);
        fill_rgrid(&grid, wall_field, &w);
        iso_view view = make_view(&grid, round / 18 ? TEST_PERSPECTIVE : TEST_ORTHOGRAPHIC, 30, &seed);
        iso_gbuffer gbuffer = cast(&grid, 1, &view, NULL);
        for (int i = 0; i < 900; i++) {
            index_ray ray = make_ray(&grid, &view, i % 30, i / 30);
            iso_vec3 p = iso_vec3_add(ray.origin, iso_vec3_scale(ray.direction, ray.from));
            double at = w.axis == 0 ? p.x : w.axis == 1 ? p.y : p.z;
            if (!(ray.to - ray.from > 1e-6) || fabs(at - w.plane) > 1e-9) continue;
            through++;
            assert_true(gbuffer.depth[i] == (float)ray.from);
        }
        iso_gbuffer_free(&gbuffer);
        iso_grid_destroy(&grid);
    }
    assert_true(through > 2000);
}

/* Rays along diagonals through voxels, edges and faces, and a fan of rays from a voxel: dense sampling
 * finds nothing that they miss. */
static void rays_through_edges_and_corners_do_not_leak(void **state) {
    (void)state;
    uint32_t seed = 77;
    test_verdict between = {0}, at = {0};
    for (int round = 0; round < 4; round++) {
        iso_transform identity = iso_transform_identity();
        iso_grid grid = make_rgrid(19, 19, 19, ISO_UINT8, &identity);
        fill_rgrid(&grid, step_field, &seed);
        iso_view view = test_axis_view(2, true, 0.5, 0, 37);
        if (round == 1) { /* along (1, 0, 1): a shear of the rows keeps the samples on voxels */
            view.rotation[6] = 1;
            view.rotation[8] = 1;
        } else if (round == 2) {
            view.rotation[6] = view.rotation[7] = view.rotation[8] = 1;
        } else if (round == 3) {
            view.orthographic = false;
            view.near = 1e-3;
            view.eye = (iso_vec3){9, 9, -4};
            view.focal = 16;
            view.cx = view.cy = 18.5;
        }
        judge(&grid, 2.3, &view, &between);
        judge(&grid, 2, &view, &at);
        iso_grid_destroy(&grid);
    }
    check_verdict(&between, "lattice rays", 0.005);
    /* these rays often touch an edge or a face that is at the isovalue without passing it: hits, and real
     */
    check_verdict(&at, "lattice rays, isovalue on voxels", 0.3);
}

/* ---- extraction sees the same corners */

static double ties_field(int x, int y, int z, void *context) {
    (void)x, (void)y, (void)z;
    return 55 + floor(4 * uniform(context));
}

/* 0.7f is below 0.7, 0.1f above 0.1. */
static double floats_field(int x, int y, int z, void *context) {
    static const float values[] = {0.7f, 0.9f, 0.1f, 0.05f};
    (void)x, (void)y, (void)z;
    return (double)values[(int)(4 * uniform(context))];
}

/* Along lines of voxels the first hit is the first vertex of the mesh, for isovalues that are voxel values
 * after rescaling (up to rounding), between two floats, and others. */
static void hits_on_edges_are_mesh_vertices(void **state) {
    (void)state;
    enum { N = 22 };
    static const double scales[] = {0.1, 0.3, 0.7, 1e-3}, floats[] = {0.7, 0.1};
    uint32_t seed = 31;
    for (int round = 0; round < 14; round++) {
        iso_transform identity = iso_transform_identity();
        bool is_float = round >= 12;
        iso_grid grid = make_rgrid(N, N, N, is_float ? ISO_FLOAT32 : ISO_INT16, &identity);
        if (!is_float) {
            grid.rgrid->scale = scales[round % 4];
            grid.rgrid->offset = -1.7;
        }
        fill_rgrid(&grid, is_float ? floats_field : ties_field, &seed);
        double isovalue = is_float ? floats[round % 2] : (56 + round / 4 * 0.5) * scales[round % 4] - 1.7;
        iso_mesh_opts opts = {.isovalue = isovalue};
        iso_mesh_set *set;
        iso_error error = {0};
        test_ok(iso_mesh_set_create(&grid, &opts, &set, &error), &error);
        test_ok(iso_mesh_set_update(set, &error), &error);
        iso_mesh_view mesh = iso_mesh_set_view(set);
        float first[N][N];
        for (int i = 0; i < N * N; i++) first[i / N][i % N] = INFINITY;
        for (size_t s = 0; s < mesh.span_count; s++)
            for (size_t i = 0; i < mesh.spans[s].vertex_count; i++) {
                size_t vertex = mesh.spans[s].first_vertex + i;
                int voxel[3];
                if (iso_edge_key_split(mesh.keys[vertex], voxel) != 2) continue; /* not on an edge along z */
                float p[3];
                for (int axis = 0; axis < 3; axis++)
                    p[axis] = mesh.vertices[vertex].position[axis] + 16 * (float)mesh.spans[s].brick[axis];
                float *best = &first[(int)p[1]][(int)p[0]];
                if (p[2] < *best) *best = p[2];
            }
        iso_view view = test_axis_view(2, true, 1, 0, N);
        iso_gbuffer gbuffer = cast(&grid, isovalue, &view, NULL);
        for (int i = 0; i < N * N; i++)
            if (!(gbuffer.depth[i] == first[i / N][i % N] ||
                  fabsf(gbuffer.depth[i] - first[i / N][i % N]) < 1e-5f))
                fail_msg("round %d line %d: %.9g, vertex %.9g", round, i, (double)gbuffer.depth[i],
                         (double)first[i / N][i % N]);
        iso_gbuffer_free(&gbuffer);
        iso_mesh_set_destroy(set);
        iso_grid_destroy(&grid);
    }
}

/* ---- hgrids, crops, threads */

static double blob(int x, int y, int z) {
    double a = iso_vec3_length(iso_vec3_make(x - 25.2, y - 20.1, z - 30.3)) - 13.2;
    double b = iso_vec3_length(iso_vec3_make(x - 50.5, y - 33.3, z - 20.2)) - 9.1;
    return fmin(fmax(fmin(a, b), -3), 3);
}

/* Cells without the surface are empty, so that rays cross all three kinds of cells. */
static iso_grid make_hgrid(const iso_transform *transform) {
    const int dims[3] = {70, 45, 61};
    iso_grid grid = {0};
    iso_error error = {0};
    test_ok(iso_hgrid_create(dims, 3, transform, &grid.hgrid, &error), &error);
    for (int cz = 0; cz < grid.hgrid->cells[2]; cz++)
        for (int cy = 0; cy < grid.hgrid->cells[1]; cy++)
            for (int cx = 0; cx < grid.hgrid->cells[0]; cx++) {
                float *brick;
                test_ok(iso_hgrid_split(grid.hgrid, cx, cy, cz, &brick, &error), &error);
                for (int i = 0; i < ISO_BRICK_VOXELS; i++)
                    brick[i] = (float)blob(16 * cx + i % 16, 16 * cy + i / 16 % 16, 16 * cz + i / 256);
            }
    iso_hgrid_prune(grid.hgrid);
    return grid;
}

static double hgrid_field(int x, int y, int z, void *context) {
    return (double)iso_hgrid_at(context, x, y, z);
}

static void an_hgrid_looks_like_its_dense_twin(void **state) {
    (void)state;
    uint32_t seed = 41;
    for (int kind = 0; kind < TEST_TRANSFORMS; kind++) {
        iso_transform transform = test_transform(kind);
        iso_grid sparse = make_hgrid(&transform);
        size_t cells = iso_hgrid_cell_count(sparse.hgrid);
        assert_true(iso_hgrid_brick_count(sparse.hgrid) < cells);
        iso_grid dense = make_rgrid(70, 45, 61, ISO_FLOAT32, &transform);
        dense.rgrid->level_set = 1;
        dense.rgrid->scale = transform.spacing[0]; /* distances in voxels, as the hgrid stores them */
        fill_rgrid(&dense, hgrid_field, sparse.hgrid);
        for (int view_kind = 0; view_kind < WHOLE_VIEWS; view_kind++) {
            iso_view view = make_view(&sparse, view_kind, 90, &seed);
            for (double isovalue = -1; isovalue <= 1; isovalue += 0.75) {
                iso_gbuffer a = cast(&sparse, isovalue, &view, NULL);
                iso_gbuffer b = cast(&dense, isovalue, &view, NULL);
                assert_true(test_covered(&a) > 300);
                test_same_pictures(&a, &b);
                iso_gbuffer_free(&a);
                iso_gbuffer_free(&b);
            }
        }
        iso_grid_destroy(&sparse);
        iso_grid_destroy(&dense);
    }
}

/* A crop is a view with strides that are not its own. */
static void a_crop_looks_like_its_copy(void **state) {
    (void)state;
    uint32_t seed = 42;
    static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    const int lo[3] = {3, 17, 2}, hi[3] = {30, 29, 27};
    for (int type = 0; type < 4; type++) {
        iso_transform identity = iso_transform_identity();
        iso_grid grid = make_rgrid(40, 33, 31, types[type], &identity);
        fill_rgrid(&grid, step_field, &seed);
        iso_grid copy = make_rgrid(28, 13, 26, types[type], &identity);
        for (int z = 0; z < 26; z++)
            for (int y = 0; y < 13; y++)
                for (int x = 0; x < 28; x++)
                    set_voxel(&copy, x, y, z, (double)iso_grid_at(&grid, x + lo[0], y + lo[1], z + lo[2]));
        iso_error error = {0};
        test_ok(iso_rgrid_crop(grid.rgrid, lo, hi, &error), &error);
        copy.rgrid->transform = grid.rgrid->transform;
        iso_view view = make_view(&grid, TEST_PERSPECTIVE, 50, &seed);
        iso_gbuffer a = cast(&grid, 2.5, &view, NULL), b = cast(&copy, 2.5, &view, NULL);
        assert_true(test_covered(&a) > 500);
        test_same_pictures(&a, &b);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        iso_grid_destroy(&grid);
        iso_grid_destroy(&copy);
    }
}

static void threads_do_not_matter(void **state) {
    (void)state;
    uint32_t seed = 43;
    iso_transform transform = test_transform(1);
    iso_grid grid = make_hgrid(&transform);
    iso_view view = make_view(&grid, TEST_PERSPECTIVE, 150, &seed);
    iso_gbuffer one = cast(&grid, 0, &view, NULL);
    assert_true(test_covered(&one) > 1000);
    static const int threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        iso_pool *pool;
        iso_error error = {0};
        test_ok(iso_pool_create(threads[i], &pool, &error), &error);
        iso_gbuffer many = cast(&grid, 0, &view, pool);
        test_same_pictures(&one, &many);
        iso_gbuffer_free(&many);
        iso_pool_destroy(pool);
    }
    iso_gbuffer_free(&one);
    iso_grid_destroy(&grid);
}

/* ---- near plane, depth test, nothing to see */

static double slab_field(int x, int y, int z, void *context) {
    (void)x, (void)y, (void)context;
    return z >= 4 && z <= 9;
}

static void nothing_before_the_near_plane(void **state) {
    (void)state;
    iso_transform identity = iso_transform_identity();
    iso_grid grid = make_rgrid(12, 12, 16, ISO_UINT8, &identity);
    fill_rgrid(&grid, slab_field, NULL);
    iso_view view = test_axis_view(2, true, 1, 0.5, 11);
    /* before, on and behind the front face at 3.5, in the slab, and behind its back at 9.5 */
    static const double near_planes[] = {-DBL_MAX, 3.25, 3.5, 3.75, 6, 9.25, 9.75, 100};
    static const double depths[] = {3.5, 3.5, 9.5, 9.5, 9.5, 9.5, INFINITY, INFINITY};
    for (int i = 0; i < 8; i++) {
        view.near = near_planes[i];
        iso_gbuffer gbuffer = cast(&grid, 0.5, &view, NULL);
        for (int sample = 0; sample < 121; sample++)
            if ((double)gbuffer.depth[sample] != depths[i] &&
                !(i == 2 && gbuffer.depth[sample] == 3.5f)) /* touching the plane may count either way */
                fail_msg("near %g: depth %g, wanted %g", near_planes[i], (double)gbuffer.depth[sample],
                         depths[i]);
        iso_gbuffer_free(&gbuffer);
    }
    iso_grid_destroy(&grid);
}

static void nearer_samples_stay(void **state) {
    (void)state;
    iso_transform identity = iso_transform_identity();
    iso_grid grid = make_rgrid(12, 12, 16, ISO_UINT8, &identity);
    fill_rgrid(&grid, slab_field, NULL);
    iso_view view = test_axis_view(2, true, 1, 0.5, 11);
    iso_gbuffer gbuffer;
    iso_raycaster *caster;
    iso_error error = {0};
    test_ok(iso_gbuffer_create(11, 11, &gbuffer, &error), &error);
    iso_gbuffer_clear(&gbuffer);
    static const float before[] = {3, 3.5f, 4, INFINITY};
    for (int i = 0; i < 121; i++) {
        gbuffer.depth[i] = before[i % 4];
        gbuffer.surface[i] = 9;
    }
    test_ok(iso_raycaster_create(&grid, 0.5, NULL, &caster, &error), &error);
    const iso_target target = {&view, &gbuffer, NULL, 5, NULL};
    test_ok(iso_draw_raycast(&target, caster, &error), &error);
    for (int i = 0; i < 121; i++) {
        assert_true(gbuffer.depth[i] == (i % 4 < 2 ? before[i % 4] : 3.5f));
        assert_int_equal(gbuffer.surface[i], i % 4 < 2 ? 9 : 5);
    }
    iso_raycaster_destroy(caster);
    iso_gbuffer_free(&gbuffer);
    iso_grid_destroy(&grid);
}

static double constant_field(int x, int y, int z, void *context) {
    (void)x, (void)y, (void)z;
    return *(double *)context;
}

static void nothing_to_see(void **state) {
    (void)state;
    static const int dims[][3] = {{20, 20, 20}, {1, 20, 20}, {20, 1, 1}, {1, 1, 1}};
    double constants[] = {3, (double)NAN};
    uint32_t seed = 51;
    for (int d = 0; d < 4; d++)
        for (int kind = 0; kind < 3; kind++) {
            if (d == 0 && kind == 2) continue; /* noise has a surface where there are cells */
            iso_transform identity = iso_transform_identity();
            iso_grid grid = make_rgrid(dims[d][0], dims[d][1], dims[d][2], ISO_FLOAT32, &identity);
            if (kind < 2) fill_rgrid(&grid, constant_field, &constants[kind]);
            if (kind == 2) fill_rgrid(&grid, noise_field, &seed);
            iso_view view = test_axis_view(2, true, 1, 0, 20);
            iso_gbuffer gbuffer = cast(&grid, kind == 2 ? 0.5 : 3, &view, NULL);
            assert_int_equal(test_covered(&gbuffer), 0);
            iso_gbuffer_free(&gbuffer);
            iso_grid_destroy(&grid);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_agrees_with_dense_sampling),
        cmocka_unit_test(every_type_agrees_with_dense_sampling),
        cmocka_unit_test(cells_with_nan_are_empty),
        cmocka_unit_test(a_sphere_is_a_sphere),
        cmocka_unit_test(depth_is_exact_to_a_float),
        cmocka_unit_test(a_wall_in_a_voxel_plane_has_no_holes),
        cmocka_unit_test(a_wall_in_the_border_is_seen),
        cmocka_unit_test(rays_through_edges_and_corners_do_not_leak),
        cmocka_unit_test(hits_on_edges_are_mesh_vertices),
        cmocka_unit_test(an_hgrid_looks_like_its_dense_twin),
        cmocka_unit_test(a_crop_looks_like_its_copy),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(nothing_before_the_near_plane),
        cmocka_unit_test(nearer_samples_stay),
        cmocka_unit_test(nothing_to_see),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
