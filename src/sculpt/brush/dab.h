/* dab: a touch in voxel coordinates, and the kernels that compute the new values of a brick from it.
 *
 * A dab is one image of a touch. All lengths are in voxels of the grid and all positions are index
 * coordinates; iso_dabs_make converts an iso_brush (millimetres) to them. A kernel reads the brick and
 * its face neighbours, or a window of the field, and writes the new values to other memory. Images act
 * together, so a symmetric field stays symmetric: the union of their solids; the sum of the displacements of
 * mirror images; of radial and repeated images, many of which can lie on one another, the mean by weight of
 * their displacements, times the largest weight.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_BRUSH_DAB_H
#define ISO_SCULPT_BRUSH_DAB_H

#include <stdbool.h>

#include "grids/hgrid.h"
#include "sculpt/brush/brush.h"
#include "sculpt/brush/outline.h"
#include "sculpt/brush/stamp.h"
#include "sculpt/field/redistance.h"

/* Whether the tool unites the field with a solid or subtracts the solid: ADD, CARVE, BLEND_ADD, BLEND_CARVE.
 */
bool iso_tool_is_set_operation(iso_tool tool);
/* Whether the tool changes the whole mask, once in a stroke, wherever its sample is. */
bool iso_tool_is_whole_mask(iso_tool tool);
/* Whether the tool samples the field at displaced positions: PINCH to MOVE. */
bool iso_tool_is_warp(iso_tool tool);
/* Whether the tool drags the surface along the segment from `from` to the dab's centre: SNAKE_HOOK and
 * MOVE. */
bool iso_tool_is_drag(iso_tool tool);
/* Whether the tool measures the surface within the radius before it acts (area_plane.h): SCRAPE, FILL,
 * CLAY. */
bool iso_tool_has_area_plane(iso_tool tool);

/* The largest number of dabs of a touch: its images; if they are not averaged its mirror images. */
enum { ISO_DAB_MAX = ISO_IMAGES_MOST, ISO_MIRRORED_MAX = 8 };

/* One image of a touch. */
typedef struct iso_dab {
    double centre[3], from[3]; /* index coordinates; `from`: the other end of a capsule, or where a drag
                                  started */
    double axis[3][3];         /* unit vectors; [2] is the surface's normal */
    double plane;              /* height, along that normal, of a tool's plane above the centre, voxels */
} iso_dab;

/* A touch with all its images; the same for all bricks. */
typedef struct iso_dabs {
    iso_tool tool;
    iso_solid solid;
    iso_falloff falloff;
    float radius_voxels, blend_voxels;
    float strength; /* at the centre: voxels for INFLATE and DEFLATE, otherwise a factor */
    float depth;    /* voxels: of a layer of CLAY, of the groove that a touch of CREASE digs; otherwise 0 */
    float aspect;   /* in brush radii */
    float band;     /* of the grid, voxels */
    uint32_t color; /* the brush's, as of a painted voxel (field/paint.h); 0: it has none */
    int cover;      /* how much of the colour a touch lays on, at its centre; 0 .. ISO_PAINT_ONE */
    bool averaged;  /* the images are not (only) mirror images: where they overlap their mean acts */
    bool apart; /* no voxel is within the influence of two dabs (false: of mirror images, also if none is) */
    const iso_hgrid *stamp;     /* the level of the stamp for this radius; NULL: no stamp is set */
    const iso_heights *heights; /* that weigh what the dabs do; NULL: nothing does */
    const iso_outline *outline; /* what CARVE or BLEND_CARVE removes instead of a solid; NULL: a solid */
    int count;                  /* of dabs */
    iso_dab dab[ISO_DAB_MAX];
} iso_dabs;

/* What iso_dabs_make needs to know about the grid and the step. All pointers are borrowed. */
typedef struct iso_dab_space {
    const iso_affine *affine; /* from index to world coordinates */
    double spacing;           /* mm from voxel to voxel */
    float band;               /* voxels */
    const iso_stamp *stamp;   /* NULL: none is set */
} iso_dab_space;

/* Converts a brush and its touch from millimetres to voxels and makes the images (brush_to_voxels.c). */
void iso_dabs_make(const iso_dab_space *space, const iso_brush *brush, const iso_touch *touch,
                   iso_dabs *dabs);

/* Returns the distance, in voxels, beyond which no voxel changes: from the dab's centre or, for capsules and
 * drags, from the segment between the centre and `from`. */
double iso_dabs_influence(const iso_dabs *dabs);

/* Returns a lower bound of the distance, in voxels, from the voxels of the brick at `brick` (in cells) to a
 * dab's centre or, for drags and capsules, to the segment along which it moved. */
double iso_dab_brick_distance(const iso_dabs *dabs, const iso_dab *dab, const int brick[3]);
/* Lists the dabs that can change a voxel of a brick, in their order, and returns their number. With the
 * others left out the brick gets the same values. A single dab is always listed. */
int iso_dabs_find_near(const iso_dabs *dabs, const int brick[3], int near[ISO_DAB_MAX]);

/* Returns the number of steps in which a drag follows a voxel back along the stroke: enough for steps of at
 * most an eighth of the radius, but at most 256. */
int iso_dabs_steps(const iso_dabs *dabs);

/* For each voxel of a brick, the position at which the field is sampled to get its new value; in voxels from
 * the brick's first voxel. */
typedef struct iso_warp {
    float position[3][ISO_BRICK_VOXELS];
} iso_warp;

/* A copy of a box of the field, x fastest: voxels lo .. lo + size - 1, counted from the brick's first voxel.
 */
typedef struct iso_field_window {
    int lo[3], size[3];
    const float *values;
} iso_field_window;

typedef struct iso_dab_kernel {
    /* Computes the new values of the brick at `brick` (in cells) for set operations, INFLATE, DEFLATE,
     * FLATTEN to CLAY and SMOOTH. phi: the values before the touch. */
    void (*edit)(const iso_dabs *dabs, const int brick[3], const iso_stencil *phi, float *out);
    /* Computes for warps where each voxel's new value is sampled. Returns false if this is the
     * voxel's own position for all voxels, so that nothing changes. */
    bool (*warp)(const iso_dabs *dabs, const int brick[3], iso_warp *warp);
    /* Samples the window at the warp's positions by trilinear interpolation. The window must contain all
     * voxels that this reads. */
    void (*sample)(const iso_warp *warp, const iso_field_window *window, float *out);
    /* Restores frozen voxels of `values` from `before` (`masked` NULL: none is frozen) and marks the voxels
     * that differ from `before` in any bit. Returns whether there are any. */
    bool (*find_changes)(const float *before, const iso_voxel_bits *masked, float *values,
                         iso_voxel_bits *changed);
    /* Marks the voxels of a brick whose distances are inside of the band. */
    void (*find_band)(const float *values, float band, iso_voxel_bits *inside);
    /* Writes the colours `from` (NULL: none) of the voxels `inside`, or `color` where they are also in `set`;
     * 0 to all others. */
    void (*set_colors)(const uint32_t *from, const iso_voxel_bits *inside, const iso_voxel_bits *set,
                       uint32_t color, uint32_t *out);
    /* Marks the voxels whose colours differ (before NULL: from none). Returns whether there are any. */
    bool (*find_recolored)(const uint32_t *before, const uint32_t *colors, iso_voxel_bits *changed);
} iso_dab_kernel;

ISO_KERNEL_UNITS(const iso_dab_kernel, iso_dab_kernel);
/* Returns the variant for an instruction set; all give the same bytes. */
const iso_dab_kernel *iso_dab_kernel_get(iso_cpu_level level);

#endif
