/* Smooths masks: a tent filter of three passes around each cell near the mask's border, and a threshold. */
#include "sculpt/edit/mask_rewrite.h"

#include <math.h>
#include <string.h>

/* The window of a cell: its voxels and `reach` more on each side. */
enum { WIDEST = ISO_BRICK + 2 * ISO_MASK_BLUR_MOST };

typedef struct blur {
    const iso_mask *mask;
    const iso_hgrid *grid;
    int reach, side; /* side: of the window */
    /* Sums along x, then along x and y: [z][y][x]. */
    uint8_t frozen[WIDEST][WIDEST][WIDEST];
    uint32_t rows[WIDEST][WIDEST][ISO_BRICK], planes[WIDEST][ISO_BRICK][ISO_BRICK];
} blur;

static int clamp(int value, int count) {
    return value < 0 ? 0 : value < count ? value : count - 1;
}

static const iso_voxel_bits *bits_at(const blur *b, int x, int y, int z) {
    return iso_mask_bits(b->mask, iso_hgrid_cell_index(b->grid, x, y, z));
}

static bool is_full(const iso_voxel_bits *bits) {
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        if (bits->row[row] != 0xffff) return false;
    return true;
}

/* Whether a cell and the 26 around it are all frozen, or all free. */
static bool is_uniform(const blur *b, const int at[3]) {
    const iso_voxel_bits *own = bits_at(b, at[0], at[1], at[2]);
    if (own && !is_full(own)) return false;
    for (int i = 0; i < 27; i++) {
        const iso_voxel_bits *bits = bits_at(b, clamp(at[0] + i % 3 - 1, b->grid->cells[0]),
                                             clamp(at[1] + i / 3 % 3 - 1, b->grid->cells[1]),
                                             clamp(at[2] + i / 9 - 1, b->grid->cells[2]));
        if (own ? !bits || !is_full(bits) : bits != NULL) return false;
    }
    return true;
}

static void fill_row(blur *b, const int at[3], int y, int z) {
    const int *dims = b->grid->dims;
    const int vy = clamp(ISO_BRICK * at[1] + y - b->reach, dims[1]),
              vz = clamp(ISO_BRICK * at[2] + z - b->reach, dims[2]);
    const int row = vz % ISO_BRICK * ISO_BRICK + vy % ISO_BRICK;
    for (int x = 0; x < b->side; x++) {
        const int vx = clamp(ISO_BRICK * at[0] + x - b->reach, dims[0]);
        const iso_voxel_bits *bits = bits_at(b, vx / ISO_BRICK, vy / ISO_BRICK, vz / ISO_BRICK);
        b->frozen[z][y][x] = bits ? bits->row[row] >> vx % ISO_BRICK & 1 : 0;
    }
}

/* Adds `value`, weighted by how near it is, to the sums of a line of the cell. */
#define SPREAD(value, from, sum)                                                                             \
    for (int k = 0; k < ISO_BRICK; k++) {                                                                    \
        const int away = (from)-b->reach - k, weight = b->reach + 1 - (away < 0 ? -away : away);             \
        (sum) += weight > 0 ? (uint32_t)weight * (value) : 0;                                                \
    }

static void sum_window(blur *b, const int at[3]) {
    memset(b->rows, 0, sizeof b->rows);
    memset(b->planes, 0, sizeof b->planes);
    for (int z = 0; z < b->side; z++)
        for (int y = 0; y < b->side; y++) {
            fill_row(b, at, y, z);
            for (int x = 0; x < b->side; x++)
                if (b->frozen[z][y][x]) SPREAD(1u, x, b->rows[z][y][k])
        }
    for (int z = 0; z < b->side; z++)
        for (int y = 0; y < b->side; y++)
            for (int x = 0; x < ISO_BRICK; x++)
                if (b->rows[z][y][x]) SPREAD(b->rows[z][y][x], y, b->planes[z][k][x])
}

static void blur_cell(blur *b, const int at[3], iso_voxel_bits *bits) {
    const uint32_t all = (uint32_t)((b->reach + 1) * (b->reach + 1));
    *bits = (iso_voxel_bits){{0}};
    sum_window(b, at);
    for (int y = 0; y < ISO_BRICK; y++)
        for (int x = 0; x < ISO_BRICK; x++) {
            uint32_t sums[ISO_BRICK] = {0};
            for (int z = 0; z < b->side; z++)
                if (b->planes[z][y][x]) SPREAD(b->planes[z][y][x], z, sums[k])
            for (int z = 0; z < ISO_BRICK; z++)
                if (2 * sums[z] > all * all * all)
                    bits->row[z * ISO_BRICK + y] = (uint16_t)(bits->row[z * ISO_BRICK + y] | 1u << x);
        }
}
#undef SPREAD

static bool differs(const iso_voxel_bits *before, const iso_voxel_bits *after) {
    static const iso_voxel_bits none;
    return memcmp(before ? before : &none, after, sizeof none) != 0;
}

static iso_status add_cell(iso_buffer *changed, size_t *count, const iso_mask_cell *cell, iso_error *error) {
    const size_t bytes = *count * sizeof *cell;
    ISO_TRY(iso_buffer_reserve(changed, bytes + sizeof *cell, bytes, error));
    ((iso_mask_cell *)changed->data)[(*count)++] = *cell;
    return ISO_OK;
}

static iso_status blur_all(blur *b, iso_buffer *changed, size_t *count, size_t *looked_at, iso_error *error) {
    int at[3];
    for (size_t cell = 0; cell < b->mask->cells; cell++) {
        iso_mask_cell made = {.cell = (uint32_t)cell};
        iso_hgrid_cell_position(b->grid, cell, at);
        if (is_uniform(b, at)) continue;
        ++*looked_at;
        blur_cell(b, at, &made.bits);
        if (!differs(iso_mask_bits(b->mask, cell), &made.bits)) continue;
        ISO_TRY(add_cell(changed, count, &made, error));
    }
    return ISO_OK;
}

iso_status iso_mask_blur(const iso_mask *mask, const iso_hgrid *grid, int reach, iso_buffer *changed,
                         size_t *count, size_t *looked_at, iso_error *error) {
    blur *b = iso_alloc(sizeof *b);
    if (!b) return iso_fail_memory(error, "smoothing the mask");
    b->mask = mask;
    b->grid = grid;
    b->reach = reach;
    b->side = ISO_BRICK + 2 * reach;
    const iso_status status = blur_all(b, changed, count, looked_at, error);
    iso_free(b);
    return status;
}

/* ---- voxels of a set */

/* The index in the set of voxel 0 of the grid, and what it grows by for each further one: both have the same
 * axes. */
static void place_set(const iso_hgrid *grid, const iso_voxel_set *set, double first[3], double *step) {
    const iso_affine affine = iso_transform_affine(&grid->transform);
    const double voxel = grid->transform.spacing[0];
    const iso_vec3 from = {affine.origin[0] - set->origin.x, affine.origin[1] - set->origin.y,
                           affine.origin[2] - set->origin.z};
    for (int axis = 0; axis < 3; axis++) {
        const iso_vec3 along = {affine.m[axis] / voxel, affine.m[3 + axis] / voxel,
                                affine.m[6 + axis] / voxel};
        first[axis] = iso_vec3_dot(along, from) / set->spacing;
    }
    *step = voxel / set->spacing;
}

static void add_voxels(const iso_hgrid *grid, const iso_voxel_set *set, const int at[3],
                       iso_voxel_bits *bits) {
    double first[3], step;
    int index[3][ISO_BRICK];
    place_set(grid, set, first, &step);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < ISO_BRICK; i++)
            index[axis][i] = (int)fmax(
                -1, fmin(floor(first[axis] + (ISO_BRICK * at[axis] + i) * step + 0.5), set->dims[axis]));
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x++)
            if (iso_voxel_set_has(set, index[0][x], index[1][row % ISO_BRICK], index[2][row / ISO_BRICK]))
                bits->row[row] = (uint16_t)(bits->row[row] | 1u << x);
}

iso_status iso_mask_add_voxels(const iso_mask *mask, const iso_hgrid *grid, const iso_voxel_set *set,
                               iso_buffer *changed, size_t *count, size_t *looked_at, iso_error *error) {
    int at[3];
    for (size_t cell = 0; cell < mask->cells; cell++) {
        const iso_voxel_bits *before = iso_mask_bits(mask, cell);
        iso_mask_cell made = {.cell = (uint32_t)cell};
        if (before) made.bits = *before;
        iso_hgrid_cell_position(grid, cell, at);
        add_voxels(grid, set, at, &made.bits);
        if (differs(before, &made.bits)) ISO_TRY(add_cell(changed, count, &made, error));
    }
    *looked_at += mask->cells;
    return ISO_OK;
}
