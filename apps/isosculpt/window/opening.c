/* Opening files in isosculpt's window: documents, volumes, meshes and stamps. */
#include "apps/isosculpt/window/opening.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "apps/isosculpt/look.h"
#include "apps/isosculpt/window/backdrop.h"
#include "apps/isosculpt/window/reference.h"
#include "base/file_types.h"
#include "source/label.h"

/* ---- the document and its viewport */

/* The first label of a segmentation that is opened is shown among the others, unless another reference is
 * asked for. */
static void adopt_labels(window *w) {
    isosculpt_reference_mode *mode = &w->viewport.reference_mode;
    const bool had_labels = w->screen.has_labels, asked = w->settings->x_ray != ISOSCULPT_X_RAY_OFF ||
                                                          w->settings->references.count || mode->shown;
    w->screen.has_labels = !w->volume && iso_source_label(&w->document.start) > 0;
    if (w->screen.has_labels && !had_labels && !asked) mode->shown = mode->labels = true;
    if (!w->screen.has_labels && mode->labels) mode->shown = mode->labels = false;
}

/* Sets up controller and engine after document and viewport have been replaced. The brush keeps its size in
 * voxels. */
static void adopt_document(window *w) {
    iso_brush brush = w->controller.brush;
    const double before = w->voxel, voxel = w->document.start.voxel_size;
    w->viewport.gl = w->gl;
    w->viewport.mode.engine = w->engine;
    isosculpt_controller_free(&w->controller);
    isosculpt_controller_init(&w->controller, &w->document, &w->viewport);
    isosculpt_window_sync_pointer(w);
    adopt_labels(w);
    if (before > 0) {
        const iso_vec3 middle = w->controller.brush.mirror; /* the axes of symmetry belong to the previous
                                                               object */
        w->controller.brush = brush;
        w->controller.brush.mirror = middle;
        w->controller.brush.symmetry = w->controller.brush.radial = 0;
        w->controller.brush.repeat[0] = w->controller.brush.repeat[1] = 0;
        w->controller.brush.radius = brush.radius / before * voxel;
    }
    if (w->document.look[0]) isosculpt_look_apply(&w->controller, w->document.look); /* it is recovered */
    w->voxel = voxel;
    w->controller.viewing_volume = w->screen.volume != NULL;
    w->controller.commands = ISOSCULPT_COMMAND_REDRAW;
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    isosculpt_window_adopt_backdrop(w);
}

/* Shows the whole surface in the part of the window that the panel leaves free. */
static void frame_surface(window *w) {
    isosculpt_window_update_framebuffer_size(w);
    isosculpt_viewport_set_size(&w->viewport, w->screen.picture_width, w->screen.height);
}

static iso_status show_document(window *w, iso_error *error) {
    ISO_TRY(isosculpt_viewport_init(&w->viewport, iso_session_grid(w->document.session), w->pool, error));
    w->viewport.reference_mode.shown =
        w->settings->x_ray != ISOSCULPT_X_RAY_OFF || w->settings->references.count;
    w->viewport.reference_mode.over = w->settings->x_ray == ISOSCULPT_X_RAY_OVER;
    frame_surface(w);
    adopt_document(w);
    return ISO_OK;
}

/* Shows the solid of --new, or a new ball, with a journal if one can be written. */
static iso_status show_solid(window *w, iso_error *error) {
    const iso_source source = {.solid = &w->settings->solid, .voxel = w->settings->voxel_size};
    ISO_TRY(isosculpt_document_new(&w->document, w->has_folder ? w->folder : NULL,
                                   isosculpt_has_new(w->settings) ? &source : NULL, error));
    return show_document(w, error);
}

/* Starts the load job that converts the viewed volume into a field at the chosen isovalue. */
static iso_status start_converting(window *w, iso_error *error) {
    const isosculpt_see_through *how = &w->viewport.see_through;
    const isosculpt_freezing second = {.on = true, .isovalue = how->second_isovalue};
    const bool freezes = how->has_second && w->screen.freeze_second;
    const isosculpt_load_request request = {.path = w->volume->path,
                                            .volume = w->volume,
                                            .folder = w->has_folder ? w->folder : NULL,
                                            .isovalue = w->viewport.isovalue,
                                            .freezing = freezes ? second : w->freezing,
                                            .voxel = w->settings->voxel_size,
                                            .threads = w->settings->common.threads,
                                            .undo_memory = (size_t)w->settings->undo_memory,
                                            .wake = isosculpt_window_wake};
    return isosculpt_load_job_start(&request, &w->load_job, error);
}

/* Makes a path absolute, because it is shown on the screen and used in commands. */
static void make_absolute(const char *path, char absolute[2 * ISOSCULPT_PATH]) {
    char folder[ISOSCULPT_PATH];
    if (path[0] == '/' || !getcwd(folder, sizeof folder))
        snprintf(absolute, 2 * ISOSCULPT_PATH, "%s", path);
    else
        snprintf(absolute, 2 * ISOSCULPT_PATH, "%s/%s", folder, path);
}

/* Starts the load job for a file, or for the input of a scene. The options for reading apply only to the file
 * on the command line; a scene has its own. */
static iso_status start_opening(window *w, const char *path, bool stamp, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    char absolute[2 * ISOSCULPT_PATH];
    isosculpt_opened_scene_free(&w->scene);
    if (!stamp && isosculpt_is_scene(path)) ISO_TRY(isosculpt_opened_scene_read(path, &w->scene, error));
    const isosculpt_settings *reading = w->scene.strings         ? &w->scene.settings
                                        : path == settings->open ? settings
                                                                 : NULL;
    make_absolute(w->scene.strings ? w->scene.settings.open : path, absolute);
    const isosculpt_load_request request = {
        .path = absolute,
        .stamp = stamp,
        .folder = w->has_folder ? w->folder : NULL,
        .isovalue = reading ? reading->isovalue : NAN,
        .voxel = reading ? reading->voxel_size : 0,
        .close_holes = settings->close_holes,
        .freezing = reading && !w->scene.strings ? settings->freezing : (isosculpt_freezing){.on = false},
        .input = reading ? reading->common.input : (iso_input){0},
        .threads = settings->common.threads,
        .undo_memory = (size_t)settings->undo_memory,
        .wake = isosculpt_window_wake};
    w->agreed_changes = w->document.change_count;
    w->freezing = request.freezing;
    return isosculpt_load_job_start(&request, &w->load_job, error);
}

/* Opens the first file; the window is blank until it is loaded. */
static iso_status open_blank(window *w, const char *path, iso_error *error) {
    ISO_TRY(isosculpt_document_init_empty(&w->document, error));
    ISO_TRY(show_document(w, error));
    w->screen.blank = true;
    return start_opening(w, path, false, error);
}

iso_status isosculpt_window_open_first(window *w, iso_error *error) {
    const isosculpt_settings *settings = w->settings;
    iso_error reason = {0};
    w->has_folder = isosculpt_document_state_folder(w->folder, &reason) == ISO_OK;
    if (settings->strokes) return open_blank(w, settings->strokes, error);
    const bool unclosed = w->has_folder && isosculpt_document_find_unclosed(w->folder, w->screen.dialog_path);
    if (settings->recover && unclosed) return open_blank(w, w->screen.dialog_path, error);
    if (unclosed) w->screen.dialog = ISOSCULPT_DIALOG_RECOVER;
    if (settings->recover)
        isosculpt_window_set_status(w, false, "There is nothing to recover: no session was left unclosed.");
    if (settings->open) return open_blank(w, settings->open, error);
    ISO_TRY(show_solid(w, error));
    if (reason.text[0])
        snprintf(w->document.journal_error, sizeof w->document.journal_error, "%s", reason.text);
    return ISO_OK;
}

/* After a volume has become a field: restores the mirror and applies the strokes that were queued meanwhile.
 */
static void apply_queued_strokes(window *w, const iso_brush *brush, isosculpt_strokes *queued) {
    w->controller.brush.symmetry = brush->symmetry;
    w->controller.brush.mirror = brush->mirror;
    w->controller.brush.radial = brush->radial;
    w->controller.brush.radial_axis = brush->radial_axis;
    memcpy(w->controller.brush.repeat, brush->repeat, sizeof brush->repeat);
    memcpy(w->controller.brush.repeat_by, brush->repeat_by, sizeof brush->repeat_by);
    isosculpt_controller_apply_strokes(&w->controller, queued);
}

/* Shows what was opened as its scene does, if it has one, and says what is not. */
static void apply_scene(window *w) {
    isosculpt_opened_scene *scene = &w->scene;
    iso_error reason = {0};
    char text[240];
    const iso_status status = isosculpt_opened_scene_apply(scene, &w->viewport, &reason);
    if (status != ISO_OK) isosculpt_window_set_status(w, true, reason.text);
    if (status == ISO_OK && scene->left_out[0]) {
        snprintf(text, sizeof text, "A window does not show %s of the scene.", scene->left_out);
        isosculpt_window_set_status(w, false, text);
    }
    isosculpt_opened_scene_free(scene);
}

/* Closes the current document, whose journal holds all of its strokes, and shows what was loaded. A field
 * made of the viewed volume keeps the volume's camera. */
static iso_status show_loaded(window *w, isosculpt_loaded *loaded, iso_error *error) {
    const isosculpt_display_mode mode = w->viewport.mode;
    const iso_camera camera = w->viewport.camera;
    const bool resampled = loaded->resampled,
               same_camera = resampled || (w->volume && !loaded->volume && w->sculpting);
    const isosculpt_reference_mode reference_mode = w->viewport.reference_mode;
    const iso_brush brush = w->controller.brush;
    const isosculpt_cut cut = w->viewport.cut;
    const isosculpt_light light = w->viewport.light;
    isosculpt_strokes queued = w->controller.queued_strokes;
    w->controller.queued_strokes = (isosculpt_strokes){0};
    isosculpt_window_cancel_reference(w);
    isosculpt_viewport_free(&w->viewport);
    isosculpt_document_close(&w->document);
    iso_source_volume_free(w->volume);
    iso_pool_destroy(w->own_pool);
    w->pool = w->own_pool = loaded->pool;
    w->document = loaded->document;
    w->viewport = loaded->viewport;
    w->screen.volume = w->volume = loaded->volume;
    w->screen.isovalue = w->viewport.isovalue;
    w->screen.blank = false;
    w->screen.asked_voxel = 0;
    w->viewport.mode = mode;
    w->viewport.reference_mode = reference_mode;
    w->viewport.light = light;
    if (same_camera) {
        w->viewport.camera = camera;
        w->viewport.cut = cut;
        if (cut.cap.kind == ISO_CAP_SLICE) w->viewport.cut.cap.kind = ISO_CAP_SURFACE; /* of distances */
    } else
        frame_surface(w);
    if (w->volume && w->volume->has_isovalues) {
        w->viewport.values[0] = w->volume->histogram.minimum;
        w->viewport.values[1] = w->volume->histogram.maximum;
    }
    apply_scene(w);
    if (w->volume) {
        w->document.pool = w->pool;
        ISO_TRY(isosculpt_document_init_empty(&w->document, error));
        w->document.start.voxel_size = iso_grid_transform(&w->viewport.grid)->spacing[0];
        isosculpt_target_default(w->volume->path, w->document.target); /* shown in the panel */
    }
    adopt_document(w);
    if (resampled) w->controller.brush = brush;
    if (same_camera)
        apply_queued_strokes(w, &brush, &queued);
    else
        isosculpt_strokes_free(&queued);
    return ISO_OK;
}

/* Keeps the current document after opening failed or was cancelled. If there is none yet, an error ends the
 * program, and cancelling shows a new ball. */
static iso_status keep_document(window *w, bool cancelled, iso_status status, iso_error *error) {
    const bool first = w->screen.blank;
    if (first && !cancelled) return status;
    isosculpt_window_set_status(w, !cancelled, cancelled ? "Cancelled." : error->text);
    if (!first) return ISO_OK;
    w->screen.blank = false;
    isosculpt_viewport_free(&w->viewport);
    isosculpt_document_close(&w->document);
    return show_solid(w, error);
}

/* Shows the session in its new voxels, which no file holds yet, unless strokes were made meanwhile. */
static iso_status show_resampled(window *w, isosculpt_loaded *loaded, iso_error *error) {
    char target[ISOSCULPT_PATH], text[ISOSCULPT_PATH + 120];
    if (w->document.change_count != w->agreed_changes) {
        isosculpt_loaded_free(loaded);
        isosculpt_window_set_status(w, true, "There are new strokes since resampling began: do it again.");
        return ISO_OK;
    }
    memcpy(target, w->document.target, sizeof target);
    snprintf(text, sizeof text, "In voxels of %.5g mm from now on. Until now: %s",
             loaded->document.start.voxel_size, w->document.journal);
    ISO_TRY(show_loaded(w, loaded, error));
    memcpy(w->document.target, target, sizeof target);
    w->document.change_count = 1;
    isosculpt_window_set_status(w, false, text);
    return ISO_OK;
}

/* Whether changes were made since the user agreed to lose the unsaved ones. */
static bool must_ask_again(const window *w) {
    const isosculpt_task *task = isosculpt_load_job_task(w->load_job);
    return isosculpt_window_has_unsaved_changes(w) && w->document.change_count != w->agreed_changes &&
           !isosculpt_task_cancelled(task) && !isosculpt_task_failed(task) &&
           !isosculpt_load_job_is_stamp(w->load_job) && !w->resampling;
}

/* Ends the conversion of a volume into a field, whether it succeeded or not. */
static void end_sculpting(window *w) {
    if (w->viewport.opaque) w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
    w->sculpting = w->screen.sculpting = w->viewport.opaque = false;
    isosculpt_controller_drop_strokes(&w->controller);
}

iso_status isosculpt_window_finish_opening(window *w, iso_error *error) {
    isosculpt_loaded loaded;
    if (!w->load_job || !isosculpt_task_done(isosculpt_load_job_task(w->load_job))) return ISO_OK;
    const isosculpt_dialog dialog = w->screen.dialog;
    if (w->controller.drag || w->document.saver || isosculpt_stroke_editor_is_busy(&w->document.strokes) ||
        (dialog && dialog != ISOSCULPT_DIALOG_RECOVER))
        return ISO_OK; /* a later call continues */
    if (must_ask_again(w)) {
        snprintf(w->next_path, sizeof w->next_path, "%s", isosculpt_load_job_path(w->load_job));
        isosculpt_window_show_dialog(w, ISOSCULPT_DIALOG_OPEN, w->next_path);
        return ISO_OK;
    }
    const bool cancelled = isosculpt_task_cancelled(isosculpt_load_job_task(w->load_job));
    iso_status status = isosculpt_load_job_finish(w->load_job, &loaded, error);
    w->load_job = NULL;
    w->resampling = false;
    if (status != ISO_OK) {
        end_sculpting(w);
        return keep_document(w, cancelled, status, error);
    }
    char note[240];
    const bool noted = iso_mesh_report_note(&loaded.report, note, sizeof note);
    if (loaded.stamp)
        isosculpt_controller_set_stamp(&w->controller, loaded.stamp);
    else if (loaded.resampled)
        status = show_resampled(w, &loaded, error);
    else
        status = show_loaded(w, &loaded, error);
    if (status == ISO_OK && noted) isosculpt_window_set_status(w, false, note);
    end_sculpting(w);
    w->frames_left = ISOSCULPT_FRAMES_AFTER_EVENT;
    return status;
}

bool isosculpt_window_is_opening(window *w) {
    if (w->load_job)
        isosculpt_window_set_status(w, true, "Another file is being opened: wait for it, or cancel it.");
    return w->load_job;
}

/* Starts the load job for a new session with w->next. */
static iso_status start_beginning(window *w, iso_error *error) {
    const isosculpt_load_request request = {.path = iso_solid_name(w->next.solid.kind),
                                            .solid = w->next.solid,
                                            .voxel = w->next.voxel,
                                            .folder = w->has_folder ? w->folder : NULL,
                                            .isovalue = NAN,
                                            .threads = w->settings->common.threads,
                                            .undo_memory = (size_t)w->settings->undo_memory,
                                            .wake = isosculpt_window_wake};
    isosculpt_opened_scene_free(&w->scene);
    w->agreed_changes = w->document.change_count;
    return isosculpt_load_job_start(&request, &w->load_job, error);
}

static void open_path(window *w, const char *path, bool stamp) {
    iso_error reason = {0};
    if (isosculpt_window_is_opening(w)) return;
    if (stamp && w->volume)
        isosculpt_window_set_status(w, true, "A stamp needs something to work on: sculpt this first.");
    else if (start_opening(w, path, stamp, &reason) != ISO_OK)
        isosculpt_window_set_status(w, true, reason.text);
    else
        w->screen.message[0] = 0; /* removes the message of an earlier attempt */
}

/* Opens next_path, or begins with `next`. */
static void open_next(window *w) {
    iso_error reason = {0};
    if (!(w->next.solid.size.x > 0))
        open_path(w, w->next_path, false);
    else if (!isosculpt_window_is_opening(w) && start_beginning(w, &reason) != ISO_OK)
        isosculpt_window_set_status(w, true, reason.text);
}

/* Opens a file, or begins with a solid, in place of the document; asks first about unsaved changes. */
static void replace_document(window *w, const char *path, const isosculpt_new *next) {
    if (isosculpt_window_is_opening(w)) return;
    snprintf(w->next_path, sizeof w->next_path, "%s", path);
    w->next = next ? *next : (isosculpt_new){.voxel = 0};
    if (isosculpt_window_has_unsaved_changes(w))
        isosculpt_window_show_dialog(w, ISOSCULPT_DIALOG_OPEN, w->next_path);
    else
        open_next(w);
}

static iso_status start_resampling(window *w, iso_error *error) {
    const isosculpt_load_request request = {.path = w->document.journal,
                                            .resample = true,
                                            .voxel = w->screen.asked_voxel,
                                            .folder = w->has_folder ? w->folder : NULL,
                                            .isovalue = NAN,
                                            .threads = w->settings->common.threads,
                                            .undo_memory = (size_t)w->settings->undo_memory,
                                            .wake = isosculpt_window_wake};
    ISO_TRY(iso_session_sync(w->document.session, error));
    w->agreed_changes = w->document.change_count;
    return isosculpt_load_job_start(&request, &w->load_job, error);
}

void isosculpt_window_resample(window *w) {
    iso_error reason = {0};
    if (isosculpt_window_is_opening(w) || w->controller.drag) return;
    w->resampling = start_resampling(w, &reason) == ISO_OK;
    if (!w->resampling) isosculpt_window_set_status(w, true, reason.text);
}

bool isosculpt_window_can_begin(const window *w) {
    iso_journal_start start;
    return iso_start_with_solid(&w->screen.asked.solid, w->screen.asked.voxel, &start, NULL) == ISO_OK;
}

void isosculpt_window_begin(window *w) {
    char name[32];
    snprintf(name, sizeof name, "A new %s", iso_solid_name(w->screen.asked.solid.kind));
    replace_document(w, name, &w->screen.asked);
}

void isosculpt_window_open_file(window *w, const char *path, bool stamp) {
    if (stamp)
        open_path(w, path, true);
    else
        replace_document(w, path, NULL);
}

void isosculpt_window_recover(window *w, const char *journal) {
    open_path(w, journal, false);
}

void isosculpt_window_confirm_open(window *w) {
    if (w->load_job)
        w->agreed_changes = w->document.change_count; /* the file is loaded already */
    else
        open_next(w);
}

void isosculpt_window_reject_open(window *w) {
    if (w->load_job) isosculpt_task_cancel(isosculpt_load_job_task(w->load_job));
}

/* Handles a dropped file. A mesh can be opened or become a stamp, a picture becomes one; a stamp needs a
 * field. */
void isosculpt_window_drop(window *w, const char *path) {
    if (isosculpt_window_is_opening(w)) return;
    const bool picture = iso_file_type_of_name(path, ~0u) == ISO_FILE_png && !isosculpt_is_scene(path);
    if (picture && !w->volume && !w->screen.blank)
        open_path(w, path, true);
    else if (iso_source_kind(path) == ISO_HOLDS_MESH && !w->volume && !w->screen.blank)
        isosculpt_window_show_dialog(w, ISOSCULPT_DIALOG_MESH, path);
    else
        replace_document(w, path, NULL);
}

void isosculpt_window_start_sculpting(window *w) {
    iso_error reason = {0};
    if (!w->volume || w->sculpting) return;
    if (isosculpt_window_is_opening(w)) {
        isosculpt_controller_drop_strokes(&w->controller);
        return;
    }
    w->sculpting = start_converting(w, &reason) == ISO_OK;
    w->screen.sculpting = w->controller.field_pending = w->viewport.opaque = w->sculpting;
    w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
    if (w->sculpting) {
        isosculpt_controller_center_mirror(&w->controller);
    } else {
        isosculpt_controller_drop_strokes(&w->controller);
        isosculpt_window_set_status(w, true, reason.text);
    }
}

void isosculpt_window_load_first_stamp(window *w) {
    if (w->stamp_loaded || w->screen.blank || w->volume || w->load_job || !w->settings->stamp) return;
    w->stamp_loaded = true;
    open_path(w, w->settings->stamp, true);
}

void isosculpt_window_cancel_load(window *w) {
    isosculpt_loaded loaded = {0};
    isosculpt_task_cancel(isosculpt_load_job_task(w->load_job));
    if (isosculpt_load_job_finish(w->load_job, &loaded, NULL) == ISO_OK) isosculpt_loaded_free(&loaded);
}
