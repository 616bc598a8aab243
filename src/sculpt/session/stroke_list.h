/* stroke_list: the strokes of a session, which stay editable. The log holds the strokes and the edits of
 * strokes (events ISO_EVENT_EDIT to ISO_EVENT_RESEAT) in the order in which they were made; the list that
 * they resolve to is what the field is made of: the field is always that of a fresh session in which the
 * strokes of the list are drawn one after the other. Internal to sculpt, except iso_stroke_list. */
#ifndef ISO_SCULPT_SESSION_STROKE_LIST_H
#define ISO_SCULPT_SESSION_STROKE_LIST_H

#include "base/c_linkage.h"
#include "base/memory.h"
#include "sculpt/session/journal.h"

ISO_C_BEGIN

/* A stroke of the list. Pointers are valid until the log changes. */
typedef struct iso_stroke {
    unsigned number; /* the strokes of a session are numbered from 1 as they begin, cancelled ones too */
    bool muted;      /* it is not drawn */
    iso_brush brush;
    const iso_sample *samples; /* at least one */
    size_t count;
    size_t path;       /* which samples: when they change it becomes another number, which none had before */
    iso_stamp *stamp;  /* that was set when it was drawn; NULL: none */
    const char *group; /* "": it is in none */
} iso_stroke;

typedef struct iso_stroke_list {
    iso_buffer strokes; /* iso_stroke, in the order in which they are drawn */
    size_t count;
} iso_stroke_list;

static inline iso_stroke *iso_stroke_at(const iso_stroke_list *list, size_t index) {
    return (iso_stroke *)list->strokes.data + index;
}
/* Returns the stroke with a number; NULL: it is not in the list. */
iso_stroke *iso_stroke_find(const iso_stroke_list *list, unsigned number);
void iso_stroke_list_free(iso_stroke_list *list);

/* What was done, in order. Zero-initialise; iso_stroke_log_free when done. */
typedef struct iso_stroke_entry iso_stroke_entry;
typedef struct iso_stroke_log {
    iso_buffer entries; /* iso_stroke_entry; those from `position` on are undone */
    size_t count, position;
    unsigned numbers; /* number of the last stroke that was begun */
    size_t changes;   /* of the log so far: lists that were resolved before hold pointers to what is gone */
} iso_stroke_log;

void iso_stroke_log_free(iso_stroke_log *log);

/* Append a stroke (its ISO_EVENT_BEGIN), or an edit, and a further sample of the last entry. `step`: it can
 * be undone by itself, and what was undone before is lost. ISO_ERR_NOMEM: the log is as before. */
iso_status iso_stroke_log_add(iso_stroke_log *log, const iso_event *event, iso_stamp *stamp, bool step,
                              iso_error *error);
iso_status iso_stroke_log_sample(iso_stroke_log *log, const iso_sample *sample, iso_error *error);
/* The samples of the last entry, and their number. */
const iso_sample *iso_stroke_log_samples(const iso_stroke_log *log, size_t *count);
/* Of the last entry, an edit: the strokes that it names; and its samples, which the caller may change while
 * no list has been resolved from them, with what iso_stroke.path is of strokes that have them. */
void iso_stroke_log_edited(const iso_stroke_log *log, unsigned *first, unsigned *last);
iso_sample *iso_stroke_log_path(iso_stroke_log *log, size_t *path);
/* The number of entries after the one that gave strokes their samples (iso_stroke.path), and up to the next
 * one, the last entry aside, that changes what was there before; 0: none has. */
size_t iso_stroke_log_before_edit(const iso_stroke_log *log, size_t path);
/* Decides whether the last entry, which was added with step = false, is a step after all. */
void iso_stroke_log_end(iso_stroke_log *log, bool step);
/* Removes the last entry, which iso_stroke_log_end has not been called for; an undone step stays undone. */
void iso_stroke_log_remove(iso_stroke_log *log);
/* Undo the last step, or redo the next one; there is one. */
void iso_stroke_log_undo(iso_stroke_log *log);
void iso_stroke_log_redo(iso_stroke_log *log);

/* Resolves the log into a list; `list` is overwritten (zero-initialise the first time). ISO_ERR_USAGE: an
 * edit names a stroke that is not in the list; ISO_ERR_NOMEM. */
iso_status iso_stroke_log_resolve(const iso_stroke_log *log, iso_stroke_list *list, iso_error *error);

ISO_C_END
#endif
