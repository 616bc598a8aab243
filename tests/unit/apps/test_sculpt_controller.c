/* isosculpt's input controller: strokes that run out of memory. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "apps/isosculpt/input_controller.h"
#include "apps/isosculpt/look.h"
#include "refused_memory.h"
#include "sculpt_support.h"

enum { WIDTH = 160, HEIGHT = 100 };

static const iso_journal_start START = {.source = "ball",
                                        .voxel_size = 0.5,
                                        .dims = {96, 96, 96},
                                        .origin = {-23.75, -23.75, -23.75},
                                        .radius = 15};

static void press(isosculpt_controller *controller) {
    isosculpt_controller_press(controller, ISOSCULPT_BUTTON_LEFT, 0, WIDTH / 2, HEIGHT / 2);
    assert_int_equal(controller->drag, ISOSCULPT_DRAG_BRUSH);
}

/* A stroke whose end is refused memory is taken back, and the next one can be drawn. */
static void strokes_that_cannot_end_are_taken_back(void **state) {
    (void)state;
    isosculpt_document document = {.start = START};
    isosculpt_viewport view;
    isosculpt_controller controller;
    iso_hgrid *grid;
    const iso_session_opts opts = {0};
    assert_int_equal(iso_session_solid(&START, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, &START, &opts, &document.session, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_init(&view, grid, NULL, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_draw(&view, WIDTH, HEIGHT, false, NULL), ISO_OK);
    isosculpt_controller_init(&controller, &document, &view);
    iso_hgrid *before = sculpt_copy(grid);
    const iso_history *history = iso_session_history(document.session);
    int refused = 0;
    for (long calls = 0; iso_history_count(history) == 0; calls++) {
        press(&controller);
        assert_false(sculpt_same(grid, before));
        test_refuse_memory_after(calls);
        isosculpt_controller_release(&controller, ISOSCULPT_BUTTON_LEFT);
        test_grant_memory();
        if (iso_history_count(history)) break;
        assert_int_equal(controller.error.status, ISO_ERR_NOMEM);
        refused++;
    }
    assert_true(refused > 2);
    assert_false(sculpt_same(grid, before));
    assert_int_equal(iso_session_undo(document.session, NULL), ISO_OK);
    assert_true(sculpt_same(grid, before));
    iso_hgrid_destroy(before);
    isosculpt_viewport_free(&view);
    iso_session_destroy(document.session);
}

/* A session with a viewport, drawn once, and a controller for both. */
typedef struct scene {
    isosculpt_document document;
    isosculpt_viewport view;
    isosculpt_controller controller;
} scene;

static void open_scene(scene *s) {
    const iso_session_opts opts = {0};
    iso_hgrid *grid;
    *s = (scene){.document = {.start = START}};
    assert_int_equal(iso_session_solid(&START, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, &START, &opts, &s->document.session, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_init(&s->view, grid, NULL, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_draw(&s->view, WIDTH, HEIGHT, false, NULL), ISO_OK);
    isosculpt_controller_init(&s->controller, &s->document, &s->view);
}

static void close_scene(scene *s) {
    isosculpt_controller_free(&s->controller);
    isosculpt_viewport_free(&s->view);
    iso_session_destroy(s->document.session);
}

static void draw_stroke(isosculpt_controller *controller, int to_x) {
    isosculpt_controller_move(controller, WIDTH / 2, HEIGHT / 2);
    press(controller);
    isosculpt_controller_move(controller, to_x, HEIGHT / 2);
    isosculpt_controller_release(controller, ISOSCULPT_BUTTON_LEFT);
}

/* What is drawn while there is no field yet becomes, played, what it would have been. */
static void strokes_wait_for_a_field(void **state) {
    (void)state;
    scene direct, late;
    open_scene(&direct);
    open_scene(&late);
    late.controller.viewing_volume = true;
    isosculpt_controller_press(&late.controller, ISOSCULPT_BUTTON_LEFT, 0, WIDTH / 2, HEIGHT / 2);
    assert_int_equal(late.controller.drag, ISOSCULPT_DRAG_ORBIT); /* no brush was picked */
    isosculpt_controller_release(&late.controller, ISOSCULPT_BUTTON_LEFT);
    assert_true(isosculpt_controller_key(&late.controller, '1', 0, true));
    assert_true(late.controller.commands & ISOSCULPT_COMMAND_SCULPT);
    assert_true(late.controller.field_pending); /* before the window has carried out the command */
    draw_stroke(&late.controller, WIDTH / 2 + 20);
    isosculpt_controller_move(&late.controller, WIDTH / 2, HEIGHT / 2);
    press(&late.controller);
    assert_int_equal(late.controller.drag, ISOSCULPT_DRAG_BRUSH);
    isosculpt_controller_drop_strokes(&late.controller); /* it could not be */
    assert_int_equal(late.controller.drag, ISOSCULPT_DRAG_NONE);
    assert_int_equal(late.controller.queued_strokes.count, 0);
    assert_false(late.controller.field_pending);
    isosculpt_controller_key(&late.controller, '1', 0, true);
    iso_hgrid *before = sculpt_copy(iso_session_grid(late.document.session));
    draw_stroke(&late.controller, WIDTH / 2 + 20);
    draw_stroke(&late.controller, WIDTH / 2 - 10);
    draw_stroke(&late.controller, WIDTH / 2 - 20);
    isosculpt_controller_key(&late.controller, 'z', ISOSCULPT_MODIFIER_CTRL, true); /* not the last one */
    assert_int_equal(late.controller.queued_strokes.count, 2);
    assert_true(sculpt_same(iso_session_grid(late.document.session), before));
    isosculpt_strokes waiting = late.controller.queued_strokes;
    late.controller.queued_strokes = (isosculpt_strokes){0};
    late.controller.viewing_volume = late.controller.field_pending = false;
    isosculpt_controller_apply_strokes(&late.controller, &waiting);
    assert_int_equal(late.controller.error.status, ISO_OK);
    assert_int_equal(late.document.change_count, 2);
    draw_stroke(&direct.controller, WIDTH / 2 + 20);
    draw_stroke(&direct.controller, WIDTH / 2 - 10); /* (the picture picked from is the same) */
    assert_true(
        sculpt_same(iso_session_grid(late.document.session), iso_session_grid(direct.document.session)));
    iso_hgrid_destroy(before);
    close_scene(&direct);
    close_scene(&late);
}

/* In the middle of what is there, on half voxels. */
static void the_mirror_is_in_the_middle(void **state) {
    (void)state;
    scene s;
    open_scene(&s);
    assert_true(iso_vec3_length(s.controller.brush.mirror) < 1e-12);
    const iso_brush bump = {.tool = ISO_TOOL_ADD, .radius = 4};
    const iso_sample sample = {.position = {15, 0, 0}, .normal = {1, 0, 0}, .pressure = 1};
    assert_int_equal(iso_session_begin(s.document.session, &bump, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(s.document.session, NULL), ISO_OK);
    isosculpt_controller_center_mirror(&s.controller);
    assert_true(fabs(s.controller.brush.mirror.x - 2) < 0.26); /* from -15 to 19, give or take half a voxel */
    const double halves = 2 * (s.controller.brush.mirror.x - START.origin.x) / START.voxel_size;
    assert_true(fabs(halves - round(halves)) < 1e-9);
    close_scene(&s);
}

/* The whole mask is changed as a stroke, which can be undone, and not while another one is drawn. */
static void masks_are_inverted_and_cleared(void **state) {
    (void)state;
    scene s;
    open_scene(&s);
    const iso_history *history = iso_session_history(s.document.session);
    isosculpt_controller_change_mask(&s.controller, ISO_TOOL_CLEAR_MASK); /* there is none */
    assert_int_equal(iso_history_count(history), 0);
    assert_true(isosculpt_controller_key(&s.controller, 'i', ISOSCULPT_MODIFIER_CTRL, true));
    assert_int_equal(iso_history_count(history), 1);
    assert_int_equal(s.document.change_count, 1);
    assert_true(iso_session_masked(s.document.session, 0, 0, 0) && s.view.mask_changed && s.view.mask.at);
    assert_true(isosculpt_controller_key(&s.controller, 'm', ISOSCULPT_MODIFIER_ALT, true));
    assert_false(iso_session_has_mask(s.document.session));
    assert_int_equal(iso_session_undo(s.document.session, NULL), ISO_OK);
    assert_true(iso_session_masked(s.document.session, 95, 95, 95));
    isosculpt_controller_move(&s.controller, WIDTH / 2, HEIGHT / 2);
    press(&s.controller);
    isosculpt_controller_change_mask(&s.controller, ISO_TOOL_CLEAR_MASK);
    assert_true(iso_session_has_mask(s.document.session));
    isosculpt_controller_release(&s.controller, ISOSCULPT_BUTTON_LEFT);
    close_scene(&s);
}

/* A look that was written is applied to another session; what a damaged line says is ignored. */
static void looks_are_written_and_applied(void **state) {
    (void)state;
    char text[ISOSCULPT_LOOK], again[ISOSCULPT_LOOK];
    scene s, other;
    open_scene(&s);
    open_scene(&other);
    isosculpt_look_write(&other.controller, again);
    s.view.mode.method = ISO_METHOD_MESH;
    s.view.mode.material.shading = ISOSCULPT_SHADING_METAL;
    s.view.mode.material.color = (iso_rgb){1, 2, 3};
    s.view.mode.material.background = (iso_rgb){255, 254, 0};
    s.controller.brush.tool = ISO_TOOL_PINCH;
    s.controller.brush.radius = 1.0 + 1.0 / 3;
    s.controller.brush.strength = 1.0 / 7;
    s.controller.brush.symmetry = 5;
    s.controller.brush.mirror = iso_vec3_make(-1e9 / 3, 0.1, 1e-9);
    isosculpt_look_write(&s.controller, text);
    static const char *const damaged[] = {
        "",
        ";",
        "=;=;==",
        "method",
        "method=",
        "tool=add2;light=;color=red2;",
        "radius=nan;strength=nan;strength=7;mirror=1,2;mirror=nan,1,2;x=y;"};
    for (size_t i = 0; i < sizeof damaged / sizeof *damaged; i++)
        isosculpt_look_apply(&other.controller, damaged[i]);
    char after[ISOSCULPT_LOOK];
    isosculpt_look_write(&other.controller, after);
    assert_string_equal(after, again);
    isosculpt_look_apply(&other.controller, text);
    isosculpt_look_write(&other.controller, again);
    assert_string_equal(text, again);
    close_scene(&s);
    close_scene(&other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strokes_that_cannot_end_are_taken_back), cmocka_unit_test(strokes_wait_for_a_field),
        cmocka_unit_test(the_mirror_is_in_the_middle), cmocka_unit_test(masks_are_inverted_and_cleared),
        cmocka_unit_test(looks_are_written_and_applied)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
