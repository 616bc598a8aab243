/* bench_bumpy: points and meshes of as many primitives as one likes: a bumpy sphere with a thin tilted ring,
 * so that there are silhouettes in front of surfaces. */
#ifndef ISO_TESTS_BENCH_BUMPY_H
#define ISO_TESTS_BENCH_BUMPY_H

#include <stdbool.h>

#include "base/parallel.h"
#include "base/primitives.h"
#include "extract/mesh/mesh.h"
#include "grids/hgrid.h"

typedef struct bench_bumpy {
    iso_point_view points; /* edge points; arrays owned */
    iso_mesh_set *mesh;    /* with its grid, owned; NULL when none was asked for */
    iso_grid grid;
} bench_bumpy;

/* The surface at `side` voxels over [-1, 1] on each axis: about 2.8 side^2 points, twice as many triangles.
 * It is worked off in pieces of at most `piece` bricks a side, since an hgrid has 2048 voxels at most; a mesh
 * is made of one piece only. bench_bumpy_free when done, also after errors. */
iso_status bench_bumpy_create(int side, int piece, bool with_mesh, iso_pool *pool, bench_bumpy *bumpy,
                              iso_error *error);
void bench_bumpy_free(bench_bumpy *bumpy);

enum { BENCH_BUMPY_PIECE = ISO_HGRID_MAX / ISO_BRICK - 2 };

#endif
