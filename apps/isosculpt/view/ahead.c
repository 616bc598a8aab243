#include "apps/isosculpt/view/ahead.h"

#include <math.h>

#include "base/memory.h"

struct isosculpt_ahead {
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

bool isosculpt_ahead_has(const isosculpt_view *view, isosculpt_method method) {
    return view->levels && view->made[slot(method)] == view->isovalue;
}

static iso_status make_set(isosculpt_view *view, isosculpt_method method, iso_error *error) {
    iso_pool *pool = view->levels ? view->ahead_pool : view->pool;
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
    view->made[slot(method)] = isovalue;
    if (slot(method) == ISOSCULPT_POINTS) view->point_count = iso_point_set_stats(view->points).points;
}

iso_status isosculpt_ahead_update(isosculpt_view *view, isosculpt_method method, iso_error *error) {
    if (isosculpt_ahead_has(view, method)) return ISO_OK;
    isosculpt_ahead_wait(view);
    ISO_TRY(make_set(view, method, error));
    view->made[slot(method)] = NAN;
    ISO_TRY(update_set(view, method, view->isovalue, error));
    note_made(view, method, view->isovalue);
    return ISO_OK;
}

/* ---- in a thread */

static iso_status make_all(void *context, const iso_progress *progress, iso_error *error) {
    (void)progress;
    const isosculpt_ahead *ahead = context;
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT; method++)
        if (ahead->methods >> method & 1)
            ISO_TRY(update_set(ahead->view, (isosculpt_method)method, ahead->isovalue, error));
    return ISO_OK;
}

void isosculpt_ahead_wait(isosculpt_view *view) {
    isosculpt_ahead *ahead = view->ahead;
    if (!ahead) return;
    view->ahead = NULL;
    const iso_status status = isosculpt_task_finish(ahead->task, NULL);
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT && status == ISO_OK; method++)
        if (ahead->methods >> method & 1) note_made(view, (isosculpt_method)method, ahead->isovalue);
    if (status != ISO_OK) view->unmade = ahead->isovalue;
    iso_free(ahead);
}

/* What the picture at rest needs, what stands in for it while OpenGL moves it, and points, to be counted. */
static unsigned wanted(const isosculpt_view *view) {
    const bool stands_in = view->look.engine == ISOSCULPT_GL && view->look.method == ISOSCULPT_EXACT;
    return 1u << slot(view->look.method) | 1u << ISOSCULPT_POINTS | (stands_in ? 1u << ISOSCULPT_MESH : 0u);
}

static unsigned missing(const isosculpt_view *view) {
    unsigned methods = wanted(view);
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT; method++)
        if (isosculpt_ahead_has(view, (isosculpt_method)method)) methods &= ~(1u << method);
    return methods;
}

bool isosculpt_view_is_preparing(const isosculpt_view *view) {
    return view->ahead && !isosculpt_task_done(view->ahead->task);
}

bool isosculpt_view_is_ready(isosculpt_view *view) {
    if (isosculpt_view_is_preparing(view)) return false;
    isosculpt_ahead_wait(view);
    return !view->levels || view->unmade == view->isovalue || !missing(view);
}

static iso_status begin(isosculpt_view *view, isosculpt_ahead *ahead, void (*wake)(void), iso_error *error) {
    for (int method = 0; method < ISOSCULPT_METHOD_COUNT; method++)
        if (ahead->methods >> method & 1) {
            ISO_TRY(make_set(view, (isosculpt_method)method, error));
            view->made[method] = NAN;
        }
    return isosculpt_task_start(make_all, ahead, wake, &ahead->task, error);
}

iso_status isosculpt_view_prepare(isosculpt_view *view, void (*wake)(void), iso_error *error) {
    if (isosculpt_view_is_preparing(view) || isosculpt_view_is_ready(view)) return ISO_OK;
    isosculpt_ahead *ahead = iso_alloc_zero(1, sizeof *ahead);
    if (!ahead) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a task");
    *ahead = (isosculpt_ahead){.view = view, .isovalue = view->isovalue, .methods = missing(view)};
    iso_status status = begin(view, ahead, wake, error);
    if (status == ISO_OK)
        view->ahead = ahead;
    else
        iso_free(ahead);
    return status;
}
