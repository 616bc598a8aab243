/* Polygons as triangles: convex ones keep their fans, concave ones are covered exactly, and what cannot be
 * right ends all the same. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/geometry.h"
#include "io/common/fans.h"

/* A polygon in the plane of two axes; z rises along x. */
typedef struct polygon {
    float (*points)[3];
    uint32_t (*triangles)[3];
    size_t count;
} polygon;

static polygon make_polygon(size_t count) {
    polygon p = {malloc(count * sizeof *p.points), malloc((count - 2) * sizeof *p.triangles), count};
    for (size_t i = 0; i + 2 < count; i++)
        for (uint32_t k = 0; k < 3; k++) p.triangles[i][k] = k ? (uint32_t)i + k : 0;
    return p;
}

static void set_point(polygon *p, size_t i, double x, double y) {
    p->points[i][0] = (float)x;
    p->points[i][1] = (float)y;
    p->points[i][2] = (float)(2 * x);
}

static void free_polygon(polygon *p) {
    free(p->points);
    free(p->triangles);
}

/* The area of a triangle above the plane of x and y, with its sign. */
static double flat_area(const polygon *p, const uint32_t t[3]) {
    const float *a = p->points[t[0]], *b = p->points[t[1]], *c = p->points[t[2]];
    return 0.5 * (((double)b[0] - (double)a[0]) * ((double)c[1] - (double)a[1]) -
                  ((double)b[1] - (double)a[1]) * ((double)c[0] - (double)a[0]));
}

static double outline_area(const polygon *p) {
    double sum = 0;
    for (size_t i = 0; i < p->count; i++) {
        const float *a = p->points[i], *b = p->points[(i + 1) % p->count];
        sum += 0.5 * ((double)a[0] * (double)b[1] - (double)a[1] * (double)b[0]);
    }
    return sum;
}

static iso_status divide(polygon *p) {
    const iso_fan fan = {0, p->count};
    return iso_fans_divide("a mesh", &fan, 1, (const float(*)[3])p->points, p->triangles, NULL);
}

/* Divides the polygon: its triangles face one way, and their areas add up to that of the outline. */
static void check_division(polygon *p) {
    assert_int_equal(divide(p), ISO_OK);
    double sum = 0, sizes = 0;
    for (size_t i = 0; i + 2 < p->count; i++) {
        for (int k = 0; k < 3; k++) assert_in_range(p->triangles[i][k], 0, p->count - 1);
        sum += flat_area(p, p->triangles[i]);
        sizes += fabs(flat_area(p, p->triangles[i]));
    }
    const double area = outline_area(p);
    if (fabs(sum - area) > 1e-6 * fabs(area) || fabs(sizes - fabs(area)) > 1e-6 * fabs(area))
        fail_msg("%zu corners: %.9g and %.9g instead of %.9g", p->count, sum, sizes, area);
}

static void convex_polygons_keep_their_fans(void **state) {
    (void)state;
    for (size_t count = 4; count < 100; count += 19) {
        polygon p = make_polygon(count);
        for (size_t i = 0; i < count; i++) {
            const double turn = 2 * ISO_PI * (double)i / (double)count;
            set_point(&p, i, 1e3 + cos(turn), sin(turn));
        }
        check_division(&p);
        for (uint32_t i = 0; i + 2 < count; i++) {
            assert_int_equal(p.triangles[i][0], 0);
            assert_int_equal(p.triangles[i][1], i + 1);
        }
        free_polygon(&p);
    }
}

/* Every order of corners: the first one is each in turn, and the outline runs either way. */
static void check_turned(const double (*outline)[2], size_t count) {
    for (size_t first = 0; first < 2 * count; first++) {
        polygon p = make_polygon(count);
        for (size_t i = 0; i < count; i++) {
            const size_t at = first < count ? (first + i) % count : (2 * count - 1 - i + first) % count;
            set_point(&p, i, outline[at][0], outline[at][1]);
        }
        check_division(&p);
        free_polygon(&p);
    }
}

static void concave_polygons_are_covered(void **state) {
    (void)state;
    static const double letter[8][2] = {{0, 0}, {10, 0}, {10, 3}, {4, 3}, {4, 7}, {10, 7}, {10, 10}, {0, 10}};
    check_turned(letter, 8);
    /* a square with a square hole that a bridge joins to the outline: two corners come twice */
    static const double hole[10][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0},
                                       {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}};
    check_turned(hole, 10);
    /* corners on straight sides, a corner twice in a row, and two squares that touch at a corner */
    static const double straight[9][2] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3},
                                          {1, 3}, {1, 1}, {1, 1}, {0, 1}};
    check_turned(straight, 9);
    static const double touching[8][2] = {{0, 0}, {2, 0}, {2, 2}, {4, 2}, {4, 4}, {2, 4}, {2, 2}, {0, 2}};
    check_turned(touching, 8);
}

/* Rings, spirals and combs of many corners. */
static void long_polygons_are_covered(void **state) {
    (void)state;
    static const size_t counts[] = {66, 936, 4000, 20000};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        const size_t count = counts[i], half = count / 2;
        polygon ring = make_polygon(count), spiral = make_polygon(count), comb = make_polygon(count);
        for (size_t k = 0; k < count; k++) {
            const double along = (double)(k < half ? k : count - 1 - k) / (double)(half - 1);
            const double radius = k < half ? 1 : 0.9, turn = 6 * along;
            set_point(&ring, k, radius * cos(turn), radius * sin(turn));
            const double away = 1 + 10 * along + (k < half ? 0 : 0.2);
            set_point(&spiral, k, -away * cos(10 * turn), away * sin(10 * turn));
            set_point(&comb, k, k < 2 ? (double)(k * count) : (double)(count - k), k < 2 ? 0 : k % 2 ? 1 : 9);
        }
        check_division(&ring);
        check_division(&spiral);
        check_division(&comb);
        free_polygon(&ring);
        free_polygon(&spiral);
        free_polygon(&comb);
    }
}

/* Points at random cross; what comes out has the right corners and ends in time. */
static void any_polygon_ends(void **state) {
    (void)state;
    srand(1);
    for (size_t count = 4; count < 20000; count = count * 3 + 1) {
        polygon p = make_polygon(count);
        for (size_t i = 0; i < count; i++) set_point(&p, i, rand() % 1000, rand() % 1000);
        for (size_t i = 0; i < count; i += 7) p.points[i][1] = NAN;
        divide(&p);
        for (size_t i = 0; i < count; i++) set_point(&p, i, rand() % 1000, rand() % 1000);
        const iso_status status = divide(&p);
        assert_true(status == ISO_OK || (status == ISO_ERR_FORMAT && count > 16384));
        for (size_t i = 0; i + 2 < count; i++)
            for (int k = 0; k < 3; k++) assert_in_range(p.triangles[i][k], 0, count - 1);
        free_polygon(&p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(convex_polygons_keep_their_fans),
        cmocka_unit_test(concave_polygons_are_covered),
        cmocka_unit_test(long_polygons_are_covered),
        cmocka_unit_test(any_polygon_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
