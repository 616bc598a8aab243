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

/* The samples of a block, and their shell. */
typedef struct iso_spline_shell {
    float
        *samples; /* become values that are negative inside: of a level set above the isovalue, else below */
    float isovalue;
    bool level_set;
    float *values; /* NULL, or, if not all samples are inside, the shell's: the inner 16^3, lowered so
                                that their trilinear surface encloses the spline's */
    int inside, outside, lowered; /* numbers of samples; of values that are inside */
} iso_spline_shell;

typedef void iso_spline_shell_fn(iso_spline_shell *shell);
/* Every instruction set gives the same bytes. */
ISO_KERNEL_UNITS(iso_spline_shell_fn, iso_spline_shell_units);

#endif
