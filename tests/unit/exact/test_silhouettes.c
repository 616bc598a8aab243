/* silhouettes: how far the outlines of meshes and points lie from the ray caster's. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/scenes/scenes.h"
#include "render/raster/raster.h"
#include "truth/raycast.h"

enum { SIZE = 512 };

typedef struct pictures {
    iso_gbuffer truth, mesh, points;
    double pixels_per_voxel;
} pictures;

static iso_view look_at(const iso_grid *grid, double *pixels_per_voxel) {
    iso_vec3 high = {grid->rgrid->dims[0] - 1, grid->rgrid->dims[1] - 1, grid->rgrid->dims[2] - 1};
    iso_box box = {{0, 0, 0}, high};
    iso_camera camera = {.view_angle = 30, .orthographic = true}; /* one size of voxel everywhere */
    iso_vec3 forward;
    iso_direction_vectors(ISO_FRONT, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_fit(&camera, &box, 1, 1);
    iso_camera_orbit(&camera, 20, 15);
    iso_view view = iso_view_make(&camera, SIZE, SIZE);
    *pixels_per_voxel = view.focal;
    return view;
}

static void draw_all(const char *scene, int size, pictures *p) {
    iso_grid grid = {0};
    double isovalue;
    const iso_scene_opts opts = {.size = size, .dense = 1};
    assert_int_equal(iso_scene_create(scene, &opts, &grid, &isovalue, NULL), ISO_OK);
    iso_view view = look_at(&grid, &p->pixels_per_voxel);
    iso_gbuffer *all[] = {&p->truth, &p->mesh, &p->points};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(iso_gbuffer_create(SIZE, SIZE, all[i], NULL), ISO_OK);
        iso_gbuffer_clear(all[i]);
    }
    iso_raycaster *caster;
    assert_int_equal(iso_raycaster_create(&grid, isovalue, NULL, &caster, NULL), ISO_OK);
    assert_int_equal(iso_draw_raycast(&(iso_target){.view = &view, .gbuffer = &p->truth}, caster, NULL),
                     ISO_OK);
    iso_mesh_set *mesh;
    assert_int_equal(iso_mesh_set_create(&grid, &(iso_mesh_opts){.isovalue = isovalue}, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(mesh, NULL), ISO_OK);
    iso_mesh_view triangles = iso_mesh_set_view(mesh);
    assert_int_equal(iso_draw_mesh(&(iso_target){.view = &view, .gbuffer = &p->mesh}, &triangles, NULL),
                     ISO_OK);
    iso_point_set *set;
    const iso_points_opts edge = {.isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE};
    assert_int_equal(iso_point_set_create(&grid, &edge, &set, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    iso_point_view points = iso_point_set_view(set);
    assert_int_equal(iso_draw_points(&(iso_target){.view = &view, .gbuffer = &p->points}, &points, NULL),
                     ISO_OK);
    iso_point_set_destroy(set);
    iso_mesh_set_destroy(mesh);
    iso_raycaster_destroy(caster);
    iso_grid_destroy(&grid);
}

static int covered(const iso_gbuffer *g, int x, int y) {
    return x >= 0 && y >= 0 && x < SIZE && y < SIZE && g->surface[y * SIZE + x] != ISO_SURFACE_NONE;
}

/* Pixels that differ, over pixels of the truth's outline: the mean distance between the outlines, in pixels.
 */
static double mean_distance(const iso_gbuffer *truth, const iso_gbuffer *other) {
    int differ = 0, outline = 0;
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++) {
            differ += covered(truth, x, y) != covered(other, x, y);
            outline += covered(truth, x, y) && !(covered(truth, x - 1, y) && covered(truth, x + 1, y) &&
                                                 covered(truth, x, y - 1) && covered(truth, x, y + 1));
        }
    assert_true(outline > 500);
    return (double)differ / outline;
}

/* Largest distance from a covered pixel to the nearest one of the truth, looked for up to `reach` pixels. */
static double dilation(const iso_gbuffer *truth, const iso_gbuffer *other, int reach) {
    double worst = 0;
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++) {
            if (!covered(other, x, y) || covered(truth, x, y)) continue;
            double nearest = reach + 1;
            for (int dy = -reach; dy <= reach; dy++)
                for (int dx = -reach; dx <= reach; dx++)
                    if (covered(truth, x + dx, y + dy)) nearest = fmin(nearest, hypot(dx, dy));
            worst = fmax(worst, nearest);
        }
    return worst;
}

static void outlines_lie_where_the_ray_caster_has_them(void **state) {
    (void)state;
    static const struct {
        const char *scene;
        int size;
    } cases[] = {{"sphere", 48}, {"cylinder", 64}, {"torus", 64}, {"gyroid", 48}, {"ct", 64}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pictures p = {0};
        draw_all(cases[i].scene, cases[i].size, &p);
        double voxel = p.pixels_per_voxel, mesh = mean_distance(&p.truth, &p.mesh) / voxel;
        double allowed = sqrt(0.5) * voxel + 1; /* half a base diameter and a pixel */
        double fat = dilation(&p.truth, &p.points, (int)allowed + 4);
        printf("%s: mesh %.3f voxel, points dilated by %.2f of %.2f pixels (%.2f a voxel)\n", cases[i].scene,
               mesh, fat, allowed, voxel);
        assert_true(mesh <= 0.15);
        assert_true(fat <= allowed);
        assert_true(fat > 0); /* discs are wider than the surface: else nothing was measured */
        iso_gbuffer_free(&p.truth);
        iso_gbuffer_free(&p.mesh);
        iso_gbuffer_free(&p.points);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(outlines_lie_where_the_ray_caster_has_them)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
