/* foot_kernel: foot points of one hgrid brick, as fast as memory allows.
 *
 * One kernel body (foot_kernel_body.inc), included once per instruction set; every variant gives the same
 * bytes, which are also those of iso_foot_points_direct. The brick's voxels are compared with the band a
 * vector at a time, which leaves a list of the vectors that have any; these queue their voxels' central
 * differences, compressed, and the arithmetic of eq. 1 (Baerentzen and Christensen 2003) then runs on full
 * vectors of the queue. Voxels whose stencil is not plain (NaN, the grid's border) leave the vectors for
 * iso_foot_point. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_FOOT_KERNEL_H
#define ISO_EXTRACT_POINTS_FOOT_KERNEL_H

#include <stdalign.h>

#include "base/cpu.h"
#include "extract/points/foot_points.h"
#include "grids/hgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The voxels next to one face of a brick: that next to offset o (x fastest) is base[o & mask] for the faces
 * in x, and base[(o & mask) + x] for those in y and z. */
typedef struct iso_foot_face {
    const float *base;
    size_t mask;
} iso_foot_face;

/* A brick and its surroundings. A voxel beyond the grid reads as NaN, one of an empty cell as infinity: the
 * first counts as missing and the second as clamped, like a stored +-band. */
typedef struct iso_foot_brick {
    const float *values;   /* 4096, 64-byte aligned */
    iso_foot_face face[6]; /* -x, +x, -y, +y, -z, +z */
    const float *next;     /* the brick to fetch into the cache meanwhile, any readable one */
} iso_foot_brick;

/* Room for whole vectors beyond the most that a brick can have. */
enum { ISO_FOOT_ROOM = 4352 };

enum {
    ISO_FOOT_UNITS = ISO_BRICK_VOXELS / 8, /* a unit: eight voxels, half a row */
    ISO_FOOT_PITCH = 32,                   /* of the table of rows */
    ISO_FOOT_FIRST = 8                     /* place of y = 0 in it */
};

/* One worker's. */
typedef struct iso_foot_scratch {
    alignas(64) float padded[ISO_BRICK_VOXELS];
    alignas(64) uint8_t hits[ISO_FOOT_UNITS]; /* bit per voxel of a unit: in the band */
    uint16_t units[ISO_FOOT_UNITS + 4];       /* those that have any */
    /* rows of the brick and of its neighbours: row (y, z) is number (z + 1) * ISO_FOOT_PITCH + ISO_FOOT_FIRST
     * + y */
    alignas(64) const float *rows[(ISO_BRICK + 2) * ISO_FOOT_PITCH];
    /* voxels in the band: the value, and on each axis the upper less the lower neighbour */
    alignas(64) float queue[4][ISO_FOOT_ROOM];
    alignas(64) int32_t voxel[ISO_FOOT_ROOM]; /* z << 8 | y << 4 | x */
    alignas(64) float scale[ISO_FOOT_ROOM];   /* differences to normal */
    alignas(64) float flat[ISO_FOOT_ROOM];    /* normal to octahedron */
} iso_foot_scratch;

/* Exactly one of the two arrays, each with ISO_FOOT_ROOM places. */
typedef struct iso_foot_output {
    iso_point *packed;
    iso_surfel *surfels;
    uint32_t count, rejected;
} iso_foot_output;

typedef struct iso_foot_kernel {
    /* Makes the brick's points, in z, y, x order of their voxels, which it leaves in scratch->voxel; sets
     * output->count and ->rejected. */
    void (*extract)(const iso_foot_surface *surface, const iso_foot_brick *brick, iso_foot_scratch *scratch,
                    iso_foot_output *output);
} iso_foot_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_foot_kernel *iso_foot_kernel_get(iso_cpu_level level);

/* Fills `out` (all but next) for cell (x, y, z), which has a brick. A brick that sticks out of the grid is
 * copied into scratch->padded with NaN beyond it. */
void iso_foot_brick_of(const iso_hgrid *grid, const int cell[3], iso_foot_scratch *scratch,
                       iso_foot_brick *out);

#ifdef __cplusplus
}
#endif
#endif
