/* shapes_support: draws sets of shapes and compares them with rays in extended precision, for tests. */
#ifndef ISO_TESTS_SHAPES_SUPPORT_H
#define ISO_TESTS_SHAPES_SUPPORT_H

#include "shapes_truth.h"

/* A view of the surroundings of `origin` from `away`, in which `height` mm at the origin fill the picture. */
iso_view test_shapes_view(iso_vec3 origin, iso_vec3 away, double height, bool parallel);
/* The same for a picture of pixels[0] x pixels[1] pixels. */
iso_view test_shapes_view_sized(iso_vec3 origin, iso_vec3 away, double height, bool parallel,
                                const int pixels[2]);

/* The prepared set of a scene. */
iso_shapes *test_shapes_make(const iso_shapes_scene *scene);

/* Draws shapes alone, with surface number 3 and elements. */
iso_gbuffer test_shapes_drawn(const iso_view *view, const iso_shapes *shapes, iso_pool *pool);

/* Fails the test unless at most two outline samples and one in 10,000 depths and normals are wrong, each
 * where a ray nearly touches a shape, and where depths are right elements are too. Returns the number of
 * samples that show a shape. */
size_t test_shapes_compare(const iso_shapes_scene *scene, const iso_view *view, const char *name);

/* The same for three zooms, perspective and parallel. */
void test_shapes_compare_views(const iso_shapes_scene *scene, iso_vec3 away, double height, const char *name);

/* Fails the test unless every instruction set, number of threads and strip gives the same bytes. */
void test_shapes_variants(const iso_shapes *shapes, const iso_view *view);

/* A clip of a half-space, and of a ball that overlaps it. */
iso_clip test_shapes_clip(iso_vec3 middle);
/* Whether a clip (NULL: none) leaves the ray through (px, py) at a depth. */
bool test_shapes_left(const iso_clip *clip, const iso_view *view, double px, double py, double depth);

#endif
