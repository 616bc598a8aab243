/* measure: what a person measures of a solid: volume, area and size; places of its surface, how thick it is
 * there, and how far apart they are. */
#ifndef ISO_SCENE_MEASURE_H
#define ISO_SCENE_MEASURE_H

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/parallel.h"
#include "grids/grid.h"

ISO_C_BEGIN

typedef struct iso_solid_measures {
    double volume, area; /* mm3, mm2: of the mesh of the surface, capped where the grid ends */
    iso_box box;         /* of that mesh, world */
    size_t pieces;       /* of the surface */
} iso_solid_measures;

/* Measures the solid of a level set. The same bits for every number of threads; `pool` may be NULL.
 * ISO_ERR_EMPTY: there is none; ISO_ERR_NOMEM, ISO_ERR_LIMIT. */
iso_status iso_measure_solid(const iso_grid *grid, iso_pool *pool, iso_solid_measures *measures,
                             iso_error *error);

/* A place of the trilinear surface. */
typedef struct iso_measured_place {
    iso_vec3 position, normal; /* world; the normal is a unit vector out of the solid */
    double thickness;          /* from there along the normal, inwards, to where the solid ends, mm; INFINITY:
                                  the grid ends before */
} iso_measured_place;

/* Measures the place of a level set's surface that is nearest to a point. It is exact within a voxel of the
 * surface; from farther away it is the nearest one but for what a surface can bend within a voxel.
 * ISO_ERR_EMPTY: there is no surface; ISO_ERR_NOMEM. */
iso_status iso_measure_place(const iso_grid *grid, iso_vec3 near, iso_pool *pool, iso_measured_place *place,
                             iso_error *error);

ISO_C_END
#endif
