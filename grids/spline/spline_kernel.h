/* spline_kernel: samples a spline at half the voxel spacing. Internal to grids/spline. */
#ifndef ISO_GRIDS_SPLINE_KERNEL_H
#define ISO_GRIDS_SPLINE_KERNEL_H

#include "base/cpu.h"
#include "grids/spline/spline.h"

/* The voxels (or coefficients) that a block's samples depend on: 15^3 from 3 before its first one, in rows of
 * 16 floats, of which the last is 0. */
enum { ISO_SPLINE_INPUT = 15, ISO_SPLINE_ROW = 16 };
typedef float iso_spline_input[ISO_SPLINE_INPUT * ISO_SPLINE_INPUT * ISO_SPLINE_ROW];

/* The weights of a sample at a voxel, of the voxels -2 .. 2 around it, and of one half a voxel further, of -2
 * .. 3. */
typedef struct iso_spline_weights {
    float at[5], between[6];
} iso_spline_weights;

typedef void iso_spline_sample_fn(const float *input, const iso_spline_weights *weights, float *samples);
/* Every instruction set gives the same bytes. */
ISO_KERNEL_UNITS(iso_spline_sample_fn, iso_spline_sample_units);

/* The inner 16^3 of a block's samples, which are negative inside, lowered so that their trilinear surface
 * encloses that of the spline. Every instruction set gives the same bytes. */
typedef void iso_spline_shell_fn(const float *samples, float *lowered);
ISO_KERNEL_UNITS(iso_spline_shell_fn, iso_spline_shell_units);

#endif
