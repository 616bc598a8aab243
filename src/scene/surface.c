/* surface: computes the parts of surfaces. */
#include "scene/surface.h"

#include <assert.h>
#include <math.h>

#include "base/memory.h"
#include "grids/change_log.h"
#include "render/groups/copies.h"
#include "render/groups/coverage.h"
#include "render/groups/disc_layers.h"

static iso_status make_points(iso_scene_surface *surface, iso_error *error) {
    if (!surface->workspace && !surface->own_workspace)
        ISO_TRY(iso_point_workspace_create(&surface->own_workspace, error));
    const iso_points_opts opts = {.isovalue = surface->isovalue,
                                  .primitive = surface->primitive ? surface->primitive : ISO_PRIMITIVE_EDGE,
                                  .floats = surface->floats,
                                  .curvature = !surface->flat,
                                  .pool = surface->pool};
    return iso_point_set_create(&surface->grid, &opts, &surface->points, error);
}

static iso_status update_points(iso_scene_surface *surface, iso_error *error) {
    if (!surface->points) ISO_TRY(make_points(surface, error));
    ISO_TRY(iso_point_set_update(surface->points, error));
    return surface->bounded ? iso_point_set_bound(surface->points, error) : ISO_OK;
}

static iso_status update_mesh(iso_scene_surface *surface, iso_error *error) {
    iso_mesh_opts opts = {.isovalue = surface->isovalue, .pool = surface->pool};
    if (!surface->mesh) ISO_TRY(iso_mesh_set_create(&surface->grid, &opts, &surface->mesh, error));
    return iso_mesh_set_update(surface->mesh, error);
}

static void free_refined(iso_scene_surface *surface) {
    if (!surface->refined) return;
    iso_exact_destroy(surface->exact);
    surface->exact = NULL;
    iso_hgrid_destroy(surface->refined);
    iso_ray_tracer_destroy(surface->tracer);
    surface->tracer = NULL;
    surface->refined = NULL;
}

static void free_caster(iso_scene_surface *surface) {
    iso_raycaster_destroy(surface->caster);
    surface->caster = NULL;
}

static void free_spline(iso_scene_surface *surface) {
    if (!surface->spline) return;
    free_refined(surface);
    free_caster(surface);
    iso_spline_destroy(surface->spline);
    surface->spline = NULL;
}

/* Makes the spline of the grid as it is, or frees it where the surface is trilinear. */
static iso_status update_spline(iso_scene_surface *surface, iso_error *error) {
    const uint64_t now = iso_change_log_now(iso_grid_log(&surface->grid));
    if (surface->splined != surface->filter) {
        free_spline(surface);
        free_caster(surface);
        iso_exact_destroy(surface->exact);
        surface->exact = NULL;
        surface->splined = surface->filter;
    }
    if (surface->spline && surface->spline_edit != now) free_spline(surface);
    if (surface->filter == ISO_FILTER_LINEAR || surface->spline) return ISO_OK;
    surface->spline_edit = now;
    return iso_spline_create(&surface->grid, surface->filter, surface->pool, &surface->spline, error);
}

static iso_status update_cells(iso_scene_surface *surface, iso_error *error) {
    iso_exact_opts opts = {.isovalue = surface->isovalue, .pool = surface->pool};
    ISO_TRY(update_spline(surface, error));
    if (!surface->spline) {
        if (!surface->exact) ISO_TRY(iso_exact_create(&surface->grid, &opts, &surface->exact, error));
        return iso_exact_update(surface->exact, error);
    }
    if (surface->exact && surface->refined && surface->refined_for == surface->isovalue &&
        surface->refined_layered == surface->layered)
        return ISO_OK;
    free_refined(surface);
    surface->refined_for = surface->isovalue;
    surface->refined_layered = surface->layered;
    ISO_TRY(iso_spline_refine(surface->spline, iso_grid_stored(&surface->grid, surface->isovalue),
                              !surface->layered, surface->pool, &surface->refined, error));
    if (!surface->layered)
        ISO_TRY(iso_ray_tracer_create_spline(surface->spline, surface->isovalue, surface->refined,
                                             surface->pool, &surface->tracer, error));
    opts.isovalue = 0;
    opts.cell_side = 0.5;
    const iso_grid grid = {NULL, surface->refined};
    ISO_TRY(iso_exact_create(&grid, &opts, &surface->exact, error));
    return iso_exact_update(surface->exact, error);
}

/* Creates the ray caster again, because it does not follow edits. */
static iso_status update_caster(iso_scene_surface *surface, iso_error *error) {
    const uint64_t now = iso_change_log_now(iso_grid_log(&surface->grid));
    ISO_TRY(update_spline(surface, error));
    if (surface->caster && surface->caster_edit == now) return ISO_OK;
    free_caster(surface);
    surface->caster_edit = now;
    if (surface->spline)
        return iso_raycaster_create_spline(surface->spline, surface->isovalue, surface->pool,
                                           &surface->caster, error);
    return iso_raycaster_create(&surface->grid, surface->isovalue, surface->pool, &surface->caster, error);
}

static iso_status update_groups(iso_scene_surface *surface, iso_error *error) {
    const uint64_t now = surface->given ? 0 : iso_change_log_now(iso_grid_log(&surface->grid));
    const bool sorted = surface->transparency == ISO_TRANSPARENCY_SORTED;
    if (surface->grouped_for != surface->transparency) iso_groups_free(&surface->groups);
    if (surface->groups.group && surface->groups_edit == now) return ISO_OK;
    if (!surface->points && !surface->given) ISO_TRY(update_points(surface, error));
    surface->groups_edit = now;
    surface->grouped_for = surface->transparency;
    const iso_point_view view = iso_scene_surface_points(surface);
    const iso_grouping *given = &surface->grouping;
    iso_groups_opts opts =
        sorted ? iso_groups_default_opts(surface->pool) : iso_splat_layers_grouping(surface->pool);
    if (given->limit) opts.limit = given->limit;
    opts.overlap = given->overlap;
    opts.ignore_opposite = given->ignore_opposite;
    opts.coplanar = given->coplanar;
    ISO_TRY(surface->given || given->once ? iso_groups_make(&view, &opts, &surface->groups, error)
                                          : iso_groups_update(&view, &opts, &surface->groups, error));
    if (sorted || given->radii == ISO_GROUP_RADII_ROOT) return ISO_OK;
    const iso_status status =
        given->radii == ISO_GROUP_RADII_COPIES
            ? iso_groups_copy(&view, opts.disc, surface->pool, &surface->groups, error)
            : iso_groups_cover(&view, opts.disc, surface->pool, &surface->groups, error);
    if (status != ISO_OK) iso_groups_free(&surface->groups); /* they are made again */
    return status;
}

static iso_status update_part(iso_scene_surface *surface, iso_part part, iso_error *error) {
    switch (part) {
    case ISO_PART_POINTS:
        return update_points(surface, error);
    case ISO_PART_MESH:
        return update_mesh(surface, error);
    case ISO_PART_CELLS:
        return update_cells(surface, error);
    case ISO_PART_CASTER:
        return update_caster(surface, error);
    case ISO_PART_GROUPS:
        return update_groups(surface, error);
    case ISO_PART_COUNT:
        break;
    }
    assert(!"a part");
    return ISO_OK;
}

/* Tells a part its isovalue, which its update follows. The parts that cannot follow it are freed. */
static void set_isovalue(iso_scene_surface *surface, iso_part part, double isovalue) {
    if (part == ISO_PART_POINTS && surface->points) iso_point_set_isovalue(surface->points, isovalue);
    if (part == ISO_PART_MESH && surface->mesh) iso_mesh_set_isovalue(surface->mesh, isovalue);
    if (part == ISO_PART_CELLS && surface->exact && !surface->refined)
        iso_exact_set_isovalue(surface->exact, isovalue);
    if (part == ISO_PART_GROUPS) iso_groups_free(&surface->groups);
    if (part == ISO_PART_CASTER) free_caster(surface);
}

iso_status iso_scene_surface_update(iso_scene_surface *surface, iso_part part, iso_error *error) {
    const double isovalue = surface->isovalue;
    if (surface->isovalues[part] != isovalue) set_isovalue(surface, part, isovalue);
    surface->isovalues[part] = NAN;
    ISO_TRY(update_part(surface, part, error));
    surface->isovalues[part] = isovalue;
    return ISO_OK;
}

typedef struct smoothing {
    const iso_scene_surface *surface;
    double isovalue; /* stored */
    double outward;
    iso_surfel *surfels; /* of the set, which nobody else has while they are moved */
    const iso_mesh_span *mesh;
    const iso_point_span *points;
} smoothing;

static void smooth_span(void *context, size_t index, int worker) {
    (void)worker;
    const smoothing *s = context;
    const int32_t *brick = s->mesh ? s->mesh[index].brick : s->points[index].brick;
    const size_t first = s->mesh ? s->mesh[index].first_vertex : s->points[index].first,
                 count = s->mesh ? s->mesh[index].vertex_count : s->points[index].count;
    for (size_t k = first; k < first + count; k++) {
        iso_surfel *surfel = &s->surfels[k];
        const iso_vec3 at = iso_brick_position(brick, surfel->position);
        double p[3] = {at.x, at.y, at.z};
        const iso_vec3 n =
            iso_vec3_unit(iso_vec3_scale(iso_spline_project(s->surface->spline, s->isovalue, p), s->outward));
        for (int i = 0; i < 3; i++) surfel->position[i] = (float)(p[i] - (double)ISO_BRICK * brick[i]);
        if (!(iso_vec3_dot(n, n) > 0)) continue;
        surfel->normal[0] = (float)n.x;
        surfel->normal[1] = (float)n.y;
        surfel->normal[2] = (float)n.z;
    }
}

iso_status iso_scene_surface_smooth(iso_scene_surface *surface, iso_part part, iso_error *error) {
    ISO_TRY(update_spline(surface, error));
    smoothing s = {.surface = surface,
                   .isovalue = iso_grid_stored(&surface->grid, surface->isovalue),
                   .outward = iso_grid_is_level_set(&surface->grid) ? 1 : -1};
    const iso_mesh_view mesh = part == ISO_PART_MESH ? iso_mesh_set_view(surface->mesh) : (iso_mesh_view){0};
    const iso_point_view points =
        part == ISO_PART_MESH ? (iso_point_view){0} : iso_point_set_view(surface->points);
    s.mesh = mesh.spans;
    s.points = points.spans;
    s.surfels = (iso_surfel *)(part == ISO_PART_MESH ? mesh.vertices : points.surfels);
    iso_parallel_until(surface->pool, part == ISO_PART_MESH ? mesh.span_count : points.span_count,
                       smooth_span, &s);
    return iso_pool_check(surface->pool, "the smooth surface", error);
}

bool iso_scene_surface_is_at(const iso_scene_surface *surface, iso_part part, double isovalue) {
    return iso_scene_surface_has(surface, part) && surface->isovalues[part] == isovalue;
}

iso_status iso_scene_surface_make_levels(iso_scene_surface *surface, iso_error *error) {
    const iso_point_view points = iso_scene_surface_points(surface);
    if (!surface->cut) surface->cut = iso_alloc_zero(1, sizeof *surface->cut);
    if (!surface->cut) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for levels of detail");
    return iso_lod_update(&surface->lod, &points, surface->pool, error);
}

bool iso_scene_surface_has(const iso_scene_surface *surface, iso_part part) {
    const void *parts[] = {surface->points, surface->mesh, surface->exact, surface->caster,
                           surface->groups.group};
    return parts[part] != NULL;
}

iso_status iso_scene_surface_prepare(iso_scene_surface *surface, iso_part part, iso_error *error) {
    return iso_scene_surface_has(surface, part) ? ISO_OK : iso_scene_surface_update(surface, part, error);
}

void iso_scene_surface_free(iso_scene_surface *surface) {
    iso_point_set_destroy(surface->points);
    iso_point_workspace_destroy(surface->own_workspace);
    iso_mesh_set_destroy(surface->mesh);
    free_spline(surface);
    iso_exact_destroy(surface->exact);
    free_caster(surface);
    iso_groups_free(&surface->groups);
    iso_lod_free(&surface->lod);
    if (surface->cut) iso_lod_cut_free(surface->cut);
    iso_free(surface->cut);
    surface->points = NULL;
    surface->own_workspace = NULL;
    surface->mesh = NULL;
    surface->exact = NULL;
    surface->cut = NULL;
}

const char *iso_part_name(iso_part part) {
    static const char *const names[] = {"points", "mesh", "cells", "ray caster's index", "groups"};
    return names[part];
}

static iso_part_size points_size(const iso_point_view *view) {
    size_t count = iso_point_view_count(view);
    size_t each =
        (view->surfels ? sizeof(iso_surfel) : sizeof(iso_point)) + (view->radii ? sizeof(float) : 0);
    return (iso_part_size){count, count * each + view->span_count * sizeof *view->spans};
}

static iso_part_size mesh_size(const iso_mesh_view *view) {
    size_t triangles = iso_mesh_view_triangle_count(view), vertices = 0;
    for (size_t s = 0; s < view->span_count; s++) vertices += view->spans[s].vertex_count;
    return (iso_part_size){triangles, triangles * sizeof *view->triangles +
                                          vertices * sizeof *view->vertices +
                                          view->span_count * sizeof *view->spans};
}

iso_part_size iso_scene_surface_size(const iso_scene_surface *surface, iso_part part) {
    if (part == ISO_PART_POINTS && surface->points) {
        iso_point_view view = iso_point_set_view(surface->points);
        return points_size(&view);
    }
    if (part == ISO_PART_MESH && surface->mesh) {
        iso_mesh_view view = iso_mesh_set_view(surface->mesh);
        return mesh_size(&view);
    }
    if (part == ISO_PART_GROUPS && surface->groups.group) {
        iso_point_view view = iso_scene_surface_points(surface);
        return (iso_part_size){(size_t)surface->groups.count,
                               iso_point_view_count(&view) + iso_groups_memory_bytes(&surface->groups)};
    }
    if (part == ISO_PART_CELLS && surface->exact) {
        iso_exact_totals totals = iso_exact_stats(surface->exact);
        return (iso_part_size){totals.cells, totals.bytes};
    }
    return (iso_part_size){0, 0};
}

iso_point_view iso_scene_surface_points(const iso_scene_surface *surface) {
    return surface->given ? *surface->given : iso_point_set_view(surface->points);
}
