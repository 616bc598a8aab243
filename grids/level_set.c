/* Writes level sets to .vdb files through OpenVDB's module, creates and resizes level sets. */
#include "grids/level_set.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/numbers.h"
#include "grids/volume/module.h"

iso_status iso_level_set_put_vdb(FILE *stream, const char *path, const iso_hgrid *grid, const char *name,
                                 const iso_level_set_colors *colors, const iso_progress *progress,
                                 iso_error *error) {
    const double *s = grid->transform.spacing;
    if (fabs(s[0] - s[1]) > 1e-6 * s[0] || fabs(s[0] - s[2]) > 1e-6 * s[0])
        return iso_fail(error, ISO_ERR_USAGE, "%s: voxels of %g x %g x %g mm are no cubes", path, s[0], s[1],
                        s[2]);
    const iso_module *module;
    ISO_TRY(iso_module_load(path, "vdb", "OpenVDB", &module, error));
    ISO_TRY(module->write_level_set(stream, path, grid, name, colors, progress, error));
    return iso_progress_tell(progress, path, 1, error);
}

iso_status iso_level_set_read_colors(const char *path, const struct iso_volume_opts *opts,
                                     const iso_color_receiver *to, iso_error *error) {
    const iso_module *module;
    ISO_TRY(iso_module_load(path, "vdb", "OpenVDB", &module, error));
    return module->read_colors(path, opts, to, error);
}

iso_status iso_level_set_write_vdb(const char *path, const iso_hgrid *grid, const char *name,
                                   const iso_progress *progress, iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    const iso_status status = iso_level_set_put_vdb(sink.stream, path, grid, name, NULL, progress, error);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}

iso_status iso_level_set_around(const char *path, const iso_box *box, const iso_sampling *sampling,
                                iso_hgrid **grid, iso_error *error) {
    const double lo[3] = {box->lo.x, box->lo.y, box->lo.z}, hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    iso_transform transform = iso_transform_identity();
    int dims[3];
    if (!(sampling->voxel > 0) || !isfinite(sampling->voxel))
        return iso_fail(error, ISO_ERR_USAGE, "%s: voxels of %g mm", path, sampling->voxel);
    for (int axis = 0; axis < 3; axis++) {
        const double voxels = ceil((hi[axis] - lo[axis]) / sampling->voxel) + 1 + 2.0 * sampling->margin;
        const double whole = ceil(voxels / ISO_BRICK) * ISO_BRICK;
        if (!(whole <= ISO_HGRID_MAX))
            return iso_fail(error, ISO_ERR_LIMIT, "%s: %g voxels of %g mm along %c, at most %d", path, whole,
                            sampling->voxel, "xyz"[axis], ISO_HGRID_MAX);
        dims[axis] = (int)whole;
        transform.spacing[axis] = sampling->voxel;
        transform.origin[axis] = (lo[axis] + hi[axis] - (whole - 1) * sampling->voxel) / 2;
    }
    return iso_hgrid_create(dims, 0, &transform, grid, error);
}

/* Whether no voxel on the grid's border is inside: then everything beyond it is outside. */
static bool ends_within(const iso_hgrid *from) {
    const int *n = from->dims;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            const bool whole = z == 0 || y == 0 || z == n[2] - 1 || y == n[1] - 1;
            for (int x = 0; x < n[0]; x += whole || x == n[0] - 1 ? 1 : n[0] - 1)
                if (iso_hgrid_at(from, x, y, z) < 0) return false;
        }
    return true;
}

/* The value at a voxel of `from`, or beyond it: there the distance of the nearest voxel, and if `grows` that
 * from it on top. */
static float value_beyond(const iso_hgrid *from, const int at[3], bool grows) {
    int near[3];
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        near[axis] = iso_clamp_index(at[axis], from->dims[axis]);
        square += (double)(at[axis] - near[axis]) * (at[axis] - near[axis]);
    }
    const float value = iso_hgrid_at(from, near[0], near[1], near[2]);
    return grows && square > 0 ? fminf(value + (float)sqrt(square), from->band) : value;
}

/* Reads the values of a cell of the result, which begins at voxel `first` of `from`. Returns whether the cell
 * needs a brick. */
static bool read_cell(const iso_hgrid *from, const int first[3], bool grows, float values[ISO_BRICK_VOXELS]) {
    bool mixed = false;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int at[3] = {first[0] + i % ISO_BRICK, first[1] + i / ISO_BRICK % ISO_BRICK,
                           first[2] + i / ISO_BRICK / ISO_BRICK};
        values[i] = value_beyond(from, at, grows);
        mixed |= values[i] != values[0];
    }
    return mixed || fabsf(values[0]) < from->band;
}

static iso_status copy_cells(const iso_hgrid *from, const int offset[3], iso_hgrid *grid, iso_error *error) {
    const bool grows = ends_within(from);
    int at[3];
    for (at[2] = 0; at[2] < grid->cells[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->cells[0]; at[0]++) {
                float values[ISO_BRICK_VOXELS], *brick;
                int first[3];
                for (int axis = 0; axis < 3; axis++) first[axis] = ISO_BRICK * at[axis] - offset[axis];
                bool full = read_cell(from, first, grows, values);
                iso_hgrid_coalesce(grid, at[0], at[1], at[2],
                                   values[0] < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE);
                if (!full) continue;
                ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
                memcpy(brick, values, sizeof values);
            }
    return ISO_OK;
}

iso_status iso_level_set_resize(const iso_hgrid *from, const int offset[3], const int dims[3],
                                iso_hgrid **out, iso_error *error) {
    const int first[3] = {-offset[0], -offset[1], -offset[2]};
    const iso_transform transform = iso_transform_shift(&from->transform, first);
    iso_hgrid *grid;
    ISO_TRY(iso_hgrid_create(dims, from->band, &transform, &grid, error));
    iso_status status = copy_cells(from, offset, grid, error);
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}
