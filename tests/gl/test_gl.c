/* The gl engine against the cpu engine, on scenes; contexts, shaders, and what happens at limits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "gl_support.h"
#include "grids/scenes/scenes.h"
#include "render/gl/internal.h"
#include "render/gl/program.h"
#include "render/gl/surface.h"
#include "render/raster/raster.h"

static iso_gl_engine *make_engine(iso_gl_context *context) {
    iso_gl_engine *engine;
    iso_error error = {ISO_OK, ""};
    if (iso_gl_engine_create(context, &engine, &error) != ISO_OK) fail_msg("%s", error.text);
    return engine;
}

/* The grid is to be destroyed after the surface. */
static gl_surface scene_surface(const char *scene, int size, bool dense, iso_grid *grid) {
    double isovalue;
    const iso_scene_opts opts = {.size = size, .dense = dense};
    assert_int_equal(iso_scene_create(scene, &opts, grid, &isovalue, NULL), ISO_OK);
    return gl_surface_make(grid, isovalue);
}

static double check_surface(iso_gl_engine *engine, const gl_surface *s, const iso_view *views, int count,
                            const char *name) {
    iso_point_view packed = iso_point_set_view(s->packed), floats = iso_point_set_view(s->floats);
    iso_mesh_view mesh = iso_mesh_set_view(s->mesh);
    double worst = gl_check_points(engine, &packed, views, count, name);
    worst = fmin(worst, gl_check_points(engine, &floats, views, count, name));
    return fmin(worst, gl_check_mesh(engine, &mesh, views, count, name));
}

static void pictures_are_the_cpu_engines(void **state) {
    (void)state;
    static const struct {
        const char *scene;
        int size, dense;
    } cases[] = {{"sphere", 48, 0}, {"cube", 40, 1}, {"gyroid", 48, 1}, {"ct", 64, 1}};
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_grid grid;
        gl_surface s = scene_surface(cases[i].scene, cases[i].size, cases[i].dense, &grid);
        iso_view views[GL_SIDES];
        for (int side = 0; side < GL_SIDES; side++)
            views[side] = gl_side_view(&s.box, side, side % 2, 200 + 40 * side, 230);
        for (int c = 0; c < contexts.count; c++) {
            iso_gl_engine *engine = make_engine(contexts.context[c]);
            double worst = check_surface(engine, &s, views, GL_SIDES, cases[i].scene);
            printf("%s, %s: %.1f dB\n", iso_gl_context_info(contexts.context[c]).name, cases[i].scene, worst);
            iso_gl_engine_destroy(engine);
        }
        gl_surface_free(&s);
        iso_grid_destroy(&grid);
    }
    gl_contexts_close(&contexts);
}

/* Discs wider than the driver's points, centres beside the picture, surfaces cut by the near plane, pictures
 * in parts: the eye is inside the scene. */
static void limits_of_the_driver_do_not_show(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    iso_grid grid;
    gl_surface s = scene_surface("gyroid", 40, true, &grid);
    iso_vec3 middle = iso_vec3_scale(iso_vec3_add(s.box.lo, s.box.hi), 0.5);
    iso_camera camera = {.view_angle = 70, .view_up = {0, 0, 1}};
    iso_view views[3];
    for (int i = 0; i < 3; i++) {
        camera.position = iso_vec3_add(middle, iso_vec3_make(1.3 * i, 0.7, 0.2 - i));
        camera.focal_point = iso_vec3_add(camera.position, iso_vec3_make(3.0 - i, 10, 2));
        views[i] = iso_view_make(&camera, 320, 250);
    }
    for (int c = 0; c < contexts.count; c++) {
        iso_gl_engine *engine = make_engine(contexts.context[c]);
        double worst = check_surface(engine, &s, views, 3, "inside");
        engine->max_side = 97;
        worst = fmin(worst, check_surface(engine, &s, views, 3, "in parts"));
        engine->max_point = 9;
        worst = fmin(worst, check_surface(engine, &s, views, 3, "wide points"));
        engine->max_point = 0.5;
        worst = fmin(worst, check_surface(engine, &s, views, 3, "nothing but quads"));
        printf("%s: %.1f dB\n", iso_gl_context_info(contexts.context[c]).name, worst);
        iso_gl_engine_destroy(engine);
    }
    gl_surface_free(&s);
    iso_grid_destroy(&grid);
    gl_contexts_close(&contexts);
}

static iso_point_view one_point(const iso_point *point, const iso_point_span *span, const float *radius) {
    return (iso_point_view){.packed = point,
                            .radii = radius,
                            .spans = span,
                            .span_count = 1,
                            .transform = iso_transform_identity(),
                            .radius = 0.25};
}

static size_t count_covered(const iso_gbuffer *g) {
    size_t count = 0;
    for (size_t i = 0; i < (size_t)g->width * (size_t)g->height; i++) count += g->surface[i] == 0;
    return count;
}

/* 2003, eq. 3-8, of a point in the middle and one in a corner of a view that is not square. */
static void attenuated_points_have_the_width_of_equation_7(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    const double tan_x = 0.8, tan_y = 0.6, z = 10;
    const iso_view view = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                           .focal = 500,
                           .cx = 400,
                           .cy = 300,
                           .width = 800,
                           .height = 600,
                           .near = 0.01};
    const iso_point_span span = {.count = 1};
    for (int c = 0; c < contexts.count; c++)
        for (int corner = 0; corner < 2; corner++) {
            float x = corner ? (float)(0.95 * tan_x * z) : 0, y = corner ? (float)(0.95 * tan_y * z) : 0;
            iso_point point = iso_point_pack(&(iso_surfel){{x, y, (float)z}, {0, 0, -1}});
            iso_point_view points = one_point(&point, &span, NULL);
            iso_gl_engine *engine = make_engine(contexts.context[c]);
            iso_gl_surface *surface;
            assert_int_equal(iso_gl_upload_points(engine, &points, &surface, NULL), ISO_OK);
            for (int scaling = 0; scaling < 2; scaling++) {
                iso_gbuffer g = gl_gbuffer(&view);
                iso_gl_draw_opts opts = {.view = &view,
                                         .surfaces = (const iso_gl_surface *const *)&surface,
                                         .surface_count = 1,
                                         .scaling = (iso_point_scaling)scaling};
                assert_int_equal(iso_gl_draw(engine, &opts, &g, NULL), ISO_OK);
                double d = sqrt((double)x * x + (double)y * y + z * z);
                double k = 1 / (1 + tan_x * tan_x + tan_y * tan_y);
                double radius = 0.25 * view.focal / (scaling ? sqrt(k * d * d) : z);
                double area = (double)count_covered(&g), wanted = ISO_PI * radius * radius;
                if (fabs(area - wanted) > 0.02 * wanted)
                    fail_msg("scaling %d, corner %d: %g pixels instead of %g", scaling, corner, area, wanted);
                iso_gbuffer_free(&g);
            }
            iso_gl_surface_destroy(surface);
            iso_gl_engine_destroy(engine);
        }
    gl_contexts_close(&contexts);
}

/* The same surface in bricks far from the volume's corner, under voxels of a hundredth of a millimetre: index
 * coordinates of millions that the origin takes back. In floats they would be off by a tenth of a voxel. */
static void precision_does_not_depend_on_the_origin(void **state) {
    (void)state;
    static const int32_t shift[3] = {100000, -70000, 30000};
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    iso_grid grid;
    gl_surface s = scene_surface("gyroid", 40, true, &grid);
    iso_mesh_view mesh = iso_mesh_set_view(s.mesh);
    iso_point_view points = iso_point_set_view(s.floats);
    iso_mesh_span *mesh_spans = malloc(mesh.span_count * sizeof *mesh_spans);
    iso_point_span *point_spans = malloc(points.span_count * sizeof *point_spans);
    assert_true(mesh_spans && point_spans);
    iso_transform far = iso_transform_identity();
    for (int axis = 0; axis < 3; axis++) {
        far.spacing[axis] = 0.01;
        far.origin[axis] = -0.01 * ISO_BRICK * shift[axis];
        for (size_t i = 0; i < mesh.span_count; i++) {
            if (axis == 0) mesh_spans[i] = mesh.spans[i];
            mesh_spans[i].brick[axis] += shift[axis];
        }
        for (size_t i = 0; i < points.span_count; i++) {
            if (axis == 0) point_spans[i] = points.spans[i];
            point_spans[i].brick[axis] += shift[axis];
        }
    }
    mesh.spans = mesh_spans;
    points.spans = point_spans;
    mesh.transform = points.transform = far;
    points.radius = 0.007;
    const iso_box box = {{0, 0, 0}, {0.4, 0.4, 0.4}};
    iso_view views[2] = {gl_side_view(&box, 2, false, 230, 250), gl_side_view(&box, 5, true, 230, 210)};
    for (int c = 0; c < contexts.count; c++) {
        iso_gl_engine *engine = make_engine(contexts.context[c]);
        double worst = gl_check_mesh(engine, &mesh, views, 2, "far mesh");
        worst = fmin(worst, gl_check_points(engine, &points, views, 2, "far points"));
        printf("%s: %.1f dB\n", iso_gl_context_info(contexts.context[c]).name, worst);
        iso_gl_engine_destroy(engine);
    }
    free(mesh_spans);
    free(point_spans);
    gl_surface_free(&s);
    iso_grid_destroy(&grid);
    gl_contexts_close(&contexts);
}

/* Spans in any order with room between them, points smaller and larger than pixels, each with a radius. */
static void spans_lie_anywhere(void **state) {
    (void)state;
    enum { SPANS = 20, EACH = 50, STRIDE = 70 };
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    static iso_surfel surfels[SPANS * STRIDE];
    static iso_point packed[SPANS * STRIDE];
    static float radii[SPANS * STRIDE];
    iso_point_span spans[SPANS];
    uint32_t seed = 7;
    for (int i = 0; i < SPANS * STRIDE; i++) {
        for (int axis = 0; axis < 3; axis++) {
            surfels[i].position[axis] = (float)(-1.9 + 19.8 * uniform(&seed));
            surfels[i].normal[axis] = (float)(uniform(&seed) - 0.5);
        }
        packed[i] = iso_point_pack(&surfels[i]);
        radii[i] = (float)(0.6 * uniform(&seed) * uniform(&seed));
    }
    for (int s = 0; s < SPANS; s++)
        spans[s] =
            (iso_point_span){{s % 3 - 1, s % 5 - 2, s % 2}, EACH, (size_t)STRIDE * ((7 * s + 3) % SPANS)};
    const iso_box box = {{-16, -32, 0}, {32, 48, 32}};
    iso_view views[2] = {gl_side_view(&box, 0, false, 300, 200), gl_side_view(&box, 6, true, 90, 120)};
    for (int c = 0; c < contexts.count; c++)
        for (int floats = 0; floats < 2; floats++) {
            iso_point_view points = {.packed = floats ? NULL : packed,
                                     .surfels = floats ? surfels : NULL,
                                     .radii = radii,
                                     .spans = spans,
                                     .span_count = SPANS,
                                     .transform = iso_transform_identity()};
            points.transform.spacing[1] = 0.7;
            points.transform.direction[1] = 0.3;
            iso_gl_engine *engine = make_engine(contexts.context[c]);
            gl_check_points(engine, &points, views, 2, "scattered spans");
            iso_gl_engine_destroy(engine);
        }
    gl_contexts_close(&contexts);
}

/* Radii of their own, several surfaces, the nearer one in front whatever the order, nothing at all. */
static void surfaces_hide_one_another(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    const iso_point_span span = {.count = 1};
    const iso_point near_point = iso_point_pack(&(iso_surfel){{8, 8, 4}, {0, 0, -1}});
    const iso_point far_point = iso_point_pack(&(iso_surfel){{8, 8, 9}, {1, 0, 0}});
    const float near_radius = 2, far_radius = 5;
    for (int c = 0; c < contexts.count; c++)
        for (int orthographic = 0; orthographic < 2; orthographic++) {
            iso_view view = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .focal = 6, .cx = 50, .cy = 50};
            view.eye = iso_vec3_make(8, 8, -4);
            view.width = view.height = 100;
            view.focal = orthographic ? 6 : 60;
            view.orthographic = orthographic;
            view.near = orthographic ? -1e300 : 0.1;
            iso_gl_engine *engine = make_engine(contexts.context[c]);
            iso_point_view points[2] = {one_point(&far_point, &span, &far_radius),
                                        one_point(&near_point, &span, &near_radius)};
            iso_gl_surface *surfaces[2];
            for (int i = 0; i < 2; i++)
                assert_int_equal(iso_gl_upload_points(engine, &points[i], &surfaces[i], NULL), ISO_OK);
            for (int count = 0; count < 3; count++) {
                iso_gbuffer gl = gl_gbuffer(&view), cpu = gl_gbuffer(&view);
                const iso_gl_draw_opts opts = {.view = &view,
                                               .surfaces = (const iso_gl_surface *const *)surfaces,
                                               .surface_count = count};
                assert_int_equal(iso_gl_draw(engine, &opts, &gl, NULL), ISO_OK);
                for (int i = 0; i < count; i++)
                    iso_draw_points(&(iso_target){&view, &cpu, NULL, (uint8_t)i, NULL}, &points[i], NULL);
                assert_memory_equal(gl.surface, cpu.surface, 100 * 100);
                assert_int_equal(gl.surface[50 * 100 + 50], count ? count - 1 : ISO_SURFACE_NONE);
                iso_gbuffer apart = gl_gbuffer(&view); /* the same one by one, the nearest first */
                for (int i = count - 1; i >= 0; i--) {
                    const iso_gl_draw_opts one = {.view = &view,
                                                  .surfaces = opts.surfaces + i,
                                                  .surface_count = 1,
                                                  .first_surface = i,
                                                  .keep = true};
                    assert_int_equal(iso_gl_draw(engine, &one, &apart, NULL), ISO_OK);
                }
                assert_memory_equal(gl.surface, apart.surface, 100 * 100);
                assert_memory_equal(gl.depth, apart.depth, 100 * 100 * sizeof *gl.depth);
                for (int k = 0; k < 3 * 100 * 100; k++)
                    if (gl.surface[k / 3] != ISO_SURFACE_NONE)
                        assert_true(gl.normal[k % 3][k / 3] == apart.normal[k % 3][k / 3]);
                iso_gbuffer_free(&apart);
                iso_gbuffer_free(&gl);
                iso_gbuffer_free(&cpu);
            }
            for (int i = 0; i < 2; i++) iso_gl_surface_destroy(surfaces[i]);
            iso_gl_engine_destroy(engine);
        }
    gl_contexts_close(&contexts);
}

static void every_shader_compiles(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    for (int c = 0; c < contexts.count; c++)
        for (int i = 0; i < ISO_GL_PROGRAMS; i++) {
            iso_gl_engine *engine = make_engine(contexts.context[c]);
            iso_error error = {ISO_OK, ""};
            unsigned name = 0;
            if (!iso_gl_program_fits((iso_gl_program)i, engine->wide_atomics)) {
                printf("not tested: %s: no atomic operations on 64 bits\n",
                       iso_gl_program_name((iso_gl_program)i));
                iso_gl_engine_destroy(engine);
                continue;
            }
            assert_int_equal(iso_gl_enter(contexts.context[c], NULL), ISO_OK);
            if (iso_gl_engine_program(engine, (iso_gl_program)i, &name, &error) != ISO_OK)
                fail_msg("%s", error.text);
            assert_int_equal(iso_gl_leave(contexts.context[c], ISO_OK, &error), ISO_OK);
            assert_true(name > 0);
            iso_gl_engine_destroy(engine);
        }
    gl_contexts_close(&contexts);
}

/* By the reference compiler, which knows the extensions that software renderers lack. */
static void every_shader_is_valid(void **state) {
    (void)state;
    if (system("glslangValidator --version >/dev/null 2>&1") != 0) {
        printf("not tested: there is no glslangValidator\n");
        skip();
    }
    for (int i = 0; i < ISO_GL_PROGRAMS; i++) {
        char command[4 * 600] = "glslangValidator -l", path[512];
        for (int stage = 0; stage < 2; stage++) {
            snprintf(path, sizeof path, "%s/shader_%d_%d", ISO_TEST_TMP, i, stage);
            FILE *stream = fopen(path, "w");
            assert_non_null(stream);
            const char *file = iso_gl_program_write((iso_gl_program)i, stage, stream);
            assert_int_equal(fclose(stream), 0);
            assert_true(file || stage);
            if (!file) {
                remove(path);
                continue;
            }
            char named[600];
            snprintf(named, sizeof named, "%s%s", path, strrchr(file, '.'));
            assert_int_equal(rename(path, named), 0);
            strcat(strcat(command, " "), named);
        }
        strcat(command, " >" ISO_TEST_TMP "/shaders.log");
        if (system(command) != 0)
            fail_msg("%s: see " ISO_TEST_TMP "/shaders.log", iso_gl_program_name((iso_gl_program)i));
    }
}

/* All kinds at the same time, made and destroyed a hundred times, each drawing while the others live. */
static void contexts_live_side_by_side(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    gl_contexts_close(&contexts);
    iso_grid grid;
    gl_surface s = scene_surface("sphere", 16, true, &grid);
    iso_view view = gl_side_view(&s.box, 0, false, 60, 60);
    iso_point_view points = iso_point_set_view(s.packed);
    iso_gl_context *kept[7] = {NULL};
    iso_gl_engine *engines[7] = {NULL};
    for (int i = 0; i < 100; i++) {
        int slot = i % 7;
        if (engines[slot]) gl_check_points(engines[slot], &points, &view, 1, "before it goes");
        iso_gl_engine_destroy(engines[slot]);
        iso_gl_context_destroy(kept[slot]);
        const iso_gl_context_opts opts = {.kind = (iso_gl_kind)(i % ISO_GL_KINDS)};
        kept[slot] = NULL;
        engines[slot] = NULL;
        if (iso_gl_context_create(&opts, &kept[slot], NULL) != ISO_OK) continue;
        engines[slot] = make_engine(kept[slot]);
        if (i % 10 == 0) gl_check_points(engines[slot], &points, &view, 1, "new");
    }
    for (int slot = 0; slot < 7; slot++) {
        iso_gl_engine_destroy(engines[slot]);
        if (kept[slot]) assert_int_equal(iso_gl_context_messages(kept[slot]).count, 0);
        iso_gl_context_destroy(kept[slot]);
    }
    gl_surface_free(&s);
    iso_grid_destroy(&grid);
}

static double resident_megabytes(void) {
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%*s %ld", &pages) != 1) pages = 0;
    if (file) fclose(file);
    return (double)pages * 4096 / (1 << 20);
}

/* Drivers hold what they made for a context where leak checkers see it; so memory itself is watched. */
static void contexts_give_their_memory_back(void **state) {
    (void)state;
#ifdef __SANITIZE_ADDRESS__
    skip(); /* which keeps what was freed */
#endif
    for (int kind = 0; kind < ISO_GL_KINDS; kind++) {
        double start = 0;
        for (int i = 0; i < 60; i++) {
            const iso_gl_context_opts opts = {.kind = (iso_gl_kind)kind};
            iso_gl_context *context;
            if (iso_gl_context_create(&opts, &context, NULL) != ISO_OK) break;
            iso_gl_engine_destroy(make_engine(context));
            iso_gl_context_destroy(context);
            if (i == 9) start = resident_megabytes();
        }
        double grown = start > 0 ? resident_megabytes() - start : 0;
        printf("kind %d: %.1f MB more after 50 contexts\n", kind, grown);
        assert_true(grown < 10);
    }
}

static void expect_refusal(iso_gl_kind kind, int device, const char *words) {
    iso_gl_context *context = NULL;
    iso_error error = {ISO_OK, ""};
    const iso_gl_context_opts opts = {.kind = kind, .device = device};
    assert_int_equal(iso_gl_context_create(&opts, &context, &error), ISO_ERR_BACKEND);
    assert_null(context);
    if (!strstr(error.text, words)) fail_msg("'%s' does not say '%s'", error.text, words);
}

static void what_is_missing_is_named(void **state) {
    (void)state;
    setenv("ISO_GL_LIBRARY_PATH", ISO_TEST_TMP "/no_libraries", 1);
    expect_refusal(ISO_GL_EGL_DEVICE, 0, "libEGL.so.1");
    expect_refusal(ISO_GL_EGL_SURFACELESS, 0, "libEGL.so.1");
    expect_refusal(ISO_GL_OSMESA, 0, "libOSMesa.so.8");
    iso_gl_context *context = NULL;
    assert_int_equal(iso_gl_context_open_egl(true, &context, NULL), ISO_ERR_BACKEND);
    assert_int_equal(iso_gl_context_open_egl(false, &context, NULL), ISO_ERR_BACKEND);
    unsetenv("ISO_GL_LIBRARY_PATH");
    int count;
    if (iso_gl_devices(NULL, 0, &count, NULL) == ISO_OK)
        expect_refusal(ISO_GL_EGL_DEVICE, 99, "no device 99");
}

static void wrong_use_of_gl_is_noticed(void **state) {
    (void)state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    for (int c = 0; c < contexts.count; c++) {
        iso_error error = {ISO_OK, ""};
        iso_gl_engine *engine = make_engine(contexts.context[c]);
        engine->programs[ISO_GL_POINTS_PACKED] = 12345; /* no program's number */
        const iso_point_span span = {.count = 1};
        const iso_point point = iso_point_pack(&(iso_surfel){{8, 8, 4}, {0, 0, -1}});
        iso_point_view points = one_point(&point, &span, NULL);
        const iso_box box = {{0, 0, 0}, {16, 16, 16}};
        iso_view view = gl_side_view(&box, 0, false, 20, 20);
        iso_gbuffer g = gl_gbuffer(&view);
        iso_gl_surface *surface;
        assert_int_equal(iso_gl_upload_points(engine, &points, &surface, NULL), ISO_OK);
        const iso_gl_draw_opts opts = {
            .view = &view, .surfaces = (const iso_gl_surface *const *)&surface, .surface_count = 1};
        assert_int_equal(iso_gl_draw(engine, &opts, &g, &error), ISO_ERR_BACKEND);
        assert_true(iso_gl_context_messages(contexts.context[c]).count > 0);
        engine->programs[ISO_GL_POINTS_PACKED] = 0;
        assert_int_equal(iso_gl_draw(engine, &opts, &g, &error), ISO_OK);
        iso_gl_surface_destroy(surface);
        iso_gl_engine_destroy(engine);
        iso_gl_context_destroy(contexts.context[c]);
        iso_gbuffer_free(&g);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_the_cpu_engines),
        cmocka_unit_test(limits_of_the_driver_do_not_show),
        cmocka_unit_test(attenuated_points_have_the_width_of_equation_7),
        cmocka_unit_test(precision_does_not_depend_on_the_origin),
        cmocka_unit_test(spans_lie_anywhere),
        cmocka_unit_test(surfaces_hide_one_another),
        cmocka_unit_test(every_shader_compiles),
        cmocka_unit_test(every_shader_is_valid),
        cmocka_unit_test(contexts_live_side_by_side),
        cmocka_unit_test(contexts_give_their_memory_back),
        cmocka_unit_test(what_is_missing_is_named),
        cmocka_unit_test(wrong_use_of_gl_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
