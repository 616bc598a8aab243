/* document: the session that a window works on, with its journal, the file it is saved to, and the recovery
 * of journals that a crashed program left behind. Saving itself is in save.h.
 *
 * While a program has the journal NAME.strokes open, it holds a lock on NAME.strokes.open beside it. A lock
 * file that no program has locked belongs to a program that was killed: recovery of its journal is offered.
 * The lock file holds two lines, so that recovered work looks as it did and is saved where it was: the path
 * that the session was saved to last, which may be empty, and the look (look.h).
 */
#ifndef ISO_APPS_ISOSCULPT_DOCUMENT_H
#define ISO_APPS_ISOSCULPT_DOCUMENT_H

#include <sys/types.h>

#include "apps/isosculpt/stroke_editor.h"
#include "base/c_linkage.h"
#include "sculpt/session/session.h"
#include "source/source.h"

ISO_C_BEGIN

enum { ISOSCULPT_PATH = ISO_JOURNAL_TEXT }; /* bytes of a path, with its end */
enum { ISOSCULPT_LOOK = 1024 };             /* bytes of the text of a look, with its end (look.h) */

typedef struct isosculpt_saver isosculpt_saver;

/* A file that a save has kept under another name. */
typedef struct isosculpt_backup {
    char path[ISOSCULPT_PATH]; /* "": there is none */
    dev_t device;
    ino_t inode;
} isosculpt_backup;

/* Zero-initialise, then set `pool` (borrowed) and `undo_memory`; isosculpt_document_close. */
typedef struct isosculpt_document {
    iso_session *session; /* owned */
    isosculpt_stroke_editor strokes;
    iso_journal_start start;
    char journal[ISOSCULPT_PATH]; /* path; "": no journal is written */
    char journal_error[512];      /* why there is no journal; "" when there is one */
    int lock_file;                /* 1 + file descriptor of NAME.strokes.open; 0: none */
    bool journal_is_new;          /* made by this session: removed when nothing was done */
    bool has_stamp;               /* the journal contains a stamp, so it is kept even without strokes */
    bool was_unclosed;            /* the journal was unclosed when it was opened */
    size_t
        change_count; /* number of strokes, edits, undos and redos since the document was opened; a recovery
                                  counts as one */
    size_t saved_change_count; /* value of change_count when the target file was saved */
    double start_seconds;      /* iso_clock_seconds when the session began */
    iso_pool *pool;
    size_t undo_memory;          /* limit of the undo history, bytes */
    char target[ISOSCULPT_PATH]; /* the file that saving writes; initially a default name */
    bool target_is_own;          /* this session has written the target, so saving again need not ask */
    bool target_was_saved; /* the target holds a state of this session, which may be an earlier program's */
    char look[ISOSCULPT_LOOK];     /* as in the lock file; "": none yet */
    char saved_as[ISOSCULPT_PATH]; /* the file of the last save or export, also of a failed one */
    isosculpt_backup backup;       /* what the last save that replaced a file has kept */
    size_t saved_open_edges;       /* of the mesh that was written last; 0 for a level set */
    bool saved_nothing;            /* the level set that was written last has no solid */
    isosculpt_saver *saver;        /* owned; NULL: no save is running (save.h) */
} isosculpt_document;

/* The folder of journals: $XDG_STATE_HOME/isopoint or ~/.local/state/isopoint. _name_: its path, whether it
 * is there or not; the other makes it when it is missing. ISO_ERR_WRITE. */
iso_status isosculpt_document_name_state_folder(char folder[ISOSCULPT_PATH], iso_error *error);
iso_status isosculpt_document_state_folder(char folder[ISOSCULPT_PATH], iso_error *error);

/* Finds the newest journal in the folder in which something was done, that was not closed and that no program
 * has open; false: there is none. */
bool isosculpt_document_find_unclosed(const char *folder, char path[ISOSCULPT_PATH]);

/* Removes the lock file, so that recovery of this journal is not offered again; the stroke file stays. */
void isosculpt_document_dismiss_recovery(const char *journal);

/* Opens a document on a source, or on a new ball (NULL), with a new journal in `folder` that is named after
 * the time. Where no journal can be written, or with `folder` NULL, the document works without one;
 * `journal_error` says why. Errors: those of iso_source_open. */
iso_status isosculpt_document_new(isosculpt_document *document, const char *folder, const iso_source *source,
                                  iso_error *error);

/* Writes the document's target and look into its lock file. Called when one of them has changed. */
void isosculpt_document_remember(const isosculpt_document *document);

/* Opens a stroke file: makes the field that it began with, replays it, and appends to it from now on. The
 * target is the one that was remembered when the file is recovered, else a name beside it.
 * ISO_ERR_IO, ISO_ERR_FORMAT; ISO_ERR_WRITE when another program has it open or it cannot be written. When
 * cancelled, ISO_ERR_IO, and the file is unchanged. */
iso_status isosculpt_document_open(isosculpt_document *document, const char *journal,
                                   const iso_progress *progress, iso_error *error);

/* Opens a document whose session begins as that of a stroke file, in voxels of another size, and plays all of
 * its events, which go into a new journal in `folder`: what could be undone can be. The file, which may be
 * open, stays as it is. Errors as isosculpt_document_open; ISO_ERR_WRITE: the new journal cannot be written;
 * ISO_ERR_LIMIT: too many voxels. */
iso_status isosculpt_document_resample(isosculpt_document *document, const char *journal, const char *folder,
                                       double voxel, const iso_progress *progress, iso_error *error);

/* Makes the field that a session began with, from its journal's header and path ("": it has none); the caller
 * owns *grid. For any thread. Errors: those of iso_source_reopen. */
iso_status isosculpt_document_first_field(const iso_journal_start *start, const char *journal, iso_pool *pool,
                                          const iso_progress *progress, iso_hgrid **grid, iso_error *error);

/* Opens an empty field without a journal, for a window that has nothing to show yet. */
iso_status isosculpt_document_init_empty(isosculpt_document *document, iso_error *error);

/* Waits for a running save, ends the session and closes its journal. pool and undo_memory stay set. */
void isosculpt_document_close(isosculpt_document *document);

/* Closes a document that was never shown to the user. A journal that an earlier program left unclosed stays
 * unclosed, so that its recovery is offered again. */
void isosculpt_document_discard(isosculpt_document *document);

ISO_C_END
#endif
