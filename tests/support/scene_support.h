/* What tests of methods that draw points share: points of scenes, views of them, and pictures. */
#ifndef ISO_TESTS_SCENE_SUPPORT_H
#define ISO_TESTS_SCENE_SUPPORT_H

#include "base/status.h"
#include "check_support.h"
#include "extract/points/points.h"
#include "image/camera.h"
#include "render/gbuffer.h"
#include "render/pullpush/pullpush.h"

typedef struct test_scene {
    iso_grid grid;
    double isovalue;
    iso_point_set *set;
    iso_point_view points;
} test_scene;

/* A scene's points, made with `opts` (NULL: defaults) at the scene's isovalue. Free with test_scene_free. */
test_scene test_scene_make(const char *name, int size, const iso_points_opts *opts, bool bounded);
void test_scene_free(test_scene *scene);

/* A view of the scene from `side` 0 .. 5, `zoom` 1 shows it all. */
iso_view test_look_at(const test_scene *scene, int side, double zoom, bool orthographic, int width,
                      int height);

/* Index coordinates are view coordinates: x right, y down, z forward, the eye at the origin. */
iso_view test_plain_view(int width, int height, bool orthographic, double focal);

/* An empty picture, all of whose bytes are set. */
iso_gbuffer test_clear_gbuffer(int width, int height, bool colored);

/* Rows of `a` from a_row on are all of b. */
void test_same_rows(const iso_gbuffer *a, int a_row, const iso_gbuffer *b);

/* Points drawn by pull-push into an empty picture. opts NULL: Gaussian; pool may be NULL. */
iso_gbuffer test_drawn(const iso_view *view, const iso_point_view *points, const iso_pullpush_opts *opts,
                       iso_pool *pool);
/* The picture is `wanted`, byte for byte, for every instruction set and 1 to 3 threads, and drawn in strips.
 */
void test_every_variant(const iso_view *view, const iso_point_view *points, const iso_pullpush_opts *opts,
                        const iso_gbuffer *wanted);
void test_every_strip(const iso_view *view, const iso_point_view *points, const iso_pullpush_opts *opts,
                      const iso_gbuffer *wanted);

#endif
