/* Saving in isosculpt's window: which file, whether it may be overwritten, and what follows a save. */
#include "apps/isosculpt/window/saving.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/render_command.h"
#include "apps/isosculpt/save.h"
#include "base/file_types.h"

/* ---- a save */

/* Drops the requested save, and the action that was waiting for it. */
static void drop_save(window *w) {
    w->pending_save = ISOSCULPT_BROWSE_NOTHING;
    w->after_save = ISOSCULPT_DIALOG_NOTHING;
}

static void refuse_save(window *w, const char *reason) {
    char text[sizeof w->screen.message];
    snprintf(text, sizeof text, "Not saved: %.550s", reason);
    drop_save(w);
    isosculpt_window_set_status(w, true, text);
}

void isosculpt_window_request_save(window *w, isosculpt_purpose purpose, const char *path) {
    w->pending_save = purpose;
    w->replace_agreed = false;
    snprintf(w->save_path, sizeof w->save_path, "%s", path ? path : w->document.target);
}

static void start_now(window *w) {
    iso_error reason = {0};
    const isosculpt_save_opts opts = {.path = w->save_path,
                                      .is_export = w->pending_save == ISOSCULPT_BROWSE_EXPORT,
                                      .color = w->viewport.mode.material.color,
                                      .closed = w->settings->closed != 0,
                                      .wake = isosculpt_window_wake};
    if (isosculpt_document_save(&w->document, &opts, &reason) == ISO_OK)
        w->pending_save = ISOSCULPT_BROWSE_NOTHING;
    else
        refuse_save(w, reason.text);
}

void isosculpt_window_start_save(window *w) {
    iso_error reason = {0};
    bool replaces;
    if (!w->pending_save || w->volume || w->controller.drag == ISOSCULPT_DRAG_BRUSH || w->document.saver ||
        isosculpt_stroke_editor_is_busy(&w->document.strokes) || w->controller.queued_strokes.count ||
        w->screen.dialog)
        return;
    if (isosculpt_document_check_target(&w->document, w->save_path, &replaces, &reason) != ISO_OK)
        refuse_save(w, reason.text);
    else if (replaces && !w->replace_agreed)
        isosculpt_window_show_dialog(w, ISOSCULPT_DIALOG_REPLACE, w->save_path);
    else
        start_now(w);
}

/* Handles the user's answer. If no save was requested, the dialog is about a screenshot. */
void isosculpt_window_answer_replace(window *w, bool agreed) {
    if (w->pending_save) {
        w->replace_agreed = agreed;
        if (!agreed) drop_save(w);
    } else if (agreed)
        w->screenshot = true;
    else
        w->screenshot_path[0] = 0;
}

static void show_save_result(window *w, iso_status status, bool cancelled, const char *reason) {
    const bool empty = status == ISO_OK && w->document.saved_nothing;
    char text[sizeof w->screen.message], note[160] = "";
    if (status == ISO_OK && w->document.saved_open_edges) {
        memcpy(note, ": ", 3);
        isosculpt_mesh_open_note(w->document.saved_open_edges, note + 2, sizeof note - 2);
    } else if (empty)
        snprintf(note, sizeof note, ": nothing is left of the solid (Ctrl+Z undoes)");
    snprintf(text, sizeof text, "%s%.400s%s", status == ISO_OK ? "Saved " : "Not saved: ",
             status == ISO_OK ? w->document.saved_as
             : cancelled      ? "cancelled"
                              : reason,
             note);
    isosculpt_window_set_status(w, (status != ISO_OK && !cancelled) || empty, text);
}

isosculpt_dialog isosculpt_window_poll_save(window *w) {
    iso_error reason = {0};
    iso_status status = ISO_OK;
    isosculpt_task *task = isosculpt_document_save_task(&w->document);
    const bool cancelled = task && isosculpt_task_cancelled(task);
    if (isosculpt_document_poll_save(&w->document, false, &status, &reason) != ISOSCULPT_SAVE_DONE)
        return ISOSCULPT_DIALOG_NOTHING;
    show_save_result(w, status, cancelled, reason.text);
    const isosculpt_dialog next = w->after_save;
    w->after_save = ISOSCULPT_DIALOG_NOTHING;
    if (status != ISO_OK || !next) return ISOSCULPT_DIALOG_NOTHING;
    if (!isosculpt_window_has_unsaved_changes(w)) return next;
    isosculpt_window_show_dialog(w, next,
                                 w->next_path); /* the dialog is about changes made in the meantime */
    return ISOSCULPT_DIALOG_NOTHING;
}

/* ---- screenshots */

void isosculpt_window_request_screenshot(window *w, const char *path) {
    struct stat about;
    if (!isosculpt_is_scene(path)) {
        isosculpt_window_set_status(w, true, "No picture: the name must end in .png (or .json: a scene)");
        return;
    }
    snprintf(w->screenshot_path, sizeof w->screenshot_path, "%s", path);
    if (stat(path, &about) == 0)
        isosculpt_window_show_dialog(w, ISOSCULPT_DIALOG_REPLACE, path);
    else
        w->screenshot = true;
}

/* ---- the isorender command */

static bool is_level_set(const char *path) {
    return iso_file_type_of_name(path, ISO_WRITES_VOLUME) != ISO_FILE_UNKNOWN;
}

/* Finds a file with the contents of the picture, and the options to read it with; returns false if there is
 * none. */
static bool find_shown_file(const window *w, isosculpt_render_command *command) {
    const isosculpt_document *document = &w->document;
    const bool saved = document->target_is_own && !isosculpt_window_has_unsaved_changes(w);
    command->reading = "";
    if (w->volume) {
        command->path = w->volume->path;
        command->reading = w->volume->reading;
    } else if (saved && is_level_set(document->target)) {
        command->path = document->target;
    } else if (document->change_count == 0 && !(w->settings->voxel_size > 0) &&
               is_level_set(document->start.source)) {
        command->path = document->start.source; /* the path with which it was opened */
        command->reading = document->start.reading;
    }
    return command->path;
}

bool isosculpt_window_render_command(const window *w, isosculpt_render_command *command) {
    *command = (isosculpt_render_command){
        .viewport = &w->viewport, .width = w->screen.picture_width, .height = w->screen.height};
    return find_shown_file(w, command);
}

void isosculpt_window_copy_command(window *w) {
    char text[8 * ISOSCULPT_PATH];
    isosculpt_render_command command;
    if (!isosculpt_window_render_command(w, &command))
        isosculpt_window_set_status(
            w, true, "No command: isorender reads files. Save the sculpture as .vdb, then copy.");
    else if (!isosculpt_render_command_text(&command, text, sizeof text))
        isosculpt_window_set_status(w, true, "No command: the file's name is too long.");
    else {
        glfwSetClipboardString(w->glfw, text);
        isosculpt_window_set_status(
            w, false,
            isosculpt_viewport_shows_reference(&w->viewport)
                ? "The isorender command is on the clipboard; it draws no x-ray of the beginning."
            : w->viewport.mode.material.shading == ISOSCULPT_SHADING_LAMPS
                ? "The isorender command is on the clipboard."
                : "The isorender command is on the clipboard; it draws with lamps.");
    }
}
