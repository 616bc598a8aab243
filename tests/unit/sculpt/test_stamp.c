/* Stamps: a mesh as the solid of a brush, stored in the journal and replayed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "extract/mesh/mesh.h"
#include "session_support.h"

/* The vertices and triangles of a ball that is not where a stamp will be. */
typedef struct ball_mesh {
    iso_triangles triangles;
} ball_mesh;

static ball_mesh make_mesh(void) {
    enum { RINGS = 96, SLICES = 192 };
    ball_mesh ball = {{calloc((RINGS + 1) * SLICES, 3 * sizeof(float)),
                       calloc(2 * RINGS * SLICES, 3 * sizeof(uint32_t)), (RINGS + 1) * SLICES, 0, NULL}};
    assert_non_null(ball.triangles.vertices);
    assert_non_null(ball.triangles.triangles);
    for (int i = 0; i <= RINGS; i++)
        for (int k = 0; k < SLICES; k++) {
            const double tilt = ISO_PI * i / RINGS, turn = 2 * ISO_PI * k / SLICES;
            float *v = ball.triangles.vertices[i * SLICES + k];
            v[0] = (float)(100 + 7 * sin(tilt) * cos(turn));
            v[1] = (float)(-50 + 7 * sin(tilt) * sin(turn));
            v[2] = (float)(7 * cos(tilt));
        }
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t k = 0; k < SLICES; k++) {
            const uint32_t next = (k + 1) % SLICES, a = i * SLICES + k, b = i * SLICES + next,
                           c = (i + 1) * SLICES + k, d = (i + 1) * SLICES + next;
            uint32_t *t = ball.triangles.triangles[ball.triangles.triangle_count];
            const uint32_t corners[6] = {a, c, b, b, c, d};
            memcpy(t, corners, sizeof corners);
            ball.triangles.triangle_count += 2;
        }
    return ball;
}

static iso_status stamp_of(const char *path, const iso_triangles *mesh, iso_pool *pool, iso_stamp **stamp,
                           iso_error *error) {
    const iso_closing_opts opts = {0};
    iso_closed_mesh *closed;
    ISO_TRY(iso_closed_mesh_create(path, mesh, &opts, &closed, error));
    iso_status status = iso_stamp_from_mesh(path, closed, pool, NULL, stamp, error);
    iso_closed_mesh_destroy(closed);
    return status;
}

/* Of a ball that lacks some of its triangles. */
static iso_stamp *make_open_stamp(size_t missing, iso_pool *pool) {
    ball_mesh ball = make_mesh();
    iso_stamp *stamp = NULL;
    iso_error error = {0};
    ball.triangles.triangle_count -= missing;
    if (stamp_of("folder/b\xc3\xa4ll.stl", &ball.triangles, pool, &stamp, &error) != ISO_OK)
        fail_msg("%s", error.text);
    free(ball.triangles.vertices);
    free(ball.triangles.triangles);
    return stamp;
}

static iso_stamp *make_stamp(void) {
    return make_open_stamp(0, NULL);
}

static void stamps_are_text_and_back(void **state) {
    (void)state;
    iso_stamp *stamp = make_stamp(), *again = NULL;
    assert_int_equal(stamp->count, ISO_STAMP_LEVELS);
    assert_string_equal(stamp->name, "b__ll.stl");
    assert_ptr_equal(iso_stamp_level(stamp, 1), stamp->level[0]);
    assert_ptr_equal(iso_stamp_level(stamp, 32.1), stamp->level[3]);
    assert_ptr_equal(iso_stamp_level(stamp, 1000), stamp->level[4]);
    char *text = iso_stamp_text(stamp);
    assert_non_null(text);
    print_message("%zu bytes of text\n", strlen(text));
    assert_int_equal(iso_stamp_parse("ball.stl", text, &again, NULL), ISO_OK);
    assert_int_equal(again->count, stamp->count);
    for (int i = 0; i < stamp->count; i++) {
        assert_true(sculpt_same(stamp->level[i], again->level[i]));
        assert_memory_equal(&stamp->level[i]->transform, &again->level[i]->transform, sizeof(iso_transform));
    }
    iso_stamp_free(again);
    char *other = iso_stamp_text(stamp);
    assert_string_equal(text, other);
    free(other);
    /* damage: what is taken all the same has only another place or size */
    uint32_t seed = 1;
    const size_t length = strlen(text);
    for (int i = 0; i < 150; i++) {
        const size_t at = i < 100 ? (size_t)i : (size_t)(uniform(&seed) * (double)length);
        const char before = text[at];
        text[at] = before == 'A' ? 'Q' : 'A';
        iso_status status = iso_stamp_parse("ball.stl", text, &again, NULL);
        assert_true(status == ISO_ERR_FORMAT || (status == ISO_OK && i < 100));
        if (status == ISO_OK) iso_stamp_free(again);
        text[at] = before;
    }
    for (int i = 0; i < 20; i++) {
        const size_t at = (size_t)(uniform(&seed) * (double)length);
        const char before = text[at];
        text[at] = i % 2 ? '*' : 0;
        assert_int_equal(iso_stamp_parse("ball.stl", text, &again, NULL), ISO_ERR_FORMAT);
        text[at] = before;
    }
    free(text);
    iso_stamp_free(stamp);
}

static const iso_sample SAMPLE = {.position = {3, 2, 9}, .normal = {0.36, 0.48, 0.8}, .pressure = 1};

static void stroke(iso_session *session, const iso_brush *brush) {
    assert_int_equal(iso_session_begin(session, brush, &SAMPLE, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
}

/* The mesh of a ball does what the brush's own ball does, at all sizes. */
static void balls_are_balls(void **state) {
    (void)state;
    iso_stamp *stamp = make_stamp();
    const double radii[] = {1.7, 3, 6, 9};
    for (int i = 0; i < 4; i++)
        for (int carve = 0; carve < 2; carve++) {
            iso_session_opts opts = {0};
            iso_session *wanted = session_open(&opts), *got = session_open(&opts);
            iso_brush brush = {.tool = carve ? ISO_TOOL_CARVE : ISO_TOOL_ADD, .radius = radii[i]};
            stroke(wanted, &brush);
            assert_int_equal(iso_session_set_stamp(got, iso_stamp_share(stamp), NULL), ISO_OK);
            brush.shape = ISO_SOLID_STAMP;
            stroke(got, &brush);
            const iso_hgrid *a = iso_session_grid(wanted), *b = iso_session_grid(got);
            double most = 0;
            for (int v = 0; v < 64 * 64 * 64; v++) {
                const float x = iso_hgrid_at(a, v % 64, v / 64 % 64, v / 4096),
                            y = iso_hgrid_at(b, v % 64, v / 64 % 64, v / 4096);
                if (fabsf(x) < 1) most = fmax(most, fabs((double)(x - y)));
            }
            if (most > 0.15) fail_msg("radius %g, carve %d: off by %g voxels", radii[i], carve, most);
            iso_session_destroy(wanted);
            iso_session_destroy(got);
        }
    iso_stamp_free(stamp);
}

static void play(iso_session *session, uint32_t *seed, int events) {
    bool drawing = false;
    for (int i = 0; i < events; i++) {
        iso_event event = session_random_event(seed, ISO_TOOL_BLEND_CARVE + 1, &drawing);
        event.brush.shape = ISO_SOLID_STAMP;
        event.brush.spacing = 1;
        event.brush.radius /= 2;
        iso_session_play(session, &event, NULL, NULL);
    }
    if (drawing) assert_int_equal(iso_session_end(session, NULL), ISO_OK);
}

/* Without the mesh, with snapshots before and after the stamp came, and with as many threads as you like. */
static void journals_hold_their_stamps(void **state) {
    (void)state;
    iso_stamp *stamp = make_stamp();
    for (int checkpoints = -1; checkpoints < 4; checkpoints += 2) {
        const char *journal = session_path("stamped.strokes");
        session_remove_files(journal);
        uint32_t seed = 8;
        iso_session_opts opts = {.journal = journal, .checkpoint_strokes = checkpoints};
        iso_session *session = session_open(&opts);
        session_field start = session_field_of(session);
        assert_int_equal(iso_session_set_stamp(session, iso_stamp_share(stamp), NULL), ISO_OK);
        play(session, &seed, 40);
        session_field wanted = session_field_of(session);
        size_t steps = iso_history_position(iso_session_history(session));
        while (iso_session_undo(session, NULL) == ISO_OK) {
        }
        assert_true(session_is(session, &start));
        for (; steps; steps--) assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
        assert_true(session_is(session, &wanted));
        iso_session_destroy(session);
        opts.resume = true;
        for (int threads = 1; threads < 4; threads += 2) {
            assert_int_equal(iso_pool_create(threads, &opts.pool, NULL), ISO_OK);
            session = session_open(&opts);
            assert_true(session_is(session, &wanted));
            assert_non_null(iso_session_stamp(session));
            iso_session_destroy(session);
            iso_pool_destroy(opts.pool);
        }
        opts.pool = NULL;
        session_field_free(&start);
        session_field_free(&wanted);
        session_remove_files(journal);
    }
    iso_stamp_free(stamp);
}

static void open_meshes_are_no_stamps(void **state) {
    (void)state;
    iso_stamp *none;
    float vertices[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t corners[1][3] = {{0, 1, 2}};
    const iso_triangles open = {vertices, corners, 3, 1, NULL};
    iso_error error = {0};
    assert_int_equal(stamp_of("open.stl", &open, NULL, &none, &error), ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "open.stl"));
    assert_non_null(strstr(error.text, "3 open edges"));
    memset(vertices, 0, sizeof vertices);
    assert_int_equal(stamp_of("open.stl", &open, NULL, &none, &error), ISO_ERR_EMPTY);
}

/* A ball without a piece of its last ring is a stamp all the same, on any number of threads. */
static void open_balls_are_balls(void **state) {
    (void)state;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    iso_stamp *whole = make_stamp(), *open = make_open_stamp(101, NULL), *again = make_open_stamp(101, pool);
    assert_int_equal(open->count, ISO_STAMP_LEVELS);
    for (int i = 0; i < open->count; i++) {
        const iso_hgrid *grid = open->level[i], *wanted = whole->level[i];
        assert_true(sculpt_same(grid, again->level[i]));
        assert_memory_equal(grid->dims, wanted->dims, sizeof grid->dims);
        for (int z = 0; z < grid->dims[2]; z++)
            for (int y = 0; y < grid->dims[1]; y++)
                for (int x = 0; x < grid->dims[0]; x++)
                    assert_true(fabsf(iso_hgrid_at(grid, x, y, z) - iso_hgrid_at(wanted, x, y, z)) < 0.2f);
    }
    iso_stamp_free(whole);
    iso_stamp_free(open);
    iso_stamp_free(again);
    iso_pool_destroy(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(open_balls_are_balls), cmocka_unit_test(stamps_are_text_and_back),
        cmocka_unit_test(balls_are_balls), cmocka_unit_test(journals_hold_their_stamps),
        cmocka_unit_test(open_meshes_are_no_stamps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
