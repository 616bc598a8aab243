#include "bench_harness.h"
#include "base/numbers.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "bench_scenes.h"

/* ---- time ---- */

static double milliseconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

bench_clock bench_clock_start(void) {
    return (bench_clock){.cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID),
                         .wall = milliseconds(CLOCK_MONOTONIC)};
}

void bench_clock_stop(const bench_clock *clock, bench_sample *sample) {
    sample->wall = milliseconds(CLOCK_MONOTONIC) - clock->wall;
    sample->cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID) - clock->cpu;
}

double bench_median(const double *values, int count) {
    double sorted[BENCH_ROUNDS];
    if (count > BENCH_ROUNDS) count = BENCH_ROUNDS;
    if (count < 1) return 0;
    memcpy(sorted, values, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, iso_compare_doubles);
    return (sorted[(count - 1) / 2] + sorted[count / 2]) / 2;
}

double bench_row_median(const bench_row *row) {
    return bench_median(row->wall, row->rounds);
}

double bench_ratio(const bench_row *row, const bench_row *other) {
    double ours = bench_row_median(row);
    return ours > 0 ? bench_row_median(other) / ours : 0;
}

/* ---- the bench ---- */

iso_status bench_open(const bench_settings *settings, bench_state *bench, iso_error *error) {
    *bench = (bench_state){.settings = settings, .best = iso_cpu_best()};
    if (settings->json && !settings->list) ISO_TRY(iso_sink_open(settings->json, &bench->json, error));
    ISO_TRY(bench_scenes_create(&bench->scenes, error));
    for (int i = 0; i < settings->thread_count && !settings->list; i++)
        if (settings->threads[i] > 1) ISO_TRY(iso_pool_create(settings->threads[i], &bench->pools[i], error));
    return ISO_OK;
}

void bench_close(bench_state *bench) {
    for (int i = 0; i < bench->row_count; i++) {
        free(bench->rows[i]->plan);
        free(bench->rows[i]);
    }
    bench_display_close(&bench->display);
    for (int i = 0; i < BENCH_THREADS; i++) iso_pool_destroy(bench->pools[i]);
    bench_scenes_destroy(bench->scenes);
    iso_sink_abort(&bench->json);
    iso_free(bench->bandwidth);
    *bench = (bench_state){0};
}

iso_pool *bench_pool(const bench_state *bench, int threads) {
    for (int i = 0; i < bench->settings->thread_count; i++)
        if (bench->settings->threads[i] == threads) return bench->pools[i];
    return NULL;
}

iso_status bench_row_grid(const bench_row *row, const iso_grid **grid, iso_error *error) {
    bench_scenes *scenes = row->bench->scenes;
    if (!row->head) return bench_scene_ct(scenes, row->size, row->type, grid, error);
    iso_grid *head = NULL;
    ISO_TRY(bench_scene_head(scenes, row->size, &head, error));
    *grid = head;
    return ISO_OK;
}

bench_row *bench_add(bench_state *bench, const bench_kind *kind, const char *name, ...) {
    bench_row *row = bench->row_count < BENCH_ROWS ? calloc(1, sizeof *row) : NULL;
    if (!row) {
        fprintf(stderr, "bench: no room for another row\n");
        exit(iso_status_exit(ISO_ERR_NOMEM));
    }
    va_list arguments;
    va_start(arguments, name);
    vsnprintf(row->name, sizeof row->name, name, arguments);
    va_end(arguments);
    row->bench = bench;
    row->kind = kind;
    row->threads = 1;
    row->level = bench->best;
    const char *filter = bench->settings->filter;
    row->wanted = !filter || strstr(row->name, filter);
    bench->rows[bench->row_count++] = row;
    return row;
}

bench_against *bench_compare(bench_row *row, bench_row *other, const char *counter, const char *pairwise,
                             double least) {
    if (!other || row->against_count == BENCH_AGAINST) return NULL;
    bench_against *against = &row->against[row->against_count++];
    *against = (bench_against){.counter = counter, .pairwise = pairwise, .other = other, .least = least};
    return against;
}

void bench_count(bench_row *row, const char *name, double value, double least, double most) {
    if (row->counter_count == BENCH_COUNTERS) return;
    row->counters[row->counter_count++] = (bench_counter){name, value, least, most};
}

/* ---- running ---- */

static bool runs(const bench_row *row) {
    return (row->wanted || row->needed) && !row->problem[0];
}

static void note_problem(bench_row *row, const iso_error *problem) {
    snprintf(row->problem, sizeof row->problem, "%.150s", problem->text);
}

/* Rows that a wanted one is compared with are run too; the second pass finds the measures' own. */
static void mark_needed(bench_state *bench) {
    for (int pass = 0; pass < 2; pass++)
        for (int i = bench->group; i < bench->row_count; i++) {
            bench_row *row = bench->rows[i];
            if (!row->wanted && !row->needed) continue;
            for (int k = 0; k < row->against_count; k++) {
                row->against[k].other->needed = true;
                if (!row->against[k].measure) continue;
                for (int m = bench->group; m < bench->row_count; m++)
                    if (bench->rows[m] == row->against[k].measure) bench->rows[m]->needed = true;
            }
        }
}

static iso_status open_rows(bench_state *bench, iso_error *error) {
    for (int i = bench->group; i < bench->row_count; i++) {
        bench_row *row = bench->rows[i];
        if (!runs(row)) continue;
        iso_cpu_limit(row->level);
        iso_error problem = {0};
        iso_status status = row->kind->open(row, &problem);
        if (status == ISO_ERR_NOMEM) return iso_fail(error, status, "%s: %s", row->name, problem.text);
        if (status != ISO_OK) note_problem(row, &problem);
    }
    return ISO_OK;
}

static void keep_extremes(bench_row *row, double wall) {
    if (row->runs == 0 || wall < row->least_wall) row->least_wall = wall;
    if (row->runs == 0 || wall > row->most_wall) row->most_wall = wall;
    row->runs++;
}

/* Threads of a peer's pool spin for a while after its work is done; the next row must not pay for that. */
static void let_others_settle(void) {
    struct timespec pause = {.tv_nsec = 3000000};
    nanosleep(&pause, NULL);
}

/* One turn of a row: runs until 20 ms have gone by, at least one, and takes their median. */
static iso_status run_round(bench_row *row, iso_error *error) {
    enum { BATCH_MS = 20 };
    int batch = row->kind->batch ? row->kind->batch : 10, count = 0;
    double wall[BENCH_ROUNDS], cpu[BENCH_ROUNDS], spent = 0;
    iso_cpu_limit(row->level);
    let_others_settle();
    while (count < batch && (count == 0 || spent < BATCH_MS)) {
        bench_sample sample = {0};
        ISO_TRY(row->kind->run(row, &sample, error));
        keep_extremes(row, sample.wall);
        wall[count] = sample.wall;
        cpu[count++] = sample.cpu;
        spent += sample.wall;
        row->primitives = sample.primitives;
    }
    row->wall[row->rounds] = bench_median(wall, count);
    row->cpu[row->rounds++] = bench_median(cpu, count);
    return ISO_OK;
}

/* A row that has taken seconds has said enough after three rounds. */
static bool is_done(const bench_row *row) {
    enum { ENOUGH_MS = 3000 };
    int most = row->bench->settings->repeat;
    if (row->kind->rounds && row->kind->rounds < most) most = row->kind->rounds;
    double spent = 0;
    for (int i = 0; i < row->rounds; i++) spent += row->wall[i];
    return row->rounds >= most || (row->rounds >= 3 && spent > ENOUGH_MS);
}

static void run_rounds(bench_state *bench) {
    for (int round = 0; round < bench->settings->repeat; round++)
        for (int i = bench->group; i < bench->row_count; i++) {
            bench_row *row = bench->rows[i];
            iso_error problem = {0};
            if (runs(row) && !is_done(row) && run_round(row, &problem) != ISO_OK) note_problem(row, &problem);
        }
}

/* ---- comparing ---- */

static double pairwise_ratio(const bench_row *row, const bench_row *other) {
    double ratios[BENCH_ROUNDS];
    int count = row->rounds < other->rounds ? row->rounds : other->rounds;
    for (int i = 0; i < count; i++) ratios[i] = row->wall[i] > 0 ? other->wall[i] / row->wall[i] : 0;
    return bench_median(ratios, count);
}

static double cpu_ratio(const bench_row *row, const bench_row *other) {
    double ours = bench_median(row->cpu, row->rounds);
    return ours > 0 ? bench_median(other->cpu, other->rounds) / ours : 0;
}

/* The same comparison as the measure makes, 0 when it makes none. */
static double measured(const bench_row *measure, const char *counter) {
    for (int i = 0; i < measure->against_count; i++)
        if (strcmp(measure->against[i].counter, counter) == 0)
            return bench_ratio(measure, measure->against[i].other);
    return 0;
}

static void compare_row(bench_row *row) {
    for (int i = 0; i < row->against_count; i++) {
        const bench_against *against = &row->against[i];
        if (!row->rounds || !against->other->rounds) continue;
        double least = against->least;
        if (against->measure) {
            double measure = measured(against->measure, against->counter);
            bench_count(row, "read_bandwidth_scaling", measure, 0, 0);
            least *= measure;
        }
        bench_count(row, against->counter, bench_ratio(row, against->other), least, 0);
        if (against->pairwise) bench_count(row, against->pairwise, pairwise_ratio(row, against->other), 0, 0);
        if (against->cpu) bench_count(row, against->cpu, cpu_ratio(row, against->other), 0, 0);
    }
    if (row->rounds && row->kind->finish) row->kind->finish(row);
}

/* Comparisons first: what finish does may need the other row's numbers. */
static void close_rows(bench_state *bench) {
    for (int i = bench->group; i < bench->row_count; i++)
        if (bench->rows[i]->rounds) compare_row(bench->rows[i]);
    for (int i = bench->group; i < bench->row_count; i++) {
        bench->rows[i]->kind->close(bench->rows[i]);
        bench->rows[i]->context = NULL;
    }
    iso_cpu_limit(bench->best);
}

iso_status bench_run_group(bench_state *bench, const char *title, iso_error *error) {
    int first = bench->group;
    mark_needed(bench);
    if (bench->settings->list) {
        for (int i = first; i < bench->row_count; i++)
            if (bench->rows[i]->wanted) puts(bench->rows[i]->name);
        bench->group = bench->row_count;
        return ISO_OK;
    }
    iso_status status = open_rows(bench, error);
    if (status == ISO_OK) run_rounds(bench);
    close_rows(bench);
    if (status == ISO_OK) bench_print_rows(bench, title, first);
    bench->group = bench->row_count;
    return status;
}

int bench_single_thread(const bench_settings *settings) {
    for (int t = 0; t < settings->thread_count; t++)
        if (settings->threads[t] == 1) return t;
    return -1;
}
