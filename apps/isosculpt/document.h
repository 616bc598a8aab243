/* desk: the session that a window works on, with its journal and the journals' folder, and what an earlier
 * session left unclosed. Saving is save.h's.
 *
 * Beside a journal NAME.strokes that a program has open lies NAME.strokes.open, locked as long as that
 * program lives. A marker that nobody holds is left of a program that was killed: its journal is offered. */
#ifndef ISO_APPS_ISOSCULPT_DOCUMENT_H
#define ISO_APPS_ISOSCULPT_DOCUMENT_H

#include "apps/isosculpt/source.h"
#include "apps/isosculpt/task.h"
#include "sculpt/session/session.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISOSCULPT_PATH = ISO_JOURNAL_TEXT };

typedef struct isosculpt_saver isosculpt_saver;

/* Zero-initialise. */
typedef struct isosculpt_document {
    iso_session *session; /* owned */
    iso_journal_start start;
    char journal[ISOSCULPT_PATH]; /* "" when there is none */
    char trouble[512];            /* why there is no journal; "" when there is one */
    int marker;                   /* 1 + file descriptor of NAME.strokes.open; 0: none */
    bool surface_isovalue;        /* the journal is new: removed when nothing was done in it */
    bool kept;                    /* it holds something beside strokes */
    bool unclosed;                /* it was, when it was opened */
    size_t changes, saved;        /* done to the field since the desk was opened; of these in the target */
    double began;                 /* monotonic seconds */
    iso_pool *pool;               /* borrowed */
    size_t undo_memory;
    char target[ISOSCULPT_PATH];   /* the file that saving writes; known from the beginning */
    bool target_is_own;            /* this session wrote it: saving again does not ask */
    char saved_as[ISOSCULPT_PATH]; /* what the last save or export wrote, or failed to */
    isosculpt_saver *saver;        /* owned; NULL when nothing is being saved (save.h) */
} isosculpt_document;

/* $XDG_STATE_HOME/isopoint, or ~/.local/state/isopoint; made when it is not there. ISO_ERR_WRITE. */
iso_status isosculpt_document_state_folder(char folder[ISOSCULPT_PATH], iso_error *error);

/* The newest journal in the folder that was not closed and that nobody has open; false: none. */
bool isosculpt_document_find_unclosed(const char *folder, char path[ISOSCULPT_PATH]);

/* The journal will not be offered again; the stroke file stays. */
void isosculpt_document_dismiss_recovery(const char *journal);

/* What the source names, or a new ball (NULL); its journal in the folder and named by the time. Where no
 * journal can be written (or `folder` is NULL) the desk works without, and says so in `trouble`. Errors: the
 * source's. */
iso_status isosculpt_document_new(isosculpt_document *document, const char *folder,
                                  const isosculpt_source *source, iso_error *error);

/* Continues a stroke file, from what it began with. ISO_ERR_IO, ISO_ERR_FORMAT; ISO_ERR_WRITE when another
 * program has it open or it cannot be written. Cancelled: ISO_ERR_IO, and the file is as it was. */
iso_status isosculpt_document_open(isosculpt_document *document, const char *journal,
                                   const iso_progress *progress, iso_error *error);

/* A field of nothing, without a journal: before there is anything else. */
iso_status isosculpt_document_init_empty(isosculpt_document *document, iso_error *error);

/* Waits for a save, ends the session and closes its journal. The pool and undo_memory stay. */
void isosculpt_document_close(isosculpt_document *document);

/* The same of one that nobody came to see: a journal that was not closed before is not closed now. */
void isosculpt_document_discard(isosculpt_document *document);

#ifdef __cplusplus
}
#endif
#endif
