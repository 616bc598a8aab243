/* What tests of methods that draw a grid's surface share: placements, views and pictures of grids. */
#ifndef ISO_TESTS_VIEW_SUPPORT_H
#define ISO_TESTS_VIEW_SUPPORT_H

#include "grids/grid.h"
#include "image/camera.h"
#include "render/gbuffer.h"

enum { TEST_TRANSFORMS = 3 };

/* The identity, a rotation with uneven spacing, and its mirror image. */
iso_transform test_transform(int kind);

typedef enum test_view {
    TEST_PERSPECTIVE,
    TEST_ORTHOGRAPHIC,
    TEST_INSIDE, /* from near the grid's middle, outwards and all around */
    TEST_CUT,    /* near plane through the middle */
    TEST_VIEWS
} test_view;

/* A square view of the whole grid from direction `away` of its middle (a unit vector). */
iso_view test_view_make(const iso_grid *grid, test_view kind, int size, iso_vec3 away);

/* Looks along index axis `axis` (up or down) of an identity grid; `step` voxels between samples, the first at
 * `first` on both other axes. */
iso_view test_axis_view(int axis, bool up, double step, double first, int size);

/* Samples that were drawn. */
size_t test_covered(const iso_gbuffer *gbuffer);

/* Asserts the same bytes in every plane; normals only where something was drawn. */
void test_same_pictures(const iso_gbuffer *a, const iso_gbuffer *b);

#endif
