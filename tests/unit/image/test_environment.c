/* environment: directions and pictures against libm and against the files' own values; the studio; files that
 * are no environments. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/srgb.h"
#include "check_support.h"
#include "exr_files.h"
#include "file_support.h"
#include "image/camera.h"
#include "image/environment.h"
#include "image/image.h"

static const char *const EXR_PATH = ISO_TEST_TMP "/environment_test.exr";
static const char *const PNG_PATH = ISO_TEST_TMP "/environment_test.png";

static iso_vec3 random_direction(uint32_t *seed) {
    return iso_vec3_make(uniform(seed) - 0.5, uniform(seed) - 0.5, uniform(seed) - 0.5);
}

/* ---- functions that replace libm's */

static void angles_are_those_of_libm(void **state) {
    (void)state;
    uint32_t seed = 1;
    for (int i = 0; i < 100000; i++) {
        const iso_vec3 v = random_direction(&seed);
        near(iso_atan2(v.y, v.x), atan2(v.y, v.x), 1e-11);
    }
    const double axis[] = {0, 1, -1};
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 3; x++)
            near(iso_atan2(axis[y], axis[x]), x || y ? atan2(axis[y], axis[x]) : 0, 1e-15);
}

static void display_values_survive(void **state) {
    (void)state;
    for (int i = 0; i < 256; i++) {
        const double light = iso_srgb_decode(i / 255.0);
        near(light, i <= 10 ? i / 255.0 / 12.92 : pow((i / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
        assert_int_equal((int)(iso_srgb_encode(light) * 255 + 0.5), i);
    }
    assert_true(iso_srgb_encode(NAN) == 0 && iso_srgb_encode(-1) == 0 && iso_srgb_encode(7) == 1);
}

/* ---- looking up */

enum { WIDTH = 64, HEIGHT = 32 };

/* Random pixels in 0 .. 2. */
static void fill(float rgb[3 * WIDTH * HEIGHT]) {
    uint32_t seed = 5;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) rgb[i] = (float)(2 * uniform(&seed));
}

static double pixel(const float *rgb, int x, int y, int k) {
    y = y < 0 ? 0 : y >= HEIGHT ? HEIGHT - 1 : y;
    return (double)rgb[3 * (y * WIDTH + (x + WIDTH) % WIDTH) + k];
}

/* What environment.h says, with libm: front is +y, right +x, up +z. */
static double wanted_light(const float *rgb, iso_vec3 d, int k) {
    const double x = (0.5 + atan2(d.x, d.y) / (2 * ISO_PI)) * WIDTH - 0.5,
                 y = acos(d.z / iso_vec3_length(d)) / ISO_PI * HEIGHT - 0.5;
    const int left = (int)floor(x), top = (int)floor(y);
    const double u = x - left, v = y - top;
    return (pixel(rgb, left, top, k) * (1 - u) + pixel(rgb, left + 1, top, k) * u) * (1 - v) +
           (pixel(rgb, left, top + 1, k) * (1 - u) + pixel(rgb, left + 1, top + 1, k) * u) * v;
}

static void directions_are_looked_up(void **state) {
    (void)state;
    float rgb[3 * WIDTH * HEIGHT];
    iso_environment *environment;
    uint32_t seed = 2;
    fill(rgb);
    assert_int_equal(iso_environment_create(WIDTH, HEIGHT, rgb, &environment, NULL), ISO_OK);
    for (int i = 0; i < 20000; i++) {
        double light[3];
        iso_vec3 d = random_direction(&seed);
        if (i % 10 == 0) d.x *= 1e-9; /* near the seam and the poles */
        if (i % 20 == 0) d.y *= 1e-9;
        iso_environment_look(environment, d, light);
        for (int k = 0; k < 3; k++) near(light[k], wanted_light(rgb, d, k), 1e-6);
    }
    iso_environment_destroy(environment);
}

/* With another up axis the same is seen in directions turned with it. */
static void the_world_may_have_another_up_axis(void **state) {
    (void)state;
    const iso_vec3 ups[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
    float rgb[3 * WIDTH * HEIGHT];
    iso_environment *plain, *turned;
    uint32_t seed = 2;
    fill(rgb);
    assert_int_equal(iso_environment_create(WIDTH, HEIGHT, rgb, &plain, NULL), ISO_OK);
    assert_int_equal(iso_environment_create(WIDTH, HEIGHT, rgb, &turned, NULL), ISO_OK);
    for (int i = 0; i < 300; i++) {
        iso_vec3 front, up;
        double a[3], b[3];
        iso_environment_set_up(turned, ups[i % 3]);
        iso_direction_vectors(ISO_FRONT, ups[i % 3], &front, &up);
        const iso_vec3 d = random_direction(&seed), right = iso_vec3_cross(front, up);
        const iso_vec3 same = iso_vec3_add(iso_vec3_scale(right, d.x),
                                           iso_vec3_add(iso_vec3_scale(front, d.y), iso_vec3_scale(up, d.z)));
        iso_environment_look(plain, d, a);
        iso_environment_look(turned, same, b);
        for (int k = 0; k < 3; k++) near(b[k], a[k], 1e-6);
    }
    iso_environment_destroy(plain);
    iso_environment_destroy(turned);
}

/* A quarter turn about the up axis shows the same. */
static void the_studio_is_bright_ahead_and_even_to_all_sides(void **state) {
    (void)state;
    iso_environment *studio;
    uint32_t seed = 3;
    double light[3], turned[3];
    assert_int_equal(iso_environment_studio(&studio, NULL), ISO_OK);
    iso_environment_look(studio, iso_vec3_make(0, 1, 0), light);
    assert_true(light[0] > 0.5 && light[0] < 1);
    for (int i = 0; i < 2000; i++) {
        const iso_vec3 d = random_direction(&seed);
        iso_environment_look(studio, d, light);
        iso_environment_look(studio, iso_vec3_make(d.y, -d.x, d.z), turned);
        for (int k = 0; k < 3; k++) near(turned[k], light[k], 1e-4);
    }
    iso_environment_destroy(studio);
}

/* ---- files */

static float value(int channel, int x, int y) {
    return (float)(channel * 64 + x * 4 + y % 4) / 32 - 1;
}

static float nan_value(int channel, int x, int y) {
    return channel == 1 && x == 5 && y == 3 ? NAN : value(channel, x, y);
}

static float infinite_value(int channel, int x, int y) {
    return channel == 2 && x == 0 && y == 1 ? INFINITY : value(channel, x, y);
}

static exr_picture good_picture(void) {
    return (exr_picture){
        .width = 16, .height = 8, .names = {"B", "G", "R"}, .value = value, .compression = 3};
}

/* The light at the middle of pixel (x, y). */
static void look_at_pixel(const iso_environment *environment, int x, int y, double rgb[3]) {
    int size[2];
    iso_environment_size(environment, size);
    const double azimuth = ((x + 0.5) / size[0] - 0.5) * 2 * ISO_PI, polar = (y + 0.5) / size[1] * ISO_PI;
    iso_environment_look(
        environment, iso_vec3_make(sin(polar) * sin(azimuth), sin(polar) * cos(azimuth), cos(polar)), rgb);
}

static void exr_pictures_are_read(void **state) {
    (void)state;
    for (int half = 0; half < 2; half++) {
        exr_picture picture = good_picture();
        iso_environment *environment;
        iso_error error = {0};
        double rgb[3];
        picture.half = half;
        assert_int_equal(exr_write(EXR_PATH, &picture), 0);
        test_ok(iso_environment_read(EXR_PATH, UINT64_MAX, NULL, &environment, &error), &error);
        for (int y = 0; y < 8; y++)
            for (int x = 0; x < 16; x++) {
                look_at_pixel(environment, x, y, rgb);
                for (int k = 0; k < 3; k++) near(rgb[k], fmax(0, (double)value(2 - k, x, y)), 1e-6);
            }
        iso_environment_destroy(environment);
    }
}

static void write_png(int width, int height) {
    iso_image image;
    assert_int_equal(iso_image_create(width, height, &image, NULL), ISO_OK);
    for (int i = 0; i < 4 * width * height; i++) image.rgba[i] = (uint8_t)(i % 4 == 3 ? 255 : i * 7);
    assert_int_equal(iso_png_write(PNG_PATH, &image, NULL, 0, NULL), ISO_OK);
    iso_image_free(&image);
}

static void png_pictures_are_read(void **state) {
    (void)state;
    iso_environment *environment;
    double rgb[3];
    write_png(16, 8);
    assert_int_equal(iso_environment_read(PNG_PATH, UINT64_MAX, NULL, &environment, NULL), ISO_OK);
    for (int i = 0; i < 16 * 8; i++) {
        look_at_pixel(environment, i % 16, i / 16, rgb);
        for (int k = 0; k < 3; k++) near(rgb[k], iso_srgb_decode((uint8_t)((4 * i + k) * 7) / 255.0), 1e-6);
    }
    iso_environment_destroy(environment);
}

/* The file is refused with `status`, in one line that names it and holds `reason`. */
static void assert_refused(const char *path, iso_status status, const char *reason) {
    iso_environment *environment = NULL;
    iso_error error = {0};
    assert_int_equal(iso_environment_read(path, UINT64_MAX, NULL, &environment, &error), status);
    if (!strstr(error.text, path) || strchr(error.text, '\n') || !strstr(error.text, reason))
        fail_msg("'%s' where '%s' belongs", error.text, reason);
    assert_null(environment);
}

static void unfit_files_are_refused(void **state) {
    (void)state;
    exr_picture picture = good_picture();
    picture.value = nan_value;
    assert_int_equal(exr_write(EXR_PATH, &picture), 0);
    assert_refused(EXR_PATH, ISO_ERR_FORMAT, "pixel 5,3 is NaN or infinite");
    picture.value = infinite_value;
    assert_int_equal(exr_write(EXR_PATH, &picture), 0);
    assert_refused(EXR_PATH, ISO_ERR_FORMAT, "pixel 0,1 is NaN or infinite");
    picture = good_picture();
    picture.names[1] = "other";
    assert_int_equal(exr_write(EXR_PATH, &picture), 0);
    assert_refused(EXR_PATH, ISO_ERR_FORMAT, "channel G is missing (R, G and B are needed)");
    const int sides[][2] = {{1, 1}, {1, 9}, {9, 1}};
    for (size_t i = 0; i < 3; i++) {
        write_png(sides[i][0], sides[i][1]);
        assert_refused(PNG_PATH, ISO_ERR_FORMAT, "no environment");
    }
    spill(EXR_PATH, "hello", 5);
    assert_refused(EXR_PATH, ISO_ERR_FORMAT, "not a readable OpenEXR picture");
    assert_refused(ISO_TEST_TMP "/none.exr", ISO_ERR_IO, "");
    assert_refused(ISO_TEST_TMP "/none.png", ISO_ERR_IO, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_are_those_of_libm),
        cmocka_unit_test(display_values_survive),
        cmocka_unit_test(directions_are_looked_up),
        cmocka_unit_test(the_world_may_have_another_up_axis),
        cmocka_unit_test(the_studio_is_bright_ahead_and_even_to_all_sides),
        cmocka_unit_test(exr_pictures_are_read),
        cmocka_unit_test(png_pictures_are_read),
        cmocka_unit_test(unfit_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
