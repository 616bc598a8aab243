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

static void set_face(const iso_hgrid *grid, const int cell[3], int face, iso_foot_brick *out) {
    int at[3] = {cell[0], cell[1], cell[2]}, axis = face / 2;
    at[axis] += face % 2 ? 1 : -1;
    out->varies[face] = 0;
    out->face[face] = missing_row;
    if (at[axis] < 0 || at[axis] >= grid->cells[axis]) return;
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
    out->face[face] = number < 0 ? clamped_row : iso_hgrid_brick(grid, number);
    if (number >= 0) out->varies[face] = SIZE_MAX;
}

void iso_foot_brick_of(const iso_hgrid *grid, const int cell[3], iso_foot_scratch *scratch,
                       iso_foot_brick *out) {
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, cell[0], cell[1], cell[2])];
    out->values = iso_hgrid_brick(grid, number);
    for (int face = 0; face < 6; face++) set_face(grid, cell, face, out);
    int n[3];
    for (int axis = 0; axis < 3; axis++) n[axis] = grid->dims[axis] - cell[axis] * ISO_BRICK;
    if (n[0] >= ISO_BRICK && n[1] >= ISO_BRICK && n[2] >= ISO_BRICK) return;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        bool inside =
            i % ISO_BRICK < n[0] && i / ISO_BRICK % ISO_BRICK < n[1] && i / (ISO_BRICK * ISO_BRICK) < n[2];
        scratch->padded[i] = inside ? out->values[i] : NAN;
    }
    out->values = scratch->padded;
}

enum { ROW = ISO_BRICK, SLICE = ISO_BRICK * ISO_BRICK };

/* Rows next to the row at offset o (a multiple of 16, or 8 more) of a brick. */
static inline const float *below_y(const iso_foot_brick *brick, size_t o) {
    const float *face = brick->face[2] + (((o & ~(size_t)(SLICE - 1)) + SLICE - ROW) & brick->varies[2]);
    return o & (SLICE - ROW) ? brick->values + o - ROW : face + (o & (ROW - 1));
}
static inline const float *above_y(const iso_foot_brick *brick, size_t o) {
    const float *face = brick->face[3] + ((o & ~(size_t)(SLICE - 1)) & brick->varies[3]);
    return (o & (SLICE - ROW)) != SLICE - ROW ? brick->values + o + ROW : face + (o & (ROW - 1));
}
static inline const float *below_z(const iso_foot_brick *brick, size_t o) {
    const float *face =
        brick->face[4] + ((ISO_BRICK_VOXELS - SLICE + (o & (SLICE - ROW))) & brick->varies[4]);
    return o >= SLICE ? brick->values + o - SLICE : face + (o & (ROW - 1));
}
static inline const float *above_z(const iso_foot_brick *brick, size_t o) {
    const float *face = brick->face[5] + ((o & (SLICE - ROW)) & brick->varies[5]);
    return o < ISO_BRICK_VOXELS - SLICE ? brick->values + o + SLICE : face + (o & (ROW - 1));
}
/* Before the first and after the last voxel of the row that offset o lies in. */
static inline float before_row(const iso_foot_brick *brick, size_t o) {
    return brick->face[0][(o | (ROW - 1)) & brick->varies[0]];
}
static inline float after_row(const iso_foot_brick *brick, size_t o) {
    return brick->face[1][(o & ~(size_t)(ROW - 1)) & brick->varies[1]];
}

/* A voxel and its neighbours as iso_foot_point takes them. */
static void stencil_of(const iso_foot_brick *brick, int voxel, iso_foot_stencil *stencil) {
    size_t o = (size_t)voxel, x = o & (ROW - 1), row = o - x;
    for (int axis = 0; axis < 3; axis++) stencil->voxel[axis] = voxel >> (4 * axis) & (ISO_BRICK - 1);
    stencil->centre = brick->values[o];
    stencil->low[0] = x > 0 ? brick->values[o - 1] : before_row(brick, o);
    stencil->high[0] = x < ROW - 1 ? brick->values[o + 1] : after_row(brick, o);
    stencil->low[1] = below_y(brick, row)[x];
    stencil->high[1] = above_y(brick, row)[x];
    stencil->low[2] = below_z(brick, row)[x];
    stencil->high[2] = above_z(brick, row)[x];
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
