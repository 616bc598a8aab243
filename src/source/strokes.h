/* strokes: plays a stroke file from the field that it began with, event by event, for programs that show or
 * measure what it makes. */
#ifndef ISO_SOURCE_STROKES_H
#define ISO_SOURCE_STROKES_H

#include "sculpt/session/session.h"
#include "source/source.h"

typedef struct iso_strokes {
    iso_journal_start start; /* the header */
    iso_session *session;    /* owned */
    iso_journal_reader *reader;
    bool drawing; /* the last stroke has not ended */
} iso_strokes;

/* Whether a file begins as a stroke file does. Files that cannot be read are none. */
bool iso_strokes_are_in(const char *path);

/* Opens a stroke file and makes the field that it began with; `how` as for iso_source_reopen. Errors: those
 * of iso_journal_open, iso_source_reopen and iso_session_create. iso_strokes_close when done, also after an
 * error. */
iso_status iso_strokes_open(const char *path, const iso_source *how, iso_strokes *strokes, iso_error *error);

/* Plays the next event. *more: false at the end of the file; a last stroke that the file leaves open ends
 * then. Errors: those of iso_journal_next and iso_session_play, with the file and the line. */
iso_status iso_strokes_next(iso_strokes *strokes, iso_event *event, bool *more, iso_error *error);

/* Plays all events that are left. Errors: those of iso_strokes_next. */
iso_status iso_strokes_finish(iso_strokes *strokes, iso_error *error);

void iso_strokes_close(iso_strokes *strokes);

/* Plays a whole stroke file. The caller owns *grid, and *paint, which is overwritten: the paint of the grid's
 * cells, for iso_cell_items_free. Errors: those above; then there is neither. */
iso_status iso_strokes_play(const char *path, const iso_source *how, iso_hgrid **grid, iso_cell_items *paint,
                            iso_error *error);

#endif
