/* The functions of isopoint.h for surfaces: a volume at an isovalue as points, as a mesh, and in files. */
#include <math.h>
#include <string.h>

#include "api/internal.h"
#include "base/memory.h"
#include "extract/isovalue/isovalue.h"
#include "extract/mesh/mesh_measure.h"
#include "grids/brick_index.h"
#include "io/mesh/mesh_write.h"
#include "io/points_write.h"
#include "scene/bounds.h"
#include "scene/solid.h"

/* The comment in the headers of the files that are written. */
static const char COMMENT[] = "isopoint";

/* ---- creation ---- */

static iso_status check_isovalue(const iso_grid *grid, double isovalue, iso_error *error) {
    if (!isfinite(isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    return iso_isovalue_check(grid, isovalue, error);
}

static iso_status check_primitive(const iso_grid *grid, iso_primitive primitive, iso_error *error) {
    if (primitive < ISO_PRIMITIVE_AUTO || primitive > ISO_PRIMITIVE_FOOT_ITERATED)
        return iso_fail(error, ISO_ERR_USAGE, "there is no primitive %d", (int)primitive);
    if (primitive == ISO_PRIMITIVE_FOOT && !iso_grid_is_level_set(grid))
        return iso_fail(error, ISO_ERR_USAGE, "foot points need a level set");
    return ISO_OK;
}

static iso_status check_opacity(double opacity, iso_error *error) {
    if (opacity >= 0 && opacity <= 1) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "opacity %g is not between 0 and 1", opacity);
}

/* Makes the level set of some labels. */
static iso_status make_labels(iso_surface *surface, const iso_surface_opts *opts, iso_error *error) {
    iso_labels *labels = &surface->labels;
    iso_pool *pool = surface->volume->pool;
    ISO_TRY(iso_labels_make(&surface->volume->volume.grid, pool, NULL, labels, NULL, error));
    uint8_t *group = iso_alloc_zero((size_t)labels->count, 1);
    if (!group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    iso_status status = ISO_OK;
    for (int i = 0; i < opts->label_count && status == ISO_OK; i++) {
        const int place = iso_labels_find(labels, opts->labels[i]);
        if (place > 0)
            group[place] = 1;
        else
            status = iso_fail(error, ISO_ERR_EMPTY, "no voxel has the label %d", opts->labels[i]);
    }
    if (status == ISO_OK) {
        const int first = iso_labels_find(labels, opts->labels[0]);
        iso_labels_join(labels, group, first); /* no borders between them */
        memset(group, 0, (size_t)labels->count);
        group[first] = 1;
        status =
            iso_label_fields_make(labels, group, 1, ISO_LABELS_BAND, pool, &surface->label_fields, error);
    }
    iso_free(group);
    if (status == ISO_OK)
        surface->scene.grid = (iso_grid){.hgrid = iso_label_fields_grid(surface->label_fields, 1)};
    surface->scene.borders = true;
    return status;
}

iso_status iso_surface_create(iso_volume *volume, const iso_surface_opts *opts, iso_surface **surface,
                              iso_error *error) {
    static const iso_surface_opts defaults;
    if (!opts) opts = &defaults;
    ISO_TRY(check_isovalue(&volume->grid, opts->isovalue, error));
    ISO_TRY(check_primitive(&volume->grid, opts->primitive, error));
    if (opts->label_count < 0 || (opts->label_count > 0) != (opts->labels != NULL) ||
        (opts->labels && (opts->isovalue != 0 || opts->primitive)))
        return iso_fail(error, ISO_ERR_USAGE, "labels have no isovalue and no kind of points: %d labels",
                        opts->label_count);
    ISO_TRY(check_opacity(opts->opacity, error));
    iso_surface *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a surface");
    made->volume = iso_api_volume_of(volume);
    made->volume->surfaces++;
    made->pool = made->volume->pool;
    made->scene = (iso_scene_surface){.grid = volume->grid,
                                      .isovalue = opts->isovalue,
                                      .pool = made->pool,
                                      .bounded = true,
                                      .primitive = opts->primitive ? opts->primitive : ISO_PRIMITIVE_EDGE};
    made->opacity = opts->opacity > 0 ? opts->opacity : 1;
    made->has_color = opts->color != NULL;
    if (opts->color) made->color = *opts->color;
    const iso_status status = opts->labels ? make_labels(made, opts, error) : ISO_OK;
    if (status == ISO_OK)
        *surface = made;
    else
        iso_surface_destroy(made);
    return status;
}

void iso_surface_destroy(iso_surface *surface) {
    if (!surface) return;
    if (surface->volume) surface->volume->surfaces--;
    iso_point_set_destroy(surface->points);
    iso_occluders_free(&surface->occluders);
    iso_scene_surface_free(&surface->scene);
    iso_api_cloud_destroy(surface->cloud);
    if (!surface->volume) iso_pool_destroy(surface->pool);
    iso_label_fields_destroy(surface->label_fields);
    iso_labels_free(&surface->labels);
    iso_free(surface);
}

/* Refuses a cloud what only isosurfaces have. */
static iso_status check_volume(const iso_surface *surface, const char *what, iso_error *error) {
    if (!surface->cloud) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "the surface is a cloud of points: %s needs a volume", what);
}

iso_status iso_surface_set_isovalue(iso_surface *surface, double isovalue, iso_error *error) {
    ISO_TRY(check_volume(surface, "an isovalue", error));
    if (surface->label_fields) return iso_fail(error, ISO_ERR_USAGE, "a surface of labels has no isovalue");
    ISO_TRY(check_isovalue(&surface->scene.grid, isovalue, error));
    surface->scene.isovalue = isovalue;
    if (surface->points) iso_point_set_isovalue(surface->points, isovalue);
    return ISO_OK;
}

iso_status iso_surface_set_look(iso_surface *surface, const iso_rgb *color, double opacity,
                                iso_error *error) {
    ISO_TRY(check_opacity(opacity, error));
    surface->opacity = opacity;
    surface->has_color = color != NULL;
    if (color) surface->color = *color;
    if (surface->cloud) iso_api_cloud_hide_colors(surface->cloud, surface->has_color);
    return ISO_OK;
}

iso_status iso_shape_set_set_look(iso_shape_set *set, const iso_rgb *color, double opacity,
                                  iso_error *error) {
    ISO_TRY(check_opacity(opacity, error));
    set->opacity = opacity;
    set->has_color = color != NULL;
    if (color) set->color = *color;
    return ISO_OK;
}

iso_status iso_surface_set_origin(iso_surface *surface, const double origin[3], iso_error *error) {
    if (!iso_vec3_is_finite(iso_vec3_make(origin[0], origin[1], origin[2])))
        return iso_fail(error, ISO_ERR_USAGE, "the origin is not finite");
    memcpy(surface->origin, origin, sizeof surface->origin);
    return ISO_OK;
}

void iso_surface_trim(iso_surface *surface) {
    iso_point_set_destroy(surface->points);
    surface->points = NULL;
    iso_occluders_free(&surface->occluders);
    surface->occluders = (iso_occluders){0};
    if (!surface->cloud) iso_scene_surface_free(&surface->scene);
    iso_memory_trim();
}

/* Begins and ends an operation that the volume's progress function is told of. */
static void begin_watch(const iso_surface *surface) {
    if (surface->volume) iso_api_watch_begin(surface->pool, &surface->volume->watch);
}

static void end_watch(const iso_surface *surface) {
    if (surface->volume) iso_api_watch_end(surface->pool);
}

iso_status iso_api_copy(const void *from, size_t count, size_t size, void *to, iso_error *error) {
    void *copy = NULL;
    if (from) {
        copy = iso_alloc(count * size);
        if (!copy) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a copy of %zu items", count);
        memcpy(copy, from, count * size);
    }
    memcpy(to, &copy, sizeof copy);
    return ISO_OK;
}

/* ---- parts ---- */

iso_status iso_api_surface_ready(iso_surface *surface, iso_error *error) {
    iso_rgrid *grid = surface->scene.grid.rgrid;
    return grid ? iso_brick_index_of(grid, surface->pool, NULL, error) : ISO_OK;
}

static iso_status fail_empty(const iso_surface *surface, iso_error *error) {
    return iso_fail(error, ISO_ERR_EMPTY, "no surface at isovalue %g", surface->scene.isovalue);
}

iso_status iso_api_surface_part(iso_surface *surface, iso_part part, iso_error *error) {
    if (surface->cloud && part == ISO_PART_POINTS) return ISO_OK;
    if (surface->cloud && part == ISO_PART_GROUPS)
        return iso_scene_surface_update(&surface->scene, part, error);
    ISO_TRY(check_volume(surface, "this method", error));
    ISO_TRY(iso_api_surface_ready(surface, error));
    ISO_TRY(iso_scene_surface_update(&surface->scene, part, error));
    const bool counted = part != ISO_PART_CASTER;
    return counted && iso_scene_surface_size(&surface->scene, part).primitives == 0
               ? fail_empty(surface, error)
               : ISO_OK;
}

iso_box iso_api_surface_bounds(const iso_surface *surface, iso_part part) {
    return surface->cloud ? surface->cloud->made.frame : iso_bounds_of_part(&surface->scene, part);
}

iso_status iso_surface_bounds(iso_surface *surface, iso_box *box, iso_error *error) {
    if (surface->cloud) {
        *box = iso_bounds_of_points(&surface->cloud->view);
        return ISO_OK;
    }
    begin_watch(surface);
    const iso_status status = iso_api_surface_part(surface, ISO_PART_CELLS, error);
    end_watch(surface);
    ISO_TRY(status);
    const iso_box found = iso_api_surface_bounds(surface, ISO_PART_CELLS);
    if (iso_box_is_empty(&found)) return fail_empty(surface, error);
    *box = found;
    return ISO_OK;
}

/* ---- points ---- */

/* Extracts the points as floats, because packed points have rounded positions and are for pictures only. */
static iso_status update_points(iso_surface *surface, iso_point_view *view, iso_error *error) {
    const iso_points_opts opts = {.isovalue = surface->scene.isovalue,
                                  .primitive = surface->scene.primitive,
                                  .floats = true,
                                  .pool = surface->pool};
    if (surface->cloud) {
        *view = surface->cloud->view;
        return ISO_OK;
    }
    ISO_TRY(iso_api_surface_ready(surface, error));
    if (!surface->points) ISO_TRY(iso_point_set_create(&surface->scene.grid, &opts, &surface->points, error));
    begin_watch(surface);
    const iso_status status = iso_point_set_update(surface->points, error);
    end_watch(surface);
    ISO_TRY(status);
    *view = iso_point_set_view(surface->points);
    return ISO_OK;
}

static void put(float out[3], iso_vec3 v) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* The map from index coordinates to world coordinates relative to the surface's origin. */
static iso_affine affine_of(const iso_surface *surface, const iso_transform *transform) {
    iso_transform relative = *transform;
    for (int axis = 0; axis < 3; axis++) relative.origin[axis] -= surface->origin[axis];
    return iso_transform_affine(&relative);
}

static void copy_points(const iso_point_view *view, const iso_affine *affine, iso_surface_point *points) {
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_point_span *span = &view->spans[s];
        for (uint32_t i = 0; i < span->count; i++, points++) {
            const iso_surfel surfel = iso_point_view_get(view, span->first + i);
            const float *p = surfel.position, *n = surfel.normal;
            const iso_vec3 index = {span->brick[0] * (double)ISO_BRICK + p[0],
                                    span->brick[1] * (double)ISO_BRICK + p[1],
                                    span->brick[2] * (double)ISO_BRICK + p[2]};
            put(points->position, iso_affine_point(affine, index));
            put(points->normal, iso_affine_normal(affine, iso_vec3_make(n[0], n[1], n[2])));
            points->radius = view->radii ? view->radii[span->first + i] : (float)view->radius;
        }
    }
}

iso_status iso_surface_points(iso_surface *surface, iso_surface_point *points, size_t capacity, size_t *count,
                              iso_error *error) {
    iso_point_view view;
    ISO_TRY(update_points(surface, &view, error));
    *count = iso_point_view_count(&view);
    if (!points) return ISO_OK;
    if (*count > capacity)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu points do not fit where there is room for %zu", *count,
                        capacity);
    const iso_affine affine = affine_of(surface, &view.transform);
    copy_points(&view, &affine, points);
    return ISO_OK;
}

iso_status iso_surface_write_points(iso_surface *surface, const char *path, iso_error *error) {
    iso_point_view view;
    ISO_TRY(iso_api_check_path(path, error));
    ISO_TRY(update_points(surface, &view, error));
    if (iso_point_view_count(&view) == 0) return fail_empty(surface, error);
    if (!surface->cloud) { /* whether the surface is closed */
        ISO_TRY(iso_point_set_bound(surface->points, error));
        view.closed = iso_point_set_view(surface->points).closed;
    }
    return iso_points_write_ply(path, &view, COMMENT, error);
}

/* ---- meshes ---- */

void iso_mesh_free(iso_mesh *mesh) {
    iso_free(mesh->positions);
    iso_free(mesh->normals);
    iso_free(mesh->triangles);
    *mesh = (iso_mesh){0};
}

/* The weld of a surface's mesh, of the surface's grid or of one of its own. */
typedef struct made_mesh {
    iso_weld weld;
    iso_transform transform;
} made_mesh;

static iso_status weld_surface(iso_scene_surface *scene, const iso_solid_mesh_opts *opts, made_mesh *made,
                               iso_error *error) {
    ISO_TRY(iso_scene_surface_update(scene, ISO_PART_MESH, error));
    const iso_mesh_view view = iso_mesh_set_view(scene->mesh);
    made->transform = view.transform;
    return iso_solid_weld(&view, opts, &made->weld, error);
}

/* The same of the solid, closed and perhaps hollow, which is made for it. */
static iso_status weld_solid(iso_surface *surface, const iso_solid_opts *solid,
                             const iso_solid_mesh_opts *opts, made_mesh *made, iso_error *error) {
    iso_scene_surface scene = {.isovalue = surface->scene.isovalue, .pool = surface->pool, .bounded = true};
    iso_status status =
        iso_solid_make(&surface->scene.grid, solid, &scene.isovalue, &scene.grid, NULL, error);
    if (status == ISO_OK) status = weld_surface(&scene, opts, made, error);
    iso_scene_surface_free(&scene);
    iso_grid_destroy(&scene.grid);
    return status;
}

static iso_status check_mesh_opts(const iso_surface_mesh_opts *opts, iso_error *error) {
    static const double most = 1e12; /* mm */
    if (opts->smooth < 0 || opts->smooth > ISO_SMOOTH_MOST)
        return iso_fail(error, ISO_ERR_USAGE, "smooth: %d is not in 0 .. %d", opts->smooth, ISO_SMOOTH_MOST);
    if (!(opts->keep >= 0 && opts->keep < 1))
        return iso_fail(error, ISO_ERR_USAGE, "keep: %g is no share of the triangles below 1", opts->keep);
    const double lengths[] = {opts->deviation, opts->hollow, opts->drain};
    static const char *const names[] = {"deviation", "hollow", "drain"};
    for (int i = 0; i < 3; i++)
        if (!(lengths[i] >= 0 && lengths[i] < most))
            return iso_fail(error, ISO_ERR_USAGE, "%s: %g is no length in mm", names[i], lengths[i]);
    if (opts->keep > 0 && opts->deviation > 0)
        return iso_fail(error, ISO_ERR_USAGE,
                        "triangles are joined until `keep` or `deviation`: give one of them");
    if (opts->drain > 0 && !(opts->hollow > 0))
        return iso_fail(error, ISO_ERR_USAGE, "drain is of what is hollow: it needs `hollow`");
    if (!iso_vec3_is_finite(opts->up)) return iso_fail(error, ISO_ERR_USAGE, "up is not finite");
    if ((opts->keep > 0 || opts->deviation > 0) && !iso_weld_can_decimate())
        return iso_fail(error, ISO_ERR_BACKEND, "built without meshoptimizer, which joins triangles");
    return ISO_OK;
}

/* Makes the mesh; iso_weld_free when done. */
static iso_status weld(iso_surface *surface, const iso_surface_mesh_opts *opts, made_mesh *made,
                       iso_error *error) {
    static const iso_surface_mesh_opts defaults;
    if (!opts) opts = &defaults;
    ISO_TRY(check_volume(surface, "a mesh", error));
    ISO_TRY(check_mesh_opts(opts, error));
    ISO_TRY(iso_api_surface_ready(surface, error));
    const bool upright = iso_vec3_dot(opts->up, opts->up) > 0;
    const iso_hollow_opts how = {.drain = opts->drain,
                                 .up = upright ? iso_vec3_unit(opts->up) : iso_vec3_make(0, 0, 1)};
    const iso_solid_opts solid = {.closed = opts->closed || opts->hollow > 0,
                                  .hollow = opts->hollow,
                                  .how = &how,
                                  .pool = surface->pool};
    const iso_mesh_edits edits = {opts->smooth, opts->keep, opts->deviation};
    const iso_solid_mesh_opts mesh = {.closed = solid.closed, .edits = &edits, .pool = surface->pool};
    begin_watch(surface);
    const iso_status status = solid.closed ? weld_solid(surface, &solid, &mesh, made, error)
                                           : weld_surface(&surface->scene, &mesh, made, error);
    end_watch(surface);
    return status;
}

/* Copies the mesh to world coordinates. If the volume's axes are left-handed, reverses the triangles, so that
 * they are counter-clockwise in the world. */
static void copy_mesh(const iso_weld *welded, const iso_affine *affine, iso_mesh *mesh) {
    const bool turned = affine->determinant < 0;
    for (size_t i = 0; i < welded->vertex_count; i++) {
        const float *p = welded->vertices[i].position, *n = welded->vertices[i].normal;
        put(mesh->positions[i], iso_affine_point(affine, iso_vec3_make(p[0], p[1], p[2])));
        put(mesh->normals[i], iso_affine_normal(affine, iso_vec3_make(n[0], n[1], n[2])));
    }
    for (size_t i = 0; i < welded->triangle_count; i++) {
        const uint32_t *corner = welded->triangles[i];
        mesh->triangles[i][0] = corner[0];
        mesh->triangles[i][1] = corner[turned ? 2 : 1];
        mesh->triangles[i][2] = corner[turned ? 1 : 2];
    }
}

iso_status iso_surface_mesh_with(iso_surface *surface, const iso_surface_mesh_opts *opts, iso_mesh *mesh,
                                 iso_error *error) {
    made_mesh from;
    ISO_TRY(weld(surface, opts, &from, error));
    const iso_weld *welded = &from.weld;
    iso_mesh made = {.positions = iso_alloc(welded->vertex_count * sizeof *made.positions),
                     .normals = iso_alloc(welded->vertex_count * sizeof *made.normals),
                     .triangles = iso_alloc(welded->triangle_count * sizeof *made.triangles),
                     .vertex_count = welded->vertex_count,
                     .triangle_count = welded->triangle_count};
    const bool there = made.positions && made.normals && made.triangles;
    const iso_affine affine = affine_of(surface, &from.transform);
    if (there) copy_mesh(welded, &affine, &made);
    iso_weld_free(&from.weld);
    if (!there) {
        iso_mesh_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a mesh");
    }
    *mesh = made;
    return ISO_OK;
}

iso_status iso_surface_mesh(iso_surface *surface, iso_mesh *mesh, iso_error *error) {
    return iso_surface_mesh_with(surface, NULL, mesh, error);
}

iso_status iso_surface_measure(iso_surface *surface, iso_mesh_measures *measures, iso_error *error) {
    made_mesh made;
    ISO_TRY(weld(surface, NULL, &made, error));
    iso_status status = iso_weld_measure(&made.weld, &made.transform, surface->pool, measures, error);
    iso_weld_free(&made.weld);
    return status;
}

iso_status iso_surface_write_mesh_with(iso_surface *surface, const iso_surface_mesh_opts *opts,
                                       const char *path, iso_error *error) {
    made_mesh made;
    ISO_TRY(iso_api_check_path(path, error));
    ISO_TRY(check_volume(surface, "a mesh", error));
    ISO_TRY(iso_mesh_write_check(path, error));
    ISO_TRY(weld(surface, opts, &made, error));
    const iso_mesh_object object = {.weld = &made.weld,
                                    .transform = &made.transform,
                                    .name = NULL,
                                    .color = surface->has_color ? &surface->color : NULL,
                                    .opacity = surface->opacity};
    const iso_status status = made.weld.triangle_count
                                  ? iso_mesh_write_objects(path, &object, 1, COMMENT, error)
                                  : fail_empty(surface, error);
    iso_weld_free(&made.weld);
    return status;
}

iso_status iso_surface_write_mesh(iso_surface *surface, const char *path, iso_error *error) {
    return iso_surface_write_mesh_with(surface, NULL, path, error);
}
