/* Many random strokes with every tool, and undo and redo between them. After each stroke the invariants of a
 * field and the effects of the tool are checked; at the end the journal must replay to the same bits.
 * ISO_TEST_STROKES sets the number of strokes; the default is 120. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/crc32c.h"
#include "session_support.h"

enum { SIDE = 64, VOXELS = SIDE * SIDE * SIDE, SNAPSHOT = 40, RESUME = 110, MOST_SAMPLES = 64 };

/* A stroke as the test knows it, in voxels: its way, segment by segment. */
typedef struct stroke {
    iso_brush brush;
    iso_vec3 from[MOST_SAMPLES], at[MOST_SAMPLES], last; /* last: where the brush touched last */
    int samples;
} stroke;

typedef struct stress {
    iso_session *session;
    const char *journal;
    uint32_t *state; /* by the history's position: checksum of field and mask */
    float *before, *now;
    stroke stroke;
    size_t strokes, undone, redone, cancelled, clamped, checked, held;
} stress;

static uint32_t checksum(iso_session *session) {
    const iso_hgrid *grid = iso_session_grid(session);
    const iso_mask *mask = &iso_session_items(session)->of[ISO_ITEM_MASK];
    uint32_t crc = 0;
    for (size_t i = 0; i < mask->cells; i++) {
        const int32_t state = grid->cell[i] < 0 ? grid->cell[i] : 0;
        const iso_voxel_bits *bits = iso_mask_bits(mask, i);
        crc = iso_crc32c(crc, &state, sizeof state);
        if (!state)
            crc = iso_crc32c(crc, iso_hgrid_brick(grid, grid->cell[i]), ISO_BRICK_VOXELS * sizeof(float));
        if (bits) crc = iso_crc32c(crc, bits, sizeof *bits);
    }
    return crc;
}

static void read_field(const iso_hgrid *grid, float *values) {
    for (int i = 0; i < VOXELS; i++)
        values[i] = iso_hgrid_at(grid, i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
}

static bool is_masked(const stress *s, int i) {
    const int x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
    size_t cell = iso_hgrid_cell_index(iso_session_grid(s->session), x / 16, y / 16, z / 16);
    const iso_voxel_bits *bits = iso_mask_bits(&iso_session_items(s->session)->of[ISO_ITEM_MASK], cell);
    return bits && bits->row[z % 16 * 16 + y % 16] >> (x % 16) & 1;
}

/* ---- what every field is */

static void check_bricks(const iso_hgrid *grid) {
    for (int i = 0; i < 64; i++) {
        if (grid->cell[i] < 0) continue;
        const float *brick = iso_hgrid_brick(grid, grid->cell[i]);
        int outside = 0, inside = 0;
        for (int k = 0; k < ISO_BRICK_VOXELS; k++) {
            if (!(fabsf(brick[k]) <= grid->band)) fail_msg("cell %d: a value of %g", i, (double)brick[k]);
            outside += brick[k] == grid->band;
            inside += brick[k] == -grid->band;
        }
        if (outside == ISO_BRICK_VOXELS || inside == ISO_BRICK_VOXELS)
            fail_msg("cell %d holds a brick and is empty", i);
    }
}

/* The surface never runs along an empty cell's border: what lies beside the cell is on its side. */
static void check_empty_cells(const stress *s) {
    const iso_hgrid *grid = iso_session_grid(s->session);
    static const int step[3] = {1, SIDE, SIDE * SIDE};
    for (int i = 0; i < VOXELS; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int axis = 0; axis < 3; axis++) {
            if (at[axis] % 16 != 15 || at[axis] == SIDE - 1) continue;
            int next[3] = {at[0] / 16, at[1] / 16, at[2] / 16};
            const int32_t here = grid->cell[iso_hgrid_cell_index(grid, next[0], next[1], next[2])];
            next[axis]++;
            const int32_t there = grid->cell[iso_hgrid_cell_index(grid, next[0], next[1], next[2])];
            if ((here < 0 || there < 0) && (s->now[i] < 0) != (s->now[i + step[axis]] < 0))
                fail_msg("stroke %zu: the surface passes an empty cell at (%d, %d, %d)", s->strokes, at[0],
                         at[1], at[2]);
        }
    }
}

/* Central differences of voxels at 0 .. sqrt 3, where foot points are made, see no clamped value. */
static void count_clamped(stress *s) {
    static const int step[3] = {1, SIDE, SIDE * SIDE};
    const float band = iso_session_grid(s->session)->band;
    for (int i = 0; i < VOXELS; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        if (!(s->now[i] >= 0 && s->now[i] < 1.7320508f)) continue;
        bool clamped = false, within = true;
        for (int axis = 0; axis < 3; axis++) {
            within &= at[axis] > 0 && at[axis] < SIDE - 1;
            clamped |=
                within && (fabsf(s->now[i - step[axis]]) >= band || fabsf(s->now[i + step[axis]]) >= band);
        }
        s->checked += within;
        s->clamped += within && clamped;
    }
}

/* ---- what the tool may have done */

/* From a voxel to the way of a stroke (of its mirrored ones too), in voxels. */
static double way_distance(const stroke *w, const int at[3]) {
    double least = 1e9;
    for (unsigned bits = 0; bits < 8; bits++) {
        if (bits & ~w->brush.symmetry) continue;
        /* (the mirrors pass through the world's origin: the grid's centre) */
        const iso_vec3 p = {bits & 1 ? SIDE - 1 - at[0] : at[0], bits & 2 ? SIDE - 1 - at[1] : at[1],
                            bits & 4 ? SIDE - 1 - at[2] : at[2]};
        for (int k = 0; k < w->samples; k++) {
            const iso_vec3 way = iso_vec3_sub(w->at[k], w->from[k]), to = iso_vec3_sub(p, w->from[k]);
            double square = iso_vec3_dot(way, way), t = square > 0 ? iso_vec3_dot(to, way) / square : 0;
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            least = fmin(least, iso_vec3_length(iso_vec3_sub(to, iso_vec3_scale(way, t))));
        }
    }
    return least;
}

/* The farthest that a tool of this shape can change a sign, in radii (aspect is half, the blend a quarter).
 */
static double sign_reach(const iso_brush *brush) {
    static const double reach[ISO_SOLID_COUNT] = {[ISO_SOLID_SPHERE] = 1,
                                                  [ISO_SOLID_BOX] = 1.2248,
                                                  [ISO_SOLID_CAPSULE] = 1,
                                                  [ISO_SOLID_CYLINDER] = 1.1181,
                                                  [ISO_SOLID_TORUS] = 1.5};
    if (brush->tool > ISO_TOOL_BLEND_CARVE) return 1;
    bool blends = brush->tool == ISO_TOOL_BLEND_ADD || brush->tool == ISO_TOOL_BLEND_CARVE;
    return reach[brush->shape] + (blends ? 0.25 : 0);
}

/* -1: nothing becomes inside; 1: nothing becomes outside; 0: both may. */
static int side_of(iso_tool tool) {
    switch (tool) {
    case ISO_TOOL_ADD:
    case ISO_TOOL_BLEND_ADD:
    case ISO_TOOL_INFLATE:
        return 1;
    case ISO_TOOL_CARVE:
    case ISO_TOOL_BLEND_CARVE:
    case ISO_TOOL_DEFLATE:
        return -1;
    default:
        return 0;
    }
}

/* The bit model: what is inside after the stroke, where that is known without the field: 1, 0; -1: not known.
 */
static int modelled(const stroke *w, bool before, double distance, double radius) {
    const iso_tool tool = w->brush.tool;
    if (tool >= ISO_TOOL_MASK) return before; /* the mask's tools do not change the field */
    if (distance > sign_reach(&w->brush) * radius + 0.01) return before;
    if (side_of(tool) == (before ? 1 : -1)) return before;
    const bool ball = w->brush.shape == ISO_SOLID_SPHERE || w->brush.shape == ISO_SOLID_CAPSULE;
    if (tool > ISO_TOOL_CARVE || !ball || fabs(distance - radius) < 0.01) return -1;
    if (distance > radius) return before;
    return w->brush.shape == ISO_SOLID_CAPSULE || w->samples == 1 ? tool == ISO_TOOL_ADD : -1;
}

/* Whether the surface passes between a frozen voxel and another one beside it. */
static bool holds_surface(const stress *s, int i) {
    static const int step[3] = {1, SIDE, SIDE * SIDE};
    const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
    for (int face = 0; face < 6; face++) {
        const int axis = face / 2, up = face % 2, other = i + (up ? step[axis] : -step[axis]);
        if (at[axis] == (up ? SIDE - 1 : 0)) continue;
        if ((s->before[i] < 0) != (s->before[other] < 0) && is_masked(s, other)) return true;
    }
    return false;
}

/* What is frozen stays on its side, and the surface where it is. */
static void check_frozen(stress *s, int i, bool all) {
    const bool held = holds_surface(s, i);
    s->held += held;
    if (all || held ? s->now[i] != s->before[i] : (s->now[i] < 0) != (s->before[i] < 0))
        fail_msg("stroke %zu (%s): frozen voxel (%d, %d, %d) was %g and is %g", s->strokes,
                 iso_tool_name(s->stroke.brush.tool), i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE,
                 (double)s->before[i], (double)s->now[i]);
}

static void check_stroke(stress *s) {
    const stroke *w = &s->stroke;
    const double radius = w->brush.radius / SESSION_START.voxel_size;
    const bool masks = w->brush.tool >= ISO_TOOL_MASK;
    for (int i = 0; i < VOXELS; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        const bool frozen = masks || is_masked(s, i);
        if (frozen) check_frozen(s, i, masks);
        const bool same = (s->now[i] < 0) == (s->before[i] < 0);
        if (frozen || (same && w->brush.tool > ISO_TOOL_CARVE)) continue;
        const int wanted = modelled(w, s->before[i] < 0, way_distance(w, at), radius);
        if (wanted >= 0 && wanted != (s->now[i] < 0))
            fail_msg("stroke %zu (%s %s): voxel (%d, %d, %d) was %g, is %g and should be %s", s->strokes,
                     iso_tool_name(w->brush.tool), iso_solid_name(w->brush.shape), at[0], at[1], at[2],
                     (double)s->before[i], (double)s->now[i], wanted ? "inside" : "outside");
    }
}

/* ---- playing */

/* The brush touches every quarter of its radius on the way from its last touch; MOVE and capsules reach back
 * by themselves. */
static void note(stress *s, const iso_event *event) {
    stroke *w = &s->stroke;
    const double voxel = SESSION_START.voxel_size;
    const iso_vec3 at = iso_vec3_scale(iso_vec3_sub(event->sample.position, SESSION_START.origin), 1 / voxel);
    if (event->kind == ISO_EVENT_BEGIN) {
        *w = (stroke){.brush = event->brush, .last = at};
        read_field(iso_session_grid(s->session), s->before);
    }
    assert_true(w->samples < MOST_SAMPLES);
    w->from[w->samples] = w->brush.tool == ISO_TOOL_MOVE && w->samples ? w->from[0] : w->last;
    w->at[w->samples++] = at;
    const iso_vec3 way = iso_vec3_sub(at, w->last);
    const double spacing = 0.25 * w->brush.radius / voxel, length = iso_vec3_length(way);
    const bool whole = w->brush.tool == ISO_TOOL_MOVE ||
                       (w->brush.tool <= ISO_TOOL_BLEND_CARVE && w->brush.shape == ISO_SOLID_CAPSULE);
    if (whole || length == 0)
        w->last = at;
    else
        w->last = iso_vec3_add(w->last, iso_vec3_scale(way, floor(length / spacing) * spacing / length));
}

/* A stroke that changed nothing makes no step. */
static void ended(stress *s, size_t position) {
    size_t now = iso_history_position(iso_session_history(s->session));
    read_field(iso_session_grid(s->session), s->now);
    check_bricks(iso_session_grid(s->session));
    check_empty_cells(s);
    check_stroke(s);
    count_clamped(s);
    assert_true(now == position || now == position + 1);
    uint32_t sum = checksum(s->session);
    if (now == position) assert_int_equal(sum, s->state[now]);
    s->state[now] = sum;
    s->strokes++;
}

static void play(stress *s, const iso_event *event) {
    const iso_history *history = iso_session_history(s->session);
    const size_t position = iso_history_position(history);
    const bool can_undo = position > 0, can_redo = position < iso_history_count(history);
    iso_error error = {0};
    if (event->kind <= ISO_EVENT_SAMPLE) note(s, event);
    iso_status status = iso_session_play(s->session, event, NULL, &error);
    bool possible = event->kind == ISO_EVENT_UNDO ? can_undo : event->kind != ISO_EVENT_REDO || can_redo;
    if (status != (possible ? ISO_OK : ISO_ERR_USAGE)) fail_msg("event %d: %s", event->kind, error.text);
    if (event->kind == ISO_EVENT_END)
        ended(s, position);
    else if (event->kind > ISO_EVENT_END)
        assert_int_equal(checksum(s->session), s->state[iso_history_position(history)]);
    s->undone += event->kind == ISO_EVENT_UNDO && possible;
    s->redone += event->kind == ISO_EVENT_REDO && possible;
    s->cancelled += event->kind == ISO_EVENT_CANCEL;
}

/* Closes the session and continues it: the history then begins at the last snapshot. */
static void resume(stress *s) {
    const iso_session_opts opts = {
        .journal = s->journal, .resume = true, .checkpoint_strokes = SNAPSHOT, .undo_memory = 1 << 20};
    const iso_history *history = iso_session_history(s->session);
    const size_t position = iso_history_position(history), count = iso_history_count(history);
    iso_session_destroy(s->session);
    s->session = session_open(&opts);
    history = iso_session_history(s->session);
    const size_t lost = position - iso_history_position(history);
    assert_true(iso_history_position(history) <= position);
    assert_int_equal(iso_history_count(history) + lost, count);
    memmove(s->state, s->state + lost, (count + 1 - lost) * sizeof *s->state);
    assert_int_equal(checksum(s->session), s->state[iso_history_position(history)]);
}

/* With the first `tools` tools. */
static stress play_strokes(int tools) {
    const char *text = getenv("ISO_TEST_STROKES");
    const size_t wanted = text ? strtoul(text, NULL, 10) : 120;
    stress s = {.journal = session_path("stress.strokes")};
    const iso_session_opts opts = {.journal = s.journal,
                                   .checkpoint_strokes = SNAPSHOT,
                                   .undo_memory = 1 << 20},
                           plain = {0};
    session_remove_files(s.journal);
    s.session = session_open(&opts);
    s.state = calloc(wanted + 2, sizeof *s.state);
    s.before = malloc(VOXELS * sizeof(float));
    s.now = malloc(VOXELS * sizeof(float));
    assert_true(s.state && s.before && s.now);
    s.state[0] = checksum(s.session);
    uint32_t seed = 2003;
    bool drawing = false;
    for (size_t next = RESUME; s.strokes < wanted;) {
        const iso_event event = session_random_event(&seed, tools, &drawing);
        play(&s, &event);
        if (drawing || s.strokes < next) continue;
        resume(&s);
        next += RESUME;
    }
    print_message("%zu strokes (%zu cancelled, %zu undone, %zu redone), %zu of %zu stencils clamped, %zu "
                  "frozen values\n",
                  s.strokes, s.cancelled, s.undone, s.redone, s.clamped, s.checked, s.held);
    resume(&s);
    session_field field = session_field_of(s.session);
    iso_session_destroy(s.session);
    s.session = session_open(&plain);
    iso_journal_start start;
    iso_journal_reader *reader;
    assert_int_equal(iso_journal_open(s.journal, &start, &reader, NULL), ISO_OK);
    iso_event event;
    bool more = true;
    while (iso_journal_next(reader, &event, &more, NULL) == ISO_OK && more)
        assert_int_equal(iso_session_play(s.session, &event, NULL, NULL), ISO_OK);
    iso_journal_reader_free(reader);
    assert_true(session_is(s.session, &field));
    iso_session_destroy(s.session);
    session_field_free(&field);
    session_remove_files(s.journal);
    free(s.state);
    free(s.before);
    free(s.now);
    return s;
}

static void strokes_keep_the_field_sound(void **state) {
    (void)state;
    const stress s = play_strokes(ISO_TOOL_MASK);
    assert_true(s.checked > 100000 && s.undone > s.strokes / 10 && s.redone > 0 && s.cancelled > 0);
    assert_int_equal(s.clamped, 0);
}

static void masked_strokes_keep_the_field_sound(void **state) {
    (void)state;
    const stress s = play_strokes(ISO_TOOL_TRIM_PLANE);
    assert_true(s.checked > 100000 && s.held > 1000);
    assert_int_equal(s.clamped, 0);
}

/* An argument is the name of the only test to run: 10,000 strokes take an hour. */
int main(int argc, char **argv) {
    if (argc > 1) cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(strokes_keep_the_field_sound),
                                       cmocka_unit_test(masked_strokes_keep_the_field_sound)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
