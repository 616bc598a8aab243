/* scene_support: points of scenes, views of them and pictures, for tests of methods that draw points. */
#ifndef ISO_TESTS_SCENE_SUPPORT_H
#define ISO_TESTS_SCENE_SUPPORT_H

#include "base/status.h"
#include "check_support.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "image/camera.h"
#include "render/point_surface.h"
#include "render/view/gbuffer.h"

typedef struct test_scene {
    iso_grid grid;
    double isovalue;
    iso_point_set *set;
    iso_point_view points;
} test_scene;

/* Extracts a scene's points with `opts` (NULL: defaults) at the scene's isovalue. Free with test_scene_free.
 */
test_scene test_scene_make(const char *name, int size, const iso_points_opts *opts, bool bounded);
void test_scene_free(test_scene *scene);
/* The box of the scene's points in world coordinates. */
iso_box test_scene_box(const test_scene *scene);

/* A scene as edge points (float surfels or packed) and as triangles. Free with test_surfaces_free. */
typedef struct test_surfaces {
    test_scene scene;
    iso_mesh_set *set;
    iso_mesh_view mesh;
} test_surfaces;

test_surfaces test_surfaces_make(const char *name, int size, bool floats);
void test_surfaces_free(test_surfaces *surfaces);

/* A view of the scene from `side` 0 .. 5; with `zoom` 1 all of it is visible. */
iso_view test_look_at(const test_scene *scene, int side, double zoom, bool orthographic, int width,
                      int height);

/* A view in which index coordinates are view coordinates: x right, y down, z forward, the eye at the origin.
 */
iso_view test_plain_view(int width, int height, bool orthographic, double focal);

/* A cleared gbuffer, with no uninitialised bytes. */
iso_gbuffer test_clear_gbuffer(int width, int height, bool colored);

/* Fails the test unless the rows of `a` from a_row on are equal to all rows of b. */
void test_same_rows(const iso_gbuffer *a, int a_row, const iso_gbuffer *b);

/* Draws what `context` says, in a view; the caller frees the gbuffer. `pool` may be NULL. */
typedef iso_gbuffer test_picture(const void *context, const iso_view *view, iso_pool *pool);

/* Fail the test unless the picture of the view is `wanted`, byte for byte: with every instruction set and 1
 * to 3 threads; in strips of several heights, `lowest` rows or more. */
void test_variants_of(test_picture *draw, const void *context, const iso_view *view,
                      const iso_gbuffer *wanted);
void test_strips_of(test_picture *draw, const void *context, const iso_view *view, int lowest,
                    const iso_gbuffer *wanted);

/* Draws points by pull-push into a cleared gbuffer. opts NULL: Gaussian; pool may be NULL. */
iso_gbuffer test_drawn(const iso_view *view, const iso_point_view *points, const iso_point_surface_opts *opts,
                       iso_pool *pool);
/* test_variants_of and test_strips_of for such a picture. */
void test_every_variant(const iso_view *view, const iso_point_view *points,
                        const iso_point_surface_opts *opts, const iso_gbuffer *wanted);
void test_every_strip(const iso_view *view, const iso_point_view *points, const iso_point_surface_opts *opts,
                      const iso_gbuffer *wanted);

#endif
