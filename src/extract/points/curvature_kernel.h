/* curvature_kernel: from the voxels around points to curvatures, a vector of points at a time, for each
 * instruction set with the same bytes. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_CURVATURE_KERNEL_H
#define ISO_EXTRACT_POINTS_CURVATURE_KERNEL_H

#include <stdalign.h>
#include <stdbool.h>

#include "base/cpu.h"
#include "base/primitives.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_CURVATURE_BATCH = 128 };

/* Values around a point, by step along three axes (a, b, c): for edge points a is the edge's axis. */
enum {
    ISO_CURVATURE_HERE, /* 0 0 0, then its neighbours */
    ISO_CURVATURE_A0,
    ISO_CURVATURE_A1, /* - 0 0, + 0 0 */
    ISO_CURVATURE_B0,
    ISO_CURVATURE_B1,
    ISO_CURVATURE_C0,
    ISO_CURVATURE_C1,
    ISO_CURVATURE_A0B0,
    ISO_CURVATURE_A1B0,
    ISO_CURVATURE_A0B1,
    ISO_CURVATURE_A1B1,
    ISO_CURVATURE_A0C0,
    ISO_CURVATURE_A1C0,
    ISO_CURVATURE_A0C1,
    ISO_CURVATURE_A1C1,
    ISO_CURVATURE_B0C0,
    ISO_CURVATURE_B1C0,
    ISO_CURVATURE_B0C1,
    ISO_CURVATURE_B1C1,
    ISO_CURVATURE_VOXEL, /* count of the values that a voxel needs. The second end of an edge also needs: */
    ISO_CURVATURE_A2 = ISO_CURVATURE_VOXEL, /* ++ 0 0 */
    ISO_CURVATURE_A2B0,
    ISO_CURVATURE_A2B1,
    ISO_CURVATURE_A2C0,
    ISO_CURVATURE_A2C1,
    ISO_CURVATURE_A1B0C0,
    ISO_CURVATURE_A1B1C0,
    ISO_CURVATURE_A1B0C1,
    ISO_CURVATURE_A1B1C1,
    ISO_CURVATURE_EDGE
};

/* Points on their way through the kernel, as structure of arrays. */
typedef struct iso_curvature_batch {
    uint32_t count;
    alignas(64) int32_t value[ISO_CURVATURE_EDGE][ISO_CURVATURE_BATCH]; /* integers, or the bits of floats */
    float along[ISO_CURVATURE_BATCH];        /* edges: 0 .. 1 from end to end; feet: distance of the voxel */
    float normal[3][ISO_CURVATURE_BATCH];    /* surfels: unit, x y z */
    int32_t octahedral[ISO_CURVATURE_BATCH]; /* packed points: bits 42..63 */
    int32_t uu[ISO_CURVATURE_BATCH], uv[ISO_CURVATURE_BATCH], vv[ISO_CURVATURE_BATCH]; /* out: steps */
    int32_t extents[ISO_CURVATURE_BATCH]; /* out: as in iso_curvature */
} iso_curvature_batch;

typedef struct iso_curvature_params {
    bool floats; /* the values' type */
    bool packed; /* normals come from `octahedral` */
    int axis;    /* a; b and c are the others, ascending */
    float normal_sign, isovalue_ceil;
    float band; /* voxels: magnitude at and above which values are clamped; INFINITY when they are not */
} iso_curvature_params;

/* Both compute whole vectors: items from `count` on may hold anything. */
typedef struct iso_curvature_kernel {
    void (*edges)(const iso_curvature_params *params, iso_curvature_batch *batch);
    /* Curvatures at voxels of a float grid; sets extents to 0. */
    void (*voxels)(const iso_curvature_params *params, iso_curvature_batch *batch);
} iso_curvature_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_curvature_kernel *iso_curvature_kernel_get(iso_cpu_level level);

#ifdef __cplusplus
}
#endif
#endif
