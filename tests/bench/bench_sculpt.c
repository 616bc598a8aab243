/* What a touch of the brush costs, from the hand to new points: against OpenVDB doing the same to the whole
 * field, or to the brush's box, and against the same touch without keeping the field a distance field. */
#include <math.h>
#include <stdlib.h>

#include "base/numbers.h"
#include "bench_harness.h"
#include "bench_peers.h"
#include "bench_scenes.h"
#include "extract/points/points.h"
#include "sculpt/edit/edit.h"
#include "sculpt/session/history.h"

/* A stroke is so many touches, a quarter of the radius apart; then it is undone and the next begins
 * elsewhere. A turn is always the same number of strokes, however long they take: rows that are compared with
 * each other make the same touches. */
enum { STROKE = 24, TURN = 4 * STROKE, PLACES = 512, TIMES = 65536 };
/* Bricks made ready between strokes, as a session does. */
enum { RESERVE = 256 };

typedef struct sculpting {
    iso_hgrid *grid; /* borrowed */
    iso_editor *editor;
    iso_history *history;
    iso_point_set *set;
    bench_volume_to_mesh *peer;
    iso_vec3 places[PLACES];
    int place_count, stroke, step;
    double *times, *cpu; /* of each touch: by the clock, and what it took of the processor */
    int time_count;
    double end_cpu; /* of all strokes' ends */
} sculpting;

typedef enum sculpt_kind { KEEPS_DISTANCES, SET_ONLY, PEER_WHOLE, PEER_CLIPPED } sculpt_kind;

typedef struct sculpt_plan {
    sculpt_kind kind;
    int radius;
} sculpt_plan;

static iso_status open_ours(bench_row *row, sculpting *work, const sculpt_plan *plan, iso_error *error) {
    (void)row;
    iso_editor_opts editor = {.iterations = plan->kind == SET_ONLY ? -1 : 0};
    iso_history_opts history = {0};
    work->times = calloc(TIMES, sizeof *work->times);
    work->cpu = calloc(TIMES, sizeof *work->cpu);
    if (!work->times || !work->cpu) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    ISO_TRY(iso_editor_create(work->grid, &editor, &work->editor, error));
    return iso_history_create(work->grid, &history, &work->history, error);
}

static iso_status open_sculpt(bench_row *row, iso_error *error) {
    const sculpt_plan *plan = row->plan;
    iso_grid *head = NULL;
    ISO_TRY(bench_scene_head(row->bench->scenes, row->size, &head, error));
    sculpting *work = calloc(1, sizeof *work);
    if (!work) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = work;
    work->grid = head->hgrid;
    iso_points_opts opts = {.isovalue = 0};
    ISO_TRY(iso_point_set_create(head, &opts, &work->set, error));
    ISO_TRY(iso_point_set_update(work->set, error));
    work->place_count = bench_scatter_places(work->set, work->places, PLACES);
    if (!work->place_count) return iso_fail(error, ISO_ERR_EMPTY, "the head has no surface");
    return plan->kind <= SET_ONLY ? open_ours(row, work, plan, error)
                                  : bench_volume_to_mesh_create(work->grid, 1, &work->peer, error);
}

static iso_vec3 next_centre(sculpting *work, const sculpt_plan *plan) {
    iso_vec3 at = work->places[work->stroke % work->place_count];
    at.y += 0.25 * plan->radius * work->step;
    return at;
}

static iso_status run_peer(const sculpt_plan *plan, sculpting *work, bench_sample *sample, iso_error *error) {
    iso_vec3 at = next_centre(work, plan);
    const double centre[3] = {at.x, at.y, at.z};
    double seconds = 0;
    work->stroke++;
    ISO_TRY(
        bench_vdb_sculpt_run(work->peer, centre, plan->radius, plan->kind == PEER_CLIPPED, &seconds, error));
    sample->wall += seconds * 1e3;
    sample->cpu += seconds * 1e3;
    return ISO_OK;
}

/* A touch and the extraction of what it changed. The stroke's end is timed apart, its undo is not. */
static iso_status run_touch(const sculpt_plan *plan, sculpting *work, bench_sample *sample,
                            iso_error *error) {
    const iso_affine affine = iso_transform_affine(&work->grid->transform);
    iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = plan->radius * work->grid->transform.spacing[0]};
    iso_sample s = {
        .position = iso_affine_point(&affine, next_centre(work, plan)), .normal = {0, 0, 1}, .pressure = 1};
    iso_touch touch = {.sample = s, .previous = s, .first = s};
    if (work->step == 0) {
        ISO_TRY(iso_history_begin(work->history, "stroke", error));
        iso_step_opts step = iso_history_step_opts(work->history);
        iso_editor_begin_step(work->editor, &step);
    }
    bench_clock clock = bench_clock_start();
    ISO_TRY(iso_editor_touch(work->editor, &brush, &touch, NULL, error));
    ISO_TRY(iso_point_set_update(work->set, error));
    bench_clock_stop(&clock, sample);
    if (work->time_count < TIMES) {
        work->cpu[work->time_count] = sample->cpu;
        work->times[work->time_count++] = sample->wall;
    }
    if (++work->step < STROKE) return ISO_OK;
    work->step = 0;
    work->stroke++;
    bench_sample end = {0};
    clock = bench_clock_start();
    ISO_TRY(iso_editor_finalize(work->editor, error));
    bench_clock_stop(&clock, &end);
    work->end_cpu += end.cpu;
    ISO_TRY(iso_history_end(work->history, error));
    ISO_TRY(iso_history_undo(work->history, error));
    ISO_TRY(iso_history_clear(work->history, error));
    iso_hgrid_reserve(work->grid, RESERVE);
    return iso_point_set_update(work->set, error);
}

/* The median touch of a turn. */
static iso_status run_ours(const sculpt_plan *plan, sculpting *work, bench_sample *sample, iso_error *error) {
    double wall[TURN], cpu[TURN];
    /* the rows share the field: what another one's turn changed is not this touch's work */
    ISO_TRY(iso_point_set_update(work->set, error));
    for (int i = 0; i < TURN; i++) {
        bench_sample touch = {0};
        ISO_TRY(run_touch(plan, work, &touch, error));
        wall[i] = touch.wall;
        cpu[i] = touch.cpu;
    }
    qsort(wall, TURN, sizeof *wall, iso_compare_doubles);
    qsort(cpu, TURN, sizeof *cpu, iso_compare_doubles);
    sample->wall = wall[TURN / 2];
    sample->cpu = cpu[TURN / 2];
    return ISO_OK;
}

static iso_status run_sculpt(bench_row *row, bench_sample *sample, iso_error *error) {
    const sculpt_plan *plan = row->plan;
    sculpting *work = row->context;
    sample->primitives = 1;
    return plan->kind <= SET_ONLY ? run_ours(plan, work, sample, error) : run_peer(plan, work, sample, error);
}

static void finish_sculpt(bench_row *row) {
    sculpting *work = row->context;
    if (!work->time_count) return;
    double touches = 0;
    for (int i = 0; i < work->time_count; i++) touches += work->cpu[i];
    bench_count(row, "stroke_end_share", work->end_cpu / (work->end_cpu + touches), 0, 0);
    qsort(work->times, (size_t)work->time_count, sizeof *work->times, iso_compare_doubles);
    qsort(work->cpu, (size_t)work->time_count, sizeof *work->cpu, iso_compare_doubles);
    double p50 = work->times[work->time_count / 2], p99 = work->times[work->time_count * 99 / 100];
    double cpu50 = work->cpu[work->time_count / 2], cpu99 = work->cpu[work->time_count * 99 / 100];
    bench_count(row, "p50_us", p50 * 1e3, 0, 0);
    bench_count(row, "p99_us", p99 * 1e3, 0, 0);
    const sculpt_plan *plan = row->plan;
    bool asked = plan->kind == KEEPS_DISTANCES && row->size >= 1024;
    bench_count(row, "p99_vs_p50", p99 / p50, 0, asked ? 4 : 0);
    bench_count(row, "p99_vs_p50_cpu", cpu99 / cpu50, 0, 0); /* what others on the machine do is not in it */
    /* the second comparison of a row that keeps distances is with the one that does not */
    for (int i = 0; i < row->against_count; i++) {
        const sculpt_plan *other = row->against[i].other->plan;
        if (other->kind != SET_ONLY || !row->against[i].other->context) continue;
        double ratio = bench_ratio(row, row->against[i].other);
        if (ratio > 0) bench_count(row, "time_vs_set_only", 1 / ratio, 0, row->size >= 1024 ? 5 : 0);
    }
}

static void close_sculpt(bench_row *row) {
    sculpting *work = row->context;
    if (!work) return;
    iso_point_set_destroy(work->set);
    iso_history_destroy(work->history);
    iso_editor_destroy(work->editor);
    if (work->peer) bench_volume_to_mesh_destroy(work->peer);
    free(work->times);
    free(work->cpu);
    free(work);
}

static const bench_kind ours_kind = {
    .open = open_sculpt, .run = run_sculpt, .finish = finish_sculpt, .close = close_sculpt, .batch = 1};
static const bench_kind peer_kind = {
    .open = open_sculpt, .run = run_sculpt, .close = close_sculpt, .batch = 1, .rounds = 3};

static bench_row *add_row(bench_state *bench, sculpt_kind kind, int size, int radius, const char *name) {
    bench_row *row = bench_add(bench, kind <= SET_ONLY ? &ours_kind : &peer_kind, "sculpt/add/head%d/r%d%s",
                               size, radius, name);
    sculpt_plan *plan = calloc(1, sizeof *plan);
    if (!plan) abort(); /* (as bench_add does when there are too many rows) */
    *plan = (sculpt_plan){kind, radius};
    row->plan = plan;
    row->head = true;
    row->size = size;
    return row;
}

iso_status bench_sculpt(bench_state *bench, iso_error *error) {
    static const struct {
        int radius;
        double whole;
    } brushes[] = {{8, 4000}, {16, 2500}, {32, 1000}, {64, 250}};
    bool small = bench->settings->small;
    int size = small ? 64 : 1024;
    iso_status status = ISO_OK;
    for (int i = 0; i < (small ? 1 : 4) && status == ISO_OK; i++) {
        int radius = brushes[i].radius;
        bench_row *whole = add_row(bench, PEER_WHOLE, size, radius, "/openvdb");
        bench_row *clipped = add_row(bench, PEER_CLIPPED, size, radius, "/openvdb_clipped");
        bench_row *plain = add_row(bench, SET_ONLY, size, radius, "/set_only");
        bench_row *ours = add_row(bench, KEEPS_DISTANCES, size, radius, "");
        bench_compare(ours, whole, "ratio_vs_openvdb", NULL, small ? 0 : brushes[i].whole);
        bench_compare(ours, clipped, "ratio_vs_openvdb_clipped", NULL, small ? 0 : 10);
        bench_compare(ours, plain, "ratio_vs_set_only", NULL, 0);
        status = bench_run_group(bench, "a touch that adds a sphere, and the points it changed", error);
    }
    bench_scene_drop_head(bench->scenes);
    return status == ISO_OK ? bench_controller_group(bench, error) : status;
}
