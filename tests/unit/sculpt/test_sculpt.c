/* Brushes: after each touch the field is a distance field with the right signs, only affected cells changed,
 * and the bits are the same on every machine. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "base/crc32c.h"
#include "sculpt/field/crease.h"
#include "sculpt_support.h"

static const iso_vec3 CENTRE = {63.3, 64.6, 62.8};

static iso_status ignore(void *context, uint32_t cell, int32_t state, const float *brick, iso_error *error) {
    (void)context, (void)cell, (void)state, (void)brick, (void)error;
    return ISO_OK;
}

static iso_editor *make_editor(iso_hgrid *grid, iso_pool *pool) {
    iso_editor *editor;
    iso_editor_opts opts = {.pool = pool};
    iso_error error = {0};
    if (iso_editor_create(grid, &opts, &editor, &error) != ISO_OK) fail_msg("%s", error.text);
    iso_step_opts nobody = {.observer = {.before = ignore}};
    iso_editor_begin_step(editor, &nobody);
    return editor;
}

static void settle(iso_editor *editor) {
    iso_error error = {0};
    if (iso_editor_finalize(editor, &error) != ISO_OK) fail_msg("%s", error.text);
}

/* Step s of a stroke that winds around the ball. */
static iso_vec3 stroke_direction(int s) {
    double turn = s * 0.05 + 0.3, rise = 0.4 * sin(s * 0.021);
    return iso_vec3_make(cos(turn) * cos(rise), sin(turn) * cos(rise), sin(rise));
}

/* While the stroke is drawn, or after its end. */
static sculpt_quality after_stroke(const iso_brush *brush, int steps, bool on_ball, bool settled) {
    iso_hgrid *grid = sculpt_ball(128, CENTRE, 40);
    iso_editor *editor = make_editor(grid, NULL);
    for (int s = 0; s < steps; s++) {
        iso_vec3 direction = stroke_direction(s);
        iso_vec3 at = on_ball ? iso_vec3_add(CENTRE, iso_vec3_scale(direction, 40))
                              : sculpt_pick(grid, CENTRE, direction);
        sculpt_touch(editor, brush, at, direction);
    }
    if (settled) settle(editor);
    sculpt_quality quality = sculpt_measure(grid, 0);
    assert_int_equal(quality.clamped, 0);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
    return quality;
}

/* The bounds that SCULPTING's measures set for 200 deforming steps. */
static void deforming_strokes_keep_a_distance_field(void **state) {
    (void)state;
    static const iso_tool tools[] = {ISO_TOOL_SMOOTH,  ISO_TOOL_INFLATE, ISO_TOOL_DEFLATE,
                                     ISO_TOOL_FLATTEN, ISO_TOOL_SCRAPE,  ISO_TOOL_FILL,
                                     ISO_TOOL_CLAY,    ISO_TOOL_PINCH,   ISO_TOOL_CREASE};
    for (size_t i = 0; i < 2 * sizeof tools / sizeof *tools; i++) {
        iso_brush brush = {.tool = tools[i / 2], .radius = 14};
        sculpt_quality q = after_stroke(&brush, 200, false, i % 2);
        print_message("%s: | |g| - 1 | mean %.5f p99 %.4f, foot p99 %.4f max %.4f\n",
                      iso_tool_name(brush.tool), q.gradient_mean, q.gradient_p99, q.foot_p99, q.foot_max);
        assert_true(q.gradient_mean <= 0.002 && q.gradient_p99 <= 0.02);
        assert_true(q.foot_p99 <= 0.03 && q.foot_max <= 0.12);
    }
}

static void set_operations_keep_a_distance_field(void **state) {
    (void)state;
    static const struct {
        iso_tool tool;
        double foot_max;
    } asked[] = {{ISO_TOOL_ADD, 1.0}, {ISO_TOOL_CARVE, 0.5}};
    for (int i = 0; i < 4; i++) {
        iso_brush brush = {.tool = asked[i / 2].tool, .radius = 10};
        sculpt_quality q = after_stroke(&brush, 200, true, i % 2);
        print_message("%s%s: | |g| - 1 | mean %.5f, foot p99 %.4f max %.4f\n", iso_tool_name(brush.tool),
                      i % 2 ? ", at its end" : "", q.gradient_mean, q.foot_p99, q.foot_max);
        assert_true(q.foot_p99 <= 0.2 && q.foot_max <= asked[i / 2].foot_max);
    }
}

/* Touches the pole of a ball that has a bump there, or a dent if `bump` is below 0, with a brush of
 * radius 12. The sample's normal is tilted by `tilt`. Returns by how many voxels the volume changes. */
static double change_at_pole(iso_tool tool, double bump, double tilt) {
    iso_hgrid *grid = sculpt_ball(128, CENTRE, 40);
    iso_editor *editor = make_editor(grid, NULL);
    const iso_vec3 up = {0, 0, 1}, pole = iso_vec3_add(CENTRE, iso_vec3_make(0, 0, 40));
    const iso_brush bumps = {.tool = bump > 0 ? ISO_TOOL_INFLATE : ISO_TOOL_DEFLATE, .radius = 7},
                    brush = {.tool = tool, .radius = 12};
    for (double height = 0; height < fabs(bump); height += 0.35) sculpt_touch(editor, &bumps, pole, up);
    const double before = sculpt_volume(grid);
    sculpt_touch(editor, &brush, sculpt_pick(grid, CENTRE, up), iso_vec3_make(sin(tilt), 0, cos(tilt)));
    const double change = sculpt_volume(grid) - before;
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
    return change;
}

/* Scraping takes off bumps, filling fills dents, clay adds more than filling, a crease digs; and a normal
 * that is wrong by 11 degrees, as one voxel's is on a scan, does not tilt the planes of the first three. */
static void brushes_act_on_their_side(void **state) {
    (void)state;
    static const struct {
        iso_tool tool;
        double bump, least, most; /* of the change */
    } asked[] = {{ISO_TOOL_SCRAPE, 2, -30, -16}, {ISO_TOOL_SCRAPE, -2, -10, -1}, {ISO_TOOL_FILL, -2, 6, 14},
                 {ISO_TOOL_FILL, 2, 10, 20},     {ISO_TOOL_CLAY, -2, 45, 62},    {ISO_TOOL_CLAY, 2, 45, 62},
                 {ISO_TOOL_CREASE, 2, -70, -40}};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        const double straight = change_at_pole(asked[i].tool, asked[i].bump, 0),
                     tilted = change_at_pole(asked[i].tool, asked[i].bump, 0.2);
        print_message("%s at a height of %g: %.1f voxels, by a tilted normal %.1f\n",
                      iso_tool_name(asked[i].tool), asked[i].bump, straight, tilted);
        assert_true(straight >= asked[i].least && straight <= asked[i].most);
        if (asked[i].tool != ISO_TOOL_CREASE) assert_true(fabs(tilted - straight) < 0.1 * fabs(straight) + 1);
    }
}

static bool is_interface(const iso_hgrid *grid, int x, int y, int z) {
    const bool inside = iso_hgrid_at(grid, x, y, z) < 0;
    return inside != (iso_hgrid_at(grid, x + 1, y, z) < 0) ||
           inside != (iso_hgrid_at(grid, x - 1, y, z) < 0) ||
           inside != (iso_hgrid_at(grid, x, y + 1, z) < 0) ||
           inside != (iso_hgrid_at(grid, x, y - 1, z) < 0) ||
           inside != (iso_hgrid_at(grid, x, y, z + 1) < 0) || inside != (iso_hgrid_at(grid, x, y, z - 1) < 0);
}

/* A touch that adds nothing new makes the band again; the zero set must not move by a bit. */
static void freezing_moves_nothing(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(64, iso_vec3_make(31.3, 32.6, 30.8), 18);
    iso_editor *editor = make_editor(grid, NULL);
    iso_brush brush = {.tool = ISO_TOOL_CARVE, .radius = 9};
    sculpt_touch(editor, &brush, iso_vec3_make(48, 32, 31), iso_vec3_make(1, 0, 0));
    for (int round = 0; round < 20; round++) {
        iso_hgrid *before = sculpt_copy(grid);
        brush.radius = 9 + 0.01 * (round % 2); /* reaches the same interface or next to nothing of it */
        iso_brush again = {.tool = ISO_TOOL_CARVE, .radius = 9};
        sculpt_touch(editor, &again, iso_vec3_make(48, 32, 31), iso_vec3_make(1, 0, 0));
        for (int z = 1; z < 63; z++)
            for (int y = 1; y < 63; y++)
                for (int x = 1; x < 63; x++) {
                    float v = iso_hgrid_at(before, x, y, z);
                    if (is_interface(before, x, y, z) && v != iso_hgrid_at(grid, x, y, z))
                        fail_msg("round %d: voxel (%d, %d, %d) at the interface was %g and is %g", round, x,
                                 y, z, (double)v, (double)iso_hgrid_at(grid, x, y, z));
                }
        iso_hgrid_destroy(before);
    }
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* At a stroke's end distances beside creases change, neither the interface nor what is frozen nor a sign
 * does, and nothing leaves the band. */
static void ends_move_nothing(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(64, iso_vec3_make(31.3, 32.6, 30.8), 18);
    iso_editor *editor = make_editor(grid, NULL);
    const iso_vec3 up = {1, 0, 0};
    iso_brush brush = {.tool = ISO_TOOL_CARVE, .radius = 9}, mask = {.tool = ISO_TOOL_MASK, .radius = 6};
    sculpt_touch(editor, &brush, iso_vec3_make(48, 32, 31), up);
    brush.shape = ISO_SOLID_BOX;
    sculpt_touch(editor, &brush, iso_vec3_make(31, 49, 28), up);
    brush.tool = ISO_TOOL_ADD;
    sculpt_touch(editor, &brush, iso_vec3_make(30, 14, 31), up);
    sculpt_touch(editor, &mask, iso_vec3_make(30, 18, 40), up);
    iso_hgrid *before = sculpt_copy(grid);
    const uint64_t seen = iso_change_log_now(grid->log);
    settle(editor);
    size_t longer = 0, masked = 0;
    for (int i = 0; i < 62 * 62 * 62; i++) {
        const int x = 1 + i % 62, y = 1 + i / 62 % 62, z = 1 + i / 62 / 62;
        const float was = iso_hgrid_at(before, x, y, z), is = iso_hgrid_at(grid, x, y, z);
        const bool frozen = iso_editor_masked(editor, x, y, z);
        masked += frozen;
        if (was == is) continue;
        longer += fabsf(is) > fabsf(was);
        if (frozen || is_interface(before, x, y, z) || (was < 0) != (is < 0) || !(fabsf(is) < grid->band) ||
            !(fabsf(is - was) <= 0.5f))
            fail_msg("voxel (%d, %d, %d) was %g and is %g", x, y, z, (double)was, (double)is);
        const uint32_t cell = (uint32_t)iso_hgrid_cell_index(grid, x / 16, y / 16, z / 16);
        assert_true(iso_change_log_last_edit(grid->log, cell) > seen);
    }
    print_message("%zu distances grew\n", longer);
    assert_true(longer > 300 && masked > 500);
    iso_hgrid_destroy(before);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* In a wider band, values beyond the distance in which crossings are searched do not change. */
static void ends_leave_what_is_far(void **state) {
    (void)state;
    const int dims[3] = {64, 64, 64};
    iso_hgrid *grid;
    assert_int_equal(iso_hgrid_create(dims, 6, NULL, &grid, NULL), ISO_OK);
    for (int i = 0; i < 4 * 4 * 4; i++) { /* a box that is cut off at an edge */
        float *brick;
        assert_int_equal(iso_hgrid_split(grid, i % 4, i / 4 % 4, i / 16, &brick, NULL), ISO_OK);
        for (int k = 0; k < ISO_BRICK_VOXELS; k++) {
            const double x = fabs(i % 4 * 16 + k % 16 - 31.3) - 14,
                         y = fabs(i / 4 % 4 * 16 + k / 16 % 16 - 31.1) - 14,
                         z = fabs(i / 16 * 16 + k / 256 - 30.8) - 14;
            const double out = sqrt(pow(fmax(x, 0), 2) + pow(fmax(y, 0), 2) + pow(fmax(z, 0), 2)),
                         distance = out + fmin(fmax(x, fmax(y, z)), 0);
            brick[k] = (float)fmin(fmax(distance, -6), 6);
        }
    }
    iso_editor *editor = make_editor(grid, NULL);
    const iso_brush brush = {.tool = ISO_TOOL_INFLATE, .radius = 30, .strength = 1e-3};
    sculpt_touch(editor, &brush, iso_vec3_make(32, 32, 32), iso_vec3_make(0, 0, 1));
    iso_hgrid *before = sculpt_copy(grid);
    settle(editor);
    size_t moved = 0;
    for (int i = 0; i < 64 * 64 * 64; i++) {
        const int x = i % 64, y = i / 64 % 64, z = i / 64 / 64;
        const float was = iso_hgrid_at(before, x, y, z), is = iso_hgrid_at(grid, x, y, z);
        moved += was != is;
        if (was != is && fabsf(was) > 4)
            fail_msg("voxel (%d, %d, %d) was %g and is %g", x, y, z, (double)was, (double)is);
    }
    assert_true(moved > 100);
    iso_hgrid_destroy(before);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* Beside a crease distances that are too long are cut; but beside the band's end none is left where foot
 * points are made, whether it was there before or not. */
static void ends_make_no_wrong_foot_points(void **state) {
    (void)state;
    enum { SIDE = ISO_CREASE_SIDE, M = ISO_CREASE_MARGIN };
    static const int step[3] = {1, SIDE, SIDE * SIDE};
    static float window[SIDE * SIDE * SIDE], out[ISO_BRICK_VOXELS];
    const float foot = 1.7320508f;
    iso_buffer room = {0};
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) { /* outside of a slanting edge; the band ends early */
        const double slant = 0.07 * (i / SIDE / SIDE), x = i % SIDE - 11.3 - slant,
                     y = i / SIDE % SIDE - 12.2 + slant;
        const double distance = hypot(fmax(x, 0), fmax(y, 0)) + fmin(fmax(x, y), 0);
        window[i] = (float)fmax(distance > 2.1 ? 3 : distance > 1.45 ? distance + 0.3 : distance, -3);
    }
    bool any;
    assert_int_equal(iso_crease_correct(window, 3, &room, out, &any), ISO_OK);
    assert_true(any);
    size_t cut = 0, held = 0, raised = 0;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const float *was = &window[((i / 256 + M) * SIDE + i / 16 % 16 + M) * SIDE + i % 16 + M];
        bool beside = false;
        for (int axis = 0; axis < 3; axis++) beside |= was[step[axis]] == 3 || was[-step[axis]] == 3;
        cut += out[i] < *was;
        held += *was > foot && out[i] == foot;
        raised += *was < foot && out[i] == foot;
        assert_false(beside && out[i] > 1 && out[i] < foot);
    }
    print_message("%zu distances cut, %zu of them to %g, %zu raised\n", cut, held, (double)foot, raised);
    assert_true(cut > held && held > 0 && raised > 0);
    iso_buffer_free(&room);
}

/* ---- creases, voxel by voxel: every edge point against every voxel, without bins */

enum { WINDOW = ISO_CREASE_SIDE, WINDOW_VOXELS = WINDOW * WINDOW * WINDOW };
static const int window_step[3] = {1, WINDOW, WINDOW *WINDOW};

static bool plain_is_curved(const float *v) {
    const float sum = (v[1] + v[-1]) + (v[window_step[1]] + v[-window_step[1]]) +
                      (v[window_step[2]] + v[-window_step[2]]) - 6 * v[0];
    return fabsf(sum) > 0.5f;
}

typedef struct plain_points {
    int32_t at[3 * WINDOW_VOXELS][3];
    bool crease[3 * WINDOW_VOXELS];
    int count, creases;
} plain_points;

static void find_plain_points(const float *window, plain_points *points) {
    points->count = points->creases = 0;
    for (int i = 0; i < WINDOW_VOXELS; i++)
        for (int axis = 0; axis < 3; axis++) {
            const int voxel[3] = {i % WINDOW, i / WINDOW % WINDOW, i / WINDOW / WINDOW};
            int least = voxel[0], most = voxel[0] + (axis == 0);
            for (int k = 1; k < 3; k++) {
                least = voxel[k] < least ? voxel[k] : least;
                most = voxel[k] + (axis == k) > most ? voxel[k] + (axis == k) : most;
            }
            if (least < 1 || most > WINDOW - 2) continue;
            const float *low = window + i, *high = low + window_step[axis];
            if ((*low < 0) == (*high < 0)) continue;
            int32_t *at = points->at[points->count];
            for (int k = 0; k < 3; k++) at[k] = 1024 * (voxel[k] - 1);
            at[axis] += (int32_t)lrint(1024 * (double)*low / ((double)*low - (double)*high));
            const bool crease = plain_is_curved(low) || plain_is_curved(high);
            points->crease[points->count++] = crease;
            points->creases += crease;
        }
}

/* The value of a voxel (counted from the window's voxel (1, 1, 1)) after correction. */
static float plain_value(const float *window, float band, const plain_points *points, const int voxel[3]) {
    const float *v =
        window + (voxel[2] + 1) * window_step[2] + (voxel[1] + 1) * window_step[1] + voxel[0] + 1;
    const float distance = fabsf(*v);
    bool near_crease = false, beside = false;
    if (distance < 1 || distance >= fminf(band, 4 - 0.4f)) return *v;
    for (int k = 0; k < 6; k++) {
        const float other = v[(k % 2 ? 1 : -1) * window_step[k / 2]];
        if ((other < 0) != (*v < 0)) return *v;
        beside |= fabsf(other) >= band;
    }
    int64_t nearest[2] = {INT64_MAX, INT64_MAX};
    for (int i = 0; i < points->count; i++) {
        int64_t square = 0;
        bool around = true;
        for (int k = 0; k < 3; k++) {
            const int64_t d = 1024 * voxel[k] - points->at[i][k];
            square += d * d;
            /* the voxel at which the edge begins lies in a block of 4^3 beside the voxel's own */
            around &= abs(points->at[i][k] / 1024 / 4 - voxel[k] / 4) <= 1;
        }
        near_crease |= around && points->crease[i];
        if (square < nearest[points->crease[i]]) nearest[points->crease[i]] = square;
    }
    const int32_t reach = (int32_t)((distance + 0.4f) * (distance + 0.4f) * (1024 * 1024));
    float made = distance;
    if (!near_crease) return *v;
    if (nearest[1] < reach && nearest[0] >= nearest[1]) {
        const float square = (float)nearest[1] / (1024 * 1024);
        made = fmaxf(distance, sqrtf(fmaxf(square - 0.25f, 0)));
        made = fminf(fminf(made, sqrtf(square)), fmaxf(distance, 0.999f * band));
    }
    if (beside && made < 1.7320508f) made = 1.7320508f;
    return *v < 0 ? -made : made;
}

/* Windows with slanting boxes and noise, bands of 3 and 5 voxels: every instruction set corrects each
 * voxel as the plain search does, and leaves a window without creases alone. */
static void creases_are_corrected_as_by_a_plain_search(void **state) {
    (void)state;
    enum { M = ISO_CREASE_MARGIN };
    static plain_points points;
    static float window[WINDOW_VOXELS], out[ISO_BRICK_VOXELS];
    iso_buffer room = {0};
    uint32_t seed = 5;
    int changed = 0, without = 0;
    for (int trial = 0; trial < 24; trial++) {
        const float band = trial % 2 ? 5 : 3, noise = trial % 3 ? 0 : 0.05f;
        double normal[3][3], offset[3];
        for (int i = 0; i < 3; i++) {
            double length = 0;
            for (int k = 0; k < 3; k++) {
                normal[i][k] = uniform(&seed) - 0.5;
                length += normal[i][k] * normal[i][k];
            }
            for (int k = 0; k < 3; k++) normal[i][k] /= sqrt(length);
            offset[i] = 6 * uniform(&seed) - 3 + (trial == 22 ? 100 : 0);
        }
        for (int i = 0; i < WINDOW_VOXELS; i++) {
            const double p[3] = {i % WINDOW - 12.5, i / WINDOW % WINDOW - 12.5, i / WINDOW / WINDOW - 12.5};
            double most = -100;
            for (int k = 0; k < (trial == 23 ? 1 : 3); k++)
                most =
                    fmax(most, normal[k][0] * p[0] + normal[k][1] * p[1] + normal[k][2] * p[2] - offset[k]);
            const double value = (trial & 4 ? -most : most) + noise * (uniform(&seed) - 0.5);
            window[i] = (float)fmax(fmin(value, (double)band), -(double)band);
        }
        find_plain_points(window, &points);
        without += points.creases == 0;
        for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
            bool any;
            iso_cpu_limit((iso_cpu_level)level);
            assert_int_equal(iso_crease_correct(window, band, &room, out, &any), ISO_OK);
            assert_int_equal(any, points.creases > 0);
            for (int i = 0; any && i < ISO_BRICK_VOXELS; i++) {
                const int voxel[3] = {i % 16 + M - 1, i / 16 % 16 + M - 1, i / 256 + M - 1};
                const float was = iso_crease_row(window, i / 16)[i % 16];
                assert_memory_equal(&out[i], &(float){plain_value(window, band, &points, voxel)},
                                    sizeof *out);
                changed += out[i] != was;
            }
        }
        iso_cpu_limit(ISO_CPU_AVX512);
    }
    assert_true(changed > 1000 && without >= 2);
    iso_buffer_free(&room);
}

static iso_brush random_brush(uint32_t *seed) {
    iso_brush brush = {.tool = (iso_tool)(uniform(seed) * (ISO_TOOL_MOVE)),
                       .shape = (iso_solid)(uniform(seed) * ISO_SOLID_STAMP),
                       .falloff = (iso_falloff)(uniform(seed) * ISO_FALLOFF_COUNT),
                       .radius = 2 + 16 * uniform(seed),
                       .strength = uniform(seed),
                       .symmetry = uniform(seed) < 0.3 ? (unsigned)(uniform(seed) * 8) : 0,
                       .mirror = {31.5, 31.5, 31.5}};
    return brush;
}

static iso_touch random_touch(uint32_t *seed) {
    iso_sample sample = {.pressure = 1};
    double *p[6] = {&sample.position.x, &sample.position.y, &sample.position.z,
                    &sample.normal.x,   &sample.normal.y,   &sample.normal.z};
    for (int i = 0; i < 6; i++) *p[i] = i < 3 ? 80 * uniform(seed) - 8 : uniform(seed) - 0.5;
    sample.normal = iso_vec3_unit(sample.normal);
    iso_touch touch = {.sample = sample, .previous = sample, .first = sample};
    touch.previous.position.x += 6 * uniform(seed);
    return touch;
}

static void play(iso_hgrid *grid, iso_pool *pool, int touches, uint32_t seed) {
    iso_editor *editor = make_editor(grid, pool);
    for (int i = 0; i < touches; i++) {
        iso_brush brush = random_brush(&seed);
        iso_touch touch = random_touch(&seed);
        assert_int_equal(iso_editor_touch(editor, &brush, &touch, NULL, NULL), ISO_OK);
        if (i % 10 == 9) settle(editor);
    }
    iso_editor_destroy(editor);
}

static void same_bytes_for_threads_and_levels(void **state) {
    (void)state;
    iso_hgrid *wanted = sculpt_ball(64, iso_vec3_make(31, 31, 31), 20);
    iso_cpu_limit(ISO_CPU_GENERIC);
    play(wanted, NULL, 60, 5);
    for (int level = ISO_CPU_GENERIC; level < ISO_CPU_LEVELS; level++) {
        iso_pool *pool;
        assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
        iso_hgrid *got = sculpt_ball(64, iso_vec3_make(31, 31, 31), 20);
        iso_cpu_limit((iso_cpu_level)level);
        play(got, pool, 60, 5);
        assert_true(sculpt_same(got, wanted));
        iso_hgrid_destroy(got);
        iso_pool_destroy(pool);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_hgrid_destroy(wanted);
}

/* What every field must be: inside the band's limits, finite, and no brick that could be an empty cell. */
static void check_invariants(const iso_hgrid *grid) {
    size_t cells = (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
    for (size_t cell = 0; cell < cells; cell++) {
        if (grid->cell[cell] < 0) continue;
        const float *brick = iso_hgrid_brick(grid, grid->cell[cell]);
        int at_limit[2] = {0, 0};
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            assert_true(fabsf(brick[i]) <= grid->band);
            at_limit[0] += brick[i] == grid->band;
            at_limit[1] += brick[i] == -grid->band;
        }
        assert_true(at_limit[0] < ISO_BRICK_VOXELS && at_limit[1] < ISO_BRICK_VOXELS);
    }
}

/* Spheres added and carved anywhere, against a bit a voxel. */
static void signs_are_those_of_a_bit_model(void **state) {
    (void)state;
    enum { SIDE = 64 };
    iso_hgrid *grid = sculpt_ball(SIDE, iso_vec3_make(31, 31, 31), 20);
    bool *model = malloc(SIDE * SIDE * SIDE);
    assert_non_null(model);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        model[i] = iso_hgrid_at(grid, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE) < 0;
    iso_editor *editor = make_editor(grid, NULL);
    uint32_t seed = 11;
    for (int step = 0; step < 300; step++) {
        bool carve = uniform(&seed) < 0.5;
        iso_brush brush = {.tool = carve ? ISO_TOOL_CARVE : ISO_TOOL_ADD, .radius = 2 + 14 * uniform(&seed)};
        double c[3];
        for (int axis = 0; axis < 3; axis++) c[axis] = 90 * uniform(&seed) - 13;
        sculpt_touch(editor, &brush, iso_vec3_make(c[0], c[1], c[2]), iso_vec3_make(0, 0, 1));
        for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
            double x = i % SIDE - c[0], y = i / SIDE % SIDE - c[1], z = i / SIDE / SIDE - c[2];
            double d = sqrt(x * x + y * y + z * z) - brush.radius;
            if (fabs(d) < 5e-4)
                model[i] =
                    iso_hgrid_at(grid, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE) < 0; /* rounding decides */
            else if (d < 0)
                model[i] = !carve;
        }
        if (step % 10 == 9) settle(editor);
        check_invariants(grid);
    }
    int wrong = 0, inside = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        wrong += model[i] != (iso_hgrid_at(grid, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE) < 0);
        inside += model[i];
    }
    assert_true(inside > 1000);
    assert_int_equal(wrong, 0);
    free(model);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* Shapes of known volume. */
static void volumes_are_known(void **state) {
    (void)state;
    static const struct {
        iso_solid shape;
        double aspect, volume; /* of radius 1 */
    } solids[] = {{ISO_SOLID_SPHERE, 0.5, 4 * ISO_PI / 3},
                  {ISO_SOLID_BOX, 0.8, 2 * 1.6 * 1.6},
                  {ISO_SOLID_CYLINDER, 0.7, ISO_PI * 1.4},
                  {ISO_SOLID_TORUS, 0.4, 2 * ISO_PI * ISO_PI * 0.16}};
    for (size_t i = 0; i < sizeof solids / sizeof *solids; i++) {
        iso_hgrid *grid = sculpt_ball(96, iso_vec3_make(-500, 0, 0), 1); /* nothing in it */
        iso_editor *editor = make_editor(grid, NULL);
        iso_brush brush = {
            .tool = ISO_TOOL_ADD, .shape = solids[i].shape, .aspect = solids[i].aspect, .radius = 20};
        sculpt_touch(editor, &brush, iso_vec3_make(47.3, 46.8, 48.1), iso_vec3_unit(iso_vec3_make(1, 2, 3)));
        double got = sculpt_volume(grid), wanted = solids[i].volume * 8000;
        print_message("%s: volume %.0f, wanted %.0f\n", iso_solid_name(solids[i].shape), got, wanted);
        assert_true(fabs(got / wanted - 1) < 0.005);
        iso_brush all = {.tool = ISO_TOOL_CARVE, .radius = 40};
        sculpt_touch(editor, &all, iso_vec3_make(47.3, 46.8, 48.1), iso_vec3_make(0, 0, 1));
        assert_true(sculpt_volume(grid) == 0 && iso_hgrid_brick_count(grid) == 0);
        iso_editor_destroy(editor);
        iso_hgrid_destroy(grid);
    }
}

static void symmetry_is_symmetric(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(64, iso_vec3_make(31.5, 31.5, 31.5), 18);
    iso_editor *editor = make_editor(grid, NULL);
    uint32_t seed = 3;
    for (int i = 0; i < 60; i++) {
        iso_brush brush = random_brush(&seed);
        iso_touch touch = random_touch(&seed);
        brush.symmetry = 7;
        assert_int_equal(iso_editor_touch(editor, &brush, &touch, NULL, NULL), ISO_OK);
        if (i % 10 == 9) settle(editor);
    }
    double worst = 0;
    for (int z = 0; z < 64; z++)
        for (int y = 0; y < 64; y++)
            for (int x = 0; x < 64; x++) {
                double v = (double)iso_hgrid_at(grid, x, y, z);
                const double others[3] = {(double)iso_hgrid_at(grid, 63 - x, y, z),
                                          (double)iso_hgrid_at(grid, x, 63 - y, z),
                                          (double)iso_hgrid_at(grid, x, y, 63 - z)};
                for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(v - others[k]));
            }
    print_message("asymmetry %.2g voxel\n", worst);
    assert_true(worst < 1e-4);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* ---- the write observer, and failing half-way */

typedef struct notified {
    const iso_hgrid *grid;
    iso_hgrid *before;
    int count, fail_at;
} notified;

static iso_status remember(void *context, uint32_t cell, int32_t state, const float *brick,
                           iso_error *error) {
    notified *t = context;
    if (t->count++ == t->fail_at) return iso_fail(error, ISO_ERR_NOMEM, "no more");
    assert_int_equal(t->grid->cell[cell] < 0, brick == NULL);
    assert_int_equal(t->before->cell[cell] < 0, brick == NULL);
    if (brick)
        assert_memory_equal(brick, iso_hgrid_brick(t->before, t->before->cell[cell]),
                            ISO_BRICK_VOXELS * sizeof(float));
    else
        assert_int_equal(state, t->before->cell[cell]);
    return ISO_OK;
}

/* The observer is called once for each cell that a step changes, with its old content; if the observer fails,
 * the touch fails. */
static void keepers_are_told_before(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(64, iso_vec3_make(31, 31, 31), 20);
    iso_editor *editor = make_editor(grid, NULL);
    uint32_t seed = 23;
    int failures = 0;
    for (int step = 0; step < 20; step++) {
        notified t = {.grid = grid, .before = sculpt_copy(grid), .fail_at = step % 5 == 4 ? 1 : -1};
        iso_step_opts opts = {.observer = {.before = remember, .context = &t}};
        iso_editor_begin_step(editor, &opts);
        uint64_t seen = iso_change_log_now(grid->log);
        iso_status status = ISO_OK;
        for (int i = 0; i < 3 && status == ISO_OK; i++) {
            iso_brush brush = random_brush(&seed);
            iso_touch touch = random_touch(&seed);
            iso_hgrid *last = sculpt_copy(grid);
            status = iso_editor_touch(editor, &brush, &touch, NULL, NULL);
            assert_int_equal(status, t.fail_at >= 0 && t.count == t.fail_at + 1 ? ISO_ERR_NOMEM : ISO_OK);
            if (status != ISO_OK) assert_true(sculpt_same(grid, last));
            failures += status != ISO_OK;
            iso_hgrid_destroy(last);
        }
        size_t differ = 0, cells = (size_t)(4 * 4 * 4);
        for (uint32_t cell = 0; cell < cells; cell++) {
            const bool a = grid->cell[cell] >= 0, b = t.before->cell[cell] >= 0;
            bool same = a == b && (a ? !memcmp(iso_hgrid_brick(grid, grid->cell[cell]),
                                               iso_hgrid_brick(t.before, t.before->cell[cell]), 16384)
                                     : grid->cell[cell] == t.before->cell[cell]);
            differ += !same;
            if (!same) assert_true(iso_change_log_last_edit(grid->log, cell) > seen);
        }
        assert_true((size_t)t.count >= differ);
        iso_hgrid_destroy(t.before);
    }
    assert_true(failures >= 2);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

static void bad_brushes_are_named(void **state) {
    (void)state;
    iso_hgrid *grid = sculpt_ball(32, iso_vec3_make(15, 15, 15), 8);
    iso_editor *editor = make_editor(grid, NULL);
    iso_sample sample = {.normal = {0, 0, 1}, .pressure = 1};
    iso_touch touch = {.sample = sample, .previous = sample, .first = sample}, lost = touch;
    lost.sample.position.y = NAN;
    const struct {
        iso_brush brush;
        const iso_touch *touch;
        const char *word;
    } bad[] = {{{.radius = 0}, &touch, "radius"},
               {{.radius = INFINITY}, &touch, "radius"},
               {{.radius = 1, .strength = 2}, &touch, "strength"},
               {{.radius = 1, .aspect = NAN}, &touch, "aspect"},
               {{.radius = 1, .tool = (iso_tool)77}, &touch, "tool"},
               {{.radius = 1, .tool = ISO_TOOL_MOVE}, &touch, "move"},
               {{.radius = 1, .shape = ISO_SOLID_STAMP}, &touch, "stamp"},
               {{.radius = 1}, &lost, "nan"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        iso_error error = {0};
        assert_int_equal(iso_editor_touch(editor, &bad[i].brush, bad[i].touch, NULL, &error), ISO_ERR_USAGE);
        if (!strstr(error.text, bad[i].word))
            fail_msg("case %zu: '%s' does not name %s", i, error.text, bad[i].word);
    }
    iso_transform flat = iso_transform_identity();
    flat.spacing[2] = 2;
    const int dims[3] = {32, 32, 32}, odd[3] = {32, 30, 32};
    iso_hgrid *other;
    iso_editor *none;
    iso_editor_opts opts = {0};
    assert_int_equal(iso_hgrid_create(dims, 3, &flat, &other, NULL), ISO_OK);
    assert_int_equal(iso_editor_create(other, &opts, &none, NULL), ISO_ERR_USAGE);
    iso_hgrid_destroy(other);
    assert_int_equal(iso_hgrid_create(odd, 3, NULL, &other, NULL), ISO_OK);
    assert_int_equal(iso_editor_create(other, &opts, &none, NULL), ISO_ERR_USAGE);
    iso_hgrid_destroy(other);
    iso_editor_destroy(editor);
    iso_hgrid_destroy(grid);
}

/* Of RFC 3720, appendix B.4, and of every length and alignment, by tables and by the instruction. */
static void checksums_are_castagnolis(void **state) {
    (void)state;
    uint8_t bytes[256];
    for (int i = 0; i < 256; i++) bytes[i] = (uint8_t)(i * 167 + 13);
    for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
        iso_cpu_limit((iso_cpu_level)level);
        assert_int_equal(iso_crc32c(0, "123456789", 9), 0xe3069283);
        for (size_t first = 0; first < 9; first++)
            for (size_t size = 0; size + first <= sizeof bytes; size++) {
                uint32_t crc = ~0u;
                for (size_t i = first; i < first + size; i++) {
                    crc ^= bytes[i];
                    for (int bit = 0; bit < 8; bit++) crc = crc >> 1 ^ (crc & 1 ? 0x82f63b78u : 0);
                }
                assert_int_equal(iso_crc32c(0, bytes + first, size), ~crc);
                const size_t half = size / 2; /* in two parts */
                assert_int_equal(
                    iso_crc32c(iso_crc32c(0, bytes + first, half), bytes + first + half, size - half), ~crc);
            }
    }
    iso_cpu_limit(ISO_CPU_AVX512);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(checksums_are_castagnolis),
                                       cmocka_unit_test(deforming_strokes_keep_a_distance_field),
                                       cmocka_unit_test(set_operations_keep_a_distance_field),
                                       cmocka_unit_test(brushes_act_on_their_side),
                                       cmocka_unit_test(freezing_moves_nothing),
                                       cmocka_unit_test(ends_move_nothing),
                                       cmocka_unit_test(ends_leave_what_is_far),
                                       cmocka_unit_test(ends_make_no_wrong_foot_points),
                                       cmocka_unit_test(creases_are_corrected_as_by_a_plain_search),
                                       cmocka_unit_test(same_bytes_for_threads_and_levels),
                                       cmocka_unit_test(signs_are_those_of_a_bit_model),
                                       cmocka_unit_test(volumes_are_known),
                                       cmocka_unit_test(symmetry_is_symmetric),
                                       cmocka_unit_test(keepers_are_told_before),
                                       cmocka_unit_test(bad_brushes_are_named)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
