/* Fills the window of a brick (its voxels and their surroundings as floats), and tests whether an isovalue
 * may cross a brick, so that most bricks can be skipped. */
#include <float.h>
#include <string.h>

#include "base/numbers.h"
#include "grids/brick_index.h"
#include "grids/grid.h"

/* Converts `count` voxels of a row to floats. */
static void convert_row(const iso_rgrid *grid, ptrdiff_t first, int count, float *out) {
    switch (grid->type) {
    case ISO_UINT8:
        for (int i = 0; i < count; i++) out[i] = ((const uint8_t *)grid->data)[first + i];
        break;
    case ISO_INT16:
        for (int i = 0; i < count; i++) out[i] = ((const int16_t *)grid->data)[first + i];
        break;
    case ISO_UINT16:
        for (int i = 0; i < count; i++) out[i] = ((const uint16_t *)grid->data)[first + i];
        break;
    default:
        memcpy(out, (const float *)grid->data + first, (size_t)count * sizeof *out);
    }
}

/* Fills the entries of a row before `low` with entry `low`, and those from `end` on with entry end - 1. */
static void replicate_ends(float row[ISO_WINDOW], int low, int end) {
    for (int i = 0; i < low; i++) row[i] = row[low];
    for (int i = end; i < ISO_WINDOW; i++) row[i] = row[end - 1];
}

static void rgrid_window(const iso_rgrid *grid, const int brick[3], float *window) {
    int x0 = brick[0] * ISO_BRICK - ISO_WINDOW_LOW;
    int low = x0 < 0 ? -x0 : 0, end = iso_min_int(ISO_WINDOW, grid->dims[0] - x0);
    for (int k = 0; k < ISO_WINDOW; k++) {
        int z = iso_clamp_index(brick[2] * ISO_BRICK - ISO_WINDOW_LOW + k, grid->dims[2]);
        for (int j = 0; j < ISO_WINDOW; j++) {
            int y = iso_clamp_index(brick[1] * ISO_BRICK - ISO_WINDOW_LOW + j, grid->dims[1]);
            float *row = window + (k * ISO_WINDOW + j) * ISO_WINDOW;
            convert_row(grid, x0 + low + y * grid->stride_y + z * grid->stride_z, end - low, row + low);
            replicate_ends(row, low, end);
        }
    }
}

/* A row of voxels of an hgrid across its cells. */
typedef struct cell_row {
    const iso_hgrid *grid;
    const int32_t *cells; /* the entries of the cells along the row */
    int offset;           /* index in a brick of the row's first voxel */
} cell_row;

static void copy_part(const cell_row *source, int cx, int local_x, int count, float *out) {
    int32_t number = source->cells[cx];
    if (number >= 0) {
        const float *from = iso_hgrid_brick(source->grid, number) + source->offset + local_x;
        if (count == ISO_BRICK) /* copied by vectors, without a call */
            memcpy(out, from, ISO_BRICK * sizeof *out);
        else
            for (int i = 0; i < count; i++) out[i] = from[i];
    } else {
        float value = iso_hgrid_empty_value(source->grid, number);
        for (int i = 0; i < count; i++) out[i] = value;
    }
}

static void hgrid_window(const iso_hgrid *grid, const int brick[3], float *window) {
    int x0 = brick[0] * ISO_BRICK - ISO_WINDOW_LOW;
    int low = x0 < 0 ? -x0 : 0, end = iso_min_int(ISO_WINDOW, grid->dims[0] - x0);
    int middle = iso_min_int(ISO_BRICK, end - ISO_WINDOW_LOW), above = end - ISO_WINDOW_LOW - middle;
    for (int k = 0; k < ISO_WINDOW; k++) {
        int z = iso_clamp_index(brick[2] * ISO_BRICK - ISO_WINDOW_LOW + k, grid->dims[2]);
        for (int j = 0; j < ISO_WINDOW; j++) {
            int y = iso_clamp_index(brick[1] * ISO_BRICK - ISO_WINDOW_LOW + j, grid->dims[1]);
            float *row = window + (k * ISO_WINDOW + j) * ISO_WINDOW;
            const cell_row source = {grid,
                                     grid->cell + iso_hgrid_cell_index(grid, 0, y / ISO_BRICK, z / ISO_BRICK),
                                     ((z % ISO_BRICK) * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK};
            if (!low) copy_part(&source, brick[0] - 1, ISO_BRICK - 1, 1, row);
            copy_part(&source, brick[0], 0, middle, row + ISO_WINDOW_LOW);
            if (above) copy_part(&source, brick[0] + 1, 0, above, row + ISO_WINDOW_LOW + ISO_BRICK);
            replicate_ends(row, low, end);
        }
    }
}

void iso_grid_window(const iso_grid *grid, const int brick[3], float window[ISO_WINDOW_VOXELS]) {
    if (grid->hgrid)
        hgrid_window(grid->hgrid, brick, window);
    else
        rgrid_window(grid->rgrid, brick, window);
}

/* Bits that say on which sides of the isovalue voxels were found. */
enum { AT_OR_ABOVE = 1, BELOW = 2, BOTH = 3 };

/* Defines a function that returns the sides of the isovalue on which the `count` voxels of a row lie. */
#define INTEGER_SIDES(name, type)                                                                            \
    static int name(const type *row, int count, float isovalue) {                                            \
        int above = 0, below = 0;                                                                            \
        for (int i = 0; i < count; i++) {                                                                    \
            above |= (float)row[i] >= isovalue;                                                              \
            below |= (float)row[i] < isovalue;                                                               \
        }                                                                                                    \
        return above * AT_OR_ABOVE | below * BELOW;                                                          \
    }
INTEGER_SIDES(uint8_sides, uint8_t)
INTEGER_SIDES(int16_sides, int16_t)
INTEGER_SIDES(uint16_sides, uint16_t)

/* Returns the sides of the isovalue on which the `count` floats of a row lie; NaN and infinities are on
 * neither side. */
static int float_sides(const float *row, int count, float isovalue) {
    int above = 0, below = 0;
    for (int i = 0; i < count; i++) {
        above |= (row[i] >= isovalue) & (row[i] <= FLT_MAX);
        below |= (row[i] < isovalue) & (row[i] >= -FLT_MAX);
    }
    return above * AT_OR_ABOVE | below * BELOW;
}

static int row_sides(const iso_rgrid *grid, ptrdiff_t first, int count, float isovalue) {
    switch (grid->type) {
    case ISO_UINT8:
        return uint8_sides((const uint8_t *)grid->data + first, count, isovalue);
    case ISO_INT16:
        return int16_sides((const int16_t *)grid->data + first, count, isovalue);
    case ISO_UINT16:
        return uint16_sides((const uint16_t *)grid->data + first, count, isovalue);
    default:
        return float_sides((const float *)grid->data + first, count, isovalue);
    }
}

static int rgrid_may_cross(const iso_rgrid *grid, const int first[3], const int end[3], float isovalue) {
    int seen = 0;
    for (int z = first[2]; z < end[2]; z++)
        for (int y = first[1]; y < end[1]; y++) {
            ptrdiff_t start = first[0] + y * grid->stride_y + z * grid->stride_z;
            seen |= row_sides(grid, start, end[0] - first[0], isovalue);
            if (seen == BOTH) return 1;
        }
    return 0;
}

/* Returns the sides on which the first n[0] x n[1] x n[2] voxels of a cell lie. */
static int cell_sides(const iso_hgrid *grid, int32_t cell, const int n[3], float isovalue) {
    if (cell < 0) {
        float value = iso_hgrid_empty_value(grid, cell);
        return float_sides(&value, 1, isovalue);
    }
    const float *brick = iso_hgrid_brick(grid, cell);
    int seen = 0;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            seen |= float_sides(brick + (z * ISO_BRICK + y) * ISO_BRICK, n[0], isovalue);
            if (seen == BOTH) return BOTH;
        }
    return seen;
}

/* Whether the isovalue may cross a brick of an hgrid: looks at the brick's cell and at the first voxels of
 * its seven upper neighbours. */
static int hgrid_may_cross(const iso_hgrid *grid, const int brick[3], const int end[3], float isovalue) {
    int seen = 0;
    for (int corner = 0; corner < 8; corner++) {
        int c[3], n[3], inside = 1;
        for (int axis = 0; axis < 3; axis++) {
            c[axis] = brick[axis] + (corner >> axis & 1);
            n[axis] = iso_min_int(ISO_BRICK, end[axis] - c[axis] * ISO_BRICK);
            inside &= n[axis] > 0;
        }
        if (!inside) continue;
        seen |= cell_sides(grid, grid->cell[iso_hgrid_cell_index(grid, c[0], c[1], c[2])], n, isovalue);
        if (seen == BOTH) return 1;
    }
    return 0;
}

int iso_grid_brick_may_cross(const iso_grid *grid, const int brick[3], float isovalue) {
    const int *dims = iso_grid_dims(grid);
    int first[3], end[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = brick[axis] * ISO_BRICK;
        end[axis] = iso_min_int(first[axis] + ISO_BRICK + 1, dims[axis]);
    }
    if (grid->hgrid) return hgrid_may_cross(grid->hgrid, brick, end, isovalue);
    const iso_brick_index *index = grid->rgrid->index;
    if (index && iso_brick_index_current(index))
        return iso_brick_index_crosses(index, iso_brick_index_number(index, brick), isovalue);
    return rgrid_may_cross(grid->rgrid, first, end, isovalue);
}
