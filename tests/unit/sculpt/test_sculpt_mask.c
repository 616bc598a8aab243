/* The mask: frozen voxels keep their values, and the field beside them remains a distance field. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "sculpt_support.h"

static double random_between(uint32_t *seed, double low, double high) {
    return low + (high - low) * uniform(seed);
}

enum { SIDE = 64, VOXELS = SIDE * SIDE * SIDE };
/* The ball, and a mask on its surface. */
static const iso_vec3 CENTRE = {31.3, 30.6, 31.8}, FROZEN = {51.2, 31.4, 30.9}, UP = {1, 0, 0};
static const double RADIUS = 20, MASK_RADIUS = 14;

static iso_editor *make_editor(iso_hgrid *grid, iso_pool *pool) {
    iso_editor *editor;
    const iso_editor_opts opts = {.pool = pool};
    iso_error error = {0};
    if (iso_editor_create(grid, &opts, &editor, &error) != ISO_OK) fail_msg("%s", error.text);
    iso_editor_begin_step(editor, &(iso_step_opts){0});
    return editor;
}

static float value_at(const iso_hgrid *grid, int i) {
    return iso_hgrid_at(grid, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
}

static bool is_frozen(const iso_editor *editor, int i) {
    return iso_editor_masked(editor, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
}

/* Whether the surface passes between the voxel and a frozen one beside it. */
static bool holds_surface(const iso_editor *editor, const iso_hgrid *grid, int i) {
    static const int step[3] = {1, SIDE, SIDE * SIDE};
    for (int face = 0; face < 6; face++) {
        const int other = i + (face % 2 ? step[face / 2] : -step[face / 2]);
        if (other < 0 || other >= VOXELS || !is_frozen(editor, other)) continue;
        if ((value_at(grid, i) < 0) != (value_at(grid, other) < 0)) return true;
    }
    return false;
}

/* Whether all within 4 voxels, along the axes together, is frozen. */
static bool is_deep(int i) {
    const iso_vec3 p = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
    return iso_vec3_length(iso_vec3_sub(p, FROZEN)) < MASK_RADIUS - sqrt(48);
}

static void check_frozen(const iso_editor *editor, const iso_hgrid *grid, const iso_hgrid *before) {
    size_t held = 0, deep = 0, moved = 0;
    for (int i = 0; i < VOXELS; i++) {
        const float was = value_at(before, i), is = value_at(grid, i);
        const bool frozen = is_frozen(editor, i);
        moved += !frozen && was != is;
        if (!frozen) continue;
        const bool snapshots = holds_surface(editor, before, i), far = is_deep(i);
        held += snapshots;
        deep += far;
        if (snapshots || far ? was != is : (was < 0) != (is < 0))
            fail_msg("frozen voxel (%d, %d, %d) was %g and is %g", i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE,
                     (double)was, (double)is);
    }
    assert_true(held > 500 && deep > 1000 && moved > 200);
}

/* One tool: how large it is, where it begins, how often it touches, and how far off foot points
 * may be then. */
typedef struct stroke {
    iso_brush brush;
    iso_vec3 at;
    int touches;
    double foot_p99;
} stroke;

static const stroke STROKES[] = {
    {{.tool = ISO_TOOL_ADD, .radius = 9}, {46, 46, 31}, 8, 0.25},
    {{.tool = ISO_TOOL_ADD, .radius = 4.5}, {57, 44, 31}, 1, 0.18}, /* where there was no surface */
    {{.tool = ISO_TOOL_ADD, .radius = 12, .shape = ISO_SOLID_BOX}, {50, 31, 31}, 8, 0.05},
    {{.tool = ISO_TOOL_CARVE, .radius = 9}, {46, 46, 31}, 8, 0.25},
    {{.tool = ISO_TOOL_CARVE, .radius = 16}, {45, 31, 31}, 8, 0.35},
    {{.tool = ISO_TOOL_BLEND_ADD, .radius = 10}, {46, 48, 31}, 8, 0.2},
    {{.tool = ISO_TOOL_BLEND_CARVE, .radius = 10}, {46, 46, 31}, 8, 0.22},
    {{.tool = ISO_TOOL_SMOOTH, .radius = 20}, {46, 46, 31}, 8, 0.03},
    {{.tool = ISO_TOOL_INFLATE, .radius = 25, .symmetry = 2, .mirror = {31, 31, 31}}, {46, 44, 31}, 8, 0.25},
    {{.tool = ISO_TOOL_DEFLATE, .radius = 25}, {51, 31, 31}, 8, 0.15},
    {{.tool = ISO_TOOL_FLATTEN, .radius = 20}, {46, 44, 31}, 8, 0.1},
    {{.tool = ISO_TOOL_PINCH, .radius = 20}, {46, 44, 31}, 8, 0.1},
    {{.tool = ISO_TOOL_SCRAPE, .radius = 20}, {46, 44, 31}, 8, 0.1},
    {{.tool = ISO_TOOL_FILL, .radius = 20}, {46, 44, 31}, 8, 0.1},
    {{.tool = ISO_TOOL_CLAY, .radius = 20}, {46, 44, 31}, 8, 0.1},
    {{.tool = ISO_TOOL_CREASE, .radius = 20}, {46, 44, 31}, 8, 0.1},
};
enum { STROKE_COUNT = sizeof STROKES / sizeof *STROKES };

static void freeze(iso_editor *editor) {
    const iso_brush mask = {.tool = ISO_TOOL_MASK, .radius = MASK_RADIUS};
    sculpt_touch(editor, &mask, FROZEN, UP);
}

static void draw(iso_editor *editor, const stroke *drawn) {
    for (int i = 0; i < drawn->touches; i++)
        sculpt_touch(editor, &drawn->brush, iso_vec3_add(drawn->at, iso_vec3_scale(UP, 0.3 * i)), UP);
}

/* Each tool at the mask's border, over it and from inside: the surface in it moves by no bit, and no
 * foot point sees a value at the band's end. */
static void frozen_surfaces_stay(void **state) {
    (void)state;
    for (int i = 0; i < STROKE_COUNT; i++) {
        iso_hgrid *grid = sculpt_ball(SIDE, CENTRE, RADIUS), *before = sculpt_copy(grid);
        iso_editor *editor = make_editor(grid, NULL);
        freeze(editor);
        draw(editor, &STROKES[i]);
        check_frozen(editor, grid, before);
        const sculpt_quality q = sculpt_measure(grid, 0);
        print_message("%s: foot points' error p99 %.3f, most %.3f\n", iso_tool_name(STROKES[i].brush.tool),
                      q.foot_p99, q.foot_max);
        assert_true(q.clamped == 0 && q.foot_p99 < STROKES[i].foot_p99 && q.foot_max < 1);
        iso_editor_destroy(editor);
        iso_hgrid_destroy(grid);
        iso_hgrid_destroy(before);
    }
}

static iso_hgrid *drawn_by(iso_cpu_level level, iso_pool *pool) {
    iso_hgrid *grid = sculpt_ball(SIDE, CENTRE, RADIUS);
    iso_editor *editor = make_editor(grid, pool);
    iso_cpu_limit(level);
    freeze(editor);
    for (int i = 0; i < STROKE_COUNT; i++) draw(editor, &STROKES[i]);
    iso_editor_destroy(editor);
    iso_cpu_limit(ISO_CPU_AVX512);
    return grid;
}

static void same_bytes_for_threads_and_levels(void **state) {
    (void)state;
    iso_hgrid *wanted = drawn_by(ISO_CPU_GENERIC, NULL);
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int level = ISO_CPU_GENERIC; level < ISO_CPU_LEVELS; level++) {
        iso_hgrid *got = drawn_by((iso_cpu_level)level, pool);
        assert_true(sculpt_same(got, wanted));
        iso_hgrid_destroy(got);
    }
    iso_pool_destroy(pool);
    iso_hgrid_destroy(wanted);
}

/* What is no longer frozen can be sculpted. */
static void masks_go(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(SIDE, CENTRE, RADIUS);
    iso_editor *editor = make_editor(grid, NULL);
    const iso_brush inflate = {.tool = ISO_TOOL_INFLATE, .radius = 25};
    freeze(editor);
    const float was = iso_hgrid_at(grid, 51, 31, 31);
    sculpt_touch(editor, &inflate, FROZEN, UP);
    assert_true(iso_editor_masked(editor, 51, 31, 31) && iso_hgrid_at(grid, 51, 31, 31) == was);
    iso_field_items_clear(iso_editor_items(editor));
    assert_false(iso_editor_masked(editor, 51, 31, 31));
    sculpt_touch(editor, &inflate, FROZEN, UP);
    assert_true(iso_hgrid_at(grid, 51, 31, 31) != was);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* Inverted, a mask freezes every voxel of the grid that was not frozen; cleared, none is. */
static void whole_masks_change(void **state) {
    (void)state;
    static bool before[VOXELS];
    iso_hgrid *grid = sculpt_ball(SIDE, CENTRE, RADIUS), *field = sculpt_copy(grid);
    iso_editor *editor = make_editor(grid, NULL);
    const iso_brush invert = {.tool = ISO_TOOL_INVERT_MASK, .radius = 1},
                    clear = {.tool = ISO_TOOL_CLEAR_MASK, .radius = 1},
                    inflate = {.tool = ISO_TOOL_INFLATE, .radius = 25};
    int frozen = 0;
    freeze(editor);
    for (int i = 0; i < VOXELS; i++) {
        before[i] = iso_editor_masked(editor, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
        frozen += before[i];
    }
    assert_in_range(frozen, 100, VOXELS / 2);
    sculpt_touch(editor, &invert, FROZEN, UP);
    for (int i = 0; i < VOXELS; i++)
        assert_true(iso_editor_masked(editor, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE) != before[i]);
    sculpt_touch(editor, &invert, FROZEN, UP);
    for (int i = 0; i < VOXELS; i++)
        assert_true(iso_editor_masked(editor, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE) == before[i]);
    sculpt_touch(editor, &clear, FROZEN, UP);
    assert_false(iso_editor_has_mask(editor));
    sculpt_touch(editor, &invert, FROZEN, UP);
    sculpt_touch(editor, &inflate, FROZEN, UP);
    assert_true(sculpt_same(grid, field)); /* everything is frozen */
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
    iso_hgrid_destroy(field);
}

/* What blurring leaves of a voxel, by the sum over all voxels around it. */
static bool blurred(const bool *frozen, int reach, const int at[3]) {
    long sum = 0, all = 0;
    for (int z = -reach; z <= reach; z++)
        for (int y = -reach; y <= reach; y++)
            for (int x = -reach; x <= reach; x++) {
                const int d[3] = {x, y, z};
                long weight = 1, index = 0;
                for (int axis = 2; axis >= 0; axis--) {
                    const int place = at[axis] + d[axis];
                    weight *= reach + 1 - abs(d[axis]);
                    index = index * SIDE + (place < 0 ? 0 : place >= SIDE ? SIDE - 1 : place);
                }
                all += weight;
                sum += frozen[index] ? weight : 0;
            }
    return 2 * sum > all;
}

static void read_mask(const iso_editor *editor, bool *frozen) {
    for (int i = 0; i < VOXELS; i++)
        frozen[i] = iso_editor_masked(editor, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
}

/* Blurring equals the sums over all voxels, also at the border of the grid; it moves the border of a ball
 * less than it smooths it, and what is nowhere frozen, or everywhere, stays so. */
static void masks_blur(void **state) {
    (void)state;
    static bool before[VOXELS], after[VOXELS];
    iso_hgrid *grid = sculpt_ball(SIDE, CENTRE, RADIUS);
    iso_editor *editor = make_editor(grid, NULL);
    iso_brush blur = {.tool = ISO_TOOL_BLUR_MASK, .radius = 3}, mask = {.tool = ISO_TOOL_MASK, .radius = 6};
    const iso_brush invert = {.tool = ISO_TOOL_INVERT_MASK, .radius = 1};
    uint32_t seed = 3;
    sculpt_touch(editor, &blur, FROZEN, UP);
    assert_false(iso_editor_has_mask(editor));
    for (int i = 0; i < 60; i++) {
        mask.tool = i % 4 == 3 ? ISO_TOOL_UNMASK : ISO_TOOL_MASK;
        mask.radius = random_between(&seed, 1, 9);
        const iso_vec3 at = {random_between(&seed, 0, SIDE), random_between(&seed, 0, SIDE),
                             random_between(&seed, 0, SIDE)};
        sculpt_touch(editor, &mask, at, UP);
    }
    for (int round = 0; round < 2; round++) {
        int changed = 0;
        blur.radius = round ? 30 : 3; /* as 16 */
        read_mask(editor, before);
        sculpt_touch(editor, &blur, FROZEN, UP);
        read_mask(editor, after);
        for (int i = 0; i < VOXELS; i += round ? 997 : 1) {
            const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            if (after[i] != blurred(before, round ? 16 : 3, at)) fail_msg("%d %d %d", at[0], at[1], at[2]);
        }
        for (int i = 0; i < VOXELS; i++) changed += after[i] != before[i];
        assert_in_range(changed, 500, VOXELS / 2);
    }
    iso_field_items_clear(iso_editor_items(editor));
    sculpt_touch(editor, &invert, FROZEN, UP);
    sculpt_touch(editor, &blur, FROZEN, UP);
    read_mask(editor, after);
    for (int i = 0; i < VOXELS; i++) assert_true(after[i]);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(masks_blur), cmocka_unit_test(frozen_surfaces_stay),
                                       cmocka_unit_test(same_bytes_for_threads_and_levels),
                                       cmocka_unit_test(masks_go), cmocka_unit_test(whole_masks_change)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
