/* bench_harness: rows that are timed in turn, A B A B ..., and what is said about them.
 *
 * A row is something that can be run many times: one kernel variant of ours, or a peer. Rows of a group share
 * their input and take turns, one after another, for several rounds, so that whatever else the machine does
 * hits all of them alike. A row's time is the median over rounds; a ratio is that of two medians, and beside
 * it stands the median of the ratios of the rounds. Speeds are reported, never judged: nothing here fails
 * because something was slow. */
#ifndef ISO_TESTS_BENCH_HARNESS_H
#define ISO_TESTS_BENCH_HARNESS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/cpu.h"
#include "base/file.h"
#include "base/parallel.h"
#include "bench_child.h"
#include "grids/grid.h"

enum { BENCH_ROWS = 640, BENCH_ROUNDS = 64, BENCH_COUNTERS = 12, BENCH_AGAINST = 6, BENCH_THREADS = 8 };

/* One timed run; milliseconds. */
typedef struct bench_sample {
    double wall, cpu; /* cpu: of all threads of the process */
    size_t primitives;
} bench_sample;

typedef struct bench_clock {
    double wall, cpu;
} bench_clock;
bench_clock bench_clock_start(void);
void bench_clock_stop(const bench_clock *clock, bench_sample *sample); /* leaves primitives alone */

/* A number beside a row's time; `least` and `most` are what the project asks for, 0: nothing. */
typedef struct bench_counter {
    const char *name;
    double value, least, most;
} bench_counter;

struct bench_state;
typedef struct bench_row bench_row;

/* How a kind of row is run. `open` makes row->context; `finish` (may be NULL) adds counters after the last
 * round; `close` accepts a row whose open failed. */
typedef struct bench_kind {
    iso_status (*open)(bench_row *row, iso_error *error);
    iso_status (*run)(bench_row *row, bench_sample *sample, iso_error *error);
    void (*finish)(bench_row *row);
    void (*close)(bench_row *row);
    int batch;  /* runs in a round at most; a round lasts BATCH_MS when they are short. 0: 10 */
    int rounds; /* at most; 0: as many as asked for */
} bench_kind;

/* Another row that this one is compared with: counter = its median / ours. */
typedef struct bench_against {
    const char *counter;
    const char *pairwise; /* name of the median of the rounds' ratios; NULL: left out */
    const char *cpu; /* name of the ratio of processor time, which bears company better; NULL: left out */
    bench_row *other;
    double least; /* what is asked for; 0: nothing */
    /* With another row's counter of the same name as the measure: `least` is a fraction of that. */
    const bench_row *measure;
} bench_against;

struct bench_row {
    char name[96];
    struct bench_state *bench;
    const bench_kind *kind;
    bool head; /* works on the head scene, else on ct as `type` */
    iso_type type;
    int size; /* voxels a side */
    double isovalue;
    iso_cpu_level level;
    int threads;
    void *plan;    /* what open needs to know beyond this; owned, from calloc */
    void *context; /* what open makes */

    bench_against against[BENCH_AGAINST];
    int against_count;
    bench_counter counters[BENCH_COUNTERS];
    int counter_count;

    bool wanted, needed; /* asked for, or another row's measure */
    char problem[160];   /* why there is no time: "built without VTK" */
    double wall[BENCH_ROUNDS], cpu[BENCH_ROUNDS], least_wall, most_wall;
    int rounds, runs;
    size_t primitives;
};

typedef struct bench_settings {
    int help, list, small, repeat;
    const char *filter, *json, *vtk_child;
    int threads[BENCH_THREADS];
    int thread_count;
} bench_settings;

typedef struct bench_state {
    const bench_settings *settings;
    iso_cpu_level best;             /* what this machine and ISO_CPU allow */
    bench_row *rows[BENCH_ROWS];    /* owned */
    int row_count, group;           /* rows from `group` on are of the current one */
    iso_pool *pools[BENCH_THREADS]; /* of settings->threads[i] threads; NULL for one */
    struct bench_scenes *scenes;
    void *bandwidth; /* a block larger than any cache */
    size_t bandwidth_bytes;
    bench_display display;
    char vtk_renderer[96]; /* what VTK's frames are drawn by, once they are */
    iso_sink json;         /* open from the start: minutes of work shall not fail at the end */
} bench_state;

iso_status bench_open(const bench_settings *settings, bench_state *bench, iso_error *error);
void bench_close(bench_state *bench);

/* A new row of the current group; ends the program when there are more than BENCH_ROWS. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bench_row *
bench_add(bench_state *bench, const bench_kind *kind, const char *name, ...);

/* Compares `row` with `other`, which may be NULL: then nothing is compared. Returns the comparison or NULL.
 */
bench_against *bench_compare(bench_row *row, bench_row *other, const char *counter, const char *pairwise,
                             double least);
void bench_count(bench_row *row, const char *name, double value, double least, double most);

iso_pool *bench_pool(const bench_state *bench, int threads);
iso_status bench_row_grid(const bench_row *row, const iso_grid **grid, iso_error *error);

/* Lists or runs the rows of the current group, prints their times, and begins a new group. A row that cannot
 * run says why and is left out; only a lack of memory ends the bench. */
iso_status bench_run_group(bench_state *bench, const char *title, iso_error *error);

double bench_median(const double *values, int count);
double bench_row_median(const bench_row *row);                    /* ms; 0: not run */
double bench_ratio(const bench_row *row, const bench_row *other); /* of medians, 0: unknown */

/* bench_report.c */
void bench_print_rows(const bench_state *bench, const char *title, int first);
void bench_print_machine(const bench_state *bench);
void bench_print_asked(const bench_state *bench);
iso_status bench_write_json(bench_state *bench, iso_error *error);

/* bench_extract.c, bench_render.c: all their groups. */
iso_status bench_extract(bench_state *bench, iso_error *error);
iso_status bench_render(bench_state *bench, iso_error *error);
/* bench_sculpt.c */
iso_status bench_sculpt(bench_state *bench, iso_error *error);

/* Runs a program to its end, which is waited for; the arguments are those of bench_child_start. */
iso_status bench_time_program(const char *const *argv, int threads, const char *display, bench_sample *sample,
                              iso_error *error);

/* Parts of bench_extract in files of their own: bench_clouds.c, bench_edit.c, bench_lines.c and
 * bench_process.c. */
iso_status bench_clouds_group(bench_state *bench, iso_error *error);
iso_status bench_edit_group(bench_state *bench, iso_error *error);
iso_status bench_lines_group(bench_state *bench, iso_error *error);
iso_status bench_process_groups(bench_state *bench, iso_error *error);
/* Glyphs and tubes, before the end of bench_render. */
iso_status bench_shapes_groups(bench_state *bench, iso_error *error);
iso_status bench_forest_groups(bench_state *bench, iso_error *error);
/* Lines, points and surfaces in one picture; trees: bench_together.c. */
iso_status bench_together_groups(bench_state *bench, iso_error *error);
/* From a file to a picture: the end of bench_render. */
iso_status bench_picture_group(bench_state *bench, iso_error *error);
iso_status bench_tracts_group(bench_state *bench, iso_error *error);        /* bench_lines.c */
iso_status bench_cloud_picture_group(bench_state *bench, iso_error *error); /* bench_clouds.c */
/* From the hand to the picture: the end of bench_sculpt. */
iso_status bench_controller_group(bench_state *bench, iso_error *error);

/* What the hidden options do in a process of its own; the exit status. */
int bench_vtk_child(const bench_settings *settings);

/* Position of one thread in settings->threads, -1 when it is not measured. */
int bench_single_thread(const bench_settings *settings);

#endif
