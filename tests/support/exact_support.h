/* What the tests of exact share: its pictures, the ray caster's, and how far apart they are. */
#ifndef ISO_TESTS_EXACT_SUPPORT_H
#define ISO_TESTS_EXACT_SUPPORT_H

#include "exact/exact.h"
#include "truth/raycast.h"

/* A gbuffer of the view's size in which nothing was drawn; normals 0. */
iso_gbuffer empty_picture(const iso_view *view);

/* The cells of an isovalue, up to date. */
iso_exact *make_exact(const iso_grid *grid, double isovalue, iso_pool *pool);

/* Draws as surface 3. */
void draw_exact(const iso_exact *exact, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool);

/* Exact's picture and the ray caster's. */
iso_gbuffer picture_of(const iso_grid *grid, double isovalue, const iso_view *view, iso_pool *pool);
iso_gbuffer truth_of(const iso_grid *grid, double isovalue, const iso_view *view);

/* How exact's pictures differ from the ray caster's, summed over pictures. */
typedef struct test_verdict {
    size_t samples, hits;
    size_t missing, extra;
    size_t deep;   /* more than 1e-3 voxel apart */
    size_t tinted; /* as deep, and a colour differs by more than 1 / 255 */
} test_verdict;

/* Adds the picture of a view. */
void judge(const iso_grid *grid, double isovalue, const iso_view *view, test_verdict *verdict);

#endif
