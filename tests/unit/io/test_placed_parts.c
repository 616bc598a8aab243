/* Parts of .glb and .3mf scenes: placed, their fronts stay outside, also where the place is a mirror. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "io/mesh/placed_parts.h"

static const double corners[4][3] = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 2}}; /* a volume of 4 */
static const uint64_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

/* The volume that the triangles from the `first` on enclose; negative where their fronts are inside. */
static double enclosed(const iso_mesh_reading *r, size_t first) {
    const float(*v)[3] = r->vertices.data;
    const uint32_t(*t)[3] = r->triangles.data;
    double volume = 0;
    for (size_t i = first; i < r->triangle_count; i++) {
        iso_vec3 p[3];
        for (int c = 0; c < 3; c++) p[c] = iso_vec3_make(v[t[i][c]][0], v[t[i][c]][1], v[t[i][c]][2]);
        volume += iso_vec3_dot(p[0], iso_vec3_cross(p[1], p[2]));
    }
    return volume / 6;
}

static void fronts_stay_outside(void **state) {
    (void)state;
    static const struct {
        iso_mesh_place place;
        double volume;
    } cases[] = {
        {{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, 4},
        {{{0, -2, 0, 2, 0, 0, 0, 0, 2}, {5, 50, 7}}, 32}, /* turned, twice as large */
        {{{-1, 0, 0, 0, 1, 0, 0, 0, 1}, {-10, 0, 0}}, 4}, /* mirrored */
        {{{0, 1, 0, 1, 0, 0, 0, 0, 3}, {1, 2, 3}}, 12},   /* two axes exchanged */
        {{{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0, 0, 0}}, 4},  /* turned by 180 degrees: no mirror */
        {{{-1, 0, 0, 0, -1, 0, 0, 0, -1}, {0, 0, 0}}, 4},
    };
    iso_mesh_reading r = {.path = "parts", .bytes = 1};
    iso_error error;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const size_t first = r.triangle_count;
        const iso_mesh_part part = iso_mesh_part_begin(&r, &cases[i].place);
        for (int v = 0; v < 4; v++)
            assert_int_equal(iso_mesh_part_vertex(&r, &part,
                                                  iso_vec3_make(corners[v][0], corners[v][1], corners[v][2]),
                                                  &error),
                             ISO_OK);
        for (int t = 0; t < 4; t++)
            assert_int_equal(iso_mesh_part_triangle(&r, &part, faces[t], &error), ISO_OK);
        assert_float_equal(enclosed(&r, first), cases[i].volume, 1e-5);
    }

    /* The place of a mirror within a mirror is no mirror. */
    const iso_mesh_place twice = iso_mesh_place_within(&cases[2].place, &cases[3].place);
    assert_false(iso_mesh_part_begin(&r, &twice).mirrored);
    iso_buffer_free(&r.vertices);
    iso_buffer_free(&r.triangles);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(fronts_stay_outside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
