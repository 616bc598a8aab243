/* What isosculpt's window works on, and its files: opening, saving, stamps. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/window/window.h"

/* ---- the sculpture on the desk */

static void show_title(window *w) {
    char title[ISOSCULPT_PATH + 32];
    const char *path = w->volume ? w->volume->path : w->desk.journal, *slash = strrchr(path, '/'),
               *name = slash ? slash + 1 : path;
    snprintf(title, sizeof title, "isosculpt%s%s", name[0] ? ": " : "", name);
    glfwSetWindowTitle(w->glfw, title);
}

/* The hand and the engine for what is on the desk and in the view. The brush stays as it is, in voxels. */
static void take_up(window *w) {
    iso_brush brush = w->hand.brush;
    const double before = w->voxel, voxel = w->desk.start.voxel_size;
    w->view.gl = w->gl;
    w->view.look.engine = w->engine;
    isosculpt_hand_free(&w->hand);
    isosculpt_hand_init(&w->hand, &w->desk, &w->view);
    isosculpt_window_point(w);
    if (before > 0) {
        const iso_vec3 middle = w->hand.brush.mirror; /* another object: no mirror, until it is asked for */
        w->hand.brush = brush;
        w->hand.brush.mirror = middle;
        w->hand.brush.symmetry = 0;
        w->hand.brush.radius = brush.radius / before * voxel;
    }
    w->voxel = voxel;
    w->hand.looking = w->screen.volume != NULL;
    show_title(w);
    w->hand.wishes = ISOSCULPT_WISH_PICTURE;
    w->frames = ISOSCULPT_FRAMES;
}

static iso_status show_desk(window *w, iso_error *error) {
    ISO_TRY(isosculpt_view_init(&w->view, iso_session_grid(w->desk.session), w->pool, error));
    take_up(w);
    return ISO_OK;
}

/* A new ball, with a journal if that can be. */
static iso_status show_ball(window *w, iso_error *error) {
    ISO_TRY(isosculpt_desk_new(&w->desk, w->has_folder ? w->folder : NULL, NULL, error));
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
                                       .threads = w->settings->threads,
                                       .undo_memory = (size_t)w->settings->undo_memory,
                                       .wake = wake};
    return isosculpt_opening_start(&request, &w->opening, error);
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
                                       .input = asked ? settings->input : (iso_input){0},
                                       .threads = settings->threads,
                                       .undo_memory = (size_t)settings->undo_memory,
                                       .wake = wake};
    w->agreed = w->desk.changes;
    return isosculpt_opening_start(&request, &w->opening, error);
}

/* Until it is there the window shows nothing. */
static iso_status open_alone(window *w, const char *path, iso_error *error) {
    ISO_TRY(isosculpt_desk_blank(&w->desk, error));
    ISO_TRY(show_desk(w, error));
    w->screen.blank = true;
    return start_opening(w, path, false, error);
}

iso_status isosculpt_window_open(window *w, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    iso_error reason = {0};
    w->has_folder = isosculpt_desk_folder(w->folder, &reason) == ISO_OK;
    if (settings->strokes) return open_alone(w, settings->strokes, error);
    const bool unclosed = w->has_folder && isosculpt_desk_unclosed(w->folder, w->screen.asked);
    if (settings->recover && unclosed) return open_alone(w, w->screen.asked, error);
    if (unclosed) w->screen.question = ISOSCULPT_ASK_RECOVER;
    if (settings->recover)
        isosculpt_window_say(w, false, "There is nothing to recover: no session was left unclosed.");
    if (settings->open) return open_alone(w, settings->open, error);
    ISO_TRY(show_ball(w, error));
    if (reason.text[0]) snprintf(w->desk.trouble, sizeof w->desk.trouble, "%s", reason.text);
    return ISO_OK;
}

/* A volume has become a field: the mirror is where it was, and what was drawn meanwhile is done. */
static void take_up_strokes(window *w, const iso_brush *brush, isosculpt_strokes *waiting) {
    w->hand.brush.symmetry = brush->symmetry;
    w->hand.brush.mirror = brush->mirror;
    isosculpt_hand_play(&w->hand, waiting);
}

/* In place of what is on the desk, whose journal has all of it. What a volume becomes is seen from where the
 * volume was. */
static iso_status replace_desk(window *w, isosculpt_opened *opened, iso_error *error) {
    const isosculpt_look look = w->view.look;
    const iso_camera camera = w->view.camera;
    const bool same_place = w->volume && !opened->volume && w->sculpting;
    const iso_brush brush = w->hand.brush;
    isosculpt_strokes waiting = w->hand.waiting;
    w->hand.waiting = (isosculpt_strokes){0};
    isosculpt_view_free(&w->view);
    isosculpt_desk_close(&w->desk);
    isosculpt_volume_free(w->volume);
    iso_pool_destroy(w->own_pool);
    w->pool = w->own_pool = opened->pool;
    w->desk = opened->desk;
    w->view = opened->view;
    w->screen.volume = w->volume = opened->volume;
    w->screen.isovalue = w->view.isovalue;
    w->screen.blank = false;
    w->view.look = look;
    if (same_place) w->view.camera = camera;
    if (w->volume) {
        w->desk.pool = w->pool;
        ISO_TRY(isosculpt_desk_blank(&w->desk, error));
        w->desk.start.voxel_size = iso_grid_transform(&w->view.grid)->spacing[0];
        isosculpt_target_default(w->volume->path, w->desk.target); /* what it would be saved to */
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
    isosculpt_window_say(w, !cancelled, cancelled ? "Cancelled." : error->text);
    if (!first) return ISO_OK;
    w->screen.blank = false;
    isosculpt_view_free(&w->view);
    isosculpt_desk_close(&w->desk);
    return show_ball(w, error);
}

void isosculpt_window_ask(window *w, isosculpt_question question, const char *path) {
    snprintf(w->screen.asked, sizeof w->screen.asked, "%s", path);
    w->screen.question = question;
    w->frames = ISOSCULPT_FRAMES;
}

/* Strokes that were made while it was opened would be out of sight with the rest: nobody was asked about
 * them. */
static bool must_ask_again(const window *w) {
    const isosculpt_task *task = isosculpt_opening_task(w->opening);
    return isosculpt_window_unsaved(w) && w->desk.changes != w->agreed && !isosculpt_task_cancelled(task) &&
           !isosculpt_task_failed(task) && !isosculpt_opening_is_stamp(w->opening);
}

/* The volume stays one, or is a field now. */
static void not_sculpting(window *w) {
    w->sculpting = w->screen.sculpting = w->hand.awaiting = false;
    isosculpt_strokes_free(&w->hand.waiting);
}

static iso_status finish_opening(window *w, iso_error *error) {
    isosculpt_opened opened;
    if (!w->opening || !isosculpt_task_done(isosculpt_opening_task(w->opening))) return ISO_OK;
    const isosculpt_question question = w->screen.question;
    if (w->hand.drag || w->desk.saver || (question && question != ISOSCULPT_ASK_RECOVER))
        return ISO_OK; /* first things first */
    if (must_ask_again(w)) {
        snprintf(w->next, sizeof w->next, "%s", isosculpt_opening_path(w->opening));
        isosculpt_window_ask(w, ISOSCULPT_ASK_OPEN, w->next);
        return ISO_OK;
    }
    const bool cancelled = isosculpt_task_cancelled(isosculpt_opening_task(w->opening));
    iso_status status = isosculpt_opening_finish(w->opening, &opened, error);
    w->opening = NULL;
    if (status != ISO_OK) {
        not_sculpting(w);
        return without(w, cancelled, status, error);
    }
    char note[240];
    const bool noted = iso_mesh_report_note(&opened.report, note, sizeof note);
    if (opened.stamp)
        isosculpt_hand_stamp(&w->hand, opened.stamp);
    else
        status = replace_desk(w, &opened, error);
    if (status == ISO_OK && noted) isosculpt_window_say(w, false, note);
    not_sculpting(w);
    w->frames = ISOSCULPT_FRAMES;
    return status;
}

static bool is_opening(window *w) {
    if (w->opening) isosculpt_window_say(w, true, "Another file is being opened: wait for it, or cancel it.");
    return w->opening;
}

static void open_path(window *w, const char *path, bool stamp) {
    iso_error reason = {0};
    if (is_opening(w)) return;
    if (stamp && w->volume)
        isosculpt_window_say(w, true, "A stamp needs something to work on: sculpt this first.");
    else if (start_opening(w, path, stamp, &reason) != ISO_OK)
        isosculpt_window_say(w, true, reason.text);
    else
        w->screen.message[0] = 0; /* of what was tried before */
}

/* In place of what is there, which may have changes that are not saved. */
static void ask_to_open(window *w, const char *path) {
    if (is_opening(w)) return;
    snprintf(w->next, sizeof w->next, "%s", path);
    if (isosculpt_window_unsaved(w))
        isosculpt_window_ask(w, ISOSCULPT_ASK_OPEN, w->next);
    else
        open_path(w, w->next, false);
}

void isosculpt_window_open_file(window *w, const char *path, bool stamp) {
    if (stamp)
        open_path(w, path, true);
    else
        ask_to_open(w, path);
}

void isosculpt_window_leave(window *w, isosculpt_question question) {
    if (question == ISOSCULPT_ASK_CLOSE) glfwSetWindowShouldClose(w->glfw, GLFW_TRUE);
    if (question == ISOSCULPT_ASK_OPEN && w->opening)
        w->agreed = w->desk.changes; /* it is ready */
    else if (question == ISOSCULPT_ASK_OPEN)
        open_path(w, w->next, false);
}

/* What is ready to be opened is let go. */
static void stay(window *w, isosculpt_question question) {
    if (question == ISOSCULPT_ASK_OPEN && w->opening)
        isosculpt_task_cancel(isosculpt_opening_task(w->opening));
}

/* A mesh can be two things, unless there is nothing that a stamp could work on. */
void isosculpt_window_drop(window *w, const char *path) {
    if (is_opening(w)) return;
    if (isosculpt_is_mesh(path) && !w->volume && !w->screen.blank)
        isosculpt_window_ask(w, ISOSCULPT_ASK_MESH, path);
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
        w->hand.wishes |= ISOSCULPT_WISH_PICTURE;
    } else if (rested)
        w->changed = isosculpt_now(); /* the exact picture is due */
}

static void sculpt(window *w) {
    iso_error reason = {0};
    if (!w->volume || w->sculpting || is_opening(w)) return;
    w->sculpting = start_sculpting(w, &reason) == ISO_OK;
    w->screen.sculpting = w->hand.awaiting = w->sculpting;
    if (!w->sculpting)
        isosculpt_window_say(w, true, reason.text);
    else
        isosculpt_hand_center_mirror(&w->hand);
}

/* --stamp, once there is a session that can hold it. */
static void ask_for_stamp(window *w) {
    if (w->stamp_asked || w->screen.blank || w->volume || w->opening || !w->settings->stamp) return;
    w->stamp_asked = true;
    open_path(w, w->settings->stamp, true);
}

/* ---- heavy work */

static void add_busy(window *w, const char *verb, const char *path, const isosculpt_task *task) {
    isosculpt_busy *busy = &w->screen.busy[w->screen.busy_count++];
    const char *slash = strrchr(path, '/');
    snprintf(busy->text, sizeof busy->text, "%s %.120s", verb, slash ? slash + 1 : path);
    busy->fraction = isosculpt_task_fraction(task);
}

static int running(const window *w, isosculpt_task *tasks[ISOSCULPT_BUSY]) {
    int count = 0;
    if (w->opening) tasks[count++] = isosculpt_opening_task(w->opening);
    if (w->desk.saver) tasks[count++] = isosculpt_desk_save_task(&w->desk);
    return count;
}

void isosculpt_window_show_busy(window *w) {
    isosculpt_task *tasks[ISOSCULPT_BUSY];
    const int before = w->screen.busy_count, count = running(w, tasks);
    w->screen.busy_count = 0;
    if (w->opening)
        add_busy(w,
                 w->sculpting                             ? "Making a field of"
                 : isosculpt_opening_is_stamp(w->opening) ? "Stamp:"
                                                          : "Opening",
                 isosculpt_opening_path(w->opening), tasks[0]);
    if (w->desk.saver) add_busy(w, "Saving", w->desk.saved_as, tasks[count - 1]);
    if (count || before) w->frames = w->frames > 0 ? w->frames : 1;
}

static void cancel(window *w, unsigned answers) {
    isosculpt_task *tasks[ISOSCULPT_BUSY];
    const int count = running(w, tasks);
    for (int i = 0; i < count; i++)
        if (answers & (unsigned)ISOSCULPT_ANSWER_CANCEL << i) isosculpt_task_cancel(tasks[i]);
}

/* ---- what is asked for */

void isosculpt_window_answer(window *w, unsigned answers) {
    const isosculpt_question question = w->screen.question;
    char path[ISOSCULPT_PATH];
    if (answers & ISOSCULPT_ANSWER_RECOVER && is_opening(w)) return; /* it is asked on */
    memcpy(path, w->screen.asked, sizeof path);
    w->screen.question = ISOSCULPT_ASK_NOTHING;
    if (answers & ISOSCULPT_ANSWER_RECOVER) open_path(w, path, false);
    if (answers & ISOSCULPT_ANSWER_DISMISS) isosculpt_desk_dismiss(path);
    if (answers & ISOSCULPT_ANSWER_OPEN) ask_to_open(w, path);
    if (answers & ISOSCULPT_ANSWER_STAMP) open_path(w, path, true);
    if (question == ISOSCULPT_ASK_REPLACE) {
        isosculpt_window_replace(w, answers & ISOSCULPT_ANSWER_REPLACE);
    } else if (answers & ISOSCULPT_ANSWER_SAVE) {
        w->leaving = question;
        isosculpt_window_save(w, ISOSCULPT_BROWSE_SAVE, NULL);
    } else if (answers & ISOSCULPT_ANSWER_LEAVE)
        isosculpt_window_leave(w, question);
    else if (answers & ISOSCULPT_ANSWER_STAY)
        stay(w, question);
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
    const unsigned wishes = w->hand.wishes;
    if (wishes & ISOSCULPT_WISH_SAVE) isosculpt_window_save(w, ISOSCULPT_BROWSE_SAVE, NULL);
    if (wishes & ISOSCULPT_WISH_SAVE_AS) w->screen.browse = ISOSCULPT_BROWSE_SAVE;
    if (wishes & ISOSCULPT_WISH_OPEN) w->screen.browse = ISOSCULPT_BROWSE_OPEN;
    if (wishes & ISOSCULPT_WISH_SCULPT) sculpt(w);
    w->hand.wishes &= ISOSCULPT_WISH_PICTURE | ISOSCULPT_WISH_CLOSE;
}

/* What went wrong under the hand. */
static void tell_troubles(window *w) {
    isosculpt_hand *hand = &w->hand;
    if (hand->error.text[0])
        isosculpt_window_say(w, true, hand->error.text);
    else if (hand->clipped)
        isosculpt_window_say(w, true, "The brush reached beyond the grid: what lies outside is lost.");
    hand->error.text[0] = 0;
    hand->clipped = false;
}

iso_status isosculpt_window_obey(window *w, iso_error *error) {
    const unsigned answers = w->screen.answers;
    w->screen.answers = 0;
    cancel(w, answers);
    if (w->screen.question && answers & ~(3u * ISOSCULPT_ANSWER_CANCEL))
        isosculpt_window_answer(w, answers);
    else if (answers & ISOSCULPT_ANSWER_OPEN)
        take_path(w);
    if (answers & ISOSCULPT_ANSWER_CHOSEN) isosculpt_window_take_choice(w);
    if (answers & ISOSCULPT_ANSWER_COMMAND) isosculpt_window_copy_command(w);
    take_wishes(w);
    isosculpt_window_go_on_saving(w);
    slide(w);
    tell_troubles(w);
    ask_for_stamp(w);
    return finish_opening(w, error);
}

/* The window closes over it. */
void isosculpt_window_abandon(window *w) {
    isosculpt_opened opened = {0};
    isosculpt_task_cancel(isosculpt_opening_task(w->opening));
    if (isosculpt_opening_finish(w->opening, &opened, NULL) == ISO_OK) isosculpt_opened_free(&opened);
}
