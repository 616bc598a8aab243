/* extract_support: volumes and comparisons for the tests of extract. */
#ifndef ISO_TESTS_EXTRACT_SUPPORT_H
#define ISO_TESTS_EXTRACT_SUPPORT_H

#include <stdint.h>

#include "base/c_linkage.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/grid.h"

ISO_C_BEGIN

typedef struct test_random {
    uint64_t state;
} test_random;

uint32_t test_random_next(test_random *random);
int test_random_int(test_random *random, int low, int high); /* inclusive */
double test_random_real(test_random *random, double low, double high);
iso_vec3 test_random_direction(test_random *random);                        /* unit */
void test_random_dims(test_random *random, int low, int high, int dims[3]); /* each low .. high */

/* Creates an rgrid of `type` with all voxels 0 and the identity transform; fails the test on errors. */
iso_grid test_rgrid(const int dims[3], iso_type type);

/* Creates an hgrid whose voxels are all outside. */
iso_grid test_hgrid(const int dims[3], float band);

/* Writes one voxel of an rgrid (rounded for integer types) or of an hgrid (splits its cell), without a change
 * log entry. */
void test_set(const iso_grid *grid, int x, int y, int z, double value);

typedef enum test_pattern {
    TEST_NOISE,  /* every voxel independent, 0 .. 250 */
    TEST_LEVELS, /* few levels, among them the isovalue 100 itself */
    TEST_SMOOTH  /* sums of a few waves: smooth surfaces */
} test_pattern;

/* Fills an rgrid. The isovalue for all patterns is 100. */
void test_fill(const iso_grid *grid, test_pattern pattern, test_random *random);

/* Replaces one in 25 voxels of an rgrid of floats, at random, by NaN or an infinity. */
void test_scatter_nonfinite(const iso_grid *grid, test_random *random);

/* A ball that is added to or removed from a level set, as a clamped signed distance, in either kind of grid
 * (cells of an hgrid are split where needed). Centre and radius in voxels. */
typedef struct test_ball {
    iso_vec3 centre;
    double radius;
    int carve; /* 0: united with the solid; 1: removed from it */
} test_ball;
void test_stamp_ball(const iso_grid *grid, const test_ball *ball);

/* A level set of so many balls in a sparse grid of about `size` voxels a side; every third one is removed. */
iso_grid test_random_balls(int size, int count, test_random *random);

/* Makes a random edit and records it in the change log: a ball that is added or removed (level sets), or a
 * box of noise or of one value, around the isovalue 100. */
void test_random_edit(const iso_grid *grid, test_random *random);

/* A level set of a ball: hgrid, or with `dense` an rgrid of float32. */
iso_grid test_ball_grid(int size, iso_vec3 centre, double radius, int dense);

/* Create sets of the grid and update them; fail the test on errors. */
iso_point_set *test_point_set(const iso_grid *grid, const iso_points_opts *opts);
iso_mesh_set *test_mesh_set(const iso_grid *grid, const iso_mesh_opts *opts);

/* Fail the test unless both have the same primitives in each brick, bit for bit, in any order of spans. */
void test_same_points(const iso_point_view *a, const iso_point_view *b);
void test_same_mesh(const iso_mesh_view *a, const iso_mesh_view *b);

ISO_C_END
#endif
