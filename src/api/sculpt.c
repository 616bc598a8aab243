/* The functions of isopoint.h for sculpting: a session, its volume and their thread pool. */
#include <math.h>
#include <string.h>

#include "api/internal.h"
#include "base/memory.h"
#include "extract/isovalue/isovalue.h"
#include "sculpt/edit/field_from_grid.h"
#include "sculpt/session/history.h"
#include "sculpt/session/session.h"
#include "source/source.h"
#include "source/strokes.h"

enum { DEFAULT_VOXELS = 256 };

struct iso_sculpt {
    iso_api_volume volume; /* its grid is the session's */
    iso_session *session;
    iso_stroke_list strokes; /* as of `changes` */
    size_t changes;          /* iso_session_stroke_changes + 1; 0: not listed yet */
};

static const iso_sculpt_opts defaults;

/* ---- creation ---- */

void iso_sculpt_destroy(iso_sculpt *sculpt) {
    if (!sculpt) return;
    iso_session_destroy(sculpt->session);
    iso_stroke_list_free(&sculpt->strokes);
    iso_pool_destroy(sculpt->volume.pool);
    iso_free(sculpt);
}

static iso_status create(const iso_sculpt_opts *opts, iso_sculpt **sculpt, iso_error *error) {
    iso_sculpt *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a sculpt");
    iso_status status = iso_api_pool(opts->threads, &made->volume.pool, error);
    if (status == ISO_OK)
        *sculpt = made;
    else
        iso_free(made);
    return status;
}

static void describe(iso_sculpt *sculpt) {
    iso_volume *volume = &sculpt->volume.volume;
    iso_volume_info *info = &volume->info;
    volume->grid.hgrid = iso_session_grid(sculpt->session);
    sculpt->volume.borrowed = true;
    sculpt->volume.paint = iso_session_paint(sculpt->session);
    strcpy(info->format, "sculpt");
    memcpy(info->dims, volume->grid.hgrid->dims, sizeof info->dims);
    info->type = ISO_FLOAT32;
    strcpy(info->file_type, "float32");
    info->components = 1;
    info->transform = volume->grid.hgrid->transform;
    info->scale = iso_grid_scale(&volume->grid);
    info->level_set = info->sparse = true;
    info->bytes = iso_hgrid_bytes(volume->grid.hgrid);
}

/* Starts a session; takes ownership of the field. */
static iso_status begin_session(iso_sculpt *sculpt, iso_hgrid *grid, const iso_journal_start *start,
                                const iso_session_opts *opts, iso_error *error) {
    iso_session_opts with_pool = *opts;
    with_pool.pool = sculpt->volume.pool;
    ISO_TRY(iso_session_create(grid, start, &with_pool, &sculpt->session, error));
    describe(sculpt);
    return ISO_OK;
}

static iso_status hand_out(iso_status status, iso_sculpt *made, iso_sculpt **sculpt) {
    if (status == ISO_OK)
        *sculpt = made;
    else
        iso_sculpt_destroy(made);
    return status;
}

/* ---- a new solid ---- */

/* A solid in the grid that suits it. */
static iso_status start_with(const iso_sculpt_opts *opts, iso_journal_start *start, iso_error *error) {
    const iso_start_solid solid = {opts->solid, opts->size, opts->round};
    if (opts->radius > 0 || opts->dims[0] || opts->dims[1] || opts->dims[2])
        return iso_fail(error, ISO_ERR_USAGE, "a size of the solid, and a radius or the grid's dims");
    return iso_start_with_solid(&solid, opts->voxel_size, start, error);
}

static iso_journal_start start_of(const iso_sculpt_opts *opts) {
    iso_journal_start start = {.source = "ball", .voxel_size = opts->voxel_size > 0 ? opts->voxel_size : 1};
    double origin[3], side = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        start.dims[axis] = opts->dims[axis] ? opts->dims[axis] : DEFAULT_VOXELS;
        origin[axis] = -start.voxel_size * (start.dims[axis] - 1) / 2;
        side = fmin(side, start.voxel_size * start.dims[axis]);
    }
    start.origin = iso_vec3_make(origin[0], origin[1], origin[2]);
    start.radius = opts->radius > 0 ? opts->radius : side / 4;
    return start;
}

static iso_status check_opts(const iso_sculpt_opts *opts, iso_error *error) {
    if (!(opts->voxel_size >= 0) || !(opts->radius >= 0))
        return iso_fail(error, ISO_ERR_USAGE, "a ball of %g mm in voxels of %g mm", opts->radius,
                        opts->voxel_size);
    for (int axis = 0; axis < 3; axis++)
        if (opts->dims[axis] < 0)
            return iso_fail(error, ISO_ERR_USAGE, "%d voxels along %c", opts->dims[axis], "xyz"[axis]);
    return ISO_OK;
}

static iso_status make_solid(iso_sculpt *sculpt, const iso_journal_start *start, const iso_session_opts *opts,
                             iso_error *error) {
    iso_hgrid *grid;
    ISO_TRY(iso_session_solid(start, &grid, error));
    return begin_session(sculpt, grid, start, opts, error);
}

iso_status iso_sculpt_create(const iso_sculpt_opts *opts, iso_sculpt **sculpt, iso_error *error) {
    iso_sculpt *made = NULL;
    if (!opts) opts = &defaults;
    ISO_TRY(check_opts(opts, error));
    iso_journal_start start = start_of(opts);
    if (opts->size.x != 0) ISO_TRY(start_with(opts, &start, error));
    const iso_session_opts session = {.journal = opts->journal, .undo_memory = opts->undo_memory};
    ISO_TRY(create(opts, &made, error));
    return hand_out(make_solid(made, &start, &session, error), made, sculpt);
}

/* ---- of a volume ---- */

static iso_status make_field(iso_sculpt *sculpt, const iso_grid *from, const iso_field_opts *how,
                             const iso_session_opts *opts, iso_error *error) {
    iso_hgrid *grid;
    ISO_TRY(iso_field_from_grid("the volume", from, how, &grid, error));
    const double *origin = grid->transform.origin;
    iso_journal_start start = {.source = "volume",
                               .voxel_size = grid->transform.spacing[0],
                               .origin = iso_vec3_make(origin[0], origin[1], origin[2])};
    memcpy(start.dims, grid->dims, sizeof start.dims);
    return begin_session(sculpt, grid, &start, opts, error);
}

iso_status iso_sculpt_from_volume(iso_volume *volume, double isovalue, const iso_sculpt_opts *opts,
                                  iso_sculpt **sculpt, iso_error *error) {
    iso_sculpt *made = NULL;
    if (!opts) opts = &defaults;
    ISO_TRY(check_opts(opts, error));
    if (opts->journal)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: only a new ball can have a journal", opts->journal);
    if (!isfinite(isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    ISO_TRY(iso_isovalue_check(&volume->grid, isovalue, error));
    ISO_TRY(create(opts, &made, error));
    const iso_field_opts how = {.resampling = {.isovalue = iso_grid_stored(&volume->grid, isovalue),
                                               .voxel = opts->voxel_size,
                                               .pool = made->volume.pool}};
    const iso_session_opts session = {.undo_memory = opts->undo_memory};
    return hand_out(make_field(made, &volume->grid, &how, &session, error), made, sculpt);
}

/* ---- stroke files ---- */

/* Makes the field that the session of a stroke file began with, and starts the session. */
static iso_status make_start(iso_sculpt *sculpt, const char *path, iso_journal_start *start,
                             const iso_session_opts *opts, iso_error *error) {
    iso_cell_items paint;
    const iso_source how = {.pool = sculpt->volume.pool, .paint = &paint};
    iso_session_opts with_paint = *opts;
    with_paint.paint = &paint;
    iso_hgrid *grid;
    ISO_TRY(iso_source_reopen(path, &how, start, &grid, error));
    return begin_session(sculpt, grid, start, &with_paint, error);
}

/* Opens a stroke file. `journal` is the path to append to; NULL: the file is only read. */
static iso_status open_strokes(const char *path, const char *journal, const iso_sculpt_opts *opts,
                               iso_sculpt **sculpt, iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader;
    iso_sculpt *made = NULL;
    if (!opts) opts = &defaults;
    ISO_TRY(iso_api_check_path(path, error));
    const iso_session_opts session = {
        .journal = journal, .resume = journal != NULL, .undo_memory = opts->undo_memory};
    ISO_TRY(iso_journal_open(path, &start, &reader, error));
    iso_status status = create(opts, &made, error);
    if (status == ISO_OK) status = make_start(made, path, &start, &session, error);
    if (status == ISO_OK && !journal) {
        iso_strokes strokes = {.session = made->session, .reader = reader}; /* borrowed: not closed */
        status = iso_strokes_finish(&strokes, error);
    }
    iso_journal_reader_free(reader);
    return hand_out(status, made, sculpt);
}

iso_status iso_sculpt_replay(const char *path, const iso_sculpt_opts *opts, iso_sculpt **sculpt,
                             iso_error *error) {
    return open_strokes(path, NULL, opts, sculpt, error);
}

iso_status iso_sculpt_resume(const char *path, const iso_sculpt_opts *opts, iso_sculpt **sculpt,
                             iso_error *error) {
    return open_strokes(path, path, opts, sculpt, error);
}

/* ---- strokes ---- */

iso_volume *iso_sculpt_volume(iso_sculpt *sculpt) {
    return &sculpt->volume.volume;
}

iso_status iso_sculpt_begin(iso_sculpt *sculpt, const iso_brush *brush, const iso_sample *sample,
                            iso_edit_stats *stats, iso_error *error) {
    return iso_session_begin(sculpt->session, brush, sample, stats, error);
}

iso_status iso_sculpt_sample(iso_sculpt *sculpt, const iso_sample *sample, iso_edit_stats *stats,
                             iso_error *error) {
    return iso_session_sample(sculpt->session, sample, stats, error);
}

iso_status iso_sculpt_end(iso_sculpt *sculpt, iso_error *error) {
    return iso_session_end(sculpt->session, error);
}

iso_status iso_sculpt_cancel(iso_sculpt *sculpt, iso_error *error) {
    return iso_session_cancel(sculpt->session, error);
}

iso_status iso_sculpt_undo(iso_sculpt *sculpt, iso_error *error) {
    return iso_session_undo(sculpt->session, error);
}

iso_status iso_sculpt_redo(iso_sculpt *sculpt, iso_error *error) {
    return iso_session_redo(sculpt->session, error);
}

size_t iso_sculpt_undo_count(iso_sculpt *sculpt) {
    return iso_history_position(iso_session_history(sculpt->session));
}

size_t iso_sculpt_redo_count(iso_sculpt *sculpt) {
    const iso_history *history = iso_session_history(sculpt->session);
    return iso_history_count(history) - iso_history_position(history);
}

/* ---- past strokes ---- */

static iso_status list_strokes(iso_sculpt *sculpt, iso_error *error) {
    const size_t changes = iso_session_stroke_changes(sculpt->session) + 1;
    if (sculpt->changes == changes) return ISO_OK;
    sculpt->changes = 0;
    sculpt->strokes.count = 0;
    ISO_TRY(iso_session_strokes(sculpt->session, &sculpt->strokes, error));
    sculpt->changes = changes;
    return ISO_OK;
}

size_t iso_sculpt_stroke_count(iso_sculpt *sculpt) {
    return list_strokes(sculpt, NULL) == ISO_OK ? sculpt->strokes.count : 0;
}

iso_status iso_sculpt_get_stroke(iso_sculpt *sculpt, size_t index, iso_sculpt_stroke *stroke,
                                 iso_error *error) {
    ISO_TRY(list_strokes(sculpt, error));
    if (index >= sculpt->strokes.count)
        return iso_fail(error, ISO_ERR_USAGE, "there are %zu strokes", sculpt->strokes.count);
    const iso_stroke *at = iso_stroke_at(&sculpt->strokes, index);
    *stroke = (iso_sculpt_stroke){
        .number = at->number, .muted = at->muted, .brush = at->brush, .samples = at->count};
    return ISO_OK;
}

static iso_status edit(iso_sculpt *sculpt, iso_event event, iso_error *error) {
    if (event.first < 1 || event.last < event.first)
        return iso_fail(error, ISO_ERR_USAGE, "there are no strokes %u to %u", event.first, event.last);
    return iso_session_edit(sculpt->session, &event, error);
}

iso_status iso_sculpt_edit(iso_sculpt *sculpt, unsigned number, const iso_brush *brush, iso_error *error) {
    return edit(sculpt, (iso_event){.kind = ISO_EVENT_EDIT, .first = number, .last = number, .brush = *brush},
                error);
}

iso_status iso_sculpt_mute(iso_sculpt *sculpt, unsigned first, unsigned last, bool muted, iso_error *error) {
    const iso_event_kind kind = muted ? ISO_EVENT_MUTE : ISO_EVENT_UNMUTE;
    return edit(sculpt, (iso_event){.kind = kind, .first = first, .last = last}, error);
}

iso_status iso_sculpt_delete(iso_sculpt *sculpt, unsigned first, unsigned last, iso_error *error) {
    return edit(sculpt, (iso_event){.kind = ISO_EVENT_DELETE, .first = first, .last = last}, error);
}

iso_status iso_sculpt_move(iso_sculpt *sculpt, unsigned first, unsigned last, unsigned before,
                           iso_error *error) {
    return edit(sculpt, (iso_event){.kind = ISO_EVENT_MOVE, .first = first, .last = last, .before = before},
                error);
}

iso_status iso_sculpt_get_path(iso_sculpt *sculpt, unsigned number, const iso_sample **samples, size_t *count,
                               iso_error *error) {
    ISO_TRY(list_strokes(sculpt, error));
    const iso_stroke *stroke = iso_stroke_find(&sculpt->strokes, number);
    if (!stroke) return iso_fail(error, ISO_ERR_USAGE, "there is no stroke %u", number);
    *samples = stroke->samples;
    *count = stroke->count;
    return ISO_OK;
}

iso_status iso_sculpt_set_path(iso_sculpt *sculpt, unsigned number, const iso_sample *samples, size_t count,
                               iso_error *error) {
    return edit(
        sculpt,
        (iso_event){
            .kind = ISO_EVENT_PATH, .first = number, .last = number, .path = samples, .path_count = count},
        error);
}

iso_status iso_sculpt_reseat(iso_sculpt *sculpt, unsigned first, unsigned last, iso_error *error) {
    return edit(sculpt, (iso_event){.kind = ISO_EVENT_RESEAT, .first = first, .last = last}, error);
}

iso_status iso_sculpt_freeze(iso_sculpt *sculpt, iso_volume *volume, double isovalue, iso_error *error) {
    return iso_source_freeze(sculpt->session, &volume->grid, isovalue, sculpt->volume.pool, error);
}

iso_status iso_sculpt_set_stamp(iso_sculpt *sculpt, const char *path, iso_error *error) {
    iso_stamp *stamp;
    ISO_TRY(iso_api_check_path(path, error));
    const iso_source source = {.path = path, .pool = sculpt->volume.pool};
    ISO_TRY(iso_source_read_stamp(&source, &stamp, error));
    return iso_session_set_stamp(sculpt->session, stamp, error);
}

iso_status iso_sculpt_journal_status(iso_sculpt *sculpt, iso_error *error) {
    return iso_session_journal_status(sculpt->session, error);
}
