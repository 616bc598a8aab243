#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/primitives.h"
#include "check_support.h"
#include "render/picture.h"
#include "render/raster/raster.h"

static const iso_rgb COLORS[] = {{200, 120, 40}, {40, 160, 220}};

static iso_camera camera_at(double distance) {
    return (iso_camera){.position = {0, -distance, 0}, .view_up = {0, 0, 1}, .view_angle = 30};
}

enum { POINTS = 3000 };

/* Points and triangles on a lumpy ball around the origin. */
typedef struct scene {
    iso_surfel surfels[POINTS];
    iso_point_span points;
    iso_surfel vertices[POINTS];
    uint16_t triangles[POINTS / 3][3];
    iso_mesh_span mesh;
    iso_pool *pool;
    int strips; /* how often it was drawn */
    int fail_at;
} scene;

static void make_scene(scene *s) {
    uint32_t seed = 4;
    memset(s, 0, sizeof *s);
    for (int i = 0; i < POINTS; i++) {
        iso_vec3 v = {uniform(&seed) - 0.5, uniform(&seed) - 0.5, uniform(&seed) - 0.5};
        iso_vec3 n = iso_vec3_unit(v), p = iso_vec3_scale(n, 3 + uniform(&seed));
        iso_surfel surfel = {{(float)p.x, (float)p.y, (float)p.z}, {(float)n.x, (float)n.y, (float)n.z}};
        s->surfels[i] = s->vertices[i] = surfel;
        s->triangles[i / 3][i % 3] = (uint16_t)i;
    }
    s->points.count = POINTS;
    s->mesh.vertex_count = s->mesh.owned_count = POINTS;
    s->mesh.triangle_count = POINTS / 30;
    s->fail_at = -1;
}

static iso_status draw_scene(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    scene *s = context;
    if (s->strips++ == s->fail_at) return iso_fail(error, ISO_ERR_BACKEND, "the brush broke");
    iso_point_view points = {.surfels = s->surfels,
                             .spans = &s->points,
                             .span_count = 1,
                             .transform = iso_transform_identity(),
                             .radius = 0.05};
    iso_mesh_view mesh = {.vertices = s->vertices,
                          .triangles = (const uint16_t(*)[3])s->triangles,
                          .spans = &s->mesh,
                          .span_count = 1,
                          .transform = iso_transform_identity()};
    iso_target target = {.view = view, .gbuffer = gbuffer, .pool = s->pool, .surface = 0};
    ISO_TRY(iso_draw_points(&target, &points, error));
    target.surface = 1;
    return iso_draw_mesh(&target, &mesh, error);
}

static iso_picture_opts options(scene *s, const iso_camera *camera, int side, int samples) {
    return (iso_picture_opts){.camera = camera,
                              .width = side,
                              .height = side,
                              .samples = samples,
                              .shading = {.colors = COLORS, .color_count = 2, .background = {10, 20, 30}},
                              .draw = draw_scene,
                              .draw_context = s,
                              .pool = s->pool};
}

static iso_image image_of(int side) {
    iso_image image;
    assert_int_equal(iso_image_create(side, side, &image, NULL), ISO_OK);
    memset(image.rgba, 77, (size_t)side * (size_t)side * 4);
    return image;
}

/* 512 x 512 pixels of 64 samples need two strips; here they are drawn in one. */
static void strips_are_the_whole_picture(void **state) {
    (void)state;
    static scene s;
    make_scene(&s);
    const int side = 512, factor = 8;
    iso_camera camera = camera_at(20);
    iso_picture_opts opts = options(&s, &camera, side, factor * factor);
    iso_image strips = image_of(side), whole = image_of(side);
    iso_aov aov, whole_aov;
    assert_int_equal(iso_aov_create(side, side, &aov, NULL), ISO_OK);
    assert_int_equal(iso_aov_create(side, side, &whole_aov, NULL), ISO_OK);
    opts.aov = &aov;
    size_t covered = 0, counted = 0;
    assert_int_equal(iso_picture_render(&opts, &strips, &covered, NULL), ISO_OK);
    assert_int_equal(s.strips, 2);

    iso_view view = iso_view_make(&camera, side, side);
    view = iso_view_scaled(&view, factor);
    iso_gbuffer gbuffer;
    assert_int_equal(iso_gbuffer_create(view.width, view.height, &gbuffer, NULL), ISO_OK);
    iso_gbuffer_clear(&gbuffer);
    assert_int_equal(draw_scene(&s, &view, &gbuffer, NULL), ISO_OK);
    const iso_strip strip = {&view, &gbuffer, factor, 0};
    iso_shade(&opts.shading, &strip, &whole, NULL);
    assert_memory_equal(strips.rgba, whole.rgba, (size_t)side * (size_t)side * 4);
    iso_strip_measure(&strip, &whole_aov, NULL);
    size_t plane = (size_t)side * (size_t)side * sizeof(float);
    assert_memory_equal(aov.depth, whole_aov.depth, plane);
    assert_memory_equal(aov.coverage, whole_aov.coverage, plane);
    for (int axis = 0; axis < 3; axis++) assert_memory_equal(aov.normal[axis], whole_aov.normal[axis], plane);
    iso_aov_free(&aov);
    iso_aov_free(&whole_aov);
    size_t samples = (size_t)view.width * (size_t)view.height;
    for (size_t i = 0; i < samples; i++) counted += gbuffer.surface[i] != ISO_SURFACE_NONE;
    assert_int_equal(covered, counted);
    assert_true(counted > samples / 10);
    iso_gbuffer_free(&gbuffer);
    iso_image_free(&strips);
    iso_image_free(&whole);
}

static void threads_change_nothing(void **state) {
    (void)state;
    static scene s;
    make_scene(&s);
    iso_camera camera = camera_at(20);
    iso_image one = image_of(150), many = image_of(150);
    iso_picture_opts opts = options(&s, &camera, 150, 4);
    assert_int_equal(iso_picture_render(&opts, &one, NULL, NULL), ISO_OK);
    const int threads[] = {2, 7};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(iso_pool_create(threads[k], &s.pool, NULL), ISO_OK);
        opts = options(&s, &camera, 150, 4);
        memset(many.rgba, 0, 150 * 150 * 4);
        assert_int_equal(iso_picture_render(&opts, &many, NULL, NULL), ISO_OK);
        assert_memory_equal(one.rgba, many.rgba, 150 * 150 * 4);
        iso_pool_destroy(s.pool);
    }
    iso_image_free(&one);
    iso_image_free(&many);
}

/* Covers the samples whose column is below `columns`, facing the eye. */
static iso_status draw_columns(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    (void)error;
    const int columns = *(const int *)context;
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < columns; x++) {
            size_t i = (size_t)y * (size_t)view->width + (size_t)x;
            gbuffer->depth[i] = 1;
            gbuffer->surface[i] = 0;
            gbuffer->normal[0][i] = gbuffer->normal[1][i] = 0;
            gbuffer->normal[2][i] = -1;
        }
    return ISO_OK;
}

static void samples_are_averaged(void **state) {
    (void)state;
    iso_camera camera = camera_at(20);
    camera.orthographic = true;
    camera.parallel_scale = 1;
    int columns = 6; /* of 4 a pixel: one full, one half covered */
    iso_picture_opts opts = {.camera = &camera,
                             .width = 4,
                             .height = 4,
                             .samples = 16,
                             .shading = {.colors = COLORS, .color_count = 1, .background = {10, 20, 30}},
                             .draw = draw_columns,
                             .draw_context = &columns};
    iso_image image = image_of(4);
    size_t covered = 0;
    assert_int_equal(iso_picture_render(&opts, &image, &covered, NULL), ISO_OK);
    assert_int_equal(covered, 6 * 16);
    const float normal[3] = {0, 0, -1};
    float rgb[3];
    iso_shade_sample(normal, normal, COLORS[0], rgb);
    const int back[3] = {10, 20, 30};
    for (int y = 0; y < 4; y++)
        for (int c = 0; c < 3; c++) {
            const uint8_t *row = image.rgba + 16 * y;
            near(row[c], 255 * rgb[c], 0.51);
            near(row[4 + c], (round(255 * (double)rgb[c]) + back[c]) / 2, 0.51); /* (samples are rounded) */
            assert_int_equal(row[8 + c], back[c]);
            assert_int_equal(row[12 + c], back[c]);
        }
    for (int i = 0; i < 16; i++) assert_int_equal(image.rgba[4 * i + 3], 255);

    opts.shading.transparent = 1;
    assert_int_equal(iso_picture_render(&opts, &image, NULL, NULL), ISO_OK);
    const int alpha[4] = {255, 128, 0, 0};
    for (int x = 0; x < 4; x++) assert_int_equal(image.rgba[4 * x + 3], alpha[x]);
    for (int c = 0; c < 3; c++) { /* straight: half covered pixels keep their colour */
        near(image.rgba[4 + c], 255 * rgb[c], 0.51);
        assert_int_equal(image.rgba[8 + c], 0);
    }
    iso_image_free(&image);
}

static void bad_requests_are_refused(void **state) {
    (void)state;
    static scene s;
    make_scene(&s);
    iso_camera camera = camera_at(20);
    iso_image image = image_of(20);
    const int samples[] = {-1, 2, 3, 8, 65, 81, 100};
    size_t covered = 99;
    for (size_t k = 0; k < sizeof samples / sizeof samples[0]; k++) {
        iso_picture_opts opts = options(&s, &camera, 20, samples[k]);
        iso_error error = {0};
        assert_int_equal(iso_picture_render(&opts, &image, &covered, &error), ISO_ERR_USAGE);
        assert_non_null(strstr(error.text, "square"));
    }
    assert_int_equal(s.strips, 0);
    s.fail_at = 0;
    iso_picture_opts opts = options(&s, &camera, 20, 0);
    iso_error error = {0};
    assert_int_equal(iso_picture_render(&opts, &image, &covered, &error), ISO_ERR_BACKEND);
    assert_string_equal(error.text, "the brush broke");
    assert_int_equal(covered, 99);
    iso_image_free(&image);
}

static void random_unit(uint32_t *seed, float out[3]) {
    iso_vec3 v = {uniform(seed) - 0.5, uniform(seed) - 0.5, uniform(seed) - 0.5};
    v = iso_vec3_unit(v);
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void shading_is_two_sided_and_bounded(void **state) {
    (void)state;
    uint32_t seed = 8;
    for (int round = 0; round < 5000; round++) {
        float n[3], eye[3], turned[3], a[3], b[3];
        random_unit(&seed, n);
        random_unit(&seed, eye);
        eye[2] = -fabsf(eye[2]);
        for (int axis = 0; axis < 3; axis++) turned[axis] = -n[axis];
        iso_rgb color = {(uint8_t)(256 * uniform(&seed)), (uint8_t)(256 * uniform(&seed)), 255};
        iso_shade_sample(n, eye, color, a);
        iso_shade_sample(turned, eye, color, b);
        for (int c = 0; c < 3; c++) {
            assert_true(a[c] >= 0 && a[c] <= 1);
            near(a[c], b[c], 0);
        }
    }
}

/* Brightness of a gray ball seen along z, at (x, y) of its disc. */
static float ball(float x, float y, uint8_t gray) {
    const float n[3] = {x, y, -sqrtf(1 - x * x - y * y)}, eye[3] = {0, 0, -1};
    float rgb[3];
    iso_shade_sample(n, eye, (iso_rgb){gray, gray, gray}, rgb);
    near(rgb[0], rgb[2], 0);
    return rgb[0];
}

static void light_comes_from_above_left(void **state) {
    (void)state;
    assert_true(ball(-0.4f, -0.4f, 180) > ball(0.4f, -0.4f, 180) + 0.1f);
    assert_true(ball(-0.4f, -0.4f, 180) > ball(-0.4f, 0.4f, 180) + 0.1f);
    assert_true(ball(0.6f, 0.7f, 180) > 0.05f); /* the fill and ambient light */
    assert_true(ball(-0.22f, -0.28f, 0) > 0.1f && ball(0.3f, 0.3f, 0) < 0.01f); /* the highlight */
}

/* The highlight of a black ball: its brightest normal tells the light, the rest must be (r.v)^32. */
static void the_highlight_has_exponent_32(void **state) {
    (void)state;
    float best = 0, x0 = 0, y0 = 0;
    for (float y = -0.9f; y < 0; y += 0.002f)
        for (float x = -0.4f; x < 0; x += 0.002f)
            if (x * x + y * y < 0.9f && ball(x, y, 0) > best) best = ball(x0 = x, y0 = y, 0);
    double z0 = -sqrt(1 - x0 * x0 - y0 * y0);
    iso_vec3 light = {2 * -z0 * x0, 2 * -z0 * y0, 2 * -z0 * z0 + 1};
    for (float r = 0.02f; r < 0.3f; r += 0.02f) {
        iso_vec3 n = {x0 + r, y0 + r, 0};
        n.z = -sqrt(1 - n.x * n.x - n.y * n.y);
        double mirror = -2 * iso_vec3_dot(n, light) * n.z + light.z;
        near(ball((float)n.x, (float)n.y, 0) / best, pow(mirror, 32), 0.02);
    }
}

/* The highlight moves with the eye: shading follows rays, not a far eye. */
static void perspective_changes_the_highlight(void **state) {
    (void)state;
    iso_gbuffer g;
    assert_int_equal(iso_gbuffer_create(64, 64, &g, NULL), ISO_OK);
    iso_gbuffer_clear(&g);
    for (int i = 0; i < 64 * 64; i++) {
        g.surface[i] = 7; /* beyond the colours: the last one */
        g.normal[0][i] = g.normal[1][i] = 0;
        g.normal[2][i] = -1;
    }
    iso_shading shading = {.colors = COLORS, .color_count = 2};
    iso_image image = image_of(64);
    iso_camera camera = camera_at(20);
    camera.view_angle = 100;
    iso_view view = iso_view_make(&camera, 64, 64);
    const iso_strip strip = {&view, &g, 1, 0};
    iso_shade(&shading, &strip, &image, NULL);
    for (int i = 0; i < 64 * 64; i++) {
        iso_vec3 ray = {(i % 64 + 0.5 - view.cx) / view.focal, (i / 64 + 0.5 - view.cy) / view.focal, 1};
        iso_vec3 to = iso_vec3_scale(iso_vec3_unit(ray), -1);
        const float eye[3] = {(float)to.x, (float)to.y, (float)to.z};
        float rgb[3];
        const float n[3] = {0, 0, -1};
        iso_shade_sample(n, eye, COLORS[1], rgb);
        for (int c = 0; c < 3; c++) near(image.rgba[4 * i + c], 255 * rgb[c], 0.51);
    }
    assert_memory_not_equal(image.rgba, image.rgba + 4 * (64 * 63 + 63), 4);
    iso_gbuffer_free(&g);
    iso_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_are_the_whole_picture),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(samples_are_averaged),
        cmocka_unit_test(bad_requests_are_refused),
        cmocka_unit_test(shading_is_two_sided_and_bounded),
        cmocka_unit_test(light_comes_from_above_left),
        cmocka_unit_test(the_highlight_has_exponent_32),
        cmocka_unit_test(perspective_changes_the_highlight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
