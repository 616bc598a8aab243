/* session: a field, the hand that works it, its undo history and its journal, put together: what the window
 * and the replayer drive. Samples become touches here: spacing along the stroke, pressure, symmetry. */
#ifndef ISO_SCULPT_SESSION_SESSION_H
#define ISO_SCULPT_SESSION_SESSION_H

#include "sculpt/field/edit.h"
#include "sculpt/session/history.h"
#include "sculpt/session/journal.h"
#include "sculpt/session/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_session iso_session;

typedef struct iso_session_opts {
    iso_pool *pool;         /* borrowed */
    const char *journal;    /* path of the stroke file to write; NULL: none */
    bool resume;            /* the file exists: what it holds is played first, then it is continued */
    size_t undo_memory;     /* bytes; 0 means 1 GiB */
    int checkpoint_strokes; /* a snapshot beside the journal after so many strokes, written by a thread of its
                             own; 0 means 200, < 0 never */
    double work; /* times iso_limit_work that iso_session_play may take: a finer grid makes more work of the
                    same strokes; 0 means 1 */
    const iso_progress *progress; /* of resuming; cancelled: ISO_ERR_IO, and the journal is as it was */
} iso_session_opts;

/* Takes over the grid (also when it fails). `start` says what the grid is; the journal's header. Resuming
 * begins at the last snapshot that can be read; what was done before it cannot be undone then. */
iso_status iso_session_create(iso_hgrid *grid, const iso_journal_start *start, const iso_session_opts *opts,
                              iso_session **session, iso_error *error);
/* Closes the journal; what was not saved stays in it. */
void iso_session_destroy(iso_session *session);

iso_hgrid *iso_session_grid(iso_session *session);            /* borrowed; do not write */
const iso_mask *iso_session_mask(const iso_session *session); /* borrowed */
iso_history *iso_session_history(iso_session *session);
bool iso_session_has_mask(const iso_session *session);
bool iso_session_masked(const iso_session *session, int x, int y, int z); /* a voxel inside the grid */

/* A stroke: begin with its first sample, then samples, then end or cancel. A sample makes as many touches as
 * the spacing asks for (none when the hand has hardly moved); more than ISO_LIMIT_TOUCHES are ISO_ERR_USAGE,
 * and none is made. stats add up. */
iso_status iso_session_begin(iso_session *session, const iso_brush *brush, const iso_sample *sample,
                             iso_edit_stats *stats, iso_error *error);
iso_status iso_session_sample(iso_session *session, const iso_sample *sample, iso_edit_stats *stats,
                              iso_error *error);
iso_status iso_session_end(iso_session *session, iso_error *error);
iso_status iso_session_cancel(iso_session *session, iso_error *error);
iso_status iso_session_undo(iso_session *session, iso_error *error);
iso_status iso_session_redo(iso_session *session, iso_error *error);

/* The field as it is now, for another thread (iso_snapshot_copy), while the session goes on; destroyed by
 * iso_session_release_snapshot, before the session. ISO_ERR_USAGE while a stroke is drawn, or when too many
 * are held; ISO_ERR_NOMEM. */
enum { ISO_SESSION_SNAPSHOTS = 4 };
iso_status iso_session_snapshot(iso_session *session, iso_snapshot **snapshot, iso_error *error);
void iso_session_release_snapshot(iso_session *session, iso_snapshot *snapshot);

/* What strokes with ISO_SOLID_STAMP use from now on; takes it over (also when it fails), and the journal gets
 * all of it. ISO_ERR_USAGE while a stroke is drawn. */
iso_status iso_session_set_stamp(iso_session *session, iso_stamp *stamp, iso_error *error);
const iso_stamp *iso_session_stamp(const iso_session *session); /* NULL: none yet */

/* Why the journal lags behind, or ISO_OK. */
iso_status iso_session_journal_status(iso_session *session, iso_error *error);

/* Plays one event of a stroke file. ISO_ERR_USAGE: the events before it do not allow it; ISO_ERR_FORMAT: the
 * file asks for more work than iso_limit_work says. iso_journal_blame names the line. */
iso_status iso_session_play(iso_session *session, const iso_event *event, iso_edit_stats *stats,
                            iso_error *error);

/* The unit ball of a new session: a grid of `dims` voxels of `voxel_size` mm with a ball of `radius` mm at
 * the world's origin, which is the grid's centre. */
iso_status iso_session_ball(const iso_journal_start *start, iso_hgrid **grid, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
