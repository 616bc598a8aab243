/* view_support: transforms, views and comparisons of pictures, for tests of methods that draw a grid's
 * surface. */
#ifndef ISO_TESTS_VIEW_SUPPORT_H
#define ISO_TESTS_VIEW_SUPPORT_H

#include "grids/grid.h"
#include "image/camera.h"
#include "render/view/gbuffer.h"

enum { TEST_TRANSFORMS = 3 };

/* A transform: kind 0: the identity, 1: a rotation with uneven spacing, 2: its mirror image. */
iso_transform test_transform(int kind);

/* Gives a grid that transform. */
void test_set_transform(const iso_grid *grid, int kind);

typedef enum test_view {
    TEST_PERSPECTIVE,
    TEST_ORTHOGRAPHIC,
    TEST_INSIDE, /* the eye is near the grid's middle and looks outwards */
    TEST_CUT,    /* the near plane is in the grid's middle */
    TEST_VIEWS
} test_view;

/* A square view of the grid; the unit vector `away` is the direction of the eye from the grid's middle. */
iso_view test_view_make(const iso_grid *grid, test_view kind, int size, iso_vec3 away);

/* A view along index axis `axis` (up or down) of a grid with the identity transform. Samples are `step`
 * voxels apart; the first is at `first` on both other axes. */
iso_view test_axis_view(int axis, bool up, double step, double first, int size);

/* The number of covered samples. */
size_t test_covered(const iso_gbuffer *gbuffer);

/* Fails the test unless both have the same bytes in every plane, in normals only where samples are covered.
 */
void test_same_pictures(const iso_gbuffer *a, const iso_gbuffer *b);

#endif
