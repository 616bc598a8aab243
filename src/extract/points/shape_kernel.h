/* shape_kernel: from the voxels around points to shapes, a vector of points at a time, for each instruction
 * set with the same bytes. Internal to extract. */
#ifndef ISO_EXTRACT_SHAPE_KERNEL_H
#define ISO_EXTRACT_SHAPE_KERNEL_H

#include <stdalign.h>
#include <stdbool.h>

#include "base/cpu.h"
#include "base/primitives.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_SHAPE_BATCH = 128 };

/* Values around a point, by step along three axes (a, b, c): for edge points a is the edge's axis. */
enum {
    ISO_SHAPE_HERE, /* 0 0 0, then its neighbours */
    ISO_SHAPE_A0,
    ISO_SHAPE_A1, /* - 0 0, + 0 0 */
    ISO_SHAPE_B0,
    ISO_SHAPE_B1,
    ISO_SHAPE_C0,
    ISO_SHAPE_C1,
    ISO_SHAPE_A0B0,
    ISO_SHAPE_A1B0,
    ISO_SHAPE_A0B1,
    ISO_SHAPE_A1B1,
    ISO_SHAPE_A0C0,
    ISO_SHAPE_A1C0,
    ISO_SHAPE_A0C1,
    ISO_SHAPE_A1C1,
    ISO_SHAPE_B0C0,
    ISO_SHAPE_B1C0,
    ISO_SHAPE_B0C1,
    ISO_SHAPE_B1C1,
    ISO_SHAPE_VOXEL,                /* as many as a voxel needs; the other end of an edge needs besides: */
    ISO_SHAPE_A2 = ISO_SHAPE_VOXEL, /* ++ 0 0 */
    ISO_SHAPE_A2B0,
    ISO_SHAPE_A2B1,
    ISO_SHAPE_A2C0,
    ISO_SHAPE_A2C1,
    ISO_SHAPE_A1B0C0,
    ISO_SHAPE_A1B1C0,
    ISO_SHAPE_A1B0C1,
    ISO_SHAPE_A1B1C1,
    ISO_SHAPE_EDGE
};

typedef struct iso_shape_batch {
    uint32_t count;
    alignas(64) int32_t value[ISO_SHAPE_EDGE][ISO_SHAPE_BATCH]; /* integers, or the bits of floats */
    float along[ISO_SHAPE_BATCH];        /* edges: 0 .. 1 from end to end; feet: distance of the voxel */
    float normal[3][ISO_SHAPE_BATCH];    /* surfels: unit, x y z */
    int32_t octahedral[ISO_SHAPE_BATCH]; /* packed points: bits 42..63 */
    int32_t uu[ISO_SHAPE_BATCH], uv[ISO_SHAPE_BATCH], vv[ISO_SHAPE_BATCH]; /* out: steps */
    int32_t ends[ISO_SHAPE_BATCH];                                         /* out: as in iso_shape */
} iso_shape_batch;

typedef struct iso_shape_job {
    bool floats; /* the values' type */
    bool packed; /* normals come from `octahedral` */
    int axis;    /* a; b and c are the others, ascending */
    float outward, at;
    float band; /* voxels: magnitude at and above which values are clamped; INFINITY when they are not */
} iso_shape_job;

/* Whole vectors are computed: what lies beyond `count` may be anything. */
typedef struct iso_shape_kernel {
    void (*edges)(const iso_shape_job *job, iso_shape_batch *batch);
    /* Of floats. */
    void (*voxels)(const iso_shape_job *job, iso_shape_batch *batch);
} iso_shape_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_shape_kernel *iso_shape_kernel_get(iso_cpu_level level);

#ifdef __cplusplus
}
#endif
#endif
