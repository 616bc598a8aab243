/* instances: uploads the points of each set once, and draws them in the place of each instance into the
 * picture buffer, which holds a strip of the picture meanwhile. */
#include "render/gl/instances.h"

#include <glad/gl.h>

#include "base/memory.h"
#include "render/gl/discs.h"
#include "render/gl/picture.h"
#include "render/gl/shared.h"

/* Limit of the storage buffer of the picture; a larger picture is drawn in strips. */
static const size_t STORAGE_BYTES = (size_t)256 << 20;

/* Samples of the picture for each point that is drawn before its depths are read again. Of 3,394 instances in
 * view none more was drawn with 16 than with 200, two with 5; with llvmpipe frames took as long. */
enum { SAMPLES_A_POINT = 50 };

/* The drawing of one picture, and of a strip of it. */
typedef struct instances_call {
    iso_gl_engine *engine;
    const iso_instances *all;
    iso_gl_discs_style style;
    iso_gl_surface **levels; /* uploaded levels of detail, ISO_LOD_LEVELS of each set; NULL: not needed yet */
    iso_target target;       /* of the strip, with the strip's part of the gbuffer */
    size_t planes;
    iso_buffer room, radii;
} instances_call;

static iso_status draw_uploaded(instances_call *call, const iso_gl_surface *surface, const iso_area *area,
                                iso_error *error) {
    const iso_view *view = call->target.view;
    iso_projector projector = iso_projector_make(view, &surface->transform);
    ISO_TRY(
        iso_point_blocks_set_view(surface->blocks, surface->closed, &surface->transform, &projector, error));
    if (!surface->blocks->seen) return ISO_OK;
    ISO_TRY(iso_gl_enter(call->engine->context, error));
    const iso_status status =
        iso_gl_draw_discs(surface, view, call->target.surface, call->style, area, &call->room, error);
    return iso_gl_leave(call->engine->context, status, error);
}

/* Draws points that are those of this instance only: colours and sizes between two levels of detail. Uploads
 * them with a radius each. */
static iso_status draw_own(instances_call *call, const iso_instance_part *part, iso_error *error) {
    iso_point_view points = part->points;
    iso_gl_surface *surface = NULL;
    if (points.span_scales) {
        size_t end = 0;
        for (size_t s = 0; s < points.span_count; s++) {
            const size_t last = points.spans[s].first + points.spans[s].count;
            end = last > end ? last : end;
        }
        ISO_TRY(iso_buffer_reserve(&call->radii, end * sizeof(float), 0, error));
        float *radii = call->radii.data;
        for (size_t s = 0; s < points.span_count; s++)
            for (size_t i = 0; i < points.spans[s].count; i++)
                radii[points.spans[s].first + i] = (float)points.radius * points.span_scales[s];
        points.radii = radii;
        points.span_scales = NULL;
        points.radii_scale = 0;
    }
    if (part->color) points.colors = NULL;
    ISO_TRY(iso_gl_upload_points(call->engine, &points, &surface, error));
    const iso_status status = draw_uploaded(call, surface, &part->area, error);
    iso_gl_surface_destroy(surface);
    return status;
}

/* iso_instance_engine.draw. */
static iso_status draw_part(void *context, const iso_instance_part *part, iso_error *error) {
    instances_call *call = context;
    iso_point_view level = iso_lod_view(call->all->sets[part->set].lod, part->level);
    iso_gl_surface **uploaded = &call->levels[part->set * ISO_LOD_LEVELS + (size_t)part->level];
    call->style.color = part->color;
    call->style.before = part->fronts;
    if (part->points.span_scales || (!part->color && part->points.colors != level.colors))
        return draw_own(call, part, error);
    if (part->color) level.colors = NULL;
    if (!*uploaded) ISO_TRY(iso_gl_upload_points(call->engine, &level, uploaded, error));
    ISO_TRY(iso_gl_surface_place(*uploaded, &part->points, error));
    return draw_uploaded(call, *uploaded, &part->area, error);
}

/* iso_instance_engine.read_depths. */
static iso_status read_depths(void *context, iso_rows rows, iso_error *error) {
    const instances_call *call = context;
    const iso_gl_engine *engine = call->engine;
    const GladGLContext *gl = engine->context->gl;
    const size_t width = (size_t)call->target.view->width, first = (size_t)rows.first * width,
                 count = (size_t)(rows.last + 1 - rows.first) * width;
    ISO_TRY(iso_gl_enter(engine->context, error));
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl->GetNamedBufferSubData(engine->storage[ISO_GL_STORE_PICTURE], (GLintptr)(first * sizeof(float)),
                              (GLsizeiptr)(count * sizeof(float)), call->target.gbuffer->depth + first);
    return iso_gl_leave(engine->context, ISO_OK, error);
}

/* ---- strips */

static iso_status begin_strip(const instances_call *call, const iso_gbuffer *from, size_t start,
                              iso_buffer *room, iso_error *error) {
    const iso_view *view = call->target.view;
    const size_t samples = (size_t)view->width * (size_t)view->height;
    iso_gl_context *context = call->engine->context;
    ISO_TRY(iso_gl_enter(context, error));
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_PICTURE, samples * call->planes * sizeof(float));
    return iso_gl_leave(
        context, iso_gl_picture_write(call->engine, call->planes, from, start, samples, room, error), error);
}

static iso_status end_strip(const instances_call *call, const iso_gbuffer *to, size_t start, iso_buffer *room,
                            iso_error *error) {
    const iso_view *view = call->target.view;
    const size_t samples = (size_t)view->width * (size_t)view->height;
    iso_gl_context *context = call->engine->context;
    ISO_TRY(iso_gl_enter(context, error));
    const iso_status status =
        iso_gl_picture_read(call->engine, call->planes, to, start, samples, room, error);
    iso_gl_timer_read(&call->engine->timer, context->gl);
    return iso_gl_leave(context, status, error);
}

/* Draws the rows from y on. */
static iso_status draw_strip(instances_call *call, iso_instance_drawing *drawing, const iso_target *whole,
                             int y, int rows, size_t *points, iso_error *error) {
    const iso_view view = iso_view_rows(whole->view, y, rows);
    const size_t start = (size_t)y * (size_t)view.width;
    iso_gbuffer depths = {.width = view.width, .height = view.height, .depth = whole->gbuffer->depth + start};
    iso_instance_counts counts;
    call->target = *whole;
    call->target.view = &view;
    call->target.gbuffer = &depths;
    ISO_TRY(begin_strip(call, whole->gbuffer, start, &call->room, error));
    ISO_TRY(iso_draw_instances(drawing, &call->target, call->all, &counts, error));
    *points += counts.points;
    return end_strip(call, whole->gbuffer, start, &call->room, error);
}

static iso_status draw_strips(instances_call *call, iso_instance_drawing *drawing, const iso_target *whole,
                              size_t *points, iso_error *error) {
    const size_t row = (size_t)whole->view->width * call->planes * sizeof(float),
                 most = call->engine->max_storage < STORAGE_BYTES ? call->engine->max_storage : STORAGE_BYTES;
    const int rows = most / row > 0 ? (int)(most / row) : 1, height = whole->view->height;
    for (int y = 0; y < height; y += rows)
        ISO_TRY(draw_strip(call, drawing, whole, y, height - y < rows ? height - y : rows, points, error));
    return ISO_OK;
}

iso_status iso_gl_draw_instances(iso_gl_engine *engine, iso_instance_drawing *drawing,
                                 const iso_target *target, const iso_instances *instances,
                                 iso_instance_counts *counts, iso_error *error) {
    const iso_reconstruction how = instances->reconstruction;
    const size_t samples = (size_t)target->view->width * (size_t)target->view->height,
                 levels = instances->set_count * ISO_LOD_LEVELS;
    iso_instances all = *instances;
    instances_call call = {.engine = engine,
                           .all = &all,
                           .style = {.flat = how != ISO_RECONSTRUCTION_CURVED,
                                     .widened = how == ISO_RECONSTRUCTION_EWA,
                                     .selection = ISO_SELECTION_ALL}};
    const iso_instance_engine by = {draw_part, read_depths, samples / SAMPLES_A_POINT, &call};
    bool colored = all.colors != NULL;
    for (size_t i = 0; i < all.set_count; i++) colored |= all.sets[i].lod->points.colors != NULL;
    if (colored) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    call.planes = ISO_GL_PICTURE_PLANES + colored;
    call.levels = iso_alloc_zero(levels ? levels : 1, sizeof *call.levels);
    if (!call.levels) return iso_fail_memory(error, "instances");
    all.engine = &by;
    *counts = (iso_instance_counts){0};
    const iso_status status = draw_strips(&call, drawing, target, &counts->points, error);
    for (size_t i = 0; i < levels; i++) iso_gl_surface_destroy(call.levels[i]);
    iso_free(call.levels);
    iso_buffer_free(&call.room);
    iso_buffer_free(&call.radii);
    return status;
}
