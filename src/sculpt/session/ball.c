/* Makes the level set of a new session: a ball. */
#include <math.h>

#include "sculpt/session/session.h"

static iso_status fill_ball_cell(iso_hgrid *grid, const int at[3], const double centre[3],
                                 double radius_voxels, iso_error *error) {
    const double band = (double)grid->band, half = 0.5 * (ISO_BRICK - 1);
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = ISO_BRICK * (double)at[axis] + half - centre[axis];
        square += d * d;
    }
    double distance = sqrt(square) - radius_voxels, influence = half * sqrt(3) + band;
    iso_hgrid_coalesce(grid, at[0], at[1], at[2], distance < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE);
    if (fabs(distance) >= influence) return ISO_OK;
    float *brick;
    ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int voxel[3] = {i % ISO_BRICK, i / ISO_BRICK % ISO_BRICK, i / (ISO_BRICK * ISO_BRICK)};
        square = 0;
        for (int axis = 0; axis < 3; axis++) {
            double d = ISO_BRICK * (double)at[axis] + voxel[axis] - centre[axis];
            square += d * d;
        }
        distance = sqrt(square) - radius_voxels;
        brick[i] = (float)(distance > band ? band : distance < -band ? -band : distance);
    }
    return ISO_OK;
}

static iso_status fill_ball(iso_hgrid *grid, const iso_journal_start *start, iso_error *error) {
    const double centre[3] = {-start->origin.x / start->voxel_size, -start->origin.y / start->voxel_size,
                              -start->origin.z / start->voxel_size};
    int at[3];
    for (at[2] = 0; at[2] < grid->cells[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->cells[0]; at[0]++)
                ISO_TRY(fill_ball_cell(grid, at, centre, start->radius / start->voxel_size, error));
    iso_hgrid_prune(grid);
    return ISO_OK;
}

iso_status iso_session_ball(const iso_journal_start *start, iso_hgrid **out, iso_error *error) {
    if (!(start->voxel_size > 0) || !isfinite(start->voxel_size) || !(start->radius > 0) ||
        !isfinite(start->radius))
        return iso_fail(error, ISO_ERR_USAGE, "a ball of %g mm in voxels of %g mm", start->radius,
                        start->voxel_size);
    iso_transform transform = iso_transform_identity();
    const double origin[3] = {start->origin.x, start->origin.y, start->origin.z};
    for (int axis = 0; axis < 3; axis++) {
        transform.origin[axis] = origin[axis];
        transform.spacing[axis] = start->voxel_size;
    }
    iso_hgrid *grid;
    ISO_TRY(iso_hgrid_create(start->dims, 0, &transform, &grid, error));
    iso_status status = fill_ball(grid, start, error);
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}
