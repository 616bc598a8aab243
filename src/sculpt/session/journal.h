/* journal: an append-only file of all events that changed the field of a session (a stroke file). The format
 * is JSON Lines: a header, then one line for each event, with its number and, at the end, the CRC-32C of
 * the line's own text up to there. Doubles are written with all digits and read back exactly.
 *
 * The same file serves as autosave, crash recovery, undo history, recorded demo, regression test and
 * benchmark. An incomplete last line, as a crash leaves it, is ignored. A damaged line before the end is an
 * error that names the line; the events before it can be used. */
#ifndef ISO_SCULPT_SESSION_JOURNAL_H
#define ISO_SCULPT_SESSION_JOURNAL_H

#include <stdbool.h>
#include <stdint.h>

#include "sculpt/brush/brush.h"
#include "sculpt/brush/stamp.h"
#include "sculpt/session/start_solid.h"

/* Version 2 adds `reading`, and isovalues of level sets are in millimetres instead of voxels. Version 3 adds
 * edits of strokes, version 4 `has_colors`, version 5 `solid`. A file that is made says the first version
 * that has what it uses; edits that are appended to an older file leave its first line as it is, and older
 * programs refuse their lines. ISO_JOURNAL_TEXT: bytes of a text. */
enum { ISO_JOURNAL_VERSION = 5, ISO_JOURNAL_TEXT = 1024 };

/* The header: the source of the session's field, and its grid. */
typedef struct iso_journal_start {
    char source[ISO_JOURNAL_TEXT]; /* "ball", the name of `solid`, or the path of a file */
    uint32_t source_crc;           /* CRC-32C of the file, 0 for solids */
    double voxel_size;             /* mm */
    int dims[3];
    iso_vec3 origin;                /* world position of voxel (0, 0, 0) */
    double radius;                  /* of the ball, mm */
    iso_start_solid solid;          /* of a session that begins with another solid than a ball */
    double isovalue;                /* of a source file: physical */
    char reading[ISO_JOURNAL_TEXT]; /* the options with which the program read the source; "" for the defaults
                                     */
    bool voxel_isovalue; /* the file is of version 1, in which the isovalue of a level set is in voxels */
    bool has_edits;      /* the file is of version 3 or later */
    bool has_colors;     /* the session began with the colours of the source, as paint */
} iso_journal_start;

typedef enum iso_event_kind {
    ISO_EVENT_BEGIN,  /* begins a stroke: the brush and the first sample */
    ISO_EVENT_SAMPLE, /* a further sample of the stroke */
    ISO_EVENT_END,    /* ends the stroke */
    ISO_EVENT_CANCEL, /* cancels the stroke: the field is as before it */
    ISO_EVENT_UNDO,
    ISO_EVENT_REDO,
    ISO_EVENT_CHECKPOINT, /* the file `text` contains the field after the first `after` events */
    ISO_EVENT_STAMP,      /* the stamp for the strokes that follow */
    /* Edits change the list of strokes that the field is made of (stroke_list.h). They name the strokes with
     * numbers `first` to `last`: strokes are numbered from 1 as they begin, cancelled and undone ones too. */
    ISO_EVENT_EDIT,   /* gives a stroke another brush */
    ISO_EVENT_DELETE, /* removes strokes */
    ISO_EVENT_MUTE,   /* strokes are not drawn ... */
    ISO_EVENT_UNMUTE, /* ... or drawn again */
    ISO_EVENT_MOVE,   /* strokes are drawn before the stroke `before` */
    ISO_EVENT_GROUP,  /* strokes belong to the group `text` from now on; "": to none */
    ISO_EVENT_PATH,   /* a stroke has the samples `path` from now on */
    ISO_EVENT_RESEAT  /* the same for several strokes, whose samples follow the surface that they lie on */
} iso_event_kind;

static inline bool iso_event_is_edit(iso_event_kind kind) {
    return kind >= ISO_EVENT_EDIT;
}
static inline bool iso_event_has_path(iso_event_kind kind) {
    return kind == ISO_EVENT_PATH || kind == ISO_EVENT_RESEAT;
}

typedef struct iso_event {
    iso_event_kind kind;
    iso_brush brush;             /* BEGIN, EDIT */
    iso_sample sample;           /* BEGIN, SAMPLE */
    char text[ISO_JOURNAL_TEXT]; /* CHECKPOINT: path; GROUP: name; of other edits, if first == 0: the group
                                    whose strokes they name */
    unsigned long long after;    /* CHECKPOINT */
    unsigned first, last;        /* edits */
    unsigned before;             /* BEGIN, MOVE: a stroke's number; 0: the end of the list */
    iso_stamp *stamp;            /* STAMP; borrowed; the reader's is valid until its next event */
    const iso_sample *path; /* PATH, RESEAT: as many as the strokes have, in the order of their numbers; */
    size_t path_count;      /* borrowed as the stamp is */
} iso_event;

/* ---- writing, in a background thread: the caller never waits for the disk */

typedef struct iso_journal iso_journal;

/* Creates the file (ISO_ERR_WRITE: it exists, or cannot be created), or appends to a stroke file, whose
 * incomplete last line is removed. Lines are written to the file within 1 s; after every event but BEGIN and
 * SAMPLE they are written at once and synced to the disk. The file is locked until it is closed, whatever
 * names it has: ISO_ERR_WRITE if another journal has it open. ISO_ERR_NOMEM; append fails as reading does,
 * too. */
iso_status iso_journal_create(const char *path, const iso_journal_start *start, iso_journal **journal,
                              iso_error *error);
iso_status iso_journal_append(const char *path, iso_journal **journal, iso_error *error);

/* Whether another journal, of any program, has the file open for writing. */
bool iso_journal_is_locked(const char *path);

/* Adds an event; never waits for the disk. If writing fails (full disk), events stay in memory and are tried
 * again; iso_journal_status reports it. ISO_ERR_NOMEM. */
iso_status iso_journal_put(iso_journal *journal, const iso_event *event, iso_error *error);
/* Returns the number of events in the journal, including those it had before iso_journal_append. */
unsigned long long iso_journal_count(const iso_journal *journal);
/* Returns ISO_ERR_WRITE if the last attempt to write failed; the message says why. Thread-safe. */
iso_status iso_journal_status(iso_journal *journal, iso_error *error);
/* Waits until all events are on the disk. ISO_ERR_WRITE. */
iso_status iso_journal_sync(iso_journal *journal, iso_error *error);
/* Syncs, closes the file and frees the journal, whether syncing fails (ISO_ERR_WRITE) or not. */
iso_status iso_journal_close(iso_journal *journal, iso_error *error);

/* Writes the events of a stroke file, and edits that follow them, to another file, which appears whole.
 * Checkpoints are left out, and a stroke without an end is ended (iso_session_end_cut_off). Errors: those of
 * reading; ISO_ERR_WRITE. */
iso_status iso_journal_rewrite(const char *from, const iso_event *edits, size_t count, const char *to,
                               iso_error *error);

/* ---- reading */

typedef struct iso_journal_reader iso_journal_reader;

/* Opens a stroke file and reads its header. ISO_ERR_IO; ISO_ERR_FORMAT: not a stroke file, of a newer
 * version, or with a number outside its bounds (limits.h); ISO_ERR_NOMEM. */
iso_status iso_journal_open(const char *path, iso_journal_start *start, iso_journal_reader **reader,
                            iso_error *error);
void iso_journal_reader_free(iso_journal_reader *reader);
/* Reads the next event; *more = false at the end of the file, or at an incomplete last line. ISO_ERR_FORMAT:
 * a damaged line before the end, or an invalid event; the message names the line. ISO_ERR_IO, ISO_ERR_NOMEM.
 */
iso_status iso_journal_next(iso_journal_reader *reader, iso_event *event, bool *more, iso_error *error);
/* Adds the file and line of the last event to the error of playing it, and returns the status to return:
 * ISO_ERR_USAGE becomes ISO_ERR_FORMAT, because the file is at fault. ISO_OK, and errors that the event did
 * not cause (cancelled, disk error), stay as they are. */
iso_status iso_journal_add_location(const iso_journal_reader *reader, iso_status status, iso_error *error);
/* Returns the number of bytes up to the end of the last valid line. */
uint64_t iso_journal_sound_bytes(const iso_journal_reader *reader);

#endif
