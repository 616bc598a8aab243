/* The surfaces that a viewport draws from: created when first needed, updated at once or in a background
 * thread. */
#include "apps/isosculpt/viewport/async_surface.h"

#include <math.h>

#include "base/memory.h"

/* A background thread and its work. While it runs, the parts of the viewport that it computes are its own. */
struct isosculpt_async_surface {
    isosculpt_task *task;
    iso_scene_surface surface,
        second;     /* copies of the viewport's, which takes over what has become of them */
    unsigned parts; /* bits 1 << iso_part, or 1 << ISOSCULPT_PART_SECOND */
};

/* ---- one part */

iso_part isosculpt_method_part(iso_method method) {
    const unsigned needs = iso_renderer_get(method)->needs;
    if (needs & 1u << ISO_PART_MESH) return ISO_PART_MESH;
    return needs & 1u << ISO_PART_CELLS ? ISO_PART_CELLS : ISO_PART_POINTS;
}

static iso_part kind_of(int part) {
    return part == ISOSCULPT_PART_SECOND ? ISO_PART_CELLS : (iso_part)part;
}

static iso_scene_surface *surface_of(isosculpt_viewport *viewport, int part) {
    return part == ISOSCULPT_PART_SECOND ? &viewport->second : &viewport->surface;
}

static void count_points(isosculpt_viewport *viewport, int part) {
    if (part == ISO_PART_POINTS) viewport->point_count = iso_point_set_stats(viewport->surface.points).points;
}

static double part_isovalue(const isosculpt_viewport *viewport, int part) {
    return part == ISOSCULPT_PART_SECOND ? viewport->see_through.second_isovalue : viewport->isovalue;
}

bool isosculpt_async_surface_has(const isosculpt_viewport *viewport, int part) {
    const iso_scene_surface *surface = part == ISOSCULPT_PART_SECOND ? &viewport->second : &viewport->surface;
    return viewport->lod && iso_scene_surface_is_at(surface, kind_of(part), part_isovalue(viewport, part));
}

iso_status isosculpt_async_surface_update(isosculpt_viewport *viewport, int part, iso_error *error) {
    if (isosculpt_async_surface_has(viewport, part)) return ISO_OK;
    isosculpt_async_surface_wait(viewport);
    iso_scene_surface *surface = surface_of(viewport, part);
    surface->isovalue = part_isovalue(viewport, part);
    ISO_TRY(iso_scene_surface_update(surface, kind_of(part), error));
    count_points(viewport, part);
    return ISO_OK;
}

/* ---- in a background thread */

static iso_status update_parts(void *context, const iso_progress *progress, iso_error *error) {
    (void)progress;
    isosculpt_async_surface *async = context;
    for (int part = 0; part < ISOSCULPT_PARTS; part++)
        if (async->parts >> part & 1)
            ISO_TRY(iso_scene_surface_update(part == ISOSCULPT_PART_SECOND ? &async->second : &async->surface,
                                             kind_of(part), error));
    return ISO_OK;
}

void isosculpt_async_surface_wait(isosculpt_viewport *viewport) {
    isosculpt_async_surface *async = viewport->async_surface;
    if (!async) return;
    viewport->async_surface = NULL;
    const iso_status status = isosculpt_task_finish(async->task, NULL);
    viewport->surface = async->surface;
    viewport->second = async->second;
    if (iso_scene_surface_is_at(&viewport->surface, ISO_PART_POINTS, async->surface.isovalue))
        count_points(viewport, ISO_PART_POINTS);
    if (status != ISO_OK) {
        viewport->failed_isovalues[0] = async->surface.isovalue;
        viewport->failed_isovalues[1] = async->second.isovalue;
    }
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

iso_status isosculpt_viewport_prepare(isosculpt_viewport *viewport, void (*wake)(void), iso_error *error) {
    if (isosculpt_viewport_is_preparing(viewport) || isosculpt_viewport_is_ready(viewport)) return ISO_OK;
    isosculpt_async_surface *async = iso_alloc_zero(1, sizeof *async);
    if (!async) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a task");
    viewport->surface.isovalue = viewport->isovalue;
    viewport->second.isovalue = viewport->see_through.second_isovalue;
    *async = (isosculpt_async_surface){
        .surface = viewport->surface, .second = viewport->second, .parts = missing_parts(viewport)};
    const iso_status status = isosculpt_task_start(update_parts, async, wake, &async->task, error);
    if (status != ISO_OK) {
        iso_free(async);
        return status;
    }
    viewport->async_surface = async;
    for (int part = 0; part < ISOSCULPT_PARTS; part++)
        if (async->parts >> part & 1) surface_of(viewport, part)->isovalues[kind_of(part)] = NAN;
    return ISO_OK;
}
