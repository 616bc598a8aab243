/* points: from a grid to points, one span per brick, and only what changed after the first time.
 *
 *   edge          the vertices of Marching Cubes, each once: three edges a voxel (+x, +y, +z), the normal
 * interpolated between the ends' central differences (2003, section 4, rgridb engine) foot          foot
 * points p - d * g / |g| of voxels with d in [0, sqrt 3) (2003, eq. 1): distance fields foot-iterated foot
 * points of any scalar field by iterating eq. 2 from voxels whose cells the surface crosses
 *
 * A corner is inside when its stored value is at or above the isovalue; normals point to lower values, or to
 * higher ones when the grid is a level set. No primitive on an edge that touches a NaN or infinite voxel.
 * Where the interpolated gradient vanishes, the normal is the edge's direction. */
#ifndef ISO_EXTRACT_POINTS_H
#define ISO_EXTRACT_POINTS_H

#include <stdbool.h>

#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_primitive {
    ISO_PRIMITIVE_AUTO, /* foot for an hgrid, edge for an rgrid */
    ISO_PRIMITIVE_EDGE,
    ISO_PRIMITIVE_FOOT,
    ISO_PRIMITIVE_FOOT_ITERATED
} iso_primitive;

const char *iso_primitive_name(iso_primitive primitive); /* "auto" "edge" "foot" "foot-iterated" */

typedef struct iso_points_opts {
    double isovalue; /* physical */
    iso_primitive primitive;
    bool floats;    /* keep iso_surfel (24 bytes, exact) instead of iso_point (8 bytes) */
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
 * in brick order (x fastest), whatever the thread count. ISO_ERR_NOMEM: call again; the set stays consistent.
 */
iso_status iso_point_set_update(iso_point_set *set, iso_error *error);

/* Changes the isovalue (physical); the next update extracts again. */
void iso_point_set_isovalue(iso_point_set *set, double isovalue);

/* The points, borrowed until the next update or destroy. Spans with count 0 can occur after updates. */
iso_point_view iso_point_set_view(const iso_point_set *set);

/* What the last updates met. */
typedef struct iso_points_stats {
    size_t points;   /* now in the set */
    size_t rejected; /* foot points given up: at the medial axis (|g| < 1/2), or in a clamped stencil, or
                        (iterated) not converged; counted by the last full extraction */
    size_t bricks;   /* bricks extracted by the last update */
} iso_points_stats;
iso_points_stats iso_point_set_stats(const iso_point_set *set);

#ifdef __cplusplus
}
#endif
#endif
