#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "render/raster/raster.h"
#include "scene_support.h"

static iso_view random_view(uint32_t *seed, int width, int height, bool orthographic) {
    iso_camera camera = {.view_up = {0.1, 0.2, 1}, .view_angle = 40, .parallel_scale = 9};
    camera.orthographic = orthographic;
    camera.position = (iso_vec3){60 * uniform(seed) - 30, -40, 60 * uniform(seed) - 30};
    camera.focal_point = (iso_vec3){uniform(seed), uniform(seed), uniform(seed)};
    return iso_view_make(&camera, width, height);
}

static iso_transform random_transform(uint32_t *seed) {
    iso_transform transform = iso_transform_identity();
    for (int axis = 0; axis < 3; axis++) {
        transform.spacing[axis] = 0.3 + uniform(seed);
        transform.origin[axis] = -16 * transform.spacing[axis] + uniform(seed);
    }
    double sine = sin(0.4), cosine = cos(0.4);
    transform.direction[0] = transform.direction[4] = cosine;
    transform.direction[1] = -sine;
    transform.direction[3] = sine;
    return transform;
}

static iso_gbuffer clear_gbuffer(int width, int height) {
    iso_gbuffer gbuffer;
    assert_int_equal(iso_gbuffer_create(width, height, &gbuffer, NULL), ISO_OK);
    for (int axis = 0; axis < 3; axis++)
        memset(gbuffer.normal[axis], 0, sizeof(float) * (size_t)width * (size_t)height);
    iso_gbuffer_clear(&gbuffer);
    return gbuffer;
}

static void same_gbuffers(const iso_gbuffer *a, const iso_gbuffer *b, size_t a_row, int height) {
    size_t start = a_row * (size_t)a->width, samples = (size_t)a->width * (size_t)height;
    assert_memory_equal(a->depth + start, b->depth, samples * sizeof(float));
    assert_memory_equal(a->surface + start, b->surface, samples);
    for (size_t i = 0; i < samples; i++)
        if (b->surface[i] != ISO_SURFACE_NONE)
            for (int axis = 0; axis < 3; axis++)
                assert_memory_equal(&a->normal[axis][start + i], &b->normal[axis][i], sizeof(float));
}

enum { MOST = 4000 };

/* A cloud with room for its arrays. */
typedef struct cloud {
    iso_surfel surfels[MOST];
    iso_point packed[MOST];
    float radii[MOST];
    iso_point_span spans[64];
    iso_point_view view;
} cloud;

/* Random points in 3 x 3 x 3 bricks around brick (0, 0, 0) .. (2, 2, 2). */
static void make_cloud(cloud *c, uint32_t *seed, uint32_t per_span, bool packed) {
    size_t count = 0, spans = 0;
    for (int brick = 0; brick < 27; brick++) {
        iso_point_span span = {.brick = {brick % 3, brick / 3 % 3, brick / 9}, per_span, count};
        c->spans[spans++] = span;
        for (uint32_t i = 0; i < per_span; i++, count++) {
            iso_surfel *s = &c->surfels[count];
            for (int axis = 0; axis < 3; axis++) {
                s->position[axis] = (float)(-1.9 + 19.8 * uniform(seed));
                s->normal[axis] = (float)(uniform(seed) - 0.5);
            }
            c->packed[count] = iso_point_pack(s);
            c->radii[count] = (float)(0.2 + 0.8 * uniform(seed));
            if (packed) *s = iso_point_unpack(c->packed[count]);
        }
    }
    c->view = (iso_point_view){.packed = packed ? c->packed : NULL,
                               .surfels = packed ? NULL : c->surfels,
                               .spans = c->spans,
                               .span_count = spans,
                               .transform = random_transform(seed),
                               .radius = 0.5};
}

static iso_status draw_points(const iso_view *view, const iso_point_view *points, iso_gbuffer *gbuffer) {
    iso_target target = {.view = view, .gbuffer = gbuffer};
    return iso_draw_points(&target, points, NULL);
}

/* What the header promises of one pixel, point by point. *sure is cleared when rounding could decide. */
static long nearest_point(const iso_view *view, const cloud *c, double px, double py, bool *sure) {
    iso_affine affine = iso_transform_affine(&c->view.transform);
    double nearest = INFINITY;
    long winner = -1;
    for (size_t s = 0; s < c->view.span_count; s++)
        for (size_t i = c->spans[s].first; i < c->spans[s].first + c->spans[s].count; i++) {
            const float *p = c->surfels[i].position;
            const int32_t *b = c->spans[s].brick;
            iso_vec3 index = {16.0 * b[0] + p[0], 16.0 * b[1] + p[1], 16.0 * b[2] + p[2]};
            iso_vec3 q = iso_view_point(view, iso_affine_point(&affine, index));
            if (q.z < view->near) continue;
            double scale = view->orthographic ? view->focal : view->focal / q.z;
            double x = view->cx + q.x * scale, y = view->cy + q.y * scale;
            double radius = (c->view.radii ? c->view.radii[i] : c->view.radius) * scale;
            double edge = hypot(px - x, py - y) - radius;
            double inside = fmax(fabs(px - x), fabs(py - y)) - 0.5;
            double cover = fmin(edge, inside);
            if (fabs(cover) < 1e-4) *sure = false;
            if (cover > 0) continue;
            if (fabs(q.z - nearest) < 1e-5 * q.z) *sure = false;
            if (q.z < nearest) {
                nearest = q.z;
                winner = (long)i;
            }
        }
    return winner;
}

static void check_cloud(const iso_view *view, const cloud *c) {
    iso_gbuffer g = clear_gbuffer(view->width, view->height);
    assert_int_equal(draw_points(view, &c->view, &g), ISO_OK);
    iso_affine affine = iso_transform_affine(&c->view.transform);
    int unsure = 0, hit = 0, total = view->width * view->height;
    for (int i = 0; i < total; i++) {
        bool sure = true;
        long point = nearest_point(view, c, i % view->width + 0.5, i / view->width + 0.5, &sure);
        unsure += !sure;
        hit += point >= 0;
        if (!sure) continue;
        if ((point >= 0) != (g.surface[i] == 0)) fail_msg("pixel %d: point %ld", i, point);
        if (point < 0) {
            assert_true(isinf(g.depth[i]));
            continue;
        }
        const float *n = c->surfels[point].normal;
        iso_vec3 normal = iso_affine_normal(&affine, iso_vec3_make(n[0], n[1], n[2]));
        normal = iso_view_vector(view, normal);
        near(g.normal[0][i], normal.x, 1e-5);
        near(g.normal[1][i], normal.y, 1e-5);
        near(g.normal[2][i], normal.z, 1e-5);
    }
    assert_true(hit > total / 20 && hit < total - total / 20);
    assert_true(unsure < total / 20);
    iso_gbuffer_free(&g);
}

static void discs_cover_what_they_should(void **state) {
    (void)state;
    static cloud c;
    uint32_t seed = 1;
    for (int round = 0; round < 12; round++) {
        make_cloud(&c, &seed, round % 3 == 2 ? 40 : 80, round % 2);
        if (round % 4 >= 2) c.view.radii = c.radii;
        if (round >= 8) c.view.radius = 0.05; /* below a pixel */
        iso_view view = random_view(&seed, 60, 46, round % 3 == 1);
        check_cloud(&view, &c);
    }
}

/* The eye among the points: some behind it, some with discs larger than the picture. */
static void the_eye_may_be_inside(void **state) {
    (void)state;
    static cloud c;
    uint32_t seed = 9;
    for (int round = 0; round < 6; round++) {
        make_cloud(&c, &seed, 60, round % 2);
        c.view.radius = 0.7;
        iso_view view = random_view(&seed, 60, 50, false);
        iso_affine affine = iso_transform_affine(&c.view.transform);
        view.eye = iso_affine_point(&affine, iso_vec3_make(24, 24, 24));
        view.near = 6;
        check_cloud(&view, &c);
    }
}

static iso_point_view few_points(const iso_surfel *surfels, iso_point_span *span, uint32_t count) {
    *span = (iso_point_span){.count = count};
    return (iso_point_view){.surfels = surfels,
                            .spans = span,
                            .span_count = 1,
                            .transform = iso_transform_identity(),
                            .radius = sqrt(0.5)};
}

/* Eq. 3 and 4: D = sqrt 2 H / h, h = 2 z tan(theta / 2), by the depth z and not by the distance. */
static void discs_have_the_paper_s_size(void **state) {
    (void)state;
    const double theta = 50 * ISO_PI / 180;
    const int height = 801;
    iso_view view = test_plain_view(height, height, false, height / 2.0 / tan(theta / 2));
    for (float z = 8; z < 80; z *= 1.7f)
        for (int side = 0; side < 2; side++) {
            const iso_surfel one = {{side * 0.35f * z, 0, z}, {0, 0, 1}};
            iso_point_span span;
            iso_point_view points = few_points(&one, &span, 1);
            iso_gbuffer g = clear_gbuffer(height, height);
            assert_int_equal(draw_points(&view, &points, &g), ISO_OK);
            double area = 0, wanted = sqrt(2) * height / (z * 2 * tan(theta / 2));
            for (int i = 0; i < height * height; i++) area += g.surface[i] == 0;
            near(2 * sqrt(area / ISO_PI), wanted, 0.03 * wanted);
            iso_gbuffer_free(&g);
        }
}

static void ties_go_to_the_first(void **state) {
    (void)state;
    const iso_surfel same[3] = {
        {{0, 0, 5}, {1, 0, 0}}, {{0.25f, 0, 5}, {0, 1, 0}}, {{0, 0.25f, 4}, {0, 0, 1}}};
    iso_view view = test_plain_view(32, 32, true, 8);
    iso_gbuffer g = clear_gbuffer(32, 32);
    iso_point_span span;
    iso_point_view points = few_points(same, &span, 2);
    iso_target first = {.view = &view, .gbuffer = &g, .surface = 3};
    iso_target second = {.view = &view, .gbuffer = &g, .surface = 4};
    const size_t middle = 16 * 32 + 16;
    assert_int_equal(iso_draw_points(&first, &points, NULL), ISO_OK);
    assert_int_equal(iso_draw_points(&second, &points, NULL), ISO_OK);
    assert_int_equal(g.surface[middle], 3); /* the earlier surface, and its earlier point */
    near(g.normal[0][middle], 1, 0);
    points = few_points(same + 2, &span, 1);
    assert_int_equal(iso_draw_points(&second, &points, NULL), ISO_OK);
    assert_int_equal(g.surface[middle], 4); /* nearer wins */
    near(g.depth[middle], 4, 0);
    points = few_points(same, &span, 2);
    assert_int_equal(iso_draw_points(&first, &points, NULL), ISO_OK);
    assert_int_equal(g.surface[middle], 4);
    iso_gbuffer_free(&g);
}

/* Centres out of sight on each side; only their discs reach into the picture. */
static void discs_reach_in_from_outside(void **state) {
    (void)state;
    const float places[4][2] = {{-12, 0}, {12, 0}, {0, -12}, {0, 12}}, radius = 5;
    iso_view view = test_plain_view(16, 16, true, 1);
    for (int k = 0; k < 8; k++) {
        const iso_surfel one = {{places[k / 2][0], places[k / 2][1], 7}, {0, 0, 1}};
        iso_point_span span;
        iso_point_view points = few_points(&one, &span, 1);
        if (k % 2)
            points.radii = &radius;
        else
            points.radius = radius;
        iso_gbuffer g = clear_gbuffer(16, 16);
        assert_int_equal(draw_points(&view, &points, &g), ISO_OK);
        int covered = 0;
        for (int i = 0; i < 16 * 16; i++) covered += g.surface[i] == 0;
        assert_in_range(covered, 4, 8);
        iso_gbuffer_free(&g);
    }
}

/* Discs of a million pixels and more must cost no more than the picture; nothing that is no number is drawn.
 */
static void extremes_are_harmless(void **state) {
    (void)state;
    iso_surfel surfels[300];
    for (int i = 0; i < 300; i++) surfels[i] = (iso_surfel){{0, 0, 0.011f}, {0, 0, 0}};
    iso_point_span span;
    iso_point_view points = few_points(surfels, &span, 300);
    points.radius = 1e9;
    iso_view view = test_plain_view(200, 100, false, 1000);
    iso_gbuffer g = clear_gbuffer(200, 100);
    assert_int_equal(draw_points(&view, &points, &g), ISO_OK);
    for (int i = 0; i < 200 * 100; i++) assert_int_equal(g.surface[i], 0);
    near(g.normal[2][0], -1, 0); /* no normal: towards the eye */
    iso_gbuffer_clear(&g);
    const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 300; i++) surfels[i] = (iso_surfel){{0, 0, 5}, {1, 0, 0}};
    for (int i = 0; i < 9; i++) surfels[i].position[i % 3] = bad[i / 3];
    points.radius = NAN;
    span.count = 9;
    assert_int_equal(draw_points(&view, &points, &g), ISO_OK);
    for (int i = 0; i < 200 * 100; i++) assert_int_equal(g.surface[i], ISO_SURFACE_NONE);
    span.count = 300;
    assert_int_equal(draw_points(&view, &points, &g), ISO_OK);
    assert_int_equal(g.surface[50 * 200 + 100], 0); /* its own pixel, with a radius that is no number */
    assert_int_equal(g.surface[50 * 200 + 101], ISO_SURFACE_NONE);
    points.span_count = 0;
    assert_int_equal(draw_points(&view, &points, &g), ISO_OK);
    iso_gbuffer_free(&g);
}

/* A mesh with room for its arrays; every triangle has its own three vertices. */
typedef struct soup {
    iso_surfel vertices[3 * MOST];
    uint16_t triangles[MOST][3];
    iso_mesh_span spans[MOST];
    iso_mesh_view view;
} soup;

/* One span per triangle, in the brick that holds the triangle's least corner. The coordinates must survive
 * being taken relative to the brick. */
static void add_triangle(soup *s, const iso_vec3 corners[3]) {
    size_t k = s->view.span_count++;
    assert_true(k < MOST);
    iso_vec3 least = corners[0];
    for (int i = 1; i < 3; i++)
        least = iso_vec3_make(fmin(least.x, corners[i].x), fmin(least.y, corners[i].y),
                              fmin(least.z, corners[i].z));
    iso_mesh_span *span = &s->spans[k];
    *span = (iso_mesh_span){
        .brick = {(int32_t)floor(least.x / 16), (int32_t)floor(least.y / 16), (int32_t)floor(least.z / 16)},
        .vertex_count = 3,
        .triangle_count = 1,
        .first_vertex = 3 * k,
        .first_triangle = k};
    iso_vec3 normal =
        iso_vec3_cross(iso_vec3_sub(corners[1], corners[0]), iso_vec3_sub(corners[2], corners[0]));
    normal = iso_vec3_unit(normal);
    for (uint16_t i = 0; i < 3; i++) {
        s->vertices[3 * k + i] = (iso_surfel){{(float)(corners[i].x - 16.0 * span->brick[0]),
                                               (float)(corners[i].y - 16.0 * span->brick[1]),
                                               (float)(corners[i].z - 16.0 * span->brick[2])},
                                              {(float)normal.x, (float)normal.y, (float)normal.z}};
        s->triangles[k][i] = i;
    }
}

static void start_soup(soup *s) {
    s->view = (iso_mesh_view){.vertices = s->vertices,
                              .triangles = (const uint16_t(*)[3])s->triangles,
                              .spans = s->spans,
                              .transform = iso_transform_identity()};
}

static void meshes_break_ties_alike(void **state) {
    (void)state;
    static soup s;
    start_soup(&s);
    const iso_vec3 corners[3] = {{-5, -5, 5}, {5, -5, 5}, {0, 5, 5}};
    add_triangle(&s, corners);
    add_triangle(&s, corners);
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++) s.vertices[3 + k].normal[axis] = axis == 0;
    iso_view view = test_plain_view(16, 16, true, 1);
    iso_gbuffer g = clear_gbuffer(16, 16);
    iso_target target = {.view = &view, .gbuffer = &g, .surface = 1};
    assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
    target.surface = 2;
    assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
    assert_int_equal(g.surface[8 * 16 + 8], 1);
    near(g.normal[2][8 * 16 + 8], 1, 0);
    iso_gbuffer_free(&g);
}

/* How often each pixel is drawn, each triangle alone. */
static void count_coverage(const iso_view *view, const soup *s, int *count) {
    iso_gbuffer g = clear_gbuffer(view->width, view->height);
    iso_target target = {.view = view, .gbuffer = &g};
    size_t samples = (size_t)view->width * (size_t)view->height;
    memset(count, 0, samples * sizeof *count);
    for (size_t k = 0; k < s->view.span_count; k++) {
        iso_mesh_view one = s->view;
        one.spans = &s->spans[k];
        one.span_count = 1;
        iso_gbuffer_clear(&g);
        assert_int_equal(iso_draw_mesh(&target, &one, NULL), ISO_OK);
        for (size_t i = 0; i < samples; i++) count[i] += g.surface[i] != ISO_SURFACE_NONE;
    }
    iso_gbuffer_free(&g);
}

static double quantised(double value, double step) {
    return floor(value / step + 0.5) * step;
}

/* A jittered sheet of 12 x 12 cells that hides the picture, corners on multiples of `step`, at random depths.
 */
static void make_sheet(soup *s, uint32_t *seed, double size, double step, bool perspective) {
    enum { CELLS = 12 };
    iso_vec3 grid[CELLS + 1][CELLS + 1];
    start_soup(s);
    for (int j = 0; j <= CELLS; j++)
        for (int i = 0; i <= CELLS; i++) {
            double z = quantised(20 + 5 * uniform(seed), 1.0 / 64), cell = size / (CELLS - 2);
            double x = (i - CELLS / 2.0 + 0.45 * (uniform(seed) - 0.5)) * cell;
            double y = (j - CELLS / 2.0 + 0.45 * (uniform(seed) - 0.5)) * cell;
            if (perspective) x *= z / 20, y *= z / 20;
            grid[j][i] = iso_vec3_make(quantised(x, step), quantised(y, step), z);
        }
    for (int j = 0; j < CELLS; j++)
        for (int i = 0; i < CELLS; i++) {
            iso_vec3 a = grid[j][i], b = grid[j][i + 1], c = grid[j + 1][i], d = grid[j + 1][i + 1];
            bool turned = uniform(seed) < 0.5, flipped = uniform(seed) < 0.5;
            iso_vec3 one[3] = {a, b, turned ? d : c}, two[3] = {d, c, turned ? a : b};
            add_triangle(s, flipped ? (iso_vec3[3]){one[1], one[0], one[2]} : one);
            add_triangle(s, two);
        }
}

static void check_once(const iso_view *view, const soup *s) {
    int count[64 * 64];
    count_coverage(view, s, count);
    for (int i = 0; i < view->width * view->height; i++)
        if (count[i] != 1) fail_msg("pixel %d of %d is drawn %d times", i, view->width, count[i]);
}

static void sheets_cover_each_pixel_once(void **state) {
    (void)state;
    static soup s;
    uint32_t seed = 77;
    const double steps[] = {0.5, 0.25, 1.0 / 64};
    for (int round = 0; round < 9; round++) {
        /* pixels of 1 mm: with steps of a half many corners and edges run through pixel centres */
        iso_view view = test_plain_view(61, 48, true, 1);
        make_sheet(&s, &seed, 64, steps[round % 3], false);
        check_once(&view, &s);
        view = test_plain_view(61, 48, false, 20);
        make_sheet(&s, &seed, 64, 1.0 / 64, true);
        check_once(&view, &s);
        /* other scales, turned, other spacings: corners of different bricks must still fall together */
        view.focal = 20;
        view.rotation[0] = view.rotation[4] = cos(0.3);
        view.rotation[1] = -(view.rotation[3] = sin(0.3));
        for (int axis = 0; axis < 3; axis++) s.view.transform.spacing[axis] = 1.7;
        s.view.transform.origin[0] = 0.123;
        check_once(&view, &s);
        /* so large that everything but the middle is beyond the guard band */
        view = test_plain_view(61, 48, false, 3e7);
        make_sheet(&s, &seed, 64, 1.0 / 64, true);
        check_once(&view, &s);
    }
}

/* The one triangle whose coverage can be written down: its legs run through pixel centres. */
static void the_top_left_rule_holds(void **state) {
    (void)state;
    static soup s;
    start_soup(&s);
    add_triangle(&s, (iso_vec3[3]){{-3.5, -3.5, 5}, {0.5, -3.5, 5}, {-3.5, 0.5, 5}}); /* top, left */
    add_triangle(&s, (iso_vec3[3]){{3.5, 3.5, 5}, {-0.5, 3.5, 5}, {3.5, -0.5, 5}});   /* bottom, right */
    iso_view view = test_plain_view(8, 8, true, 1);
    int count[64];
    count_coverage(&view, &s, count);
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 8; x++) {
            bool upper = x + y < 4;                     /* x, y >= 0 on top and left edges */
            bool lower = x + y >= 10 && x < 7 && y < 7; /* not on right and bottom edges */
            assert_int_equal(count[8 * y + x], upper || lower);
        }
}

static iso_vec3 on_sphere(int ring, int rings, int step, int steps) {
    double theta = ISO_PI * ring / rings, phi = 2 * ISO_PI * (step % steps) / steps;
    double r = ring == 0 || ring == rings ? 0 : 9.7 * sin(theta);
    return iso_vec3_make(quantised(16 + r * cos(phi), 1.0 / 1024), quantised(16 + r * sin(phi), 1.0 / 1024),
                         quantised(16 + 9.7 * cos(theta), 1.0 / 1024));
}

/* A closed convex mesh of eight bricks. */
static void make_sphere(soup *s, int rings, int steps) {
    start_soup(s);
    for (int ring = 0; ring < rings; ring++)
        for (int step = 0; step < steps; step++) {
            iso_vec3 a = on_sphere(ring, rings, step, steps), b = on_sphere(ring, rings, step + 1, steps);
            iso_vec3 c = on_sphere(ring + 1, rings, step, steps),
                     d = on_sphere(ring + 1, rings, step + 1, steps);
            if (ring > 0) add_triangle(s, (iso_vec3[3]){a, c, b});
            if (ring < rings - 1) add_triangle(s, (iso_vec3[3]){b, c, d});
        }
}

/* Every pixel sees the front and the back of a convex body, or neither; with the eye inside, the far wall
 * once, through clipping at the near plane as well. */
static void closed_meshes_have_two_sides(void **state) {
    (void)state;
    static soup s;
    uint32_t seed = 21;
    make_sphere(&s, 20, 30);
    int count[64 * 64];
    for (int round = 0; round < 8; round++) {
        s.view.transform = random_transform(&seed);
        iso_view view = random_view(&seed, 64, 64, round % 2);
        if (round >= 6) {
            iso_affine affine = iso_transform_affine(&s.view.transform);
            view.eye = iso_affine_point(&affine, iso_vec3_make(17, 14, 18));
            view.orthographic = false;
            view.near = 0.01;
            view.focal = 20;
        }
        count_coverage(&view, &s, count);
        int twice = 0;
        for (int i = 0; i < 64 * 64; i++) {
            if (count[i] != (round >= 6 ? 1 : count[i] ? 2 : 0)) fail_msg("pixel %d: %d", i, count[i]);
            twice += count[i] == 2;
        }
        if (round < 6) assert_in_range(twice, 200, 4000);
    }
}

/* Depth along the ray through picture position (px, py) of the view's own space; < 0 for a miss. */
static double hit_triangle(const iso_view *view, const iso_vec3 v[3], double px, double py) {
    iso_vec3 direction = {(px - view->cx) / view->focal, (py - view->cy) / view->focal, 1};
    iso_vec3 a = iso_vec3_sub(v[1], v[0]), b = iso_vec3_sub(v[2], v[0]);
    iso_vec3 p = iso_vec3_cross(direction, b);
    double determinant = iso_vec3_dot(a, p);
    if (determinant == 0) return -1;
    iso_vec3 t = iso_vec3_scale(v[0], -1);
    double s = iso_vec3_dot(t, p) / determinant;
    iso_vec3 q = iso_vec3_cross(t, a);
    double r = iso_vec3_dot(direction, q) / determinant;
    double z = iso_vec3_dot(b, q) / determinant;
    return s >= 0 && r >= 0 && s + r <= 1 && z >= view->near ? z : -1;
}

/* The pixel of a lone triangle against rays through its centre and 1/64 pixel around it. */
static int check_pixel(const iso_view *view, const iso_vec3 v[3], const iso_gbuffer *g, int i) {
    double x = i % view->width + 0.5, y = i / view->width + 0.5, z[5];
    const double off[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    double least = INFINITY, most = 0;
    int hits = 0;
    for (int k = 0; k < 5; k++) {
        z[k] = hit_triangle(view, v, x + off[k][0] / 64, y + off[k][1] / 64);
        hits += z[k] > 0;
        least = fmin(least, z[k]);
        most = fmax(most, z[k]);
    }
    if (hits != 0 && hits != 5) return 0;
    if ((g->surface[i] == 0) != (hits == 5))
        fail_msg("pixel %d: drawn %d, hits %d", i, g->surface[i] == 0, hits);
    if (hits == 5) near(g->depth[i], z[0], 1e-4 * z[0] + (most - least));
    return hits == 5 && most - least < 1e-3 * z[0];
}

static void near_clipping_matches_rays(void **state) {
    (void)state;
    static soup s;
    uint32_t seed = 5;
    int checked = 0, clipped = 0;
    for (int round = 0; round < 400; round++) {
        iso_view view = test_plain_view(48, 40, false, 30);
        view.near = 0.5;
        iso_vec3 v[3];
        int behind = 0;
        for (int k = 0; k < 3; k++) {
            v[k].x = quantised(16 * uniform(&seed) - 8, 1.0 / 1024);
            v[k].y = quantised(16 * uniform(&seed) - 8, 1.0 / 1024);
            v[k].z = quantised(12 * uniform(&seed) - 4, 1.0 / 1024);
            behind += v[k].z < view.near;
        }
        start_soup(&s);
        add_triangle(&s, v);
        iso_gbuffer g = clear_gbuffer(48, 40);
        iso_target target = {.view = &view, .gbuffer = &g};
        assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
        for (int i = 0; i < 48 * 40; i++) {
            int sound = check_pixel(&view, v, &g, i);
            checked += sound;
            if (behind == 1 || behind == 2) clipped += sound;
        }
        iso_gbuffer_free(&g);
    }
    assert_true(checked > 20000 && clipped > 10000);
}

/* The normal of a flat triangle with a different normal at each corner, against rays. */
static void normals_are_interpolated_in_space(void **state) {
    (void)state;
    static soup s;
    start_soup(&s);
    const iso_vec3 v[3] = {{-4, -3, 4}, {9, 0, 14}, {0, 5, 6}};
    add_triangle(&s, v);
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++) s.vertices[k].normal[axis] = axis == k ? 1.0f : 0.2f;
    iso_view view = test_plain_view(64, 64, false, 40);
    iso_gbuffer g = clear_gbuffer(64, 64);
    iso_target target = {.view = &view, .gbuffer = &g};
    assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
    int seen = 0;
    for (int i = 0; i < 64 * 64; i++) {
        if (g.surface[i]) continue;
        double z = g.depth[i], total = 0, part[3];
        iso_vec3 p = {(i % 64 + 0.5 - 32) / 40 * z, (i / 64 + 0.5 - 32) / 40 * z, z};
        for (int k = 0; k < 3; k++) {
            iso_vec3 a = iso_vec3_sub(v[(k + 1) % 3], p), b = iso_vec3_sub(v[(k + 2) % 3], p);
            part[k] = iso_vec3_length(iso_vec3_cross(a, b));
            total += part[k];
        }
        iso_vec3 n = {part[0] + 0.2 * (total - part[0]), part[1] + 0.2 * (total - part[1]),
                      part[2] + 0.2 * (total - part[2])};
        n = iso_vec3_unit(n);
        near(g.normal[0][i], n.x, 3e-3);
        near(g.normal[1][i], n.y, 3e-3);
        near(g.normal[2][i], n.z, 3e-3);
        seen++;
    }
    assert_true(seen > 500);
    iso_gbuffer_free(&g);
}

/* Slivers and triangles of which only a corner is seen, wider than a row is searched pixel by pixel. */
static void broad_triangles_match_rays(void **state) {
    (void)state;
    static soup s;
    uint32_t seed = 31;
    for (int round = 0; round < 300; round++) {
        iso_view view = test_plain_view(60, 60, false, 30);
        double size = round % 2 ? 60 : 4000;
        iso_vec3 v[3];
        for (int k = 0; k < 3; k++) {
            v[k].x = quantised(size * (uniform(&seed) - 0.5), 1.0 / 256);
            v[k].y = quantised(size * (uniform(&seed) - 0.5), 1.0 / 256);
            v[k].z = quantised(10 + 20 * uniform(&seed), 1.0 / 256);
        }
        start_soup(&s);
        add_triangle(&s, v);
        iso_gbuffer g = clear_gbuffer(60, 60);
        iso_target target = {.view = &view, .gbuffer = &g};
        assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
        for (int i = 0; i < 60 * 60; i++) check_pixel(&view, v, &g, i);
        iso_gbuffer_free(&g);
    }
}

static void broken_meshes_are_harmless(void **state) {
    (void)state;
    static soup s;
    const float bad[] = {NAN, INFINITY, -INFINITY, 3e38f};
    iso_view view = test_plain_view(40, 40, false, 30);
    iso_gbuffer g = clear_gbuffer(40, 40);
    iso_target target = {.view = &view, .gbuffer = &g};
    for (int i = 0; i < 36; i++) {
        start_soup(&s);
        add_triangle(&s, (iso_vec3[3]){{-5, -5, 5}, {5, -5, 5}, {0, 5, 5}});
        s.vertices[i % 3].position[i / 3 % 3] = bad[i / 9];
        assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
    }
    iso_gbuffer_clear(&g);
    start_soup(&s);
    assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
    add_triangle(&s, (iso_vec3[3]){{-5, -5, 5}, {5, 5, 5}, {0, 0, 5}}); /* no area */
    assert_int_equal(iso_draw_mesh(&target, &s.view, NULL), ISO_OK);
    for (int i = 0; i < 40 * 40; i++) assert_int_equal(g.surface[i], ISO_SURFACE_NONE);
    iso_gbuffer_free(&g);
}

/* Points and the mesh into one gbuffer. */
static void draw_both(const iso_view *view, const cloud *c, const soup *s, iso_pool *pool,
                      iso_gbuffer *gbuffer) {
    iso_target target = {.view = view, .gbuffer = gbuffer, .pool = pool, .surface = 1};
    assert_int_equal(iso_draw_points(&target, &c->view, NULL), ISO_OK);
    target.surface = 2;
    assert_int_equal(iso_draw_mesh(&target, &s->view, NULL), ISO_OK);
}

static void threads_strips_and_levels_change_nothing(void **state) {
    (void)state;
    static cloud c;
    static soup s;
    uint32_t seed = 13;
    const int threads[] = {2, 7}, strips[] = {0, 1, 38, 39, 170, 200};
    for (int round = 0; round < 6; round++) {
        make_cloud(&c, &seed, 100, round % 2);
        for (int i = 0; i < MOST; i++) c.radii[i] *= i % 500 == 7 ? 9 : i % 3 == 0 ? 0.1f : 1;
        if (round >= 2) c.view.radii = c.radii;
        make_sphere(&s, 30, 40);
        s.view.transform = c.view.transform;
        iso_view view = random_view(&seed, 180, 200, round % 3 == 2);
        iso_gbuffer whole = clear_gbuffer(180, 200);
        draw_both(&view, &c, &s, NULL, &whole);
        int seen[3] = {0};
        for (int i = 0; i < 180 * 200; i++) seen[whole.surface[i] % 3 == 0 ? 0 : whole.surface[i]]++;
        assert_true(seen[1] > 500 && seen[2] > 500);
        for (int k = 0; k < 2; k++) {
            iso_pool *pool;
            assert_int_equal(iso_pool_create(threads[k], &pool, NULL), ISO_OK);
            iso_gbuffer g = clear_gbuffer(180, 200);
            draw_both(&view, &c, &s, pool, &g);
            same_gbuffers(&whole, &g, 0, 200);
            iso_gbuffer_free(&g);
            iso_pool_destroy(pool);
        }
        for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
            iso_gbuffer g = clear_gbuffer(180, 200);
            iso_cpu_limit((iso_cpu_level)level);
            draw_both(&view, &c, &s, NULL, &g);
            iso_cpu_limit(ISO_CPU_AVX512);
            same_gbuffers(&whole, &g, 0, 200);
            iso_gbuffer_free(&g);
        }
        for (int k = 0; k < 5; k++) {
            int rows = strips[k + 1] - strips[k];
            iso_view strip = iso_view_rows(&view, strips[k], rows);
            iso_gbuffer g = clear_gbuffer(180, rows);
            draw_both(&strip, &c, &s, NULL, &g);
            same_gbuffers(&whole, &g, (size_t)strips[k], rows);
            iso_gbuffer_free(&g);
        }
        iso_gbuffer_free(&whole);
    }
}

static void impossible_buffers_are_refused(void **state) {
    (void)state;
    iso_gbuffer gbuffer = {0};
    iso_error error = {0};
    assert_int_equal(iso_gbuffer_create(0, 4, &gbuffer, &error), ISO_ERR_NOMEM);
    assert_int_equal(iso_gbuffer_create(2147483647, 2147483647, &gbuffer, &error), ISO_ERR_NOMEM);
    assert_non_null(strstr(error.text, "2147483647"));
    assert_null(gbuffer.depth);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(discs_cover_what_they_should),
        cmocka_unit_test(the_eye_may_be_inside),
        cmocka_unit_test(discs_have_the_paper_s_size),
        cmocka_unit_test(ties_go_to_the_first),
        cmocka_unit_test(discs_reach_in_from_outside),
        cmocka_unit_test(meshes_break_ties_alike),
        cmocka_unit_test(extremes_are_harmless),
        cmocka_unit_test(sheets_cover_each_pixel_once),
        cmocka_unit_test(the_top_left_rule_holds),
        cmocka_unit_test(closed_meshes_have_two_sides),
        cmocka_unit_test(near_clipping_matches_rays),
        cmocka_unit_test(normals_are_interpolated_in_space),
        cmocka_unit_test(broad_triangles_match_rays),
        cmocka_unit_test(broken_meshes_are_harmless),
        cmocka_unit_test(threads_strips_and_levels_change_nothing),
        cmocka_unit_test(impossible_buffers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
