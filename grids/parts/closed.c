/* Closes solids at the volume's border with one more layer of voxels, which are outside. */
#include "grids/parts/closed.h"

#include <float.h>
#include <math.h>

#include "grids/brick_index.h"
#include "grids/level_set.h"
#include "grids/threshold.h"

/* A cap lies at (value - isovalue) / (value - outside) of the way from a sample at the border to the new
 * layer. The value `outside` is therefore this factor times the largest value - isovalue away from the
 * isovalue. The factor is twice as large as needed, to allow for rounding. */
static const double OUTSIDE_FACTOR = 2 / ISO_CLOSED_TOLERANCE;

/* ---- dense grids */

typedef struct padding {
    const iso_rgrid *from;
    iso_rgrid *to;
    float outside;
} padding;

static void copy_slice(void *context, size_t z, int worker) {
    (void)worker;
    const padding *p = context;
    const int *dims = p->to->dims;
    float *to = (float *)p->to->data + (ptrdiff_t)z * p->to->stride_z;
    for (int y = 0; y < dims[1]; y++)
        for (int x = 0; x < dims[0]; x++, to++) {
            const bool border =
                !x || !y || !z || x == dims[0] - 1 || y == dims[1] - 1 || (int)z == dims[2] - 1;
            const float value = border ? p->outside : iso_rgrid_at(p->from, x - 1, y - 1, (int)z - 1);
            *to = isfinite(value) ? value : p->outside;
        }
}

static float choose_outside(const iso_rgrid *grid, const struct iso_brick_index *index, float at) {
    double low, high;
    iso_brick_index_extremes(index, &low, &high);
    const double deepest =
        fmax(grid->level_set ? at - low : high - at, 0); /* 0 also when nothing is finite */
    /* If all values of the solid equal the isovalue, any distance will do. */
    const double far = fmax(OUTSIDE_FACTOR * deepest, fmax(fabs((double)at), 1));
    return (float)fmin(fmax(grid->level_set ? at + far : at - far, -FLT_MAX), FLT_MAX);
}

static iso_status close_dense(const iso_grid *from, double isovalue, iso_pool *pool, iso_rgrid **closed,
                              iso_error *error) {
    const iso_rgrid *grid = from->rgrid;
    const iso_transform transform = iso_transform_shift(&grid->transform, (const int[3]){-1, -1, -1});
    iso_rgrid_desc desc = {.type = ISO_FLOAT32,
                           .scale = grid->scale,
                           .offset = grid->offset,
                           .transform = &transform,
                           .level_set = grid->level_set};
    for (int axis = 0; axis < 3; axis++) {
        if (grid->dims[axis] > INT32_MAX - 2)
            return iso_fail(error, ISO_ERR_LIMIT, "no room for two more voxels");
        desc.dims[axis] = grid->dims[axis] + 2;
    }
    const struct iso_brick_index *index;
    ISO_TRY(iso_brick_index_of(from->rgrid, pool, &index, error));
    padding p = {.from = grid,
                 .outside = choose_outside(grid, index, iso_threshold_of(from, isovalue).isovalue_ceil)};
    ISO_TRY(iso_rgrid_create(&desc, &p.to, error));
    iso_parallel_for(pool, (size_t)desc.dims[2], copy_slice, &p);
    iso_status status = iso_brick_index_of(p.to, pool, NULL, error);
    if (status == ISO_OK)
        *closed = p.to;
    else
        iso_rgrid_destroy(p.to);
    return status;
}

uint64_t iso_grid_close_estimate(const int dims[3]) {
    uint64_t voxels = 1;
    int padded[3];
    for (int axis = 0; axis < 3; axis++) {
        padded[axis] = dims[axis] < INT32_MAX - 2 ? dims[axis] + 2 : INT32_MAX;
        voxels *= (uint64_t)padded[axis];
    }
    return voxels * sizeof(float) + iso_brick_index_estimate(padded);
}

/* ---- level sets */

/* Sets the voxels of the outermost layer in one cell; an empty cell outside the solid stays empty. */
static iso_status close_cell(iso_hgrid *grid, const int at[3], float outside, iso_error *error) {
    float *brick;
    const int32_t state = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
    if (state == ISO_CELL_OUTSIDE) return ISO_OK;
    ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int voxel[3] = {at[0] * ISO_BRICK + i % ISO_BRICK,
                              at[1] * ISO_BRICK + i / ISO_BRICK % ISO_BRICK,
                              at[2] * ISO_BRICK + i / ISO_BRICK / ISO_BRICK};
        for (int axis = 0; axis < 3; axis++)
            if (voxel[axis] == 0 || voxel[axis] >= grid->dims[axis] - 1) brick[i] = outside;
    }
    return ISO_OK;
}

static iso_status close_cells(iso_hgrid *grid, float outside, iso_error *error) {
    int at[3];
    for (at[2] = 0; at[2] < grid->cells[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->cells[0]; at[0]++) {
                bool border = false;
                for (int axis = 0; axis < 3; axis++)
                    border |= at[axis] == 0 || at[axis] == (grid->dims[axis] - 1) / ISO_BRICK;
                if (border) ISO_TRY(close_cell(grid, at, outside, error));
            }
    return ISO_OK;
}

static iso_status close_sparse(const iso_hgrid *from, float at, iso_hgrid **closed, iso_error *error) {
    const int offset[3] = {1, 1, 1};
    const int dims[3] = {from->dims[0] + 2, from->dims[1] + 2, from->dims[2] + 2};
    iso_hgrid *grid;
    ISO_TRY(iso_level_set_resize(from, offset, dims, &grid, error));
    const double deepest = (double)at + (double)from->band;
    const double outside = fmax((double)at, 0) + OUTSIDE_FACTOR * fmax(deepest, 1);
    iso_status status = close_cells(grid, (float)outside, error);
    if (status == ISO_OK)
        *closed = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}

iso_status iso_grid_close(const iso_grid *from, double isovalue, iso_pool *pool, iso_grid *closed,
                          iso_error *error) {
    *closed = (iso_grid){0};
    if (!isfinite(isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not a number");
    if (from->rgrid) return close_dense(from, isovalue, pool, &closed->rgrid, error);
    return close_sparse(from->hgrid, iso_threshold_of(from, isovalue).isovalue_ceil, &closed->hgrid, error);
}
