/* redistance: the kernels that make a clamped field a distance field again, brick by brick.
 *
 * The equation u_t = sign(phi) (1 - |grad u|) is stepped explicitly (Sussman, Smereka and Osher 1994) with
 * Godunov's upwind differences of second order (ENO2, min-mod of second differences), Jacobi across bricks:
 * what a step makes depends on the step before only, so neither the order of bricks nor threads change a bit.
 * Voxels beside the interface (a face neighbour has the other sign) keep their value; before the first step
 * they are either left as they are, so that the zero set moves by no bit, or, where a deformation changed
 * them, divided by the gradient's length (Russo and Smereka 2000) and then corrected so that the crossings on
 * the edges keep their ratios (Hartmann, Meinke and Schroeder 2010, CR-2). Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_REDISTANCE_H
#define ISO_SCULPT_FIELD_REDISTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
#include "sculpt/field/mask.h"

/* A brick and its neighbours across the faces -x, +x, -y, +y, -z, +z: 4096 floats each, 64-byte aligned. */
typedef struct iso_stencil {
    const float *self, *face[6];
} iso_stencil;

/* A bit for each row of a brick: z * 16 + y. */
enum { ISO_ROW_WORDS = ISO_BRICK_ROWS / 32 };
typedef struct iso_row_bits {
    uint32_t word[ISO_ROW_WORDS];
} iso_row_bits;

/* What the steps need to know of a brick. */
typedef struct iso_band_state {
    iso_voxel_bits frozen; /* beside the interface, or kept by the caller */
    iso_voxel_bits lost;   /* beside the interface, but at the band's end: its distance is not known */
    iso_row_bits active;   /* rows that hold, or touch, a voxel inside the band */
} iso_band_state;

/* A step of one brick. */
typedef struct iso_relaxation {
    iso_row_bits due;   /* rows to step */
    iso_row_bits stale; /* rows of `out` that differ from the brick */
    float band, least;  /* voxels */
} iso_relaxation;

/* What a set operation with one exact solid left of a brick. Where all is the solid's, or all is as it was,
 * it is as good a distance field as those are; what must be made one again begins at the seams, where a voxel
 * that changed lies beside one that did not. A voxel at `away`, the end of the band that lies outside what
 * was united, belongs to either. */
typedef struct iso_seam_side {
    const iso_voxel_bits *self, *face[6]; /* changed; of the stencil's bricks */
    float far_value;
} iso_seam_side;

/* 0.45 voxel a step. */
typedef struct iso_redistancer {
    /* The changed voxels at a seam; whether there are any. */
    bool (*find_seam)(const iso_stencil *phi, const iso_seam_side *side, iso_voxel_bits *seam);
    /* Bit 0: some voxel is outside, bit 1: some is inside. */
    uint32_t (*sides)(const float *values);
    /* Finds the state of a brick in these rows; the other rows' is cleared. */
    void (*classify)(const iso_stencil *phi, float band, const iso_row_bits *rows, iso_band_state *state);
    /* out = phi, but phi / |grad phi| where both `changed` and frozen, or lost. */
    void (*rescale)(const iso_stencil *phi, const iso_band_state *state, const iso_voxel_bits *changed,
                    float *out);
    /* out = scaled, but corrected for the crossings' ratios in phi at the same voxels. */
    void (*correct)(const iso_stencil *phi, const iso_stencil *scaled, const iso_band_state *state,
                    const iso_voxel_bits *changed, float *out);
    /* One step: out becomes the brick after it, *moved the rows in which a voxel moved by more than `least`.
     * Voxels that are frozen stay. */
    void (*relax)(const iso_stencil *phi, const iso_voxel_bits *frozen, const iso_relaxation *step,
                  float *out, iso_row_bits *moved);
} iso_redistancer;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_redistancer *iso_redistancer_get(iso_cpu_level level);

#endif
