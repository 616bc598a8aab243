/* The surfaces that a viewport draws from: created when first needed, updated at once or in a background
 * thread. */
#include "apps/isosculpt/viewport/async_surface.h"

#include <math.h>

#include "base/memory.h"

/* A background thread and its work. While it runs, the parts of the viewport that it makes are its own. */
struct isosculpt_async_surface {
    isosculpt_task *task;
    isosculpt_viewport *viewport;
    double isovalues[ISOSCULPT_PARTS];
    unsigned parts; /* bits 1 << iso_part, or 1 << ISOSCULPT_PART_SECOND */
};

/* ---- one part */

iso_part isosculpt_method_part(iso_method method) {
    const unsigned needs = iso_renderer_get(method)->needs;
    if (needs & 1u << ISO_PART_MESH) return ISO_PART_MESH;
    return needs & 1u << ISO_PART_CELLS ? ISO_PART_CELLS : ISO_PART_POINTS;
}

static double part_isovalue(const isosculpt_viewport *viewport, int part) {
    return part == ISOSCULPT_PART_SECOND ? viewport->see_through.second_isovalue : viewport->isovalue;
}

bool isosculpt_async_surface_has(const isosculpt_viewport *viewport, int part) {
    return viewport->lod && viewport->surface_isovalues[part] == part_isovalue(viewport, part);
}

static iso_status create_part(isosculpt_viewport *viewport, int part, iso_error *error) {
    iso_pool *pool = viewport->lod ? viewport->async_surface_pool : viewport->pool;
    const double isovalue = part_isovalue(viewport, part);
    const iso_points_opts points = {.isovalue = isovalue, .pool = pool};
    const iso_mesh_opts mesh = {.isovalue = isovalue, .pool = pool};
    const iso_exact_opts exact = {.isovalue = isovalue, .pool = pool};
    if (part == ISO_PART_POINTS && !viewport->points)
        return iso_point_set_create(&viewport->grid, &points, &viewport->points, error);
    if (part == ISO_PART_MESH && !viewport->mesh)
        return iso_mesh_set_create(&viewport->grid, &mesh, &viewport->mesh, error);
    if (part == ISO_PART_CELLS && !viewport->exact)
        return iso_exact_create(&viewport->grid, &exact, &viewport->exact, error);
    if (part == ISOSCULPT_PART_SECOND && !viewport->second)
        return iso_exact_create(&viewport->grid, &exact, &viewport->second, error);
    return ISO_OK;
}

static iso_status update_part(const isosculpt_viewport *viewport, int part, double isovalue,
                              iso_error *error) {
    if (part == ISO_PART_MESH) {
        iso_mesh_set_isovalue(viewport->mesh, isovalue);
        return iso_mesh_set_update(viewport->mesh, error);
    }
    if (part == ISO_PART_CELLS || part == ISOSCULPT_PART_SECOND) {
        iso_exact *exact = part == ISO_PART_CELLS ? viewport->exact : viewport->second;
        iso_exact_set_isovalue(exact, isovalue);
        return iso_exact_update(exact, error);
    }
    iso_point_set_isovalue(viewport->points, isovalue);
    return iso_point_set_update(viewport->points, error);
}

static void record_part(isosculpt_viewport *viewport, int part, double isovalue) {
    viewport->surface_isovalues[part] = isovalue;
    if (part == ISO_PART_POINTS) viewport->point_count = iso_point_set_stats(viewport->points).points;
}

iso_status isosculpt_async_surface_update(isosculpt_viewport *viewport, int part, iso_error *error) {
    const double isovalue = part_isovalue(viewport, part);
    if (isosculpt_async_surface_has(viewport, part)) return ISO_OK;
    isosculpt_async_surface_wait(viewport);
    ISO_TRY(create_part(viewport, part, error));
    viewport->surface_isovalues[part] = NAN;
    ISO_TRY(update_part(viewport, part, isovalue, error));
    record_part(viewport, part, isovalue);
    return ISO_OK;
}

/* ---- in a background thread */

static iso_status update_parts(void *context, const iso_progress *progress, iso_error *error) {
    (void)progress;
    const isosculpt_async_surface *async = context;
    for (int part = 0; part < ISOSCULPT_PARTS; part++)
        if (async->parts >> part & 1)
            ISO_TRY(update_part(async->viewport, part, async->isovalues[part], error));
    return ISO_OK;
}

void isosculpt_async_surface_wait(isosculpt_viewport *viewport) {
    isosculpt_async_surface *async = viewport->async_surface;
    if (!async) return;
    viewport->async_surface = NULL;
    const iso_status status = isosculpt_task_finish(async->task, NULL);
    for (int part = 0; part < ISOSCULPT_PARTS && status == ISO_OK; part++)
        if (async->parts >> part & 1) record_part(viewport, part, async->isovalues[part]);
    for (int i = 0; i < 2 && status != ISO_OK; i++)
        viewport->failed_isovalues[i] = async->isovalues[i ? ISOSCULPT_PART_SECOND : ISO_PART_CELLS];
    iso_free(async);
}

/* The parts that are needed soon: of the picture at rest, of the mesh that OpenGL draws instead of exact
 * while the camera moves, and the points, whose number the panel shows. */
static unsigned needed_parts(const isosculpt_viewport *viewport) {
    const iso_method method = isosculpt_viewport_method(viewport);
    const bool moves_as_mesh = viewport->mode.engine == ISOSCULPT_ENGINE_GL && method == ISO_METHOD_EXACT &&
                               !isosculpt_viewport_is_see_through(viewport);
    return 1u << isosculpt_method_part(method) | 1u << ISO_PART_POINTS |
           (moves_as_mesh ? 1u << ISO_PART_MESH : 0u) |
           (isosculpt_viewport_has_second(viewport) ? 1u << ISOSCULPT_PART_SECOND : 0u);
}

static unsigned missing_parts(const isosculpt_viewport *viewport) {
    unsigned parts = needed_parts(viewport);
    for (int part = 0; part < ISOSCULPT_PARTS; part++)
        if (isosculpt_async_surface_has(viewport, part)) parts &= ~(1u << part);
    return parts;
}

/* Whether the background thread has failed at the isovalues of the picture. */
static bool has_failed(const isosculpt_viewport *viewport) {
    return viewport->failed_isovalues[0] == viewport->isovalue &&
           (!isosculpt_viewport_has_second(viewport) ||
            viewport->failed_isovalues[1] == viewport->see_through.second_isovalue);
}

bool isosculpt_viewport_is_preparing(const isosculpt_viewport *viewport) {
    return viewport->async_surface && !isosculpt_task_done(viewport->async_surface->task);
}

bool isosculpt_viewport_is_ready(isosculpt_viewport *viewport) {
    if (isosculpt_viewport_is_preparing(viewport)) return false;
    isosculpt_async_surface_wait(viewport);
    return !viewport->lod || has_failed(viewport) || !missing_parts(viewport);
}

static iso_status start_update(isosculpt_viewport *viewport, isosculpt_async_surface *async,
                               void (*wake)(void), iso_error *error) {
    for (int part = 0; part < ISOSCULPT_PARTS; part++)
        if (async->parts >> part & 1) {
            ISO_TRY(create_part(viewport, part, error));
            viewport->surface_isovalues[part] = NAN;
        }
    return isosculpt_task_start(update_parts, async, wake, &async->task, error);
}

iso_status isosculpt_viewport_prepare(isosculpt_viewport *viewport, void (*wake)(void), iso_error *error) {
    if (isosculpt_viewport_is_preparing(viewport) || isosculpt_viewport_is_ready(viewport)) return ISO_OK;
    isosculpt_async_surface *async = iso_alloc_zero(1, sizeof *async);
    if (!async) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a task");
    *async = (isosculpt_async_surface){.viewport = viewport, .parts = missing_parts(viewport)};
    for (int part = 0; part < ISOSCULPT_PARTS; part++) async->isovalues[part] = part_isovalue(viewport, part);
    iso_status status = start_update(viewport, async, wake, error);
    if (status == ISO_OK)
        viewport->async_surface = async;
    else
        iso_free(async);
    return status;
}
