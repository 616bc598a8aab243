/* Saving in isosculpt's window: where to, what may be written over, and what follows. */
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/render_command.h"
#include "apps/isosculpt/window/window.h"
#include "base/text.h"

bool isosculpt_window_has_unsaved_changes(const window *w) {
    return w->document.changes != w->document.saved;
}

static void wake(void) {
    glfwPostEmptyEvent();
}

/* ---- a save */

/* What was to follow a save does not. */
static void give_up(window *w) {
    w->saving = ISOSCULPT_BROWSE_NOTHING;
    w->leaving = ISOSCULPT_DIALOG_NOTHING;
}

static void refuse(window *w, const char *reason) {
    char text[sizeof w->screen.message];
    snprintf(text, sizeof text, "Not saved: %.550s", reason);
    give_up(w);
    isosculpt_window_set_status(w, true, text);
}

void isosculpt_window_save(window *w, isosculpt_purpose purpose, const char *path) {
    if (w->volume) {
        refuse(w, "there is nothing to save before it is sculpted.");
        return;
    }
    w->saving = purpose;
    w->replace = false;
    snprintf(w->save_path, sizeof w->save_path, "%s", path ? path : w->document.target);
}

static void start(window *w) {
    iso_error reason = {0};
    const isosculpt_save_opts opts = {
        .path = w->save_path, .is_export = w->saving == ISOSCULPT_BROWSE_EXPORT, .wake = wake};
    if (isosculpt_document_save(&w->document, &opts, &reason) == ISO_OK)
        w->saving = ISOSCULPT_BROWSE_NOTHING;
    else
        refuse(w, reason.text);
}

void isosculpt_window_go_on_saving(window *w) {
    iso_error reason = {0};
    bool replaces;
    if (!w->saving || w->controller.drag == ISOSCULPT_DRAG_BRUSH || w->document.saver || w->screen.dialog)
        return;
    if (isosculpt_document_check_target(&w->document, w->save_path, &replaces, &reason) != ISO_OK)
        refuse(w, reason.text);
    else if (replaces && !w->replace)
        isosculpt_window_ask(w, ISOSCULPT_DIALOG_REPLACE, w->save_path);
    else
        start(w);
}

/* The file that was asked about is a picture's, or the one that is to be saved. */
void isosculpt_window_replace(window *w, bool agreed) {
    if (w->saving) {
        w->replace = agreed;
        if (!agreed) give_up(w);
    } else if (agreed)
        w->screenshot = true;
    else
        w->shot_path[0] = 0;
}

static void tell_saved(window *w, iso_status status, bool cancelled, const char *reason) {
    char text[sizeof w->screen.message];
    snprintf(text, sizeof text, "%s%.550s", status == ISO_OK ? "Saved " : "Not saved: ",
             status == ISO_OK ? w->document.saved_as
             : cancelled      ? "cancelled"
                              : reason);
    isosculpt_window_set_status(w, status != ISO_OK && !cancelled, text);
}

void isosculpt_window_poll_save(window *w) {
    iso_error reason = {0};
    iso_status status = ISO_OK;
    isosculpt_task *task = isosculpt_document_save_task(&w->document);
    const bool cancelled = task && isosculpt_task_cancelled(task);
    if (isosculpt_document_saving(&w->document, false, &status, &reason) != ISOSCULPT_SAVE_DONE) return;
    tell_saved(w, status, cancelled, reason.text);
    const isosculpt_dialog leaving = w->leaving;
    w->leaving = ISOSCULPT_DIALOG_NOTHING;
    if (status == ISO_OK && leaving && isosculpt_window_has_unsaved_changes(w))
        isosculpt_window_ask(w, leaving, w->next); /* about what was done meanwhile */
    else if (status == ISO_OK)
        isosculpt_window_leave(w, leaving);
}

/* ---- what the browser chose */

/* A picture under a name. */
static void shoot_to(window *w, const char *path) {
    struct stat about;
    if (!iso_text_has_extension(path, ".png")) {
        isosculpt_window_set_status(w, true, "No picture: the name must end in .png");
        return;
    }
    snprintf(w->shot_path, sizeof w->shot_path, "%s", path);
    if (stat(path, &about) == 0)
        isosculpt_window_ask(w, ISOSCULPT_DIALOG_REPLACE, path);
    else
        w->screenshot = true;
}

void isosculpt_window_take_choice(window *w) {
    const isosculpt_purpose purpose = w->screen.chosen_for;
    const char *path = w->screen.chosen;
    if (purpose == ISOSCULPT_BROWSE_PICTURE)
        shoot_to(w, path);
    else if (isosculpt_browser_saves(purpose))
        isosculpt_window_save(w, purpose, path);
    else
        isosculpt_window_open_file(w, path, purpose == ISOSCULPT_BROWSE_STAMP);
}

/* ---- the command */

/* The file that holds what is shown and how it is read; false: there is none. */
static bool find_shown(const window *w, isosculpt_render_command *command) {
    const isosculpt_document *document = &w->document;
    const bool saved = document->target_is_own && !isosculpt_window_has_unsaved_changes(w);
    command->reading = "";
    if (w->volume) {
        command->path = w->volume->path;
        command->reading = w->volume->reading;
    } else if (saved && iso_text_has_extension(document->target, ".vdb")) {
        command->path = document->target;
    } else if (document->changes == 0 && !(w->settings->voxel_size > 0) &&
               iso_text_has_extension(document->start.source, ".vdb")) {
        command->path = document->start.source; /* as it was opened */
        command->reading = document->start.reading;
    }
    return command->path;
}

void isosculpt_window_copy_command(window *w) {
    char text[8 * ISOSCULPT_PATH];
    isosculpt_render_command command = {
        .view = &w->view, .width = w->screen.width, .height = w->screen.height};
    if (!find_shown(w, &command))
        isosculpt_window_set_status(
            w, true, "No command: isorender reads files. Save the sculpture as .vdb, then copy.");
    else if (!isosculpt_render_command_text(&command, text, sizeof text))
        isosculpt_window_set_status(w, true, "No command: the file's name is too long.");
    else {
        glfwSetClipboardString(w->glfw, text);
        isosculpt_window_set_status(w, false,
                                    w->view.mode.paint.light == ISOSCULPT_SHADING_LAMPS
                                        ? "The isorender command is on the clipboard."
                                        : "The isorender command is on the clipboard; it draws with lamps.");
    }
}
