/* Shading and measuring of strips, held against one sample at a time. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "render/shading/shading.h"

static const iso_rgb COLORS[] = {{200, 120, 40}, {40, 160, 220}, {0, 255, 7}};

/* A strip of random samples: runs of surfaces and of nothing. */
typedef struct subject {
    iso_view view;
    iso_gbuffer gbuffer;
    iso_strip strip;
    iso_shading shading;
    iso_image image;
} subject;

static void random_sample(subject *s, size_t i, uint8_t surface, uint32_t *seed) {
    s->gbuffer.surface[i] = surface;
    float n[3] = {(float)uniform(seed) - 0.5f, (float)uniform(seed) - 0.5f, (float)uniform(seed) - 0.5f};
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    /* what lies where nothing was drawn must not matter */
    s->gbuffer.depth[i] = surface == ISO_SURFACE_NONE ? NAN : 5 + 100 * (float)uniform(seed);
    for (int axis = 0; axis < 3; axis++)
        s->gbuffer.normal[axis][i] = surface == ISO_SURFACE_NONE ? NAN : n[axis] / length;
}

static void make_subject(subject *s, int width, int rows, int factor, uint32_t seed) {
    const iso_camera camera = {.position = {3, -20, 9},
                               .view_up = {0.2, 0, 1},
                               .view_angle = 70,
                               .orthographic = seed % 3 == 0,
                               .parallel_scale = 4};
    enum { ABOVE = 5 };
    iso_view view = iso_view_make(&camera, width, rows + ABOVE + 2);
    view = iso_view_scaled(&view, factor);
    *s = (subject){.view = iso_view_rows(&view, ABOVE * factor, rows * factor)};
    assert_int_equal(iso_gbuffer_create(s->view.width, s->view.height, &s->gbuffer, NULL), ISO_OK);
    assert_int_equal(iso_image_create(width, rows + ABOVE + 2, &s->image, NULL), ISO_OK);
    memset(s->image.rgba, 77, (size_t)width * (size_t)(rows + ABOVE + 2) * 4);
    s->strip = (iso_strip){&s->view, &s->gbuffer, factor, ABOVE};
    s->shading = (iso_shading){COLORS, 1 + (int)(seed % 3), {10, 20, 30}, seed % 2, {0, 0, 0}};
    uint8_t surface = 0;
    size_t count = (size_t)s->view.width * (size_t)s->view.height;
    for (size_t i = 0; i < count; i++) {
        if (random_bits(&seed) % 16 == 0)
            surface = random_bits(&seed) % 2 ? ISO_SURFACE_NONE : (uint8_t)(random_bits(&seed) % 5);
        random_sample(s, i, surface, &seed);
    }
}

static void free_subject(subject *s) {
    iso_gbuffer_free(&s->gbuffer);
    iso_image_free(&s->image);
}

/* The colour of a covered sample. */
static void shade_sample(const subject *s, int x, int y, float rgb[3]) {
    const iso_view *view = &s->view;
    size_t i = (size_t)y * (size_t)view->width + (size_t)x;
    const float n[3] = {s->gbuffer.normal[0][i], s->gbuffer.normal[1][i], s->gbuffer.normal[2][i]};
    float eye[3] = {0, 0, -1};
    if (!view->orthographic) {
        eye[0] = -(float)((x + 0.5 - view->cx) / view->focal);
        eye[1] = -(float)((y + 0.5 - view->cy) / view->focal);
    }
    int last = s->shading.color_count - 1, surface = s->gbuffer.surface[i];
    iso_shade_sample(n, eye, COLORS[surface < last ? surface : last], rgb);
}

/* Sums of the covered samples of a pixel, each rounded to 0 .. 255: columns first. */
static int sum_samples(const subject *s, int x, int y, float sum[3]) {
    int factor = s->strip.factor, covered = 0;
    for (int i = x * factor; i < (x + 1) * factor; i++) {
        float column[3] = {0, 0, 0};
        for (int j = y * factor; j < (y + 1) * factor; j++) {
            if (s->gbuffer.surface[(size_t)j * (size_t)s->view.width + (size_t)i] == ISO_SURFACE_NONE)
                continue;
            float rgb[3];
            shade_sample(s, i, j, rgb);
            for (int c = 0; c < 3; c++) column[c] += floorf(rgb[c] * 255 + 0.5f);
            covered++;
        }
        for (int c = 0; c < 3; c++) sum[c] += column[c];
    }
    return covered;
}

static size_t reference_pixel(const subject *s, int x, int y, uint8_t rgba[4]) {
    float sum[3] = {0, 0, 0};
    int covered = sum_samples(s, x, y, sum);
    const iso_rgb back = s->shading.background;
    const uint8_t background[4] = {back.r, back.g, back.b, 255};
    memset(rgba, 0, 4);
    if (covered == 0 && !s->shading.transparent) memcpy(rgba, background, 4);
    if (covered == 0) return 0;
    float part = (float)covered / (float)(s->strip.factor * s->strip.factor);
    for (int c = 0; c < 3; c++) {
        float value = sum[c] / ((float)covered * 255);
        if (!s->shading.transparent) value = value * part + (float)background[c] / 255 * (1 - part);
        rgba[c] = (uint8_t)(value * 255 + 0.5f);
    }
    rgba[3] = s->shading.transparent ? (uint8_t)(part * 255 + 0.5f) : 255;
    return (size_t)covered;
}

static void assert_shaded(const subject *s, const iso_image *wanted, size_t covered, iso_pool *pool) {
    size_t bytes = (size_t)wanted->width * (size_t)wanted->height * 4;
    for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
        if (iso_cpu_limit((iso_cpu_level)level) != (iso_cpu_level)level) continue; /* ISO_CPU forbids it */
        iso_image image;
        assert_int_equal(iso_image_create(wanted->width, wanted->height, &image, NULL), ISO_OK);
        memset(image.rgba, 77, bytes);
        assert_int_equal(iso_shade(&s->shading, &s->strip, &image, pool), covered);
        assert_memory_equal(image.rgba, wanted->rgba, bytes);
        iso_image_free(&image);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
}

static void every_sample_is_shaded_alike(void **state) {
    (void)state;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    const int widths[] = {1, 3, 15, 16, 37, 130, 1030};
    for (uint32_t k = 0; k < 7 * ISO_FACTOR_MAX; k++) {
        subject s;
        make_subject(&s, widths[k % 7], 1 + (int)k % 41, 1 + (int)k / 7, k + 1);
        size_t covered = 0;
        for (int y = 0; y < s.view.height / s.strip.factor; y++)
            for (int x = 0; x < s.image.width; x++)
                covered += reference_pixel(
                    &s, x, y,
                    s.image.rgba + ((size_t)(y + s.strip.y0) * (size_t)s.image.width + (size_t)x) * 4);
        assert_shaded(&s, &s.image, covered, k % 2 ? pool : NULL);
        free_subject(&s);
    }
    iso_pool_destroy(pool);
}

/* Normals without a direction, or with a bad one, give some colour and nothing worse. */
static void odd_normals_do_no_harm(void **state) {
    (void)state;
    subject s;
    make_subject(&s, 64, 4, 1, 7);
    const float odd[] = {0, NAN, INFINITY, -INFINITY, 1e-40f, 3e38f};
    for (int i = 0; i < 64 * 4; i++) {
        s.gbuffer.surface[i] = 0;
        for (int axis = 0; axis < 3; axis++) s.gbuffer.normal[axis][i] = odd[(i / (axis ? 6 * axis : 1)) % 6];
    }
    iso_image first = {0};
    for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
        iso_cpu_limit((iso_cpu_level)level);
        assert_int_equal(iso_shade(&s.shading, &s.strip, &s.image, NULL), 64 * 4);
        if (level == 0) {
            assert_int_equal(iso_image_create(s.image.width, s.image.height, &first, NULL), ISO_OK);
            memcpy(first.rgba, s.image.rgba, (size_t)s.image.width * (size_t)s.image.height * 4);
        }
        assert_memory_equal(first.rgba, s.image.rgba, (size_t)s.image.width * (size_t)s.image.height * 4);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_image_free(&first);
    free_subject(&s);
}

static void length_of_the_eye_direction_does_not_matter(void **state) {
    (void)state;
    uint32_t seed = 3;
    for (int round = 0; round < 2000; round++) {
        float n[3] = {(float)uniform(&seed) - 0.5f, (float)uniform(&seed) - 0.5f, -0.5f}, unit[3], eye[3],
              a[3], b[3];
        float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]),
              stretch = 1 + 3 * (float)uniform(&seed);
        for (int axis = 0; axis < 3; axis++) n[axis] /= length;
        float direction[3] = {(float)uniform(&seed) - 0.5f, (float)uniform(&seed) - 0.5f, -1};
        length = sqrtf(direction[0] * direction[0] + direction[1] * direction[1] + 1);
        for (int axis = 0; axis < 3; axis++) unit[axis] = direction[axis] / length;
        for (int axis = 0; axis < 3; axis++) eye[axis] = direction[axis] * stretch;
        iso_shade_sample(n, unit, COLORS[0], a);
        iso_shade_sample(n, eye, COLORS[0], b);
        for (int c = 0; c < 3; c++) assert_true(fabsf(a[c] - b[c]) < 1e-5f);
    }
}

/* ---- depth, normal, coverage */

static void measures_are_means_of_covered_samples(void **state) {
    (void)state;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int factor = 1; factor <= ISO_FACTOR_MAX; factor++) {
        subject s;
        make_subject(&s, 29, 11, factor, (uint32_t)factor);
        iso_aov aov;
        assert_int_equal(iso_aov_create(29, s.image.height, &aov, NULL), ISO_OK);
        aov.depth[0] = -1; /* rows above the strip are not touched */
        assert_int_equal(iso_aov_add_ids(&aov, NULL), ISO_OK);
        assert_int_equal(iso_gbuffer_add_elements(&s.gbuffer, NULL), ISO_OK);
        for (size_t i = 0; i < s.gbuffer.samples; i++) s.gbuffer.element[i] = (uint32_t)i;
        aov.ids[ISO_ID_ELEMENT][0] = 77;
        iso_strip_measure(&s.strip, &aov, pool);
        assert_true(aov.depth[0] == -1 && aov.ids[ISO_ID_ELEMENT][0] == 77);
        for (int pixel = 0; pixel < 29 * 11; pixel++) {
            int x = pixel % 29, y = pixel / 29, covered = 0;
            uint32_t surface = 0, element = 0;
            float nearest = INFINITY;
            size_t at = (size_t)(pixel + 29 * s.strip.y0);
            double depth = 0;
            iso_vec3 normal = {0};
            for (int k = 0; k < factor * factor; k++) {
                size_t i = (size_t)(y * factor + k / factor) * (size_t)s.view.width +
                           (size_t)(x * factor + k % factor);
                if (s.gbuffer.surface[i] == ISO_SURFACE_NONE) continue;
                covered++;
                if (s.gbuffer.depth[i] < nearest) {
                    nearest = s.gbuffer.depth[i];
                    surface = s.gbuffer.surface[i] + 1u;
                    element = (uint32_t)i;
                }
                depth += (double)s.gbuffer.depth[i];
                normal = iso_vec3_add(normal, iso_gbuffer_normal(&s.gbuffer, i));
            }
            assert_true(aov.coverage[at] == (float)covered / (float)(factor * factor));
            assert_int_equal(aov.ids[ISO_ID_SURFACE][at], surface);
            assert_int_equal(aov.ids[ISO_ID_ELEMENT][at], element);
            assert_int_equal(aov.ids[ISO_ID_SEGMENT][at], 0);
            iso_vec3 world = {(double)aov.normal[0][at], (double)aov.normal[1][at],
                              (double)aov.normal[2][at]};
            if (!covered) {
                assert_true(isinf(aov.depth[at]) && iso_vec3_length(world) == 0);
                continue;
            }
            assert_true(fabs((double)aov.depth[at] - depth / covered) < 1e-5 * depth / covered);
            iso_vec3 seen = iso_view_vector(&s.view, world); /* back in view space */
            iso_vec3 error = iso_vec3_sub(seen, iso_vec3_unit(normal));
            assert_true(iso_vec3_length(error) < 1e-6 && fabs(iso_vec3_length(world) - 1) < 1e-6);
        }
        iso_aov_free(&aov);
        free_subject(&s);
    }
    iso_pool_destroy(pool);
}

/* Two sides of a thin sheet in one pixel: there is no normal to speak of, and no NaN. */
static void normals_that_cancel_are_zero(void **state) {
    (void)state;
    subject s;
    make_subject(&s, 1, 1, 2, 4);
    for (int i = 0; i < 4; i++) {
        s.gbuffer.surface[i] = 0;
        s.gbuffer.depth[i] = 8;
        for (int axis = 0; axis < 3; axis++)
            s.gbuffer.normal[axis][i] = axis == 1 ? (i % 2 ? 1.0f : -1.0f) : 0;
    }
    iso_aov aov;
    assert_int_equal(iso_aov_create(1, s.image.height, &aov, NULL), ISO_OK);
    iso_strip_measure(&s.strip, &aov, NULL);
    int at = s.strip.y0;
    assert_true(aov.depth[at] == 8 && aov.coverage[at] == 1);
    for (int axis = 0; axis < 3; axis++) assert_true(aov.normal[axis][at] == 0);
    iso_aov_free(&aov);
    free_subject(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_sample_is_shaded_alike),
        cmocka_unit_test(odd_normals_do_no_harm),
        cmocka_unit_test(length_of_the_eye_direction_does_not_matter),
        cmocka_unit_test(measures_are_means_of_covered_samples),
        cmocka_unit_test(normals_that_cancel_are_zero),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
