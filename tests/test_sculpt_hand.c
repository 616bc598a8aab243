/* isosculpt's hand: what becomes of a stroke that runs out of memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "apps/isosculpt_hand.h"
#include "refused_memory.h"
#include "sculpt_support.h"

enum { WIDTH = 160, HEIGHT = 100 };

static const iso_journal_start START = {.source = "ball",
                                        .voxel_size = 0.5,
                                        .dims = {96, 96, 96},
                                        .origin = {-23.75, -23.75, -23.75},
                                        .radius = 15};

static void press(isosculpt_hand *hand) {
    isosculpt_hand_press(hand, ISOSCULPT_LEFT, 0, WIDTH / 2, HEIGHT / 2);
    assert_int_equal(hand->drag, ISOSCULPT_DRAG_BRUSH);
}

/* A stroke whose end is refused memory is taken back, and the next one can be drawn. */
static void strokes_that_cannot_end_are_taken_back(void **state) {
    (void)state;
    isosculpt_desk desk = {.start = START};
    isosculpt_view view;
    isosculpt_hand hand;
    iso_hgrid *grid;
    const iso_session_opts opts = {0};
    assert_int_equal(iso_session_ball(&START, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, &START, &opts, &desk.session, NULL), ISO_OK);
    assert_int_equal(isosculpt_view_init(&view, grid, NULL, NULL), ISO_OK);
    assert_int_equal(isosculpt_view_draw(&view, WIDTH, HEIGHT, false, NULL), ISO_OK);
    isosculpt_hand_init(&hand, &desk, &view);
    iso_hgrid *before = sculpt_copy(grid);
    const iso_history *history = iso_session_history(desk.session);
    int refused = 0;
    for (long calls = 0; iso_history_count(history) == 0; calls++) {
        press(&hand);
        assert_false(sculpt_same(grid, before));
        test_refuse_memory_after(calls);
        isosculpt_hand_release(&hand, ISOSCULPT_LEFT);
        test_grant_memory();
        if (iso_history_count(history)) break;
        assert_int_equal(hand.error.status, ISO_ERR_NOMEM);
        refused++;
    }
    assert_true(refused > 2);
    assert_false(sculpt_same(grid, before));
    assert_int_equal(iso_session_undo(desk.session, NULL), ISO_OK);
    assert_true(sculpt_same(grid, before));
    iso_hgrid_destroy(before);
    isosculpt_view_free(&view);
    iso_session_destroy(desk.session);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(strokes_that_cannot_end_are_taken_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
