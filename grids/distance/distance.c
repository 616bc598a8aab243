/* distance: from a mesh by a tree over its triangles; from a field by one over the pieces of its surface. */
#include "grids/distance/distance.h"

#include "base/memory.h"
#include "grids/closing/triangle_tree.h"
#include "grids/distance/patch_search.h"

struct iso_distance {
    iso_triangle_tree *tree; /* of a mesh; NULL: it is a field */
    iso_patch_tree patches;  /* of a field, */
    iso_grid grid;           /* which is this one */
};

/* ---- creating */

iso_status iso_distance_of_mesh(const iso_triangles *mesh, iso_distance **distance, iso_error *error) {
    iso_distance *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    const iso_status status = mesh->triangle_count
                                  ? iso_triangle_tree_create(mesh, &d->tree, error)
                                  : iso_fail(error, ISO_ERR_EMPTY, "there is no surface to measure from");
    if (status != ISO_OK)
        iso_distance_destroy(d);
    else
        *distance = d;
    return status;
}

iso_status iso_distance_of_field(const iso_grid *grid, double isovalue, const iso_triangles *mesh,
                                 iso_pool *pool, iso_distance **distance, iso_error *error) {
    iso_distance *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    d->grid = *grid;
    const iso_status status =
        iso_patch_tree_create(grid, iso_grid_stored(grid, isovalue), mesh, pool, &d->patches, error);
    if (status != ISO_OK)
        iso_distance_destroy(d);
    else
        *distance = d;
    return status;
}

void iso_distance_destroy(iso_distance *distance) {
    if (!distance) return;
    iso_triangle_tree_destroy(distance->tree);
    iso_patch_tree_free(&distance->patches);
    iso_free(distance);
}

/* ---- distances */

static double field_distance(const iso_distance *d, iso_vec3 point, iso_nearby *nearby) {
    const double *o = d->patches.affine.origin;
    return iso_patch_search(&d->patches, iso_vec3_sub(point, iso_vec3_make(o[0], o[1], o[2])), nearby);
}

static bool is_inside_field(const iso_distance *d, iso_vec3 point) {
    const iso_vec3 index = iso_affine_point_to_index(&d->patches.affine, point);
    const double p[3] = {index.x, index.y, index.z};
    for (int axis = 0; axis < 3; axis++)
        if (!(p[axis] >= 0 && p[axis] <= iso_grid_dims(&d->grid)[axis] - 1)) return false;
    const double value = iso_grid_sample(&d->grid, index);
    if (isnan(value)) return false;
    return iso_grid_is_level_set(&d->grid) ? value < d->patches.isovalue : value >= d->patches.isovalue;
}

bool iso_distance_is_inside(const iso_distance *d, iso_vec3 point) {
    return !d->tree ? is_inside_field(d, point) : fabs(iso_triangle_tree_winding(d->tree, point)) > 0.5;
}

static double mesh_distance(const iso_distance *d, iso_vec3 point, iso_nearby *nearby) {
    iso_nearest nearest = {.squared = INFINITY, .triangle = nearby->last};
    iso_triangle_tree_nearest(d->tree, point, &nearest);
    nearby->last = nearest.triangle;
    return sqrt(nearest.squared);
}

double iso_distance_at(const iso_distance *d, iso_vec3 point, iso_nearby *nearby) {
    const double distance = !d->tree ? field_distance(d, point, nearby) : mesh_distance(d, point, nearby);
    return iso_distance_is_inside(d, point) ? -distance : distance;
}
