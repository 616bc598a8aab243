/* dab: a touch in the coordinates of one brick, and the kernels that compute what it makes of the brick.
 *
 * A kernel reads the brick, its face neighbours or a window of the field, and writes new values elsewhere: a
 * touch is complete before the grid is written. Mirrored touches act together (union of shapes, sum of
 * displacements), so a symmetric field stays symmetric. Internal to sculpt. */
#ifndef ISO_SCULPT_BRUSH_DAB_H
#define ISO_SCULPT_BRUSH_DAB_H

#include <stdbool.h>

#include "grids/hgrid.h"
#include "sculpt/brush/brush.h"
#include "sculpt/field/redistance.h"

bool iso_tool_is_set_operation(iso_tool tool);
bool iso_tool_is_warp(iso_tool tool); /* PINCH and MOVE */

/* At most all three mirrors. */
enum { ISO_DAB_MAX = 8 };

/* One mirrored instance, in voxels. */
typedef struct iso_dab {
    double centre[3], from[3]; /* index coordinates; `from`: the capsule's other end, MOVE's start */
    double axis[3][3];         /* unit; [2] is the surface's normal */
} iso_dab;

/* A touch in index coordinates: what is the same for all bricks. */
typedef struct iso_dabs {
    iso_tool tool;
    iso_solid shape;
    iso_falloff falloff;
    float radius, strength, aspect, blend; /* voxels, but strength and aspect */
    float band;
    int count;
    iso_dab dab[ISO_DAB_MAX];
    const iso_hgrid *stamp;
} iso_dabs;

/* Voxels from a centre (or the segment between from and centre) beyond which nothing changes. */
double iso_dabs_influence(const iso_dabs *dabs);

/* Steps in which MOVE follows its way: each an eighth of the radius or less, 256 at most. */
int iso_dabs_steps(const iso_dabs *dabs);

/* Index positions in a brick: voxel (x, y, z) shows what lies at position. */
typedef struct iso_warp {
    float position[3][ISO_BRICK_VOXELS];
} iso_warp;

/* A box of the field as floats, x fastest: voxels lo .. lo + size - 1, relative to the brick. */
typedef struct iso_field_window {
    int lo[3], size[3];
    const float *values;
} iso_field_window;

typedef struct iso_dab_kernel {
    /* Set operations, INFLATE, DEFLATE, FLATTEN, SMOOTH: out = new values of the brick at `brick`. */
    void (*edit)(const iso_dabs *dabs, const int brick[3], const iso_stencil *phi, float *out);
    /* PINCH and MOVE: where each voxel's value comes from; false when no voxel moves. */
    bool (*warp)(const iso_dabs *dabs, const int brick[3], iso_warp *warp);
    /* out = trilinear values at the warp's positions, which the window holds with a voxel to spare. */
    void (*sample)(const iso_warp *warp, const iso_field_window *window, float *out);
    /* Puts back masked voxels (NULL: none), says which others differ from `before` by any bit, and whether
     * any does. */
    bool (*settle)(const float *before, const iso_voxel_bits *masked, float *values, iso_voxel_bits *changed);
} iso_dab_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_dab_kernel *iso_dab_kernel_get(iso_cpu_level level);

#endif
