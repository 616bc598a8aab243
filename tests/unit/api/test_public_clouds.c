/* Clouds of discs and 3-D Gaussians through the public interface: of arrays and of files, beside other
 * surfaces, and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isopoint.h"
#include "lent_ball.h"

enum { WIDTH = 80, HEIGHT = 60, MIDDLE = HEIGHT / 2 * WIDTH + WIDTH / 2 };

static size_t differing(const iso_image *a, const iso_image *b) {
    size_t count = 0;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        count += memcmp(a->rgba + 4 * i, b->rgba + 4 * i, 4) != 0;
    return count;
}

/* The points of a surface in arrays. */
typedef struct arrays {
    size_t count;
    float *positions, *normals, *radii;
} arrays;

static arrays arrays_of(iso_surface *surface) {
    arrays a = {0};
    assert_int_equal(iso_surface_points(surface, NULL, 0, &a.count, NULL), ISO_OK);
    iso_surface_point *points = calloc(a.count, sizeof *points);
    a.positions = calloc(3 * a.count, sizeof(float));
    a.normals = calloc(3 * a.count, sizeof(float));
    a.radii = calloc(a.count, sizeof(float));
    assert_int_equal(iso_surface_points(surface, points, a.count, &a.count, NULL), ISO_OK);
    for (size_t i = 0; i < a.count; i++) {
        memcpy(a.positions + 3 * i, points[i].position, sizeof points[i].position);
        memcpy(a.normals + 3 * i, points[i].normal, sizeof points[i].normal);
        a.radii[i] = points[i].radius;
    }
    free(points);
    return a;
}

static void free_arrays(arrays *a) {
    free(a->positions);
    free(a->normals);
    free(a->radii);
}

/* Levels of detail draw a small picture of many points from fewer; other methods have none. */
static void test_levels(void **state) {
    (void)state;
    enum { COUNT = 60000 };
    float *positions = calloc(3 * COUNT, sizeof(float)), *normals = calloc(3 * COUNT, sizeof(float));
    for (int i = 0; i < COUNT; i++) { /* a spiral on a ball of radius 10 */
        const double z = 1 - (2 * i + 1.0) / COUNT, r = sqrt(1 - z * z), angle = 2.399963229728653 * i;
        const double n[3] = {r * cos(angle), r * sin(angle), z};
        for (int k = 0; k < 3; k++) {
            normals[3 * i + k] = (float)n[k];
            positions[3 * i + k] = (float)(10 * n[k]);
        }
    }
    const iso_cloud_arrays ball = {.count = COUNT, .positions = positions, .normals = normals};
    iso_surface *surface = NULL;
    iso_image images[2] = {{0}, {0}};
    iso_difference difference;
    assert_int_equal(iso_surface_of_cloud(&ball, NULL, &surface, NULL), ISO_OK);
    iso_render_opts opts = {.width = WIDTH, .height = HEIGHT, .method = ISO_METHOD_DISCS};
    for (int i = 0; i < 2; i++) {
        opts.lod = i;
        assert_int_equal(iso_render(surface, &opts, &images[i], NULL), ISO_OK);
    }
    assert_int_equal(iso_compare_images(&images[0], &images[1], NULL, &difference, NULL), ISO_OK);
    assert_true(differing(&images[0], &images[1]) > 20 && difference.psnr > 30);
    opts.method = ISO_METHOD_POINTS;
    assert_int_equal(iso_render(surface, &opts, &images[0], NULL), ISO_ERR_USAGE);
    iso_surface_destroy(surface);
    for (int i = 0; i < 2; i++) iso_image_free(&images[i]);
    free(positions);
    free(normals);
}

/* The points of a ball, as arrays and in a file, give the same picture, which is that of the ball; points
 * without normals and radii, which are estimated, give nearly that. */
static void test_discs(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(1);
    iso_surface *ball = NULL, *clouds[3] = {NULL, NULL, NULL};
    iso_image images[4] = {{0}, {0}, {0}, {0}};
    iso_box box, own;
    size_t count;
    const char *path = ISO_TEST_TMP "/public_clouds.ply";
    const iso_rgb red = {255, 0, 0};
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.color = &red}, &ball, NULL), ISO_OK);
    arrays a = arrays_of(ball);
    assert_int_equal(iso_surface_write_points(ball, path, NULL), ISO_OK);
    const iso_cloud_arrays whole = {
        .count = a.count, .positions = a.positions, .normals = a.normals, .radii = a.radii};
    const iso_cloud_arrays bare = {.count = a.count, .positions = a.positions};
    const iso_surface_cloud_opts look = {.color = &red, .threads = 2};
    assert_int_equal(iso_surface_of_cloud(&whole, &look, &clouds[0], NULL), ISO_OK);
    assert_int_equal(iso_surface_read_cloud(path, &look, &clouds[1], NULL), ISO_OK);
    assert_int_equal(iso_surface_of_cloud(&bare, &look, &clouds[2], NULL), ISO_OK);
    iso_render_opts opts = {
        .width = WIDTH, .height = HEIGHT, .method = ISO_METHOD_SPLATS, .transparent = true};
    assert_int_equal(iso_surface_bounds(ball, &box, NULL), ISO_OK);
    iso_camera camera;
    assert_int_equal(iso_camera_of_box(&box, WIDTH, HEIGHT, NULL, &camera, NULL), ISO_OK);
    opts.camera = &camera;
    for (int i = 0; i < 4; i++)
        assert_int_equal(iso_render(i < 3 ? clouds[i] : ball, &opts, &images[i], NULL), ISO_OK);
    /* the file says that its surface is closed: at its outline, points that face away are left out */
    assert_in_range(differing(&images[0], &images[1]), 1, 60);
    size_t outline[2] = {0, 0};
    for (size_t i = 3; i < 4 * (size_t)WIDTH * HEIGHT; i += 4) {
        outline[0] += (images[0].rgba[i] > 127) != (images[3].rgba[i] > 127);
        outline[1] += (images[2].rgba[i] > 127) != (images[3].rgba[i] > 127);
    }
    assert_true(outline[0] < 20 && outline[1] < 120);
    for (int k = 0; k < 3; k++)
        assert_true(abs(images[0].rgba[4 * MIDDLE + k] - images[3].rgba[4 * MIDDLE + k]) < 8);
    assert_int_equal(iso_surface_bounds(clouds[0], &own, NULL), ISO_OK);
    assert_true(fabs(own.lo.x - box.lo.x) < 0.01 && fabs(own.hi.z - box.hi.z) < 0.01);
    assert_int_equal(iso_surface_points(clouds[2], NULL, 0, &count, NULL), ISO_OK);
    assert_int_equal(count, a.count);
    opts.method = ISO_METHOD_PULLPUSH;
    assert_int_equal(iso_render(clouds[0], &opts, &images[0], NULL), ISO_OK);
    for (int i = 0; i < 3; i++) iso_surface_destroy(clouds[i]);
    for (int i = 0; i < 4; i++) iso_image_free(&images[i]);
    free_arrays(&a);
    iso_surface_destroy(ball);
    iso_volume_destroy(volume);
}

/* A disc stops as much light as its opacity says, by splats; positions far from 0 are relative to an origin;
 * colours are those of the points unless the options have one. */
static void test_opacities(void **state) {
    (void)state;
    const float position[3] = {1, 2, 3}, normal[3] = {0, -1, 0}, radius = 5, opacity = 0.5f;
    const uint8_t green[3] = {0, 255, 0};
    const iso_cloud_arrays disc = {.count = 1,
                                   .positions = position,
                                   .origin = {5e6, -5e6, 1e5},
                                   .normals = normal,
                                   .radii = &radius,
                                   .colors = green,
                                   .opacities = &opacity};
    iso_surface *surface = NULL, *red_surface = NULL;
    iso_image image = {0};
    iso_box box;
    assert_int_equal(iso_surface_of_cloud(&disc, NULL, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_bounds(surface, &box, NULL), ISO_OK);
    assert_true(box.lo.x > 5e6 - 4.001 && box.lo.x < 5e6 + 1.001 && box.lo.z > 1e5 - 2.001);
    iso_render_opts opts = {.width = WIDTH,
                            .height = HEIGHT,
                            .method = ISO_METHOD_SPLATS_FLAT,
                            .transparent = true,
                            .constant_opacity = true};
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
    assert_in_range(image.rgba[4 * MIDDLE + 3], 126, 129);
    assert_true(image.rgba[4 * MIDDLE + 1] > 3 * image.rgba[4 * MIDDLE]);
    opts.method = ISO_METHOD_PULLPUSH; /* which draws it opaque */
    assert_int_equal(iso_render(surface, &opts, &image, NULL), ISO_OK);
    assert_int_equal(image.rgba[4 * MIDDLE + 3], 255);
    const iso_rgb red = {255, 0, 0};
    assert_int_equal(
        iso_surface_of_cloud(&disc, &(iso_surface_cloud_opts){.color = &red}, &red_surface, NULL), ISO_OK);
    assert_int_equal(iso_render(red_surface, &opts, &image, NULL), ISO_OK);
    assert_true(image.rgba[4 * MIDDLE] > 3 * image.rgba[4 * MIDDLE + 1]);
    iso_surface_destroy(surface);
    iso_surface_destroy(red_surface);
    iso_image_free(&image);
}

/* A Gaussian twice as wide along z as along x, alone and behind an opaque ball. */
static void test_gaussians(void **state) {
    (void)state;
    const float position[3] = {0, 0, 0}, axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 2}, opacity = 0.75f;
    const uint8_t green[3] = {0, 255, 0};
    iso_cloud_arrays one = {
        .count = 1, .positions = position, .axes = axes, .colors = green, .opacities = &opacity};
    iso_surface *gaussian = NULL, *ball = NULL;
    iso_volume *volume = lend_ball(1);
    iso_image image = {0};
    assert_int_equal(iso_surface_of_cloud(&one, NULL, &gaussian, NULL), ISO_OK);
    const iso_camera camera = {.position = {0, -40, 0},
                               .focal_point = {0, 0, 0},
                               .view_up = {0, 0, 1},
                               .view_angle = 20,
                               .parallel_scale = 1};
    iso_render_opts opts = {.width = WIDTH, .height = HEIGHT, .camera = &camera, .transparent = true};
    assert_int_equal(iso_render(gaussian, &opts, &image, NULL), ISO_OK); /* by the usual method */
    assert_in_range(image.rgba[4 * MIDDLE + 3], 180, 192);
    size_t wide = 0, high = 0;
    for (size_t x = 0; x < WIDTH; x++) wide += image.rgba[4 * (HEIGHT / 2 * WIDTH + x) + 3] > 40;
    for (size_t y = 0; y < HEIGHT; y++) high += image.rgba[4 * (y * WIDTH + WIDTH / 2) + 3] > 40;
    assert_true(high > 1.7 * (double)wide && high < 2.3 * (double)wide);
    const iso_rgb red = {255, 0, 0};
    assert_int_equal(iso_surface_create(volume, &(iso_surface_opts){.color = &red}, &ball, NULL), ISO_OK);
    iso_surface *both[2] = {gaussian, ball};
    iso_box box;
    assert_int_equal(iso_surface_bounds(ball, &box, NULL), ISO_OK);
    const iso_vec3 middle = {(box.lo.x + box.hi.x) / 2, (box.lo.y + box.hi.y) / 2, (box.lo.z + box.hi.z) / 2};
    const iso_camera behind = {.position = {middle.x, middle.y + 60, middle.z},
                               .focal_point = middle,
                               .view_up = {0, 0, 1},
                               .view_angle = 40,
                               .parallel_scale = 1};
    opts.camera = &behind;
    assert_int_equal(iso_render_surfaces(both, 2, &opts, &image, NULL), ISO_OK);
    assert_true(image.rgba[4 * MIDDLE] > 2 * image.rgba[4 * MIDDLE + 1]); /* the ball, in front */
    both[0] = ball;
    both[1] = gaussian;
    assert_int_equal(iso_render_surfaces(both, 2, &opts, &image, NULL), ISO_ERR_USAGE);
    opts.shadow = true;
    assert_int_equal(iso_render(gaussian, &opts, &image, NULL), ISO_ERR_USAGE);
    iso_surface_destroy(gaussian);
    iso_surface_destroy(ball);
    iso_volume_destroy(volume);
    iso_image_free(&image);
    const float bad = 1.5f;
    one.opacities = &bad;
    assert_int_equal(iso_surface_of_cloud(&one, NULL, &gaussian, NULL), ISO_ERR_USAGE);
}

static void test_refusals(void **state) {
    (void)state;
    const float position[6] = {0, 0, 0, 1, 1, 1}, wrong[3] = {0, NAN, 0};
    iso_cloud_arrays two = {.count = 2, .positions = position}, none = {.positions = position},
                     bad = {.count = 1, .positions = wrong};
    iso_surface *surface = NULL, *failed = NULL;
    iso_mesh mesh = {0};
    iso_mesh_measures measures;
    iso_image image = {0};
    iso_error error = {0};
    assert_int_equal(iso_surface_of_cloud(&two, NULL, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_mesh(surface, &mesh, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_surface_measure(surface, &measures, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_surface_set_isovalue(surface, 1, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_surface_write_mesh(surface, ISO_TEST_TMP "/no.stl", NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_render(surface, NULL, &image, &error), ISO_ERR_USAGE); /* exact */
    assert_string_equal(
        error.text,
        "surface 0 is a cloud of points: the method exact needs a volume; points, pullpush, discs "
        "or splats draw it");
    const iso_color_by color_by = {.source = ISO_COLOR_BY_CURVATURE};
    const iso_render_opts colored = {.method = ISO_METHOD_SPLATS, .color_by = &color_by, .color_by_count = 1};
    assert_int_equal(iso_render(surface, &colored, &image, NULL), ISO_ERR_USAGE);
    iso_surface_destroy(surface);
    iso_image_free(&image);
    assert_int_equal(iso_surface_of_cloud(&none, NULL, &failed, NULL), ISO_ERR_EMPTY);
    assert_int_equal(iso_surface_of_cloud(&bad, NULL, &failed, NULL), ISO_ERR_USAGE);
    assert_int_equal(iso_surface_of_cloud(&two, &(iso_surface_cloud_opts){.radius = -1}, &failed, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_surface_of_cloud(&two, &(iso_surface_cloud_opts){.opacity = 2}, &failed, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_surface_of_cloud(&two, &(iso_surface_cloud_opts){.threads = -1}, &failed, NULL),
                     ISO_ERR_USAGE);
    assert_int_equal(iso_surface_read_cloud(ISO_TEST_TMP "/absent.ply", NULL, &failed, NULL), ISO_ERR_IO);
    assert_int_equal(iso_surface_read_cloud(NULL, NULL, &failed, NULL), ISO_ERR_USAGE);
    assert_null(failed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_discs),     cmocka_unit_test(test_levels),   cmocka_unit_test(test_opacities),
        cmocka_unit_test(test_gaussians), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
