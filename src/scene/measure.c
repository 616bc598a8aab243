/* Measures solids by their meshes, and places of surfaces by rays. */
#include "scene/measure.h"

#include <math.h>

#include "extract/mesh/mesh.h"
#include "extract/mesh/mesh_measure.h"
#include "grids/parts/closed.h"
#include "grids/ray/ray_tracer.h"

/* ---- the whole solid */

typedef struct solid_mesh {
    iso_mesh_set *set;
    iso_weld weld;
} solid_mesh;

static void free_mesh(solid_mesh *mesh) {
    iso_weld_free(&mesh->weld);
    iso_mesh_set_destroy(mesh->set);
    *mesh = (solid_mesh){.set = NULL};
}

static iso_status make_mesh(const iso_grid *grid, iso_pool *pool, solid_mesh *mesh, iso_error *error) {
    const iso_mesh_opts opts = {.pool = pool};
    *mesh = (solid_mesh){.set = NULL};
    ISO_TRY(iso_mesh_set_create(grid, &opts, &mesh->set, error));
    iso_status status = iso_mesh_set_update(mesh->set, error);
    const iso_mesh_view view = iso_mesh_set_view(mesh->set);
    if (status == ISO_OK && iso_mesh_view_triangle_count(&view) == 0)
        status = iso_fail(error, ISO_ERR_EMPTY, "there is no surface to measure");
    if (status == ISO_OK) status = iso_mesh_weld(&view, NULL, &mesh->weld, error);
    if (status != ISO_OK) free_mesh(mesh);
    return status;
}

static iso_vec3 vertex_of(const solid_mesh *mesh, size_t i) {
    const float *p = mesh->weld.vertices[i].position;
    return iso_vec3_make((double)p[0], (double)p[1], (double)p[2]);
}

static iso_status measure_mesh(const iso_grid *grid, iso_pool *pool, iso_mesh_measures *measures,
                               iso_box *box, iso_error *error) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    solid_mesh mesh;
    ISO_TRY(make_mesh(grid, pool, &mesh, error));
    *box = iso_box_empty();
    for (size_t i = 0; i < mesh.weld.vertex_count; i++)
        iso_box_add(box, iso_affine_point(&affine, vertex_of(&mesh, i)));
    const iso_status status = iso_weld_measure(&mesh.weld, iso_grid_transform(grid), pool, measures, error);
    free_mesh(&mesh);
    return status;
}

iso_status iso_measure_solid(const iso_grid *grid, iso_pool *pool, iso_solid_measures *measures,
                             iso_error *error) {
    iso_mesh_measures made;
    iso_grid closed;
    iso_box box;
    ISO_TRY(measure_mesh(grid, pool, &made, &box, error));
    if (made.open_edges) {
        ISO_TRY(iso_grid_close(grid, 0, pool, &closed, error));
        const iso_status status = measure_mesh(&closed, pool, &made, &box, error);
        iso_grid_destroy(&closed);
        ISO_TRY(status);
    }
    *measures =
        (iso_solid_measures){.volume = made.volume, .area = made.area, .box = box, .pieces = made.pieces};
    return ISO_OK;
}

/* ---- places; in index coordinates */

/* Moves a point along the gradient to where the level set is 0. */
static iso_vec3 to_surface(const iso_grid *grid, iso_vec3 p) {
    enum { STEPS = 12 };
    for (int i = 0; i < STEPS; i++) {
        const iso_vec3 gradient = iso_grid_gradient(grid, p);
        const double square = iso_vec3_dot(gradient, gradient), value = iso_grid_sample(grid, p);
        if (!(square > 1e-6)) break;
        p = iso_vec3_sub(p, iso_vec3_scale(gradient, fmax(-1, fmin(1, value / square))));
    }
    return p;
}

/* Moves a place along the surface while it comes nearer to `near`. */
static iso_vec3 slide(const iso_grid *grid, iso_vec3 at, iso_vec3 near) {
    enum { STEPS = 200 };
    double reach = 0.5; /* voxels */
    for (int i = 0; i < STEPS && reach > 1e-4; i++) {
        const iso_vec3 normal = iso_vec3_unit(iso_grid_gradient(grid, at)), way = iso_vec3_sub(near, at);
        const iso_vec3 along = iso_vec3_sub(way, iso_vec3_scale(normal, iso_vec3_dot(way, normal)));
        const double length = iso_vec3_length(along);
        if (length < 1e-6) break;
        const iso_vec3 to =
            to_surface(grid, iso_vec3_add(at, iso_vec3_scale(along, fmin(1, reach / length))));
        if (iso_vec3_length(iso_vec3_sub(near, to)) < iso_vec3_length(way))
            at = to;
        else
            reach /= 2;
    }
    return at;
}

static iso_status nearest_vertex(const iso_grid *grid, iso_vec3 near, iso_pool *pool, iso_vec3 *nearest,
                                 iso_error *error) {
    solid_mesh mesh;
    double least = INFINITY;
    ISO_TRY(make_mesh(grid, pool, &mesh, error));
    for (size_t i = 0; i < mesh.weld.vertex_count; i++) {
        const iso_vec3 p = vertex_of(&mesh, i);
        const double distance = iso_vec3_length(iso_vec3_sub(p, near));
        if (distance >= least) continue;
        least = distance;
        *nearest = p;
    }
    free_mesh(&mesh);
    return ISO_OK;
}

/* Follows a ray from just inside the surface to where it leaves the solid. */
static iso_status find_thickness(const iso_grid *grid, iso_pool *pool, iso_measured_place *place,
                                 iso_error *error) {
    const double skin = 0.01 * iso_grid_transform(grid)->spacing[0];
    const iso_vec3 inwards = iso_vec3_scale(place->normal, -1);
    iso_ray_tracer *tracer;
    iso_ray ray;
    iso_ray_hit hit;
    ISO_TRY(iso_ray_tracer_create(grid, 0, pool, &tracer, error));
    place->thickness = INFINITY;
    bool inside = false, more = iso_ray_start(tracer, place->position, inwards, skin, &ray);
    if (more) inside = !iso_ray_starts_above(tracer, &ray);
    while (more && (more = iso_ray_next(tracer, &ray, &hit))) {
        const bool leaves = !hit.falls; /* into values above the isovalue */
        if (inside && leaves) {
            place->thickness = hit.t;
            break;
        }
        inside = hit.falls;
    }
    iso_ray_tracer_destroy(tracer);
    return ISO_OK;
}

iso_status iso_measure_place(const iso_grid *grid, iso_vec3 near, iso_pool *pool, iso_measured_place *place,
                             iso_error *error) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    const iso_vec3 wanted = iso_affine_point_to_index(&affine, near);
    iso_vec3 at = wanted;
    if (!(fabs(iso_grid_sample(grid, at)) < 1)) ISO_TRY(nearest_vertex(grid, wanted, pool, &at, error));
    at = slide(grid, to_surface(grid, at), wanted);
    place->position = iso_affine_point(&affine, at);
    place->normal = iso_affine_normal(&affine, iso_grid_gradient(grid, at));
    return find_thickness(grid, pool, place, error);
}
