/* MASK and UNMASK without enough memory: the mask stays as it was. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "refused_memory.h"
#include "sculpt_support.h"

enum { SIDE = 64 };

/* iso_write_observer.item_before of a step that takes memory for each cell, as the undo history does. */
static iso_status keep(void *context, iso_item_kind kind, uint32_t cell, void *item, iso_error *error) {
    void *copy = iso_alloc(sizeof(iso_voxel_bits));
    (void)context;
    (void)kind;
    (void)item;
    (void)cell;
    if (!copy) return iso_fail(error, ISO_ERR_NOMEM, "refused");
    iso_free(copy);
    return ISO_OK;
}

/* Where the voxels are frozen; returns how many cells have bits. */
static size_t read_mask(iso_editor *editor, unsigned char frozen[SIDE * SIDE * SIDE]) {
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        frozen[i] = iso_editor_masked(editor, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
    return iso_editor_items(editor)->of[ISO_ITEM_MASK].used;
}

/* Touches with less memory than it takes until it is enough; returns how often it was not. */
static int touch_with_less_memory(iso_editor *editor, iso_tool tool) {
    static unsigned char before[SIDE * SIDE * SIDE], after[SIDE * SIDE * SIDE];
    const iso_brush brush = {
        .tool = tool, .radius = 14, .strength = 1, .symmetry = 1, .mirror = {31.5, 31.5, 31.5}};
    const iso_sample sample = {.position = {44, 31, 31}, .normal = {1, 0, 0}, .pressure = 1};
    const iso_touch touch = {.sample = sample, .previous = sample, .first = sample};
    const size_t cells = read_mask(editor, before);
    iso_status status = ISO_ERR_NOMEM;
    int refused = 0;
    for (long calls = 0; status != ISO_OK; calls++) {
        iso_editor_begin_step(editor, &(iso_step_opts){.observer = {.item_before = keep}});
        test_refuse_memory_after(calls);
        status = iso_editor_touch(editor, &brush, &touch, NULL, NULL);
        test_grant_memory();
        const size_t cells_now = read_mask(editor, after);
        if (status == ISO_OK) break;
        assert_int_equal(status, ISO_ERR_NOMEM);
        assert_int_equal(cells_now, cells);
        assert_memory_equal(before, after, sizeof before);
        refused++;
    }
    assert_memory_not_equal(before, after, sizeof before);
    return refused;
}

static void masks_are_changed_wholly_or_not(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(SIDE, iso_vec3_make(31.5, 31.5, 31.5), 20);
    iso_editor *editor;
    assert_int_equal(iso_editor_create(grid, &(iso_editor_opts){0}, &editor, NULL), ISO_OK);
    assert_true(touch_with_less_memory(editor, ISO_TOOL_MASK) > 20);
    assert_true(iso_editor_has_mask(editor));
    assert_true(touch_with_less_memory(editor, ISO_TOOL_BLUR_MASK) > 10);
    assert_true(touch_with_less_memory(editor, ISO_TOOL_UNMASK) > 10);
    assert_true(touch_with_less_memory(editor, ISO_TOOL_INVERT_MASK) > 20);
    assert_true(touch_with_less_memory(editor, ISO_TOOL_CLEAR_MASK) > 20);
    assert_false(iso_editor_has_mask(editor));
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(masks_are_changed_wholly_or_not)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
