/* foot_kernel: sets the neighbours of a brick, and computes irregular voxels one by one; includes the kernel
 * body (foot_kernel_body.inc) once per instruction set. */
#include "extract/points/foot_kernel.h"

#include <math.h>
#include <string.h>

#include "base/point_code.h"
#include "base/simd.h"

#define SAME_16(v)                                                                                           \
    { v, v, v, v, v, v, v, v, v, v, v, v, v, v, v, v }
_Alignas(64) static const float missing_row[ISO_BRICK] = SAME_16(NAN);
_Alignas(64) static const float clamped_row[ISO_BRICK] = SAME_16(INFINITY);

/* The voxels beyond face number `side` (-x, +x, -y, +y, -z, +z) of a brick. */
static iso_foot_face face_of(const iso_hgrid *grid, const int cell[3], int side) {
    static const size_t across[3] = {0xff0, 0xf00, 0x0f0}; /* offset bits of a face's axes, without x */
    int at[3] = {cell[0], cell[1], cell[2]}, axis = side / 2, up = side % 2;
    at[axis] += up ? 1 : -1;
    if (at[axis] < 0 || at[axis] >= grid->cells[axis]) return (iso_foot_face){missing_row, 0};
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
    if (number < 0) return (iso_foot_face){clamped_row, 0};
    size_t last = (size_t)(ISO_BRICK - 1) << 4 * axis;
    return (iso_foot_face){iso_hgrid_brick(grid, number) + (up ? 0 : last), across[axis]};
}

/* Returns the brick's values or, if the brick reaches beyond the grid, a copy in scratch->padded with NaN
 * there. */
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
    for (int side = 0; side < 6; side++) out->face[side] = face_of(grid, cell, side);
}

/* Reads the values of the voxel at offset o of the brick and of its neighbours. */
static void read_stencil(const iso_foot_brick *brick, size_t o, iso_foot_stencil *stencil) {
    stencil->centre = brick->values[o];
    for (int axis = 0; axis < 3; axis++) {
        const iso_foot_face *low = &brick->face[2 * axis], *high = low + 1;
        size_t step = (size_t)1 << 4 * axis, at = o >> 4 * axis & 15, x = axis ? o & 15 : 0;
        stencil->voxel[axis] = (int)at;
        stencil->low[axis] = at > 0 ? brick->values[o - step] : low->base[(o & low->mask) + x];
        stencil->high[axis] = at < 15 ? brick->values[o + step] : high->base[(o & high->mask) + x];
    }
}

/* A half row (eight voxels of a row of a brick) and its neighbours. */
typedef struct foot_half_row {
    uint32_t hits; /* bits of the voxels in the band */
    int32_t voxel; /* number of its first voxel in the brick */
    const float *here, *low_y, *high_y, *low_z, *high_z;
    const float *before, *after; /* the voxels before its first and after its last along x */
} foot_half_row;

/* The x neighbours of a half row's ends, before[half] and after[half] for the two halves of a row: they lie
 * in the brick or beyond its face. The table replaces branches, which could not be predicted. A face is read
 * only for a voxel in the band (else the entry inside the brick is taken), because each row of a face is
 * another cache line. */
typedef struct foot_ends {
    iso_foot_face before[2], after[2];
} foot_ends;

static inline foot_ends half_row_ends(const iso_foot_brick *brick) {
    const iso_foot_face low = {brick->values + 7, 0xff0}, high = {brick->values + 8, 0xff0};
    return (foot_ends){{brick->face[0], low}, {high, brick->face[1]}};
}

static inline foot_half_row half_row_of(const iso_foot_scratch *scratch, const foot_ends *ends,
                                        size_t number) {
    const size_t row = number >> 1, half = number & 1, o = number * 8;
    const uint32_t hits = scratch->hits[number];
    const float *const *at = scratch->rows + row + (row & 0xf0) + ISO_FOOT_PITCH + ISO_FOOT_FIRST;
    const iso_foot_face *before = &ends->before[half | (~hits & 1)], *after = &ends->after[half & hits >> 7];
    return (foot_half_row){.hits = hits,
                           .voxel = (int32_t)o,
                           .here = at[0] + 8 * half,
                           .low_y = at[-1] + 8 * half,
                           .high_y = at[1] + 8 * half,
                           .low_z = at[-ISO_FOOT_PITCH] + 8 * half,
                           .high_z = at[ISO_FOOT_PITCH] + 8 * half,
                           .before = before->base + (o & before->mask),
                           .after = after->base + (o & after->mask)};
}

/* Prefetches a cache line into the second-level cache. */
#define PREFETCH(place) __builtin_prefetch(place, 0, 1)

/* Writes the positions of the set bits, plus `first`, to `list`; returns how many there are. Writes four at a
 * time, to need fewer branches: `list` needs room for four more items. */
static inline uint32_t list_bits(uint64_t bits, uint32_t first, uint16_t *list) {
    const uint32_t count = (uint32_t)__builtin_popcountll(bits);
    for (uint32_t n = 0; n < count; n += 4)
        for (uint32_t k = 0; k < 4; k++) {
            list[n + k] = (uint16_t)(first + (uint32_t)__builtin_ctzll(bits | (uint64_t)1 << 63));
            bits &= bits - 1;
        }
    return count;
}

/* The bit that marks irregular voxels of the queue: iso_foot_is_regular is false for them, because the
 * gradient is not that of a distance field or a neighbour is missing. */
enum { IRREGULAR = ISO_BRICK_VOXELS };

/* Marks the irregular voxels of the queue, and replaces their differences by 1, so that the vectors with them
 * can be computed. */
static void mark_irregular(iso_foot_scratch *scratch, uint32_t queued) {
    for (uint32_t i = 0; i < queued; i++) {
        const float x = scratch->queue[1][i], y = scratch->queue[2][i], z = scratch->queue[3][i];
        if (iso_foot_is_regular(0.25f * (x * x + y * y + z * z))) continue;
        scratch->voxel[i] |= IRREGULAR;
        scratch->scale[i] = 1;
        for (int axis = 1; axis <= 3; axis++) scratch->queue[axis][i] = 1;
    }
}

/* Replaces the points of the marked voxels by those of iso_foot_point, or removes them where it rejects the
 * voxel; closes the gaps in the output and in scratch->voxel, and sets output->count. */
static void replace_irregular(const iso_foot_surface *surface, const iso_foot_brick *brick,
                              iso_foot_scratch *scratch, uint32_t queued, iso_foot_output *output) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < queued; i++) {
        if (!(scratch->voxel[i] & IRREGULAR)) {
            if (output->packed) output->packed[kept] = output->packed[i];
            if (output->surfels) output->surfels[kept] = output->surfels[i];
            scratch->voxel[kept++] = scratch->voxel[i];
            continue;
        }
        iso_foot_stencil stencil;
        iso_surfel surfel;
        const int32_t voxel = scratch->voxel[i] & ~IRREGULAR;
        read_stencil(brick, (size_t)voxel, &stencil);
        if (!iso_foot_point(surface, &stencil, &surfel)) continue;
        if (output->packed) output->packed[kept] = iso_point_pack(&surfel);
        if (output->surfels) output->surfels[kept] = surfel;
        scratch->voxel[kept++] = voxel;
    }
    output->count = kept;
}

/* The number of the brick's voxels in the band. */
static uint32_t count_hits(const iso_foot_scratch *scratch) {
    uint32_t count = 0;
    for (int i = 0; i < ISO_FOOT_HALF_ROWS; i += 8) {
        uint64_t hits;
        memcpy(&hits, scratch->hits + i, sizeof hits);
        count += (uint32_t)__builtin_popcountll(hits);
    }
    return count;
}

#include "extract/points/foot_kernel_lanes.inc"

#define ISO_KERNEL_BODY "extract/points/foot_kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_foot_kernel *iso_foot_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
