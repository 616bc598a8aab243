/* journal: the session as an append-only stroke file. JSON Lines: a header, then one line for each event,
 * each with its number and the CRC-32C of what stands before the checksum member. Numbers are written so that
 * they read back as the same doubles.
 *
 * The same file is autosave, crash recovery, undo history, recorded demo, regression test and benchmark. A
 * torn last line costs that line only; a damaged line in the middle ends what can be used there, and is
 * named. */
#ifndef ISO_SCULPT_SESSION_JOURNAL_H
#define ISO_SCULPT_SESSION_JOURNAL_H

#include <stdbool.h>
#include <stdint.h>

#include "sculpt/brush/brush.h"
#include "sculpt/brush/stamp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Version 2: how the source is read; isovalues of level sets are millimetres, where they were voxels. What
 * needs neither is still written as version 1. */
enum { ISO_JOURNAL_VERSION = 2, ISO_JOURNAL_TEXT = 1024 };

/* Where the session began: a new ball or a file, in a grid of this shape. */
typedef struct iso_journal_start {
    char source[ISO_JOURNAL_TEXT]; /* "ball", or the path of a file */
    uint32_t source_crc;           /* CRC-32C of the file, 0 for a ball */
    double voxel_size;             /* mm */
    int dims[3];
    iso_vec3 origin;                /* world position of voxel (0, 0, 0) */
    double radius;                  /* of the ball, mm */
    double isovalue;                /* of a volume: physical */
    char reading[ISO_JOURNAL_TEXT]; /* how the source is read, as the program that reads it says it; "" by
                                       default */
    bool voxel_isovalue;            /* from version 1: a level set's isovalue is in voxels */
} iso_journal_start;

typedef enum iso_event_kind {
    ISO_EVENT_BEGIN, /* a stroke: brush and its first sample */
    ISO_EVENT_SAMPLE,
    ISO_EVENT_END,
    ISO_EVENT_CANCEL, /* the stroke is taken back */
    ISO_EVENT_UNDO,
    ISO_EVENT_REDO,
    ISO_EVENT_SNAPSHOT, /* the field as it was after the first `after` events is in the file `text` */
    ISO_EVENT_STAMP     /* what strokes stamp from here on */
} iso_event_kind;

typedef struct iso_event {
    iso_event_kind kind;
    iso_brush brush;   /* BEGIN */
    iso_sample sample; /* BEGIN, SAMPLE */
    char text[ISO_JOURNAL_TEXT];
    unsigned long long after;
    iso_stamp *stamp; /* STAMP; borrowed: put packs it, a reader keeps it until its next event */
} iso_event;

/* ---- writing: a thread of its own writes; events are handed to it without waiting for the disk */

typedef struct iso_journal iso_journal;

/* Creates the file (ISO_ERR_WRITE when it exists or cannot be made) or, with `append`, continues one that was
 * read to its end. Flushes at most 1 s apart, fsync after each END. */
iso_status iso_journal_create(const char *path, const iso_journal_start *start, iso_journal **journal,
                              iso_error *error);
iso_status iso_journal_append(const char *path, iso_journal **journal, iso_error *error);

/* Never blocks on the disk. ISO_ERR_NOMEM. When writing fails (full disk) events are kept in memory and tried
 * again; iso_journal_status says so. */
iso_status iso_journal_put(iso_journal *journal, const iso_event *event, iso_error *error);
/* Events that were put, those of the file that is continued included. */
unsigned long long iso_journal_count(const iso_journal *journal);
/* ISO_OK, or why the file lags behind. Thread-safe. */
iso_status iso_journal_status(iso_journal *journal, iso_error *error);
/* Waits until everything put is on the disk. */
iso_status iso_journal_sync(iso_journal *journal, iso_error *error);
/* Syncs and closes. */
iso_status iso_journal_close(iso_journal *journal, iso_error *error);

/* ---- reading */

typedef struct iso_journal_reader iso_journal_reader;

/* ISO_ERR_IO, ISO_ERR_FORMAT (not a stroke file, a newer version, a number outside its bounds (limits.h)). */
iso_status iso_journal_open(const char *path, iso_journal_start *start, iso_journal_reader **reader,
                            iso_error *error);
void iso_journal_reader_free(iso_journal_reader *reader);
/* The next event; *more = false at the end. A torn last line is the end. A damaged line before the end, and a
 * sound one that says what no recording says, is ISO_ERR_FORMAT naming its number; what came before it has
 * been delivered. */
iso_status iso_journal_next(iso_journal_reader *reader, iso_event *event, bool *more, iso_error *error);
/* The failure of playing the last event, named by the file and its line; wrong usage is the file's: it
 * becomes ISO_ERR_FORMAT. Returns what to return. ISO_OK, and what is not the event's fault (a cancelled
 * replay, a disk that cannot be read), stay as they are. */
iso_status iso_journal_blame(const iso_journal_reader *reader, iso_status status, iso_error *error);
/* Bytes up to the end of the last sound line. */
uint64_t iso_journal_sound_bytes(const iso_journal_reader *reader);

#ifdef __cplusplus
}
#endif
#endif
