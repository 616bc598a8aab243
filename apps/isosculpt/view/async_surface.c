#include "apps/isosculpt/view/async_surface.h"

#include <math.h>

#include "base/memory.h"

struct isosculpt_async_surface {
    isosculpt_task *task;
    isosculpt_view *view; /* whose sets are the thread's meanwhile */
    double isovalue;
    unsigned methods; /* a bit each */
};

/* ---- one surface */

/* Both draw points. */
static int slot(isosculpt_method method) {
    return method == ISOSCULPT_PULLPUSH ? ISOSCULPT_POINTS : (int)method;
}

bool isosculpt_async_surface_has(const isosculpt_view *view, isosculpt_method method) {
    return view->levels && view->surface_isovalue[slot(method)] == view->isovalue;
}

static iso_status make_set(isosculpt_view *view, isosculpt_method method, iso_error *error) {
    iso_pool *pool = view->levels ? view->async_surface_pool : view->pool;
    iso_points_opts points = {.isovalue = view->isovalue, .pool = pool};
    iso_mesh_opts mesh = {.isovalue = view->isovalue, .pool = pool};
    iso_exact_opts exact = {.isovalue = view->isovalue, .pool = pool};
    if (slot(method) == ISOSCULPT_POINTS && !view->points)
        return iso_point_set_create(&view->grid, &points, &view->points, error);
    if (method == ISOSCULPT_MESH && !view->mesh)
        return iso_mesh_set_create(&view->grid, &mesh, &view->mesh, error);
    if (method == ISOSCULPT_EXACT && !view->exact)
        return iso_exact_create(&view->grid, &exact, &view->exact, error);
    return ISO_OK;
}

static iso_status update_set(const isosculpt_view *view, isosculpt_method method, double isovalue,
                             iso_error *error) {
    if (method == ISOSCULPT_MESH) {
        iso_mesh_set_isovalue(view->mesh, isovalue);
        return iso_mesh_set_update(view->mesh, error);
    }
    if (method == ISOSCULPT_EXACT) {
        iso_exact_isovalue(view->exact, isovalue);
        return iso_exact_update(view->exact, error);
    }
    iso_point_set_isovalue(view->points, isovalue);
    return iso_point_set_update(view->points, error);
}

static void note_made(isosculpt_view *view, isosculpt_method method, double isovalue) {
    view->surface_isovalue[slot(method)] = isovalue;
    if (slot(method) == ISOSCULPT_POINTS) view->point_count = iso_point_set_stats(view->points).points;
}

iso_status isosculpt_async_surface_update(isosculpt_view *view, isosculpt_method method, iso_error *error) {
    if (isosculpt_async_surface_has(view, method)) return ISO_OK;
    isosculpt_async_surface_wait(view);
    ISO_TRY(make_set(view, method, error));
    view->surface_isovalue[slot(method)] = NAN;
    ISO_TRY(update_set(view, method, view->isovalue, error));
    note_made(view, method, view->isovalue);
    return ISO_OK;
}

/* ---- in a thread */

static iso_status make_all(void *context, const iso_progress *progress, iso_error *error) {
    (void)progress;
    const isosculpt_async_surface *async_surface = context;
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT; method++)
        if (async_surface->methods >> method & 1)
            ISO_TRY(
                update_set(async_surface->view, (isosculpt_method)method, async_surface->isovalue, error));
    return ISO_OK;
}

void isosculpt_async_surface_wait(isosculpt_view *view) {
    isosculpt_async_surface *async_surface = view->async_surface;
    if (!async_surface) return;
    view->async_surface = NULL;
    const iso_status status = isosculpt_task_finish(async_surface->task, NULL);
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT && status == ISO_OK; method++)
        if (async_surface->methods >> method & 1)
            note_made(view, (isosculpt_method)method, async_surface->isovalue);
    if (status != ISO_OK) view->failed_isovalue = async_surface->isovalue;
    iso_free(async_surface);
}

/* What the picture at rest needs, what stands in for it while OpenGL moves it, and points, to be counted. */
static unsigned wanted(const isosculpt_view *view) {
    const bool stands_in = view->mode.engine == ISOSCULPT_GL && view->mode.method == ISOSCULPT_EXACT;
    return 1u << slot(view->mode.method) | 1u << ISOSCULPT_POINTS | (stands_in ? 1u << ISOSCULPT_MESH : 0u);
}

static unsigned missing(const isosculpt_view *view) {
    unsigned methods = wanted(view);
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT; method++)
        if (isosculpt_async_surface_has(view, (isosculpt_method)method)) methods &= ~(1u << method);
    return methods;
}

bool isosculpt_view_is_preparing(const isosculpt_view *view) {
    return view->async_surface && !isosculpt_task_done(view->async_surface->task);
}

bool isosculpt_view_is_ready(isosculpt_view *view) {
    if (isosculpt_view_is_preparing(view)) return false;
    isosculpt_async_surface_wait(view);
    return !view->levels || view->failed_isovalue == view->isovalue || !missing(view);
}

static iso_status begin(isosculpt_view *view, isosculpt_async_surface *async_surface, void (*wake)(void),
                        iso_error *error) {
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT; method++)
        if (async_surface->methods >> method & 1) {
            ISO_TRY(make_set(view, (isosculpt_method)method, error));
            view->surface_isovalue[method] = NAN;
        }
    return isosculpt_task_start(make_all, async_surface, wake, &async_surface->task, error);
}

iso_status isosculpt_view_prepare(isosculpt_view *view, void (*wake)(void), iso_error *error) {
    if (isosculpt_view_is_preparing(view) || isosculpt_view_is_ready(view)) return ISO_OK;
    isosculpt_async_surface *async_surface = iso_alloc_zero(1, sizeof *async_surface);
    if (!async_surface) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a task");
    *async_surface =
        (isosculpt_async_surface){.view = view, .isovalue = view->isovalue, .methods = missing(view)};
    iso_status status = begin(view, async_surface, wake, error);
    if (status == ISO_OK)
        view->async_surface = async_surface;
    else
        iso_free(async_surface);
    return status;
}
