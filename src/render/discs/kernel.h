/* kernel: the steps of the method discs (render/discs/discs.h) on a patch of the picture,
 * once per instruction set. Internal to render.
 *
 * A pixel's value depends on the points and the view alone, not on the division into patches: discs are
 * added in the order of their blocks, and within a block in the order of its points. */
#ifndef ISO_RENDER_DISCS_KERNEL_H
#define ISO_RENDER_DISCS_KERNEL_H

#include "base/cpu.h"
#include "render/discs/discs_numbers.h"
#include "render/discs/setup.h"
#include "render/points/point_blocks.h"
#include "render/points/reconstruction.h"
#include "render/raster/raster.h"

/* The weighted sums of a pixel over the frontmost discs that its ray hits. Groups of four are stored
 * together; the values that are constant over a disc come first. */
enum {
    ISO_SUM_WEIGHT,
    ISO_SUM_NX, /* normals of the points */
    ISO_SUM_NY,
    ISO_SUM_NZ,
    ISO_SUM_XX, /* shape operators, 1 / mm */
    ISO_SUM_XY,
    ISO_SUM_XZ,
    ISO_SUM_YY,
    ISO_SUM_YZ,
    ISO_SUM_ZZ,
    ISO_SUM_SQUARE, /* squared norms of the shape operators */
    ISO_SUM_SIDE,   /* 1, or -1 for back-facing discs, whose normals were flipped */
    ISO_SUM_X,      /* centres of the discs, view space, mm */
    ISO_SUM_Y,
    ISO_SUM_Z,
    ISO_SUM_DEPTH, /* depths of the hits, mm */
    ISO_SUMS,
    /* Coloured points are flat: the place of their shape operators is taken by */
    ISO_SUM_RED = ISO_SUM_XX, /* red, then green and blue, 0 .. 255 */
};

/* The sums of flat discs without colours, as they are resolved. */
enum { ISO_FLAT_WEIGHT, ISO_FLAT_NX, ISO_FLAT_NY, ISO_FLAT_NZ, ISO_FLAT_SIDE, ISO_FLAT_DEPTH };

/* The values of a disc, in view space. LIT_X to Z are in the order of the sums ISO_SUM_NX to ISO_SUM_Z. */
enum {
    ISO_DISC_COLUMN, /* of the centre in the whole picture, pixels */
    ISO_DISC_ROW,
    ISO_DISC_NX, /* normal of the quadric: the point's normal with its tilt (iso_curvature) */
    ISO_DISC_NY,
    ISO_DISC_NZ,
    ISO_DISC_LIT_X, /* the point's unit normal, for shading */
    ISO_DISC_LIT_Y,
    ISO_DISC_LIT_Z,
    ISO_DISC_XX, /* shape operator, with the curvature along the normal (discs.h), 1 / mm */
    ISO_DISC_XY,
    ISO_DISC_XZ,
    ISO_DISC_YY,
    ISO_DISC_YZ,
    ISO_DISC_ZZ,
    ISO_DISC_RED = ISO_DISC_XX,        /* as ISO_SUM_RED */
    ISO_DISC_SQUARE = ISO_DISC_ZZ + 1, /* its squared norm */
    ISO_DISC_SIDE,                     /* 1, or -1 when the disc was back-facing and has been flipped */
    ISO_DISC_X,                        /* centre, mm */
    ISO_DISC_Y,
    ISO_DISC_Z,
    /* For the intersection with a ray of direction d that passes the centre at offset q = (qx, qy, 0) mm:
     * n.d + q.Sd = B0 + BX qx + BY qy, and d.Sd = A. */
    ISO_DISC_B0,
    ISO_DISC_BX,
    ISO_DISC_BY,
    ISO_DISC_A,
    /* In the same places for flat discs: the ray through the pixel at (x, y) pixels from the centre hits
     * the disc X x + Y y mm behind the centre, at a squared distance from it of XX x^2 + XY x y + YY y^2
     * squared radii. */
    ISO_DISC_FLAT_XX = ISO_DISC_B0,
    ISO_DISC_FLAT_X = ISO_DISC_BX,
    ISO_DISC_FLAT_Y = ISO_DISC_BY,
    ISO_DISC_FLAT_YY = ISO_DISC_A,
    ISO_DISC_FLAT_XY,
    ISO_DISC_FLAT_NEAR, /* 1 / depth of the centre, 1 / mm; 0: the disc is so small for its depth that rays
                           are taken as parallel */
    ISO_DISC_LOW_X,     /* the box that the disc is clipped to: voxels from its centre along the index axes */
    ISO_DISC_LOW_Y,
    ISO_DISC_LOW_Z,
    ISO_DISC_HIGH_X,
    ISO_DISC_HIGH_Y,
    ISO_DISC_HIGH_Z,
    ISO_DISC_RADIUS,  /* of the ball, mm */
    ISO_DISC_INVERSE, /* 1 / radius^2 */
    ISO_DISC_PIXEL,   /* mm per pixel at the centre's depth */
    ISO_DISC_SCALE,   /* pixels per mm there */
    ISO_DISC_PIXELS,  /* radius of a circle in the picture that contains the disc, pixels */
    /* If discs are filtered: as FLAT_XX, XY and YY for the disc convolved with the filter; factor of
     * weights */
    ISO_DISC_SOFT_XX,
    ISO_DISC_SOFT_XY,
    ISO_DISC_SOFT_YY,
    ISO_DISC_SHARE,
    ISO_DISC_VALUES
};

/* How often the discs of a patch are drawn. In one pass a pixel's sums depend on the order of its discs where
 * discs of different thickness overlap. In two passes (Botsch et al. 2005) they do not: the first finds the
 * front of each pixel, the second adds the discs near it. */
typedef enum iso_discs_pass { ISO_DISCS_ONE_PASS, ISO_DISCS_FRONT_PASS, ISO_DISCS_SUM_PASS } iso_discs_pass;

/* A body that cuts discs (render/view/clip.h), in view space: a point p lies in it if x * p.x + y * p.y + z *
 * p.z < offset for each face; without faces, in the ball. mm. */
typedef struct iso_discs_cut {
    int faces;
    float face[ISO_CLIP_FACES][4];
    float centre[3], radius;
    bool keeps;
} iso_discs_cut;

/* Parameters of one picture or strip. Positions are counted in steps: quantisation steps for packed points,
 * voxels for surfels. */
typedef struct iso_discs_params {
    const iso_target *target;
    const iso_point_view *points;
    const iso_point_block *blocks;
    const float (*corner)[3]; /* for each block: the view space position of step 0, mm */
    float first_step;         /* the position at step 0, relative to the block's brick, in voxels (the same on
                                 each axis) */
    float voxels_per_step;
    float step[9];         /* steps to view space */
    float normal[9];       /* normals from index to view space */
    float radius;          /* of points without radii of their own, mm */
    float ball[2];         /* radius of a disc's ball in radii of its point; how much more for large discs */
    float grow_from, grow; /* radius of a point, in pixels, from which its ball grows; 1 / the pixels over
                              which it grows */
    float focal, slope; /* pixels per mm at depth 1 mm, and the inverse; slope is 0 for orthographic views */
    float axis[2];      /* column and row of the optical axis in the whole picture, pixels */
    float metric[6];    /* quadratic form of squared lengths as if all voxels had the largest spacing:
                              xx xy xz yy yz zz, those off the diagonal doubled */
    bool anisotropic;   /* voxels are not cubes: balls are measured with `metric` */
    float slant;        /* result of iso_discs_slant */
    float per_length;   /* 1 / length of a unit normal after `normal`; 0: depends on the direction */
    float near;         /* depth of the near plane, mm */
    bool orthographic;
    bool cull;         /* leave out back-facing points */
    bool colored;      /* points have colours; they have no curvatures then */
    uint32_t color;    /* of all discs, as in iso_gbuffer.color; 0: they have none */
    float radii_scale; /* what radii of the points' own are multiplied by */
    /* Of flat discs (iso_flat_disc_style): */
    bool filtered; /* small discs are convolved with a low-pass filter; */
    bool widened;  /* they then cover what the convolved discs cover, else what they cover themselves */
    bool centres;  /* instead of a disc, only the pixel that contains its centre is drawn */
    iso_discs_pass pass;
    bool first;          /* the front of a pixel is its first disc, not the nearest */
    float voxels_per_mm; /* voxels per mm, at most */
    bool has_border;     /* discs are clipped at the grid's border: */
    float border[3];     /* index coordinates of its high corner; those of the low corner are 0 */
    int cuts;            /* hits in these bodies, or outside of those that are kept, are left out */
    iso_discs_cut cut[ISO_CLIP_BODIES];
} iso_discs_params;

enum {
    ISO_DISCS_TILE = 4, /* columns of a tile */
    ISO_DISCS_BOX = 11  /* columns and rows that a scattered disc may cover, at most */
};

/* A patch of the picture and a worker's sums of its pixels. Discs that cover a few pixels are added to
 * single pixels (scatter): curved ones a vector of discs at a time; flat ones, where there are no others,
 * one at a time, a vector of pixels at once. The sums of a pixel are then adjacent. Larger discs are
 * processed one at a time and added to tiles, a vector of pixels (splat); then the values of one sum are
 * adjacent. All ways give the same sums. */
typedef struct iso_discs_patch {
    int first[2], last[2]; /* column and row of the view */
    size_t stride;         /* pixels in a row */
    size_t tiles;          /* tiles in a row */
    bool flat;             /* all discs are flat */
    float *sums;           /* ISO_SUMS for each pixel, or ISO_SUMS vectors for each tile */
    /* Where all discs are flat and scattered: `sums` has the weight and normal of each pixel, `colors` its
     * colour and a 0; `depths` and `sides` are planes, the latter without weights, of ISO_SUM_SIDE's sign.
     * They are 0 before. */
    float *colors, *depths, *sides;
    float *front; /* nearest depth of each pixel, in the same order; ISO_NOWHERE: no disc so far */
    /* NULL, or the depths that the gbuffer had before, in the same order as `front`. Hits that are more
     * than their disc's thickness behind them are not added. */
    float *limit;
    /* If discs are filtered: for pixels without a front, the nearest depth of the discs in their sums,
     * which lie within ISO_DISCS_LOW_PASS pixels but do not cover the pixel. Such pixels are not drawn
     * unless a disc that covers them is added later. ISO_NOWHERE: none. */
    float *outer_front;
    /* Of the front pass: the least depth of each pixel's front-facing discs; of its flipped ones, which are
     * in front where they are nearer than `facing_reach`; of its front-facing ones minus their thickness. */
    float *facing, *flipped, *facing_reach;
    /* Discs whose centres lie deeper than the value for their cell are hidden. NULL: none is known to be. */
    const float *hidden;
    iso_selection_counts *counts; /* what is looked at and drawn is added here */
    int shift, cells;             /* a cell is a square of 2^shift pixels a side; number of cells in a row */
} iso_discs_patch;

typedef struct iso_discs_kernel {
    /* Adds the discs of block number `block` to the sums of pixels. Sums of pixels without a front are
     * undefined; where all discs are flat, they are 0. In the front pass: lowers the fronts; in the sum pass
     * `front` is not changed, and the sums are 0 before. */
    void (*scatter_block)(const iso_discs_params *params, const iso_discs_patch *patch, uint32_t block);
    /* The same for tiles. */
    void (*splat_block)(const iso_discs_params *params, const iso_discs_patch *patch, uint32_t block);
    /* Resolve sums into samples of the gbuffer. */
    void (*resolve_pixels)(const iso_discs_params *params, const iso_discs_patch *patch);
    void (*resolve_tiles)(const iso_discs_params *params, const iso_discs_patch *patch);
    /* Copies the depths of the gbuffer to patch->limit, in the order of tiles. */
    void (*load_limits_tiles)(const iso_discs_params *params, const iso_discs_patch *patch);
    /* Set deepest[cell], which is -ISO_NOWHERE before, to the greatest `front` of the cell's pixels. */
    void (*find_deepest_pixels)(const iso_discs_patch *patch, float *deepest);
    void (*find_deepest_tiles)(const iso_discs_patch *patch, float *deepest);
} iso_discs_kernel;
ISO_KERNEL_UNITS(const iso_discs_kernel, iso_discs_kernel);

/* Whether the curvatures of a block's points are used: its discs are large enough to show them. */
static inline bool iso_discs_use_curvature(const iso_discs_params *params, const iso_point_block *block) {
    return params->points->curvatures && !params->colored && block->radius[1] >= ISO_DISCS_FLAT_RADIUS;
}

/* Whether a block's discs are filtered. */
static inline bool iso_discs_use_filter(const iso_discs_params *params, const iso_point_block *block) {
    return params->filtered && iso_discs_is_filtered(block);
}

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_discs_kernel *iso_discs_kernel_get(iso_cpu_level level);

#endif
