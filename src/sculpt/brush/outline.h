/* outline: what a stroke of TRIM_PLANE, TRIM_LASSO or CROP_LASSO removes: a half space, or what lies within
 * or outside of a prism or pyramid whose cross-section is the stroke's path.
 *
 * The lines through the samples along their normals are the edges of the prism, which is parallel to them, or
 * of the pyramid, whose apex they all meet in: the viewer of a picture with perspective. Distances to its
 * sides are exact (near the apex too small); where the path crosses itself, a place is within the outline if
 * a line from it to the outside crosses the path an odd number of times. All lengths are in voxels of the
 * grid, and positions are index coordinates. Internal to sculpt. */
#ifndef ISO_SCULPT_BRUSH_OUTLINE_H
#define ISO_SCULPT_BRUSH_OUTLINE_H

#include "base/geometry.h"
#include "base/status.h"
#include "isopoint.h"
#include "sculpt/brush/brush.h"

/* The largest number of sides, and of samples that they are made from: samples that lie within 1/16 voxel of
 * the line through their neighbours make no side. */
enum { ISO_OUTLINE_SIDES = 1024, ISO_OUTLINE_SAMPLES = 1 << 14 };

/* A function of the position: [0] x + [1] y + [2] z + [3]. */
typedef struct iso_affine_function {
    double of[4];
} iso_affine_function;

/* The part of a plane between two edges. */
typedef struct iso_outline_side {
    iso_affine_function plane;    /* distance from the plane; positive to its left, for the viewer */
    iso_affine_function limit[2]; /* distances from its edges in the plane; positive between them */
    iso_affine_function level[2]; /* heights of its edges above the position, in the viewer's picture */
    bool rises;                   /* the second edge is higher */
} iso_outline_side;

typedef struct iso_outline {
    bool plane;    /* a half space: only the plane of side[0] matters */
    bool inverted; /* what is outside is removed */
    bool pyramid; /* nothing is within the outline where `depth`, the distance from the viewer, is negative */
    iso_affine_function depth;
    iso_outline_side *side; /* owned */
    int count;
} iso_outline;

/* What iso_outline_make needs to know about the grid. */
typedef struct iso_outline_space {
    const iso_affine *affine; /* from index to world coordinates; borrowed */
    double spacing;           /* mm from voxel to voxel */
} iso_outline_space;

/* Makes an image of the outline of a stroke; iso_outline_free. ISO_ERR_USAGE: the samples outline nothing,
 * too few of them, or their normals are neither parallel nor do they meet in a point; ISO_ERR_LIMIT: it has
 * too many sides; ISO_ERR_NOMEM. */
iso_status iso_outline_make(const iso_outline_space *space, iso_tool tool, const iso_brush_image *image,
                            const iso_sample *samples, size_t count, iso_outline *outline, iso_error *error);
void iso_outline_free(iso_outline *outline);

/* Returns the signed distance from a position to what is removed; negative within. */
double iso_outline_distance(const iso_outline *outline, const double at[3]);

/* A side in floats, for positions relative to a brick's first voxel. */
typedef struct iso_local_side {
    float plane[4], limit[2][4], level[2][4];
    bool rises;
    bool near;    /* it may be the nearest one */
    bool crossed; /* a line from some voxel to the outside may cross it */
} iso_local_side;

typedef struct iso_local_outline {
    bool plane, inverted;
    bool pyramid; /* `depth` is negative somewhere in the brick */
    float depth[4];
    bool within; /* crossings of the sides that are left out make voxels begin within the outline */
    int count;
    iso_local_side side[ISO_OUTLINE_SIDES];
} iso_local_outline;

/* Finds the sides that matter for a brick's voxels. */
void iso_outline_localize(const iso_outline *outline, const int brick[3], iso_local_outline *local);

#endif
