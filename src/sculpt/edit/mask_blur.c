/* Smooths masks: a tent filter of three passes around each cell near the mask's border, and a threshold. */
#include "sculpt/edit/mask_blur.h"

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

static iso_status blur_all(blur *b, iso_buffer *changed, size_t *count, size_t *looked_at, iso_error *error) {
    int at[3];
    for (size_t cell = 0; cell < b->mask->cells; cell++) {
        iso_blurred_cell made = {.cell = (uint32_t)cell};
        iso_hgrid_cell_position(b->grid, cell, at);
        if (is_uniform(b, at)) continue;
        ++*looked_at;
        blur_cell(b, at, &made.bits);
        if (!differs(iso_mask_bits(b->mask, cell), &made.bits)) continue;
        const size_t bytes = *count * sizeof made;
        ISO_TRY(iso_buffer_reserve(changed, bytes + sizeof made, bytes, error));
        ((iso_blurred_cell *)changed->data)[(*count)++] = made;
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
