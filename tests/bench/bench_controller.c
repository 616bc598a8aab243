/* From the hand to the picture: isosculpt plays a stroke file without a window, draws every step as its
 * window does, and says itself how long each took. A process of its own, on as many processors as it has
 * threads. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench_harness.h"
#include "sculpt/session/journal.h"

/* A person's strokes with each tool in turn, over the side of a ball that the picture shows. */
enum { STROKES = 24, SAMPLES = 40 };
static const iso_tool tools[] = {ISO_TOOL_ADD,     ISO_TOOL_CARVE,   ISO_TOOL_SMOOTH, ISO_TOOL_INFLATE,
                                 ISO_TOOL_DEFLATE, ISO_TOOL_FLATTEN, ISO_TOOL_PINCH,  ISO_TOOL_BLEND_ADD};
static const double RADII_A_SAMPLE = 0.25;

typedef struct hand_scene {
    int side; /* voxels, of 1 mm */
    double ball, brush;
    const char *x_ray; /* isosculpt's option: how the ball as it was at the beginning is seen; "off" */
} hand_scene;

typedef struct controller {
    char strokes[512], report[520];
    double p50, p99, edit, draw; /* ms, the latest run's */
    double p50s[BENCH_ROUNDS], p99s[BENCH_ROUNDS];
    int runs;
} controller;

/* Along a circle of latitude of the ball. */
static iso_sample sample_of(const hand_scene *scene, int stroke, int sample) {
    double latitude = 0.9 * (stroke % 6 - 2.5) / 2.5;
    double step = RADII_A_SAMPLE * scene->brush / (scene->ball * cos(latitude));
    double longitude = (stroke % 4 - 1.5) * 0.5 + step * (sample - SAMPLES / 2);
    const iso_vec3 out =
        iso_vec3_make(cos(latitude) * sin(longitude), -cos(latitude) * cos(longitude), sin(latitude));
    return (iso_sample){.position = iso_vec3_scale(out, scene->ball),
                        .normal = out,
                        .pressure = 1,
                        .seconds = stroke + (double)sample / SAMPLES};
}

static iso_status put_strokes(const hand_scene *scene, iso_journal *journal, iso_error *error) {
    for (int stroke = 0; stroke < STROKES; stroke++) {
        iso_event event = {.kind = ISO_EVENT_BEGIN};
        event.brush = (iso_brush){.tool = tools[stroke % (int)(sizeof tools / sizeof *tools)],
                                  .radius = scene->brush,
                                  .strength = 0.5};
        for (int sample = 0; sample < SAMPLES; sample++, event.kind = ISO_EVENT_SAMPLE) {
            event.sample = sample_of(scene, stroke, sample);
            ISO_TRY(iso_journal_put(journal, &event, error));
        }
        event.kind = ISO_EVENT_END;
        ISO_TRY(iso_journal_put(journal, &event, error));
    }
    return ISO_OK;
}

static iso_status write_strokes(const hand_scene *scene, const char *path, iso_error *error) {
    double corner = -(scene->side - 1) / 2.0;
    const iso_journal_start start = {.source = "ball",
                                     .voxel_size = 1,
                                     .dims = {scene->side, scene->side, scene->side},
                                     .origin = {corner, corner, corner},
                                     .radius = scene->ball};
    iso_journal *journal = NULL;
    ISO_TRY(iso_journal_create(path, &start, &journal, error));
    iso_status status = put_strokes(scene, journal, error);
    iso_status closed = iso_journal_close(journal, status == ISO_OK ? error : NULL);
    return status == ISO_OK ? closed : status;
}

static iso_status open_hand(bench_row *row, iso_error *error) {
    controller *h = calloc(1, sizeof *h);
    if (!h) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = h;
    const char *folder = getenv("TMPDIR");
    snprintf(h->strokes, sizeof h->strokes, "%.400s/isopoint-bench-%ld-%d-%s.strokes",
             folder ? folder : "/tmp", (long)getpid(), row->threads, ((const hand_scene *)row->plan)->x_ray);
    snprintf(h->report, sizeof h->report, "%s.json", h->strokes);
    return write_strokes(row->plan, h->strokes, error);
}

static double milliseconds(json_t *report, const char *what, const char *quantile) {
    json_t *times = json_object_get(json_object_get(report, "seconds"), what);
    return 1e3 * json_number_value(json_object_get(times, quantile));
}

static iso_status read_report(controller *h, bench_sample *sample, iso_error *error) {
    json_error_t why;
    json_t *report = json_load_file(h->report, 0, &why);
    if (!report) return iso_fail(error, ISO_ERR_UNSUPPORTED, "isosculpt's report: %.100s", why.text);
    h->p50 = milliseconds(report, "step", "p50");
    h->p99 = milliseconds(report, "step", "p99");
    h->edit = milliseconds(report, "edit", "p50");
    h->draw = milliseconds(report, "draw", "p50");
    sample->primitives = (size_t)json_integer_value(json_object_get(report, "points"));
    json_decref(report);
    return h->p50 > 0 ? ISO_OK : iso_fail(error, ISO_ERR_UNSUPPORTED, "isosculpt reports no step");
}

/* The time of a run is that of its middle step. */
static iso_status run_hand(bench_row *row, bench_sample *sample, iso_error *error) {
    controller *h = row->context;
    const hand_scene *scene = row->plan;
    char program[1100], threads[16], report[560];
    bench_child *child = NULL;
    ISO_TRY(bench_sibling("isosculpt", program, sizeof program, error));
    snprintf(threads, sizeof threads, "%d", row->threads);
    snprintf(report, sizeof report, "--json=%s", h->report);
    const char *const argv[] = {program,     "--replay", h->strokes, "--headless", "--draw",     report,
                                "--threads", threads,    "--quiet",  "--x-ray",    scene->x_ray, NULL};
    ISO_TRY(bench_child_start(argv, row->threads, NULL, &child, error));
    if (!bench_child_end(child)) return iso_fail(error, ISO_ERR_UNSUPPORTED, "isosculpt failed");
    ISO_TRY(read_report(h, sample, error));
    sample->wall += h->p50;
    sample->cpu += h->p50; /* what one step took of the processors is not known */
    if (h->runs < BENCH_ROUNDS) {
        h->p50s[h->runs] = h->p50;
        h->p99s[h->runs++] = h->p99;
    }
    return ISO_OK;
}

static void finish_hand(bench_row *row) {
    const controller *h = row->context;
    bool asked = row->threads == 2 && !row->bench->settings->small;
    bench_count(row, "step_p50_ms", bench_median(h->p50s, h->runs), 0, asked ? 12 : 0);
    bench_count(row, "step_p99_ms", bench_median(h->p99s, h->runs), 0, asked ? 25 : 0);
    bench_count(row, "edit_p50_ms", h->edit, 0, 0);
    bench_count(row, "draw_p50_ms", h->draw, 0, 0);
}

static void close_hand(bench_row *row) {
    const controller *h = row->context;
    if (h) remove(h->strokes);
    if (h) remove(h->report);
    free(row->context);
}

static const bench_kind hand_kind = {
    .open = open_hand, .run = run_hand, .finish = finish_hand, .close = close_hand, .batch = 1, .rounds = 5};

static bench_row *add_hand(bench_state *bench, const hand_scene *scene, int threads) {
    const bool x_ray = strcmp(scene->x_ray, "off") != 0;
    bench_row *row = bench_add(bench, &hand_kind, "sculpt/hand/ball%d/r%g%s%s/threads:%d", scene->side,
                               scene->brush, x_ray ? "/x-ray-" : "", x_ray ? scene->x_ray : "", threads);
    hand_scene *plan = calloc(1, sizeof *plan);
    if (!plan) abort(); /* (as bench_add does when there are too many rows) */
    *plan = *scene;
    row->plan = plan;
    row->size = scene->side;
    row->threads = threads;
    return row;
}

iso_status bench_controller_group(bench_state *bench, iso_error *error) {
    const bench_settings *settings = bench->settings;
    /* the large ball has 3 million points */
    const hand_scene scene =
        settings->small ? (hand_scene){64, 24, 6, "off"} : (hand_scene){1024, 400, 32, "off"};
    static const char *const x_rays[] = {"under", "over"};
    for (int t = 0; t < settings->thread_count; t++) {
        bench_row *row = add_hand(bench, &scene, settings->threads[t]);
        for (int i = 0; i < 2; i++) {
            hand_scene with = scene;
            with.x_ray = x_rays[i];
            bench_compare(add_hand(bench, &with, settings->threads[t]), row, "ratio_vs_off", NULL, 0);
        }
    }
    return bench_run_group(bench, "from a sample of the hand to the finished picture, 1280x800", error);
}
