#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "grids/scenes/scenes.h"
#include "scene/method.h"
#include "study_support.h"

/* ---- views ---- */

static void pixel_of(const iso_view *view, iso_vec3 world, double pixel[2]) {
    iso_vec3 p = iso_view_point(view, world);
    pixel[0] = view->cx + view->focal * p.x / p.z;
    pixel[1] = view->cy + view->focal * p.y / p.z;
}

static void the_ball_fits_exactly(void **state) {
    (void)state;
    const iso_study_ball ball = {{3, -2, 7}, 5};
    for (int turn = 0; turn < 5; turn++) {
        iso_view view = iso_study_fit(&ball, 256, 0.5 * turn);
        double pixel[2];
        pixel_of(&view, ball.center, pixel);
        near(pixel[0], 128, 1e-9);
        near(pixel[1], 128, 1e-9);
        /* the rays through the middles of the picture's sides touch the ball */
        iso_vec3 origin, ray;
        for (int side = 0; side < 4; side++) {
            iso_view_ray(&view, side < 2 ? 256 * side : 128, side < 2 ? 128 : 256 * (side - 2), &origin,
                         &ray);
            iso_vec3 to_center = iso_vec3_sub(ball.center, origin);
            near(iso_vec3_length(iso_vec3_cross(to_center, iso_vec3_unit(ray))), 5, 1e-9);
        }
        /* up is up, and the rows of the rotation are a right-handed system */
        double up[2];
        pixel_of(&view, iso_vec3_make(3, -2, 8), up);
        assert_true(up[1] < 128);
        near(up[0], 128, 1e-9);
        const double *r = view.rotation;
        iso_vec3 z = iso_vec3_cross(iso_vec3_make(r[0], r[1], r[2]), iso_vec3_make(r[3], r[4], r[5]));
        near(z.x, r[6], 1e-12);
        near(z.y, r[7], 1e-12);
        near(z.z, r[8], 1e-12);
    }
    /* from the right of the front (-y), and from above */
    iso_vec3 outward = iso_vec3_unit(iso_vec3_sub(iso_study_fit(&ball, 256, 0).eye, ball.center));
    near(outward.x, sin(0.6) * cos(0.35), 1e-12);
    near(outward.y, -cos(0.6) * cos(0.35), 1e-12);
    near(outward.z, sin(0.35), 1e-12);
    outward = iso_vec3_unit(iso_vec3_sub(iso_study_fit(&ball, 256, 10).eye, ball.center));
    near(outward.x, sin(0.6 + 10 * ISO_PI / 180) * cos(0.35), 1e-12);
}

static void zooming_keeps_the_aim_in_the_middle(void **state) {
    (void)state;
    const iso_study_ball ball = {{0, 0, 0}, 2};
    const int aim[2] = {40, 170};
    iso_view fit = iso_study_fit(&ball, 192, 0), near_view = iso_study_zoom(&fit, aim, 4);
    iso_vec3 origin, ray;
    double pixel[2];
    iso_view_ray(&fit, 40.5, 170.5, &origin, &ray);
    pixel_of(&near_view, iso_vec3_add(origin, iso_vec3_scale(ray, 3)), pixel);
    near(pixel[0], 96, 1e-9);
    near(pixel[1], 96, 1e-9);
    double other[2];
    iso_view_ray(&fit, 41.5, 170.5, &origin, &ray);
    pixel_of(&near_view, iso_vec3_add(origin, iso_vec3_scale(ray, 3)), other);
    near(other[0] - pixel[0], 4, 1e-9);
}

static void aim_is_the_nearest_pixel_that_will_do(void **state) {
    (void)state;
    enum { SIDE = 128 };
    static uint8_t mask[SIDE * SIDE];
    int aim[2];
    memset(mask, 0, sizeof mask);
    assert_int_equal(iso_study_aim(mask, SIDE, aim, NULL), ISO_OK);
    assert_true(aim[0] == 64 && aim[1] == 64); /* nothing to aim at */
    memset(mask, 1, sizeof mask);
    assert_int_equal(iso_study_aim(mask, SIDE, aim, NULL), ISO_OK);
    assert_true(aim[0] == 64 && aim[1] == 64); /* no silhouette anywhere */
    /* covered from column 70 on: of the squares of 32 and 8 pixels around x, the share 70 .. x + 15 (x + 3);
     * the narrow one asks for x >= 70, and covered is x >= 70 */
    for (int i = 0; i < SIDE * SIDE; i++) mask[i] = i % SIDE >= 70;
    assert_int_equal(iso_study_aim(mask, SIDE, aim, NULL), ISO_OK);
    assert_int_equal(aim[0], 70);
    assert_int_equal(aim[1], 64);
    /* covered up to column 79: half of the narrow square of pixels x - 4 .. x + 3 is there for x <= 80, but x
     * must be covered, and nearer to the middle more than 95 percent are, until x = 77 */
    for (int i = 0; i < SIDE * SIDE; i++) mask[i] = i % SIDE < 80;
    assert_int_equal(iso_study_aim(mask, SIDE, aim, NULL), ISO_OK);
    assert_int_equal(aim[0], 77);
    /* a small hole in the middle is a silhouette in the narrow square only: not enough; the border at column
     * 30 is one in both, from 87.5 percent of the narrow square on */
    for (int i = 0; i < SIDE * SIDE; i++) mask[i] = i % SIDE >= 30;
    for (int i = 0; i < 9; i++) mask[(60 + i / 3) * SIDE + 60 + i % 3] = 0;
    assert_int_equal(iso_study_aim(mask, SIDE, aim, NULL), ISO_OK);
    assert_true(aim[0] == 33 && aim[1] == 64);
}

static void medians_are_in_the_middle(void **state) {
    (void)state;
    double odd[] = {5, 1, 4, 2, 3}, even[] = {40, 10, 30, 20}, one[] = {7};
    near(iso_study_median(odd, 5), 3, 0);
    near(iso_study_median(even, 4), 25, 0);
    near(iso_study_median(one, 1), 7, 0);
    assert_true(isnan(iso_study_median(one, 0)));
}

/* ---- pictures ---- */

typedef struct fixture {
    iso_grid grid;
    iso_scene_surface surface;
    iso_study_ball ball;
} fixture;

static void open_scene(fixture *f, const char *name) {
    memset(f, 0, sizeof *f);
    iso_scene_opts opts = {.size = 32};
    assert_int_equal(iso_scene_create(name, &opts, &f->grid, &f->surface.isovalue, NULL), ISO_OK);
    f->surface.grid = f->grid;
    for (int part = 0; part < ISO_PART_COUNT; part++) {
        assert_false(iso_scene_surface_has(&f->surface, (iso_part)part));
        assert_int_equal(iso_scene_surface_prepare(&f->surface, (iso_part)part, NULL), ISO_OK);
        assert_true(iso_scene_surface_has(&f->surface, (iso_part)part));
        assert_int_equal(iso_scene_surface_prepare(&f->surface, (iso_part)part, NULL), ISO_OK);
    }
    iso_mesh_view mesh = iso_mesh_set_view(f->surface.mesh);
    assert_int_equal(iso_study_bound(&mesh, &f->ball, NULL), ISO_OK);
}

static void close_scene(fixture *f) {
    iso_scene_surface_free(&f->surface);
    iso_grid_destroy(&f->grid);
}

static void balls_bound_the_surface(void **state) {
    (void)state;
    fixture f;
    open_scene(&f, "sphere"); /* of radius 12.8 around (15.5, 15.5, 15.5) */
    near(f.ball.radius, 12.8, 0.05);
    near(f.ball.center.x, 15.5, 0.02);
    near(f.ball.center.y, 15.5, 0.02);
    near(f.ball.center.z, 15.5, 0.02);
    close_scene(&f);
    iso_mesh_view nothing = {.transform = iso_transform_identity()};
    assert_int_equal(iso_study_bound(&nothing, &f.ball, NULL), ISO_ERR_EMPTY);
}

/* All methods show nearly the same, and none is the truth itself. */
static void every_method_draws(void **state) {
    (void)state;
    enum { SIDE = 128 };
    fixture f;
    open_scene(&f, "torus");
    iso_view view = iso_study_fit(&f.ball, SIDE, 0);
    iso_study_look look = {.color = {200, 100, 50}, .background = {1, 2, 3}};
    iso_study_frame truth, frame;
    assert_int_equal(iso_study_frame_create(SIDE, true, &truth, NULL), ISO_OK);
    assert_int_equal(iso_study_frame_create(SIDE, true, &frame, NULL), ISO_OK);
    assert_int_equal(iso_study_draw(&f.surface, iso_renderer_truth(), &view, &look, &truth, NULL), ISO_OK);
    iso_compare_picture a = iso_study_picture(&truth), b = iso_study_picture(&frame);
    size_t count;
    const iso_renderer *methods = iso_renderer_list(&count);
    assert_true(count >= 2);
    for (size_t m = 0; m < count; m++) {
        assert_true(methods[m].needs && methods[m].name[0] && methods[m].title[0]);
        assert_int_equal(iso_study_draw(&f.surface, &methods[m], &view, &look, &frame, NULL), ISO_OK);
        iso_compare_opts opts = {.background = look.background, .voxel = 1};
        iso_metrics metrics;
        assert_int_equal(iso_compare(&a, &b, &opts, &metrics, NULL), ISO_OK);
        assert_int_equal(metrics.sources[0], ISO_SILHOUETTE_COVERAGE);
        assert_true(metrics.iou > 0.8);
        assert_true(metrics.normal_error_deg < 20 && metrics.depth_error_voxel < 1);
        assert_true(metrics.psnr_in > 12);
    }
    iso_study_frame_free(&truth);
    iso_study_frame_free(&frame);
    close_scene(&f);
}

/* The centre of a sphere faces the eye: there the light is known. */
static void light_is_what_the_header_says(void **state) {
    (void)state;
    enum { SIDE = 65, MIDDLE = SIDE / 2 * SIDE + SIDE / 2 };
    fixture f;
    open_scene(&f, "sphere");
    iso_view view = iso_study_fit(&f.ball, SIDE, 0);
    iso_study_look look = {.color = {100, 200, 50}, .background = {31, 33, 41}};
    iso_study_frame frame;
    static float color[3 * SIDE * SIDE];
    assert_int_equal(iso_study_frame_create(SIDE, true, &frame, NULL), ISO_OK);
    assert_int_equal(iso_study_draw(&f.surface, iso_renderer_truth(), &view, &look, &frame, NULL), ISO_OK);
    iso_study_shade(&frame, &view, &look, color);
    near((double)color[0], 31, 0);
    near((double)color[2], 41, 0);
    near((double)color[3 * MIDDLE], 100 * 0.95 + 0.3 * 255, 0.5);
    near((double)color[3 * MIDDLE + 1], 255, 0); /* 200 * 0.95 + 76.5 is more */
    near((double)color[3 * MIDDLE + 2], 50 * 0.95 + 0.3 * 255, 0.5);
    for (int i = 0; i < 3; i++) frame.aov.normal[i][MIDDLE] *= -1; /* both sides are lit */
    static float turned[3 * SIDE * SIDE];
    iso_study_shade(&frame, &view, &look, turned);
    assert_memory_equal(color, turned, sizeof color);
    iso_study_frame_free(&frame);
    close_scene(&f);
}

static void change_by_hand(void **state) {
    (void)state;
    iso_study_frame a, b;
    assert_int_equal(iso_study_frame_create(2, true, &a, NULL), ISO_OK);
    assert_int_equal(iso_study_frame_create(2, true, &b, NULL), ISO_OK);
    for (int i = 0; i < 4; i++) a.aov.coverage[i] = b.aov.coverage[i] = 0;
    assert_true(isnan(iso_study_change(&a, &b)));
    memset(a.image.rgba, 10, 16);
    memset(b.image.rgba, 10, 16);
    memset(b.image.rgba + 12, 99, 4); /* covered by neither: not counted */
    b.image.rgba[0] = 40;
    b.image.rgba[5] = 4;
    a.aov.coverage[0] = b.aov.coverage[1] = a.aov.coverage[2] = 1;
    near(iso_study_change(&a, &b), (30.0 + 6.0) / 9, 1e-12);
    iso_study_frame_free(&a);
    iso_study_frame_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ball_fits_exactly),
        cmocka_unit_test(zooming_keeps_the_aim_in_the_middle),
        cmocka_unit_test(aim_is_the_nearest_pixel_that_will_do),
        cmocka_unit_test(medians_are_in_the_middle),
        cmocka_unit_test(balls_bound_the_surface),
        cmocka_unit_test(every_method_draws),
        cmocka_unit_test(light_is_what_the_header_says),
        cmocka_unit_test(change_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
