/* distances: from a grid to what distances are measured from. */
#include "scene/distances.h"

#include <string.h>

#include "base/memory.h"
#include "io/mesh/mesh_read.h"

iso_status iso_isosurface_mesh(const iso_grid *grid, double isovalue, iso_pool *pool, iso_weld *weld,
                               iso_error *error) {
    const iso_mesh_opts opts = {.isovalue = isovalue, .pool = pool, .chunk = NULL};
    iso_mesh_set *set;
    ISO_TRY(iso_mesh_set_create(grid, &opts, &set, error));
    iso_status status = iso_mesh_set_update(set, error);
    if (status == ISO_OK) {
        const iso_mesh_view view = iso_mesh_set_view(set);
        status = iso_mesh_weld(&view, NULL, weld, error);
    }
    iso_mesh_set_destroy(set);
    return status;
}

iso_status iso_weld_triangles(const iso_weld *weld, const iso_affine *affine, iso_triangles *triangles,
                              iso_error *error) {
    iso_triangles made = {.vertex_count = weld->vertex_count, .triangle_count = weld->triangle_count};
    made.vertices = iso_alloc((made.vertex_count + 1) * sizeof *made.vertices);
    made.triangles = iso_alloc((made.triangle_count + 1) * sizeof *made.triangles);
    if (!made.vertices || !made.triangles) {
        iso_triangles_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu triangles", weld->triangle_count);
    }
    for (size_t i = 0; i < weld->vertex_count; i++) {
        const float *v = weld->vertices[i].position;
        const iso_vec3 index = {(double)v[0], (double)v[1], (double)v[2]},
                       place = affine ? iso_affine_point(affine, index) : index;
        made.vertices[i][0] = (float)place.x;
        made.vertices[i][1] = (float)place.y;
        made.vertices[i][2] = (float)place.z;
    }
    if (weld->triangle_count)
        memcpy(made.triangles, weld->triangles, weld->triangle_count * sizeof *made.triangles);
    *triangles = made;
    return ISO_OK;
}

iso_status iso_distance_of_isosurface(const iso_grid *grid, double isovalue, iso_pool *pool,
                                      iso_distance **distance, iso_error *error) {
    iso_weld weld;
    iso_triangles mesh;
    ISO_TRY(iso_isosurface_mesh(grid, isovalue, pool, &weld, error));
    iso_status status = iso_weld_triangles(&weld, NULL, &mesh, error);
    iso_weld_free(&weld);
    ISO_TRY(status);
    status = mesh.triangle_count ? iso_distance_of_field(grid, isovalue, &mesh, pool, distance, error)
                                 : iso_fail(error, ISO_ERR_EMPTY, "no surface at isovalue %g", isovalue);
    iso_triangles_free(&mesh);
    return status;
}

iso_status iso_distance_of_mesh_file(const char *path, iso_triangles *mesh, iso_distance **distance,
                                     iso_error *error) {
    iso_triangles own = {.vertices = NULL}, *read = mesh ? mesh : &own;
    ISO_TRY(iso_mesh_read(path, NULL, read, error));
    const iso_status status = iso_distance_of_mesh(read, distance, error);
    iso_triangles_free(&own);
    return status;
}
