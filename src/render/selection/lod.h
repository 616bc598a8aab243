/* lod: levels of detail of a set of points: coarser and coarser copies of it, of which a picture needs only
 * the one whose points are about as far apart as pixels are.
 *
 * Level k has voxels that are 2^k times as large. All points of level k - 1 that lie in one voxel of level
 * k and face the same way become one point of it: the mean of their positions, normals and colours. A level
 * is a set of points like any other, in spans of 16^3 of its voxels, which every renderer can draw; a span
 * of level k stands for up to eight spans of level k - 1, its children. As a surface crosses a quarter as
 * many voxels of twice the size, all levels together have a third of the points of level 0. The colours are
 * prefiltered, as those of a texture's mip-map are (surfel mip-maps; Pfister et al. 2000), and every point
 * knows the colour of the point that stands for it in the next level, so that a picture can interpolate
 * between both.
 *
 * Dachsbacher, Vogelgsang and Stamminger 2003 (Sequential Point Trees) sort the nodes of one octree by the
 * distances from which they are to be drawn; Guennebaud et al. 2004, section 7.2, recommends that for
 * deferred splatting. Here all nodes of a span change levels together: then a point needs neither a
 * distance nor a radius of its own, only the spans whose points have changed are made again, and what is
 * drawn is contiguous in memory. */
#ifndef ISO_RENDER_SELECTION_LOD_H
#define ISO_RENDER_SELECTION_LOD_H

#include "base/parallel.h"
#include "base/primitives.h"

enum { ISO_LOD_LEVELS = 21 }; /* most levels, with level 0 */

/* The error of a span in voxels: FLAT plus BENT times the sine of the typical angle between a normal and the
 * mean that takes its place, and times the same difference of colours (0 to 1); at most 1. The mean of the
 * points in a voxel is about half a voxel from them (e_t of the paper). Where the surface is bent within a
 * voxel, the mean of its normals is not the normal at any of them, and shading changes by more than the
 * distance e_p from the plane says. Measured: a flat surface in voxels of two pixels looks like one in
 * voxels of one. */
#define ISO_LOD_FLAT_ERROR 0.5f
#define ISO_LOD_BENT_ERROR 5.0f

/* The shared radius of a level's points, in radii of the points of level 0 and voxels of the level. Larger
 * than 1: a plane crosses the voxels of a grid in places that are not as evenly apart as edge points are. */
#define ISO_LOD_RADIUS 1.15

/* A level above 0. All arrays are owned. Its spans are in the order of Morton codes of their bricks. */
typedef struct iso_lod_level {
    iso_point *packed;   /* this or */
    iso_surfel *surfels; /* this, as level 0 has */
    float *radii;        /* mm; a disc that contains the discs of the points it stands for. NULL: those of
                            level 0 have none and do not overlap (iso_point_view) */
    uint8_t (*colors)[3];
    /* With colours: for every point of the level below, by span of this level, its children and their points,
     * the colour of the point that stands for it here; those of span s begin at first_color_below[s]. */
    uint8_t (*colors_below)[3];
    size_t *first_color_below;
    iso_point_span *spans;
    iso_point_bounds *bounds;
    float *errors; /* of each span, in voxels: how far points may be from where they should be; up to 1 */
    uint64_t *versions;    /* change when those of the children do */
    uint32_t *first_child; /* the children of span s are first_child[s] .. first_child[s + 1] - 1 */
    size_t span_count, count;
} iso_lod_level;

/* Zero-initialise; free with iso_lod_free. */
typedef struct iso_lod {
    iso_point_view points; /* level 0, borrowed */
    uint32_t *order;       /* the spans of level 0 in the order that the children of level 1 are counted in */
    iso_lod_level level[ISO_LOD_LEVELS]; /* level[0] is empty */
    int count;                           /* of levels, with level 0 */
    size_t made, kept;                   /* how many spans the last update made, and kept */
} iso_lod;

/* Makes the levels of `points`, which is borrowed until the next update. Spans of levels above 0 are kept
 * from the update before if the versions of the spans below them are the same; without versions, and where
 * points have colours or radii that they had not then, or the other way round, all are made. The result is
 * the same as if all were made, and for every number of threads. ISO_ERR_NOMEM; ISO_ERR_LIMIT: bricks further
 * than 2^20 bricks from brick 0. After an error the levels are those of no points. */
iso_status iso_lod_update(iso_lod *lod, const iso_point_view *points, iso_pool *pool, iso_error *error);
void iso_lod_free(iso_lod *lod);

/* A view of level 0 .. lod->count - 1, borrowed until the next update. */
iso_point_view iso_lod_view(const iso_lod *lod, int level);
/* The number of a child's span in level - 1: `child` is one of first_child[s] .. first_child[s + 1] - 1 of a
 * span s of `level`. */
static inline size_t iso_lod_child(const iso_lod *lod, int level, uint32_t child) {
    return level == 1 ? lod->order[child] : child;
}
/* The points of all levels above 0, and their bytes with those of their spans. */
size_t iso_lod_count(const iso_lod *lod);
size_t iso_lod_bytes(const iso_lod *lod);

#endif
