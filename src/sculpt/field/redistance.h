/* redistance: kernels that turn a clamped field into a distance field, brick by brick.
 *
 * The equation u_t = sign(phi) (1 - |grad u|) is integrated explicitly (Sussman, Smereka and Osher 1994) with
 * Godunov's upwind differences of second order (ENO2: min-mod of second differences). The iteration is
 * Jacobi: a step reads only values of the step before, so the order of bricks and threads does not change a
 * bit. Voxels beside the interface (a face neighbour has the other sign) are fixed during the steps. Before
 * the first step they are either left alone, so that the zero set does not move, or, where a deformation
 * changed them, divided by the length of the gradient (Russo and Smereka 2000) and corrected so that the
 * edge points keep their ratios (scheme CR-2 of Hartmann, Meinke and Schroeder 2010). All values
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

/* A set of rows of a brick: bit z * 16 + y. */
enum { ISO_ROW_WORDS = ISO_BRICK_ROWS / 32 };
typedef struct iso_row_bits {
    uint32_t word[ISO_ROW_WORDS];
} iso_row_bits;

/* What the redistancing steps need to know about the voxels and rows of a brick. */
typedef struct iso_band_state {
    iso_voxel_bits fixed;   /* beside the interface, or frozen by the mask: the steps do not change them */
    iso_voxel_bits unknown; /* beside the interface, but with a clamped value, which is not a distance */
    iso_row_bits active;    /* rows with a voxel that is, or has a face neighbour, inside the band */
} iso_band_state;

/* The parameters of one redistancing step of one brick. */
typedef struct iso_relaxation {
    iso_row_bits due;   /* rows to compute */
    iso_row_bits stale; /* rows of `out` that do not have the brick's values: unless they are due, the brick
                           is copied there */
    float band;
    float least; /* a voxel counts as moved if it changes by more than this, in voxels */
} iso_relaxation;

/* The changed voxels of a stencil after a set operation with one solid whose distances are exact. Where all
 * voxels of a neighbourhood have changed, they hold exact distances to the solid; where none has, they hold
 * the distances from before. Redistancing therefore starts at the seams, where a changed voxel has an
 * unchanged neighbour. Neighbours with the value `far_value` do not make a seam: this end of the band (+band
 * after a union, -band after a difference) is right on both sides. */
typedef struct iso_changed_stencil {
    const iso_voxel_bits *self, *face[6];
    float far_value;
} iso_changed_stencil;

/* The redistancing kernels. The time step is 0.45 voxel: distances move by at most this much in one step. */
typedef struct iso_redistancer {
    /* Marks the changed voxels at a seam; returns whether there are any. */
    bool (*find_seam)(const iso_stencil *phi, const iso_changed_stencil *side, iso_voxel_bits *seam);
    /* Returns on which sides of the surface the voxels of a brick lie. Bit 0: some are outside; bit 1: some
     * are inside. */
    uint32_t (*sides)(const float *values);
    /* Computes the band state of a brick in the rows `rows`; all other rows get empty sets. */
    void (*classify)(const iso_stencil *phi, float band, const iso_row_bits *rows, iso_band_state *state);
    /* Computes out = phi / |grad phi| for voxels that are unknown, or both fixed and `changed`; elsewhere out
     * = phi. */
    void (*rescale)(const iso_stencil *phi, const iso_band_state *state, const iso_voxel_bits *changed,
                    float *out);
    /* Computes out = scaled, with the same voxels corrected so that the edge points on their edges keep the
     * ratios that they have in phi. */
    void (*correct)(const iso_stencil *phi, const iso_stencil *scaled, const iso_band_state *state,
                    const iso_voxel_bits *changed, float *out);
    /* Computes one step: `out` is the brick after the step, in which the `fixed` voxels keep their values.
     * *moved is the set of rows in which a voxel changed by more than step->least. */
    void (*relax)(const iso_stencil *phi, const iso_voxel_bits *fixed, const iso_relaxation *step, float *out,
                  iso_row_bits *moved);
} iso_redistancer;
ISO_KERNEL_UNITS(const iso_redistancer, iso_redistancer);

/* Returns the kernels for an instruction set, or for the best one below it that this build has. */
const iso_redistancer *iso_redistancer_get(iso_cpu_level level);

#endif
