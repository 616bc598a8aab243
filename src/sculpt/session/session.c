/* The session: strokes, undo steps, the journal with its checkpoints, and resuming from a journal. */
#include "sculpt/session/session.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "sculpt/brush/dab.h"
#include "sculpt/field/checkpoint.h"
#include "sculpt/limits.h"
#include "sculpt/session/event_limits.h"
#include "sculpt/session/pen.h"
#include "sculpt/session/seat.h"
#include "sculpt/session/step_name.h"
#include "sculpt/session/versions.h"

enum { DEFAULT_CHECKPOINT_STROKES = 200, DEFAULT_VERSION_MEMORY = 384 << 20 };
/* Bricks that are allocated between strokes, so that the next stroke need not: 4 MiB. */
enum { RESERVED_BRICKS = 256 };

struct iso_session {
    iso_hgrid *grid;
    iso_pool *pool;
    iso_editor *editor;
    iso_history *history;
    iso_journal *journal;
    char *journal_path;
    iso_journal_start start;
    iso_cell_items first_paint;                   /* of the field before all strokes */
    iso_stamp *stamp;                             /* NULL: none yet */
    int checkpoint_strokes, strokes, checkpoints; /* interval; strokes since the last one; number so far */
    bool drawing, acts_at_end;   /* a stroke is being drawn, which does nothing before its end */
    bool replaying;              /* the journal being resumed: events are not recorded again */
    bool bounded;                /* an event of a stroke file is being replayed: check_cost applies */
    double cost_factor, samples; /* of the options; number of samples replayed so far */
    double undo_cost, edit_cost; /* of all replayed undo and redo steps; of versions that were discarded */
    iso_pen pen;
    iso_edit_stats *stats;  /* of the call that is being served; NULL: not wanted */
    iso_stroke_log log;     /* of all strokes, unless it is `partial` */
    iso_stroke_list list;   /* the last one that an edit resolved */
    iso_versions *versions; /* NULL: no edit has needed them yet */
    size_t versions_at;     /* log.changes when they were those of the log's list; 0: they are not */
    size_t version_memory;
    bool edits_aside;
    iso_pool *edit_pool;          /* owned; draws them if edits_aside */
    bool editing, edit_is_logged; /* between begin and end of an edit; it is the last entry of the log */
    const iso_progress *edit_progress;
    iso_event edit;
    bool reseats;   /* the samples of the edit's strokes are found by drawing it */
    bool partial;   /* the session began with a checkpoint: strokes before it are not in the log */
    bool inserting; /* the stroke that is being drawn belongs before another one, and is drawn at its end */
    iso_snapshot *snapshots[ISO_SESSION_SNAPSHOTS];
    iso_checkpoint *checkpoint;      /* being written; NULL: none */
    iso_snapshot *checkpoint_source; /* the snapshot that it is written from */
    iso_event checkpoint_event;      /* recorded in the journal when the file is complete */
};

/* ---- snapshots */

static void preserve_in_snapshots(void *context, uint32_t cell) {
    iso_session *session = context;
    for (int i = 0; i < ISO_SESSION_SNAPSHOTS; i++)
        if (session->snapshots[i]) iso_snapshot_preserve(session->snapshots[i], cell);
}

iso_status iso_session_snapshot(iso_session *session, iso_snapshot **snapshot, iso_error *error) {
    int at = 0;
    while (at < ISO_SESSION_SNAPSHOTS && session->snapshots[at]) at++;
    if (session->drawing || at == ISO_SESSION_SNAPSHOTS)
        return iso_fail(error, ISO_ERR_USAGE,
                        session->drawing ? "a stroke is being drawn"
                                         : "there are too many snapshots of the field");
    ISO_TRY(iso_snapshot_create(session->grid, &session->snapshots[at], error));
    *snapshot = session->snapshots[at];
    return ISO_OK;
}

void iso_session_release_snapshot(iso_session *session, iso_snapshot *snapshot) {
    for (int i = 0; i < ISO_SESSION_SNAPSHOTS; i++)
        if (session->snapshots[i] == snapshot) session->snapshots[i] = NULL;
    iso_snapshot_destroy(snapshot);
}

/* ---- the journal */

static iso_status record_event(iso_session *session, const iso_event *event, iso_error *error) {
    return session->journal && !session->replaying ? iso_journal_put(session->journal, event, error) : ISO_OK;
}

/* Checks, before an event changes anything, that its numbers are within the bounds of replaying. */
static iso_status check_record(const iso_session *session, const iso_event *event, iso_error *error) {
    if (!session->journal || session->replaying) return ISO_OK;
    return iso_limits_event(event, &session->start, error) == ISO_OK ? ISO_OK : ISO_ERR_USAGE;
}

static iso_status record_kind(iso_session *session, iso_event_kind kind, iso_error *error) {
    const iso_event event = {.kind = kind};
    return record_event(session, &event, error);
}

/* Waits for the checkpoint that is being written, if there is one, and records it. A checkpoint that could
 * not be written is left out of the journal, which only makes replaying slower. */
static iso_status finish_checkpoint(iso_session *session, iso_error *error) {
    if (!session->checkpoint) return ISO_OK;
    const bool written = iso_checkpoint_finish(session->checkpoint);
    iso_session_release_snapshot(session, session->checkpoint_source);
    session->checkpoint = NULL;
    if (!written) return ISO_OK;
    session->checkpoints++;
    return record_event(session, &session->checkpoint_event, error);
}

/* Starts writing a checkpoint of the current field. It is recorded in the journal when its file is complete;
 * other events may be recorded before that. */
static iso_status start_checkpoint(iso_session *session, iso_error *error) {
    iso_event *event = &session->checkpoint_event;
    ISO_TRY(finish_checkpoint(session, error)); /* the previous one; after many strokes it is complete */
    memset(event, 0, sizeof *event);
    event->kind = ISO_EVENT_CHECKPOINT;
    event->after = iso_journal_count(session->journal);
    int size = snprintf(event->text, sizeof event->text, "%s.%d.snapshot", session->journal_path,
                        session->checkpoints + 1);
    if (size < 0 || (size_t)size >= sizeof event->text) return ISO_OK;
    if (iso_session_snapshot(session, &session->checkpoint_source, NULL) != ISO_OK) return ISO_OK;
    if (iso_checkpoint_start(event->text, session->checkpoint_source, iso_editor_items(session->editor),
                             &session->checkpoint, NULL) != ISO_OK)
        iso_session_release_snapshot(session, session->checkpoint_source);
    return ISO_OK;
}

static void discard_versions(iso_session *session) {
    if (session->versions) session->edit_cost += iso_versions_get_stats(session->versions).cost;
    iso_versions_destroy(session->versions);
    session->versions = NULL;
    session->versions_at = 0;
}

/* ---- resuming */

/* A checkpoint that a journal mentions. */
typedef struct checkpoint_line {
    unsigned long long after;
    char path[ISO_JOURNAL_TEXT];
} checkpoint_line;
/* The result of reading a journal before it is replayed: its checkpoints, and the number of its events. */
typedef struct journal_contents {
    iso_buffer lines; /* checkpoint_line */
    int checkpoints;
    unsigned long long events;
} journal_contents;

typedef iso_status event_fn(iso_session *session, const iso_event *event, void *context, iso_error *error);

/* Calls `visit` for each event of the session's journal, until it fails. */
static iso_status for_events(iso_session *session, event_fn *visit, void *context, iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader;
    ISO_TRY(iso_journal_open(session->journal_path, &start, &reader, error));
    iso_event event;
    bool more = true;
    iso_status status = ISO_OK;
    while (status == ISO_OK && more) {
        status = iso_journal_next(reader, &event, &more, error);
        if (status == ISO_OK && more)
            status = iso_journal_add_location(reader, visit(session, &event, context, error), error);
    }
    iso_journal_reader_free(reader);
    return status;
}

static iso_status collect_contents(iso_session *session, const iso_event *event, void *context,
                                   iso_error *error) {
    journal_contents *found = context;
    const size_t size = (size_t)found->checkpoints * sizeof(checkpoint_line);
    (void)session;
    found->events++;
    if (event->kind != ISO_EVENT_CHECKPOINT) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&found->lines, size + sizeof(checkpoint_line), size, error));
    checkpoint_line *line = (checkpoint_line *)found->lines.data + found->checkpoints++;
    line->after = event->after;
    memcpy(line->path, event->text, sizeof line->path);
    return ISO_OK;
}

typedef struct replay_progress {
    const iso_progress *progress;
    unsigned long long at, from, count; /* the current event, the first one to replay, number of events */
} replay_progress;

static iso_status play_event(iso_session *session, const iso_event *event, void *context, iso_error *error) {
    replay_progress *p = context;
    ISO_TRY(iso_progress_tell(p->progress, session->journal_path, (double)p->at / (double)p->count, error));
    const bool wanted = p->at >= p->from || event->kind == ISO_EVENT_STAMP;
    p->at++;
    return wanted ? iso_session_play(session, event, NULL, error) : ISO_OK;
}

/* Replays the journal from checkpoint `from` (counted from 1), or from the beginning (0). */
static iso_status play_from_checkpoint(iso_session *session, const journal_contents *found, int from,
                                       const iso_progress *progress, iso_error *error) {
    replay_progress p = {.progress = progress, .count = found->events};
    if (from) {
        const checkpoint_line *line = (const checkpoint_line *)found->lines.data + from - 1;
        ISO_TRY(iso_checkpoint_read(line->path, session->grid, iso_editor_items(session->editor), error));
        p.from = line->after;
        session->partial = true;
    }
    return for_events(session, play_event, &p, error);
}

/* Restores the initial field, without mask and history. */
static iso_status reset_to(iso_session *session, const iso_hgrid *initial, iso_error *error) {
    if (session->drawing) ISO_TRY(iso_session_cancel(session, error));
    while (iso_history_position(session->history)) ISO_TRY(iso_history_undo(session->history, error));
    iso_field_items_clear(iso_editor_items(session->editor));
    if (session->first_paint.cell)
        ISO_TRY(iso_editor_set_paint(session->editor, &session->first_paint, error));
    iso_stroke_log_free(&session->log);
    discard_versions(session);
    session->partial = false;
    ISO_TRY(iso_hgrid_copy_cells(initial, session->grid, error));
    return iso_history_clear(session->history, error);
}

/* Replays from the newest checkpoint from which replaying succeeds. Replaying from a checkpoint fails if its
 * file is missing or damaged, or if an undo goes back to events before it. */
static iso_status play_from_newest(iso_session *session, const journal_contents *found,
                                   const iso_progress *progress, iso_error *error) {
    iso_hgrid *initial = NULL;
    const int lo[3] = {0, 0, 0},
              hi[3] = {session->grid->dims[0] - 1, session->grid->dims[1] - 1, session->grid->dims[2] - 1};
    int from = found->checkpoints;
    iso_status status = from ? iso_hgrid_crop(session->grid, lo, hi, &initial, error) : ISO_OK;
    for (int tries = 1; status == ISO_OK; from = tries++ < ISO_LIMIT_CHECKPOINTS ? from - 1 : 0) {
        status = play_from_checkpoint(session, found, from, progress, error);
        if (status == ISO_OK || from == 0) break;
        status = iso_progress_cancelled(progress)
                     ? iso_fail(error, ISO_ERR_IO, "%s: cancelled", session->journal_path)
                     : reset_to(session, initial, error);
    }
    iso_hgrid_destroy(initial);
    return status;
}

static iso_status play_journal(iso_session *session, const iso_progress *progress, iso_error *error) {
    journal_contents found = {0};
    iso_status status = for_events(session, collect_contents, &found, error);
    session->checkpoints = found.checkpoints;
    if (status == ISO_OK) status = play_from_newest(session, &found, progress, error);
    iso_buffer_free(&found.lines);
    return status;
}

/* Replays the journal and opens it for appending. */
static iso_status resume(iso_session *session, const iso_progress *progress, iso_error *error) {
    session->replaying = true;
    iso_status status = play_journal(session, progress, error);
    session->replaying = false;
    if (status == ISO_OK) status = iso_journal_append(session->journal_path, &session->journal, error);
    if (status == ISO_OK && session->drawing) status = iso_session_end_cut_off(session, error);
    return status;
}

/* ---- costs */

static void add_stats(iso_edit_stats *sum, const iso_edit_stats *more) {
    if (!sum) return;
    sum->edited += more->edited;
    sum->redistanced += more->redistanced;
    sum->created += more->created;
    sum->pruned += more->pruned;
    sum->clipped |= more->clipped;
}

/* While a stroke file is replayed: fails if its events have cost more than those of a recording can
 * (iso_limit_cost). */
static iso_status check_total(const iso_session *session, double edits, iso_error *error) {
    const double most = session->cost_factor * iso_limit_cost(session->samples),
                 done = iso_editor_cost(session->editor) + session->undo_cost + session->edit_cost + edits;
    if (!session->bounded || done <= most) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "the strokes up to here ask for more work than %.3g edited bricks",
                    most);
}

static iso_status check_cost(const iso_session *session, iso_error *error) {
    return check_total(session, session->versions ? iso_versions_get_stats(session->versions).cost : 0,
                       error);
}

/* iso_pen.touch. */
static iso_status touch_field(void *context, const iso_brush *brush, const iso_touch *touch,
                              iso_error *error) {
    iso_session *session = context;
    ISO_TRY(check_cost(session, error));
    iso_edit_stats made = {0};
    ISO_TRY(iso_editor_touch(session->editor, brush, touch, &made, error));
    add_stats(session->stats, &made);
    return ISO_OK;
}

/* ---- creation and destruction */

static iso_status copy_journal_path(iso_session *session, const char *journal, iso_error *error) {
    if (!journal) return ISO_OK;
    size_t size = strlen(journal) + 1;
    session->journal_path = iso_alloc(size);
    if (!session->journal_path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a session");
    memcpy(session->journal_path, journal, size);
    return ISO_OK;
}

static iso_status set_up(iso_session *session, const iso_journal_start *start, const iso_session_opts *opts,
                         iso_error *error) {
    iso_editor_opts editor = {.pool = opts->pool};
    iso_history_opts history = {.memory = opts->undo_memory,
                                .before_write = preserve_in_snapshots,
                                .context = session,
                                .beside = opts->journal};
    ISO_TRY(copy_journal_path(session, opts->journal, error));
    ISO_TRY(iso_editor_create(session->grid, &editor, &session->editor, error));
    if (session->first_paint.cell)
        ISO_TRY(iso_editor_set_paint(session->editor, &session->first_paint, error));
    history.items = iso_editor_items(session->editor);
    history.paint_log = iso_editor_paint_log(session->editor);
    ISO_TRY(iso_history_create(session->grid, &history, &session->history, error));
    iso_hgrid_reserve(session->grid, RESERVED_BRICKS);
    if (!opts->journal) return ISO_OK;
    if (iso_limits_start(start, error) != ISO_OK) return ISO_ERR_USAGE;
    session->start = *start;
    return opts->resume ? resume(session, opts->progress, error)
                        : iso_journal_create(opts->journal, start, &session->journal, error);
}

iso_status iso_session_create(iso_hgrid *grid, const iso_journal_start *start, const iso_session_opts *opts,
                              iso_session **out, iso_error *error) {
    iso_session *session = iso_alloc_zero(1, sizeof *session);
    if (!session) {
        iso_hgrid_destroy(grid);
        if (opts->paint) iso_cell_items_free(opts->paint);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a session");
    }
    session->grid = grid;
    if (opts->paint) {
        session->first_paint = *opts->paint;
        *opts->paint = (iso_cell_items){.cell = NULL};
    }
    session->pool = opts->pool;
    session->edits_aside = opts->edits_aside;
    session->version_memory = opts->version_memory ? opts->version_memory : DEFAULT_VERSION_MEMORY;
    session->pen = (iso_pen){.touch = touch_field, .context = session};
    session->cost_factor = opts->cost_factor > 0 ? opts->cost_factor : 1;
    session->checkpoint_strokes =
        opts->checkpoint_strokes ? opts->checkpoint_strokes : DEFAULT_CHECKPOINT_STROKES;
    iso_status status = set_up(session, start, opts, error);
    if (status == ISO_OK)
        *out = session;
    else
        iso_session_destroy(session);
    return status;
}

void iso_session_destroy(iso_session *session) {
    if (!session) return;
    finish_checkpoint(session, NULL);
    if (session->journal) iso_journal_close(session->journal, NULL);
    iso_stamp_free(session->stamp);
    iso_versions_destroy(session->versions);
    iso_pool_destroy(session->edit_pool);
    iso_stroke_list_free(&session->list);
    iso_stroke_log_free(&session->log);
    iso_history_destroy(session->history);
    iso_editor_destroy(session->editor);
    iso_cell_items_free(&session->first_paint);
    iso_hgrid_destroy(session->grid);
    iso_free(session->journal_path);
    iso_free(session);
}

iso_hgrid *iso_session_grid(iso_session *session) {
    return session->grid;
}
const iso_field_items *iso_session_items(const iso_session *session) {
    return iso_editor_items(session->editor);
}
const iso_change_log *iso_session_paint_log(const iso_session *session) {
    return iso_editor_paint_log(session->editor);
}
iso_history *iso_session_history(iso_session *session) {
    return session->history;
}
bool iso_session_has_mask(const iso_session *session) {
    return iso_editor_has_mask(session->editor);
}
bool iso_session_masked(const iso_session *session, int x, int y, int z) {
    return iso_editor_masked(session->editor, x, y, z);
}
iso_status iso_session_sync(iso_session *session, iso_error *error) {
    return session->journal ? iso_journal_sync(session->journal, error) : ISO_OK;
}
iso_status iso_session_journal_status(iso_session *session, iso_error *error) {
    return session->journal ? iso_journal_status(session->journal, error) : ISO_OK;
}

/* ---- edits of strokes */

static iso_status no_strokes(iso_error *error) {
    return iso_fail(error, ISO_ERR_USAGE,
                    "the session began with a snapshot, and holds no strokes before it");
}

/* Fails while a stroke is drawn or strokes are edited. */
static iso_status check_idle(const iso_session *session, iso_error *error) {
    if (!session->drawing && !session->editing) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    session->drawing ? "a stroke is being drawn" : "strokes are being edited");
}

/* Resolves the log with what was added to it last. */
static iso_status check_edit(iso_session *session, iso_error *error) {
    return session->partial ? no_strokes(error)
                            : iso_stroke_log_resolve(&session->log, &session->list, error);
}

/* iso_versions_check. */
static iso_status check_versions(void *context, double cost, iso_error *error) {
    const iso_session *session = context;
    if (iso_progress_cancelled(session->edit_progress))
        return iso_fail(error, ISO_ERR_IO, "the strokes: cancelled");
    return check_total(session, cost, error);
}

/* Copies the field before all strokes. */
static iso_status copy_first_field(iso_session *session, iso_hgrid **first, iso_error *error) {
    const int lo[3] = {0, 0, 0},
              hi[3] = {session->grid->dims[0] - 1, session->grid->dims[1] - 1, session->grid->dims[2] - 1};
    ISO_TRY(iso_hgrid_crop(session->grid, lo, hi, first, error));
    for (size_t i = iso_history_position(session->history); i-- > 0;)
        session->undo_cost += iso_history_cost(session->history, i);
    const iso_status status = iso_history_first(session->history, *first, error);
    if (status != ISO_OK) iso_hgrid_destroy(*first);
    return status;
}

static iso_status make_versions(iso_session *session, iso_error *error) {
    iso_hgrid *first = NULL;
    if (session->versions) return ISO_OK;
    if (session->edits_aside && !session->edit_pool)
        ISO_TRY(iso_pool_create(iso_pool_threads(session->pool), &session->edit_pool, error));
    ISO_TRY(copy_first_field(session, &first, error));
    return iso_versions_create(first, &session->first_paint, session->version_memory,
                               session->edits_aside ? session->edit_pool : session->pool, check_versions,
                               session, &session->versions, error);
}

/* Makes the versions of the strokes as they are before the last `entries` entries of the log. */
static iso_status update_versions(iso_session *session, size_t entries, const iso_progress *progress,
                                  iso_error *error) {
    iso_stroke_list list = {.count = 0};
    iso_stroke_log before = session->log;
    before.position -= entries;
    ISO_TRY(make_versions(session, error));
    iso_status status = iso_stroke_log_resolve(&before, &list, error);
    if (status == ISO_OK) status = iso_versions_update(session->versions, &list, NULL, progress, error);
    iso_stroke_list_free(&list);
    return status;
}

static iso_status write_change(iso_session *session, const iso_step_opts *step, size_t index,
                               iso_error *error) {
    const iso_cell_change change = iso_versions_change(session->versions, index);
    const uint32_t cell = change.cell;
    iso_hgrid *grid = session->grid;
    void *context = step->observer.context;
    int at[3], lo[3], hi[3];
    iso_hgrid_cell_position(grid, cell, at);
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = ISO_BRICK * at[axis];
        hi[axis] = lo[axis] + ISO_BRICK - 1;
    }
    if (change.kind != ISO_CHANGE_DISTANCES) {
        iso_cell_items *items = &iso_editor_items(session->editor)->of[change.kind];
        iso_paint_item item; /* the largest */
        ISO_TRY(
            step->observer.item_before(context, (iso_item_kind)change.kind, cell, items->cell[cell], error));
        if (change.state == 0) iso_versions_change_values(session->versions, index, &item);
        if (change.kind == ISO_ITEM_PAINT)
            ISO_TRY(iso_change_log_add(iso_editor_paint_log(session->editor), lo, hi, error));
        return iso_cell_items_set(items, cell, change.state == 0 ? &item : NULL, error);
    }
    float *brick = grid->cell[cell] >= 0 ? iso_hgrid_brick(grid, grid->cell[cell]) : NULL;
    ISO_TRY(step->observer.before(context, cell, grid->cell[cell], brick, error));
    ISO_TRY(iso_change_log_add(grid->log, lo, hi, error));
    if (change.state != 0) {
        iso_hgrid_coalesce(grid, at[0], at[1], at[2], change.state);
        return ISO_OK;
    }
    ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
    iso_versions_change_values(session->versions, index, brick);
    return ISO_OK;
}

/* Makes the versions of session->list, which has the last entry of the log. */
static iso_status draw_list(iso_session *session, const iso_progress *progress, iso_error *error) {
    const iso_progress before = iso_progress_part(progress, 0, 0.5),
                       after = iso_progress_part(progress, 0.5, 1);
    iso_seat seat = {.samples = NULL};
    const iso_versions_visitor visitor = {iso_seat_stroke, &seat};
    const bool current = session->versions_at > 0 && session->versions_at == session->log.changes - 1;
    session->versions_at = 0;
    if (!current) ISO_TRY(update_versions(session, 1, progress ? &before : NULL, error));
    iso_status status = ISO_OK;
    if (session->reseats) {
        status = iso_seat_measure(&seat, session->versions, &session->log, &session->list, progress, error);
        if (status == ISO_OK) status = update_versions(session, 1, progress, error);
    }
    if (status == ISO_OK)
        status = iso_versions_update(session->versions, &session->list, session->reseats ? &visitor : NULL,
                                     progress ? &after : NULL, error);
    iso_seat_free(&seat);
    return status;
}

/* Makes the field that of session->list, as a step. If it fails, the field is unchanged. */
static iso_status write_list(iso_session *session, const char *name, iso_error *error) {
    ISO_TRY(iso_history_begin(session->history, name, error));
    const iso_step_opts step = iso_history_step_opts(session->history);
    iso_status status = ISO_OK;
    iso_history_keep(session->history);
    iso_change_log_begin(session->grid->log);
    iso_change_log_begin(iso_editor_paint_log(session->editor));
    for (size_t i = 0; status == ISO_OK && i < iso_versions_change_count(session->versions); i++)
        status = write_change(session, &step, i, error);
    if (status == ISO_OK) status = iso_history_end(session->history, error);
    if (status != ISO_OK) {
        iso_history_cancel(session->history, NULL);
        return status;
    }
    iso_stroke_log_end(&session->log, true);
    session->versions_at = session->log.changes;
    return ISO_OK;
}

/* ---- strokes */

/* Begins the step of a stroke and makes its first touch. */
static iso_status begin_step(iso_session *session, const iso_event *event, iso_error *error) {
    char name[ISO_STEP_NAME];
    iso_step_name_stroke(&event->brush, name);
    ISO_TRY(iso_history_begin(session->history, name, error));
    iso_step_opts step = iso_history_step_opts(session->history);
    step.stamp = session->stamp;
    iso_editor_begin_step(session->editor, &step);
    return iso_pen_begin(&session->pen, &event->brush, &event->sample, error);
}

static iso_status begin_stroke(iso_session *session, const iso_event *event, iso_edit_stats *stats,
                               iso_error *error) {
    ISO_TRY(check_idle(session, error));
    ISO_TRY(iso_brush_check(&event->brush, error));
    ISO_TRY(check_record(session, event, error));
    ISO_TRY(iso_stroke_log_add(&session->log, event, session->stamp, false, error));
    session->inserting = event->before > 0;
    session->acts_at_end = iso_tool_is_trim(event->brush.tool);
    session->stats = stats;
    iso_status status = session->inserting ? check_edit(session, error) : begin_step(session, event, error);
    if (status == ISO_OK) status = record_event(session, event, error);
    session->drawing = status == ISO_OK;
    if (status == ISO_OK) return ISO_OK;
    iso_stroke_log_remove(&session->log);
    iso_history_cancel(session->history, NULL);
    return status;
}

iso_status iso_session_begin(iso_session *session, const iso_brush *brush, const iso_sample *sample,
                             iso_edit_stats *stats, iso_error *error) {
    const iso_event event = {.kind = ISO_EVENT_BEGIN, .brush = *brush, .sample = *sample};
    return begin_stroke(session, &event, stats, error);
}

iso_status iso_session_sample(iso_session *session, const iso_sample *sample, iso_edit_stats *stats,
                              iso_error *error) {
    const iso_event event = {.kind = ISO_EVENT_SAMPLE, .sample = *sample};
    if (!session->drawing) return iso_fail(error, ISO_ERR_USAGE, "no stroke is being drawn");
    ISO_TRY(check_record(session, &event, error));
    session->stats = stats;
    if (!session->inserting) ISO_TRY(iso_pen_move(&session->pen, sample, error));
    ISO_TRY(iso_stroke_log_sample(&session->log, sample, error));
    return record_event(session, &event, error);
}

/* Records the end of a stroke or an edit, and makes a checkpoint when one is due. */
static iso_status end_step(iso_session *session, const iso_event *event, iso_error *error) {
    ISO_TRY(record_event(session, event, error));
    session->strokes++;
    iso_hgrid_reserve(session->grid, RESERVED_BRICKS);
    if (session->checkpoint && iso_checkpoint_done(session->checkpoint))
        ISO_TRY(finish_checkpoint(session, error));
    /* what is undone can be redone only by replaying the strokes before it: the checkpoint waits */
    const bool redoable = iso_history_position(session->history) < iso_history_count(session->history);
    const bool due =
        session->checkpoint_strokes > 0 && session->strokes >= session->checkpoint_strokes && !redoable;
    if (due) session->strokes = 0;
    return due && session->journal && !session->replaying ? start_checkpoint(session, error) : ISO_OK;
}

iso_status iso_session_end(iso_session *session, iso_error *error) {
    const iso_event event = {.kind = ISO_EVENT_END};
    if (!session->drawing) return iso_fail(error, ISO_ERR_USAGE, "no stroke is being drawn");
    if (session->inserting) {
        ISO_TRY(check_edit(session, error));
        ISO_TRY(draw_list(session, NULL, error));
        ISO_TRY(write_list(session, "insert", error));
    } else {
        size_t count;
        const iso_sample *path = iso_stroke_log_samples(&session->log, &count);
        session->stats = NULL;
        ISO_TRY(iso_pen_end(&session->pen, path, count, error));
        ISO_TRY(iso_editor_finalize(session->editor, error));
        const bool step = iso_history_open_cells(session->history) > 0;
        ISO_TRY(iso_history_end(session->history, error));
        iso_stroke_log_end(&session->log, step);
    }
    session->drawing = false;
    return end_step(session, &event, error);
}

iso_status iso_session_cancel(iso_session *session, iso_error *error) {
    if (!session->drawing) return iso_fail(error, ISO_ERR_USAGE, "no stroke is being drawn");
    if (!session->inserting) ISO_TRY(iso_history_cancel(session->history, error));
    iso_stroke_log_remove(&session->log);
    session->drawing = false;
    return record_kind(session, ISO_EVENT_CANCEL, error);
}

iso_status iso_session_end_cut_off(iso_session *session, iso_error *error) {
    return session->acts_at_end ? iso_session_cancel(session, error) : iso_session_end(session, error);
}

iso_status iso_session_undo(iso_session *session, iso_error *error) {
    ISO_TRY(check_idle(session, error));
    ISO_TRY(iso_history_undo(session->history, error));
    iso_stroke_log_undo(&session->log);
    return record_kind(session, ISO_EVENT_UNDO, error);
}

iso_status iso_session_redo(iso_session *session, iso_error *error) {
    ISO_TRY(check_idle(session, error));
    ISO_TRY(iso_history_redo(session->history, error));
    iso_stroke_log_redo(&session->log);
    return record_kind(session, ISO_EVENT_REDO, error);
}

/* Adds an edit to the log that gives strokes the samples that they have. */
static iso_status add_reseat(iso_session *session, iso_event made, iso_error *error) {
    iso_buffer path = {.data = NULL};
    ISO_TRY(check_edit(session, error));
    iso_status status =
        iso_seat_collect(&session->list, made.first, made.last, &path, &made.path_count, error);
    made.path = path.data;
    if (status == ISO_OK) status = iso_stroke_log_add(&session->log, &made, NULL, false, error);
    iso_buffer_free(&path);
    return status;
}

iso_status iso_session_begin_edit(iso_session *session, const iso_event *event, iso_error *error) {
    ISO_TRY(check_idle(session, error));
    if (!event && session->partial) return no_strokes(error);
    if (event) {
        if (event->kind == ISO_EVENT_EDIT) ISO_TRY(iso_brush_check(&event->brush, error));
        ISO_TRY(check_record(session, event, error));
        session->reseats = event->kind == ISO_EVENT_RESEAT && !event->path_count;
        ISO_TRY(session->reseats ? add_reseat(session, *event, error)
                                 : iso_stroke_log_add(&session->log, event, NULL, false, error));
        const iso_status status = check_edit(session, error);
        if (status != ISO_OK) {
            iso_stroke_log_remove(&session->log);
            return status;
        }
        session->edit = *event;
        if (iso_event_has_path(event->kind)) /* the log's own */
            session->edit.path = iso_stroke_log_samples(&session->log, &session->edit.path_count);
    }
    session->edit_is_logged = event != NULL;
    session->editing = true;
    return ISO_OK;
}

iso_status iso_session_draw_edit(iso_session *session, const iso_progress *progress, iso_error *error) {
    session->edit_progress = progress;
    return session->edit_is_logged ? draw_list(session, progress, error)
                                   : update_versions(session, 0, progress, error);
}

iso_status iso_session_end_edit(iso_session *session, bool keep, iso_error *error) {
    char name[ISO_STEP_NAME];
    session->editing = false;
    if (!session->edit_is_logged) return ISO_OK;
    iso_step_name_edit(&session->edit, name);
    const iso_status status = keep ? write_list(session, name, error) : ISO_OK;
    if (!keep || status != ISO_OK) {
        iso_stroke_log_remove(&session->log);
        return status;
    }
    return end_step(session, &session->edit, error);
}

iso_status iso_session_edit(iso_session *session, const iso_event *event, iso_error *error) {
    ISO_TRY(iso_session_begin_edit(session, event, error));
    const iso_status status = iso_session_draw_edit(session, NULL, error);
    if (status == ISO_OK) return iso_session_end_edit(session, true, error);
    iso_session_end_edit(session, false, NULL);
    return status;
}

const iso_event *iso_session_last_edit(const iso_session *session) {
    return &session->edit;
}

unsigned iso_session_stroke_at(const iso_session *session, iso_vec3 place) {
    if (!session->versions || session->editing) return 0;
    const iso_affine affine = iso_transform_affine(&session->grid->transform);
    const iso_vec3 at = iso_affine_point_to_index(&affine, place);
    return iso_versions_find(session->versions, (const double[3]){at.x, at.y, at.z});
}

size_t iso_session_stroke_changes(const iso_session *session) {
    return session->log.changes;
}

iso_status iso_session_strokes(const iso_session *session, iso_stroke_list *list, iso_error *error) {
    if (session->partial) return no_strokes(error);
    return iso_stroke_log_resolve(&session->log, list, error);
}

iso_versions_stats iso_session_edit_stats(const iso_session *session) {
    return session->versions ? iso_versions_get_stats(session->versions) : (iso_versions_stats){0};
}

iso_status iso_session_set_stamp(iso_session *session, iso_stamp *stamp, iso_error *error) {
    const iso_event event = {.kind = ISO_EVENT_STAMP, .stamp = stamp};
    iso_status status = check_idle(session, error);
    if (!stamp) status = iso_fail(error, ISO_ERR_USAGE, "there is no stamp");
    if (status == ISO_OK) status = record_event(session, &event, error);
    if (status != ISO_OK) {
        iso_stamp_free(stamp);
        return status;
    }
    iso_stamp_free(session->stamp);
    session->stamp = stamp;
    return ISO_OK;
}

const iso_stamp *iso_session_stamp(const iso_session *session) {
    return session->stamp;
}

/* Adds the cost of an undo or redo to undo_cost. */
static iso_status count_step_cost(iso_session *session, bool redo, iso_error *error) {
    const iso_history *history = session->history;
    const size_t position = iso_history_position(history);
    if (redo ? position < iso_history_count(history) : position > 0)
        session->undo_cost += iso_history_cost(history, redo ? position : position - 1);
    return check_cost(session, error);
}

static iso_status play(iso_session *session, const iso_event *event, iso_edit_stats *stats,
                       iso_error *error) {
    switch (event->kind) {
    case ISO_EVENT_BEGIN:
        return begin_stroke(session, event, stats, error);
    case ISO_EVENT_SAMPLE:
        return iso_session_sample(session, &event->sample, stats, error);
    case ISO_EVENT_END:
        return iso_session_end(session, error);
    case ISO_EVENT_CANCEL:
        return iso_session_cancel(session, error);
    case ISO_EVENT_UNDO:
        ISO_TRY(count_step_cost(session, false, error));
        return iso_session_undo(session, error);
    case ISO_EVENT_REDO:
        ISO_TRY(count_step_cost(session, true, error));
        return iso_session_redo(session, error);
    case ISO_EVENT_STAMP:
        return iso_session_set_stamp(session, iso_stamp_share(event->stamp), error);
    case ISO_EVENT_CHECKPOINT:
        return ISO_OK;
    default:
        return iso_session_edit(session, event, error);
    }
}

iso_status iso_session_play(iso_session *session, const iso_event *event, iso_edit_stats *stats,
                            iso_error *error) {
    session->bounded = true;
    session->samples += event->kind <= ISO_EVENT_SAMPLE || iso_event_is_edit(event->kind);
    iso_status status = play(session, event, stats, error);
    session->bounded = false;
    return status;
}
