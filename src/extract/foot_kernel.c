#include "extract/foot_kernel.h"

#include <math.h>
#include <string.h>

#if ISO_HAVE_X86
#include <immintrin.h>
#endif

#define SAME_16(v)                                                                                           \
    { v, v, v, v, v, v, v, v, v, v, v, v, v, v, v, v }
_Alignas(64) static const float missing_row[ISO_BRICK] = SAME_16(NAN);
_Alignas(64) static const float clamped_row[ISO_BRICK] = SAME_16(INFINITY);

static void set_side(const iso_hgrid *grid, const int cell[3], int side, iso_foot_brick *out) {
    int at[3] = {cell[0], cell[1], cell[2]}, axis = side / 2, up = side % 2;
    size_t step = (size_t)1 << 4 * axis, across = (ISO_BRICK - 1) * step;
    out->side[side][0] = (iso_foot_side){out->values, up ? step : 0 - step, SIZE_MAX};
    /* all voxels of a face that is the same everywhere are in one row */
    out->side[side][1] = (iso_foot_side){missing_row, 0, ISO_BRICK - 1};
    at[axis] += up ? 1 : -1;
    if (at[axis] < 0 || at[axis] >= grid->cells[axis]) return;
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
    out->side[side][1].base = clamped_row;
    if (number < 0) return;
    out->side[side][1] = (iso_foot_side){iso_hgrid_brick(grid, number), up ? 0 - across : across, SIZE_MAX};
}

static const float *pad_brick(const iso_hgrid *grid, const int cell[3], const float *values,
                              iso_foot_scratch *scratch) {
    int n[3];
    for (int axis = 0; axis < 3; axis++) n[axis] = grid->dims[axis] - cell[axis] * ISO_BRICK;
    if (n[0] >= ISO_BRICK && n[1] >= ISO_BRICK && n[2] >= ISO_BRICK) return values;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        bool inside = (i & 15) < n[0] && (i >> 4 & 15) < n[1] && i >> 8 < n[2];
        scratch->padded[i] = inside ? values[i] : NAN;
    }
    return scratch->padded;
}

void iso_foot_brick_of(const iso_hgrid *grid, const int cell[3], iso_foot_scratch *scratch,
                       iso_foot_brick *out) {
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, cell[0], cell[1], cell[2])];
    out->values = out->next = pad_brick(grid, cell, iso_hgrid_brick(grid, number), scratch);
    for (int side = 0; side < 6; side++) set_side(grid, cell, side, out);
}

/* The neighbour of the voxel at offset o, or of a row that begins there. No branches: which rows are at a
 * face cannot be predicted. */
static inline const float *neighbour(const iso_foot_brick *brick, int side, size_t o) {
    size_t at = o >> (side / 2 * 4) & (ISO_BRICK - 1);
    const iso_foot_side *where = &brick->side[side][at == (side % 2 ? ISO_BRICK - 1 : 0)];
    return where->base + ((o + where->shift) & where->mask);
}

/* One voxel's, as iso_foot_point takes them. */
static void stencil_of(const iso_foot_brick *brick, int voxel, iso_foot_stencil *stencil) {
    stencil->centre = brick->values[voxel];
    for (int axis = 0; axis < 3; axis++) {
        stencil->voxel[axis] = voxel >> (4 * axis) & (ISO_BRICK - 1);
        stencil->low[axis] = *neighbour(brick, 2 * axis, (size_t)voxel);
        stencil->high[axis] = *neighbour(brick, 2 * axis + 1, (size_t)voxel);
    }
}

/* Some of the queue's voxels did not go through the vectors' arithmetic: each again by itself, the others
 * closing up in place. */
static void settle_irregular(const iso_foot_surface *surface, const iso_foot_brick *brick,
                             const iso_foot_scratch *scratch, uint32_t queued, iso_foot_output *output) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < queued; i++) {
        const float x = 0.5f * scratch->difference[0][i], y = 0.5f * scratch->difference[1][i],
                    z = 0.5f * scratch->difference[2][i];
        if (iso_foot_is_regular(x * x + y * y + z * z)) {
            if (output->packed) output->packed[kept] = output->packed[i];
            if (output->surfels) output->surfels[kept] = output->surfels[i];
            kept++;
            continue;
        }
        iso_foot_stencil stencil;
        iso_surfel surfel;
        stencil_of(brick, scratch->voxel[i], &stencil);
        if (!iso_foot_point(surface, &stencil, &surfel)) continue;
        if (output->packed) output->packed[kept] = iso_point_pack(&surfel);
        if (output->surfels) output->surfels[kept] = surfel;
        kept++;
    }
    output->count = kept;
}

#include "extract/foot_kernel_variants.inc"

static const iso_foot_kernel kernels[] = {
    [ISO_CPU_GENERIC] = {extract_generic},
#if ISO_HAVE_X86
    [ISO_CPU_AVX2] = {extract_avx2},
    [ISO_CPU_AVX512] = {extract_avx512},
#endif
};

const iso_foot_kernel *iso_foot_kernel_get(iso_cpu_level level) {
    return (size_t)level < sizeof kernels / sizeof kernels[0] ? &kernels[level] : NULL;
}
