/* Trimming by a plane and by a lasso: exact distances to what is removed, checked by brute force; the same
 * bytes for every instruction set, number of threads, and replayed, edited, undone; what outlines nothing is
 * refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/numbers.h"
#include "sculpt/brush/dab.h"
#include "session_support.h"

enum { SIDE = 64, CORNERS = 12 };

static const iso_vec3 Z = {0, 0, 1};

static double dot3(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_dot(a, b);
}

/* ---- by brute force */

/* The distance from p to the triangle a, b, c: the least of what its plane and its sides give. */
static double segment_distance(iso_vec3 p, iso_vec3 a, iso_vec3 b) {
    const iso_vec3 ab = iso_vec3_sub(b, a), ap = iso_vec3_sub(p, a);
    const double square = dot3(ab, ab), t = square > 0 ? fmin(fmax(dot3(ap, ab) / square, 0), 1) : 0;
    return iso_vec3_length(iso_vec3_sub(ap, iso_vec3_scale(ab, t)));
}

static double triangle_distance(iso_vec3 p, iso_vec3 a, iso_vec3 b, iso_vec3 c) {
    const iso_vec3 n = iso_vec3_unit(iso_vec3_cross(iso_vec3_sub(b, a), iso_vec3_sub(c, a)));
    const iso_vec3 corners[] = {a, b, c};
    double least =
        fmin(segment_distance(p, a, b), fmin(segment_distance(p, b, c), segment_distance(p, c, a)));
    for (int k = 0; k < 3; k++) {
        const iso_vec3 side = iso_vec3_sub(corners[(k + 1) % 3], corners[k]);
        if (dot3(iso_vec3_cross(n, side), iso_vec3_sub(p, corners[k])) < 0) return least;
    }
    return fmin(least, fabs(dot3(n, iso_vec3_sub(p, a))));
}

/* Whether (x, y) is within a polygon: a line upwards crosses it an odd number of times. */
static bool is_within(double x, double y, const double (*at)[2], int count) {
    bool within = false;
    for (int i = 0; i < count; i++) {
        const double *a = at[i], *b = at[(i + 1) % count];
        if ((a[0] > x) == (b[0] > x)) continue;
        within ^= a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) > y;
    }
    return within;
}

/* An outline on the plane z = 0 seen from `eye`; at infinity above, if it is 0. */
typedef struct seen {
    double at[CORNERS][2];
    iso_sample samples[CORNERS];
    double eye;
} seen;

static seen make_seen(uint32_t *seed, double eye, bool crosses) {
    seen s = {.eye = eye};
    for (int i = 0; i < CORNERS; i++) {
        const double r = 6 + 14 * uniform(seed), t = crosses ? 7 * uniform(seed) : 2 * ISO_PI * i / CORNERS;
        s.at[i][0] = 31 + r * cos(t);
        s.at[i][1] = 30 + r * sin(t);
        s.samples[i] = (iso_sample){.position = {s.at[i][0], s.at[i][1], 0}, .normal = Z, .pressure = 1};
        if (eye > 0)
            s.samples[i].normal =
                iso_vec3_unit(iso_vec3_sub(iso_vec3_make(31, 30, eye), s.samples[i].position));
    }
    return s;
}

static double seen_distance(const seen *s, iso_vec3 p) {
    const iso_vec3 eye = {31, 30, s->eye};
    double least = INFINITY, x = p.x, y = p.y;
    for (int i = 0; i < CORNERS; i++) {
        const double *a = s->at[i], *b = s->at[(i + 1) % CORNERS];
        const iso_vec3 low_a = {a[0], a[1], 0}, low_b = {b[0], b[1], 0};
        if (s->eye > 0) {
            const iso_vec3 far_a = iso_vec3_add(eye, iso_vec3_scale(iso_vec3_sub(low_a, eye), 50)),
                           far_b = iso_vec3_add(eye, iso_vec3_scale(iso_vec3_sub(low_b, eye), 50));
            least = fmin(least, triangle_distance(p, eye, far_a, far_b));
        } else
            least = fmin(least, segment_distance(iso_vec3_make(p.x, p.y, 0), low_a, low_b));
    }
    if (s->eye > 0) {
        x = eye.x + (p.x - eye.x) * s->eye / (s->eye - p.z);
        y = eye.y + (p.y - eye.y) * s->eye / (s->eye - p.z);
    }
    return is_within(x, y, s->at, CORNERS) ? -least : least;
}

static iso_status make_outline(iso_tool tool, const iso_sample *samples, size_t count, iso_outline *outline,
                               iso_error *error) {
    const iso_transform transform = iso_transform_identity();
    const iso_affine affine = iso_transform_affine(&transform);
    const iso_brush brush = {.radius = 1};
    iso_brush_image image[ISO_IMAGES_MOST];
    iso_brush_images(&brush, image);
    return iso_outline_make(&(iso_outline_space){&affine, 1}, tool, image, samples, count, outline, error);
}

static void distances_are_exact(void **state) {
    (void)state;
    uint32_t seed = 5;
    double worst = 0;
    for (int round = 0; round < 60; round++) {
        const seen s = make_seen(&seed, round % 3 ? 90 : 0, round % 2);
        iso_outline trim, crop;
        assert_int_equal(make_outline(ISO_TOOL_TRIM_LASSO, s.samples, CORNERS, &trim, NULL), ISO_OK);
        assert_int_equal(make_outline(ISO_TOOL_CROP_LASSO, s.samples, CORNERS, &crop, NULL), ISO_OK);
        for (int i = 0; i < 400; i++) {
            const double p[3] = {64 * uniform(&seed), 64 * uniform(&seed), 64 * uniform(&seed)};
            const double wanted = seen_distance(&s, iso_vec3_make(p[0], p[1], p[2])),
                         got = iso_outline_distance(&trim, p);
            worst = fmax(worst, fabs(got - wanted));
            assert_true(iso_outline_distance(&crop, p) == -got);
        }
        iso_outline_free(&trim);
        iso_outline_free(&crop);
    }
    print_message("distances differ by at most %.3g voxel\n", worst);
    assert_true(worst < 0.07); /* (corners that bend by less than 1/16 voxel are left out) */
}

/* Kernels take only the sides that a brick sees, in floats: the same values, the same bytes in every unit. */
static void kernels_agree(void **state) {
    (void)state;
    static float phi[ISO_BRICK_VOXELS], first[ISO_BRICK_VOXELS], got[ISO_BRICK_VOXELS];
    const iso_cpu_level best = iso_cpu_best();
    const iso_stencil stencil = {.self = phi, .face = {phi, phi, phi, phi, phi, phi}};
    uint32_t seed = 11;
    int near = 0;
    for (int k = 0; k < ISO_BRICK_VOXELS; k++) phi[k] = -3;
    for (int round = 0; round < 60; round++) {
        const seen s = make_seen(&seed, round % 3 ? 90 : 0, round % 2);
        static iso_dabs dabs;
        iso_outline outline;
        const iso_tool tool = round % 4 == 0   ? ISO_TOOL_TRIM_PLANE
                              : round % 4 == 1 ? ISO_TOOL_TRIM_LASSO
                                               : ISO_TOOL_CROP_LASSO;
        assert_int_equal(make_outline(tool, s.samples, CORNERS, &outline, NULL), ISO_OK);
        dabs = (iso_dabs){
            .tool = ISO_TOOL_CARVE, .radius_voxels = 1, .band = 3, .count = 1, .outline = &outline};
        for (int b = 0; b < 64; b++) {
            const int brick[3] = {b % 4, b / 4 % 4, b / 16};
            for (int level = 0; level <= (int)best; level++) {
                iso_dab_kernel_get((iso_cpu_level)level)->edit(&dabs, brick, &stencil, got);
                if (level == 0) memcpy(first, got, sizeof got);
                assert_memory_equal(first, got, sizeof got);
            }
            for (int k = 0; k < ISO_BRICK_VOXELS; k++) {
                const double at[3] = {16 * brick[0] + k % 16, 16 * brick[1] + k / 16 % 16,
                                      16 * brick[2] + k / 256};
                const double wanted = fmin(fmax(-iso_outline_distance(&outline, at), -3), 3);
                near += fabs(wanted) < 3;
                if (fabs(wanted - (double)got[k]) > 1e-4)
                    fail_msg("round %d, brick %d, voxel %d: %g, wanted %g", round, b, k, (double)got[k],
                             wanted);
            }
        }
        iso_outline_free(&outline);
    }
    assert_true(near > 100000);
}

/* ---- strokes */

static iso_session *open_session(const char *journal, iso_pool *pool) {
    return session_open(&(iso_session_opts){.journal = journal, .pool = pool, .checkpoint_strokes = -1});
}

static iso_status draw(iso_session *session, const iso_brush *brush, const iso_sample *samples, size_t count,
                       iso_error *error) {
    assert_int_equal(iso_session_begin(session, brush, &samples[0], NULL, NULL), ISO_OK);
    for (size_t i = 1; i < count; i++)
        assert_int_equal(iso_session_sample(session, &samples[i], NULL, NULL), ISO_OK);
    const iso_status status = iso_session_end(session, error);
    if (status != ISO_OK) assert_int_equal(iso_session_cancel(session, NULL), ISO_OK);
    return status;
}

/* A rectangle around (x, y) of the ball of radius 10 mm, seen from above or from an eye at this height. */
static void rectangle(double x, double y, double half, double eye, iso_sample out[4]) {
    for (int i = 0; i < 4; i++) {
        const iso_vec3 p = {x + (i == 1 || i == 2 ? half : -half), y + (i >= 2 ? half : -half), 0};
        out[i] = (iso_sample){.position = p, .normal = Z, .pressure = 1};
        if (eye > 0) out[i].normal = iso_vec3_unit(iso_vec3_sub(iso_vec3_make(x, y, eye), p));
    }
}

static double at_index(double x) { /* of a world coordinate in the session's grid */
    return (x + 15.75) / 0.5;
}

/* A plane through a ball: the rest is a part of the ball, with exact distances beside the cut. */
static void plane_halves_a_ball(void **state) {
    (void)state;
    const iso_brush brush = {.tool = ISO_TOOL_TRIM_PLANE, .radius = 1};
    const iso_vec3 along = iso_vec3_unit(iso_vec3_make(2, 1, 0)), right = {along.y, -along.x, 0};
    const iso_sample line[2] = {{.position = iso_vec3_scale(along, -9), .normal = Z, .pressure = 1},
                                {.position = iso_vec3_scale(along, 9), .normal = Z, .pressure = 1}};
    iso_session *session = open_session(NULL, NULL);
    const double before = sculpt_volume(iso_session_grid(session));
    assert_int_equal(draw(session, &brush, line, 2, NULL), ISO_OK);
    const iso_hgrid *grid = iso_session_grid(session);
    assert_true(fabs(sculpt_volume(grid) / before - 0.5) < 0.002);
    double worst = 0, sum = 0;
    int count = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const iso_vec3 p = {i % SIDE - 31.5, i / SIDE % SIDE - 31.5, i / SIDE / SIDE - 31.5};
        const double v = (double)iso_hgrid_at(grid, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE),
                     side = dot3(p, right), ball = iso_vec3_length(p) - 20;
        if (fabs(v) > 2) continue;
        /* the distance to half a ball: outside, beyond its rim, the distance to the rim */
        double wanted = fmax(ball, side);
        const double across = sqrt(fmax(dot3(p, p) - side * side, 0));
        if (side > 0) wanted = across < 20 ? side : sqrt(side * side + (across - 20) * (across - 20));
        worst = fmax(worst, fabs(v - wanted));
        sum += fabs(v - wanted);
        count++;
    }
    print_message("half a ball: distances differ by %.4f voxel, at most %.3f\n", sum / count, worst);
    assert_true(sum / count < 0.02 && worst < 0.7);
    iso_session_destroy(session);
}

static void trim_and_crop_make_a_whole(void **state) {
    (void)state;
    for (int eye = 0; eye < 2; eye++) {
        iso_session *trim = open_session(NULL, NULL), *crop = open_session(NULL, NULL);
        const double before = sculpt_volume(iso_session_grid(trim));
        iso_sample path[4];
        rectangle(4, 1, 3.3, eye * 40.0, path);
        assert_int_equal(draw(trim, &(iso_brush){.tool = ISO_TOOL_TRIM_LASSO, .radius = 1}, path, 4, NULL),
                         ISO_OK);
        assert_int_equal(draw(crop, &(iso_brush){.tool = ISO_TOOL_CROP_LASSO, .radius = 1}, path, 4, NULL),
                         ISO_OK);
        const double a = sculpt_volume(iso_session_grid(trim)), b = sculpt_volume(iso_session_grid(crop));
        print_message("volumes %.0f and %.0f of %.0f\n", a, b, before);
        assert_true(fabs(a + b - before) < 0.003 * before && b > 0.1 * before && a > 0.5 * before);
        iso_session_destroy(trim);
        iso_session_destroy(crop);
    }
}

/* Every voxel near what is left is a distance to it, so that brushes work on the cut as elsewhere. */
static void cuts_have_distances(void **state) {
    (void)state;
    iso_session *session = open_session(NULL, NULL);
    iso_sample path[4];
    const uint64_t begun = iso_change_log_now(iso_session_grid(session)->log);
    rectangle(6, 0, 4, 60, path);
    assert_int_equal(draw(session, &(iso_brush){.tool = ISO_TOOL_TRIM_LASSO, .radius = 1}, path, 4, NULL),
                     ISO_OK);
    const sculpt_quality q = sculpt_measure(iso_session_grid(session), begun);
    print_message("| |g| - 1 | mean %.4f p99 %.3f, foot points p99 %.3f, %zu of %zu clamped\n",
                  q.gradient_mean, q.gradient_p99, q.foot_p99, q.clamped, q.voxels);
    assert_true(q.voxels > 1000 && q.clamped == 0 && q.gradient_mean < 0.02 && q.foot_p99 < 0.3);
    iso_session_destroy(session);
}

/* With a blend the edge is rounded: some material less than with a sharp one, only beside the edge. */
static void blends_round_the_edge(void **state) {
    (void)state;
    iso_session *sharp = open_session(NULL, NULL), *round = open_session(NULL, NULL);
    iso_sample path[4];
    rectangle(6, 0, 4, 0, path);
    iso_brush brush = {.tool = ISO_TOOL_TRIM_LASSO, .radius = 1};
    assert_int_equal(draw(sharp, &brush, path, 4, NULL), ISO_OK);
    brush.blend = 1.5;
    assert_int_equal(draw(round, &brush, path, 4, NULL), ISO_OK);
    const double a = sculpt_volume(iso_session_grid(sharp)), b = sculpt_volume(iso_session_grid(round));
    assert_true(b < a - 20 && b > 0.98 * a);
    iso_session_destroy(sharp);
    iso_session_destroy(round);
}

static void symmetry_trims_both_sides(void **state) {
    (void)state;
    iso_session *session = open_session(NULL, NULL);
    iso_sample line[2] = {{.position = {5, -9, 0}, .normal = Z, .pressure = 1},
                          {.position = {5, 9, 0}, .normal = Z, .pressure = 1}};
    const iso_brush brush = {.tool = ISO_TOOL_TRIM_PLANE, .radius = 1, .symmetry = 1};
    assert_int_equal(draw(session, &brush, line, 2, NULL), ISO_OK);
    const iso_hgrid *grid = iso_session_grid(session);
    const int middle = 31;
    assert_true(iso_hgrid_at(grid, (int)at_index(4), middle, middle) < 0);
    assert_true(iso_hgrid_at(grid, (int)at_index(6), middle, middle) > 0);
    assert_true(iso_hgrid_at(grid, (int)at_index(-4), middle, middle) < 0);
    assert_true(iso_hgrid_at(grid, (int)at_index(-6), middle, middle) > 0);
    iso_session_destroy(session);
}

/* What is frozen stays when all around it is removed. */
static void frozen_voxels_stay(void **state) {
    (void)state;
    iso_session *session = open_session(NULL, NULL);
    const iso_sample top = {.position = {0, 0, 9}, .normal = Z, .pressure = 1};
    iso_sample path[4];
    assert_int_equal(draw(session, &(iso_brush){.tool = ISO_TOOL_MASK, .radius = 5}, &top, 1, NULL), ISO_OK);
    iso_hgrid *before = sculpt_copy(iso_session_grid(session));
    rectangle(0, 0, 15, 0, path);
    assert_int_equal(draw(session, &(iso_brush){.tool = ISO_TOOL_TRIM_LASSO, .radius = 1}, path, 4, NULL),
                     ISO_OK);
    int frozen = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        const bool kept = iso_session_masked(session, at[0], at[1], at[2]),
                   inside = iso_hgrid_at(iso_session_grid(session), at[0], at[1], at[2]) < 0;
        assert_int_equal(inside, kept && iso_hgrid_at(before, at[0], at[1], at[2]) < 0);
        frozen += inside;
    }
    assert_true(frozen > 1000);
    iso_hgrid_destroy(before);
    iso_session_destroy(session);
}

/* ---- the same bytes */

static void draw_some(iso_session *session) {
    iso_sample path[4];
    const iso_brush add = {.tool = ISO_TOOL_ADD, .radius = 3, .has_color = true, .color = {9, 90, 200}};
    const iso_sample bump = {.position = {0, 9, 3}, .normal = {0, 1, 0}, .pressure = 1};
    assert_int_equal(draw(session, &add, &bump, 1, NULL), ISO_OK);
    rectangle(6, 4, 4, 50, path);
    assert_int_equal(draw(session, &(iso_brush){.tool = ISO_TOOL_TRIM_LASSO, .radius = 1, .has_color = true},
                          path, 4, NULL),
                     ISO_OK);
    assert_int_equal(
        draw(session, &(iso_brush){.tool = ISO_TOOL_INFLATE, .radius = 3, .strength = 1}, &bump, 1, NULL),
        ISO_OK);
    const iso_sample line[2] = {{.position = {-9, -6, 0}, .normal = Z, .pressure = 1},
                                {.position = {9, -5, 0}, .normal = Z, .pressure = 1}};
    assert_int_equal(draw(session, &(iso_brush){.tool = ISO_TOOL_TRIM_PLANE, .radius = 1}, line, 2, NULL),
                     ISO_OK);
}

static void replay_and_edits_give_the_same(void **state) {
    (void)state;
    const char *journal = session_path("trim.strokes");
    session_field drawn;
    iso_session *session = session_drawn(journal, draw_some, &drawn);
    while (iso_history_position(iso_session_history(session)))
        assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    while (iso_history_position(iso_session_history(session)) <
           iso_history_count(iso_session_history(session)))
        assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
    assert_true(session_is(session, &drawn));

    const iso_event mute = {.kind = ISO_EVENT_MUTE, .first = 2, .last = 2};
    iso_event unmute = mute, edit = {.kind = ISO_EVENT_EDIT, .first = 2, .last = 2};
    unmute.kind = ISO_EVENT_UNMUTE;
    edit.brush = (iso_brush){.tool = ISO_TOOL_CROP_LASSO, .radius = 1, .blend = 1};
    assert_int_equal(iso_session_edit(session, &mute, NULL), ISO_OK);
    assert_false(session_is(session, &drawn));
    assert_int_equal(iso_session_edit(session, &unmute, NULL), ISO_OK);
    assert_true(session_is(session, &drawn));
    assert_int_equal(iso_session_edit(session, &edit, NULL), ISO_OK);
    assert_false(session_is(session, &drawn));
    session_field edited = session_field_of(session);
    edit.first = edit.last = 1; /* one sample outlines nothing */
    iso_error error = {0};
    assert_int_equal(iso_session_edit(session, &edit, &error), ISO_ERR_USAGE);
    assert_true(session_is(session, &edited));
    iso_session_destroy(session);

    session = session_open(&(iso_session_opts){.journal = journal, .resume = true, .checkpoint_strokes = -1});
    assert_true(session_is(session, &edited));
    iso_session_destroy(session);
    session_field_free(&drawn);
    session_field_free(&edited);
    session_remove_files(journal);
}

/* A session that was killed while an outline was drawn goes on without it, whether it outlined something yet.
 */
static void half_an_outline_is_left_out(void **state) {
    (void)state;
    const char *journal = session_path("killed.strokes"), *copy = session_path("killed-copy.strokes");
    const iso_brush lasso = {.tool = ISO_TOOL_TRIM_LASSO, .radius = 1};
    const iso_event end = {.kind = ISO_EVENT_END};
    iso_sample path[4];
    rectangle(6, 4, 4, 50, path);
    for (int drawn = 1; drawn <= 4; drawn++) {
        session_remove_files(journal);
        iso_session *session = open_session(journal, NULL);
        draw_some(session);
        session_field before = session_field_of(session);
        assert_int_equal(iso_session_begin(session, &lasso, path, NULL, NULL), ISO_OK);
        for (int i = 1; i < drawn; i++)
            assert_int_equal(iso_session_sample(session, &path[i], NULL, NULL), ISO_OK);
        iso_session_destroy(session);
        unlink(copy);
        assert_int_equal(iso_journal_rewrite(journal, NULL, 0, copy, NULL), ISO_OK);
        session =
            session_open(&(iso_session_opts){.journal = journal, .resume = true, .checkpoint_strokes = -1});
        assert_true(session_is(session, &before));
        draw_some(session); /* it goes on */
        iso_session_destroy(session);
        for (int k = 0; k < 2; k++) { /* and can be resumed again; so can a copy of the file */
            session = session_open(
                &(iso_session_opts){.journal = k ? copy : journal, .resume = true, .checkpoint_strokes = -1});
            assert_int_equal(session_is(session, &before), k == 1);
            assert_int_equal(iso_session_play(session, &end, NULL, NULL), ISO_ERR_USAGE);
            iso_session_destroy(session);
        }
        session_field_free(&before);
    }
    session_remove_files(journal);
    session_remove_files(copy);
}

static void nothing_outlined_is_refused(void **state) {
    (void)state;
    iso_sample path[4];
    const struct {
        iso_tool tool;
        int count;
        const char *says;
        iso_sample samples[4];
    } cases[] = {
        {ISO_TOOL_TRIM_LASSO,
         2,
         "a stroke of 2 samples: it takes at least 3",
         {{.position = {0, 0, 0}, .normal = Z}, {.position = {9, 0, 0}, .normal = Z}}},
        {ISO_TOOL_CROP_LASSO,
         3,
         "encloses nothing",
         {{.position = {0, 0, 0}, .normal = Z},
          {.position = {4, 0, 0}, .normal = Z},
          {.position = {9, 0, 0}, .normal = Z}}},
        {ISO_TOOL_TRIM_PLANE, 1, "it takes at least 2", {{.position = {0, 0, 0}, .normal = Z}}},
        {ISO_TOOL_TRIM_PLANE,
         2,
         "no length",
         {{.position = {1, 0, 0}, .normal = Z}, {.position = {1, 0, 5}, .normal = Z}}},
        {ISO_TOOL_TRIM_PLANE,
         2,
         "opposite",
         {{.position = {0, 0, 0}, .normal = Z}, {.position = {5, 0, 0}, .normal = {0, 0, -1}}}},
        {ISO_TOOL_TRIM_PLANE, 2, "length 0", {{.position = {0, 0, 0}, .normal = Z}, {.position = {5, 0, 0}}}},
        {ISO_TOOL_TRIM_LASSO,
         3,
         "neither parallel nor",
         {{.position = {0, 0, 0}, .normal = {0.6, 0, 0.8}},
          {.position = {4, 0, 0}, .normal = Z},
          {.position = {0, 4, 0}, .normal = {0, 0.6, 0.8}}}}};
    iso_session *session = open_session(NULL, NULL);
    session_field before = session_field_of(session);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_error error = {0};
        const iso_brush brush = {.tool = cases[i].tool, .radius = 1};
        assert_int_equal(draw(session, &brush, cases[i].samples, (size_t)cases[i].count, &error),
                         ISO_ERR_USAGE);
        if (!strstr(error.text, cases[i].says)) fail_msg("case %zu says %s", i, error.text);
        assert_true(session_is(session, &before));
    }
    rectangle(0, 0, 15, 0, path); /* what removes all is no error: it can be undone */
    assert_int_equal(draw(session, &(iso_brush){.tool = ISO_TOOL_TRIM_LASSO, .radius = 1}, path, 4, NULL),
                     ISO_OK);
    assert_int_equal(iso_hgrid_brick_count(iso_session_grid(session)), 0);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(session_is(session, &before));
    session_field_free(&before);
    iso_session_destroy(session);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(distances_are_exact),
                                       cmocka_unit_test(kernels_agree),
                                       cmocka_unit_test(plane_halves_a_ball),
                                       cmocka_unit_test(trim_and_crop_make_a_whole),
                                       cmocka_unit_test(cuts_have_distances),
                                       cmocka_unit_test(blends_round_the_edge),
                                       cmocka_unit_test(symmetry_trims_both_sides),
                                       cmocka_unit_test(frozen_voxels_stay),
                                       cmocka_unit_test(replay_and_edits_give_the_same),
                                       cmocka_unit_test(half_an_outline_is_left_out),
                                       cmocka_unit_test(nothing_outlined_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
