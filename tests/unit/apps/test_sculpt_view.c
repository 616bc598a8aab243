/* isosculpt's view: what a stroke, an undo or a camera move leaves in the picture is what a new view would
 * draw, to the bit, however little of it was drawn again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "apps/isosculpt/viewport/viewport.h"
#include "render/picture.h"
#include "sculpt/session/session.h"
#include "sculpt_support.h"
#include "viewport_support.h"

enum { WIDTH = VIEWPORT_WIDTH, HEIGHT = VIEWPORT_HEIGHT };

static void open_view(isosculpt_viewport *view, iso_session *session, iso_pool *pool) {
    iso_error error = {0};
    if (isosculpt_viewport_init(view, iso_session_grid(session), pool, &error) != ISO_OK)
        fail_msg("%s", error.text);
}

/* Two views of one field from one place hold the same picture and the same samples to pick from. */
static void assert_same(const isosculpt_viewport *a, const isosculpt_viewport *b) {
    const size_t pixels = (size_t)WIDTH * HEIGHT;
    assert_int_equal(a->image.width, b->image.width);
    assert_memory_equal(a->image.rgba, b->image.rgba, 4 * pixels);
    viewport_same_samples(a, b);
}

static void assert_as_new(const isosculpt_viewport *view, iso_session *session, iso_pool *pool) {
    isosculpt_viewport fresh;
    open_view(&fresh, session, pool);
    fresh.camera = view->camera;
    viewport_draw(&fresh, false);
    assert_same(view, &fresh);
    isosculpt_viewport_free(&fresh);
}

static size_t stroke(iso_session *session, isosculpt_viewport *view, uint32_t *seed) {
    iso_brush brush = {.tool = (iso_tool)(uniform(seed) * (ISO_TOOL_MOVE + 1)),
                       .radius = 1 + 3 * uniform(seed),
                       .strength = 0.5,
                       .symmetry = uniform(seed) < 0.3 ? 1 : 0};
    return viewport_stroke(view, session, &brush, seed);
}

static void test_patched_picture_is_the_whole_one(void **state) {
    (void)state;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    iso_session *session = viewport_session(pool);
    isosculpt_viewport view;
    uint32_t seed = 7;
    size_t drawn = 0;
    open_view(&view, session, pool);
    viewport_draw(&view, false);
    for (int i = 0; i < 40; i++) {
        drawn += stroke(session, &view, &seed);
        assert_as_new(&view, session, pool);
        if (i % 4 == 3) {
            assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
            viewport_draw(&view, true);
            assert_as_new(&view, session, pool);
        }
        if (i % 10 != 9) continue;
        isosculpt_viewport_orbit(&view, 20, 5);
        isosculpt_viewport_zoom(&view, 1.2); /* at last parts of the surface are out of sight */
        viewport_draw(&view, true);
        viewport_draw(&view, false);
        assert_as_new(&view, session, pool);
    }
    print_message("of the pictures %.1f %% was drawn again\n",
                  100.0 * (double)drawn / (120.0 * WIDTH * HEIGHT));
    assert_true(drawn < 120.0 * WIDTH * HEIGHT / 4);
    isosculpt_viewport_free(&view);
    iso_session_destroy(session);
    iso_pool_destroy(pool);
}

/* Strokes on a picture that was coarse because the camera moved. */
static void test_stroke_right_after_camera(void **state) {
    (void)state;
    iso_session *session = viewport_session(NULL);
    isosculpt_viewport view;
    uint32_t seed = 11;
    open_view(&view, session, NULL);
    view.moving_factor = 3;
    viewport_draw(&view, true);
    assert_int_equal(view.image.width, WIDTH / 3);
    assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
    stroke(session, &view, &seed);
    assert_as_new(&view, session, NULL);
    isosculpt_viewport_orbit(&view, 10, 0);
    view.moving_factor = 1;
    viewport_draw(&view, true); /* fast enough: it is the picture at rest */
    assert_int_equal(view.quality, ISOSCULPT_QUALITY_REST);
    assert_as_new(&view, session, NULL);
    isosculpt_viewport_free(&view);
    iso_session_destroy(session);
}

static iso_status draw_exact(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    iso_target target = {.view = view, .gbuffer = gbuffer};
    return iso_draw_exact(&target, context, error);
}

/* Smoothed in pieces, and again only where a stroke was. */
static void test_fine_picture(void **state) {
    (void)state;
    iso_session *session = viewport_session(NULL);
    isosculpt_viewport view;
    iso_image image;
    uint32_t seed = 3;
    open_view(&view, session, NULL);
    viewport_draw(&view, false);
    viewport_refine(&view);
    size_t drawn = stroke(session, &view, &seed);
    assert_int_equal(view.quality, ISOSCULPT_QUALITY_REST);
    assert_true(isosculpt_damage_area(&view.unrefined) <= drawn && drawn < (size_t)WIDTH * HEIGHT);
    viewport_refine(&view);
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    iso_picture_opts opts = {.camera = &view.camera,
                             .width = WIDTH,
                             .height = HEIGHT,
                             .samples = 4,
                             .shading = {.colors = &view.mode.material.color,
                                         .color_count = 1,
                                         .background = view.mode.material.background},
                             .draw = draw_exact,
                             .draw_context = view.surface.exact};
    assert_int_equal(iso_picture_render(&opts, &image, NULL, NULL), ISO_OK);
    assert_memory_equal(view.image.rgba, image.rgba, (size_t)WIDTH * HEIGHT * 4);
    iso_image_free(&image);
    isosculpt_viewport_free(&view);
    iso_session_destroy(session);
}

static void test_held_picture_stays(void **state) {
    (void)state;
    iso_session *session = viewport_session(NULL);
    isosculpt_viewport view;
    isosculpt_pick before, picked, now;
    open_view(&view, session, NULL);
    viewport_draw(&view, false);
    const double x = WIDTH / 2.0, y = HEIGHT / 2.0;
    assert_true(isosculpt_pick_buffer_pick(&view.drawn, x, y, &before));
    assert_int_equal(isosculpt_viewport_keep_pick_buffer(&view, NULL), ISO_OK);
    iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 4, .strength = 1};
    iso_sample sample = {.position = before.position, .normal = before.normal, .pressure = 1};
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
    viewport_draw(&view, true);
    assert_true(isosculpt_pick_buffer_pick(&view.pick_buffer, x, y, &picked));
    assert_true(isosculpt_pick_buffer_pick(&view.drawn, x, y, &now));
    assert_memory_equal(&picked, &before, sizeof picked);
    assert_true(now.depth < before.depth - 3.9);
    isosculpt_viewport_free(&view);
    iso_session_destroy(session);
}

/* What was beside the middle is in it, no larger and no smaller, and orbiting turns about it. */
static void test_focus(void **state) {
    (void)state;
    iso_session *session = viewport_session(NULL);
    isosculpt_viewport view;
    isosculpt_pick before, after;
    double x, y;
    open_view(&view, session, NULL);
    viewport_draw(&view, false);
    assert_true(isosculpt_pick_buffer_pick(&view.drawn, 0.6 * WIDTH, 0.4 * HEIGHT, &before));
    isosculpt_viewport_focus(&view, &before.position);
    for (int i = 0; i < 3; i++) {
        viewport_draw(&view, false);
        assert_true(isosculpt_pick_buffer_pixel(&view.drawn, before.position, &x, &y));
        assert_float_equal(x, WIDTH / 2.0, 0.01);
        assert_float_equal(y, HEIGHT / 2.0, 0.01);
        if (i == 0) {
            assert_true(isosculpt_pick_buffer_pick(&view.drawn, x, y, &after));
            assert_float_equal(after.depth, before.depth, 0.05);
        }
        isosculpt_viewport_orbit(&view, 20, 10);
    }
    isosculpt_viewport_free(&view);
    iso_session_destroy(session);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_patched_picture_is_the_whole_one),
        cmocka_unit_test(test_stroke_right_after_camera),
        cmocka_unit_test(test_fine_picture),
        cmocka_unit_test(test_held_picture_stays),
        cmocka_unit_test(test_focus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
