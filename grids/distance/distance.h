/* distance: signed distances from a surface: that of a triangle mesh, or the isosurface of a grid itself,
 * which is the trilinear surface, not a mesh of it. For colours of surfaces and for comparing them. */
#ifndef ISO_GRIDS_DISTANCE_DISTANCE_H
#define ISO_GRIDS_DISTANCE_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/nearby.h"
#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/grid.h"

/* Immutable; thread-safe. */
typedef struct iso_distance iso_distance;

/* The isosurface of a grid, which is borrowed until iso_distance_destroy. mesh: its Marching Cubes mesh in
 * index coordinates, copied: the search begins with its nearest triangles, and ends at the nearest point
 * of the trilinear surface in their cells. isovalue: physical. ISO_ERR_EMPTY: there is no triangle;
 * ISO_ERR_NOMEM. */
iso_status iso_distance_of_field(const iso_grid *grid, double isovalue, const iso_triangles *mesh,
                                 iso_pool *pool, iso_distance **distance, iso_error *error);

/* A mesh in the world, mm; copied. ISO_ERR_EMPTY: there is no triangle; ISO_ERR_NOMEM. */
iso_status iso_distance_of_mesh(const iso_triangles *mesh, iso_distance **distance, iso_error *error);

void iso_distance_destroy(iso_distance *distance); /* NULL is allowed */

/* The distance from a point in the world, mm; below 0 inside: of a field where the volume says so, of a
 * mesh where its winding number is nearer to 1 than to 0 (or to -1, if it is inside out). *nearby makes
 * the search for points that are near to each other faster; the distance does not depend on it but for
 * rounding. */
double iso_distance_at(const iso_distance *distance, iso_vec3 point, iso_nearby *nearby);

/* Whether a point is inside, as the sign of iso_distance_at says. */
bool iso_distance_is_inside(const iso_distance *distance, iso_vec3 point);

#endif
