/* session: a level set with its editor, undo history and journal; used by the program's window, by replaying
 * and by the public API. It turns the samples of a stroke into touches, which are spaced along the stroke.
 * All functions are for one thread. */
#ifndef ISO_SCULPT_SESSION_SESSION_H
#define ISO_SCULPT_SESSION_SESSION_H

#include "base/c_linkage.h"
#include "sculpt/edit/edit.h"
#include "sculpt/field/snapshot.h"
#include "sculpt/session/history.h"
#include "sculpt/session/journal.h"
#include "sculpt/session/versions.h"

ISO_C_BEGIN

typedef struct iso_session iso_session;

typedef struct iso_session_opts {
    iso_pool *pool;         /* borrowed */
    const char *journal;    /* path of the stroke file to write; NULL: none */
    bool resume;            /* the file exists: its events are replayed, then new ones are appended */
    size_t undo_memory;     /* bytes; 0 means 1 GiB */
    int checkpoint_strokes; /* strokes between checkpoints, which are written in the background to files
                               beside the journal; 0 means 200, < 0 none */
    double cost_factor; /* multiplies iso_limit_cost, which bounds iso_session_play: on a finer grid the same
                           strokes cost more; 0 means 1 */
    size_t version_memory; /* bytes of the versions that edits of strokes need, beyond which they lie in files
                              in TMPDIR; 0 means 384 MiB */
    bool edits_aside; /* iso_session_draw_edit has a pool of its own, as it is called in another thread */
    iso_cell_items
        *paint; /* the paint that the field begins with, which is taken (*paint is empty then), also
                              when it fails; NULL: none */
    const iso_progress *progress; /* of resuming; cancelled: ISO_ERR_IO, and the journal is unchanged */
} iso_session_opts;

/* Takes ownership of the grid, also when it fails. `start` describes the grid and becomes the journal's
 * header. Resuming begins at the last checkpoint that can be read; events before that cannot be undone.
 * Errors: those of the editor, the history and the journal; ISO_ERR_USAGE: a number of `start` is outside its
 * bounds. */
iso_status iso_session_create(iso_hgrid *grid, const iso_journal_start *start, const iso_session_opts *opts,
                              iso_session **session, iso_error *error);
/* Closes the journal and waits for a checkpoint that is being written. NULL is allowed. */
void iso_session_destroy(iso_session *session);

iso_hgrid *iso_session_grid(iso_session *session);                    /* borrowed; not to be written */
const iso_field_items *iso_session_items(const iso_session *session); /* borrowed: mask and paint */
static inline const iso_cell_items *iso_session_paint(const iso_session *session) {
    return &iso_session_items(session)->of[ISO_ITEM_PAINT];
}
/* Which voxels have changed their colours; borrowed. A snapshot that replaces the whole field is not in it.
 */
const iso_change_log *iso_session_paint_log(const iso_session *session);
iso_history *iso_session_history(iso_session *session);
bool iso_session_has_mask(const iso_session *session);
bool iso_session_masked(const iso_session *session, int x, int y, int z); /* a voxel inside the grid */

/* Draw a stroke: begin with its first sample, then further samples, then end or cancel. A sample makes
 * touches between the last touch and itself, as many as the brush's spacing gives, possibly none. `stats` may
 * be NULL and are added to. ISO_ERR_USAGE: the wrong order of calls, a bad brush or sample, or more than
 * ISO_LIMIT_TOUCHES touches, of which none is made; also the errors of iso_editor_touch. A stroke that cannot
 * be ended, as one that trims and outlines nothing, goes on, and can be cancelled. */
iso_status iso_session_begin(iso_session *session, const iso_brush *brush, const iso_sample *sample,
                             iso_edit_stats *stats, iso_error *error);
iso_status iso_session_sample(iso_session *session, const iso_sample *sample, iso_edit_stats *stats,
                              iso_error *error);
iso_status iso_session_end(iso_session *session, iso_error *error);
iso_status iso_session_cancel(iso_session *session, iso_error *error);
/* Ends a stroke whose end a stroke file lacks; one that acts only when it ends (iso_tool_is_trim) is
 * cancelled, as its outline may be half drawn. Errors as of these. */
iso_status iso_session_end_cut_off(iso_session *session, iso_error *error);
iso_status iso_session_undo(iso_session *session, iso_error *error);
iso_status iso_session_redo(iso_session *session, iso_error *error);

/* Edits strokes (an event of the kinds ISO_EVENT_EDIT to ISO_EVENT_RESEAT) as one step of the undo
 * history: the field becomes that of a fresh session in which the edited list of strokes is drawn. The
 * first edit of a session draws all strokes once more to find what each of them made of its cells;
 * later ones draw only the strokes that can come out differently. ISO_ERR_USAGE: there is no such
 * stroke, a bad brush, a path of another number of samples, or the session began with a checkpoint; also the
 * errors of iso_editor_touch. The field is unchanged then. A reseat without a path (path_count 0) finds the
 * samples (seat.h). */
iso_status iso_session_edit(iso_session *session, const iso_event *event, iso_error *error);
/* The same in three parts, of which the second takes long: any one thread may call it, which may be another
 * one if the session has `edits_aside`. Between begin and end the session is not changed by strokes, edits,
 * undo and redo (ISO_ERR_USAGE), and its field can be read; the list of strokes has the edit already. An edit
 * that is begun must be ended, with keep = false if drawing it failed or was cancelled (ISO_ERR_IO); nothing
 * has changed then. Without an event, drawing prepares the versions that an edit needs. */
iso_status iso_session_begin_edit(iso_session *session, const iso_event *event, iso_error *error);
iso_status iso_session_draw_edit(iso_session *session, const iso_progress *progress, iso_error *error);
iso_status iso_session_end_edit(iso_session *session, bool keep, iso_error *error);
/* The last edit, as the journal has it: reseated strokes have the samples that drawing it has found. Its path
 * is valid until another one is begun, or a step is undone. */
const iso_event *iso_session_last_edit(const iso_session *session);
/* The number of the last stroke that changed the surface at a world position, as the strokes were when
 * versions of them were made last; 0: none did, or there are no versions. */
unsigned iso_session_stroke_at(const iso_session *session, iso_vec3 place);
/* Changes whenever the strokes do. */
size_t iso_session_stroke_changes(const iso_session *session);
/* Lists the strokes that the field is made of (zero-initialise `list`; iso_stroke_list_free). Its pointers
 * are valid until the session changes. ISO_ERR_USAGE: the session began with a checkpoint; ISO_ERR_NOMEM. */
iso_status iso_session_strokes(const iso_session *session, iso_stroke_list *list, iso_error *error);
iso_versions_stats iso_session_edit_stats(const iso_session *session); /* all 0 before the first edit */

/* Makes a snapshot of the field, for another thread to copy (iso_snapshot_copy) while editing continues. It
 * must be released before the session is destroyed. ISO_ERR_USAGE: a stroke is being drawn, or there are
 * ISO_SESSION_SNAPSHOTS already; ISO_ERR_NOMEM. */
enum { ISO_SESSION_SNAPSHOTS = 4 };
iso_status iso_session_snapshot(iso_session *session, iso_snapshot **snapshot, iso_error *error);
void iso_session_release_snapshot(iso_session *session, iso_snapshot *snapshot);

/* Sets the stamp for strokes with ISO_SOLID_STAMP and writes it to the journal. Takes ownership, also when it
 * fails. ISO_ERR_USAGE: a stroke is being drawn; ISO_ERR_NOMEM. */
iso_status iso_session_set_stamp(iso_session *session, iso_stamp *stamp, iso_error *error);
const iso_stamp *iso_session_stamp(const iso_session *session); /* NULL: none yet */

/* Returns the status of the journal (iso_journal_status); ISO_OK if there is no journal. */
iso_status iso_session_journal_status(iso_session *session, iso_error *error);

/* Waits until all events are in the journal's file (iso_journal_sync); ISO_OK if there is no journal. */
iso_status iso_session_sync(iso_session *session, iso_error *error);

/* Replays one event of a stroke file. ISO_ERR_USAGE: the event is not possible after those before it;
 * ISO_ERR_FORMAT: the cost of the file exceeds iso_limit_cost; iso_journal_add_location adds the line. */
iso_status iso_session_play(iso_session *session, const iso_event *event, iso_edit_stats *stats,
                            iso_error *error);

ISO_C_END
#endif
