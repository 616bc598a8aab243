/* Commands of isosculpt's window: of the input controller, the panel and the dialogs. */
#include "apps/isosculpt/window/commands.h"

#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/style.h"
#include "apps/isosculpt/viewport/color_by.h"
#include "apps/isosculpt/window/opening.h"
#include "apps/isosculpt/window/reference.h"
#include "apps/isosculpt/window/saving.h"
#include "base/clock.h"

/* ---- background tasks */

static void add_progress_item(window *w, const char *verb, const char *path, const isosculpt_task *task) {
    isosculpt_progress_item *item = &w->screen.progress_items[w->screen.progress_item_count++];
    const char *slash = strrchr(path, '/');
    snprintf(item->text, sizeof item->text, "%s %.120s", verb, slash ? slash + 1 : path);
    item->fraction = isosculpt_task_fraction(task);
}

/* Whether strokes have been drawn again for so long that their progress is shown. */
static bool draws_strokes_long(const window *w) {
    const double patience = 0.4;
    return w->document.strokes.task && iso_clock_seconds() - w->document.strokes.seconds > patience;
}

/* Lists the running tasks in the order of their progress items; returns their number. */
static int list_tasks(const window *w, isosculpt_task *tasks[ISOSCULPT_PROGRESS_ITEMS]) {
    int count = 0;
    if (w->load_job) tasks[count++] = isosculpt_load_job_task(w->load_job);
    if (w->document.saver) tasks[count++] = isosculpt_document_save_task(&w->document);
    if (draws_strokes_long(w)) tasks[count++] = w->document.strokes.task;
    return count;
}

void isosculpt_window_show_progress(window *w) {
    isosculpt_task *tasks[ISOSCULPT_PROGRESS_ITEMS];
    int at = 0;
    const int before = w->screen.progress_item_count, count = list_tasks(w, tasks);
    w->screen.progress_item_count = 0;
    if (w->load_job)
        add_progress_item(w,
                          w->sculpting                               ? "Making a field of"
                          : w->resampling                            ? "Resampling"
                          : isosculpt_load_job_is_stamp(w->load_job) ? "Stamp:"
                                                                     : "Opening",
                          isosculpt_load_job_path(w->load_job), tasks[at++]);
    if (w->document.saver) add_progress_item(w, "Saving", w->document.saved_as, tasks[at++]);
    if (at < count) add_progress_item(w, "Drawing", "strokes again", tasks[at]);
    if (count || before) w->frames_left = w->frames_left > 0 ? w->frames_left : 1;
}

static void cancel_tasks(window *w, unsigned results) {
    isosculpt_task *tasks[ISOSCULPT_PROGRESS_ITEMS];
    const int count = list_tasks(w, tasks);
    for (int i = 0; i < count; i++)
        if (results & (unsigned)ISOSCULPT_RESULT_CANCEL << i) isosculpt_task_cancel(tasks[i]);
}

/* ---- dialogs */

/* Continues with what the user confirmed despite unsaved changes, or with what was waiting for a save. */
static void proceed(window *w, isosculpt_dialog dialog) {
    if (dialog == ISOSCULPT_DIALOG_CLOSE) glfwSetWindowShouldClose(w->glfw, GLFW_TRUE);
    if (dialog == ISOSCULPT_DIALOG_OPEN) isosculpt_window_confirm_open(w);
}

void isosculpt_window_handle_dialog_result(window *w, unsigned results) {
    const isosculpt_dialog dialog = w->screen.dialog;
    char path[ISOSCULPT_PATH];
    if (results & ISOSCULPT_RESULT_RECOVER && isosculpt_window_is_opening(w)) return; /* the dialog stays */
    if (results & ISOSCULPT_RESULT_NEW && !isosculpt_window_can_begin(w)) return;
    memcpy(path, w->screen.dialog_path, sizeof path);
    w->screen.dialog = ISOSCULPT_DIALOG_NOTHING;
    if (results & ISOSCULPT_RESULT_RECOVER) isosculpt_window_recover(w, path);
    if (results & ISOSCULPT_RESULT_DISMISS) isosculpt_document_dismiss_recovery(path);
    if (results & ISOSCULPT_RESULT_OPEN) isosculpt_window_open_file(w, path, false);
    if (results & ISOSCULPT_RESULT_STAMP) isosculpt_window_open_file(w, path, true);
    if (results & ISOSCULPT_RESULT_NEW) isosculpt_window_begin(w);
    if (dialog == ISOSCULPT_DIALOG_REPLACE) {
        isosculpt_window_answer_replace(w, results & ISOSCULPT_RESULT_REPLACE);
    } else if (results & ISOSCULPT_RESULT_SAVE) {
        w->after_save = dialog;
        isosculpt_window_request_save(w, ISOSCULPT_BROWSE_SAVE, NULL);
    } else if (results & ISOSCULPT_RESULT_PROCEED)
        proceed(w, dialog);
    else if (results & ISOSCULPT_RESULT_KEEP && dialog == ISOSCULPT_DIALOG_OPEN)
        isosculpt_window_reject_open(w);
}

/* ---- the panel */

/* Opens the path in the input box; a folder is opened in the browser. */
static void open_typed_path(window *w) {
    char path[ISOSCULPT_PATH];
    if (isosculpt_browser_is_folder(w->screen.typed_path)) {
        w->screen.browse_request = ISOSCULPT_BROWSE_OPEN;
        return;
    }
    memcpy(path, w->screen.typed_path, sizeof path);
    w->screen.typed_path[0] = 0;
    isosculpt_window_open_file(w, path, false);
}

/* Passes the isovalue of the panel on to the viewport. */
static void apply_isovalue(window *w) {
    if (!w->volume) return;
    const bool released = w->viewport.sliding && !w->screen.isovalue_dragged;
    w->viewport.sliding = w->screen.isovalue_dragged;
    if (w->screen.isovalue != w->viewport.isovalue) {
        isosculpt_viewport_set_isovalue(&w->viewport, w->screen.isovalue);
        w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
    } else if (released)
        w->last_change = iso_clock_seconds(); /* the exact picture is drawn after a pause */
}

/* Colours the surfaces by a volume, or by their distance from what is in a file, which is read. */
static void color_by(window *w, const char *path, bool distance) {
    iso_error reason = {0};
    char value[ISOSCULPT_COLOR_TEXT];
    snprintf(value, sizeof value, "%s%s", distance ? "distance:" : "", path);
    if (isosculpt_style_set(&w->viewport, "surface-color-by", value, &reason) != ISO_OK)
        isosculpt_window_set_status(w, true, reason.text);
    w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
}

/* Uses the file chosen in the browser for the purpose for which the browser was opened. */
static void use_chosen_path(window *w) {
    const isosculpt_purpose purpose = w->screen.chosen_purpose;
    const char *path = w->screen.chosen_path;
    if (purpose == ISOSCULPT_BROWSE_PICTURE)
        isosculpt_window_request_screenshot(w, path);
    else if (isosculpt_browser_saves(purpose))
        isosculpt_window_request_save(w, purpose, path);
    else if (purpose == ISOSCULPT_BROWSE_COLORS || purpose == ISOSCULPT_BROWSE_DISTANCES)
        color_by(w, path, purpose == ISOSCULPT_BROWSE_DISTANCES);
    else
        isosculpt_window_open_file(w, path, purpose == ISOSCULPT_BROWSE_STAMP);
}

/* ---- the input controller */

static void process_controller_commands(window *w) {
    const unsigned commands = w->controller.commands;
    if (commands & ISOSCULPT_COMMAND_SAVE) isosculpt_window_request_save(w, ISOSCULPT_BROWSE_SAVE, NULL);
    if (commands & ISOSCULPT_COMMAND_SAVE_AS) w->screen.browse_request = ISOSCULPT_BROWSE_SAVE;
    if (commands & ISOSCULPT_COMMAND_OPEN) w->screen.browse_request = ISOSCULPT_BROWSE_OPEN;
    if (commands & ISOSCULPT_COMMAND_NEW) isosculpt_window_show_dialog(w, ISOSCULPT_DIALOG_NEW, "");
    if (commands & ISOSCULPT_COMMAND_SCULPT) isosculpt_window_start_sculpting(w);
    w->controller.commands &= ISOSCULPT_COMMAND_REDRAW | ISOSCULPT_COMMAND_CLOSE;
}

/* Shows the error of the last edit, or that its brush was clipped, which the next edit takes away again. */
static void show_edit_message(window *w) {
    static const char clipped[] = "The brush reached beyond the grid: what lies outside is lost.";
    isosculpt_controller *controller = &w->controller;
    if (controller->error.text[0])
        isosculpt_window_set_status(w, true, controller->error.text);
    else if (controller->emptied)
        isosculpt_window_set_status(w, true, "Nothing is left of the object. Ctrl+Z brings it back.");
    else if (controller->clipped)
        isosculpt_window_set_status(w, true, clipped);
    else if (controller->edited && strcmp(w->screen.message, clipped) == 0)
        isosculpt_window_set_status(w, false, "");
    if (w->document.strokes.found_none)
        isosculpt_window_set_status(w, false, "No stroke made the surface there: the session began with it.");
    w->document.strokes.found_none = false;
    controller->error.text[0] = 0;
    controller->clipped = controller->edited = controller->emptied = false;
}

/* Before a viewed volume is saved, it is converted into a field. If that fails or is cancelled, nothing is
 * saved. */
static void sculpt_before_saving(window *w) {
    if (!w->pending_save || !w->volume) {
        w->sculpting_to_save = false;
    } else if (w->sculpting_to_save && !w->sculpting) {
        w->sculpting_to_save = false;
        w->pending_save = ISOSCULPT_BROWSE_NOTHING;
    } else if (!w->sculpting) {
        isosculpt_window_start_sculpting(w);
        w->sculpting_to_save = true;
    }
}

iso_status isosculpt_window_process_commands(window *w, iso_error *error) {
    proceed(w, isosculpt_window_poll_save(w));
    const unsigned results = w->screen.results;
    w->screen.results = 0;
    cancel_tasks(w, results);
    if (w->screen.dialog && results & ~(7u * ISOSCULPT_RESULT_CANCEL))
        isosculpt_window_handle_dialog_result(w, results);
    else if (results & ISOSCULPT_RESULT_OPEN)
        open_typed_path(w);
    if (results & ISOSCULPT_RESULT_RESAMPLE) isosculpt_window_resample(w);
    if (results & ISOSCULPT_RESULT_CHOSEN) use_chosen_path(w);
    if (results & ISOSCULPT_RESULT_COMMAND) isosculpt_window_copy_command(w);
    process_controller_commands(w);
    isosculpt_controller_update_strokes(&w->controller, isosculpt_window_wake);
    sculpt_before_saving(w);
    isosculpt_window_start_save(w);
    apply_isovalue(w);
    show_edit_message(w);
    isosculpt_window_load_first_stamp(w);
    isosculpt_window_update_reference(w);
    return isosculpt_window_finish_opening(w, error);
}
