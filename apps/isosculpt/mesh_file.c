/* Meshes of sculpted fields in files: capped at the border of the grid if that is asked for, and measured. */
#include "apps/isosculpt/mesh_file.h"

#include <stdio.h>

#include "grids/parts/closed.h"
#include "io/mesh/mesh_write.h"

/* Welds, measures and writes the mesh. */
static iso_status write_weld(const char *path, const iso_mesh_view *view, const isosculpt_mesh_opts *opts,
                             iso_mesh_measures *measures, iso_error *error) {
    iso_weld weld;
    ISO_TRY(iso_mesh_weld(view, NULL, &weld, error));
    if (opts->closed) iso_weld_separate(view, ISO_CLOSED_TOLERANCE, &weld);
    iso_status status = ISO_OK;
    if (opts->painted && iso_painted_any(opts->painted)) {
        const iso_coloring coloring = iso_painted_coloring(opts->painted);
        status = iso_coloring_weld(&coloring, &view->transform, opts->pool, &weld, error);
    }
    if (status == ISO_OK) status = iso_weld_measure(&weld, &view->transform, opts->pool, measures, error);
    if (status == ISO_OK && opts->stream)
        status = iso_mesh_put_weld(opts->stream, path, &weld, &view->transform, "isosculpt", error);
    else if (status == ISO_OK)
        status = iso_mesh_write_weld(path, &weld, &view->transform, "isosculpt", error);
    iso_weld_free(&weld);
    return status;
}

/* Extracts the surface of the grid and writes it. */
static iso_status write_surface(const char *path, const iso_grid *grid, const isosculpt_mesh_opts *opts,
                                iso_mesh_measures *measures, iso_error *error) {
    const iso_mesh_opts how = {.pool = opts->pool};
    iso_mesh_set *set;
    ISO_TRY(iso_mesh_set_create(grid, &how, &set, error));
    iso_status status = iso_mesh_set_update(set, error);
    if (status == ISO_OK) status = iso_progress_tell(opts->progress, path, 0.5, error);
    const iso_mesh_view view = iso_mesh_set_view(set);
    if (status == ISO_OK && iso_mesh_view_triangle_count(&view) == 0)
        status = iso_fail(error, ISO_ERR_EMPTY, "%.700s: nothing is left of the solid", path);
    if (status == ISO_OK) status = write_weld(path, &view, opts, measures, error);
    iso_mesh_set_destroy(set);
    return status == ISO_OK ? iso_progress_tell(opts->progress, path, 1, error) : status;
}

iso_status isosculpt_mesh_write(const char *path, iso_hgrid *field, const isosculpt_mesh_opts *opts,
                                iso_mesh_measures *measures, iso_error *error) {
    const iso_grid grid = {.hgrid = field};
    iso_grid closed;
    if (!opts->closed) return write_surface(path, &grid, opts, measures, error);
    ISO_TRY(iso_grid_close(&grid, 0, opts->pool, &closed, error));
    iso_status status = write_surface(path, &closed, opts, measures, error);
    iso_grid_destroy(&closed);
    return status;
}

void isosculpt_mesh_open_note(size_t open_edges, char *text, size_t size) {
    snprintf(text, size, "%zu open edges where the border of the grid cuts the solid: --closed caps it there",
             open_edges);
}
