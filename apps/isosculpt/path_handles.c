/* Bends paths of strokes. */
#include "apps/isosculpt/path_handles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/input_controller.h"

static double step_length(const iso_sample *samples, size_t i) {
    return iso_vec3_length(iso_vec3_sub(samples[i].position, samples[i - 1].position));
}

int isosculpt_path_handles(const iso_sample *samples, size_t count, size_t at[ISOSCULPT_HANDLES]) {
    double length = 0, along = 0;
    int handles = 1;
    at[0] = 0;
    for (size_t i = 1; i < count; i++) length += step_length(samples, i);
    const double apart = length / (ISOSCULPT_HANDLES - 1);
    for (size_t i = 1; i + 1 < count && handles < ISOSCULPT_HANDLES - 1; i++) {
        along += step_length(samples, i);
        if (along >= handles * apart) at[handles++] = i;
    }
    if (count > 1) at[handles++] = count - 1;
    return handles;
}

int isosculpt_path_handle_at(const isosculpt_pick_buffer *buffer, const iso_sample *samples, size_t count,
                             double x, double y, double scale) {
    size_t at[ISOSCULPT_HANDLES];
    double nearest = ISOSCULPT_HANDLE_GRIP * scale, px, py;
    const int handles = isosculpt_path_handles(samples, count, at);
    int found = -1;
    for (int i = 0; i < handles; i++) {
        if (!isosculpt_pick_buffer_pixel(buffer, samples[at[i]].position, &px, &py)) continue;
        const double away = hypot(px - x, py - y);
        if (away > nearest) continue;
        nearest = away;
        found = i;
    }
    return found;
}

iso_status isosculpt_bending_begin(isosculpt_bending *bending, const isosculpt_pick_buffer *buffer,
                                   unsigned number, const iso_sample *samples, size_t count, int handle,
                                   double x, double y, iso_error *error) {
    size_t at[ISOSCULPT_HANDLES];
    isosculpt_bending_free(bending);
    bending->from = malloc(count * sizeof *samples);
    bending->bent = malloc(count * sizeof *samples);
    if (!bending->from || !bending->bent) {
        isosculpt_bending_free(bending);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the path of a stroke");
    }
    memcpy(bending->from, samples, count * sizeof *samples);
    memcpy(bending->bent, samples, count * sizeof *samples);
    isosculpt_path_handles(samples, count, at);
    bending->number = number;
    bending->count = count;
    bending->handle = handle;
    bending->depth = iso_view_point(&buffer->view, samples[at[handle]].position).z;
    bending->pressed = isosculpt_pick_buffer_point(buffer, x, y, bending->depth);
    return ISO_OK;
}

/* Moves the samples between a handle and the next one (step: 1 or -1), or the end of the path. */
static void bend_side(isosculpt_bending *bending, size_t handle, size_t other, int step, iso_vec3 by) {
    double length = 0, along = 0;
    for (size_t i = handle; i != other; i += (size_t)step)
        length += step_length(bending->from, step > 0 ? i + 1 : i);
    for (size_t i = handle; i != other; i += (size_t)step) {
        const double t = length > 0 ? 1 - along / length : 1, weight = t * t * (3 - 2 * t);
        bending->bent[i].position = iso_vec3_add(bending->from[i].position, iso_vec3_scale(by, weight));
        along += step_length(bending->from, step > 0 ? i + 1 : i);
    }
}

void isosculpt_bending_move(isosculpt_bending *bending, const isosculpt_pick_buffer *buffer, double x,
                            double y) {
    size_t at[ISOSCULPT_HANDLES];
    const iso_vec3 by =
        iso_vec3_sub(isosculpt_pick_buffer_point(buffer, x, y, bending->depth), bending->pressed);
    const int handles = isosculpt_path_handles(bending->from, bending->count, at), i = bending->handle;
    bending->moved = true;
    bending->bent[at[i]].position = iso_vec3_add(bending->from[at[i]].position, by);
    if (i > 0) bend_side(bending, at[i], at[i - 1], -1, by);
    if (i + 1 < handles) bend_side(bending, at[i], at[i + 1], 1, by);
}

void isosculpt_bending_free(isosculpt_bending *bending) {
    free(bending->from);
    free(bending->bent);
    *bending = (isosculpt_bending){.number = 0};
}

/* ---- of the selected stroke */

const iso_sample *isosculpt_controller_path(const isosculpt_controller *controller,
                                            const iso_stroke *stroke) {
    const isosculpt_bending *bending = &controller->bending;
    const bool bent = bending->number == stroke->number && bending->count == stroke->count;
    return bent ? bending->bent : isosculpt_stroke_editor_path(&controller->document->strokes, stroke);
}

/* The selected stroke, if its path is drawn with handles. */
static const iso_stroke *stroke_with_handles(isosculpt_controller *controller) {
    isosculpt_document *document = controller->document;
    if (controller->viewing_volume) return NULL;
    const iso_stroke *stroke = isosculpt_stroke_editor_stroke(&document->strokes, document->session);
    return stroke && isosculpt_tool_has_path(stroke->brush.tool) ? stroke : NULL;
}

int isosculpt_controller_path_handle(isosculpt_controller *controller) {
    if (controller->drag == ISOSCULPT_DRAG_HANDLE) return controller->bending.handle;
    const iso_stroke *stroke = controller->drag ? NULL : stroke_with_handles(controller);
    return stroke ? isosculpt_path_handle_at(&controller->viewport->drawn,
                                             isosculpt_controller_path(controller, stroke), stroke->count,
                                             controller->x, controller->y, controller->scale)
                  : -1;
}

void isosculpt_bending_take(isosculpt_controller *controller, int handle) {
    const iso_stroke *stroke = stroke_with_handles(controller);
    if (isosculpt_bending_begin(&controller->bending, &controller->viewport->drawn, stroke->number,
                                isosculpt_controller_path(controller, stroke), stroke->count, handle,
                                controller->x, controller->y, &controller->error) == ISO_OK)
        controller->drag = ISOSCULPT_DRAG_HANDLE;
}

void isosculpt_bending_release(isosculpt_controller *controller, bool cancel) {
    const isosculpt_bending *bending = &controller->bending;
    const iso_event event = {.kind = ISO_EVENT_PATH,
                             .first = bending->number,
                             .last = bending->number,
                             .path = bending->bent,
                             .path_count = bending->count};
    if (!cancel && bending->moved)
        isosculpt_stroke_editor_request(&controller->document->strokes, &event, &controller->error);
    isosculpt_bending_free(&controller->bending);
    controller->drag = ISOSCULPT_DRAG_NONE;
}
