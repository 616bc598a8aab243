/* foot_kernel: foot points of one hgrid brick.
 *
 * One source (foot_kernel.c), compiled once for each instruction set; every variant gives the same bytes,
 * which are also those of iso_foot_points_direct. First the brick's voxels are compared with the band, and
 * the half rows (eight voxels) that have a voxel in it are listed. Then the values and central differences
 * of the voxels in the band are queued, and eq. 1 (Baerentzen and Christensen 2003) is computed for the
 * queue in full vectors. Irregular voxels (NaN, the grid's border, gradients that are not those of a
 * distance field) are computed again one by one, with iso_foot_point. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_FOOT_KERNEL_H
#define ISO_EXTRACT_POINTS_FOOT_KERNEL_H

#include <stdalign.h>

#include "base/cpu.h"
#include "extract/points/foot_points.h"
#include "grids/hgrid.h"

/* The voxels beyond one face of a brick. The neighbour of the brick's voxel at offset o (x fastest) is
 * base[o & mask] beyond the faces in x, and base[(o & mask) + x] beyond those in y and z. */
typedef struct iso_foot_face {
    const float *base;
    size_t mask;
} iso_foot_face;

/* A brick and its neighbours. A voxel outside the grid is NaN, which counts as missing; a voxel of an empty
 * cell is infinity, which counts as clamped like a stored value of +-band. */
typedef struct iso_foot_brick {
    const float *values;   /* the brick's 4096 voxels, 64-byte aligned */
    iso_foot_face face[6]; /* -x, +x, -y, +y, -z, +z */
    const float *next;     /* voxels of the brick to be prefetched meanwhile; must be readable */
} iso_foot_brick;

/* Size of arrays for a brick's points: 4096, and room for whole vectors after them. */
enum { ISO_FOOT_ROOM = 4352 };

enum {
    ISO_FOOT_HALF_ROWS = ISO_BRICK_VOXELS / 8, /* a half row: eight voxels of a row */
    ISO_FOOT_PITCH = 32,                       /* entries of a slice in the table of rows */
    ISO_FOOT_FIRST = 8                         /* entry of y = 0 in a slice */
};

/* The working memory of one worker. */
typedef struct iso_foot_scratch {
    alignas(64) float padded[ISO_BRICK_VOXELS];
    alignas(64) uint8_t hits[ISO_FOOT_HALF_ROWS]; /* by half row: bits of its voxels that are in the band */
    uint16_t half_rows[ISO_FOOT_HALF_ROWS + 4];   /* numbers of the half rows with a voxel in the band */
    /* the rows (y, z) of the brick and those beyond its faces, y and z from -1 to 16: entry (z + 1) *
     * ISO_FOOT_PITCH + ISO_FOOT_FIRST + y */
    alignas(64) const float *rows[(ISO_BRICK + 2) * ISO_FOOT_PITCH];
    /* the queue of voxels in the band: values, and on each axis the upper minus the lower neighbour */
    alignas(64) float queue[4][ISO_FOOT_ROOM];
    alignas(64) int32_t voxel[ISO_FOOT_ROOM]; /* the queue's voxels: z << 8 | y << 4 | x */
    alignas(64) float scale[ISO_FOOT_ROOM];   /* factor from differences to unit normal */
    alignas(64) float flat[ISO_FOOT_ROOM];    /* factor from unit normal to |x| + |y| + |z| = 1 */
} iso_foot_scratch;

/* The points of a brick. The caller sets exactly one of the two arrays, with room for ISO_FOOT_ROOM
 * points. */
typedef struct iso_foot_output {
    iso_point *packed;
    iso_surfel *surfels;
    uint32_t count, rejected;
} iso_foot_output;

typedef struct iso_foot_kernel {
    /* Computes the brick's points, in z, y, x order of their voxels, and sets output->count and ->rejected.
     * scratch->voxel holds the points' voxels afterwards. */
    void (*extract)(const iso_foot_surface *surface, const iso_foot_brick *brick, iso_foot_scratch *scratch,
                    iso_foot_output *output);
} iso_foot_kernel;
ISO_KERNEL_UNITS(const iso_foot_kernel, iso_foot_kernel);

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_foot_kernel *iso_foot_kernel_get(iso_cpu_level level);

/* Sets `out`, except `next`, for a cell of the grid, which must have a brick. A brick that reaches beyond the
 * grid is copied to scratch->padded, with NaN beyond the grid. Borrows grid and scratch. */
void iso_foot_brick_of(const iso_hgrid *grid, const int cell[3], iso_foot_scratch *scratch,
                       iso_foot_brick *out);

#endif
