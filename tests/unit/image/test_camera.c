#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "image/camera.h"

static void near_vector(iso_vec3 got, iso_vec3 wanted, double tolerance) {
    if (!(iso_vec3_length(iso_vec3_sub(got, wanted)) <= tolerance))
        fail_msg("got (%g %g %g), wanted (%g %g %g)", got.x, got.y, got.z, wanted.x, wanted.y, wanted.z);
}

static iso_vec3 random_vector(uint32_t *seed) {
    iso_vec3 v;
    v.x = 2 * uniform(seed) - 1;
    v.y = 2 * uniform(seed) - 1;
    v.z = 2 * uniform(seed) - 1;
    return v;
}

static iso_camera preset(iso_direction direction, iso_vec3 up) {
    iso_camera camera = {.view_angle = 30, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors(direction, up, &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -10);
    return camera;
}

static iso_vec3 row(const iso_view *view, int k) {
    return iso_vec3_make(view->rotation[3 * k], view->rotation[3 * k + 1], view->rotation[3 * k + 2]);
}

/* What lies to the right, at the top and towards the viewer in each preset, in LPS. */
static void presets_are_anatomical(void **state) {
    (void)state;
    const struct {
        iso_direction direction;
        iso_vec3 right, up, towards;
    } table[] = {
        {ISO_FRONT, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {ISO_BACK, {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
        {ISO_LEFT, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}},   {ISO_RIGHT, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
        {ISO_TOP, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},    {ISO_BOTTOM, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
    };
    for (size_t k = 0; k < sizeof table / sizeof table[0]; k++) {
        iso_camera camera = preset(table[k].direction, iso_vec3_make(0, 0, 1));
        assert_int_equal(iso_camera_check(&camera, NULL), ISO_OK);
        iso_view view = iso_view_make(&camera, 100, 100);
        near_vector(row(&view, 0), table[k].right, 1e-15);
        near_vector(row(&view, 1), iso_vec3_scale(table[k].up, -1), 1e-15);
        near_vector(row(&view, 2), iso_vec3_scale(table[k].towards, -1), 1e-15);
    }
    iso_camera iso = preset(ISO_ISOMETRIC, iso_vec3_make(0, 0, 1));
    near_vector(iso_vec3_unit(iso.position), iso_vec3_unit(iso_vec3_make(1, -1, 1)), 1e-15);
}

static void presets_follow_the_up_axis(void **state) {
    (void)state;
    iso_vec3 forward, up;
    iso_direction_vectors(ISO_FRONT, iso_vec3_make(0, 1, 0), &forward, &up);
    near_vector(forward, iso_vec3_make(0, 0, -1), 1e-15); /* the usual view of y-up models */
    near_vector(up, iso_vec3_make(0, 1, 0), 1e-15);
    iso_direction_vectors(ISO_FRONT, iso_vec3_make(0, 0, -1), &forward, &up);
    near_vector(forward, iso_vec3_make(0, 1, 0), 1e-15);
    near_vector(up, iso_vec3_make(0, 0, -1), 1e-15);
    uint32_t seed = 2;
    for (int round = 0; round < 200; round++) {
        iso_vec3 axis = iso_vec3_unit(random_vector(&seed));
        for (int direction = ISO_FRONT; direction <= ISO_ISOMETRIC; direction++) {
            iso_vec3 f0, u0;
            iso_direction_vectors(direction, iso_vec3_make(0, 0, 1), &f0, &u0);
            iso_direction_vectors(direction, axis, &forward, &up);
            near(iso_vec3_dot(forward, axis), f0.z, 1e-12);
            near(iso_vec3_dot(up, axis), u0.z, 1e-12);
            near(iso_vec3_dot(forward, up), iso_vec3_dot(f0, u0), 1e-12);
            near(iso_vec3_length(forward), 1, 1e-12);
        }
    }
}

/* With view_up upright, orbiting is longitude and latitude of the eye. */
static void orbits_are_longitude_and_latitude(void **state) {
    (void)state;
    for (double azimuth = -360; azimuth <= 360; azimuth += 45)
        for (double elevation = -85; elevation <= 85; elevation += 17) {
            iso_camera camera = preset(ISO_FRONT, iso_vec3_make(0, 0, 1));
            camera.focal_point = iso_vec3_make(3, 4, 5);
            camera.position = iso_vec3_add(camera.position, camera.focal_point);
            iso_camera_orbit(&camera, azimuth, elevation);
            double a = azimuth * ISO_PI / 180, e = elevation * ISO_PI / 180;
            iso_vec3 wanted = {3 + 10 * sin(a) * cos(e), 4 - 10 * cos(a) * cos(e), 5 + 10 * sin(e)};
            near_vector(camera.position, wanted, 1e-12);
            near_vector(camera.view_up, iso_vec3_make(0, 0, 1), 0);
        }
}

/* Elevation goes through the poles without the picture flipping over: it equals many small steps. */
static void poles_do_not_flip(void **state) {
    (void)state;
    for (int step = -12; step <= 12; step++) {
        iso_camera once = preset(ISO_FRONT, iso_vec3_make(0, 0, 1)), many = once;
        iso_camera_orbit(&once, 20, 15.0 * step);
        assert_int_equal(iso_camera_check(&once, NULL), ISO_OK);
        iso_camera_orbit(&many, 20, 0);
        for (int i = 0; i < abs(step); i++) iso_camera_orbit(&many, 0, step > 0 ? 15 : -15);
        iso_view a = iso_view_make(&once, 10, 10), b = iso_view_make(&many, 10, 10);
        for (int k = 0; k < 3; k++) near_vector(row(&a, k), row(&b, k), 1e-9);
    }
    iso_camera top = preset(ISO_FRONT, iso_vec3_make(0, 0, 1));
    iso_camera_orbit(&top, 0, 90);
    iso_camera wanted = preset(ISO_TOP, iso_vec3_make(0, 0, 1));
    near_vector(top.position, wanted.position, 1e-12);
    near_vector(top.view_up, wanted.view_up, 1e-12);
}

static void pixel_of(const iso_view *view, iso_vec3 world, double *x, double *y, double *z) {
    iso_vec3 p = iso_view_point(view, world);
    double scale = view->orthographic ? view->focal : view->focal / p.z;
    *x = view->cx + p.x * scale;
    *y = view->cy + p.y * scale;
    *z = p.z;
}

static iso_camera random_camera(uint32_t *seed, bool orthographic) {
    iso_camera camera = {.orthographic = orthographic};
    camera.position = iso_vec3_scale(random_vector(seed), 50);
    camera.focal_point = iso_vec3_scale(random_vector(seed), 5);
    camera.view_up = random_vector(seed);
    camera.view_angle = 1 + 140 * uniform(seed);
    camera.parallel_scale = 1 + 20 * uniform(seed);
    return camera;
}

static void rays_hit_what_was_projected(void **state) {
    (void)state;
    uint32_t seed = 11;
    for (int round = 0; round < 2000; round++) {
        iso_camera camera = random_camera(&seed, round % 2);
        if (iso_camera_check(&camera, NULL) != ISO_OK) continue;
        iso_view view = iso_view_make(&camera, 640, 480);
        if (round % 3 == 0) view = iso_view_scaled(&view, 3);
        if (round % 5 == 0) view = iso_view_rows(&view, 100, 50);
        iso_vec3 world = iso_vec3_scale(random_vector(&seed), 20);
        double x, y, z;
        pixel_of(&view, world, &x, &y, &z);
        if (!camera.orthographic && z < 1e-3) continue;
        iso_vec3 origin, direction;
        iso_view_ray(&view, x, y, &origin, &direction);
        near_vector(iso_vec3_add(origin, iso_vec3_scale(direction, z)), world, 1e-9 * (100 + fabs(z)));
    }
}

/* A picture position's ray does not change when the picture is sampled more densely or in rows. */
static void windows_keep_their_rays(void **state) {
    (void)state;
    uint32_t seed = 19;
    for (int round = 0; round < 20; round++) {
        iso_camera camera = random_camera(&seed, round % 2);
        iso_view view = iso_view_make(&camera, 640, 480), dense = iso_view_scaled(&view, 3);
        iso_view rows = iso_view_rows(&dense, 700, 90);
        assert_int_equal(rows.width, 1920);
        assert_int_equal(dense.height, 1440);
        assert_int_equal(rows.height, 90);
        iso_vec3 origin[2], direction[2];
        double x = 640 * uniform(&seed), y = 480 * uniform(&seed);
        iso_view_ray(&view, x, y, &origin[0], &direction[0]);
        iso_view_ray(&rows, 3 * x, 3 * y - 700, &origin[1], &direction[1]);
        near_vector(origin[1], origin[0], 1e-9);
        near_vector(direction[1], direction[0], 1e-9);
    }
}

static void the_focal_point_is_in_the_middle(void **state) {
    (void)state;
    uint32_t seed = 3;
    iso_camera camera = random_camera(&seed, false);
    iso_view view = iso_view_make(&camera, 640, 480);
    double x, y, z;
    pixel_of(&view, camera.focal_point, &x, &y, &z);
    near(x, 320, 1e-9);
    near(y, 240, 1e-9);
    near(z, iso_vec3_length(iso_vec3_sub(camera.position, camera.focal_point)), 1e-9);
    near(view.near, 1e-4 * z, 1e-12);
    /* the upper edge of the picture is half the view angle away */
    iso_vec3 origin, direction;
    iso_view_ray(&view, 320, 0, &origin, &direction);
    direction = iso_view_vector(&view, direction);
    near(atan2(-direction.y, direction.z) * 360 / ISO_PI, camera.view_angle, 1e-9);
    camera.orthographic = true;
    view = iso_view_make(&camera, 640, 480);
    iso_view_ray(&view, 320, 0, &origin, &direction);
    near(iso_view_point(&view, origin).y, -camera.parallel_scale, 1e-9);
}

/* Largest |x|, |y| of the box in all turns, as parts of half the picture. */
static double reach(const iso_camera *camera, const iso_box *box, int turns, double *least_depth) {
    const int width = 800, height = 500;
    double most = 0;
    for (int turn = 0; turn < turns; turn++) {
        iso_camera turned = *camera;
        iso_camera_orbit(&turned, 360.0 * turn / turns, 0);
        iso_view view = iso_view_make(&turned, width, height);
        for (int corner = 0; corner < 8; corner++) {
            double x, y, z;
            pixel_of(&view, iso_box_corner(box, corner), &x, &y, &z);
            *least_depth = fmin(*least_depth, z - view.near);
            most = fmax(most, fmax(fabs(x / (width / 2.0) - 1), fabs(y / (height / 2.0) - 1)));
        }
    }
    return most;
}

static void fit_touches_the_margin(void **state) {
    (void)state;
    uint32_t seed = 17;
    for (int round = 0; round < 600; round++) {
        iso_camera camera = random_camera(&seed, round % 2);
        if (iso_camera_check(&camera, NULL) != ISO_OK) continue;
        iso_vec3 a = random_vector(&seed), b = random_vector(&seed);
        iso_box box = iso_box_empty();
        iso_box_add(&box, iso_vec3_scale(a, 30));
        iso_box_add(&box, iso_vec3_scale(b, 30));
        int turns = round % 3 == 0 ? 36 : 1;
        iso_camera_fit(&camera, &box, 1.6, turns);
        assert_int_equal(iso_camera_check(&camera, NULL), ISO_OK);
        double depth = INFINITY;
        near(reach(&camera, &box, turns, &depth), 0.92, 1e-9);
        if (!camera.orthographic) assert_true(depth > 0);
        near_vector(camera.focal_point, iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5), 1e-12);
    }
}

typedef struct cloud {
    iso_vec3 points[40];
    int count;
} cloud;

static iso_box cloud_bounds(void *context, const iso_vec3 vectors[3]) {
    const cloud *c = context;
    iso_box box = iso_box_empty();
    for (int i = 0; i < c->count; i++)
        iso_box_add(&box, iso_vec3_make(iso_vec3_dot(vectors[0], c->points[i]),
                                        iso_vec3_dot(vectors[1], c->points[i]),
                                        iso_vec3_dot(vectors[2], c->points[i])));
    return box;
}

/* Box of the points in a picture that reaches from -1 to 1 both ways; depth is the smallest one. */
static iso_box picture_box(const iso_camera *camera, const cloud *c, double aspect, double *depth) {
    const iso_view view = iso_view_make(camera, (int)(aspect * 1000), 1000);
    iso_box box = iso_box_empty();
    for (int i = 0; i < c->count; i++) {
        const iso_vec3 p = iso_view_point(&view, c->points[i]);
        const double scale = view.focal / (camera->orthographic ? 1 : p.z) / 500;
        iso_box_add(&box, iso_vec3_make(p.x * scale / aspect, p.y * scale, 0));
        *depth = fmin(*depth, p.z);
    }
    return box;
}

/* Points fill the picture in one direction, exactly, and lie in the middle of both; turns share one camera
 * that shows them all. */
static void tight_fit_frames_the_points(void **state) {
    (void)state;
    uint32_t seed = 23;
    for (int round = 0; round < 600; round++) {
        iso_camera camera = random_camera(&seed, round % 2);
        cloud c = {.count = round % 10 ? 40 : 1};
        for (int i = 0; i < c.count; i++) c.points[i] = iso_vec3_scale(random_vector(&seed), 30);
        if (iso_camera_check(&camera, NULL) != ISO_OK) continue;
        const double fill = round % 3 ? 1 : 0.8;
        const iso_fit fit = {.aspect = 1.6,
                             .turns = round % 5 == 0 ? 12 : 1,
                             .fill = fill,
                             .bounds = cloud_bounds,
                             .context = &c};
        iso_camera_fit_tight(&camera, iso_vec3_make(1, 2, 3), &fit);
        assert_int_equal(iso_camera_check(&camera, NULL), ISO_OK);
        double depth = INFINITY, most = 0;
        for (int turn = 0; turn < fit.turns; turn++) {
            iso_camera turned = camera;
            if (turn) iso_camera_orbit(&turned, 360.0 * turn / fit.turns, 0);
            const iso_box box = picture_box(&turned, &c, fit.aspect, &depth);
            most = fmax(most, fmax(fmax(box.hi.x, -box.lo.x), fmax(box.hi.y, -box.lo.y)));
            if (fit.turns > 1) continue;
            near(box.hi.x + box.lo.x, 0, 1e-3);
            near(box.hi.y + box.lo.y, 0, 1e-3);
        }
        if (!camera.orthographic) assert_true(depth > 0);
        /* (less where the eye would have to be among the points) */
        if (c.count > 1 && (camera.orthographic || camera.view_angle < 60)) near(most, fill, 1e-6);
        assert_true(most < fill + 1e-6);
    }
}

static void fit_survives_flat_boxes(void **state) {
    (void)state;
    const iso_box boxes[] = {
        {{1, 2, 3}, {1, 2, 3}}, {{1, -5, 3}, {1, 5, 3}}, {{0, 2, 0}, {4, 2, 4}}, {{0, 0, 0}, {0, 9, 9}}};
    for (int k = 0; k < 8; k++) {
        iso_camera camera = preset(ISO_FRONT, iso_vec3_make(0, 0, 1));
        camera.orthographic = k % 2;
        iso_camera_fit(&camera, &boxes[k / 2], 1, 1);
        assert_int_equal(iso_camera_check(&camera, NULL), ISO_OK);
        double depth = INFINITY;
        assert_true(reach(&camera, &boxes[k / 2], 1, &depth) < 1);
        if (!camera.orthographic) assert_true(depth > 0);
    }
}

static void zoom_is_exact(void **state) {
    (void)state;
    const double factors[] = {0.2, 1, 1.5, 4, 1000};
    for (double angle = 1; angle < 179; angle += 8.9)
        for (int k = 0; k < 10; k++) {
            iso_camera camera = preset(ISO_FRONT, iso_vec3_make(0, 0, 1));
            camera.view_angle = angle;
            camera.orthographic = k % 2;
            iso_view before = iso_view_make(&camera, 64, 64);
            iso_camera_zoom(&camera, factors[k / 2]);
            iso_view after = iso_view_make(&camera, 64, 64);
            near(after.focal / before.focal / factors[k / 2], 1, 1e-9);
        }
}

static void bad_cameras_are_refused(void **state) {
    (void)state;
    const iso_camera good = preset(ISO_FRONT, iso_vec3_make(0, 0, 1));
    iso_camera bad[9];
    for (int k = 0; k < 9; k++) bad[k] = good;
    bad[0].position = bad[0].focal_point;
    bad[1].view_up = iso_vec3_make(0, 3, 0);
    bad[2].view_up = iso_vec3_make(0, 0, 0);
    bad[3].view_angle = 0;
    bad[4].view_angle = 180;
    bad[5].view_angle = NAN;
    bad[6].position.x = INFINITY;
    bad[7].orthographic = true;
    bad[7].parallel_scale = 0;
    bad[8].view_up.z = NAN;
    for (int k = 0; k < 9; k++) {
        iso_error error = {0};
        assert_int_equal(iso_camera_check(&bad[k], &error), ISO_ERR_USAGE);
        assert_non_null(strstr(error.text, "camera"));
    }
    assert_int_equal(iso_camera_check(&good, NULL), ISO_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(presets_are_anatomical),
        cmocka_unit_test(presets_follow_the_up_axis),
        cmocka_unit_test(orbits_are_longitude_and_latitude),
        cmocka_unit_test(poles_do_not_flip),
        cmocka_unit_test(rays_hit_what_was_projected),
        cmocka_unit_test(windows_keep_their_rays),
        cmocka_unit_test(the_focal_point_is_in_the_middle),
        cmocka_unit_test(fit_touches_the_margin),
        cmocka_unit_test(tight_fit_frames_the_points),
        cmocka_unit_test(fit_survives_flat_boxes),
        cmocka_unit_test(zoom_is_exact),
        cmocka_unit_test(bad_cameras_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
