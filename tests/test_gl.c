/* The gl engine against the cpu engine, on scenes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "extract/mesh.h"
#include "extract/points.h"
#include "gl_support.h"
#include "grids/scenes.h"

enum { SIDES = 6 };

static iso_view side_view(const iso_box *box, int side, bool orthographic, int width, int height) {
    iso_camera camera = {.view_angle = 30, .orthographic = orthographic, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors((iso_direction)side, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_fit(&camera, box, (double)width / height, 1);
    return iso_view_make(&camera, width, height);
}

typedef struct surface {
    iso_grid grid;
    iso_point_set *packed, *floats;
    iso_mesh_set *mesh;
    iso_box box;
} surface;

static void make_surface(const char *scene, int size, bool dense, surface *s) {
    *s = (surface){.packed = NULL};
    double isovalue;
    const iso_scene_opts opts = {.size = size, .dense = dense};
    assert_int_equal(iso_scene_create(scene, &opts, &s->grid, &isovalue, NULL), ISO_OK);
    for (int floats = 0; floats < 2; floats++) {
        iso_point_set **set = floats ? &s->floats : &s->packed;
        const iso_points_opts points = {.isovalue = isovalue, .floats = floats};
        assert_int_equal(iso_point_set_create(&s->grid, &points, set, NULL), ISO_OK);
        assert_int_equal(iso_point_set_update(*set, NULL), ISO_OK);
    }
    assert_int_equal(iso_mesh_set_create(&s->grid, &(iso_mesh_opts){.isovalue = isovalue}, &s->mesh, NULL),
                     ISO_OK);
    assert_int_equal(iso_mesh_set_update(s->mesh, NULL), ISO_OK);
    iso_mesh_view mesh = iso_mesh_set_view(s->mesh);
    iso_affine affine = iso_transform_affine(&mesh.transform);
    iso_box box = iso_mesh_view_bounds(&mesh);
    s->box = iso_box_transform(&box, &affine);
}

static void free_surface(surface *s) {
    iso_point_set_destroy(s->packed);
    iso_point_set_destroy(s->floats);
    iso_mesh_set_destroy(s->mesh);
    iso_grid_destroy(&s->grid);
}

static void check_surface(iso_gl_engine *engine, const surface *s, const iso_view *view, const char *name) {
    char text[200];
    iso_point_view packed = iso_point_set_view(s->packed), floats = iso_point_set_view(s->floats);
    iso_mesh_view mesh = iso_mesh_set_view(s->mesh);
    snprintf(text, sizeof text, "%s, points", name);
    gl_check_points(engine, view, &packed, text);
    snprintf(text, sizeof text, "%s, points in floats", name);
    gl_check_points(engine, view, &floats, text);
    snprintf(text, sizeof text, "%s, mesh", name);
    gl_check_mesh(engine, view, &mesh, text);
}

static void pictures_are_the_cpu_engines(void **state) {
    (void)state;
    static const struct {
        const char *scene;
        int size, dense;
    } cases[] = {{"sphere", 48, 0}, {"cube", 40, 1}, {"gyroid", 48, 1}, {"ct", 64, 1}};
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    for (int c = 0; c < contexts.count; c++) {
        iso_gl_engine *engine;
        assert_int_equal(iso_gl_engine_create(contexts.context[c], &engine, NULL), ISO_OK);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            surface s;
            make_surface(cases[i].scene, cases[i].size, cases[i].dense, &s);
            for (int side = 0; side < SIDES; side++) {
                char name[128];
                snprintf(name, sizeof name, "%s: %s from side %d",
                         iso_gl_context_info(contexts.context[c]).name, cases[i].scene, side);
                iso_view view = side_view(&s.box, side, side % 2, 200 + 40 * side, 230);
                check_surface(engine, &s, &view, name);
            }
            free_surface(&s);
        }
        iso_gl_engine_destroy(engine);
    }
    gl_contexts_close(&contexts);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_cpu_engines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
