/* Paint: what tools do to the colours of a field; the same bytes on every machine and for every number of
 * threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/crc32c.h"
#include "session_support.h"

static const iso_rgb BLUE = {20, 60, 220};

static void touch(iso_session *session, iso_tool tool, double radius, iso_vec3 at, const iso_rgb *color) {
    iso_brush brush = {
        .tool = tool, .falloff = ISO_FALLOFF_CONSTANT, .radius = radius, .has_color = color != NULL};
    if (color) brush.color = *color;
    session_stroke(session, &brush, &at, 1);
}

/* The colour at a place in the world. */
static uint32_t color_at(iso_session *session, iso_vec3 at) {
    const iso_hgrid *grid = iso_session_grid(session);
    const iso_affine affine = iso_transform_affine(&grid->transform);
    iso_paint_view view = {.paint = &iso_session_items(session)->of[ISO_ITEM_PAINT]};
    memcpy(view.cells, grid->cells, sizeof view.cells);
    return iso_paint_at(&view, iso_affine_point_to_index(&affine, at));
}

static iso_session *open_painted(void) { /* the ball of radius 10 with a blue spot */
    iso_session *session = session_open(&(iso_session_opts){.checkpoint_strokes = -1});
    touch(session, ISO_TOOL_PAINT, 5, iso_vec3_make(0, 0, 10), &BLUE);
    return session;
}

static void painting_changes_colors_only(void **state) {
    (void)state;
    iso_session *session = session_open(&(iso_session_opts){.checkpoint_strokes = -1});
    session_field before = session_field_of(session);
    const uint64_t edit = iso_change_log_now(iso_session_grid(session)->log);
    touch(session, ISO_TOOL_PAINT, 5, iso_vec3_make(0, 0, 10), &BLUE);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, 10)), 0xffdc3c14);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, 4)), 0); /* deep inside there is none */
    assert_int_equal(color_at(session, iso_vec3_make(10, 0, 0)), 0);
    assert_true(sculpt_same(iso_session_grid(session), before.grid));
    assert_int_equal(iso_change_log_now(iso_session_grid(session)->log), edit);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(session_is(session, &before));
    assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
    touch(session, ISO_TOOL_PAINT, 6, iso_vec3_make(0, 0, 10), NULL); /* takes it away */
    assert_true(session_is(session, &before));
    session_field_free(&before);
    iso_session_destroy(session);
}

/* Thin layers cover in the end, whatever is below. */
static void layers_cover(void **state) {
    (void)state;
    for (uint32_t weight = 200; weight < ISO_PAINT_ONE; weight *= 3)
        for (int base = 0; base < 2; base++) {
            uint32_t color = base ? 0xff00ff80 : 0;
            int layers = 0;
            for (; color != 0xff2040c8 && layers < 5000; layers++)
                color = iso_paint_over(color, 0xff2040c8, (int)weight);
            assert_int_equal(color, 0xff2040c8);
        }
    assert_int_equal(iso_paint_over(0x80112233, 0xff445566, ISO_PAINT_ONE), 0xff445566);
}

static void new_surface_has_the_brush_color(void **state) {
    (void)state;
    const iso_rgb red = {200, 10, 10};
    iso_session *session = open_painted();
    touch(session, ISO_TOOL_ADD, 3, iso_vec3_make(0, 0, 11), &red);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, 14)), 0xff0a0ac8);
    assert_int_equal(color_at(session, iso_vec3_make(0, 4.5, 8.93)), 0xffdc3c14); /* beside it */
    touch(session, ISO_TOOL_ADD, 3, iso_vec3_make(0, 0, 12), NULL);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, 15)), 0);
    touch(session, ISO_TOOL_CARVE, 7, iso_vec3_make(0, 0, 12), &red);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, 5)), 0xff0a0ac8);
    iso_session_destroy(session);
}

static void paint_stays_on_a_surface_that_moves(void **state) {
    (void)state;
    iso_session *session = open_painted();
    for (int i = 0; i < 16; i++) touch(session, ISO_TOOL_INFLATE, 9, iso_vec3_make(0, 0, 10), NULL);
    const iso_hgrid *grid = iso_session_grid(session);
    const iso_affine affine = iso_transform_affine(&grid->transform);
    double height = 10;
    while (true) {
        const iso_vec3 p = iso_affine_point_to_index(&affine, iso_vec3_make(0.25, 0.25, height));
        if (iso_hgrid_at(grid, (int)p.x, (int)p.y, (int)p.z) > 0) break;
        height += 0.1;
    }
    assert_true(height > 13);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, height)), 0xffdc3c14);
    iso_session_destroy(session);
}

/* MOVE along the surface takes the paint along, and back again when the pointer returns. */
static void warps_carry_paint(void **state) {
    (void)state;
    const iso_brush move = {.tool = ISO_TOOL_MOVE, .falloff = ISO_FALLOFF_CONSTANT, .radius = 8};
    const iso_vec3 path[3] = {{0, 0, 10}, {6, 0, 8}, {0, 0, 10}};
    iso_session *session = open_painted();
    session_field before = session_field_of(session);
    assert_int_equal(color_at(session, iso_vec3_make(6.5, 0, 7.6)), 0);
    session_stroke(session, &move, path, 2);
    assert_int_equal(color_at(session, iso_vec3_make(6, 0, 8)) >> 24, 255);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(session_is(session, &before));
    session_stroke(session, &move, path, 3);
    assert_true(session_same_items(iso_session_items(session), &before.items));
    session_field_free(&before);
    iso_session_destroy(session);
}

static void symmetry_mirrors_paint(void **state) {
    (void)state;
    iso_session *session = session_open(&(iso_session_opts){.checkpoint_strokes = -1});
    const iso_vec3 path[3] = {{4, 2, 9}, {6, 1, 8}, {7, -2, 7}};
    const iso_tool tools[] = {ISO_TOOL_PAINT, ISO_TOOL_MOVE, ISO_TOOL_PINCH, ISO_TOOL_INFLATE};
    for (int i = 0; i < 4; i++) {
        const iso_brush brush = {
            .tool = tools[i], .radius = 4, .symmetry = 1, .has_color = i != 3, .color = BLUE};
        session_stroke(session, &brush, path, 3);
    }
    const iso_hgrid *grid = iso_session_grid(session);
    iso_paint_view view = {.paint = &iso_session_items(session)->of[ISO_ITEM_PAINT]};
    memcpy(view.cells, grid->cells, sizeof view.cells);
    int painted = 0;
    for (int i = 0; i < 64 * 64 * 64; i++) {
        const int at[3] = {i % 64, i / 64 % 64, i / 4096}, other[3] = {63 - at[0], at[1], at[2]};
        painted += iso_paint_voxel(&view, at) != 0;
        assert_int_equal(iso_paint_voxel(&view, at), iso_paint_voxel(&view, other));
    }
    assert_true(painted > 500);
    iso_session_destroy(session);
}

static void frozen_voxels_keep_paint(void **state) {
    (void)state;
    const iso_rgb red = {200, 10, 10};
    iso_session *session = open_painted();
    touch(session, ISO_TOOL_MASK, 3, iso_vec3_make(0, 0, 10), NULL);
    touch(session, ISO_TOOL_PAINT, 5, iso_vec3_make(0, 0, 10), &red);
    assert_int_equal(color_at(session, iso_vec3_make(0, 0, 10)), 0xffdc3c14);
    assert_int_equal(color_at(session, iso_vec3_make(0, 4.2, 9.07)), 0xff0a0ac8);
    iso_session_destroy(session);
}

static uint32_t crc_of(iso_session *session) {
    const iso_cell_items *paint = &iso_session_items(session)->of[ISO_ITEM_PAINT];
    uint32_t crc = 0;
    for (size_t i = 0; i < paint->cells; i++)
        if (paint->cell[i]) crc = iso_crc32c(crc ^ (uint32_t)i, paint->cell[i], paint->bytes);
    return crc;
}

/* Random strokes with all tools: the colours are pinned, whatever the threads and the instruction set. */
static void colors_are_the_same_everywhere(void **state) {
    (void)state;
    for (int threads = 1; threads <= 4; threads += 3) {
        iso_pool *pool;
        assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
        iso_session *session = session_open(&(iso_session_opts){.pool = pool, .checkpoint_strokes = -1});
        uint32_t seed = 77;
        size_t most = 0;
        for (int i = 0; i < 60; i++) {
            iso_brush brush = session_random_brush(&seed, ISO_TOOL_TRIM_PLANE);
            iso_vec3 path[3];
            if (brush.tool == ISO_TOOL_INVERT_MASK || brush.tool == ISO_TOOL_BLUR_MASK ||
                brush.tool == ISO_TOOL_MASK)
                brush.tool = ISO_TOOL_PAINT;
            for (int k = 0; k < 3; k++) {
                const iso_sample sample = session_random_sample(&seed);
                path[k] = iso_vec3_scale(sample.normal, 10);
                if (k) path[k] = iso_vec3_add(path[k - 1], iso_vec3_scale(path[k], 0.2));
            }
            session_stroke(session, &brush, path, 3);
            const size_t used = iso_session_items(session)->of[ISO_ITEM_PAINT].used;
            most = used > most ? used : most;
        }
        assert_true(most > 20);
        assert_int_equal(crc_of(session), 0xe8e5d6b3);
        iso_session_destroy(session);
        iso_pool_destroy(pool);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(painting_changes_colors_only),
                                       cmocka_unit_test(layers_cover),
                                       cmocka_unit_test(new_surface_has_the_brush_color),
                                       cmocka_unit_test(paint_stays_on_a_surface_that_moves),
                                       cmocka_unit_test(warps_carry_paint),
                                       cmocka_unit_test(symmetry_mirrors_paint),
                                       cmocka_unit_test(frozen_voxels_keep_paint),
                                       cmocka_unit_test(colors_are_the_same_everywhere)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
