/* solid: changes solids, and writes their surfaces. */
#include "scene/solid.h"

#include "base/memory.h"
#include "extract/mesh/mesh_measure.h"
#include "io/points_write.h"
#include "scene/distances.h"

/* ---- the solid */

/* Puts a grid in place of *own. */
static void replace(iso_grid *own, iso_grid with) {
    iso_grid_destroy(own);
    *own = with;
}

static iso_status make_hollow(const iso_solid_opts *opts, double *isovalue, iso_grid *own, iso_error *error) {
    iso_hollow_opts how = *opts->how;
    iso_hgrid *hollow;
    how.wall = opts->hollow;
    how.pool = opts->pool;
    ISO_TRY(iso_grid_hollow(own, *isovalue, &how, &hollow, error));
    replace(own, (iso_grid){.hgrid = hollow});
    *isovalue = 0;
    return ISO_OK;
}

iso_status iso_solid_make(iso_grid *grid, const iso_solid_opts *opts, double *isovalue, iso_grid *own,
                          iso_components_totals *parts, iso_error *error) {
    const iso_components_opts kept = {
        .isovalue = *isovalue, .largest = opts->largest, .min_volume = opts->min_volume, .pool = opts->pool};
    iso_grid closed, *from = grid;
    if (iso_solid_drops_parts(opts) && opts->copied) {
        ISO_TRY(iso_grid_copy(grid, opts->pool, own, error));
        from = own;
    }
    if (iso_solid_drops_parts(opts)) ISO_TRY(iso_components_filter(from, &kept, parts, error));
    if (!opts->closed) return ISO_OK;
    ISO_TRY(iso_grid_close(from, *isovalue, opts->pool, &closed, error));
    replace(own, closed);
    return opts->hollow > 0 ? make_hollow(opts, isovalue, own, error) : ISO_OK;
}

/* ---- meshes */

iso_status iso_solid_weld(const iso_mesh_view *mesh, const iso_solid_mesh_opts *opts, iso_weld *weld,
                          iso_error *error) {
    iso_status status = ISO_OK;
    ISO_TRY(iso_mesh_weld(mesh, opts->pool, weld, error));
    /* Caps lie this far outside the volume, so that they are flat. */
    if (opts->closed) iso_weld_separate(mesh, ISO_CLOSED_TOLERANCE, weld);
    if (opts->edits) status = iso_weld_edit(weld, &mesh->transform, opts->edits, error);
    if (status == ISO_OK && opts->measures)
        status = iso_weld_measure(weld, &mesh->transform, opts->pool, opts->measures, error);
    if (status == ISO_OK && opts->coloring)
        status = iso_coloring_weld(opts->coloring, &mesh->transform, opts->pool, weld, error);
    if (status != ISO_OK) iso_weld_free(weld);
    return status;
}

iso_status iso_solid_measure(const iso_grid *grid, double isovalue, iso_pool *pool,
                             iso_mesh_measures *measures, iso_error *error) {
    iso_weld weld;
    ISO_TRY(iso_isosurface_mesh(grid, isovalue, pool, &weld, error));
    const iso_status status = iso_weld_measure(&weld, iso_grid_transform(grid), pool, measures, error);
    iso_weld_free(&weld);
    return status;
}

/* Welds and writes the surface of a grid. */
static iso_status write_mesh(const char *path, const iso_grid *grid, const iso_solid_mesh_opts *opts,
                             const char *comment, FILE *stream, const iso_progress *progress,
                             iso_error *error) {
    iso_scene_surface surface = {.grid = *grid, .pool = opts->pool};
    iso_weld weld = {0};
    iso_status status = iso_scene_surface_update(&surface, ISO_PART_MESH, error);
    if (status == ISO_OK) status = iso_progress_tell(progress, path, 0.5, error);
    if (status == ISO_OK) {
        const iso_mesh_view view = iso_mesh_set_view(surface.mesh);
        status = iso_mesh_view_triangle_count(&view)
                     ? iso_solid_weld(&view, opts, &weld, error)
                     : iso_fail(error, ISO_ERR_EMPTY, "%.700s: nothing is left of the solid", path);
    }
    const iso_transform *transform = iso_grid_transform(grid);
    if (status == ISO_OK)
        status = stream ? iso_mesh_put_weld(stream, path, &weld, transform, comment, error)
                        : iso_mesh_write_weld(path, &weld, transform, comment, error);
    iso_weld_free(&weld);
    iso_scene_surface_free(&surface);
    return status == ISO_OK ? iso_progress_tell(progress, path, 1, error) : status;
}

iso_status iso_solid_write(const char *path, iso_hgrid *field, const iso_solid_mesh_opts *opts,
                           const char *comment, FILE *stream, const iso_progress *progress,
                           iso_error *error) {
    const iso_solid_opts solid = {.closed = opts->closed, .pool = opts->pool};
    iso_grid grid = {.hgrid = field}, own = {.hgrid = NULL};
    double isovalue = 0;
    ISO_TRY(iso_solid_make(&grid, &solid, &isovalue, &own, NULL, error));
    const iso_status status =
        write_mesh(path, opts->closed ? &own : &grid, opts, comment, stream, progress, error);
    iso_grid_destroy(&own);
    return status;
}

/* ---- points */

iso_status iso_solid_write_points(const char *path, const iso_point_view *points,
                                  const iso_coloring *coloring, iso_pool *pool, const char *comment,
                                  iso_error *error) {
    iso_point_view view = *points;
    uint8_t(*colors)[3] = NULL;
    if (coloring) {
        ISO_TRY(iso_coloring_points(coloring, points, pool, &colors, error));
        view.colors = (const uint8_t(*)[3])colors;
    }
    const iso_status status = iso_points_write_ply(path, &view, comment, error);
    iso_free(colors);
    return status;
}
