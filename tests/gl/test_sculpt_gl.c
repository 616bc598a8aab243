/* isosculpt's view by OpenGL: the pictures of the cpu engine, the same places under the cursor, and what
 * happens when the driver fails. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "apps/isosculpt/viewport/viewport.h"
#include "gl_support.h"
#include "render/gl/internal.h"
#include "sculpt/session/session.h"
#include "sculpt_support.h"

enum { WIDTH = 301, HEIGHT = 220 };
/* mm, where a voxel has 0.5. */
static const double NEAR = 0.02;

static const iso_journal_start START = {.source = "ball",
                                        .voxel_size = 0.5,
                                        .dims = {96, 96, 96},
                                        .origin = {-23.75, -23.75, -23.75},
                                        .radius = 15};

/* A field, and a view of it by each engine. */
typedef struct studio {
    iso_session *session;
    isosculpt_gl *gl;
    isosculpt_viewport by_cpu, by_gl;
} studio;

static void open_studio(studio *s, iso_gl_context *context) {
    iso_hgrid *grid;
    assert_int_equal(iso_session_solid(&START, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, &START, &(iso_session_opts){.pool = NULL}, &s->session, NULL),
                     ISO_OK);
    assert_int_equal(isosculpt_gl_create(context, &s->gl, NULL), ISO_OK);
    grid = iso_session_grid(s->session);
    assert_int_equal(isosculpt_viewport_init(&s->by_cpu, grid, NULL, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_init(&s->by_gl, grid, NULL, NULL), ISO_OK);
    s->by_gl.gl = s->gl;
    s->by_gl.mode.engine = ISOSCULPT_ENGINE_GL;
}

static void close_studio(studio *s) {
    isosculpt_viewport_free(&s->by_cpu);
    isosculpt_viewport_free(&s->by_gl);
    isosculpt_gl_destroy(s->gl);
    iso_session_destroy(s->session);
}

static void draw(isosculpt_viewport *view, bool moving) {
    iso_error error = {ISO_OK, ""};
    if (isosculpt_viewport_draw(view, WIDTH, HEIGHT, moving, &error) != ISO_OK) fail_msg("%s", error.text);
}

static void draw_best(isosculpt_viewport *view) {
    iso_error error = {ISO_OK, ""};
    draw(view, false);
    while (view->quality != ISOSCULPT_QUALITY_FINE)
        if (isosculpt_viewport_refine(view, &error) != ISO_OK) fail_msg("%s", error.text);
}

static void stroke(studio *s, double x) {
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 4, .strength = 1};
    const iso_sample sample = {.position = {x, -15, 3}, .normal = {0, -1, 0}, .pressure = 1};
    assert_int_equal(iso_session_begin(s->session, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(s->session, NULL), ISO_OK);
}

static double psnr_of(isosculpt_viewport *a, isosculpt_viewport *b) {
    assert_int_equal(isosculpt_viewport_read_back(a, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_read_back(b, NULL), ISO_OK);
    assert_int_equal(a->image.width, b->image.width);
    assert_int_equal(a->image.height, b->image.height);
    return gl_psnr(&a->image, &b->image);
}

/* At most of the places tried. */
static void assert_same_picks(const studio *s, const char *when) {
    int found = 0, all = 0;
    for (double y = 3; y < HEIGHT; y += 9)
        for (double x = 3; x < WIDTH; x += 9) {
            isosculpt_pick a, b;
            if (!isosculpt_pick_buffer_pick(&s->by_cpu.drawn, x, y, &a)) continue;
            all++;
            if (!isosculpt_pick_buffer_pick(&s->by_gl.drawn, x, y, &b)) continue;
            found += fabs(a.depth - b.depth) < NEAR && iso_vec3_dot(a.normal, b.normal) > 0.99 &&
                     iso_vec3_length(iso_vec3_sub(a.position, b.position)) < 2 * NEAR;
        }
    if (!(all > 100 && found > 0.98 * all))
        fail_msg("%s, %s: %d of %d picks", iso_method_name(s->by_gl.mode.method), when, found, all);
}

static void assert_alike(studio *s, bool best, const char *when) {
    const isosculpt_display_mode *mode = &s->by_gl.mode;
    isosculpt_viewport *views[] = {&s->by_cpu, &s->by_gl};
    for (int i = 0; i < 2; i++) best ? draw_best(views[i]) : draw(views[i], false);
    double psnr = psnr_of(views[0], views[1]);
    if (!(psnr >= 40)) fail_msg("%s, %s: %.1f dB", iso_method_name(mode->method), when, psnr);
    assert_null(s->by_cpu.drawn.canvas);
    assert_int_equal(s->by_gl.drawn.canvas != NULL, mode->method != ISO_METHOD_EXACT);
    if (mode->method == ISO_METHOD_EXACT) assert_true(isinf(psnr));
    assert_same_picks(s, when);
}

static void check_method(studio *s, int index) {
    s->by_cpu.mode.method = s->by_gl.mode.method = isosculpt_methods[index];
    assert_alike(s, false, "at rest");
    assert_alike(s, true, "at its best");
    stroke(s, -4 + 2.5 * index);
    assert_alike(s, false, "after a stroke");
    isosculpt_viewport_orbit(&s->by_cpu, 25, 10);
    isosculpt_viewport_orbit(&s->by_gl, 25, 10);
    assert_alike(s, true, "from elsewhere");
    assert_int_equal(iso_session_undo(s->session, NULL), ISO_OK);
    assert_alike(s, true, "undone");
    for (int light = ISOSCULPT_SHADING_COUNT - 1; light >= 0; light--) {
        s->by_cpu.mode.material.shading = s->by_gl.mode.material.shading = (isosculpt_shading)light;
        assert_alike(s, false, isosculpt_shading_name((isosculpt_shading)light));
    }
}

static void pictures_are_the_cpu_engines(iso_gl_context *context) {
    studio s;
    open_studio(&s, context);
    for (int method = 0; method < ISOSCULPT_METHODS; method++) check_method(&s, method);
    close_studio(&s);
}

/* Discs of what is visible: turning the model and editing it gives the bytes of a new engine, which has no
 * frames before, and the cpu engine's picture. */
static void frames_of_discs_do_not_depend_on_frames_before(iso_gl_context *context) {
    studio s;
    open_studio(&s, context);
    s.by_cpu.mode.method = s.by_gl.mode.method = ISO_METHOD_DISCS;
    for (int frame = 0; frame < 12; frame++) {
        if (frame % 4 == 3) stroke(&s, frame - 6);
        if (frame == 8) assert_int_equal(iso_session_undo(s.session, NULL), ISO_OK);
        draw(&s.by_gl, false);
        isosculpt_gl *anew;
        isosculpt_viewport other;
        assert_int_equal(isosculpt_gl_create(context, &anew, NULL), ISO_OK);
        assert_int_equal(isosculpt_viewport_init(&other, iso_session_grid(s.session), NULL, NULL), ISO_OK);
        other.gl = anew;
        other.mode = s.by_gl.mode;
        other.camera = s.by_cpu.camera = s.by_gl.camera;
        draw(&other, false);
        draw(&s.by_cpu, false);
        assert_non_null(s.by_gl.drawn.canvas);
        assert_true(isinf(psnr_of(&s.by_gl, &other)));
        const double psnr = psnr_of(&s.by_gl, &s.by_cpu);
        if (!(psnr >= 43)) fail_msg("frame %d: %.1f dB from the cpu engine", frame, psnr);
        isosculpt_viewport_free(&other);
        isosculpt_gl_destroy(anew);
        isosculpt_viewport_orbit(&s.by_gl, frame == 6 ? 150 : 4, 2);
    }
    close_studio(&s);
}

/* Exact pictures cannot be had while the camera moves: the mesh stands in, as fine as the window. */
static void mesh_stands_in_for_exact(iso_gl_context *context) {
    studio s;
    open_studio(&s, context);
    draw(&s.by_gl, true);
    assert_non_null(s.by_gl.drawn.canvas);
    assert_int_equal(s.by_gl.quality, ISOSCULPT_QUALITY_MOVING);
    s.by_cpu.mode.method = ISO_METHOD_MESH;
    draw(&s.by_cpu, false);
    assert_true(psnr_of(&s.by_cpu, &s.by_gl) >= 40);
    draw(&s.by_gl, false);
    assert_null(s.by_gl.drawn.canvas);
    assert_int_equal(s.by_gl.quality, ISOSCULPT_QUALITY_REST);
    stroke(&s, 0); /* and what changed of it is drawn as without OpenGL */
    draw(&s.by_gl, true);
    assert_null(s.by_gl.drawn.canvas);
    assert_true(isosculpt_damage_area(&s.by_gl.redrawn) < (size_t)WIDTH * HEIGHT);
    s.by_cpu.mode.method = ISO_METHOD_EXACT;
    draw(&s.by_cpu, false);
    assert_true(isinf(psnr_of(&s.by_cpu, &s.by_gl)));
    close_studio(&s);
}

/* Strokes pick from the picture that they began on. */
static void held_picture_stays(iso_gl_context *context) {
    studio s;
    isosculpt_pick before, picked, now;
    open_studio(&s, context);
    const double x = WIDTH / 2.0, y = HEIGHT / 2.0;
    s.by_gl.mode.method = ISO_METHOD_MESH;
    draw(&s.by_gl, false);
    assert_true(isosculpt_pick_buffer_pick(&s.by_gl.drawn, x, y, &before));
    assert_int_equal(isosculpt_viewport_keep_pick_buffer(&s.by_gl, NULL), ISO_OK);
    stroke(&s, 0);
    draw(&s.by_gl, true);
    assert_true(isosculpt_pick_buffer_pick(&s.by_gl.pick_buffer, x, y, &picked));
    assert_true(isosculpt_pick_buffer_pick(&s.by_gl.drawn, x, y, &now));
    assert_memory_equal(&picked, &before, sizeof picked);
    assert_true(now.depth < before.depth - 1);
    s.by_gl.mode.engine = ISOSCULPT_ENGINE_CPU; /* what is held does not depend on what draws now */
    draw(&s.by_gl, false);
    assert_true(isosculpt_pick_buffer_pick(&s.by_gl.pick_buffer, x, y, &picked));
    assert_memory_equal(&picked, &before, sizeof picked);
    assert_int_equal(isosculpt_viewport_keep_pick_buffer(&s.by_gl, NULL), ISO_OK);
    assert_true(isosculpt_pick_buffer_pick(&s.by_gl.pick_buffer, x, y, &picked));
    assert_true(fabs(picked.depth - now.depth) < 0.01);
    close_studio(&s);
}

/* The cpu engine goes on where the driver fails, whenever that is. */
static void driver_that_fails_is_done_without(iso_gl_context *context) {
    for (int when = 0; when < 3; when++) {
        studio s;
        open_studio(&s, context);
        s.by_gl.mode.method = s.by_cpu.mode.method = ISO_METHOD_POINTS;
        if (when) draw(&s.by_gl, false);
        context->lost = true;
        if (when == 1) isosculpt_viewport_orbit(&s.by_gl, 10, 0);
        s.by_cpu.camera = s.by_gl.camera;
        draw_best(&s.by_gl);
        draw_best(&s.by_cpu);
        assert_true(strstr(s.by_gl.gl_error.text, "lost"));
        assert_int_equal(s.by_gl.mode.engine, ISOSCULPT_ENGINE_CPU);
        assert_true(isinf(psnr_of(&s.by_cpu, &s.by_gl)));
        context->lost = false; /* so that it can be cleared away */
        close_studio(&s);
    }
}

static bool everywhere(const void *context, int x, int y, int z) {
    (void)context, (void)x, (void)y, (void)z;
    return true;
}

/* What is frozen looks it, which OpenGL cannot draw. */
static void frozen_parts_are_the_cpu_engines(iso_gl_context *context) {
    studio s;
    open_studio(&s, context);
    s.by_gl.mode.method = s.by_cpu.mode.method = ISO_METHOD_MESH;
    draw(&s.by_gl, true);
    s.by_gl.mask.at = s.by_cpu.mask.at = everywhere;
    s.by_gl.mask_changed = s.by_cpu.mask_changed = true;
    draw_best(&s.by_gl);
    draw_best(&s.by_cpu);
    assert_true(isinf(psnr_of(&s.by_cpu, &s.by_gl)));
    close_studio(&s);
}

static iso_rgrid *make_volume(void) {
    enum { SIDE = 48 };
    iso_rgrid *volume;
    const iso_rgrid_desc desc = {.dims = {SIDE, SIDE, SIDE}, .type = ISO_UINT8};
    assert_int_equal(iso_rgrid_create(&desc, &volume, NULL), ISO_OK);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int x = i % SIDE - 20, y = i / SIDE % SIDE - 24, z = i / SIDE / SIDE - 28;
        ((uint8_t *)volume->data)[i] = (uint8_t)(250 - (x * x + y * y + 2 * z * z) / 16);
    }
    return volume;
}

static void open_volume(isosculpt_viewport *view, iso_rgrid *volume, isosculpt_gl *gl) {
    const iso_grid grid = {.rgrid = volume};
    assert_int_equal(isosculpt_viewport_init_grid(view, &grid, 225, NULL, NULL), ISO_OK);
    view->gl = gl;
    view->mode.engine = ISOSCULPT_ENGINE_GL;
    view->sliding = true;
}

static void go_to_level(isosculpt_lod *levels, int level) {
    while (isosculpt_lod_level(levels) < level) isosculpt_lod_record_times(levels, 1, 1);
    while (isosculpt_lod_level(levels) > level) isosculpt_lod_record_times(levels, 0, 0);
}

/* From one level to another OpenGL keeps nothing of the points before. */
static void levels_do_not_mix(iso_gl_context *context) {
    static const int levels[] = {0, 1, 0, 2, 1};
    iso_rgrid *volume = make_volume();
    isosculpt_gl *gl, *other_gl;
    isosculpt_viewport view, other;
    assert_int_equal(isosculpt_gl_create(context, &gl, NULL), ISO_OK);
    assert_int_equal(isosculpt_gl_create(context, &other_gl, NULL), ISO_OK);
    open_volume(&view, volume, gl);
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        go_to_level(view.lod, levels[i]);
        view.moving_factor = 1; /* however long the picture before took */
        draw(&view, true);
        open_volume(&other, volume, other_gl);
        other.camera = view.camera;
        go_to_level(other.lod, levels[i]);
        draw(&other, true);
        assert_non_null(view.drawn.canvas);
        if (!isinf(psnr_of(&view, &other))) fail_msg("step %zu, level %d", i, levels[i]);
        isosculpt_viewport_free(&other);
        isosculpt_viewport_orbit(&view, 5, 0); /* the isovalue stays, and with it the numbers of spans */
    }
    isosculpt_viewport_free(&view);
    isosculpt_gl_destroy(other_gl);
    isosculpt_gl_destroy(gl);
    iso_rgrid_destroy(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_context_test(pictures_are_the_cpu_engines),
        gl_context_test(frames_of_discs_do_not_depend_on_frames_before),
        gl_context_test(mesh_stands_in_for_exact),
        gl_context_test(held_picture_stays),
        gl_context_test(driver_that_fails_is_done_without),
        gl_context_test(frozen_parts_are_the_cpu_engines),
        gl_context_test(levels_do_not_mix),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
