/* gl_support: OpenGL contexts, and comparisons of the gl engine with the cpu engine. */
#include "gl_support.h"

#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "render/raster/raster.h"
#include "render/shading/shading.h"

/* Called by the leak sanitizer: OSMesa leaks a few bytes of every context (Mesa 22.3). */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
    return "leak:libOSMesa.so";
}

bool gl_contexts_open(gl_contexts *contexts) {
    static const iso_gl_kind kinds[] = {ISO_GL_EGL_SURFACELESS, ISO_GL_OSMESA};
    *contexts = (gl_contexts){.count = 0};
    for (int i = 0; i < 2; i++) {
        iso_error error = {ISO_OK, ""};
        const iso_gl_context_opts opts = {.kind = kinds[i], .debug = true};
        if (iso_gl_context_create(&opts, &contexts->context[contexts->count], &error) == ISO_OK)
            contexts->count++;
        else
            printf("not tested: %s\n", error.text);
    }
    return contexts->count > 0;
}

void gl_contexts_close(gl_contexts *contexts) {
    for (int i = 0; i < contexts->count; i++) {
        iso_gl_messages messages = iso_gl_context_messages(contexts->context[i]);
        if (messages.count)
            fail_msg("%s: %zu messages, the first: %s", iso_gl_context_info(contexts->context[i]).name,
                     messages.count, messages.first);
        iso_gl_context_destroy(contexts->context[i]);
    }
}

void gl_on_each_context(void **state) {
    gl_context_check *const *check = *state;
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    for (int c = 0; c < contexts.count; c++) (*check)(contexts.context[c]);
    gl_contexts_close(&contexts);
}

/* Runs a check with an engine on each of the first `most` contexts. */
static void check_engines(gl_engine_check *check, int most) {
    gl_contexts contexts;
    if (!gl_contexts_open(&contexts)) skip();
    for (int c = 0; c < contexts.count && c < most; c++) {
        iso_gl_engine *engine;
        iso_error error = {ISO_OK, ""};
        if (iso_gl_engine_create(contexts.context[c], &engine, &error) != ISO_OK) fail_msg("%s", error.text);
        check(engine);
        iso_gl_engine_destroy(engine);
    }
    gl_contexts_close(&contexts);
}

void gl_on_each_engine(void **state) {
    gl_engine_check *const *check = *state;
    check_engines(*check, INT_MAX);
}

void gl_on_first_engine(void **state) {
    gl_engine_check *const *check = *state;
    check_engines(*check, 1);
}

iso_gbuffer gl_gbuffer(const iso_view *view) {
    iso_gbuffer gbuffer;
    assert_int_equal(iso_gbuffer_create(view->width, view->height, &gbuffer, NULL), ISO_OK);
    iso_gbuffer_clear(&gbuffer);
    return gbuffer;
}

static iso_image shaded(const iso_view *view, const iso_gbuffer *gbuffer) {
    static const iso_rgb colors[] = {{0xD9, 0xB3, 0x6C}, {0x3F, 0x6F, 0xA8}};
    iso_image image;
    assert_int_equal(iso_image_create(view->width, view->height, &image, NULL), ISO_OK);
    const iso_shading shading = {colors, 2, {255, 255, 255}, 0, {0, 0, 0}};
    const iso_strip strip = {view, gbuffer, 1, 0};
    iso_shade(&shading, &strip, &image, NULL);
    return image;
}

static bool covered(const iso_gbuffer *g, int x, int y) {
    return x >= 0 && y >= 0 && x < g->width && y < g->height &&
           g->surface[(size_t)y * (size_t)g->width + (size_t)x] != ISO_SURFACE_NONE;
}

static bool opposed(const iso_gbuffer *a, const iso_gbuffer *b, size_t i) {
    return iso_vec3_dot(iso_gbuffer_normal(a, i), iso_gbuffer_normal(b, i)) < 0;
}

double gl_psnr(const iso_image *a, const iso_image *b) {
    size_t count = (size_t)a->width * (size_t)a->height * 4;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double d = (double)a->rgba[i] - b->rgba[i];
        if (i % 4 != 3) sum += d * d;
    }
    return sum > 0 ? 10 * log10(255.0 * 255.0 * 0.75 * (double)count / sum) : INFINITY;
}

gl_difference gl_compare(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b) {
    gl_difference d = {0};
    iso_image first = shaded(view, a), second = shaded(view, b);
    d.psnr = gl_psnr(&first, &second);
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            size_t i = (size_t)y * (size_t)view->width + (size_t)x;
            bool in_a = covered(a, x, y), in_b = covered(b, x, y);
            d.differ += in_a != in_b;
            d.turned += in_a && in_b && opposed(a, b, i);
            d.outline += in_a && !(covered(a, x - 1, y) && covered(a, x + 1, y) && covered(a, x, y - 1) &&
                                   covered(a, x, y + 1));
            double between = fabs(a->depth[i] - b->depth[i]);
            if (in_a && in_b && between < 0.01 && between > d.depth) d.depth = between;
        }
    iso_image_free(&first);
    iso_image_free(&second);
    return d;
}

iso_view gl_side_view(const iso_box *box, int side, bool orthographic, int width, int height) {
    iso_camera camera = {.view_angle = 30, .orthographic = orthographic, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors((iso_direction)side, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_fit(&camera, box, (double)width / height, 1);
    return iso_view_make(&camera, width, height);
}

static iso_point_set *make_points(const iso_grid *grid, const iso_points_opts *opts) {
    iso_point_set *set;
    assert_int_equal(iso_point_set_create(grid, opts, &set, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    return set;
}

iso_point_set *gl_discs_make(const iso_grid *grid, double isovalue, bool floats) {
    const iso_points_opts opts = {
        .isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE, .floats = floats, .curvature = true};
    return make_points(grid, &opts);
}

gl_surface gl_surface_make(const iso_grid *grid, double isovalue) {
    gl_surface s = {make_points(grid, &(iso_points_opts){.isovalue = isovalue}),
                    make_points(grid, &(iso_points_opts){.isovalue = isovalue, .floats = true}), NULL,
                    iso_box_empty()};
    assert_int_equal(iso_mesh_set_create(grid, &(iso_mesh_opts){.isovalue = isovalue}, &s.mesh, NULL),
                     ISO_OK);
    assert_int_equal(iso_mesh_set_update(s.mesh, NULL), ISO_OK);
    iso_mesh_view mesh = iso_mesh_set_view(s.mesh);
    iso_affine affine = iso_transform_affine(&mesh.transform);
    iso_box box = iso_mesh_view_bounds(&mesh);
    s.box = iso_box_transform(&box, &affine);
    return s;
}

void gl_surface_free(gl_surface *surface) {
    iso_point_set_destroy(surface->packed);
    iso_point_set_destroy(surface->floats);
    iso_mesh_set_destroy(surface->mesh);
}

/* Compares the picture of the gl engine with the cpu engine's, and frees it. */
static double check_picture(const iso_view *view, const iso_gbuffer *cpu, iso_gbuffer *gl, const char *name) {
    gl_difference d = gl_compare(view, cpu, gl);
    const double most = 0.01 * d.outline;
    if (!(d.outline > 0 && d.psnr >= 40 && d.differ <= most && d.turned <= 2 * most))
        fail_msg("%s: %.1f dB, %d of %d pixels of the outline differ, %d normals are turned", name, d.psnr,
                 d.differ, d.outline, d.turned);
    iso_gbuffer_free(gl);
    return d.psnr;
}

static double check(iso_gl_engine *engine, const iso_view *view, const iso_gbuffer *cpu,
                    const iso_gl_surface *surface, const char *name) {
    iso_gbuffer gl = gl_gbuffer(view);
    iso_error error = {ISO_OK, ""};
    const iso_gl_draw_opts opts = {.view = view, .surfaces = &surface, .surface_count = 1};
    iso_status status = iso_gl_draw(engine, &opts, &gl, &error);
    if (status != ISO_OK) fail_msg("%s: %s", name, error.text);
    return check_picture(view, cpu, &gl, name);
}

double gl_check_pullpush(iso_gl_engine *engine, const iso_point_view *points,
                         iso_reconstruction reconstruction, const iso_view *views, int count,
                         const char *name) {
    iso_gl_surface *surface;
    iso_error error = {ISO_OK, ""};
    double worst = INFINITY;
    if (iso_gl_upload_points(engine, points, &surface, &error) != ISO_OK) fail_msg("%s", error.text);
    for (int i = 0; i < count; i++) {
        iso_gbuffer cpu = gl_gbuffer(&views[i]), gl = gl_gbuffer(&views[i]);
        const iso_target target = {.view = &views[i], .gbuffer = &cpu};
        assert_int_equal(iso_draw_point_surface(&target, points,
                                                &(iso_point_surface_opts){.reconstruction = reconstruction},
                                                NULL),
                         ISO_OK);
        const iso_gl_pullpush_opts opts = {&views[i], (const iso_gl_surface *const *)&surface, 1,
                                           reconstruction, ISO_SELECTION_ALL};
        if (iso_gl_draw_pullpush(engine, &opts, &gl, &error) != ISO_OK) fail_msg("%s: %s", name, error.text);
        worst = fmin(worst, check_picture(&views[i], &cpu, &gl, name));
        iso_gbuffer_free(&cpu);
    }
    iso_gl_surface_destroy(surface);
    return worst;
}

/* Draws points or a mesh with the cpu engine. */
typedef iso_status draw_fn(const iso_target *target, const void *view);

static iso_status draw_points(const iso_target *target, const void *view) {
    return iso_draw_points(target, view, NULL);
}
static iso_status draw_mesh(const iso_target *target, const void *view) {
    return iso_draw_mesh(target, view, NULL);
}

/* Compares the pictures of several views; frees the surface. */
static double check_views(iso_gl_engine *engine, iso_gl_surface *surface, draw_fn *draw,
                          const void *primitives, const iso_view *views, int count, const char *name) {
    double worst = INFINITY;
    for (int i = 0; i < count; i++) {
        iso_gbuffer cpu = gl_gbuffer(&views[i]);
        assert_int_equal(draw(&(iso_target){.view = &views[i], .gbuffer = &cpu}, primitives), ISO_OK);
        worst = fmin(worst, check(engine, &views[i], &cpu, surface, name));
        iso_gbuffer_free(&cpu);
    }
    iso_gl_surface_destroy(surface);
    return worst;
}

double gl_check_points(iso_gl_engine *engine, const iso_point_view *points, const iso_view *views, int count,
                       const char *name) {
    iso_gl_surface *surface;
    iso_error error = {ISO_OK, ""};
    if (iso_gl_upload_points(engine, points, &surface, &error) != ISO_OK) fail_msg("%s", error.text);
    return check_views(engine, surface, draw_points, points, views, count, name);
}

double gl_check_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, const iso_view *views, int count,
                     const char *name) {
    iso_gl_surface *surface;
    iso_error error = {ISO_OK, ""};
    if (iso_gl_upload_mesh(engine, mesh, &surface, &error) != ISO_OK) fail_msg("%s", error.text);
    return check_views(engine, surface, draw_mesh, mesh, views, count, name);
}
