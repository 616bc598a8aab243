/* The reference in isosculpt's window: made in the background when it is first shown. */
#include "apps/isosculpt/window/reference.h"

#include <stdio.h>

void isosculpt_window_toggle_reference(window *w) {
    if (w->volume || w->screen.blank) return;
    w->viewport.reference_mode.shown = !w->viewport.reference_mode.shown;
    w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
}

static void fail(window *w, const char *reason) {
    char text[sizeof w->screen.message];
    snprintf(text, sizeof text, "No reference: %.500s", reason);
    isosculpt_window_set_status(w, true, text);
    w->viewport.reference_mode.shown = false;
}

static void start(window *w) {
    w->reference_labels = w->viewport.reference_mode.labels;
    const isosculpt_reference_files files = {.labels = w->reference_labels,
                                             .settings = w->settings,
                                             .voxel = w->voxel,
                                             .box = isosculpt_viewport_bounds(&w->viewport)};
    iso_error reason = {0};
    if (isosculpt_reference_job_start(&w->document, &files, isosculpt_window_wake, &w->reference_job,
                                      &reason) != ISO_OK)
        fail(w, reason.text);
}

/* A segmentation of one label, such as a mask, has no others to be shown. */
static void forget_labels(window *w) {
    w->screen.has_labels = false;
    w->viewport.reference_mode.shown = w->viewport.reference_mode.labels = false;
}

static void finish(window *w) {
    iso_error reason = {0};
    isosculpt_reference *reference;
    isosculpt_reference_files files;
    iso_status status = isosculpt_reference_job_finish(w->reference_job, &reference, &files, &reason);
    iso_rgb *color = &w->viewport.mode.material.color;
    w->reference_job = NULL;
    if (files.sculpted.known && iso_rgb_equal(*color, ISOSCULPT_SURFACE_COLOR)) *color = files.sculpted.color;
    for (int i = 0; status == ISO_OK && i < files.note_count; i++) {
        iso_program_log(isosculpt_program(), "note: %s", files.notes[i]);
        isosculpt_window_set_status(w, false, files.notes[i]);
    }
    if (status == ISO_OK)
        isosculpt_viewport_set_reference(&w->viewport, reference);
    else if (status == ISO_ERR_EMPTY && w->reference_labels)
        forget_labels(w);
    else
        fail(w, reason.text);
    w->controller.commands |= ISOSCULPT_COMMAND_REDRAW;
}

void isosculpt_window_update_reference(window *w) {
    iso_error *reason = &w->viewport.reference_error;
    if (reason->text[0]) fail(w, reason->text);
    reason->text[0] = 0;
    if (w->viewport.reference_mode.labels != w->reference_labels) { /* another one is wanted */
        isosculpt_window_cancel_reference(w);
        isosculpt_viewport_set_reference(&w->viewport, NULL);
        w->reference_labels = w->viewport.reference_mode.labels;
    }
    const bool wanted = w->viewport.reference_mode.shown && !w->volume && !w->screen.blank;
    if (w->reference_job && isosculpt_reference_job_done(w->reference_job)) finish(w);
    if (wanted && !w->viewport.reference && !w->reference_job) start(w);
    w->screen.reference_pending = w->reference_job != NULL;
}

void isosculpt_window_cancel_reference(window *w) {
    isosculpt_reference_job_cancel(w->reference_job);
    w->reference_job = NULL;
}
