// flying_edges: compares a grid's mesh with that of vtkFlyingEdges3D.
#ifndef ISO_TESTS_FLYING_EDGES_HPP
#define ISO_TESTS_FLYING_EDGES_HPP

#include <cstddef>

#include "grids/grid.h"

// Fails unless both have as many vertices and triangles, the same vertices within 1e-4 voxel, and (unless the
// grid is a level set, where ours point the other way) the same normals. For finite data with every dimension
// >= 2. `isovalue` is physical. Returns the number of triangles.
size_t check_against_flying_edges(const iso_grid *grid, double isovalue);

#endif
