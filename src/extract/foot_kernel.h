/* foot_kernel: foot points of one hgrid brick, as fast as memory allows.
 *
 * One kernel body (foot_kernel_body.inc), included once per instruction set; every variant gives the same
 * bytes, which are also those of iso_foot_points_direct. The brick's voxels are compared with the band a
 * vector at a time, which leaves a list of the vectors that have any; these queue their voxels' central
 * differences, compressed, and the arithmetic of eq. 1 (Baerentzen and Christensen 2003) then runs on full
 * vectors of the queue. Voxels whose stencil is not plain (NaN, the grid's border) leave the vectors for
 * iso_foot_point. Internal to extract. */
#ifndef ISO_EXTRACT_FOOT_KERNEL_H
#define ISO_EXTRACT_FOOT_KERNEL_H

#include "base/cpu.h"
#include "extract/foot_points.h"
#include "grids/hgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where voxels' neighbours on one side are: that of offset o in the brick is base[(o + shift) & mask]. */
typedef struct iso_foot_side {
    const float *base;
    size_t shift, mask;
} iso_foot_side;

/* A brick and its surroundings. A voxel beyond the grid reads as NaN, one of an empty cell as infinity: the
 * first counts as missing and the second as clamped, like a stored +-band. */
typedef struct iso_foot_brick {
    const float *values;      /* 4096, 64-byte aligned */
    iso_foot_side side[6][2]; /* -x, +x, -y, +y, -z, +z: of voxels inside the brick, and at its face there */
    const float *next;        /* the brick to fetch into the cache meanwhile, any readable one */
} iso_foot_brick;

/* Room for whole vectors beyond the most that a brick can have. */
enum { ISO_FOOT_ROOM = ISO_BRICK_VOXELS + 16 };

/* One worker's. */
typedef struct iso_foot_scratch {
    _Alignas(64) float padded[ISO_BRICK_VOXELS];
    _Alignas(64) float centre[ISO_FOOT_ROOM];
    float difference[3][ISO_FOOT_ROOM]; /* upper less lower neighbour */
    int32_t voxel[ISO_FOOT_ROOM];       /* z << 8 | y << 4 | x */
    uint16_t unit[ISO_BRICK_VOXELS / 8 + 1];
    uint16_t mask[ISO_BRICK_VOXELS / 8 + 1];
} iso_foot_scratch;

/* Exactly one of the two arrays, each with ISO_FOOT_ROOM places. */
typedef struct iso_foot_output {
    iso_point *packed;
    iso_surfel *surfels;
    uint32_t count, rejected;
} iso_foot_output;

typedef struct iso_foot_kernel {
    /* Makes the brick's points, in z, y, x order of their voxels; sets output->count and ->rejected. */
    void (*extract)(const iso_foot_surface *surface, const iso_foot_brick *brick, iso_foot_scratch *scratch,
                    iso_foot_output *output);
} iso_foot_kernel;

/* The kernel at an instruction set, NULL when this build does not have it. */
const iso_foot_kernel *iso_foot_kernel_get(iso_cpu_level level);

/* Fills `out` (all but next) for cell (x, y, z), which has a brick. A brick that sticks out of the grid is
 * copied into scratch->padded with NaN beyond it. */
void iso_foot_brick_of(const iso_hgrid *grid, const int cell[3], iso_foot_scratch *scratch,
                       iso_foot_brick *out);

#ifdef __cplusplus
}
#endif
#endif
