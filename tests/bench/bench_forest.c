/* Frames of a forest, 1024 x 1024, one sample a pixel, one thread: a thousand and more copies of the head
 * scene on a plain, seen by a walker (Guennebaud et al. 2004, figure 7 and table 1: 6,800 trees, 8 to 12
 * times as fast with what they select); and of 200 copies that turn from frame to frame (figure 5). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench_harness.h"
#include "extract/points/points.h"
#include "grids/scenes/scenes.h"
#include "render/selection/instances.h"

/* all: every point in sight is drawn, the farthest instances first; selected: the nearest first, without what
 * they hide; detail: also with levels of detail. */
typedef enum forest_mode { ALL, SELECTED, DETAIL, MODES } forest_mode;

typedef struct forest {
    size_t count;
    int size; /* voxels along the side of a tree */
    bool moving;
    iso_grid grid;
    iso_point_set *points;
    iso_lod lod;
    iso_instanced tree;
    iso_instance *instances; /* by their distance along the view; NULL: not made yet */
    iso_camera camera;
    iso_gbuffer gbuffer;
} forest;

static double uniform(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/* Farther instances last. */
static int compare_places(const void *a, const void *b) {
    const iso_instance *one = a, *other = b;
    return (one->transform.origin[1] > other->transform.origin[1]) -
           (one->transform.origin[1] < other->transform.origin[1]);
}

static void place_trees(forest *f, double side) {
    const double wide = 1.2 * side * sqrt((double)f->count);
    uint64_t seed = 1;
    for (size_t i = 0; i < f->count; i++) {
        iso_transform *t = &f->instances[i].transform;
        const double angle = 6.28 * uniform(&seed), size = 0.7 + 0.6 * uniform(&seed);
        const double turned[9] = {cos(angle), -sin(angle), 0, sin(angle), cos(angle), 0, 0, 0, 1};
        *t = f->lod.points.transform;
        memcpy(t->direction, turned, sizeof turned);
        for (int k = 0; k < 3; k++) t->spacing[k] *= size;
        t->origin[0] = wide * (uniform(&seed) - 0.5);
        t->origin[1] = wide * uniform(&seed);
        t->origin[2] = 0;
    }
    qsort(f->instances, f->count, sizeof *f->instances, compare_places);
    f->camera = (iso_camera){.position = {0, -2 * side, side},
                             .focal_point = {0, wide / 2, 0.6 * side},
                             .view_up = {0, 0, 1},
                             .view_angle = 50};
}

/* Turns every tree about a vertical axis at its corner. */
static void turn_trees(forest *f) {
    const double c = cos(0.1), s = sin(0.1);
    for (size_t i = 0; i < f->count; i++) {
        double *m = f->instances[i].transform.direction;
        for (int k = 0; k < 3; k++) {
            const double x = m[k], y = m[3 + k];
            m[k] = c * x - s * y;
            m[3 + k] = s * x + c * y;
        }
    }
}

/* Once, when the first row needs it. */
static iso_status make_forest(forest *f, iso_error *error) {
    const iso_scene_opts scene = {.size = f->size};
    double isovalue;
    if (f->instances) return ISO_OK;
    ISO_TRY(iso_scene_create("head", &scene, &f->grid, &isovalue, error));
    const iso_points_opts opts = {.isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE};
    ISO_TRY(iso_point_set_create(&f->grid, &opts, &f->points, error));
    ISO_TRY(iso_point_set_update(f->points, error));
    ISO_TRY(iso_point_set_bound(f->points, error));
    const iso_point_view view = iso_point_set_view(f->points);
    ISO_TRY(iso_lod_update(&f->lod, &view, NULL, error));
    f->tree = (iso_instanced){&f->lod, iso_point_view_bounds(&view), view.radius};
    f->instances = calloc(f->count, sizeof *f->instances);
    if (!f->instances) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    place_trees(f, view.transform.spacing[0] * f->size);
    return iso_gbuffer_create(1024, 1024, &f->gbuffer, error);
}

static void free_forest(forest *f) {
    iso_lod_free(&f->lod);
    iso_point_set_destroy(f->points);
    iso_grid_destroy(&f->grid);
    free(f->instances);
    iso_gbuffer_free(&f->gbuffer);
}

/* ---- rows */

typedef struct forest_plan {
    forest *forest; /* borrowed */
    forest_mode mode;
} forest_plan;

typedef struct forest_work {
    iso_instance_drawing drawing;
    iso_instance_counts counts;
} forest_work;

static iso_status open_row(bench_row *row, iso_error *error) {
    const forest_plan *plan = row->plan;
    row->context = calloc(1, sizeof(forest_work));
    if (!row->context) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    return make_forest(plan->forest, error);
}

/* Draws the instances one by one, the farthest first, so that none hides another one. */
static iso_status draw_all(forest_work *work, const iso_target *target, const forest *f, iso_error *error) {
    work->counts = (iso_instance_counts){0};
    for (size_t i = f->count; i-- > 0;) {
        const iso_instances one = {
            .sets = &f->tree, .instances = &f->instances[i], .set_count = 1, .count = 1, .draw_hidden = true};
        iso_instance_counts counts;
        ISO_TRY(iso_draw_instances(&work->drawing, target, &one, &counts, error));
        work->counts.drawn += counts.drawn;
        work->counts.outside += counts.outside;
        work->counts.points += counts.points;
    }
    return ISO_OK;
}

static iso_status run_row(bench_row *row, bench_sample *sample, iso_error *error) {
    const forest_plan *plan = row->plan;
    forest *f = plan->forest;
    forest_work *work = row->context;
    const iso_view view = iso_view_make(&f->camera, f->gbuffer.width, f->gbuffer.height);
    const iso_target target = {.view = &view, .gbuffer = &f->gbuffer};
    const iso_instances all = {.sets = &f->tree,
                               .instances = f->instances,
                               .set_count = 1,
                               .count = f->count,
                               .lod_pixels = plan->mode == DETAIL ? 1 : 0};
    sample->primitives = f->count;
    if (f->moving) turn_trees(f);
    const bench_clock clock = bench_clock_start();
    iso_gbuffer_clear(&f->gbuffer);
    const iso_status status = plan->mode == ALL
                                  ? draw_all(work, &target, f, error)
                                  : iso_draw_instances(&work->drawing, &target, &all, &work->counts, error);
    bench_clock_stop(&clock, sample);
    return status;
}

static void finish_row(bench_row *row) {
    const forest_work *work = row->context;
    bench_count(row, "drawn", (double)work->counts.drawn, 0, 0);
    bench_count(row, "hidden", (double)work->counts.hidden, 0, 0);
    bench_count(row, "million_points", (double)work->counts.points / 1e6, 0, 0);
}

static void close_row(bench_row *row) {
    forest_work *work = row->context;
    if (!work) return;
    iso_instance_drawing_free(&work->drawing);
    free(work);
}

static const bench_kind forest_kind = {
    .open = open_row, .run = run_row, .finish = finish_row, .close = close_row, .batch = 1, .rounds = 5};

static iso_status run_forest(bench_state *bench, size_t count, int size, bool moving, iso_error *error) {
    static const char *const names[MODES] = {"all", "selected", "detail"};
    const char *kind = moving ? "moving" : "forest";
    char title[64];
    forest f = {.count = count, .size = size, .moving = moving};
    bench_row *rows[MODES];
    for (int mode = 0; mode < MODES; mode++) {
        bench_row *row = rows[mode] =
            bench_add(bench, &forest_kind, "render/%s/%zu/%s/threads:1", kind, count, names[mode]);
        forest_plan *plan = calloc(1, sizeof *plan);
        if (!plan) abort(); /* (as bench_add does when there are too many rows) */
        *plan = (forest_plan){&f, (forest_mode)mode};
        row->plan = plan;
        row->threads = 1;
        row->level = bench->best;
        if (mode == ALL) continue;
        bench_against *against = bench_compare(
            row, rows[ALL], "ratio_vs_all", NULL,
            mode == DETAIL && bench->best == ISO_CPU_AVX512 && !bench->settings->small && !moving ? 5 : 0);
        if (against) against->cpu = "cpu_ratio_vs_all";
    }
    snprintf(title, sizeof title, "frames of %s copies: %zu", moving ? "moving" : "standing", count);
    const iso_status status = bench_run_group(bench, title, error);
    free_forest(&f);
    return status;
}

iso_status bench_forest_groups(bench_state *bench, iso_error *error) {
    const bool small = bench->settings->small;
    const int size = small ? 32 : 256;
    ISO_TRY(run_forest(bench, small ? 20 : 200, size, true, error));
    ISO_TRY(run_forest(bench, small ? 30 : 1000, size, false, error));
    return small ? ISO_OK : run_forest(bench, 6800, size, false, error);
}
