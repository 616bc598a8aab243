/* What an edit costs: a brush goes over the head, and only what it changed is extracted again. */
#include <math.h>
#include <stdlib.h>

#include "bench_harness.h"
#include "bench_scenes.h"
#include "extract/points/points.h"

/* ---- a brush on the head ---- */

enum { BRUSH_RADIUS = 8, BRUSH_PLACES = 4096 };

typedef struct brushing {
    iso_hgrid *grid; /* borrowed */
    iso_point_set *set;
    iso_vec3 *places; /* on the surface as it was, scattered over it */
    int place_count, next;
    bool nudged;
    double touched, active; /* bricks of all updates: extracted, and with points */
    int updates;
} brushing;

typedef struct voxel_box {
    int lo[3], hi[3];
} voxel_box;

/* One cell's share of a brush: the union with a sphere, or the difference. Grows `changed`. */
typedef struct brush_dab {
    iso_vec3 centre;
    bool digs;
    voxel_box box, changed;
} brush_dab;

static float dab_value(const brush_dab *dab, float band, int x, int y, int z, float old) {
    iso_vec3 away = iso_vec3_sub(iso_vec3_make(x, y, z), dab->centre);
    float distance = (float)iso_vec3_length(away) - BRUSH_RADIUS;
    float value = dab->digs ? fmaxf(old, -distance) : fminf(old, distance);
    return fmaxf(-band, fminf(band, value));
}

static void grow(voxel_box *box, int x, int y, int z) {
    const int voxel[3] = {x, y, z};
    for (int axis = 0; axis < 3; axis++) {
        if (voxel[axis] < box->lo[axis]) box->lo[axis] = voxel[axis];
        if (voxel[axis] > box->hi[axis]) box->hi[axis] = voxel[axis];
    }
}

/* The part of the brush's box in a cell. */
static voxel_box cell_part(const brush_dab *dab, const int cell[3]) {
    voxel_box part;
    for (int axis = 0; axis < 3; axis++) {
        int first = cell[axis] * ISO_BRICK, last = first + ISO_BRICK - 1;
        part.lo[axis] = dab->box.lo[axis] > first ? dab->box.lo[axis] : first;
        part.hi[axis] = dab->box.hi[axis] < last ? dab->box.hi[axis] : last;
    }
    return part;
}

/* Writes into `brick`, or with NULL only says whether anything would change. */
static bool dab_cell(const iso_hgrid *grid, brush_dab *dab, const int cell[3], float *brick) {
    voxel_box part = cell_part(dab, cell);
    bool changes = false;
    for (int z = part.lo[2]; z <= part.hi[2]; z++)
        for (int y = part.lo[1]; y <= part.hi[1]; y++)
            for (int x = part.lo[0]; x <= part.hi[0]; x++) {
                float old = iso_hgrid_at(grid, x, y, z);
                float value = dab_value(dab, grid->band, x, y, z, old);
                if (value == old) continue;
                changes = true;
                if (!brick) return true;
                brick[((z % ISO_BRICK) * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK + x % ISO_BRICK] = value;
                grow(&dab->changed, x, y, z);
            }
    return changes;
}

static iso_status paint(iso_hgrid *grid, brush_dab *dab, iso_error *error) {
    const double reach = BRUSH_RADIUS + grid->band;
    const double centre[3] = {dab->centre.x, dab->centre.y, dab->centre.z};
    for (int axis = 0; axis < 3; axis++) {
        dab->box.lo[axis] = (int)fmax(0, floor(centre[axis] - reach));
        dab->box.hi[axis] = (int)fmin(grid->dims[axis] - 1, ceil(centre[axis] + reach));
        dab->changed.lo[axis] = grid->dims[axis];
        dab->changed.hi[axis] = -1;
    }
    int cell[3];
    for (cell[2] = dab->box.lo[2] / ISO_BRICK; cell[2] <= dab->box.hi[2] / ISO_BRICK; cell[2]++)
        for (cell[1] = dab->box.lo[1] / ISO_BRICK; cell[1] <= dab->box.hi[1] / ISO_BRICK; cell[1]++)
            for (cell[0] = dab->box.lo[0] / ISO_BRICK; cell[0] <= dab->box.hi[0] / ISO_BRICK; cell[0]++) {
                float *brick = NULL;
                if (!dab_cell(grid, dab, cell, NULL)) continue;
                ISO_TRY(iso_hgrid_split(grid, cell[0], cell[1], cell[2], &brick, error));
                dab_cell(grid, dab, cell, brick);
            }
    return iso_hgrid_mark_changed(grid, dab->changed.lo, dab->changed.hi, error);
}

/* Bricks with points; with `near` only those within a voxel of its changes. */
static size_t active_bricks(const iso_point_set *set, const voxel_box *near) {
    iso_point_view view = iso_point_set_view(set);
    size_t count = 0;
    for (size_t i = 0; i < view.span_count; i++) {
        bool inside = view.spans[i].count > 0;
        for (int axis = 0; near && axis < 3; axis++) {
            int first = view.spans[i].brick[axis] * ISO_BRICK;
            inside = inside && first <= near->hi[axis] + 1 && first + ISO_BRICK > near->lo[axis] - 1;
        }
        count += inside;
    }
    return count;
}

static iso_status open_brush(bench_row *row, iso_error *error) {
    iso_grid *head = NULL;
    ISO_TRY(bench_scene_head(row->bench->scenes, row->size, &head, error));
    brushing *work = calloc(1, sizeof *work);
    if (!work) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = work;
    work->grid = head->hgrid;
    work->places = calloc(BRUSH_PLACES, sizeof *work->places);
    if (!work->places) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_points_opts opts = {.isovalue = 0};
    ISO_TRY(iso_point_set_create(head, &opts, &work->set, error));
    ISO_TRY(iso_point_set_update(work->set, error));
    work->place_count = bench_scatter_places(work->set, work->places, BRUSH_PLACES);
    return work->place_count ? ISO_OK : iso_fail(error, ISO_ERR_EMPTY, "the head has no surface");
}

/* Updates the points, which is what is timed, and counts what was looked at; `changed` NULL: everything. */
static iso_status update(brushing *work, const voxel_box *changed, bench_sample *sample, iso_error *error) {
    bench_clock clock = bench_clock_start();
    ISO_TRY(iso_point_set_update(work->set, error));
    bench_clock_stop(&clock, sample);
    iso_points_stats stats = iso_point_set_stats(work->set);
    sample->primitives = stats.points;
    work->touched += (double)stats.bricks;
    work->active += (double)active_bricks(work->set, changed);
    work->updates++;
    return ISO_OK;
}

/* Alternately adds and digs a sphere at the next place; only the update is timed. */
static iso_status run_brush(bench_row *row, bench_sample *sample, iso_error *error) {
    brushing *work = row->context;
    brush_dab dab = {.centre = work->places[work->next % work->place_count], .digs = work->next % 2 != 0};
    work->next++;
    ISO_TRY(paint(work->grid, &dab, error));
    return update(work, &dab.changed, sample, error);
}

static iso_status run_whole(bench_row *row, bench_sample *sample, iso_error *error) {
    brushing *work = row->context;
    work->nudged = !work->nudged;
    iso_point_set_isovalue(work->set, work->nudged ? 0x1p-30 : 0);
    return update(work, NULL, sample, error);
}

/* The first comparison of the brush's row is the one with the whole. Bricks with points stand for the work on
 * both sides, so that visiting an empty brick makes nothing look cheaper. */
static void finish_brush(bench_row *row) {
    const brushing *work = row->context;
    double touched = work->touched / work->updates, active = work->active / work->updates;
    bench_count(row, "bricks_extracted", touched, 0, 0);
    bench_count(row, "bricks_active", active, 0, 0);
    if (active > 0) bench_count(row, "us_per_active_brick", bench_row_median(row) * 1e3 / active, 0, 0);
    if (!row->against_count || !row->against[0].other->context || active <= 0) return;
    const bench_row *whole = row->against[0].other;
    const brushing *all = whole->context;
    double each = bench_row_median(whole) * all->updates / all->active;
    double most = row->against[0].least > 0 ? 2 : 0;
    if (each > 0) bench_count(row, "brick_time_vs_full", bench_row_median(row) / active / each, 0, most);
}

static void close_brush(bench_row *row) {
    brushing *work = row->context;
    if (!work) return;
    iso_point_set_destroy(work->set);
    free(work->places);
    free(work);
}

static const bench_kind brush_kind = {
    .open = open_brush, .run = run_brush, .finish = finish_brush, .close = close_brush, .batch = 48};
static const bench_kind whole_kind = {
    .open = open_brush, .run = run_whole, .finish = finish_brush, .close = close_brush};

static iso_status run_dirty(bench_state *bench, int size, bool asked, iso_error *error) {
    bench_row *whole = bench_add(bench, &whole_kind, "extract/dirty/head%d/full", size);
    bench_row *brush = bench_add(bench, &brush_kind, "extract/dirty/head%d/r%d", size, BRUSH_RADIUS);
    whole->head = brush->head = true;
    whole->size = brush->size = size;
    bench_compare(brush, whole, "ratio_vs_full", "ratio_vs_full_pairwise", asked ? 500 : 0);
    iso_status status = bench_run_group(bench, "a brush of radius 8: only what it changed", error);
    bench_scene_drop_head(bench->scenes); /* it has been edited */
    return status;
}

iso_status bench_edit_group(bench_state *bench, iso_error *error) {
    bool small = bench->settings->small;
    return run_dirty(bench, small ? 64 : 1024, !small, error);
}
