/* points: extracts points from a grid, one span per brick; after the first time only the bricks that changed.
 *
 * edge: the vertices of Marching Cubes, each once: three edges a voxel (+x, +y, +z), the normal interpolated
 * between the ends' central differences (Baerentzen and Christensen 2003, section 4, rgridb engine).
 *
 * foot: foot points p - d * g / |g| of voxels p with distances d in [0, sqrt 3) and gradients g (same paper,
 * eq. 1). For distance fields in voxels: the voxels of an hgrid's bricks, or of a whole rgrid.
 *
 * foot-iterated: foot points of any scalar field: eq. 2 of the paper repeated from the outer corners of the
 * cells that the surface crosses, until the value is within 1e-4 |g| of the isovalue, at most 10 times.
 *
 * A corner is inside when its stored value is at or above the isovalue (exactly: a float isovalue is never
 * rounded to the other side of a voxel); normals point to lower values, or to higher ones when the grid is a
 * level set. An edge with a NaN or infinite end has no point; differences with such a voxel are one-sided.
 * Where the interpolated gradient vanishes, the normal is the edge's outward direction.
 *
 * A foot point is rejected when |g| < 1/2 (near the medial axis, where two surfaces are equally near), or
 * when a value of its stencil is clamped: of magnitude at or above the hgrid's band (an rgrid states no
 * band, so there this rule does not apply). An iterated foot point is rejected when it gets 2 voxels away
 * from its voxel, leaves the volume, meets a zero gradient or a non-finite value, or has not arrived after
 * 10 steps. */
#ifndef ISO_EXTRACT_POINTS_POINTS_H
#define ISO_EXTRACT_POINTS_POINTS_H

#include <stdbool.h>

#include "base/c_linkage.h"
#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/grid.h"
#include "grids/grid_chunk.h"
#include "isopoint.h"

ISO_C_BEGIN

const char *iso_primitive_name(iso_primitive primitive); /* "auto" "edge" "foot" "foot-iterated" */

/* The primitive that ISO_PRIMITIVE_AUTO stands for here, that which is extracted fastest: foot for an hgrid,
 * unless the isovalue (physical) is so near the end of its narrow band that foot points would be missing;
 * edge for all other grids. Pictures and files show edge points, because foot points miss narrow creases. */
iso_primitive iso_primitive_auto(const iso_grid *grid, double isovalue);

typedef struct iso_points_opts {
    double isovalue; /* physical (grids/grid.h): of a level set, mm */
    iso_primitive primitive;
    bool floats;    /* keep iso_surfel (24 bytes, exact) instead of iso_point (8 bytes) */
    bool curvature; /* keep an iso_curvature (8 bytes; base/primitives.h) with each point */
    iso_pool *pool; /* borrowed until destroy; NULL: the calling thread */
    /* The grid is that of this chunk: the edge points are those of the chunk's bricks, numbered as in the
     * whole. Copied. Edits are not followed. NULL: the grid is the whole. */
    const iso_grid_chunk *chunk;
} iso_points_opts;

/* Owns the points of a surface, and follows the grid's change log. Not thread-safe; different sets are
 * independent. */
typedef struct iso_point_set iso_point_set;

/* Creates an empty set; iso_point_set_update extracts the points. The grid is borrowed until
 * iso_point_set_destroy. ISO_ERR_USAGE: foot points of a grid that is not a level set or of a chunk, or an
 * isovalue that is not finite. */
iso_status iso_point_set_create(const iso_grid *grid, const iso_points_opts *opts, iso_point_set **set,
                                iso_error *error);
void iso_point_set_destroy(iso_point_set *set);

/* Brings the points up to date: the first time (and after iso_point_set_isovalue) all bricks, later only
 * bricks that the change log names, widened by the halo of the primitive. After a full extraction spans are
 * in brick order (x fastest) and without gaps, for any number of threads; later a span that grows may move,
 * and sometimes all spans move to close gaps. ISO_ERR_USAGE: isovalue not finite. ISO_ERR_NOMEM: the points
 * extracted so far can be used, but may be out of date or incomplete (none, if a full extraction failed);
 * call iso_point_set_update again. */
iso_status iso_point_set_update(iso_point_set *set, iso_error *error);

/* Sets the isovalue (physical); the next update extracts all bricks again. */
void iso_point_set_isovalue(iso_point_set *set, double isovalue);

/* The radius of the edge points of a volume, mm: iso_point_view.radius. */
double iso_edge_point_radius(const iso_transform *transform);

/* The points, borrowed until the next update or destroy. Items of the arrays that are in no span are
 * undefined. */
iso_point_view iso_point_set_view(const iso_point_set *set);

/* Computes the bounds of each span, and whether the surface is closed (no point is within a voxel of the
 * volume's border, or near a voxel that is not finite), so that drawing can skip hidden spans. Of a chunk
 * only the volume's border counts, and its own spans. The view has both until the next update; without this
 * call it has no bounds and is not closed. Only spans that changed are computed again. ISO_ERR_NOMEM. */
iso_status iso_point_set_bound(iso_point_set *set, iso_error *error);

/* Counts, for reports. */
typedef struct iso_points_stats {
    size_t points;   /* number of points in the set */
    size_t rejected; /* foot points rejected by the rules above, in the last full extraction */
    size_t bricks;   /* bricks extracted by the last update; those that cannot have points are left out */
} iso_points_stats;
iso_points_stats iso_point_set_stats(const iso_point_set *set);

ISO_C_END
#endif
