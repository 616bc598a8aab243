/* Headless: makes a field, plays a stroke file on it, writes the outputs and the report. */
#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/json.h"
#include "apps/common/json_parts.h"
#include "apps/common/progress_bar.h"
#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/reference_file.h"
#include "apps/isosculpt/save.h"
#include "apps/isosculpt/time_lapse.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "base/numbers.h"
#include "scene/solid.h"
#include "source/label.h"

/* The durations of all samples. */
typedef struct times {
    double *seconds; /* owned */
    size_t count, room;
} times;

/* The contents of the report of --json. */
typedef struct report {
    iso_journal_start start;
    iso_mesh_report opened_mesh; /* of the opened file, when it is a mesh */
    size_t strokes, samples, undone;
    iso_edit_stats edits;
    times edit, extract, draw, step; /* step: everything that a sample takes */
    times stroke_edit;               /* edits of past strokes */
    iso_versions_stats versions;
    iso_stroke_list list; /* owned; of strokes, as they are in the result */
    double total;         /* seconds */
    size_t bricks, bytes, points;
    iso_components_totals parts; /* of the opened file; zero unless parts could be dropped */
    const char *mesh_path;       /* of the mesh that was written; NULL: none */
    iso_mesh_measures mesh;      /* of that mesh */
    isosculpt_measured measured; /* of --measure */
    int resolution[2];           /* pixels, of --draw */
    iso_label_changes *label;    /* owned; of the segmentation that was written; NULL: none */
} report;

static iso_status add_time(times *list, double seconds, iso_error *error) {
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 1024;
        double *larger = realloc(list->seconds, room * sizeof *larger);
        if (!larger) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu times", room);
        list->seconds = larger;
        list->room = room;
    }
    list->seconds[list->count++] = seconds;
    return ISO_OK;
}

static void free_times(report *r) {
    free(r->edit.seconds);
    free(r->extract.seconds);
    free(r->draw.seconds);
    free(r->step.seconds);
    free(r->stroke_edit.seconds);
    iso_stroke_list_free(&r->list);
    free(r->label);
}

/* ---- the field that the session began with */

static void log_note(const char *text) {
    iso_program_log(isosculpt_program(), "%s", text);
}

/* How far opening is, for the bar: any thread tells it, one at a time shows it. */
typedef struct opening {
    atomic_flag busy;
    int percent;
} opening;

/* iso_progress.tell. -1 asks whether to cancel. */
static int show_opening(void *context, double fraction) {
    opening *o = context;
    const int percent = (int)(100 * fraction);
    if (fraction < 0 || atomic_flag_test_and_set(&o->busy)) return 0;
    if (percent > o->percent) iso_progress_bar_show("opening", percent);
    o->percent = percent > o->percent ? percent : o->percent;
    atomic_flag_clear(&o->busy);
    return 0;
}

static iso_status make_field(const isosculpt_settings *settings, iso_pool *pool, iso_file_set *files,
                             report *r, iso_hgrid **grid, iso_cell_items *paint, iso_error *error) {
    iso_journal_start *start = &r->start;
    opening shown = {.busy = ATOMIC_FLAG_INIT};
    const iso_progress bar = {.tell = show_opening, .context = &shown};
    const bool shows = !settings->common.quiet && iso_progress_bar_possible();
    const iso_source source = {.path = settings->open,
                               .solid = &settings->solid,
                               .progress = shows ? &bar : NULL,
                               .isovalue = settings->isovalue,
                               .voxel = settings->voxel_size,
                               .pool = pool,
                               .close_holes = settings->close_holes,
                               .report = &r->opened_mesh,
                               .input = &settings->common.input,
                               .parts = &r->parts,
                               .paint = paint,
                               .files = files,
                               .note = settings->common.quiet ? NULL : log_note};
    if (settings->open || isosculpt_has_new(settings)) return iso_source_open(&source, start, grid, error);
    return iso_source_reopen(settings->replay, &source, start, grid, error);
}

static void log_parts(const isosculpt_settings *settings, const report *r) {
    const iso_components_totals *parts = &r->parts;
    if (settings->common.quiet || !parts->kept) return;
    iso_program_log(isosculpt_program(),
                    "%s: kept %zu of %zu parts of the solid, dropped %zu with %.3g %% of its volume (%.6g of "
                    "%.6g mm3)",
                    r->start.source, parts->kept, parts->kept + parts->dropped, parts->dropped,
                    100 * parts->dropped_share, parts->dropped_volume,
                    parts->kept_volume + parts->dropped_volume);
}

/* ---- playing */

enum { OUTPUTS = 4 };

typedef struct player {
    const isosculpt_settings *settings;
    report *report;
    iso_pool *pool;
    iso_session *session;
    iso_point_set *points;
    isosculpt_viewport *viewport; /* NULL: nothing is drawn */
    const char *written[OUTPUTS]; /* outputs written so far */
    iso_buffer events;            /* iso_event: the edits of the command line */
    size_t event_count;
    iso_grid first; /* owned; the field before any stroke, if the output is a segmentation */
} player;

static iso_status extract_timed(player *p, iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(iso_point_set_update(p->points, error));
    return add_time(&p->report->extract, iso_clock_seconds() - start, error);
}

static iso_status draw_timed(player *p, iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(isosculpt_viewport_draw(p->viewport, p->report->resolution[0], p->report->resolution[1], true,
                                    error));
    if (p->viewport->reference_error.text[0])
        return iso_fail(error, ISO_ERR_NOMEM, "%s", p->viewport->reference_error.text);
    return add_time(&p->report->draw, iso_clock_seconds() - start, error);
}

static void count_event(report *r, const iso_event *event, const iso_edit_stats *stats) {
    r->strokes += event->kind == ISO_EVENT_BEGIN;
    r->undone += event->kind == ISO_EVENT_UNDO;
    r->samples += event->kind <= ISO_EVENT_SAMPLE;
    r->edits.edited += stats->edited;
    r->edits.redistanced += stats->redistanced;
    r->edits.created += stats->created;
    r->edits.pruned += stats->pruned;
    r->edits.clipped |= stats->clipped;
}

static iso_status play_event(player *p, const iso_event *event, iso_error *error) {
    iso_edit_stats stats = {0};
    double start = iso_clock_seconds();
    ISO_TRY(iso_session_play(p->session, event, &stats, error));
    count_event(p->report, event, &stats);
    if (event->kind > ISO_EVENT_SAMPLE) return ISO_OK;
    ISO_TRY(add_time(&p->report->edit, iso_clock_seconds() - start, error));
    if (p->points) ISO_TRY(extract_timed(p, error));
    if (p->viewport) ISO_TRY(draw_timed(p, error));
    return add_time(&p->report->step, iso_clock_seconds() - start, error);
}

static iso_status play_all(player *p, iso_journal_reader *reader, iso_error *error) {
    iso_event event;
    bool more = true, drawing = false;
    for (;;) {
        ISO_TRY(iso_journal_next(reader, &event, &more, error));
        if (!more) break;
        ISO_TRY(iso_journal_add_location(reader, play_event(p, &event, error), error));
        if (event.kind <= ISO_EVENT_CANCEL) drawing = event.kind <= ISO_EVENT_SAMPLE;
    }
    if (!drawing) return ISO_OK;
    return iso_journal_add_location(reader, iso_session_end_cut_off(p->session, error),
                                    error); /* for a file that ends within a stroke */
}

/* ---- edits of strokes */

static iso_status edit_timed(player *p, const iso_event *event, iso_buffer *events, size_t *count,
                             iso_error *error) {
    const double start = iso_clock_seconds();
    ISO_TRY(iso_session_edit(p->session, event, error));
    ISO_TRY(add_time(&p->report->stroke_edit, iso_clock_seconds() - start, error));
    const size_t bytes = *count * sizeof *event;
    ISO_TRY(iso_buffer_reserve(events, bytes + sizeof *event, bytes, error));
    ((iso_event *)events->data)[(*count)++] = *iso_session_last_edit(p->session);
    return ISO_OK;
}

/* Makes an edit of the command line: --edit of each stroke in its range. */
static iso_status make_edit(player *p, const isosculpt_edit *edit, iso_buffer *events, size_t *count,
                            iso_error *error) {
    iso_stroke_list list = {.count = 0};
    iso_event event;
    size_t found = 0;
    iso_status status = iso_session_strokes(p->session, &list, error);
    for (size_t i = 0; status == ISO_OK && edit->kind == ISO_EVENT_EDIT && i < list.count; i++) {
        const iso_stroke *stroke = iso_stroke_at(&list, i);
        if (!isosculpt_edit_names(edit, stroke)) continue;
        found++;
        status = isosculpt_edit_event(edit, stroke, &event, error);
        if (status == ISO_OK) status = edit_timed(p, &event, events, count, error);
        if (status == ISO_OK) status = iso_session_strokes(p->session, &list, error);
    }
    if (status == ISO_OK && !found) { /* (--edit of no stroke is refused) */
        status = isosculpt_edit_event(edit, &(iso_stroke){.number = edit->first, .brush = {.radius = 1}},
                                      &event, error);
        if (status == ISO_OK) status = edit_timed(p, &event, events, count, error);
    }
    iso_stroke_list_free(&list);
    if (status == ISO_OK || !error) return status;
    const iso_error why = *error;
    return iso_fail(error, status, "%s: strokes %s: %s", p->settings->replay, edit->text, why.text);
}

/* ---- the report */

static void put_times(iso_json *json, const char *key, const times *list) {
    if (!list->count) return;
    qsort(list->seconds, list->count, sizeof *list->seconds, iso_compare_doubles);
    iso_json_begin_object(json, key);
    iso_json_integer(json, "count", list->count);
    iso_json_real(json, "p50", list->seconds[list->count / 2]);
    iso_json_real(json, "p95", list->seconds[list->count * 95 / 100]);
    iso_json_real(json, "p99", list->seconds[list->count * 99 / 100]);
    iso_json_real(json, "max", list->seconds[list->count - 1]);
    iso_json_end_object(json);
}

/* Writes how the opened mesh was closed. */
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

/* Writes what the label has gained and lost in the segmentation. */
static void put_label(iso_json *json, const report *r) {
    if (!r->label) return;
    iso_json_begin_object(json, "label");
    iso_json_integer(json, "value", (uint64_t)iso_source_label(&r->start));
    iso_json_integer(json, "added", r->label->added);
    iso_json_integer(json, "removed", r->label->removed);
    iso_json_begin_object(json, "taken_from");
    for (int value = 0; value <= ISO_LABEL_VALUE_MAX; value++) {
        char key[16];
        snprintf(key, sizeof key, "%d", value);
        if (r->label->taken[value]) iso_json_integer(json, key, r->label->taken[value]);
    }
    iso_json_end_object(json);
    iso_json_end_object(json);
}

/* Writes the strokes of the result, in the order in which they are drawn. */
static void put_strokes(iso_json *json, const report *r) {
    iso_json_begin_array(json, "stroke_list");
    for (size_t i = 0; i < r->list.count; i++) {
        const iso_stroke *stroke = iso_stroke_at(&r->list, i);
        iso_json_begin_object(json, NULL);
        iso_json_integer(json, "stroke", stroke->number);
        iso_json_string(json, "tool", iso_tool_name(stroke->brush.tool));
        iso_json_real(json, "radius", stroke->brush.radius);
        iso_json_integer(json, "samples", stroke->count);
        iso_json_bool(json, "muted", stroke->muted);
        if (stroke->group[0]) iso_json_string(json, "group", stroke->group);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}

static void put_report(iso_json *json, const isosculpt_settings *settings, const report *r) {
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "schema", "isosculpt/1");
    iso_json_string(json, "version", isosculpt_program()->version);
    if (settings->replay) iso_json_string(json, "strokes_file", settings->replay);
    iso_json_string(json, "source", r->start.source);
    iso_json_ints(json, "dims", r->start.dims, 3);
    iso_json_real(json, "voxel_size", r->start.voxel_size);
    put_opened_mesh(json, &r->opened_mesh);
    if (r->parts.kept) iso_put_components(json, "solid_parts", &r->parts);
    if (r->mesh_path) iso_put_mesh_measures(json, "mesh", &r->mesh);
    put_label(json, r);
    if (settings->measure.on) isosculpt_put_measured(json, &r->measured);
    iso_json_integer(json, "strokes", r->strokes);
    iso_json_integer(json, "samples", r->samples);
    iso_json_integer(json, "undone", r->undone);
    if (settings->replay) put_strokes(json, r);
    if (r->versions.strokes) iso_json_integer(json, "strokes_drawn_again", r->versions.drawn);
    if (r->versions.strokes) iso_json_integer(json, "version_bytes", r->versions.bytes);
    if (r->versions.in_files) iso_json_integer(json, "version_bytes_in_files", r->versions.in_files);
    iso_json_integer(json, "cells_edited", r->edits.edited);
    iso_json_integer(json, "cells_redistanced", r->edits.redistanced);
    iso_json_integer(json, "cells_created", r->edits.created);
    iso_json_integer(json, "cells_pruned", r->edits.pruned);
    iso_json_bool(json, "clipped", r->edits.clipped);
    iso_json_integer(json, "bricks", r->bricks);
    iso_json_integer(json, "bytes", r->bytes);
    iso_json_integer(json, "points", r->points);
    iso_json_integer(json, "peak_bytes", iso_memory_peak());
    if (settings->draw) iso_json_ints(json, "resolution", r->resolution, 2);
    iso_json_begin_object(json, "seconds");
    iso_json_real(json, "total", r->total);
    put_times(json, "edit", &r->edit);
    put_times(json, "extract", &r->extract);
    put_times(json, "draw", &r->draw);
    put_times(json, "step", &r->step);
    put_times(json, "stroke_edit", &r->stroke_edit);
    iso_json_end_object(json);
    iso_json_end_object(json);
}

static iso_status write_report(const isosculpt_settings *settings, const report *r, iso_error *error) {
    iso_sink sink;
    iso_json json = {0};
    ISO_TRY(iso_sink_open(settings->common.json_path ? settings->common.json_path : "-", &sink, error));
    put_report(&json, settings, r);
    return iso_json_commit(&json, &sink, error);
}

/* ---- outputs */

static const char *input_name(const isosculpt_settings *settings) {
    return settings->replay ? settings->replay : settings->open ? settings->open : "--new";
}

/* Whether the output is the segmentation that the session began with. */
static bool writes_label(const isosculpt_settings *settings) {
    const unsigned others = ISO_WRITES_VOLUME | ISO_WRITES_POINTS | ISO_WRITES_MESH;
    return settings->output && iso_file_type_of_name(settings->output, others) == ISO_FILE_UNKNOWN;
}

static iso_painted paint_of(const player *p) {
    return iso_painted_make(iso_session_paint(p->session), iso_session_grid(p->session),
                            ISOSCULPT_SURFACE_COLOR);
}

static iso_status write_points(player *p, const char *path, iso_error *error) {
    const iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    iso_scene_surface surface = {
        .grid = grid, .primitive = ISO_PRIMITIVE_EDGE, .bounded = true, .floats = true, .pool = p->pool};
    iso_status status = iso_scene_surface_update(&surface, ISO_PART_POINTS, error);
    if (status == ISO_OK) {
        const iso_point_view view = iso_scene_surface_points(&surface);
        const iso_painted painted = paint_of(p);
        const iso_coloring coloring = iso_painted_coloring(&painted);
        p->report->points = iso_point_view_count(&view);
        if (p->report->points == 0 && !writes_label(p->settings)) /* (a label may be removed) */
            status =
                iso_fail(error, ISO_ERR_EMPTY, "%s: nothing is left of the solid", input_name(p->settings));
        else if (path)
            status = iso_solid_write_points(path, &view, iso_painted_any(&painted) ? &coloring : NULL,
                                            p->pool, "isosculpt", error);
    }
    iso_scene_surface_free(&surface);
    return status;
}

static iso_status write_mesh(player *p, const char *path, iso_error *error) {
    const iso_painted painted = paint_of(p);
    const iso_coloring coloring = iso_painted_coloring(&painted);
    const iso_solid_mesh_opts opts = {.closed = p->settings->closed != 0,
                                      .coloring = iso_painted_any(&painted) ? &coloring : NULL,
                                      .measures = &p->report->mesh,
                                      .pool = p->pool};
    p->report->mesh_path = path;
    return iso_solid_write(path, iso_session_grid(p->session), &opts, "isosculpt", NULL, NULL, error);
}

static iso_status write_level_set(player *p, const char *path, iso_error *error) {
    const iso_painted painted = paint_of(p);
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    const iso_status status =
        iso_painted_put_vdb(sink.stream, path, iso_session_grid(p->session), &painted, NULL, error);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}

/* The stroke file that the session's source is sought beside. */
static const char *strokes_of(const isosculpt_settings *settings) {
    return settings->replay && !settings->open ? settings->replay : "";
}

static iso_status write_label(player *p, const char *path, iso_error *error) {
    iso_sink sink;
    p->report->label = calloc(1, sizeof *p->report->label);
    if (!p->report->label) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_status status =
        iso_source_label_write(strokes_of(p->settings), &p->report->start, p->first.hgrid,
                               iso_session_grid(p->session), sink.stream, NULL, p->report->label, error);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}

static iso_film_opts film_of(const isosculpt_settings *settings) {
    return (iso_film_opts){.path = settings->video,
                           .width = settings->resolution[0],
                           .height = settings->resolution[1],
                           .frame_rate = settings->frame_rate,
                           .seconds = settings->replay ? settings->seconds : 0,
                           .turn_seconds = settings->turntable,
                           .title = input_name(settings)};
}

/* Makes the first field again, and draws the strokes that are left. */
static iso_status write_video(player *p, iso_error *error) {
    report again = {.start = p->report->start};
    iso_cell_items paint = {.cell = NULL};
    iso_file_set files = {0};
    isosculpt_time_lapse lapse = {.film = film_of(p->settings),
                                  .start = &again.start,
                                  .strokes = &p->report->list,
                                  .result = iso_session_grid(p->session),
                                  .paint = &paint,
                                  .pool = p->pool};
    iso_status status = make_field(p->settings, p->pool, &files, &again, &lapse.first, &paint, error);
    iso_progress_bar_clear();
    if (status == ISO_OK) status = isosculpt_time_lapse_write(&lapse, error);
    iso_cell_items_free(&paint);
    iso_file_set_free(&files);
    return status;
}

static iso_status write_outputs(player *p, iso_error *error) {
    const isosculpt_settings *settings = p->settings;
    const char *output = settings->output;
    bool points = output && iso_file_type_of_name(output, ISO_WRITES_POINTS) != ISO_FILE_UNKNOWN;
    ISO_TRY(write_points(p, points ? output : NULL, error));
    if (writes_label(settings))
        ISO_TRY(write_label(p, output, error));
    else if (output && iso_file_type_of_name(output, ISO_WRITES_VOLUME) != ISO_FILE_UNKNOWN)
        ISO_TRY(write_level_set(p, output, error));
    else if (output && !points)
        ISO_TRY(write_mesh(p, output, error));
    p->written[0] = output;
    if (settings->mesh) ISO_TRY(write_mesh(p, settings->mesh, error));
    p->written[1] = settings->mesh;
    if (settings->save_strokes)
        ISO_TRY(iso_journal_rewrite(settings->replay, p->events.data, p->event_count, settings->save_strokes,
                                    error));
    p->written[2] = settings->save_strokes;
    if (settings->video) ISO_TRY(write_video(p, error));
    p->written[3] = settings->video;
    return settings->common.json ? write_report(settings, p->report, error) : ISO_OK;
}

/* Checks, before the work begins, whether all outputs can be written. */
static iso_status check_outputs(const isosculpt_settings *settings, iso_file_set *files,
                                const iso_journal_start *start, iso_error *error) {
    const char *const outputs[] = {settings->output, settings->mesh, settings->common.json_path,
                                   settings->save_strokes, settings->video};
    enum { COUNT = sizeof outputs / sizeof *outputs };
    const iso_film_opts film = film_of(settings);
    for (int i = 0; i < settings->references.count; i++)
        iso_file_set_read(files, settings->references.values[i]);
    for (int i = 0; i < COUNT; i++) iso_file_set_write(files, outputs[i]);
    ISO_TRY(iso_file_set_check(files, error));
    for (int i = 0; i < COUNT; i++) ISO_TRY(iso_sink_check(outputs[i], error));
    if (settings->video) ISO_TRY(iso_film_check(&film, error));
    return writes_label(settings)
               ? iso_source_label_check(strokes_of(settings), start, settings->output, error)
               : ISO_OK;
}

/* Copies the field before any stroke is replayed. */
static iso_status copy_reference(const player *p, isosculpt_reference **reference, iso_error *error) {
    const iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    iso_grid copy;
    ISO_TRY(iso_grid_copy(&grid, p->pool, &copy, error));
    return isosculpt_reference_create(copy.hgrid, iso_pool_threads(p->pool), reference, error);
}

static iso_status read_reference(const player *p, isosculpt_reference **reference, iso_error *error) {
    isosculpt_reference_files files = {.settings = p->settings,
                                       .voxel = iso_session_grid(p->session)->transform.spacing[0],
                                       .box = isosculpt_viewport_bounds(p->viewport)};
    ISO_TRY(isosculpt_reference_read(&files, reference, error));
    for (int i = 0; i < files.note_count && !p->settings->common.quiet; i++)
        iso_program_log(isosculpt_program(), "note: %s", files.notes[i]);
    return ISO_OK;
}

static iso_status add_reference(player *p, iso_error *error) {
    const bool files = p->settings->references.count > 0;
    isosculpt_reference *reference;
    if (p->settings->x_ray == ISOSCULPT_X_RAY_OFF && !files) return ISO_OK;
    ISO_TRY(files ? read_reference(p, &reference, error) : copy_reference(p, &reference, error));
    isosculpt_viewport_set_reference(p->viewport, reference);
    p->viewport->reference_mode.shown = true;
    p->viewport->reference_mode.over = p->settings->x_ray == ISOSCULPT_X_RAY_OVER;
    return ISO_OK;
}

/* Extracts and draws the surface, as a window does before the first stroke. */
static iso_status prepare(player *p, iso_error *error) {
    const int *size = p->report->resolution;
    iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    iso_points_opts opts = {.pool = p->pool};
    if (p->settings->extract) {
        ISO_TRY(iso_point_set_create(&grid, &opts, &p->points, error));
        ISO_TRY(iso_point_set_update(p->points, error));
    }
    if (writes_label(p->settings)) ISO_TRY(iso_grid_copy(&grid, p->pool, &p->first, error));
    if (!p->viewport) return ISO_OK;
    ISO_TRY(isosculpt_viewport_init(p->viewport, grid.hgrid, p->pool, error));
    p->viewport->painted =
        iso_painted_make(iso_session_paint(p->session), grid.hgrid, ISOSCULPT_SURFACE_COLOR);
    p->viewport->painted.log = iso_session_paint_log(p->session);
    ISO_TRY(add_reference(p, error));
    return isosculpt_viewport_draw(p->viewport, size[0], size[1], false, error);
}

/* Prints how the opened mesh was closed, and whether the written mesh is open. */
static void log_mesh_notes(const player *p) {
    char note[240];
    if (p->settings->common.quiet) return;
    if (iso_mesh_report_note(&p->report->opened_mesh, note, sizeof note))
        iso_program_log(isosculpt_program(), "%s: %s", p->settings->open, note);
    if (!p->report->mesh_path || !p->report->mesh.open_edges) return;
    isosculpt_mesh_open_note(p->report->mesh.open_edges, note, sizeof note);
    iso_program_log(isosculpt_program(), "%s: %s", p->report->mesh_path, note);
}

/* Prints one line for each file that was written, with the size of what it holds. */
static void log_outputs(const player *p) {
    const iso_program *program = isosculpt_program();
    const char *input = input_name(p->settings);
    if (p->settings->common.quiet) return;
    if (p->settings->measure.on) isosculpt_tell_measured(&p->report->measured, log_note);
    if (!p->written[0] && !p->written[1] && !p->written[2] && !p->written[3] && !p->settings->common.json &&
        !p->settings->measure.on)
        iso_program_log(program, "%s: note: nothing is written: --output or --mesh names a file", input);
    for (int i = 0; i < OUTPUTS; i++) {
        const char *path = p->written[i];
        if (path && path == p->report->mesh_path)
            iso_program_log(program, "%s: wrote %s: %zu triangles", input, path, p->report->mesh.triangles);
        else if (path && iso_file_type_of_name(path, ISO_WRITES_POINTS) != ISO_FILE_UNKNOWN)
            iso_program_log(program, "%s: wrote %s: %zu points", input, path, p->report->points);
        else if (path && path == p->settings->output && p->report->label)
            iso_program_log(program, "%s: wrote %s: label %d gained %" PRIu64 " voxels and lost %" PRIu64,
                            input, path, iso_source_label(&p->report->start), p->report->label->added,
                            p->report->label->removed);
        else if (path)
            iso_program_log(program, "%s: wrote %s", input, path);
    }
}

static iso_status measure(player *p, iso_error *error) {
    const iso_grid grid = {.hgrid = iso_session_grid(p->session)};
    const iso_status status =
        isosculpt_measure(&p->settings->measure, &grid, p->pool, &p->report->measured, error);
    if (status != ISO_ERR_EMPTY) return status;
    return iso_fail(error, status, "%s: nothing is left of the solid", input_name(p->settings));
}

static iso_status play_and_write(player *p, iso_journal_reader *reader, iso_error *error) {
    ISO_TRY(prepare(p, error));
    if (p->settings->freezing.on)
        ISO_TRY(isosculpt_freeze(p->session, p->settings->open, &p->settings->common.input,
                                 iso_source_label(&p->report->start), &p->settings->freezing, p->pool,
                                 error));
    double start = iso_clock_seconds();
    if (reader) ISO_TRY(play_all(p, reader, error));
    for (int i = 0; i < p->settings->edits.count; i++)
        ISO_TRY(make_edit(p, &p->settings->edits.edit[i], &p->events, &p->event_count, error));
    if (reader) ISO_TRY(iso_session_strokes(p->session, &p->report->list, error));
    p->report->versions = iso_session_edit_stats(p->session);
    p->report->total = iso_clock_seconds() - start;
    const iso_hgrid *grid = iso_session_grid(p->session);
    p->report->bricks = iso_hgrid_brick_count(grid);
    p->report->bytes = iso_hgrid_bytes(grid);
    if (p->settings->measure.on) ISO_TRY(measure(p, error));
    iso_status status = write_outputs(p, error);
    for (int i = 0; status != ISO_OK && i < OUTPUTS; i++)
        iso_file_remove(p->written[i]); /* all outputs or none */
    ISO_TRY(status);
    if (!p->settings->common.quiet && p->report->edits.clipped)
        iso_program_log(isosculpt_program(), "%s: a brush reached beyond the grid: what lies outside is lost",
                        input_name(p->settings));
    log_mesh_notes(p);
    log_outputs(p);
    return ISO_OK;
}

iso_status isosculpt_replay(const isosculpt_settings *settings, iso_pool *pool, iso_error *error) {
    report r = {0};
    iso_journal_reader *reader = NULL;
    if (settings->replay) ISO_TRY(iso_journal_open(settings->replay, &r.start, &reader, error));
    const double own = r.start.voxel_size;
    isosculpt_viewport viewport = {0};
    player p = {
        .settings = settings, .report = &r, .pool = pool, .viewport = settings->draw ? &viewport : NULL};
    memcpy(r.resolution, settings->resolution, sizeof r.resolution);
    iso_hgrid *grid = NULL;
    iso_cell_items paint = {.cell = NULL};
    iso_session_opts opts = {.pool = pool, .undo_memory = (size_t)settings->undo_memory, .paint = &paint};
    iso_file_set files = {0};
    if (settings->replay) iso_file_set_read(&files, settings->replay);
    iso_status status = make_field(settings, pool, &files, &r, &grid, &paint, error);
    iso_progress_bar_clear();
    if (status == ISO_OK && (status = check_outputs(settings, &files, &r.start, error)) != ISO_OK)
        iso_hgrid_destroy(grid);
    iso_file_set_free(&files);
    if (status == ISO_OK) log_parts(settings, &r);
    if (status == ISO_OK && reader) opts.cost_factor = fmax(1, pow(own / grid->transform.spacing[0], 3));
    if (status == ISO_OK) status = iso_session_create(grid, &r.start, &opts, &p.session, error);
    if (status == ISO_OK) status = play_and_write(&p, reader, error);
    iso_point_set_destroy(p.points);
    iso_grid_destroy(&p.first);
    isosculpt_viewport_free(&viewport);
    iso_session_destroy(p.session);
    iso_cell_items_free(&paint);
    iso_buffer_free(&p.events);
    iso_journal_reader_free(reader);
    free_times(&r);
    return status;
}
