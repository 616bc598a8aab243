/* Lines of meshes that were made of known lines: a tree and its leaves, closed and open tubes of few and
 * of many vertices, and round ends; and meshes that are not made of thin branches. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "check_support.h"
#include "extract/lines/mesh_lines.h"
#include "scene_tree.h"

enum { MOST_VERTICES = 20000, MOST_TRIANGLES = 40000 };

static float vertices[MOST_VERTICES][3];
static uint32_t triangles[MOST_TRIANGLES][3];
static iso_triangles mesh;
static iso_mesh_lines made;

static int setup(void **state) {
    (void)state;
    mesh = (iso_triangles){.vertices = vertices, .triangles = triangles};
    return 0;
}

static int teardown(void **state) {
    (void)state;
    iso_mesh_lines_free(&made);
    return 0;
}

static void convert(const iso_triangles *from) {
    iso_error error = {0};
    test_ok(iso_mesh_lines_make("mesh", from, &made, &error), &error);
}

/* ---- meshes */

static uint32_t add_vertex(double x, double y, double z) {
    float *v = mesh.vertices[mesh.vertex_count];
    v[0] = (float)x, v[1] = (float)y, v[2] = (float)z;
    return (uint32_t)mesh.vertex_count++;
}

static void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *t = mesh.triangles[mesh.triangle_count++];
    t[0] = a, t[1] = b, t[2] = c;
}

/* A ring around the z axis, joined to the ring of as many vertices before it if `joined`. Returns its
 * first vertex. */
static uint32_t add_ring(double x, double z, double radius, int sides, bool joined) {
    const uint32_t first = (uint32_t)mesh.vertex_count, before = first - (uint32_t)sides;
    for (int i = 0; i < sides; i++) {
        double sine, cosine;
        iso_sincos(i * 2 * ISO_PI / sides, &sine, &cosine);
        add_vertex(x + radius * cosine, radius * sine, z);
    }
    for (uint32_t i = 0, next; joined && i < (uint32_t)sides; i++) {
        next = (i + 1) % (uint32_t)sides;
        add_triangle(before + i, before + next, first + next);
        add_triangle(before + i, first + next, first + i);
    }
    return first;
}

/* Closes a ring by triangles between its own vertices. */
static void close_ring(uint32_t first, int sides, bool down) {
    for (uint32_t i = 1; i + 1 < (uint32_t)sides; i++)
        add_triangle(first, first + (down ? i + 1 : i), first + (down ? i : i + 1));
}

/* A tube of rings that are `step` apart, closed at both ends or open. */
static void add_tube(double x, double radius, int sides, int rings, double step, bool closed) {
    uint32_t ring = 0;
    for (int i = 0; i < rings; i++) {
        ring = add_ring(x, i * step, radius, sides, i > 0);
        if (i == 0 && closed) close_ring(ring, sides, true);
    }
    if (closed) close_ring(ring, sides, false);
}

/* A tube along the z axis from 0 to `length` whose ends are half spheres around these places. */
static void add_capsule(double x, double radius, double length, int sides, int rows) {
    const uint32_t bottom = add_vertex(x, 0, -radius);
    double sine, cosine;
    for (int i = 1; i <= rows; i++) {
        iso_sincos(0.5 * ISO_PI * i / rows, &sine, &cosine);
        add_ring(x, -radius * cosine, radius * sine, sides, i > 1);
    }
    for (int i = 1; i <= rows; i++) add_ring(x, length * i / rows, radius, sides, true);
    uint32_t ring = 0;
    for (int i = 1; i < rows; i++) {
        iso_sincos(0.5 * ISO_PI * i / rows, &sine, &cosine);
        ring = add_ring(x, length + radius * sine, radius * cosine, sides, true);
    }
    const uint32_t top = add_vertex(x, 0, length + radius);
    for (uint32_t i = 0; i < (uint32_t)sides; i++) {
        const uint32_t next = (i + 1) % (uint32_t)sides;
        add_triangle(bottom, bottom + 1 + next, bottom + 1 + i);
        add_triangle(ring + i, ring + next, top);
    }
}

/* ---- comparisons */

static double distance(const float *a, const float *b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(sum);
}

/* Each line of `got` is one of `wanted`, from either end, with the same places and, but at its ends if
 * `ends` is false, radii. */
static void same_lines(const iso_lines *got, const iso_lines *wanted, bool ends) {
    assert_int_equal(got->line_count, wanted->line_count);
    assert_int_equal(got->vertex_count, wanted->vertex_count);
    for (size_t line = 0; line < got->line_count; line++) {
        const size_t first = got->starts[line], count = got->starts[line + 1] - first;
        bool found = false;
        for (size_t i = 0; i < 2 * wanted->line_count && !found; i++) {
            const size_t from = wanted->starts[i / 2];
            found = wanted->starts[i / 2 + 1] - from == count;
            for (size_t k = 0; k < count && found; k++) {
                const size_t a = first + k, b = from + (i & 1 ? count - 1 - k : k);
                const bool end = k == 0 || k + 1 == count;
                found = distance(got->vertices[a], wanted->vertices[b]) < 2e-3 &&
                        (fabs((double)got->radii[a] - (double)wanted->radii[b]) < 1e-3 || (end && !ends));
            }
        }
        if (!found) fail_msg("line %zu of %zu vertices is not one of those of the mesh", line, count);
    }
}

/* The line ends at the z of `low` and `high`, on the axis at x, and has this radius everywhere. */
static void near_tube(size_t line, double x, double low, double high, double radius, double tolerance) {
    const iso_lines *lines = &made.tubes;
    const size_t first = lines->starts[line], last = lines->starts[line + 1] - 1;
    const double a = (double)lines->vertices[first][2], b = (double)lines->vertices[last][2];
    near(fmin(a, b), low, tolerance);
    near(fmax(a, b), high, tolerance);
    for (size_t i = first; i <= last; i++) {
        near((double)lines->vertices[i][0], x, tolerance);
        near((double)lines->vertices[i][1], 0, tolerance);
        near((double)lines->radii[i], radius, tolerance);
    }
}

/* ---- tests */

static void test_tree(void **state) {
    (void)state;
    const iso_scene_tree_opts opts = {.size = 0.2, .seed = 3};
    iso_scene_tree tree = {.wood = {.line_count = 0}};
    iso_error error = {0};
    test_ok(iso_scene_tree_make(&opts, &tree, &error), &error);
    convert(&tree.wood_mesh);
    assert_int_equal(made.ribbons.line_count, 0);
    assert_int_equal(made.rest.triangle_count, 0);
    same_lines(&made.tubes, &tree.wood, true);
    iso_mesh_lines_free(&made);
    convert(&tree.leaf_mesh);
    assert_int_equal(made.tubes.line_count, 0);
    same_lines(&made.ribbons, &tree.leaves, false); /* triangles have no width at a leaf's ends */
    for (size_t i = 0; i < made.ribbons.vertex_count; i++) {
        const float *n = made.ribbons.normals[i];
        near((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1, 1e-5);
    }
    iso_scene_tree_free(&tree);
}

static void test_closed_and_open(void **state) {
    (void)state;
    for (int sides = 3; sides <= 24; sides += 7)
        for (int closed = 0; closed < 2; closed++) {
            setup(NULL);
            add_tube(0, 1, sides, 5, 4, closed);
            add_tube(10, 0.5, sides, 9, 1.5, closed);
            convert(&mesh);
            assert_int_equal(made.tube_pieces, 2);
            assert_int_equal(made.tubes.line_count, 2);
            near_tube(0, 0, 0, 16, 1, 1e-5);
            near_tube(1, 10, 0, 12, 0.5, 1e-5);
            iso_mesh_lines_free(&made);
        }
}

/* Rings that are near each other: of three vertices, and of many. */
static void test_dense(void **state) {
    (void)state;
    add_tube(0, 1, 3, 100, 0.2, false);
    add_tube(10, 2, 32, 60, 0.4, false);
    convert(&mesh);
    assert_int_equal(made.tubes.line_count, 2);
    near_tube(0, 0, 0, 19.8, 1, 1e-4);
    near_tube(1, 10, 0, 23.6, 2, 1e-4);
    assert_true(made.tubes.vertex_count < 20); /* a straight line needs few vertices */
}

static void test_round_ends(void **state) {
    (void)state;
    add_capsule(0, 1, 12, 16, 8);
    convert(&mesh);
    assert_int_equal(made.tubes.line_count, 1);
    near_tube(0, 0, 0, 12, 1, 0.12);
}

/* A ball alone, and beside a tube. */
static void test_not_thin(void **state) {
    (void)state;
    iso_error error = {0};
    add_capsule(0, 5, 0.01, 24, 12); /* a sphere */
    assert_int_equal(iso_mesh_lines_make("ball.ply", &mesh, &made, &error), ISO_ERR_EMPTY);
    assert_non_null(
        strstr(error.text, "ball.ply: not made of thin branches or leaves: it is as thick as long"));
    const size_t ball = mesh.triangle_count;
    add_tube(20, 1, 6, 5, 4, true);
    convert(&mesh);
    assert_int_equal(made.pieces, 2);
    assert_int_equal(made.tube_pieces, 1);
    assert_int_equal(made.rest.triangle_count, ball);
    near_tube(0, 20, 0, 16, 1, 1e-5);
}

static void test_sheets(void **state) {
    (void)state;
    iso_error error = {0};
    for (int i = 0; i < 6; i++) add_vertex(i / 2, i % 2, 0); /* 1 x 2 mm */
    for (uint32_t i = 0; i < 4; i += 2) {
        add_triangle(i, i + 2, i + 1);
        add_triangle(i + 1, i + 2, i + 3);
    }
    for (uint32_t i = 0; i < 6; i++) vertices[i][1] *= 4; /* 4 x 2 mm: wider than long for a leaf */
    assert_int_equal(iso_mesh_lines_make("plate.ply", &mesh, &made, &error), ISO_ERR_EMPTY);
    assert_non_null(strstr(error.text, "sheet"));
}

/* Any triangles: something comes out, or a refusal. */
static void test_random(void **state) {
    (void)state;
    uint32_t seed = 5;
    for (int round = 0; round < 300; round++) {
        iso_error error = {0};
        setup(NULL);
        const int count = 3 + (int)(random_word(&seed) >> 16) % 40,
                  faces = 1 + (int)(random_word(&seed) >> 16) % 80;
        for (int i = 0; i < count; i++)
            add_vertex((random_word(&seed) >> 24) / 16, (random_word(&seed) >> 24) / 16,
                       (random_word(&seed) >> 24) / 64);
        for (int i = 0; i < faces; i++)
            add_triangle((random_word(&seed) >> 16) % (uint32_t)count,
                         (random_word(&seed) >> 16) % (uint32_t)count,
                         (random_word(&seed) >> 16) % (uint32_t)count);
        const iso_status status = iso_mesh_lines_make("mesh", &mesh, &made, &error);
        assert_true(status == ISO_OK || status == ISO_ERR_EMPTY);
        for (size_t i = 0; i < made.tubes.vertex_count; i++)
            assert_true(made.tubes.radii[i] >= 0 && isfinite(made.tubes.vertices[i][0]));
        iso_mesh_lines_free(&made);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_tree, setup, teardown),
        cmocka_unit_test_setup_teardown(test_closed_and_open, setup, teardown),
        cmocka_unit_test_setup_teardown(test_dense, setup, teardown),
        cmocka_unit_test_setup_teardown(test_round_ends, setup, teardown),
        cmocka_unit_test_setup_teardown(test_not_thin, setup, teardown),
        cmocka_unit_test_setup_teardown(test_sheets, setup, teardown),
        cmocka_unit_test_setup_teardown(test_random, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
