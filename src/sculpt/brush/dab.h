/* dab: a touch in voxel coordinates, and the kernels that compute the new values of a brick from it.
 *
 * A dab is one mirror image of a touch. All lengths are in voxels of the grid and all positions are index
 * coordinates; iso_dabs_make converts an iso_brush (millimetres) to them. A kernel reads the brick and
 * its face neighbours, or a window of the field, and writes the new values to other memory. Mirror images act
 * together (union of their solids, sum of their displacements), so a symmetric field stays symmetric.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_BRUSH_DAB_H
#define ISO_SCULPT_BRUSH_DAB_H

#include <stdbool.h>

#include "grids/hgrid.h"
#include "sculpt/brush/brush.h"
#include "sculpt/brush/stamp.h"
#include "sculpt/field/redistance.h"

/* ADD, CARVE, BLEND_ADD, BLEND_CARVE. */
bool iso_tool_is_set_operation(iso_tool tool);
bool iso_tool_is_warp(iso_tool tool); /* PINCH and MOVE */

/* The mirror images of a touch with symmetry in all three axes. */
enum { ISO_DAB_MAX = 8 };

/* One mirror image. */
typedef struct iso_dab {
    double centre[3], from[3]; /* index coordinates; `from`: the capsule's other end, the start of MOVE */
    double axis[3][3];         /* unit vectors; [2] is the surface's normal */
} iso_dab;

/* A touch with all its mirror images; the same for all bricks. */
typedef struct iso_dabs {
    iso_tool tool;
    iso_solid solid;
    iso_falloff falloff;
    float radius_voxels, blend_voxels;
    float strength; /* at the centre: voxels for INFLATE and DEFLATE, otherwise a factor */
    float aspect;   /* in radii */
    float band;     /* of the grid, voxels */
    int count;      /* of dabs */
    iso_dab dab[ISO_DAB_MAX];
    const iso_hgrid *stamp; /* the level of the stamp that fits the radius; NULL: none is set */
} iso_dabs;

/* The grid that dabs are made for; all borrowed. */
typedef struct iso_dab_space {
    const iso_affine *affine; /* from index to world coordinates */
    double spacing;           /* mm from voxel to voxel */
    float band;               /* voxels */
    const iso_stamp *stamp;   /* NULL: none is set */
} iso_dab_space;

/* Converts a brush and its touch from millimetres to voxels and makes the mirror images
 * (brush_to_voxels.c). */
void iso_dabs_make(const iso_dab_space *space, const iso_brush *brush, const iso_touch *touch,
                   iso_dabs *dabs);

/* The distance in voxels from a dab's centre (or the segment from `from` to it) beyond which no voxel
 * changes. */
double iso_dabs_influence(const iso_dabs *dabs);

/* The number of steps in which MOVE integrates its path: each at most an eighth of the radius, at most 256.
 */
int iso_dabs_steps(const iso_dabs *dabs);

/* For each voxel of a brick the position, in voxels from the brick's first voxel, at which its new value is
 * sampled. */
typedef struct iso_warp {
    float position[3][ISO_BRICK_VOXELS];
} iso_warp;

/* A box of the field as floats, x fastest: voxels lo .. lo + size - 1, relative to the brick's first voxel.
 */
typedef struct iso_field_window {
    int lo[3], size[3];
    const float *values;
} iso_field_window;

typedef struct iso_dab_kernel {
    /* Set operations, INFLATE, DEFLATE, FLATTEN and SMOOTH: the new values of the brick at `brick` (in
     * cells).
     */
    void (*edit)(const iso_dabs *dabs, const int brick[3], const iso_stencil *phi, float *out);
    /* PINCH and MOVE: where each voxel's new value is sampled. False: nowhere but at the voxel itself. */
    bool (*warp)(const iso_dabs *dabs, const int brick[3], iso_warp *warp);
    /* Samples the window at the warp's positions, trilinearly. The window holds all voxels that this reads.
     */
    void (*sample)(const iso_warp *warp, const iso_field_window *window, float *out);
    /* Restores frozen voxels of `values` from `before` (`masked` NULL: none is frozen), marks the voxels that
     * differ from `before` in any bit, and returns whether there are any. */
    bool (*find_changes)(const float *before, const iso_voxel_bits *masked, float *values,
                         iso_voxel_bits *changed);
} iso_dab_kernel;

/* The kernels for an instruction set, or for the best one below it that this build has. */
const iso_dab_kernel *iso_dab_kernel_get(iso_cpu_level level);

#endif
