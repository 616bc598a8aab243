/* Plays a stroke file without a window. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/json.h"
#include "apps/common/json_parts.h"
#include "apps/isosculpt/document.h"
#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/source.h"
#include "apps/isosculpt/view/view.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/numbers.h"
#include "base/text.h"
#include "grids/level_set.h"
#include "io/mesh_io.h"
#include "io/points_io.h"

static iso_status add_time(isosculpt_times *times, double seconds, iso_error *error) {
    if (times->count == times->room) {
        size_t room = times->room ? 2 * times->room : 1024;
        double *more = realloc(times->seconds, room * sizeof *more);
        if (!more) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu times", room);
        times->seconds = more;
        times->room = room;
    }
    times->seconds[times->count++] = seconds;
    return ISO_OK;
}

void isosculpt_report_free(isosculpt_report *report) {
    free(report->edit.seconds);
    free(report->extract.seconds);
    free(report->draw.seconds);
    free(report->step.seconds);
}

/* ---- the field that the session began with */

/* The same place in space, in voxels of another size: whole bricks, no fewer than before. */
static iso_status rescale(iso_journal_start *start, double voxel_size, iso_error *error) {
    for (int axis = 0; axis < 3; axis++) {
        double voxels = ceil(start->dims[axis] * start->voxel_size / voxel_size / ISO_BRICK) * ISO_BRICK;
        if (voxels > ISO_HGRID_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "voxels of %g mm: %g of them along %c, at most %d",
                            voxel_size, voxels, "xyz"[axis], ISO_HGRID_MAX);
        start->dims[axis] = (int)voxels;
    }
    start->voxel_size = voxel_size;
    return ISO_OK;
}

static iso_status make_field(const isosculpt_settings *settings, iso_pool *pool, iso_file_set *files,
                             isosculpt_report *report, iso_hgrid **grid, iso_error *error) {
    iso_journal_start *start = &report->start;
    const isosculpt_source source = {.path = settings->open,
                                     .isovalue = settings->isovalue,
                                     .voxel = settings->voxel_size,
                                     .pool = pool,
                                     .close_holes = settings->close_holes,
                                     .report = &report->opened_mesh,
                                     .input = &settings->common.input,
                                     .parts = &report->parts,
                                     .files = files,
                                     .notes = !settings->common.quiet};
    if (settings->open) return isosculpt_source_open(&source, start, grid, error);
    if (strcmp(start->source, "ball") != 0)
        return isosculpt_source_find(settings->replay, &source, start, grid, error);
    if (settings->voxel_size > 0) ISO_TRY(rescale(start, settings->voxel_size, error));
    return iso_session_ball(start, grid, error);
}

static void say_parts(const isosculpt_settings *settings, const isosculpt_report *report) {
    const iso_components_totals *parts = &report->parts;
    if (settings->common.quiet || !parts->kept) return;
    iso_program_log(isosculpt_program(),
                    "%s: kept %zu of %zu parts of the solid, dropped %zu with %.3g %% of its volume (%.6g of "
                    "%.6g mm3)",
                    report->start.source, parts->kept, parts->kept + parts->dropped, parts->dropped,
                    100 * parts->dropped_share, parts->dropped_volume,
                    parts->kept_volume + parts->dropped_volume);
}

/* ---- playing */

typedef struct player {
    const isosculpt_settings *settings;
    isosculpt_report *report;
    iso_pool *pool;
    iso_session *session;
    iso_point_set *points;
    isosculpt_view *view;   /* NULL: nothing is drawn */
    const char *written[2]; /* outputs that stand */
} player;

static iso_status extract(player *p, iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(iso_point_set_update(p->points, error));
    return add_time(&p->report->extract, iso_clock_seconds() - start, error);
}

static iso_status draw(player *p, iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(isosculpt_view_draw(p->view, p->report->resolution[0], p->report->resolution[1], true, error));
    return add_time(&p->report->draw, iso_clock_seconds() - start, error);
}

static void count(isosculpt_report *report, const iso_event *event, const iso_edit_stats *surface_isovalue) {
    report->strokes += event->kind == ISO_EVENT_BEGIN;
    report->undone += event->kind == ISO_EVENT_UNDO;
    report->samples += event->kind <= ISO_EVENT_SAMPLE;
    report->edits.edited += surface_isovalue->edited;
    report->edits.redistanced += surface_isovalue->redistanced;
    report->edits.created += surface_isovalue->created;
    report->edits.pruned += surface_isovalue->pruned;
    report->edits.clipped |= surface_isovalue->clipped;
}

static iso_status play(player *p, const iso_event *event, iso_error *error) {
    iso_edit_stats surface_isovalue = {0};
    double start = iso_clock_seconds();
    ISO_TRY(iso_session_play(p->session, event, &surface_isovalue, error));
    count(p->report, event, &surface_isovalue);
    if (event->kind > ISO_EVENT_SAMPLE) return ISO_OK;
    ISO_TRY(add_time(&p->report->edit, iso_clock_seconds() - start, error));
    if (p->points) ISO_TRY(extract(p, error));
    if (p->view) ISO_TRY(draw(p, error));
    return add_time(&p->report->step, iso_clock_seconds() - start, error);
}

static iso_status play_all(player *p, iso_journal_reader *reader, iso_error *error) {
    iso_event event;
    bool more = true, drawing = false;
    for (;;) {
        ISO_TRY(iso_journal_next(reader, &event, &more, error));
        if (!more) break;
        ISO_TRY(iso_journal_add_location(reader, play(p, &event, error), error));
        if (event.kind <= ISO_EVENT_CANCEL) drawing = event.kind <= ISO_EVENT_SAMPLE;
    }
    if (!drawing) return ISO_OK;
    return iso_journal_add_location(reader, iso_session_end(p->session, error),
                                    error); /* it broke off here */
}

/* ---- outputs */

static const char *name_of(const isosculpt_settings *settings) {
    return settings->replay ? settings->replay : settings->open;
}

static iso_status write_points(player *p, const char *path, iso_error *error) {
    iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    iso_points_opts opts = {.floats = true, .pool = p->pool};
    iso_point_set *set;
    ISO_TRY(iso_point_set_create(&grid, &opts, &set, error));
    iso_status status = iso_point_set_update(set, error);
    iso_point_view view = iso_point_set_view(set);
    p->report->points = iso_point_view_count(&view);
    if (status == ISO_OK && p->report->points == 0)
        status = iso_fail(error, ISO_ERR_EMPTY, "%s: nothing is left of the solid", name_of(p->settings));
    if (status == ISO_OK && path) status = iso_points_write_ply(path, &view, "isosculpt", error);
    iso_point_set_destroy(set);
    return status;
}

/* Measured as well when there is a report to say it in. */
static iso_status write_welded(player *p, const char *path, const iso_mesh_view *view, iso_error *error) {
    iso_weld weld;
    ISO_TRY(iso_mesh_weld(view, &weld, error));
    iso_status status = ISO_OK;
    if (p->settings->common.json) {
        p->report->has_mesh = true;
        status = iso_weld_measure(&weld, &view->transform, p->pool, &p->report->mesh, error);
    }
    if (status == ISO_OK) status = iso_mesh_write_weld(path, &weld, &view->transform, "isosculpt", error);
    iso_weld_free(&weld);
    return status;
}

static iso_status write_mesh(player *p, const char *path, iso_error *error) {
    iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    iso_mesh_opts opts = {.pool = p->pool};
    iso_mesh_set *set;
    ISO_TRY(iso_mesh_set_create(&grid, &opts, &set, error));
    iso_status status = iso_mesh_set_update(set, error);
    iso_mesh_view view = iso_mesh_set_view(set);
    if (status == ISO_OK) status = write_welded(p, path, &view, error);
    iso_mesh_set_destroy(set);
    return status;
}

static iso_status write_outputs(player *p, iso_error *error) {
    const isosculpt_settings *settings = p->settings;
    const char *output = settings->output;
    bool points = output && iso_text_ends_with(output, ".ply");
    ISO_TRY(write_points(p, points ? output : NULL, error));
    if (output && iso_text_ends_with(output, ".vdb"))
        ISO_TRY(iso_level_set_write_vdb(output, iso_session_grid(p->session), "surface", NULL, error));
    else if (output && !points)
        ISO_TRY(write_mesh(p, output, error));
    p->written[0] = output;
    if (settings->mesh) ISO_TRY(write_mesh(p, settings->mesh, error));
    p->written[1] = settings->mesh;
    return settings->common.json ? isosculpt_report_write(settings, p->report, error) : ISO_OK;
}

/* What cannot be written is known before the work is done. */
static iso_status check_outputs(const isosculpt_settings *settings, iso_file_set *files, iso_error *error) {
    const char *const outputs[] = {settings->output, settings->mesh, settings->common.json_path};
    for (int i = 0; i < 3; i++) iso_file_set_write(files, outputs[i]);
    ISO_TRY(iso_file_set_check(files, error));
    for (int i = 0; i < 3; i++) ISO_TRY(iso_sink_check(outputs[i], error));
    return ISO_OK;
}

/* What a window would have made before the first stroke. */
static iso_status prepare(player *p, iso_error *error) {
    const int *size = p->report->resolution;
    iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    iso_points_opts opts = {.pool = p->pool};
    if (p->settings->extract) {
        ISO_TRY(iso_point_set_create(&grid, &opts, &p->points, error));
        ISO_TRY(iso_point_set_update(p->points, error));
    }
    if (!p->view) return ISO_OK;
    ISO_TRY(isosculpt_view_init(p->view, grid.hgrid, p->pool, error));
    return isosculpt_view_draw(p->view, size[0], size[1], false, error);
}

static iso_status run(player *p, iso_journal_reader *reader, iso_error *error) {
    ISO_TRY(prepare(p, error));
    double start = iso_clock_seconds();
    if (reader) ISO_TRY(play_all(p, reader, error));
    p->report->total = iso_clock_seconds() - start;
    const iso_hgrid *grid = iso_session_grid(p->session);
    p->report->bricks = iso_hgrid_brick_count(grid);
    p->report->bytes = iso_hgrid_bytes(grid);
    iso_status status = write_outputs(p, error);
    for (int i = 0; status != ISO_OK && i < 2; i++) iso_file_remove(p->written[i]); /* all or none */
    ISO_TRY(status);
    if (!p->settings->common.quiet && p->report->edits.clipped)
        iso_program_log(isosculpt_program(), "%s: a brush reached beyond the grid: what lies outside is lost",
                        name_of(p->settings));
    char note[240];
    if (!p->settings->common.quiet && iso_mesh_report_note(&p->report->opened_mesh, note, sizeof note))
        iso_program_log(isosculpt_program(), "%s: %s", p->settings->open, note);
    return ISO_OK;
}

iso_status isosculpt_replay(const isosculpt_settings *settings, iso_pool *pool, iso_error *error) {
    isosculpt_report report = {0};
    iso_journal_reader *reader = NULL;
    if (settings->replay) ISO_TRY(iso_journal_open(settings->replay, &report.start, &reader, error));
    const double own = report.start.voxel_size;
    isosculpt_view view = {0};
    player p = {.settings = settings, .report = &report, .pool = pool, .view = settings->draw ? &view : NULL};
    report.resolution[0] = settings->resolution[0] ? settings->resolution[0] : 1280;
    report.resolution[1] = settings->resolution[1] ? settings->resolution[1] : 800;
    iso_hgrid *grid = NULL;
    iso_session_opts opts = {.pool = pool, .undo_memory = (size_t)settings->undo_memory};
    iso_file_set files = {0};
    if (settings->replay) iso_file_set_read(&files, settings->replay);
    iso_status status = make_field(settings, pool, &files, &report, &grid, error);
    if (status == ISO_OK && (status = check_outputs(settings, &files, error)) != ISO_OK)
        iso_hgrid_destroy(grid);
    iso_file_set_free(&files);
    if (status == ISO_OK) say_parts(settings, &report);
    if (status == ISO_OK && reader) opts.cost_factor = fmax(1, pow(own / grid->transform.spacing[0], 3));
    if (status == ISO_OK) status = iso_session_create(grid, &report.start, &opts, &p.session, error);
    if (status == ISO_OK) status = run(&p, reader, error);
    iso_point_set_destroy(p.points);
    isosculpt_view_free(&view);
    iso_session_destroy(p.session);
    iso_journal_reader_free(reader);
    isosculpt_report_free(&report);
    return status;
}

/* ---- the report */

static void put_times(iso_json *json, const char *key, const isosculpt_times *times) {
    if (!times->count) return;
    qsort(times->seconds, times->count, sizeof *times->seconds, iso_compare_doubles);
    iso_json_begin_object(json, key);
    iso_json_integer(json, "count", times->count);
    iso_json_real(json, "p50", times->seconds[times->count / 2]);
    iso_json_real(json, "p99", times->seconds[times->count * 99 / 100]);
    iso_json_real(json, "max", times->seconds[times->count - 1]);
    iso_json_end_object(json);
}

/* What a mesh that was opened needed to be closed. */
static void put_opened_mesh(iso_json *json, const iso_mesh_report *mesh) {
    if (!mesh->triangles) return;
    iso_json_begin_object(json, "opened_mesh");
    iso_json_integer(json, "triangles", mesh->triangles);
    iso_json_integer(json, "open_edges", mesh->open_edges);
    iso_json_integer(json, "holes_closed", mesh->holes_closed);
    iso_json_integer(json, "loops_capped", mesh->loops_capped);
    iso_json_real(json, "largest_hole", mesh->largest_hole);
    iso_json_integer(json, "turned", mesh->turned);
    iso_json_bool(json, "inside_out", mesh->volume < 0);
    iso_json_real(json, "volume", fabs(mesh->volume));
    iso_json_end_object(json);
}

static void put_report(FILE *stream, const isosculpt_settings *settings, const isosculpt_report *report) {
    iso_json json = {.stream = stream};
    iso_json_begin_object(&json, NULL);
    iso_json_string(&json, "schema", "isosculpt 1");
    iso_json_string(&json, "version", isosculpt_program()->version);
    if (settings->replay) iso_json_string(&json, "strokes_file", settings->replay);
    iso_json_string(&json, "source", report->start.source);
    iso_json_ints(&json, "dims", report->start.dims, 3);
    iso_json_real(&json, "voxel_size", report->start.voxel_size);
    put_opened_mesh(&json, &report->opened_mesh);
    if (report->parts.kept) iso_put_components(&json, "parts", &report->parts);
    if (report->has_mesh) iso_put_mesh_measures(&json, "mesh", &report->mesh);
    iso_json_integer(&json, "strokes", report->strokes);
    iso_json_integer(&json, "samples", report->samples);
    iso_json_integer(&json, "undone", report->undone);
    iso_json_integer(&json, "cells_edited", report->edits.edited);
    iso_json_integer(&json, "cells_redistanced", report->edits.redistanced);
    iso_json_integer(&json, "cells_created", report->edits.created);
    iso_json_integer(&json, "cells_pruned", report->edits.pruned);
    iso_json_bool(&json, "clipped", report->edits.clipped);
    iso_json_integer(&json, "bricks", report->bricks);
    iso_json_integer(&json, "bytes", report->bytes);
    iso_json_integer(&json, "points", report->points);
    iso_json_integer(&json, "peak_bytes", iso_memory_peak());
    if (settings->draw) iso_json_ints(&json, "resolution", report->resolution, 2);
    iso_json_begin_object(&json, "seconds");
    iso_json_real(&json, "total", report->total);
    put_times(&json, "edit", &report->edit);
    put_times(&json, "extract", &report->extract);
    put_times(&json, "draw", &report->draw);
    put_times(&json, "step", &report->step);
    iso_json_end_object(&json);
    iso_json_end_object(&json);
}

iso_status isosculpt_report_write(const isosculpt_settings *settings, const isosculpt_report *report,
                                  iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(settings->common.json_path ? settings->common.json_path : "-", &sink, error));
    put_report(sink.stream, settings, report);
    return iso_sink_commit(&sink, error);
}
