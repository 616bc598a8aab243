/* curvature_kernel: computes curvatures from the voxels around points, a vector of points at a time. The same
 * bytes for each instruction set. The method is described in curvature.h. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_CURVATURE_KERNEL_H
#define ISO_EXTRACT_POINTS_CURVATURE_KERNEL_H

#include <stdalign.h>
#include <stdbool.h>

#include "base/cpu.h"
#include "base/primitives.h"

enum { ISO_CURVATURE_BATCH = 128 };

/* The numbers of the values around a point. A name is an offset from HERE along three axes a, b, c: B0 is one
 * voxel down along b, B1 one up, A2 two up along a. For edge points a is the edge's axis and HERE the edge's
 * lower end; b and c are the other axes, ascending. */
enum {
    ISO_CURVATURE_HERE,
    ISO_CURVATURE_A0,
    ISO_CURVATURE_A1,
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
    ISO_CURVATURE_VOXEL, /* how many values a voxel needs; an edge needs those below, too */
    ISO_CURVATURE_A2 = ISO_CURVATURE_VOXEL,
    ISO_CURVATURE_A2B0,
    ISO_CURVATURE_A2B1,
    ISO_CURVATURE_A2C0,
    ISO_CURVATURE_A2C1,
    ISO_CURVATURE_A1B0C0,
    ISO_CURVATURE_A1B1C0,
    ISO_CURVATURE_A1B0C1,
    ISO_CURVATURE_A1B1C1,
    ISO_CURVATURE_EDGE /* how many values an edge needs */
};

/* The kernel's input and output for up to ISO_CURVATURE_BATCH points, as a structure of arrays. */
typedef struct iso_curvature_batch {
    uint32_t count;
    alignas(64) int32_t value[ISO_CURVATURE_EDGE][ISO_CURVATURE_BATCH]; /* integers, or the bits of floats */
    float along[ISO_CURVATURE_BATCH]; /* edges: position on the edge, 0 .. 1; feet: distance of the voxel */
    float normal[3][ISO_CURVATURE_BATCH];    /* surfels: unit, x y z */
    int32_t octahedral[ISO_CURVATURE_BATCH]; /* packed points: their normal, bits 42 .. 63 */
    /* output: the fields of iso_curvature */
    int32_t uu[ISO_CURVATURE_BATCH], uv[ISO_CURVATURE_BATCH], vv[ISO_CURVATURE_BATCH];
    int32_t extents[ISO_CURVATURE_BATCH];
} iso_curvature_batch;

typedef struct iso_curvature_params {
    bool floats; /* `value` holds the bits of floats, not integers */
    bool packed; /* normals are in `octahedral`, not in `normal` */
    int axis;    /* the axis a */
    float normal_sign, isovalue_ceil;
    float band; /* foot points: the magnitude from which on values are clamped; INFINITY: none are */
} iso_curvature_params;

/* Both functions compute whole vectors: the arrays' items from `count` on may have any value. */
typedef struct iso_curvature_kernel {
    /* Curvatures of edge points. */
    void (*edges)(const iso_curvature_params *params, iso_curvature_batch *batch);
    /* Curvatures of foot points, at their voxels of a float grid; sets extents to 0. */
    void (*voxels)(const iso_curvature_params *params, iso_curvature_batch *batch);
} iso_curvature_kernel;

ISO_KERNEL_UNITS(const iso_curvature_kernel, iso_curvature_kernel);

#endif
