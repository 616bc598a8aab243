/* Converts a grid to a level set for sculpting: a level set is copied, any other grid is resampled
 * (grids/level_set.h) and redistanced. */
#include "sculpt/edit/field_from_grid.h"

#include <math.h>

#include "sculpt/edit/edit.h"

/* The number of redistancing steps (0.45 voxel each) that fill the whole band. */
enum { ITERATIONS = 16 };

static bool has_cubes(const iso_hgrid *grid) {
    const double *s = grid->transform.spacing;
    return fabs(s[0] - s[1]) <= 1e-6 * s[0] && fabs(s[0] - s[2]) <= 1e-6 * s[0];
}

/* Copies a level set with unchanged values, adds ISO_FIELD_MARGIN voxels on each side and rounds the size up
 * to whole bricks. */
static iso_status copy_level_set(const iso_hgrid *from, iso_hgrid **grid, iso_error *error) {
    const int offset[3] = {ISO_FIELD_MARGIN, ISO_FIELD_MARGIN, ISO_FIELD_MARGIN};
    int dims[3];
    for (int axis = 0; axis < 3; axis++)
        dims[axis] = (from->dims[axis] + 2 * ISO_FIELD_MARGIN + ISO_BRICK - 1) / ISO_BRICK * ISO_BRICK;
    return iso_level_set_resize(from, offset, dims, grid, error);
}

iso_status iso_field_redistance(iso_hgrid *grid, iso_pool *pool, const iso_progress *progress,
                                iso_error *error) {
    iso_editor *editor = NULL;
    const iso_editor_opts opts = {.pool = pool};
    iso_status status = iso_editor_create(grid, &opts, &editor, error);
    if (status == ISO_OK) {
        status = iso_editor_redistance(editor, ITERATIONS, progress, error);
        iso_editor_destroy(editor);
    }
    return status;
}

static iso_status sample_volume(const char *name, const iso_grid *from, const iso_resampling *asked,
                                iso_hgrid **grid, iso_error *error) {
    const iso_progress progress = iso_progress_part(asked->progress, 0, 0.5);
    iso_resampling how = *asked;
    how.margin = ISO_FIELD_MARGIN;
    how.progress = &progress;
    return iso_level_set_from_grid(name, from, &how, grid, error);
}

iso_status iso_field_from_grid(const char *name, const iso_grid *from, const iso_field_opts *opts,
                               iso_hgrid **grid, iso_error *error) {
    const iso_resampling *how = &opts->resampling;
    const iso_hgrid *sparse = from->hgrid;
    const double own_voxel = sparse ? sparse->transform.spacing[0] : 0;
    const bool is_copied =
        sparse && has_cubes(sparse) && (how->voxel <= 0 || how->voxel == own_voxel) && how->isovalue == 0;
    ISO_TRY(is_copied ? copy_level_set(sparse, grid, error) : sample_volume(name, from, how, grid, error));
    const iso_progress progress = iso_progress_part(how->progress, 0.5, 1);
    if (is_copied && !opts->damaged) return ISO_OK;
    const iso_status status = iso_field_redistance(*grid, how->pool, &progress, error);
    if (status != ISO_OK) iso_hgrid_destroy(*grid);
    return status;
}
