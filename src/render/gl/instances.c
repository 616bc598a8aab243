/* instances: uploads the points of an instance, and draws them into the picture buffer, which holds a strip
 * of the picture meanwhile. */
#include "render/gl/instances.h"

#include <glad/gl.h>

#include "render/gl/discs.h"
#include "render/gl/picture.h"
#include "render/gl/shared.h"

/* Limit of the storage buffer of the picture; a larger picture is drawn in strips. */
static const size_t STORAGE_BYTES = (size_t)256 << 20;

/* The drawing of one strip. */
typedef struct instances_call {
    iso_gl_engine *engine;
    const iso_target *target;
    iso_gl_discs_style style;
    iso_buffer room, radii;
} instances_call;

/* The points as they are uploaded: with the radii of the instance. ISO_ERR_NOMEM. */
static iso_status prepare(instances_call *call, iso_point_view *points, iso_error *error) {
    const bool scaled = points->radii ? iso_point_view_radii_scale(points) != 1 : points->span_scales != NULL;
    size_t end = 0;
    for (size_t s = 0; s < points->span_count; s++) {
        const size_t last = points->spans[s].first + points->spans[s].count;
        if (last > end) end = last;
    }
    if (!scaled) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&call->radii, end * sizeof(float), 0, error));
    float *radii = call->radii.data;
    for (size_t s = 0; s < points->span_count; s++) {
        const iso_point_span *span = &points->spans[s];
        const float all = points->span_scales ? (float)points->radius * points->span_scales[s] : 0;
        for (size_t i = span->first; i < span->first + span->count; i++)
            radii[i] = points->radii ? iso_point_view_radii_scale(points) * points->radii[i] : all;
    }
    points->radii = radii;
    points->span_scales = NULL;
    points->radii_scale = 0;
    return ISO_OK;
}

static iso_status draw_uploaded(instances_call *call, const iso_gl_surface *surface, const iso_area *area,
                                iso_error *error) {
    const iso_view *view = call->target->view;
    iso_projector projector = iso_projector_make(view, &surface->transform);
    ISO_TRY(
        iso_point_blocks_set_view(surface->blocks, surface->closed, &surface->transform, &projector, error));
    if (!surface->blocks->seen) return ISO_OK;
    ISO_TRY(iso_gl_enter(call->engine->context, error));
    const iso_status status =
        iso_gl_draw_discs(surface, view, call->target->surface, call->style, area, &call->room, error);
    return iso_gl_leave(call->engine->context, status, error);
}

/* iso_instance_engine.draw. */
static iso_status draw_instance(void *context, const iso_point_view *view, const iso_rgb *color,
                                const iso_area *area, iso_error *error) {
    instances_call *call = context;
    iso_point_view points = *view;
    iso_gl_surface *surface = NULL;
    call->style.color = color;
    if (color) points.colors = NULL;
    ISO_TRY(prepare(call, &points, error));
    ISO_TRY(iso_gl_upload_points(call->engine, &points, &surface, error));
    const iso_status status = draw_uploaded(call, surface, area, error);
    iso_gl_surface_destroy(surface);
    return status;
}

static iso_status begin_strip(instances_call *call, size_t planes, size_t start, size_t samples,
                              iso_error *error) {
    iso_gl_context *context = call->engine->context;
    ISO_TRY(iso_gl_enter(context, error));
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_PICTURE, samples * planes * sizeof(float));
    return iso_gl_leave(
        context,
        iso_gl_picture_write(call->engine, planes, call->target->gbuffer, start, samples, &call->room, error),
        error);
}

static iso_status end_strip(instances_call *call, size_t planes, size_t start, size_t samples,
                            iso_error *error) {
    iso_gl_context *context = call->engine->context;
    ISO_TRY(iso_gl_enter(context, error));
    const iso_status status =
        iso_gl_picture_read(call->engine, planes, call->target->gbuffer, start, samples, &call->room, error);
    iso_gl_timer_read(&call->engine->timer, context->gl);
    return iso_gl_leave(context, status, error);
}

static iso_status draw_strips(instances_call *call, iso_instance_drawing *drawing,
                              const iso_instances *instances, size_t planes, iso_instance_counts *counts,
                              iso_error *error) {
    const iso_target *whole = call->target;
    const size_t width = (size_t)whole->view->width, row = width * planes * sizeof(float),
                 most = call->engine->max_storage < STORAGE_BYTES ? call->engine->max_storage : STORAGE_BYTES;
    const int rows = most / row > 0 ? (int)(most / row) : 1, height = whole->view->height;
    iso_status status = ISO_OK;
    for (int y = 0; y < height && status == ISO_OK; y += rows) {
        const iso_view view = iso_view_rows(whole->view, y, height - y < rows ? height - y : rows);
        const size_t start = (size_t)y * width, samples = (size_t)view.height * width;
        iso_target strip = *whole;
        strip.view = &view;
        iso_instance_counts of_strip;
        call->target = whole;
        ISO_TRY(begin_strip(call, planes, start, samples, error));
        call->target = &strip;
        ISO_TRY(iso_draw_instances(drawing, &strip, instances, &of_strip, error));
        counts->points += of_strip.points;
        call->target = whole;
        status = end_strip(call, planes, start, samples, error);
    }
    return status;
}

iso_status iso_gl_draw_instances(iso_gl_engine *engine, iso_instance_drawing *drawing,
                                 const iso_target *target, const iso_instances *instances,
                                 iso_instance_counts *counts, iso_error *error) {
    const iso_reconstruction how = instances->reconstruction;
    instances_call call = {.engine = engine,
                           .target = target,
                           .style = {.flat = how != ISO_RECONSTRUCTION_CURVED,
                                     .widened = how == ISO_RECONSTRUCTION_EWA,
                                     .selection = ISO_SELECTION_ALL}};
    const iso_instance_engine by = {draw_instance, &call};
    iso_instances all = *instances;
    bool colored = all.colors != NULL;
    for (size_t i = 0; i < all.set_count; i++) colored |= all.sets[i].lod->points.colors != NULL;
    if (colored) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    all.engine = &by;
    *counts = (iso_instance_counts){0};
    const iso_status status =
        draw_strips(&call, drawing, &all, ISO_GL_PICTURE_PLANES + colored, counts, error);
    iso_buffer_free(&call.room);
    iso_buffer_free(&call.radii);
    return status;
}
