/* points: from a grid to points, one span per brick, and only what changed after the first time.
 *
 * edge: the vertices of Marching Cubes, each once: three edges a voxel (+x, +y, +z), the normal interpolated
 * between the ends' central differences (2003, section 4, rgridb engine).
 *
 * foot: foot points p - d * g / |g| of voxels with d in [0, sqrt 3) (2003, eq. 1). For distance fields in
 * voxels; taken from the voxels of an hgrid's bricks, or of a whole rgrid.
 *
 * foot-iterated: foot points of any scalar field: eq. 2 repeated from the outer corners of the cells that the
 * surface crosses, until the value is within 1e-4 |g| of the isovalue, at most 10 times.
 *
 * A corner is inside when its stored value is at or above the isovalue (exactly: a float isovalue is never
 * rounded to the other side of a voxel); normals point to lower values, or to higher ones when the grid is a
 * level set. No primitive on an edge that touches a NaN or infinite voxel; gradients go around such voxels.
 * Where the interpolated gradient vanishes, the normal is the edge's direction, outwards.
 *
 * A foot point is rejected when |g| < 1/2 (near the medial axis, where two surfaces are equally near), or
 * when a value of its stencil is clamped: of magnitude at or above the hgrid's band (an rgrid states no band,
 * so there this rule does not apply). An iterated one when it gets 2 voxels away from where it started,
 * leaves the volume, meets a zero gradient or a non-finite value, or has not arrived after 10 steps. */
#ifndef ISO_EXTRACT_POINTS_POINTS_H
#define ISO_EXTRACT_POINTS_POINTS_H

#include <stdbool.h>

#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/grid.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

const char *iso_primitive_name(iso_primitive primitive); /* "auto" "edge" "foot" "foot-iterated" */

/* What AUTO stands for: foot for an hgrid, unless the isovalue (physical) is so near the end of its narrow
 * band that foot points would be missing; edge for the rest. */
iso_primitive iso_primitive_auto(const iso_grid *grid, double isovalue);

typedef struct iso_points_opts {
    double isovalue; /* physical (grids/grid.h): of a level set, mm */
    iso_primitive primitive;
    bool floats;    /* keep iso_surfel (24 bytes, exact) instead of iso_point (8 bytes) */
    bool curvature; /* keep an iso_curvature (8 bytes) with each: how the surface bends there
                     * (base/primitives.h)
                     */
    iso_pool *pool; /* borrowed until destroy; NULL: the calling thread */
} iso_points_opts;

/* A consumer of a grid's change log that owns the points. Not thread-safe; different sets are independent. */
typedef struct iso_point_set iso_point_set;

/* The grid is borrowed until destroy. ISO_ERR_USAGE: foot on a grid that is not a level set, isovalue not
 * finite. */
iso_status iso_point_set_create(const iso_grid *grid, const iso_points_opts *opts, iso_point_set **set,
                                iso_error *error);
void iso_point_set_destroy(iso_point_set *set);

/* Brings the points up to date: the first time (and after iso_point_set_isovalue) all bricks, later only
 * bricks that the change log names, widened by the halo of the primitive. After a full extraction spans are
 * in brick order (x fastest) and packed without gaps, whatever the thread count; later a brick that grows may
 * move to another place, and now and then all do to close gaps. ISO_ERR_USAGE: isovalue not finite.
 * ISO_ERR_NOMEM: call again; what the view holds then is sound, but older, or lacks bricks (all of them when
 * a full extraction failed). */
iso_status iso_point_set_update(iso_point_set *set, iso_error *error);

/* Changes the isovalue (physical); the next update extracts again. */
void iso_point_set_isovalue(iso_point_set *set, double isovalue);

/* The points, borrowed until the next update or destroy. Items between spans, after updates, mean nothing. */
iso_point_view iso_point_set_view(const iso_point_set *set);

/* Finds what drawing can leave out: bounds of each span, and whether the points lie on closed surfaces (that
 * is: none of them is within a voxel of the volume's border, or near a voxel that is not finite).
 * Until the next update the view holds both; without this call it has no bounds and is not closed. Looks at
 * the spans that changed only. ISO_ERR_NOMEM. */
iso_status iso_point_set_bound(iso_point_set *set, iso_error *error);

/* What the last updates met. */
typedef struct iso_points_stats {
    size_t points;   /* now in the set */
    size_t rejected; /* foot points given up by the rules above; counted by the last full extraction */
    size_t bricks;   /* extracted by the last update (those that could not hold anything are not) */
} iso_points_stats;
iso_points_stats iso_point_set_stats(const iso_point_set *set);

#ifdef __cplusplus
}
#endif
#endif
