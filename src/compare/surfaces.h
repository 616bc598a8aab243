/* surfaces: how far two surfaces are from each other: isosurfaces of volumes, or meshes. */
#ifndef ISO_COMPARE_SURFACES_H
#define ISO_COMPARE_SURFACES_H

#include "base/parallel.h"
#include "grids/distance/distance.h"

/* A surface. All pointers are borrowed. */
typedef struct iso_compared_surface {
    const iso_triangles *mesh;    /* in the world, mm; of a field its Marching Cubes mesh */
    const iso_distance *distance; /* from the surface */
    bool is_field;                /* the vertices lie on the surface; triangles are smaller than voxels */
} iso_compared_surface;

/* One surface, and the distances of its points from the other one. */
typedef struct iso_surface_distances {
    double area;        /* mm2 */
    double mean, rms;   /* mm, weighted by area */
    double signed_mean; /* the same with signs: below 0 inside the other surface */
    double p95, most;   /* mm: 95 % of the area is nearer; the largest, the directed Hausdorff distance */
    size_t points;
} iso_surface_distances;

typedef struct iso_surfaces_compared {
    iso_surface_distances side[2]; /* of the first from the second, and the other way */
    double mean, p95, hausdorff;   /* mm: of both ways the mean, and the larger ones */
    double volume[2], overlap;     /* mm3: of the solids, and of what lies in both */
    double dice;                   /* 2 overlap / (sum of the volumes), 0 .. 1 */
    double step;                   /* mm between the points that volumes are counted at */
} iso_surfaces_compared;

/* Compares two surfaces: distances at all vertices and, of meshes, at points in their triangles; volumes
 * by the points of a lattice of about a million points (meshes: 100,000) in the box of both. The same with
 * every number of threads. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_compare_surfaces(const iso_compared_surface surfaces[2], iso_pool *pool,
                                iso_surfaces_compared *compared, iso_error *error);

#endif
