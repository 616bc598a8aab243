/* Meshes for files: a hollow solid's wall, measured from the solid's own surface; closed meshes that stay so
 * when they are smoothed and simplified; open edges that stay where they are. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "extract/mesh/mesh_edit.h"
#include "extract/mesh/mesh_measure.h"
#include "extract_support.h"
#include "scene/distances.h"
#include "scene/hollow.h"

enum { SIDE = 44 };
static const double ISOVALUE = 100;

/* A bean: values fall with the distance from two places; the voxels are not cubes, and turned. */
static iso_grid make_bean(void) {
    const double s = sin(0.4), c = cos(0.4);
    iso_grid grid = test_rgrid((const int[3]){SIDE, SIDE, SIDE}, ISO_FLOAT32);
    grid.rgrid->transform = (iso_transform){
        .spacing = {1, 0.8, 1.25}, .origin = {10, -20, 30}, .direction = {c, -s, 0, s, c, 0, 0, 0, 1}};
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) {
                const double a = iso_vec3_length(iso_vec3_make(x - 17, 0.8 * (y - 20), 1.25 * (z - 20))),
                             b = iso_vec3_length(iso_vec3_make(x - 26, 0.8 * (y - 25), 1.25 * (z - 21)));
                test_set(&grid, x, y, z, 100 + 20 * (10 - a * b / (0.4 * (a + b))));
            }
    return grid;
}

static void the_wall_is_as_thick_everywhere(void **state) {
    (void)state;
    static const double WALL = 2;
    iso_grid grid = make_bean();
    iso_distance *distance;
    iso_hgrid *hollow;
    iso_weld weld;
    iso_mesh_measures measures;
    const iso_hollow_opts opts = {.wall = WALL, .up = {0, 0, 1}};
    assert_int_equal(iso_distance_of_isosurface(&grid, ISOVALUE, NULL, &distance, NULL), ISO_OK);
    assert_int_equal(iso_grid_hollow(&grid, ISOVALUE, &opts, &hollow, NULL), ISO_OK);
    iso_grid made = {.hgrid = hollow};
    assert_int_equal(iso_isosurface_mesh(&made, 0, NULL, &weld, NULL), ISO_OK);
    assert_int_equal(iso_weld_measure(&weld, iso_grid_transform(&made), NULL, &measures, NULL), ISO_OK);
    assert_int_equal(measures.pieces, 2);
    assert_int_equal(measures.open_edges + measures.crowded_edges, 0);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&made));
    iso_nearby nearby = {0};
    size_t inner = 0;
    for (size_t i = 0; i < weld.vertex_count; i++) {
        const float *p = weld.vertices[i].position;
        const double depth =
            -iso_distance_at(distance, iso_affine_point(&affine, iso_vec3_make(p[0], p[1], p[2])), &nearby);
        assert_true(fabs(depth) < 0.05 || fabs(depth - WALL) < 0.05);
        inner += depth > WALL / 2;
    }
    assert_true(inner > weld.vertex_count / 4);
    iso_nearby_free(&nearby);
    iso_weld_free(&weld);
    iso_distance_destroy(distance);
    iso_grid_destroy(&made);
    iso_grid_destroy(&grid);
}

static iso_weld make_mesh(iso_grid *grid) {
    iso_weld weld;
    *grid = make_bean();
    assert_int_equal(iso_isosurface_mesh(grid, ISOVALUE, NULL, &weld, NULL), ISO_OK);
    return weld;
}

static iso_mesh_measures measure(const iso_weld *weld, const iso_grid *grid) {
    iso_mesh_measures measures;
    assert_int_equal(iso_weld_measure(weld, iso_grid_transform(grid), NULL, &measures, NULL), ISO_OK);
    return measures;
}

/* Normals of length 1 that point out of a solid around `middle`. */
static void check_normals(const iso_weld *weld) {
    double least = 1, most = 1, outwards = 0;
    for (size_t i = 0; i < weld->vertex_count; i++) {
        const iso_surfel *v = &weld->vertices[i];
        const iso_vec3 n = iso_vec3_make(v->normal[0], v->normal[1], v->normal[2]),
                       way =
                           iso_vec3_make(v->position[0] - 21.5, v->position[1] - 22.5, v->position[2] - 20.5);
        least = fmin(least, iso_vec3_length(n));
        most = fmax(most, iso_vec3_length(n));
        outwards += iso_vec3_dot(n, way) > 0;
    }
    assert_true(least > 0.9999 && most < 1.0001);
    assert_true(outwards > 0.95 * (double)weld->vertex_count);
}

static void closed_meshes_stay_closed(void **state) {
    (void)state;
    iso_grid grid;
    iso_weld weld = make_mesh(&grid);
    const iso_mesh_measures whole = measure(&weld, &grid);
    const size_t triangles = weld.triangle_count;
    assert_int_equal(iso_weld_smooth(&weld, 10, NULL), ISO_OK);
    const iso_mesh_measures smooth = measure(&weld, &grid);
    check_normals(&weld);
    assert_int_equal(weld.triangle_count, triangles);
    assert_int_equal(smooth.open_edges + smooth.crowded_edges, 0);
    assert_true(fabs(smooth.volume / whole.volume - 1) < 0.01);
    const iso_mesh_edits edits = {.keep = 0.2};
    if (iso_weld_can_decimate()) {
        assert_int_equal(iso_weld_edit(&weld, iso_grid_transform(&grid), &edits, NULL), ISO_OK);
        const iso_mesh_measures fewer = measure(&weld, &grid);
        check_normals(&weld);
        assert_true(weld.triangle_count <= (size_t)(0.2 * (double)triangles) + 2);
        assert_int_equal(fewer.open_edges + fewer.crowded_edges, 0);
        assert_int_equal(fewer.euler, whole.euler);
        assert_true(fabs(fewer.volume / whole.volume - 1) < 0.02);
    } else
        assert_int_equal(iso_weld_edit(&weld, iso_grid_transform(&grid), &edits, NULL), ISO_ERR_BACKEND);
    iso_weld_free(&weld);
    iso_grid_destroy(&grid);
}

/* Without one of its triangles a mesh has an edge of three vertices, which stay; all others move. */
static void open_edges_stay(void **state) {
    (void)state;
    iso_grid grid;
    iso_weld weld = make_mesh(&grid);
    iso_grid_destroy(&grid);
    iso_weld before = make_mesh(&grid);
    uint32_t corner[3];
    memcpy(corner, weld.triangles[--weld.triangle_count], sizeof corner);
    assert_int_equal(iso_weld_smooth(&weld, 3, NULL), ISO_OK);
    for (int k = 0; k < 3; k++)
        assert_memory_equal(weld.vertices[corner[k]].position, before.vertices[corner[k]].position,
                            sizeof weld.vertices[0].position);
    size_t moved = 0;
    for (size_t i = 0; i < weld.vertex_count; i++)
        moved += memcmp(weld.vertices[i].position, before.vertices[i].position, 3 * sizeof(float)) != 0;
    assert_true(moved > weld.vertex_count - 10);
    iso_weld_free(&weld);
    iso_weld_free(&before);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_wall_is_as_thick_everywhere),
        cmocka_unit_test(closed_meshes_stay_closed),
        cmocka_unit_test(open_edges_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
