/* stroke_editor: the strokes of a document as a window shows and edits them: their list, which of them are
 * selected, and the edits, which are drawn one after the other by a background thread. For the window's
 * thread. */
#ifndef ISO_APPS_ISOSCULPT_STROKE_EDITOR_H
#define ISO_APPS_ISOSCULPT_STROKE_EDITOR_H

#include "apps/isosculpt/task.h"
#include "base/c_linkage.h"
#include "sculpt/session/session.h"

ISO_C_BEGIN

/* Zero-initialise; isosculpt_stroke_editor_free before the session is destroyed. */
typedef struct isosculpt_stroke_editor {
    unsigned first, last;         /* numbers of the strokes that are selected; 0: none */
    char group[ISO_JOURNAL_TEXT]; /* whose strokes are selected instead; "": none */
    iso_brush brush; /* of the stroke, if only one is selected, as the panel changes it; tubes are spheres */
    iso_brush asked; /* as the last edit asks for it */
    unsigned before; /* new strokes are placed before this one; 0: at the end */

    iso_stroke_list list; /* as of `changes` */
    iso_error no_list;    /* why there is no list; text[0] == 0: there is one */
    size_t changes;       /* iso_session_stroke_changes + 1; 0: not listed yet */

    /* Edits that are still to be made, owned, with their paths: the first is being drawn if there is a task
     * that is not `preparing`. */
    iso_event *edits;
    size_t count, room;
    isosculpt_task *task; /* or NULL */
    double seconds;       /* iso_clock_seconds when it began */
    bool preparing;       /* the task makes versions, and no edit */
    bool prepared;        /* it has done so before */
    bool dropped;         /* the edit that is being drawn is no longer wanted */
    bool seeking;         /* the stroke that made the surface at `place` is to be selected */
    iso_vec3 place;       /* world */
    bool found_none;      /* no stroke did; the window clears this when it has said so */
} isosculpt_stroke_editor;

/* Cancels all edits that are not made yet, and waits for the thread. */
void isosculpt_stroke_editor_stop(isosculpt_stroke_editor *editor, iso_session *session);
void isosculpt_stroke_editor_free(isosculpt_stroke_editor *editor, iso_session *session);

/* The list, up to date until the session changes; also updates the selection. NULL: there is none, and
 * editor->no_list says why. */
const iso_stroke_list *isosculpt_stroke_editor_list(isosculpt_stroke_editor *editor,
                                                    const iso_session *session);

/* Selects the strokes with the numbers first to last, or (0, 0) none. */
void isosculpt_stroke_editor_select(isosculpt_stroke_editor *editor, unsigned first, unsigned last);
/* Selects the strokes of a group. */
void isosculpt_stroke_editor_select_group(isosculpt_stroke_editor *editor, const char *group);
bool isosculpt_stroke_editor_selects(const isosculpt_stroke_editor *editor, const iso_stroke *stroke);
/* Selects the last stroke that changed the surface at a world position, as soon as that is known. */
void isosculpt_stroke_editor_seek(isosculpt_stroke_editor *editor, iso_vec3 place);
/* The stroke, if one and only one is selected; else NULL. */
const iso_stroke *isosculpt_stroke_editor_stroke(isosculpt_stroke_editor *editor, const iso_session *session);

/* The samples that a stroke of the list has when all requests are made, as many as it has now. */
const iso_sample *isosculpt_stroke_editor_path(const isosculpt_stroke_editor *editor,
                                               const iso_stroke *stroke);

/* Requests an edit, whose path is copied. One that gives a stroke a brush or a path takes the place of an
 * earlier one that is still to be made. Errors (of memory) leave the requests as they are. */
iso_status isosculpt_stroke_editor_request(isosculpt_stroke_editor *editor, const iso_event *event,
                                           iso_error *error);
/* Requests that the selected strokes are deleted, muted, reseated ... (not ISO_EVENT_EDIT and _PATH). */
iso_status isosculpt_stroke_editor_request_all(isosculpt_stroke_editor *editor, iso_event_kind kind,
                                               iso_error *error);
/* Requests that the selected stroke gets editor->brush, if that has been changed. */
iso_status isosculpt_stroke_editor_request_brush(isosculpt_stroke_editor *editor, iso_error *error);
/* After a stroke was drawn at the end of the list: requests that it is placed where new strokes go. */
iso_status isosculpt_stroke_editor_place(isosculpt_stroke_editor *editor, const iso_session *session,
                                         iso_error *error);
/* Withdraws the last edit that is still to be made. Returns false when there is none. */
bool isosculpt_stroke_editor_withdraw(isosculpt_stroke_editor *editor);
/* Whether a thread uses the session, which cannot be changed otherwise until then. */
bool isosculpt_stroke_editor_is_busy(const isosculpt_stroke_editor *editor);

/* Take over what the thread has made; `changed` is set if the field has. Start the next task, if there is
 * something to do. `wake`: see isosculpt_task_start. Errors: those of the edit, which is not made then. */
iso_status isosculpt_stroke_editor_take(isosculpt_stroke_editor *editor, iso_session *session, bool *changed,
                                        iso_error *error);
iso_status isosculpt_stroke_editor_start(isosculpt_stroke_editor *editor, iso_session *session,
                                         void (*wake)(void), iso_error *error);

/* A stroke's brush as widgets show it (tubes are spheres), and as strokes have it: tubes leave no ridges
 * between touches, and stamps are set down apart. */
iso_brush isosculpt_brush_shown(const iso_brush *brush);
iso_brush isosculpt_brush_drawn(const iso_brush *brush);

ISO_C_END
#endif
