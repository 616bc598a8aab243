/* Lines that tests put together vertex by vertex. */
#include "lines_support.h"

#include "check_support.h"
#include "scene_support.h"

void test_lines_start(test_lines *set, double x, double y, double z) {
    set->starts[0] = 0;
    set->lines = (iso_lines){.origin = iso_vec3_make(x, y, z),
                             .vertices = set->vertices,
                             .radii = set->radii,
                             .starts = set->starts};
}

void test_lines_add(test_lines *set, double x, double y, double z, double radius) {
    const size_t v = set->lines.vertex_count++;
    assert_true(v < TEST_LINES_VERTICES);
    set->vertices[v][0] = (float)x, set->vertices[v][1] = (float)y, set->vertices[v][2] = (float)z;
    set->radii[v] = (float)radius;
    for (int k = 0; k < 3; k++) set->colors[v][k] = (uint8_t)(53 * v + 91 * (size_t)k);
}

void test_lines_end(test_lines *set) {
    assert_true(set->lines.line_count < TEST_LINES_MOST);
    set->starts[++set->lines.line_count] = set->lines.vertex_count;
}

void test_lines_add_walk(test_lines *set, int count, double half, double step, double low, double high,
                         uint32_t *seed) {
    double p[3];
    for (int a = 0; a < 3; a++) p[a] = half * (2 * uniform(seed) - 1);
    for (int i = 0; i <= count; i++) {
        test_lines_add(set, p[0], p[1], p[2], low + (high - low) * uniform(seed));
        for (int a = 0; a < 3; a++) p[a] += step * (2 * uniform(seed) - 1);
    }
    test_lines_end(set);
}
