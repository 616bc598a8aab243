/* The editor of strokes: a queue of edits, of which one is drawn at a time. */
#include "apps/isosculpt/stroke_editor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

/* Distance between the touches of a stamp, in radii. */
static const double STAMP_SPACING = 1;

iso_brush isosculpt_brush_shown(const iso_brush *brush) {
    iso_brush shown = *brush;
    if (shown.shape == ISO_SOLID_CAPSULE) shown.shape = ISO_SOLID_SPHERE;
    return shown;
}

iso_brush isosculpt_brush_drawn(const iso_brush *brush) {
    iso_brush drawn = *brush;
    const bool tube = brush->tool == ISO_TOOL_ADD || brush->tool == ISO_TOOL_CARVE;
    if (tube && drawn.shape == ISO_SOLID_SPHERE) drawn.shape = ISO_SOLID_CAPSULE;
    if (drawn.shape == ISO_SOLID_STAMP) drawn.spacing = STAMP_SPACING;
    return drawn;
}

/* ---- the list and the selection */

static bool is_single(const isosculpt_stroke_editor *editor) {
    return editor->first && editor->first == editor->last;
}

/* The brush that the selected stroke has, or will have when all edits are made. */
static iso_brush brush_to_be(const isosculpt_stroke_editor *editor) {
    for (size_t i = editor->count; i-- > 0;)
        if (editor->edits[i].kind == ISO_EVENT_EDIT && editor->edits[i].first == editor->first)
            return isosculpt_brush_shown(&editor->edits[i].brush);
    return isosculpt_brush_shown(&iso_stroke_find(&editor->list, editor->first)->brush);
}

bool isosculpt_stroke_editor_selects(const isosculpt_stroke_editor *editor, const iso_stroke *stroke) {
    if (editor->group[0]) return strcmp(stroke->group, editor->group) == 0;
    return stroke->number >= editor->first && stroke->number <= editor->last;
}

static void update_selection(isosculpt_stroke_editor *editor) {
    bool any = false;
    for (size_t i = 0; i < editor->list.count && !any; i++)
        any = isosculpt_stroke_editor_selects(editor, iso_stroke_at(&editor->list, i));
    if (!any) editor->first = editor->last = 0;
    if (!any) editor->group[0] = 0;
    if (editor->before && !iso_stroke_find(&editor->list, editor->before)) editor->before = 0;
    if (is_single(editor) && iso_brush_is_same(&editor->brush, &editor->asked))
        editor->brush = editor->asked = brush_to_be(editor);
}

const iso_stroke_list *isosculpt_stroke_editor_list(isosculpt_stroke_editor *editor,
                                                    const iso_session *session) {
    const size_t changes = iso_session_stroke_changes(session) + 1;
    if (editor->changes == changes) return editor->no_list.text[0] ? NULL : &editor->list;
    editor->no_list.text[0] = 0;
    editor->changes = changes;
    if (iso_session_strokes(session, &editor->list, &editor->no_list) != ISO_OK) {
        editor->list.count = 0;
        editor->first = editor->last = 0;
        editor->group[0] = 0;
        return NULL;
    }
    update_selection(editor);
    return &editor->list;
}

void isosculpt_stroke_editor_select(isosculpt_stroke_editor *editor, unsigned first, unsigned last) {
    editor->first = first < last ? first : last;
    editor->last = first < last ? last : first;
    editor->group[0] = 0;
    editor->seeking = false;
    editor->brush = editor->asked; /* to be that of the new stroke */
    editor->changes = 0;
}

void isosculpt_stroke_editor_select_group(isosculpt_stroke_editor *editor, const char *group) {
    isosculpt_stroke_editor_select(editor, 0, 0);
    snprintf(editor->group, sizeof editor->group, "%s", group);
}

const iso_stroke *isosculpt_stroke_editor_stroke(isosculpt_stroke_editor *editor,
                                                 const iso_session *session) {
    const iso_stroke_list *list = editor->first ? isosculpt_stroke_editor_list(editor, session) : NULL;
    return list && is_single(editor) ? iso_stroke_find(list, editor->first) : NULL;
}

void isosculpt_stroke_editor_seek(isosculpt_stroke_editor *editor, iso_vec3 place) {
    editor->place = place;
    editor->seeking = true;
}

/* ---- requests */

/* The edit that is being drawn is not wanted any more. */
static void drop_drawing(isosculpt_stroke_editor *editor) {
    if (!editor->task || editor->preparing) return;
    editor->dropped = true;
    isosculpt_task_cancel(editor->task);
}

const iso_sample *isosculpt_stroke_editor_path(const isosculpt_stroke_editor *editor,
                                               const iso_stroke *stroke) {
    for (size_t i = editor->count; i-- > 0;)
        if (editor->edits[i].kind == ISO_EVENT_PATH && editor->edits[i].first == stroke->number &&
            editor->edits[i].path_count == stroke->count)
            return editor->edits[i].path;
    return stroke->samples;
}

/* Copies an edit with its path. */
static iso_status copy_edit(const iso_event *event, iso_event *copy, iso_error *error) {
    const size_t bytes = event->path_count * sizeof *event->path;
    *copy = *event;
    if (!bytes) return ISO_OK;
    iso_sample *path = malloc(bytes);
    if (!path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the path of a stroke");
    memcpy(path, event->path, bytes);
    copy->path = path;
    return ISO_OK;
}

static void free_edit(iso_event *edit) {
    free((void *)edit->path);
    edit->path = NULL;
}

/* Whether an edit replaces an earlier one, as both give the same stroke a brush or a path. */
static bool replaces(const iso_event *event, const iso_event *earlier) {
    return event->kind == earlier->kind && event->first == earlier->first &&
           (event->kind == ISO_EVENT_EDIT || event->kind == ISO_EVENT_PATH);
}

iso_status isosculpt_stroke_editor_request(isosculpt_stroke_editor *editor, const iso_event *event,
                                           iso_error *error) {
    iso_event *last = editor->count ? &editor->edits[editor->count - 1] : NULL, copy;
    if (editor->count == editor->room) {
        const size_t room = editor->room ? 2 * editor->room : 4;
        iso_event *edits = realloc(editor->edits, room * sizeof *edits);
        if (!edits) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an edit of a stroke");
        editor->edits = edits;
        editor->room = room;
        last = editor->count ? &editor->edits[editor->count - 1] : NULL;
    }
    ISO_TRY(copy_edit(event, &copy, error));
    if (!last || !replaces(event, last)) {
        editor->edits[editor->count++] = copy;
        return ISO_OK;
    }
    free_edit(last);
    *last = copy;
    if (editor->count == 1) drop_drawing(editor);
    return ISO_OK;
}

iso_status isosculpt_stroke_editor_request_all(isosculpt_stroke_editor *editor, iso_event_kind kind,
                                               iso_error *error) {
    iso_event event = {.kind = kind, .first = editor->first, .last = editor->last};
    memcpy(event.text, editor->group, sizeof event.text);
    return editor->first || editor->group[0] ? isosculpt_stroke_editor_request(editor, &event, error)
                                             : ISO_OK;
}

iso_status isosculpt_stroke_editor_request_brush(isosculpt_stroke_editor *editor, iso_error *error) {
    if (!is_single(editor) || iso_brush_is_same(&editor->brush, &editor->asked)) return ISO_OK;
    if (editor->asked.shape == ISO_SOLID_STAMP && editor->brush.shape != ISO_SOLID_STAMP)
        editor->brush.spacing = 0;
    editor->asked = editor->brush;
    const iso_event event = {.kind = ISO_EVENT_EDIT,
                             .first = editor->first,
                             .last = editor->first,
                             .brush = isosculpt_brush_drawn(&editor->brush)};
    return isosculpt_stroke_editor_request(editor, &event, error);
}

iso_status isosculpt_stroke_editor_place(isosculpt_stroke_editor *editor, const iso_session *session,
                                         iso_error *error) {
    const iso_stroke_list *list = editor->before ? isosculpt_stroke_editor_list(editor, session) : NULL;
    if (!list || !editor->before) return ISO_OK;
    const unsigned number = iso_stroke_at(list, list->count - 1)->number;
    const iso_event event = {
        .kind = ISO_EVENT_MOVE, .first = number, .last = number, .before = editor->before};
    return isosculpt_stroke_editor_request(editor, &event, error);
}

bool isosculpt_stroke_editor_withdraw(isosculpt_stroke_editor *editor) {
    if (!editor->count) return false;
    free_edit(&editor->edits[--editor->count]);
    if (editor->count == 0) drop_drawing(editor);
    editor->changes = 0;
    return true;
}

bool isosculpt_stroke_editor_is_busy(const isosculpt_stroke_editor *editor) {
    return editor->task || editor->count;
}

/* ---- drawing */

static iso_status draw(void *context, const iso_progress *progress, iso_error *error) {
    return iso_session_draw_edit(context, progress, error);
}

static void remove_first(isosculpt_stroke_editor *editor) {
    if (!editor->count) return;
    free_edit(&editor->edits[0]);
    memmove(editor->edits, editor->edits + 1, --editor->count * sizeof *editor->edits);
}

static void remove_all(isosculpt_stroke_editor *editor) {
    while (editor->count) free_edit(&editor->edits[--editor->count]);
}

/* Ends the task, whose work is done. */
static iso_status finish(isosculpt_stroke_editor *editor, iso_session *session, bool *changed,
                         iso_error *error) {
    const bool edit = !editor->preparing, dropped = editor->dropped,
               cancelled = isosculpt_task_cancelled(editor->task) && !dropped;
    iso_error reason = {0};
    iso_status status = isosculpt_task_finish(editor->task, &reason);
    editor->task = NULL;
    editor->dropped = false;
    const iso_status ended =
        iso_session_end_edit(session, status == ISO_OK && !dropped && !cancelled, &reason);
    if (status == ISO_OK) status = ended;
    editor->prepared |= status == ISO_OK;
    editor->changes = 0;
    if (cancelled) remove_all(editor);
    if (dropped || cancelled) editor->seeking &= dropped;
    if (dropped || cancelled) return ISO_OK;
    if (edit) remove_first(editor);
    *changed = edit && status == ISO_OK;
    if (status != ISO_OK) editor->seeking = false;
    if (status != ISO_OK && error) *error = reason;
    if (editor->seeking && !edit) {
        const unsigned number = iso_session_stroke_at(session, editor->place);
        isosculpt_stroke_editor_select(editor, number, number);
        editor->found_none = number == 0;
    }
    return status;
}

iso_status isosculpt_stroke_editor_take(isosculpt_stroke_editor *editor, iso_session *session, bool *changed,
                                        iso_error *error) {
    *changed = false;
    if (!editor->task || !isosculpt_task_done(editor->task)) return ISO_OK;
    return finish(editor, session, changed, error);
}

iso_status isosculpt_stroke_editor_start(isosculpt_stroke_editor *editor, iso_session *session,
                                         void (*wake)(void), iso_error *error) {
    if (editor->task || (!editor->count && !editor->seeking)) return ISO_OK;
    /* The first edit draws all strokes once; a further edit meanwhile takes its place only after that. */
    const bool prepares = !editor->prepared || !editor->count;
    iso_status status = iso_session_begin_edit(session, prepares ? NULL : &editor->edits[0], error);
    if (status == ISO_OK) {
        editor->preparing = prepares;
        editor->seconds = iso_clock_seconds();
        status = isosculpt_task_start(draw, session, wake, &editor->task, error);
        if (status != ISO_OK) iso_session_end_edit(session, false, NULL);
    }
    editor->changes = 0;
    if (status == ISO_OK) return ISO_OK;
    editor->seeking = false;
    remove_first(editor);
    return status;
}

void isosculpt_stroke_editor_stop(isosculpt_stroke_editor *editor, iso_session *session) {
    bool changed;
    remove_all(editor);
    editor->seeking = false;
    if (!editor->task) return;
    isosculpt_task_cancel(editor->task);
    finish(editor, session, &changed, NULL);
}

void isosculpt_stroke_editor_free(isosculpt_stroke_editor *editor, iso_session *session) {
    isosculpt_stroke_editor_stop(editor, session);
    free(editor->edits);
    iso_stroke_list_free(&editor->list);
    *editor = (isosculpt_stroke_editor){.first = 0};
}
