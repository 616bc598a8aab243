/* raycast: draws the first crossing of every sample's ray into a gbuffer. The rays are traced by
 * grids/ray/ray_tracer.h. */
#include "truth/raycast.h"

#include <math.h>

#include "base/memory.h"
#include "truth/raycaster.h"

enum { ROWS_PER_TASK = 8 };

static iso_status create(const iso_grid *grid, const iso_spline *spline, double isovalue, iso_pool *pool,
                         iso_raycaster **out, iso_error *error) {
    iso_raycaster *caster = iso_alloc_zero(1, sizeof *caster);
    if (!caster) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the ray caster");
    const double *spacing = iso_grid_transform(grid)->spacing;
    caster->level_set = iso_grid_is_level_set(grid);
    caster->voxel = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    iso_status status =
        spline ? iso_ray_tracer_create_spline(spline, isovalue, NULL, pool, &caster->tracer, error)
               : iso_ray_tracer_create(grid, isovalue, pool, &caster->tracer, error);
    if (status == ISO_OK) status = iso_ray_tracer_refine(caster->tracer, pool, error);
    if (status == ISO_OK)
        *out = caster;
    else
        iso_raycaster_destroy(caster);
    return status;
}

iso_status iso_raycaster_create(const iso_grid *grid, double isovalue, iso_pool *pool, iso_raycaster **caster,
                                iso_error *error) {
    return create(grid, NULL, isovalue, pool, caster, error);
}

iso_status iso_raycaster_create_spline(const iso_spline *spline, double isovalue, iso_pool *pool,
                                       iso_raycaster **caster, iso_error *error) {
    return create(iso_spline_grid(spline), spline, isovalue, pool, caster, error);
}

void iso_raycaster_destroy(iso_raycaster *caster) {
    if (!caster) return;
    iso_ray_tracer_destroy(caster->tracer);
    iso_free(caster);
}

typedef struct cast_context {
    const iso_target *target;
    const iso_ray_tracer *tracer;
} cast_context;

static void cast_sample(const cast_context *cast, int x, int y) {
    const iso_view *view = cast->target->view;
    iso_gbuffer *gbuffer = cast->target->gbuffer;
    iso_vec3 origin, direction;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    iso_ray ray;
    iso_ray_hit hit;
    if (!iso_ray_start(cast->tracer, origin, direction, view->near, &ray)) return;
    do
        if (!iso_ray_next(cast->tracer, &ray, &hit)) return;
    while (!iso_raycast_shows(cast->target->clip, origin, direction, hit.t));
    const size_t sample = (size_t)y * (size_t)gbuffer->width + (size_t)x;
    if (!((float)hit.t < gbuffer->depth[sample])) return;
    const iso_vec3 normal = iso_view_vector(view, iso_ray_hit_normal(cast->tracer, &ray, &hit));
    gbuffer->depth[sample] = (float)hit.t;
    gbuffer->normal[0][sample] = (float)normal.x;
    gbuffer->normal[1][sample] = (float)normal.y;
    gbuffer->normal[2][sample] = (float)normal.z;
    gbuffer->surface[sample] = cast->target->surface;
}

static void cast_rows(void *context, size_t index, int worker) {
    (void)worker;
    const cast_context *cast = context;
    int first = (int)index * ROWS_PER_TASK, end = first + ROWS_PER_TASK;
    if (end > cast->target->gbuffer->height) end = cast->target->gbuffer->height;
    for (int y = first; y < end; y++)
        for (int x = 0; x < cast->target->gbuffer->width; x++) cast_sample(cast, x, y);
}

iso_status iso_draw_raycast(const iso_target *target, const iso_raycaster *caster, iso_error *error) {
    (void)error;
    cast_context cast = {target, caster->tracer};
    size_t bands = ((size_t)target->gbuffer->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    iso_parallel_until(target->pool, bands, cast_rows, &cast);
    return ISO_OK;
}
