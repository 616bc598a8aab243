/* exact_support: shared by the tests of exact: pictures by exact and by the ray caster, and their
 * differences. */
#ifndef ISO_TESTS_EXACT_SUPPORT_H
#define ISO_TESTS_EXACT_SUPPORT_H

#include "exact/exact.h"
#include "truth/raycast.h"

/* A cleared gbuffer of the view's size, with normals 0. */
iso_gbuffer empty_picture(const iso_view *view);

/* Extracts the cells of an isovalue. */
iso_exact *make_exact(const iso_grid *grid, double isovalue, iso_pool *pool);

/* Draws with the surface number 3. */
void draw_exact(const iso_exact *exact, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool);

/* Draw a grid by exact; by the ray caster. */
iso_gbuffer picture_of(const iso_grid *grid, double isovalue, const iso_view *view, iso_pool *pool);
iso_gbuffer truth_of(const iso_grid *grid, double isovalue, const iso_view *view);

/* Differences between pictures by exact and by the ray caster, summed over pictures. */
typedef struct test_verdict {
    size_t samples, hits;
    size_t missing, extra;
    size_t deep;   /* samples whose depths differ by more than 1e-3 voxel */
    size_t tinted; /* of the others, those with a colour that differs by more than 1 / 255 */
} test_verdict;

/* Adds the differences of the pictures of a view. */
void judge(const iso_grid *grid, double isovalue, const iso_view *view, test_verdict *verdict);

#endif
