/* Past strokes in isosculpt: edits are drawn by a thread, and give what the same edits give without one,
 * whatever the user does meanwhile; a click with Alt selects the stroke that made the surface. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

#include <cmocka.h>

#include "apps/isosculpt/input_controller.h"
#include "sculpt_support.h"

enum { WIDTH = 160, HEIGHT = 100, STROKES = 3 };

static const iso_journal_start START = {.source = "ball",
                                        .voxel_size = 0.5,
                                        .dims = {96, 96, 96},
                                        .origin = {-23.75, -23.75, -23.75},
                                        .radius = 15};

typedef struct scene {
    isosculpt_document document;
    isosculpt_viewport view;
    isosculpt_controller controller;
} scene;

static void stroke_from(isosculpt_controller *controller, unsigned modifiers, int x, int dx) {
    isosculpt_controller_move(controller, x, HEIGHT / 2);
    isosculpt_controller_press(controller, ISOSCULPT_BUTTON_LEFT, modifiers, x, HEIGHT / 2);
    for (int i = 1; i <= 4; i++) isosculpt_controller_move(controller, x + i * dx / 4, HEIGHT / 2);
    isosculpt_controller_release(controller, ISOSCULPT_BUTTON_LEFT);
}

/* A ball with three strokes, of which the second meets the first. */
static void open_scene(scene *s) {
    const iso_session_opts opts = {.edits_aside = true};
    iso_hgrid *grid;
    *s = (scene){.document = {.start = START}};
    assert_int_equal(iso_session_solid(&START, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, &START, &opts, &s->document.session, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_init(&s->view, grid, NULL, NULL), ISO_OK);
    assert_int_equal(isosculpt_viewport_draw(&s->view, WIDTH, HEIGHT, false, NULL), ISO_OK);
    isosculpt_controller_init(&s->controller, &s->document, &s->view);
    s->controller.brush.radius = 2;
    stroke_from(&s->controller, 0, WIDTH / 2 - 16, 6);
    stroke_from(&s->controller, 0, WIDTH / 2 - 8, 4);
    stroke_from(&s->controller, 0, WIDTH / 2 + 14, 4);
    assert_int_equal(iso_history_count(iso_session_history(s->document.session)), STROKES);
}

static void close_scene(scene *s) {
    isosculpt_stroke_editor_free(&s->document.strokes, s->document.session);
    isosculpt_controller_free(&s->controller);
    isosculpt_viewport_free(&s->view);
    iso_session_destroy(s->document.session);
}

/* Waits until all edits are made. */
static void settle(scene *s) {
    const isosculpt_stroke_editor *editor = &s->document.strokes;
    isosculpt_controller_update_strokes(&s->controller, NULL);
    while (isosculpt_stroke_editor_is_busy(editor) || editor->seeking) {
        usleep(500);
        isosculpt_controller_update_strokes(&s->controller, NULL);
    }
    isosculpt_controller_update_strokes(&s->controller, NULL); /* strokes that waited */
    assert_string_equal(s->controller.error.text, "");
}

static void assert_same(scene *s, scene *other) {
    assert_true(
        sculpt_same(iso_session_grid(s->document.session), iso_session_grid(other->document.session)));
}

static void edit_now(scene *s, const iso_event *event) {
    assert_int_equal(iso_session_edit(s->document.session, event, NULL), ISO_OK);
}

static void request(scene *s, iso_event_kind kind, unsigned number) {
    const iso_event event = {.kind = kind, .first = number, .last = number};
    assert_int_equal(isosculpt_stroke_editor_request(&s->document.strokes, &event, NULL), ISO_OK);
}

/* A slider that is dragged is one step, with its last value; not before it is released. */
static void the_last_radius_counts(void **state) {
    (void)state;
    scene s, other;
    open_scene(&s);
    open_scene(&other);
    isosculpt_stroke_editor *editor = &s.document.strokes;
    const iso_history *history = iso_session_history(s.document.session);
    isosculpt_stroke_editor_select(editor, 2, 2);
    iso_brush *brush = isosculpt_controller_brush(&s.controller);
    assert_ptr_equal(brush, &editor->brush);
    assert_int_equal(brush->shape, ISO_SOLID_SPHERE); /* of a tube */
    s.controller.brush_held = true;
    brush->radius = 9;
    isosculpt_controller_update_strokes(&s.controller, NULL);
    assert_false(isosculpt_stroke_editor_is_busy(editor));
    s.controller.brush_held = false;
    for (int i = 0; i < 40; i++) {
        brush->radius = 2.5 + 0.02 * i;
        isosculpt_controller_update_strokes(&s.controller, NULL);
        if (i % 8 == 0) usleep(3000);
    }
    const iso_brush wanted = isosculpt_brush_drawn(brush);
    settle(&s);
    const iso_stroke *stroke = isosculpt_stroke_editor_stroke(editor, s.document.session);
    assert_true(stroke && stroke->number == 2 && iso_brush_is_same(&stroke->brush, &wanted));
    assert_true(iso_history_count(history) <= STROKES + 2); /* (the first may have been made in between) */
    assert_int_equal(stroke->brush.shape, ISO_SOLID_CAPSULE);
    edit_now(&other, &(iso_event){.kind = ISO_EVENT_EDIT, .first = 2, .last = 2, .brush = wanted});
    assert_same(&s, &other);
    close_scene(&s);
    close_scene(&other);
}

/* Strokes that are drawn while past ones are edited follow the edit; undo takes the last one back. */
static void strokes_wait_for_an_edit(void **state) {
    (void)state;
    scene s, other;
    open_scene(&s);
    open_scene(&other);
    request(&s, ISO_EVENT_MUTE, 1);
    isosculpt_controller_update_strokes(&s.controller, NULL);
    assert_true(isosculpt_stroke_editor_is_busy(&s.document.strokes));
    stroke_from(&s.controller, 0, WIDTH / 2 - 4, 12);
    stroke_from(&s.controller, 0, WIDTH / 2, 12);
    assert_int_equal(s.controller.queued_strokes.count, 2);
    assert_int_equal(iso_history_count(iso_session_history(s.document.session)), STROKES);
    isosculpt_controller_key(&s.controller, 'z', ISOSCULPT_MODIFIER_CTRL, true);
    assert_int_equal(s.controller.queued_strokes.count, 1);
    settle(&s);
    assert_int_equal(s.document.change_count, STROKES + 2);
    edit_now(&other, &(iso_event){.kind = ISO_EVENT_MUTE, .first = 1, .last = 1});
    stroke_from(&other.controller, 0, WIDTH / 2 - 4, 12);
    assert_same(&s, &other);
    close_scene(&s);
    close_scene(&other);
}

/* Undo withdraws an edit that is still to be made; redo, and closing, do not wait for it. */
static void edits_are_withdrawn(void **state) {
    (void)state;
    scene s, other;
    open_scene(&s);
    open_scene(&other);
    const iso_history *history = iso_session_history(s.document.session);
    request(&s, ISO_EVENT_MUTE, 1);
    request(&s, ISO_EVENT_DELETE, 3);
    isosculpt_controller_update_strokes(&s.controller, NULL);
    isosculpt_controller_key(&s.controller, 'z', ISOSCULPT_MODIFIER_CTRL, true);
    isosculpt_controller_key(&s.controller, 'z', ISOSCULPT_MODIFIER_CTRL, true);
    settle(&s);
    assert_int_equal(iso_history_position(history), STROKES);
    assert_same(&s, &other);
    request(&s, ISO_EVENT_MUTE, 1);
    settle(&s);
    assert_int_equal(iso_history_position(history), STROKES + 1);
    isosculpt_controller_key(&s.controller, 'z', ISOSCULPT_MODIFIER_CTRL, true);
    assert_same(&s, &other);
    request(&s, ISO_EVENT_UNMUTE, 9); /* there is none: said, and nothing else is lost */
    request(&s, ISO_EVENT_MUTE, 2);
    char said[sizeof s.controller.error.text] = "";
    while (isosculpt_stroke_editor_is_busy(&s.document.strokes)) {
        isosculpt_controller_update_strokes(&s.controller, NULL);
        if (s.controller.error.text[0]) snprintf(said, sizeof said, "%s", s.controller.error.text);
        s.controller.error.text[0] = 0; /* as the window does */
    }
    assert_string_equal(said, "there is no stroke 9");
    edit_now(&other, &(iso_event){.kind = ISO_EVENT_MUTE, .first = 2, .last = 2});
    assert_same(&s, &other);
    request(&s, ISO_EVENT_DELETE, 1);
    isosculpt_controller_update_strokes(&s.controller, NULL);
    close_scene(&s);
    close_scene(&other);
}

static void click(scene *s, int x) {
    assert_int_equal(isosculpt_viewport_draw(&s->view, WIDTH, HEIGHT, false, NULL), ISO_OK);
    stroke_from(&s->controller, ISOSCULPT_MODIFIER_ALT, x, 0);
    settle(s);
}

/* Alt and a click select; Alt and a drag draw, inverted, from where the button was pressed. */
static void alt_selects(void **state) {
    (void)state;
    scene s;
    open_scene(&s);
    const isosculpt_stroke_editor *editor = &s.document.strokes;
    const int at[STROKES] = {WIDTH / 2 - 16, WIDTH / 2 - 6, WIDTH / 2 + 16};
    for (unsigned i = 0; i < STROKES; i++) {
        click(&s, at[i]);
        assert_int_equal(editor->first, i + 1);
        assert_int_equal(editor->last, i + 1);
    }
    click(&s, WIDTH / 2 + 6); /* the ball */
    request(&s, ISO_EVENT_MUTE, 2);
    settle(&s);
    click(&s, at[1]);
    assert_int_not_equal(editor->first, 2);
    assert_int_equal(iso_history_count(iso_session_history(s.document.session)), STROKES + 1);
    click(&s, at[2]);
    assert_int_equal(editor->first, 3);
    assert_true(isosculpt_controller_key(&s.controller, ISOSCULPT_KEY_DELETE, 0, true));
    settle(&s);
    assert_null(isosculpt_stroke_editor_stroke(&s.document.strokes, s.document.session));
    stroke_from(&s.controller, ISOSCULPT_MODIFIER_ALT, WIDTH / 2, 10);
    const iso_stroke_list *list = isosculpt_stroke_editor_list(&s.document.strokes, s.document.session);
    assert_true(list && list->count == STROKES);
    assert_int_equal(iso_stroke_at(list, STROKES - 1)->brush.tool, ISO_TOOL_CARVE);
    close_scene(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_radius_counts),
        cmocka_unit_test(strokes_wait_for_an_edit),
        cmocka_unit_test(edits_are_withdrawn),
        cmocka_unit_test(alt_selects),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
