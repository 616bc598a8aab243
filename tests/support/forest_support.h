/* forest_support: many copies of scenes, and a walk among them, for tests of instances. */
#ifndef ISO_TESTS_FOREST_SUPPORT_H
#define ISO_TESTS_FOREST_SUPPORT_H

#include "render/selection/instances.h"
#include "scene_support.h"

enum { TEST_FOREST_SETS = 2, TEST_FOREST_MOST = 400 };

/* Copies of two scenes, turned about the vertical and of different sizes. */
typedef struct test_forest {
    test_scene scenes[TEST_FOREST_SETS];
    iso_lod lods[TEST_FOREST_SETS];
    iso_instanced sets[TEST_FOREST_SETS];
    iso_instance instances[TEST_FOREST_MOST];
    iso_instances all;
} test_forest;

/* Free with test_forest_free. */
test_forest *test_forest_make(size_t count);
void test_forest_free(test_forest *forest);
/* Makes levels of detail and boxes again, after the scenes' points have changed. */
void test_forest_make_lods(test_forest *forest);

/* The size of the trees. */
double test_forest_side(const test_forest *forest);
/* A view from the edge of the forest, of frame `number` of a walk through it; every 20th frame looks back. */
iso_view test_forest_view(const test_forest *forest, int number, int width, int height);

/* A wall that faces the eye (set 0), and close behind it a plane turned nearly edge-on, of discs far smaller
 * than the pixels of test_wall_view (set 1). Borrow arrays of this struct. */
typedef struct test_wall {
    iso_surfel surfels[2][32 * 32];
    iso_point_span spans[2];
    iso_lod lods[2];
    iso_instanced sets[2];
    iso_instance instances[2];
    iso_instances all;
} test_wall;

/* `behind`: how far the plane's nearest discs lie behind the wall, mm. */
void test_wall_make(test_wall *wall, double behind);
iso_view test_wall_view(int width, int height, bool orthographic);

#endif
