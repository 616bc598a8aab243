/* distances: distances from the isosurface of a grid, for colours and for comparing surfaces. */
#ifndef ISO_SCENE_DISTANCES_H
#define ISO_SCENE_DISTANCES_H

#include "extract/mesh/mesh.h"
#include "grids/distance/distance.h"

/* Extracts the mesh that iso_distance_of_field begins with. The grid is borrowed until
 * iso_distance_destroy; `pool` may be NULL. ISO_ERR_EMPTY: there is no surface at this isovalue
 * (physical); ISO_ERR_USAGE, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_distance_of_isosurface(const iso_grid *grid, double isovalue, iso_pool *pool,
                                      iso_distance **distance, iso_error *error);

/* The same from a mesh in a file. *mesh: the mesh, the caller's (iso_triangles_free); NULL: not wanted.
 * Errors of iso_mesh_read and iso_distance_of_mesh. */
iso_status iso_distance_of_mesh_file(const char *path, iso_triangles *mesh, iso_distance **distance,
                                     iso_error *error);

/* The mesh of an isosurface; iso_weld_free when done. Errors as above, but for ISO_ERR_EMPTY. */
iso_status iso_isosurface_mesh(const iso_grid *grid, double isovalue, iso_pool *pool, iso_weld *weld,
                               iso_error *error);

/* The positions and triangles of a mesh, in coordinates of the grid or in the world (`affine` maps one to
 * the other; NULL: index coordinates); iso_triangles_free when done. ISO_ERR_NOMEM. */
iso_status iso_weld_triangles(const iso_weld *weld, const iso_affine *affine, iso_triangles *triangles,
                              iso_error *error);

#endif
