/* What isosculpt's window works on, and its files: opening, saving, stamps. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/window.h"
#include "base/clock.h"

/* ---- the sculpture on the desk */

static void show_title(window *w) {
    char title[ISOSCULPT_PATH + 32];
    const char *path = w->volume ? w->volume->path : w->document.journal, *slash = strrchr(path, '/'),
               *name = slash ? slash + 1 : path;
    snprintf(title, sizeof title, "isosculpt%s%s", name[0] ? ": " : "", name);
    glfwSetWindowTitle(w->glfw, title);
}

/* The hand and the engine for what is on the desk and in the view. The brush stays as it is, in voxels. */
static void take_up(window *w) {
    iso_brush brush = w->controller.brush;
    const double before = w->voxel, voxel = w->document.start.voxel_size;
    w->view.gl = w->gl;
    w->view.mode.engine = w->engine;
    isosculpt_controller_free(&w->controller);
    isosculpt_controller_init(&w->controller, &w->document, &w->view);
    isosculpt_window_sync_pointer(w);
    if (before > 0) {
        const iso_vec3 middle =
            w->controller.brush.mirror; /* another object: no mirror, until it is asked for */
        w->controller.brush = brush;
        w->controller.brush.mirror = middle;
        w->controller.brush.symmetry = 0;
        w->controller.brush.radius = brush.radius / before * voxel;
    }
    w->voxel = voxel;
    w->controller.viewing_volume = w->screen.volume != NULL;
    show_title(w);
    w->controller.commands = ISOSCULPT_COMMAND_PICTURE;
    w->frames = ISOSCULPT_FRAMES;
}

static iso_status show_desk(window *w, iso_error *error) {
    ISO_TRY(isosculpt_view_init(&w->view, iso_session_grid(w->document.session), w->pool, error));
    take_up(w);
    return ISO_OK;
}

/* A new ball, with a journal if that can be. */
static iso_status show_ball(window *w, iso_error *error) {
    ISO_TRY(isosculpt_document_new(&w->document, w->has_folder ? w->folder : NULL, NULL, error));
    return show_desk(w, error);
}

static void wake(void) {
    glfwPostEmptyEvent();
}

/* The volume that is looked at as a field at the isovalue that was chosen. */
static iso_status start_sculpting(window *w, iso_error *error) {
    const isosculpt_request request = {.path = w->volume->path,
                                       .sculpt = w->volume,
                                       .folder = w->has_folder ? w->folder : NULL,
                                       .isovalue = w->view.isovalue,
                                       .voxel = w->settings->voxel_size,
                                       .threads = w->settings->common.threads,
                                       .undo_memory = (size_t)w->settings->undo_memory,
                                       .wake = wake};
    return isosculpt_load_job_start(&request, &w->load_job, error);
}

/* The path from the root, so that it means the same to whoever reads it on the screen or in a command. */
static void make_whole(const char *path, char whole[2 * ISOSCULPT_PATH]) {
    char folder[ISOSCULPT_PATH];
    if (path[0] == '/' || !getcwd(folder, sizeof folder))
        snprintf(whole, 2 * ISOSCULPT_PATH, "%s", path);
    else
        snprintf(whole, 2 * ISOSCULPT_PATH, "%s/%s", folder, path);
}

/* Beside what is there, until it is whole. */
static iso_status start_opening(window *w, const char *path, bool stamp, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    const bool asked = path == settings->open;
    char whole[2 * ISOSCULPT_PATH];
    make_whole(path, whole);
    const isosculpt_request request = {.path = whole,
                                       .stamp = stamp,
                                       .folder = w->has_folder ? w->folder : NULL,
                                       .isovalue = asked ? settings->isovalue : NAN,
                                       .voxel = asked ? settings->voxel_size : 0,
                                       .close_holes = settings->close_holes,
                                       .input = asked ? settings->common.input : (iso_input){0},
                                       .threads = settings->common.threads,
                                       .undo_memory = (size_t)settings->undo_memory,
                                       .wake = wake};
    w->agreed = w->document.changes;
    return isosculpt_load_job_start(&request, &w->load_job, error);
}

/* Until it is there the window shows nothing. */
static iso_status open_alone(window *w, const char *path, iso_error *error) {
    ISO_TRY(isosculpt_document_init_empty(&w->document, error));
    ISO_TRY(show_desk(w, error));
    w->screen.blank = true;
    return start_opening(w, path, false, error);
}

iso_status isosculpt_window_open(window *w, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    iso_error reason = {0};
    w->has_folder = isosculpt_document_state_folder(w->folder, &reason) == ISO_OK;
    if (settings->strokes) return open_alone(w, settings->strokes, error);
    const bool unclosed = w->has_folder && isosculpt_document_find_unclosed(w->folder, w->screen.asked);
    if (settings->recover && unclosed) return open_alone(w, w->screen.asked, error);
    if (unclosed) w->screen.dialog = ISOSCULPT_DIALOG_RECOVER;
    if (settings->recover)
        isosculpt_window_set_status(w, false, "There is nothing to recover: no session was left unclosed.");
    if (settings->open) return open_alone(w, settings->open, error);
    ISO_TRY(show_ball(w, error));
    if (reason.text[0]) snprintf(w->document.trouble, sizeof w->document.trouble, "%s", reason.text);
    return ISO_OK;
}

/* A volume has become a field: the mirror is where it was, and what was drawn meanwhile is done. */
static void take_up_strokes(window *w, const iso_brush *brush, isosculpt_strokes *waiting) {
    w->controller.brush.symmetry = brush->symmetry;
    w->controller.brush.mirror = brush->mirror;
    isosculpt_controller_play(&w->controller, waiting);
}

/* In place of what is on the desk, whose journal has all of it. What a volume becomes is seen from where the
 * volume was. */
static iso_status replace_desk(window *w, isosculpt_loaded *loaded, iso_error *error) {
    const isosculpt_display_mode mode = w->view.mode;
    const iso_camera camera = w->view.camera;
    const bool same_place = w->volume && !loaded->volume && w->sculpting;
    const iso_brush brush = w->controller.brush;
    isosculpt_strokes waiting = w->controller.waiting;
    w->controller.waiting = (isosculpt_strokes){0};
    isosculpt_view_free(&w->view);
    isosculpt_document_close(&w->document);
    isosculpt_volume_free(w->volume);
    iso_pool_destroy(w->own_pool);
    w->pool = w->own_pool = loaded->pool;
    w->document = loaded->document;
    w->view = loaded->view;
    w->screen.volume = w->volume = loaded->volume;
    w->screen.isovalue = w->view.isovalue;
    w->screen.blank = false;
    w->view.mode = mode;
    if (same_place) w->view.camera = camera;
    if (w->volume) {
        w->document.pool = w->pool;
        ISO_TRY(isosculpt_document_init_empty(&w->document, error));
        w->document.start.voxel_size = iso_grid_transform(&w->view.grid)->spacing[0];
        isosculpt_target_default(w->volume->path, w->document.target); /* what it would be saved to */
    }
    take_up(w);
    if (same_place)
        take_up_strokes(w, &brush, &waiting);
    else
        isosculpt_strokes_free(&waiting);
    return ISO_OK;
}

/* What could not be opened leaves what was there; at the start that was nothing. */
static iso_status without(window *w, bool cancelled, iso_status status, iso_error *error) {
    const bool first = w->screen.blank;
    if (first && !cancelled) return status;
    isosculpt_window_set_status(w, !cancelled, cancelled ? "Cancelled." : error->text);
    if (!first) return ISO_OK;
    w->screen.blank = false;
    isosculpt_view_free(&w->view);
    isosculpt_document_close(&w->document);
    return show_ball(w, error);
}

void isosculpt_window_ask(window *w, isosculpt_dialog dialog, const char *path) {
    snprintf(w->screen.asked, sizeof w->screen.asked, "%s", path);
    w->screen.dialog = dialog;
    w->frames = ISOSCULPT_FRAMES;
}

/* Strokes that were made while it was opened would be out of sight with the rest: nobody was asked about
 * them. */
static bool must_ask_again(const window *w) {
    const isosculpt_task *task = isosculpt_load_job_task(w->load_job);
    return isosculpt_window_has_unsaved_changes(w) && w->document.changes != w->agreed &&
           !isosculpt_task_cancelled(task) && !isosculpt_task_failed(task) &&
           !isosculpt_load_job_is_stamp(w->load_job);
}

/* The volume stays one, or is a field now. */
static void not_sculpting(window *w) {
    w->sculpting = w->screen.sculpting = w->controller.awaiting = false;
    isosculpt_strokes_free(&w->controller.waiting);
}

static iso_status finish_opening(window *w, iso_error *error) {
    isosculpt_loaded loaded;
    if (!w->load_job || !isosculpt_task_done(isosculpt_load_job_task(w->load_job))) return ISO_OK;
    const isosculpt_dialog dialog = w->screen.dialog;
    if (w->controller.drag || w->document.saver || (dialog && dialog != ISOSCULPT_DIALOG_RECOVER))
        return ISO_OK; /* first things first */
    if (must_ask_again(w)) {
        snprintf(w->next, sizeof w->next, "%s", isosculpt_load_job_path(w->load_job));
        isosculpt_window_ask(w, ISOSCULPT_DIALOG_OPEN, w->next);
        return ISO_OK;
    }
    const bool cancelled = isosculpt_task_cancelled(isosculpt_load_job_task(w->load_job));
    iso_status status = isosculpt_load_job_finish(w->load_job, &loaded, error);
    w->load_job = NULL;
    if (status != ISO_OK) {
        not_sculpting(w);
        return without(w, cancelled, status, error);
    }
    char note[240];
    const bool noted = iso_mesh_report_note(&loaded.report, note, sizeof note);
    if (loaded.stamp)
        isosculpt_controller_set_stamp(&w->controller, loaded.stamp);
    else
        status = replace_desk(w, &loaded, error);
    if (status == ISO_OK && noted) isosculpt_window_set_status(w, false, note);
    not_sculpting(w);
    w->frames = ISOSCULPT_FRAMES;
    return status;
}

static bool is_opening(window *w) {
    if (w->load_job)
        isosculpt_window_set_status(w, true, "Another file is being opened: wait for it, or cancel it.");
    return w->load_job;
}

static void open_path(window *w, const char *path, bool stamp) {
    iso_error reason = {0};
    if (is_opening(w)) return;
    if (stamp && w->volume)
        isosculpt_window_set_status(w, true, "A stamp needs something to work on: sculpt this first.");
    else if (start_opening(w, path, stamp, &reason) != ISO_OK)
        isosculpt_window_set_status(w, true, reason.text);
    else
        w->screen.message[0] = 0; /* of what was tried before */
}

/* In place of what is there, which may have changes that are not saved. */
static void ask_to_open(window *w, const char *path) {
    if (is_opening(w)) return;
    snprintf(w->next, sizeof w->next, "%s", path);
    if (isosculpt_window_has_unsaved_changes(w))
        isosculpt_window_ask(w, ISOSCULPT_DIALOG_OPEN, w->next);
    else
        open_path(w, w->next, false);
}

void isosculpt_window_open_file(window *w, const char *path, bool stamp) {
    if (stamp)
        open_path(w, path, true);
    else
        ask_to_open(w, path);
}

void isosculpt_window_leave(window *w, isosculpt_dialog dialog) {
    if (dialog == ISOSCULPT_DIALOG_CLOSE) glfwSetWindowShouldClose(w->glfw, GLFW_TRUE);
    if (dialog == ISOSCULPT_DIALOG_OPEN && w->load_job)
        w->agreed = w->document.changes; /* it is ready */
    else if (dialog == ISOSCULPT_DIALOG_OPEN)
        open_path(w, w->next, false);
}

/* What is ready to be opened is let go. */
static void stay(window *w, isosculpt_dialog dialog) {
    if (dialog == ISOSCULPT_DIALOG_OPEN && w->load_job)
        isosculpt_task_cancel(isosculpt_load_job_task(w->load_job));
}

/* A mesh can be two things, unless there is nothing that a stamp could work on. */
void isosculpt_window_drop(window *w, const char *path) {
    if (is_opening(w)) return;
    if (isosculpt_is_mesh(path) && !w->volume && !w->screen.blank)
        isosculpt_window_ask(w, ISOSCULPT_DIALOG_MESH, path);
    else
        ask_to_open(w, path);
}

/* What the panel says of the isovalue. */
static void slide(window *w) {
    if (!w->volume) return;
    const bool rested = w->view.sliding && !w->screen.sliding;
    w->view.sliding = w->screen.sliding;
    if (w->screen.isovalue != w->view.isovalue) {
        isosculpt_view_set_isovalue(&w->view, w->screen.isovalue);
        w->controller.commands |= ISOSCULPT_COMMAND_PICTURE;
    } else if (rested)
        w->changed = iso_clock_seconds(); /* the exact picture is due */
}

static void sculpt(window *w) {
    iso_error reason = {0};
    if (!w->volume || w->sculpting || is_opening(w)) return;
    w->sculpting = start_sculpting(w, &reason) == ISO_OK;
    w->screen.sculpting = w->controller.awaiting = w->sculpting;
    if (!w->sculpting)
        isosculpt_window_set_status(w, true, reason.text);
    else
        isosculpt_controller_center_mirror(&w->controller);
}

/* --stamp, once there is a session that can hold it. */
static void ask_for_stamp(window *w) {
    if (w->stamp_asked || w->screen.blank || w->volume || w->load_job || !w->settings->stamp) return;
    w->stamp_asked = true;
    open_path(w, w->settings->stamp, true);
}

/* ---- heavy work */

static void add_busy(window *w, const char *verb, const char *path, const isosculpt_task *task) {
    isosculpt_progress_item *progress_items = &w->screen.progress_items[w->screen.progress_item_count++];
    const char *slash = strrchr(path, '/');
    snprintf(progress_items->text, sizeof progress_items->text, "%s %.120s", verb, slash ? slash + 1 : path);
    progress_items->fraction = isosculpt_task_fraction(task);
}

static int running(const window *w, isosculpt_task *tasks[ISOSCULPT_PROGRESS_ITEMS]) {
    int count = 0;
    if (w->load_job) tasks[count++] = isosculpt_load_job_task(w->load_job);
    if (w->document.saver) tasks[count++] = isosculpt_document_save_task(&w->document);
    return count;
}

void isosculpt_window_show_progress(window *w) {
    isosculpt_task *tasks[ISOSCULPT_PROGRESS_ITEMS];
    const int before = w->screen.progress_item_count, count = running(w, tasks);
    w->screen.progress_item_count = 0;
    if (w->load_job)
        add_busy(w,
                 w->sculpting                               ? "Making a field of"
                 : isosculpt_load_job_is_stamp(w->load_job) ? "Stamp:"
                                                            : "Opening",
                 isosculpt_load_job_path(w->load_job), tasks[0]);
    if (w->document.saver) add_busy(w, "Saving", w->document.saved_as, tasks[count - 1]);
    if (count || before) w->frames = w->frames > 0 ? w->frames : 1;
}

static void cancel(window *w, unsigned results) {
    isosculpt_task *tasks[ISOSCULPT_PROGRESS_ITEMS];
    const int count = running(w, tasks);
    for (int i = 0; i < count; i++)
        if (results & (unsigned)ISOSCULPT_RESULT_CANCEL << i) isosculpt_task_cancel(tasks[i]);
}

/* ---- what is asked for */

void isosculpt_window_handle_dialog_result(window *w, unsigned results) {
    const isosculpt_dialog dialog = w->screen.dialog;
    char path[ISOSCULPT_PATH];
    if (results & ISOSCULPT_RESULT_RECOVER && is_opening(w)) return; /* it is asked on */
    memcpy(path, w->screen.asked, sizeof path);
    w->screen.dialog = ISOSCULPT_DIALOG_NOTHING;
    if (results & ISOSCULPT_RESULT_RECOVER) open_path(w, path, false);
    if (results & ISOSCULPT_RESULT_DISMISS) isosculpt_document_dismiss_recovery(path);
    if (results & ISOSCULPT_RESULT_OPEN) ask_to_open(w, path);
    if (results & ISOSCULPT_RESULT_STAMP) open_path(w, path, true);
    if (dialog == ISOSCULPT_DIALOG_REPLACE) {
        isosculpt_window_replace(w, results & ISOSCULPT_RESULT_REPLACE);
    } else if (results & ISOSCULPT_RESULT_SAVE) {
        w->leaving = dialog;
        isosculpt_window_save(w, ISOSCULPT_BROWSE_SAVE, NULL);
    } else if (results & ISOSCULPT_RESULT_LEAVE)
        isosculpt_window_leave(w, dialog);
    else if (results & ISOSCULPT_RESULT_STAY)
        stay(w, dialog);
}

/* What was typed in. */
static void take_path(window *w) {
    char path[ISOSCULPT_PATH];
    memcpy(path, w->screen.path, sizeof path);
    w->screen.path[0] = 0;
    ask_to_open(w, path);
}

/* What the hand asks for. */
static void take_wishes(window *w) {
    const unsigned commands = w->controller.commands;
    if (commands & ISOSCULPT_COMMAND_SAVE) isosculpt_window_save(w, ISOSCULPT_BROWSE_SAVE, NULL);
    if (commands & ISOSCULPT_COMMAND_SAVE_AS) w->screen.browse = ISOSCULPT_BROWSE_SAVE;
    if (commands & ISOSCULPT_COMMAND_OPEN) w->screen.browse = ISOSCULPT_BROWSE_OPEN;
    if (commands & ISOSCULPT_COMMAND_SCULPT) sculpt(w);
    w->controller.commands &= ISOSCULPT_COMMAND_PICTURE | ISOSCULPT_COMMAND_CLOSE;
}

/* What went wrong under the hand. */
static void tell_troubles(window *w) {
    isosculpt_controller *controller = &w->controller;
    if (controller->error.text[0])
        isosculpt_window_set_status(w, true, controller->error.text);
    else if (controller->clipped)
        isosculpt_window_set_status(w, true, "The brush reached beyond the grid: what lies outside is lost.");
    controller->error.text[0] = 0;
    controller->clipped = false;
}

iso_status isosculpt_window_process_commands(window *w, iso_error *error) {
    const unsigned results = w->screen.results;
    w->screen.results = 0;
    cancel(w, results);
    if (w->screen.dialog && results & ~(3u * ISOSCULPT_RESULT_CANCEL))
        isosculpt_window_handle_dialog_result(w, results);
    else if (results & ISOSCULPT_RESULT_OPEN)
        take_path(w);
    if (results & ISOSCULPT_RESULT_CHOSEN) isosculpt_window_take_choice(w);
    if (results & ISOSCULPT_RESULT_COMMAND) isosculpt_window_copy_command(w);
    take_wishes(w);
    isosculpt_window_go_on_saving(w);
    slide(w);
    tell_troubles(w);
    ask_for_stamp(w);
    return finish_opening(w, error);
}

/* The window closes over it. */
void isosculpt_window_cancel_load(window *w) {
    isosculpt_loaded loaded = {0};
    isosculpt_task_cancel(isosculpt_load_job_task(w->load_job));
    if (isosculpt_load_job_finish(w->load_job, &loaded, NULL) == ISO_OK) isosculpt_loaded_free(&loaded);
}
