/* Pictures of heights as stamps: they weigh what deforming tools do, turned as the brush says; the same bytes
 * in every kernel, replayed without their file; what is damaged or missing is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/numbers.h"
#include "sculpt/brush/dab.h"
#include "session_support.h"

enum { SIDE = 64, WIDTH = 20, HEIGHT = 12 };

/* White in its upper right quarter, black elsewhere. */
static iso_stamp *make_picture(void) {
    uint16_t values[WIDTH * HEIGHT];
    iso_stamp *stamp;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        values[i] = i % WIDTH >= WIDTH / 2 && i / WIDTH < HEIGHT / 2 ? 65535 : 0;
    assert_int_equal(iso_stamp_from_picture("a/corner.png", WIDTH, HEIGHT, values, &stamp, NULL), ISO_OK);
    return stamp;
}

static iso_session *open_session(const char *journal, iso_pool *pool) {
    return session_open(&(iso_session_opts){.journal = journal, .pool = pool, .checkpoint_strokes = -1});
}

static iso_status draw(iso_session *session, const iso_brush *brush, const iso_vec3 *at, int count,
                       iso_error *error) {
    iso_sample sample = {.pressure = 1};
    for (int i = 0; i < count; i++) {
        sample.position = at[i];
        sample.normal = iso_vec3_unit(at[i]);
        const iso_status status = i ? iso_session_sample(session, &sample, NULL, error)
                                    : iso_session_begin(session, brush, &sample, NULL, error);
        if (status != ISO_OK) return status;
    }
    return iso_session_end(session, error);
}

/* Where a ball of radius 20 voxels was changed: the mean of the changed voxels' positions, from its centre,
 * mm. */
static iso_vec3 changed_at(iso_session *session, int *count) {
    iso_vec3 sum = {0, 0, 0};
    *count = 0;
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const iso_vec3 p = {i % SIDE - 31.5, i / SIDE % SIDE - 31.5, i / SIDE / SIDE - 31.5};
        const double v =
            (double)iso_hgrid_at(iso_session_grid(session), i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
        if (fabs(v) > 2 || fabs(v - (iso_vec3_length(p) - 20)) < 0.1) continue;
        sum = iso_vec3_add(sum, p);
        ++*count;
    }
    return iso_vec3_scale(sum, 0.5 / *count);
}

static const iso_brush INFLATE = {.tool = ISO_TOOL_INFLATE,
                                  .falloff = ISO_FALLOFF_CONSTANT,
                                  .radius = 5,
                                  .strength = 1,
                                  .alpha = ISO_ALPHA_FIXED};

/* At (0, -10, 0), seen from there, z is up and x to the right: the white quarter is there. */
static void pictures_are_upright(void **state) {
    (void)state;
    iso_session *session = open_session(NULL, NULL);
    int count;
    assert_int_equal(iso_session_set_stamp(session, make_picture(), NULL), ISO_OK);
    assert_int_equal(draw(session, &INFLATE, (iso_vec3[]){{0, -10, 0}}, 1, NULL), ISO_OK);
    const iso_vec3 at = changed_at(session, &count);
    print_message("%d voxels were changed around (%.2f, %.2f, %.2f)\n", count, at.x, at.y, at.z);
    assert_true(count > 100 && fabs(at.x - 2.4) < 0.5 && fabs(at.z - 1.4) < 0.5);
    iso_session_destroy(session);
}

/* A stroke to the right turns the picture by a quarter: its upper edge is on the right then, its right one
 * below. */
static void pictures_follow_strokes(void **state) {
    (void)state;
    iso_session *session = open_session(NULL, NULL);
    iso_brush brush = INFLATE;
    int count;
    brush.alpha = ISO_ALPHA_FOLLOWS;
    brush.spacing = 0.1;
    assert_int_equal(iso_session_set_stamp(session, make_picture(), NULL), ISO_OK);
    assert_int_equal(draw(session, &brush, (iso_vec3[]){{0, -10, 0}, {0.6, -9.98, 0}}, 2, NULL), ISO_OK);
    for (int i = 0; i < 4;
         i++) /* (a first sample has no direction: more strokes are made of the second only) */
        assert_int_equal(draw(session, &brush, (iso_vec3[]){{0, -10, 0}, {3, -9.5, 0}}, 2, NULL), ISO_OK);
    const iso_vec3 at = changed_at(session, &count);
    print_message("%d voxels were changed around (%.2f, %.2f, %.2f)\n", count, at.x, at.y, at.z);
    assert_true(count > 100 && at.x > 1.5 && at.z < -0.3);
    iso_session_destroy(session);
}

/* The kernel against the picture, interpolated in double precision; every unit gives the same bytes. */
static void weights_are_heights(void **state) {
    (void)state;
    static float phi[ISO_BRICK_VOXELS], got[ISO_BRICK_VOXELS], first[ISO_BRICK_VOXELS];
    uint16_t values[WIDTH * HEIGHT];
    const iso_stencil stencil = {.self = phi, .face = {phi, phi, phi, phi, phi, phi}};
    const iso_transform transform = iso_transform_identity();
    const iso_affine affine = iso_transform_affine(&transform);
    uint32_t seed = 9;
    static iso_dabs dabs;
    double worst = 0;
    int weighed = 0;
    for (int round = 0; round < 50; round++) {
        iso_stamp *stamp;
        for (int i = 0; i < WIDTH * HEIGHT; i++) values[i] = (uint16_t)(65535 * uniform(&seed));
        assert_int_equal(iso_stamp_from_picture("x.png", WIDTH, HEIGHT, values, &stamp, NULL), ISO_OK);
        iso_brush brush = INFLATE;
        brush.radius = 6 + 6 * uniform(&seed);
        iso_sample sample = {.position = {8 * uniform(&seed), 8 * uniform(&seed), 8}, .pressure = 1};
        sample.normal =
            iso_vec3_unit(iso_vec3_make(uniform(&seed) - 0.5, uniform(&seed) - 0.5, uniform(&seed)));
        const iso_touch touch = {.sample = sample, .previous = sample, .first = sample};
        iso_dabs_make(&(iso_dab_space){.affine = &affine, .spacing = 1, .band = 3, .stamp = stamp}, &brush,
                      &touch, &dabs);
        for (int level = 0; level <= (int)iso_cpu_best(); level++) {
            iso_dab_kernel_get((iso_cpu_level)level)->edit(&dabs, (const int[]){0, 0, 0}, &stencil, got);
            if (level == 0) memcpy(first, got, sizeof got);
            assert_memory_equal(first, got, sizeof got);
        }
        const iso_dab *dab = &dabs.dab[0];
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            const double at[3] = {i % 16, i / 16 % 16, i / 256};
            double p[2] = {0, 0}, square = 0, height = 0;
            for (int k = 0; k < 3; k++) {
                const double d = at[k] - dab->centre[k];
                square += d * d;
                for (int a = 0; a < 2; a++) p[a] += d * dab->axis[a][k];
            }
            if (fabs(sqrt(square) - brush.radius) < 1e-3) continue;
            const double x = p[0] / brush.radius * WIDTH / 2 + WIDTH / 2.0 - 0.5,
                         y = HEIGHT / 2.0 - 0.5 - p[1] / brush.radius * WIDTH / 2;
            for (int c = 0; c < 4; c++) {
                const int column = (int)floor(x) + c % 2, row = (int)floor(y) + c / 2;
                if (column < 0 || column >= WIDTH || row < 0 || row >= HEIGHT) continue;
                height += (1 - fabs(x - column)) * (1 - fabs(y - row)) * values[row * WIDTH + column] / 65535;
            }
            const double wanted = sqrt(square) < brush.radius ? -height * (double)dabs.strength : 0;
            worst = fmax(worst, fabs(wanted - (double)got[i]));
            weighed += wanted < 0;
        }
        iso_stamp_free(stamp);
    }
    print_message("heights differ by at most %.2g voxel\n", worst);
    assert_true(worst < 1e-3 && weighed > 10000);
}

/* ---- files */

static void draw_some(iso_session *session) {
    iso_brush brush = INFLATE;
    assert_int_equal(iso_session_set_stamp(session, make_picture(), NULL), ISO_OK);
    assert_int_equal(draw(session, &brush, (iso_vec3[]){{0, -10, 0}, {3, -9.5, 0}}, 2, NULL), ISO_OK);
    brush.tool = ISO_TOOL_CLAY;
    brush.alpha = ISO_ALPHA_FOLLOWS;
    brush.radial = 5;
    brush.symmetry = 1;
    assert_int_equal(draw(session, &brush, (iso_vec3[]){{9, 2, 3}, {8, 3, 4}, {7, 4, 5}}, 3, NULL), ISO_OK);
    brush.alpha = ISO_ALPHA_NONE;
    assert_int_equal(draw(session, &brush, (iso_vec3[]){{0, 2, 9.5}}, 1, NULL), ISO_OK);
}

static void replay_needs_no_picture(void **state) {
    (void)state;
    const char *journal = session_path("alpha.strokes");
    session_field drawn;
    iso_session *session = session_drawn(journal, draw_some, &drawn);
    iso_event edit = {.kind = ISO_EVENT_EDIT, .first = 1, .last = 1, .brush = INFLATE};
    edit.brush.alpha = ISO_ALPHA_FOLLOWS;
    assert_int_equal(iso_session_edit(session, &edit, NULL), ISO_OK);
    assert_false(session_is(session, &drawn));
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(session_is(session, &drawn));
    iso_session_destroy(session);
    session = session_open(&(iso_session_opts){.journal = journal, .resume = true, .checkpoint_strokes = -1});
    assert_true(session_is(session, &drawn));
    assert_string_equal(iso_session_stamp(session)->name, "corner.png");
    iso_session_destroy(session);
    session_field_free(&drawn);
    session_remove_files(journal);
}

static void large_pictures_are_averaged(void **state) {
    (void)state;
    enum { W = 600, H = 301 };
    uint16_t *values = malloc(W * H * sizeof *values);
    iso_stamp *stamp;
    for (int i = 0; i < W * H; i++) values[i] = (uint16_t)(i % W * 100 + i / W % 2);
    assert_int_equal(iso_stamp_from_picture("large.png", W, H, values, &stamp, NULL), ISO_OK);
    assert_int_equal(stamp->heights.width, 200);
    assert_int_equal(stamp->heights.height, 101);
    assert_true(fabsf(stamp->heights.value[202 + 1] * 65535 - 100) < 1); /* the mean of 0, 100 and 200 */
    iso_stamp_free(stamp);
    free(values);
}

static void what_is_missing_is_refused(void **state) {
    (void)state;
    iso_session *session = open_session(NULL, NULL);
    session_field before = session_field_of(session);
    iso_error error = {0};
    assert_int_equal(draw(session, &INFLATE, (iso_vec3[]){{0, -10, 0}}, 1, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "needs a picture"));
    assert_int_equal(iso_session_set_stamp(session, make_picture(), NULL), ISO_OK);
    const iso_brush solid = {.tool = ISO_TOOL_ADD, .shape = ISO_SOLID_STAMP, .radius = 3};
    assert_int_equal(draw(session, &solid, (iso_vec3[]){{0, -10, 0}}, 1, &error), ISO_ERR_USAGE);
    assert_true(session_is(session, &before));
    iso_stamp *stamp = NULL;
    assert_int_equal(iso_stamp_parse_picture("x", 2, 2, "AAAAAAAAAAA=", &stamp, &error), ISO_OK);
    iso_stamp_free(stamp);
    assert_int_equal(iso_stamp_parse_picture("x", 2, 3, "AAAAAAAAAAA=", &stamp, &error), ISO_ERR_FORMAT);
    assert_int_equal(iso_stamp_parse_picture("x", 2, 2, "AAAA*AAAAAA=", &stamp, &error), ISO_ERR_FORMAT);
    session_field_free(&before);
    iso_session_destroy(session);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_upright),        cmocka_unit_test(pictures_follow_strokes),
        cmocka_unit_test(weights_are_heights),         cmocka_unit_test(replay_needs_no_picture),
        cmocka_unit_test(large_pictures_are_averaged), cmocka_unit_test(what_is_missing_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
