/* point_numbers: constants of packed points and curvatures (base/primitives.h), for C and GLSL. */
#ifndef ISO_BASE_POINT_NUMBERS_H
#define ISO_BASE_POINT_NUMBERS_H

/* Voxels along a brick's side. */
#define ISO_BRICK 16

/* Positions: a coordinate is ISO_POINT_LOW + ISO_POINT_STEP * bits, in voxels. */
#define ISO_POINT_COORDINATE_BITS 14
#define ISO_POINT_COORDINATE_STEPS 16384
#define ISO_POINT_RANGE 20.0f /* voxels */
#define ISO_POINT_LOW (-2.0f)
#define ISO_POINT_STEP (ISO_POINT_RANGE / 16384)

/* Octahedral normals (Meyer et al. 2010, "On floating-point normal vectors"): each of the two numbers,
 * -1 .. 1, is bits * (2 / ISO_POINT_NORMAL_STEPS) - 1. */
#define ISO_POINT_NORMAL_BITS 11
#define ISO_POINT_NORMAL_STEPS 2047

/* Curvatures: see iso_curvature. */
#define ISO_CURVATURE_STEP (1.0f / 8000)
#define ISO_CURVATURE_LOW_BITS 5
#define ISO_CURVATURE_TILT_BITS 7
#define ISO_CURVATURE_TILT_STEPS 63
#define ISO_CURVATURE_TILT_MOST 0.8f
#define ISO_CURVATURE_EXTENT_BITS 3
#define ISO_CURVATURE_EXTENT_STEPS 7
#define ISO_CURVATURE_AXIS_BIT 12
#define ISO_CURVATURE_AXIS_MASK 3
#define ISO_CURVATURE_SHRINK_BIT 14

#endif
