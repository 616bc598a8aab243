/* stroke_edits: the edits of strokes that the command line asks for. */
#ifndef ISO_APPS_ISOSCULPT_STROKE_EDITS_H
#define ISO_APPS_ISOSCULPT_STROKE_EDITS_H

#include "sculpt/session/session.h"

enum { ISOSCULPT_EDITS = 64 };

/* An edit as it was given; texts are borrowed from argv. */
typedef struct isosculpt_edit {
    iso_event_kind kind;
    const char *text;     /* the whole value */
    unsigned first, last; /* numbers of strokes; 0: those of a group */
    char group[256];      /* its name */
    const char *rest;     /* behind the colon: KEY=VALUE,... of --edit, a stroke or `end` of --move, a name */
} isosculpt_edit;

typedef struct isosculpt_edits {
    isosculpt_edit edit[ISOSCULPT_EDITS]; /* in the order of the command line */
    int count;
} isosculpt_edits;

/* Parses the value of --edit, --delete, --mute, --unmute, --move, --group or --reseat and appends it.
 * ISO_ERR_USAGE. */
iso_status isosculpt_edits_add(isosculpt_edits *edits, iso_event_kind kind, const char *text,
                               iso_error *error);

/* Whether the edit names the stroke. */
bool isosculpt_edit_names(const isosculpt_edit *edit, const iso_stroke *stroke);
/* Makes the event of an edit of stroke `number` (of --edit; else of all strokes that it names).
 * ISO_ERR_USAGE: the list has no such stroke. */
iso_status isosculpt_edit_event(const isosculpt_edit *edit, const iso_stroke *stroke, iso_event *event,
                                iso_error *error);

#endif
