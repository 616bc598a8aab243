/* refined_kernel: the steps of the refined reconstruction (render/refined/refined.h) on a patch of the
 * picture, for each instruction set. Internal to render.
 *
 * What becomes of a pixel depends on the points and the view alone, not on the patch it is in: points come in
 * the order of their blocks, and a block's in their own. */
#ifndef ISO_RENDER_REFINED_KERNEL_H
#define ISO_RENDER_REFINED_KERNEL_H

#include "base/cpu.h"
#include "render/point_blocks.h"
#include "render/raster/raster.h"
#include "render/refined/refined_numbers.h"

/* Sums over the discs that a pixel's ray meets at the front, weighted. They come in fours; what is constant
 * over a disc comes first. */
enum {
    ISO_SUM_WEIGHT,
    ISO_SUM_NX, /* discs' normals at their centres */
    ISO_SUM_NY,
    ISO_SUM_NZ,
    ISO_SUM_XX, /* shape operators, 1 / mm */
    ISO_SUM_XY,
    ISO_SUM_XZ,
    ISO_SUM_YY,
    ISO_SUM_YZ,
    ISO_SUM_ZZ,
    ISO_SUM_SQUARE, /* of their norms */
    ISO_SUM_SIDE,   /* 1, or -1 for discs that were turned to the eye */
    ISO_SUM_X,      /* discs' centres, mm */
    ISO_SUM_Y,
    ISO_SUM_Z,
    ISO_SUM_DEPTH, /* where the ray meets them */
    ISO_SUMS
};

/* The sums of pixels all of whose discs are flat. */
enum {
    ISO_FLAT_WEIGHT,
    ISO_FLAT_NX,
    ISO_FLAT_NY,
    ISO_FLAT_NZ,
    ISO_FLAT_SIDE,
    ISO_FLAT_DEPTH = 7,
    ISO_FLAT_SUMS
};

/* A disc: a point seen from the eye, in view space and pixels of the whole frame. From LIT_X to Z in the
 * order of sums. */
enum {
    ISO_DISC_COLUMN, /* pixels */
    ISO_DISC_ROW,
    ISO_DISC_NX, /* normal, with its tilt (iso_curvature) */
    ISO_DISC_NY,
    ISO_DISC_NZ,
    ISO_DISC_LIT_X, /* the point's own, unit: what is shown */
    ISO_DISC_LIT_Y,
    ISO_DISC_LIT_Z,
    ISO_DISC_XX, /* shape operator, with the normal's own curvature (refined.h) */
    ISO_DISC_XY,
    ISO_DISC_XZ,
    ISO_DISC_YY,
    ISO_DISC_YZ,
    ISO_DISC_ZZ,
    ISO_DISC_SQUARE, /* of its norm */
    ISO_DISC_SIDE,
    ISO_DISC_X, /* mm */
    ISO_DISC_Y,
    ISO_DISC_Z,
    ISO_DISC_B0, /* along a ray with direction d: n.d + q.Sd = B0 + BX qx + BY qy, and A = d.Sd */
    ISO_DISC_BX,
    ISO_DISC_BY,
    ISO_DISC_A,
    /* Flat discs have in their places: pixels (x, y) from the centre, the ray is X x + Y y mm behind it, and
     * the square of how far that is in radii is XX x^2 + XY x y + YY y^2. */
    ISO_DISC_FLAT_XX = ISO_DISC_B0,
    ISO_DISC_FLAT_X = ISO_DISC_BX,
    ISO_DISC_FLAT_Y = ISO_DISC_BY,
    ISO_DISC_FLAT_YY = ISO_DISC_A,
    ISO_DISC_FLAT_XY,
    ISO_DISC_LOW_X, /* the box that it stays in: voxels from its centre along the index axes */
    ISO_DISC_LOW_Y,
    ISO_DISC_LOW_Z,
    ISO_DISC_HIGH_X,
    ISO_DISC_HIGH_Y,
    ISO_DISC_HIGH_Z,
    ISO_DISC_RADIUS,  /* mm */
    ISO_DISC_INVERSE, /* 1 / radius^2 */
    ISO_DISC_PIXEL,   /* mm of a pixel at its depth, and its inverse */
    ISO_DISC_SCALE,
    ISO_DISC_PIXELS, /* of a circle that it stays within, as seen from the eye */
    ISO_DISC_VALUES
};

/* What a call does. */
typedef struct iso_refined_params {
    const iso_target *target;
    const iso_point_view *points;
    const iso_point_block *blocks;
    const float (*corner)[3]; /* of each block: where its first step of position lies in view space */
    float low, voxels;        /* the first step of a block and a step of position, in voxels */
    float step[9];            /* a step of position, in view space */
    float normal[9];          /* index covector to view space */
    float radius;             /* of points without their own, mm */
    float reach[2];           /* a disc's radius in those of its point, and how much more for large ones */
    float grow_from, grow;    /* pixels of the point's radius from where it grows, and 1 / pixels of growth */
    float focal, slope;       /* pixels per mm at depth 1, and its inverse; orthographic: slope 0 */
    float axis[2];            /* pixel of the optical axis, in the whole frame */
    float metric[6];          /* xx xy xz yy yz zz: of squares of lengths as if voxels were cubes */
    bool uneven;              /* voxels are no cubes */
    float slant;              /* how much larger a ball's shadow can be than it would be at the axis */
    float per_length;         /* 1 / length in view space of unit normals; 0: they differ */
    float near;
    bool orthographic;
    bool cull;       /* leave out points that face away */
    float per_mm;    /* voxels in a mm, at most */
    bool bordered;   /* discs end at the grid's border: */
    float border[3]; /* the high one's index coordinates; the low one's are 0 */
} iso_refined_params;

enum {
    ISO_REFINED_TILE = 4, /* columns */
    ISO_REFINED_BOX = 11  /* columns and rows that a scattered disc may cover */
};

/* A patch of the picture and what a worker keeps of it. Discs of a few pixels are best taken a vector at a
 * time to single pixels (scatter), whose sums lie together; larger ones one at a time to tiles of pixels
 * (splat), whose vectors of each sum lie together. Both ways do the same to every pixel. */
typedef struct iso_refined_patch {
    int first[2], last[2]; /* columns and rows of the view */
    size_t stride;         /* pixels in a row */
    size_t tiles;          /* in a row of them */
    bool flat;             /* all its discs are: single pixels have ISO_FLAT_SUMS */
    float *sums;           /* of single pixels, ISO_SUMS each, or by tiles */
    float *front; /* nearest depths, ISO_NOWHERE where there is none; of single pixels, or by tiles */
    /* Discs whose centres are behind this for their cell of 2^shift pixels a side are hidden; NULL: none
     * is. */
    const float *hidden;
    int shift, cells; /* in a row of them */
} iso_refined_patch;

typedef struct iso_refined_kernel {
    /* Adds the discs of a block (its number) to pixels, of which `front` tells which have sums. */
    void (*scatter)(const iso_refined_params *params, const iso_refined_patch *patch, uint32_t block);
    /* The same to tiles. */
    void (*splat)(const iso_refined_params *params, const iso_refined_patch *patch, uint32_t block);
    /* From sums to the gbuffer. */
    void (*finish_pixels)(const iso_refined_params *params, const iso_refined_patch *patch);
    void (*finish_tiles)(const iso_refined_params *params, const iso_refined_patch *patch);
    /* The deepest front of each cell of the patch. */
    void (*survey_pixels)(const iso_refined_patch *patch, float *deepest);
    void (*survey_tiles)(const iso_refined_patch *patch, float *deepest);
} iso_refined_kernel;

/* Whether a block's points have shapes that matter. */
static inline bool iso_refined_use_curvature(const iso_refined_params *params, const iso_point_block *block) {
    return params->points->curvatures && block->radius[1] >= ISO_REFINED_FLAT_RADIUS;
}

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_refined_kernel *iso_refined_kernel_get(iso_cpu_level level);

#endif
