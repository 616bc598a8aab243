/* redistance: kernels that turn a clamped field into a distance field, brick by brick.
 *
 * The equation u_t = sign(phi) (1 - |grad u|) is integrated explicitly (Sussman, Smereka and Osher 1994) with
 * Godunov's upwind differences of second order (ENO2: min-mod of second differences). The iteration is
 * Jacobi: a step reads only values of the step before, so the order of bricks and threads does not change a
 * bit. Voxels beside the interface (a face neighbour has the other sign) are fixed during the steps. Before
 * the first step they are either left alone, so that the zero set does not move, or, where a deformation
 * changed them, divided by the length of the gradient (Russo and Smereka 2000) and corrected so that the
 * crossings on the edges keep their ratios (scheme CR-2 of Hartmann, Meinke and Schroeder 2010). All values
 * are in voxels. Internal to sculpt. */
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

/* The voxels and rows of a brick that the steps treat differently. */
typedef struct iso_band_state {
    iso_voxel_bits fixed;   /* beside the interface, or frozen by the mask: the steps do not change them */
    iso_voxel_bits unknown; /* beside the interface, but with a clamped value: their distance is not known */
    iso_row_bits active;    /* rows with a voxel that is, or has a face neighbour, inside the band */
} iso_band_state;

/* One step on one brick. */
typedef struct iso_relaxation {
    iso_row_bits due;   /* rows to compute */
    iso_row_bits stale; /* rows of `out` that differ from the brick: copied unless they are due */
    float band;
    float least; /* the change from which on a voxel counts as moved */
} iso_relaxation;

/* The voxels of a stencil that a set operation with one exact solid changed. Where a neighbourhood is
 * entirely changed, or entirely unchanged, it is as good a distance field as the solid's, or as before.
 * Redistancing therefore starts at the seams, where a changed voxel has an unchanged neighbour. Neighbours
 * with the value `far_value` do not make a seam: this end of the band (+band after a union, -band after a
 * difference) is right on both sides. */
typedef struct iso_changed_stencil {
    const iso_voxel_bits *self, *face[6];
    float far_value;
} iso_changed_stencil;

/* The kernels; steps advance by 0.45 voxel. */
typedef struct iso_redistancer {
    /* Marks the changed voxels at a seam; returns whether there are any. */
    bool (*find_seam)(const iso_stencil *phi, const iso_changed_stencil *side, iso_voxel_bits *seam);
    /* Bit 0: some voxel is outside, bit 1: some voxel is inside. */
    uint32_t (*sides)(const float *values);
    /* Computes the state of a brick in `rows` and clears that of all other rows. */
    void (*classify)(const iso_stencil *phi, float band, const iso_row_bits *rows, iso_band_state *state);
    /* out = phi / |grad phi| where a voxel is `changed` and fixed, or unknown; elsewhere phi. */
    void (*rescale)(const iso_stencil *phi, const iso_band_state *state, const iso_voxel_bits *changed,
                    float *out);
    /* out = scaled, with the same voxels corrected to keep the ratios of the crossings in phi. */
    void (*correct)(const iso_stencil *phi, const iso_stencil *scaled, const iso_band_state *state,
                    const iso_voxel_bits *changed, float *out);
    /* One step: `out` is the brick after it, except for voxels in `fixed`, and *moved the rows in which a
     * voxel changed by more than step->least. */
    void (*relax)(const iso_stencil *phi, const iso_voxel_bits *fixed, const iso_relaxation *step, float *out,
                  iso_row_bits *moved);
} iso_redistancer;

/* The kernels for an instruction set, or for the best one below it that this build has. */
const iso_redistancer *iso_redistancer_get(iso_cpu_level level);

#endif
