#include <stdlib.h>
#include <string.h>

#include "base/placement.h"
#include "forest_support.h"

/* ---- the pyramid of depths */

/* Whether nothing in an area could be seen, pixel by pixel. */
static bool is_hidden(const iso_gbuffer *g, const iso_area *area) {
    for (int y = area->rows.first; y <= area->rows.last; y++)
        for (int x = area->columns.first; x <= area->columns.last; x++)
            if (!((double)g->depth[y * g->width + x] < area->nearest)) return false;
    return true;
}

/* An area of a gbuffer; `align`: its sides are multiples of this. */
static iso_area random_area(const iso_gbuffer *g, uint32_t *seed, int align) {
    iso_area area;
    iso_rows *const ranges[] = {&area.columns, &area.rows};
    for (int axis = 0; axis < 2; axis++) {
        const int size = axis ? g->height : g->width, first = (int)(uniform(seed) * size) / align * align,
                  last =
                      first + ((int)(uniform(seed) * uniform(seed) * (size - first)) / align + 1) * align - 1;
        *ranges[axis] = (iso_rows){first, last < size ? last : size - 1};
    }
    area.nearest = 10 * uniform(seed);
    return area;
}

static void pyramid_hides_what_is_hidden(void **state) {
    (void)state;
    static const int sizes[][2] = {{1, 1}, {7, 9}, {64, 64}, {200, 131}, {513, 40}};
    uint32_t seed = 11;
    iso_depth_pyramid pyramid = {0};
    for (int s = 0; s < 5; s++) {
        iso_gbuffer g = test_clear_gbuffer(sizes[s][0], sizes[s][1], false);
        const size_t samples = (size_t)g.width * (size_t)g.height;
        size_t hidden = 0, found = 0;
        for (int round = 0; round < 6; round++) {
            /* smooth depths with a few holes */
            for (size_t i = 0; i < samples; i++)
                g.depth[i] = uniform(&seed) < 0.002 ? INFINITY : 3 + (float)(i % (size_t)g.width) * 0.01f;
            assert_int_equal(iso_depth_pyramid_make(&pyramid, &g, NULL), ISO_OK);
            for (int k = 0; k < 300; k++) {
                const iso_area area = random_area(&g, &seed, k % 2 ? 8 : 1);
                const bool says = iso_depth_pyramid_hides(&pyramid, &area), is = is_hidden(&g, &area);
                assert_true(is || !says);
                hidden += is;
                found += says;
                /* what is drawn makes depths smaller, and holes are closed */
                for (int y = area.rows.first; y <= area.rows.last && k % 10 == 0; y++)
                    for (int x = area.columns.first; x <= area.columns.last; x++) {
                        float *depth = &g.depth[y * g.width + x];
                        *depth = *depth < 2 ? *depth : 2;
                    }
                if (k % 10 == 0) iso_depth_pyramid_update(&pyramid, &g, &area);
            }
            iso_depth_pyramid fresh = {0};
            assert_int_equal(iso_depth_pyramid_make(&fresh, &g, NULL), ISO_OK);
            for (int level = 0; level < fresh.levels; level++)
                assert_memory_equal(fresh.level[level], pyramid.level[level],
                                    (size_t)(fresh.width[level] * fresh.height[level]) * sizeof(float));
            iso_depth_pyramid_free(&fresh);
        }
        assert_true(found > hidden / 2);
        const iso_area none = {{3, 2}, {0, 0}, 0};
        assert_true(iso_depth_pyramid_hides(&pyramid, &none));
        iso_gbuffer_free(&g);
    }
    iso_depth_pyramid_free(&pyramid);
}

/* ---- what has been drawn before */

/* A wall across the middle of a scene with a hole in it, drawn before the scene. */
typedef struct walled {
    const iso_point_view *points;
    float wall; /* depth, mm */
    bool curved;
} walled;

static iso_gbuffer draw_behind_wall(const void *context, const iso_view *view, iso_pool *pool) {
    const walled *w = context;
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    for (int y = 0; y < g.height; y++)
        for (int x = 0; x < g.width; x++) {
            const size_t at = (size_t)y * (size_t)g.width + (size_t)x;
            if (x % 50 < 12) continue;
            g.depth[at] = w->wall;
            g.normal[2][at] = -1;
            g.surface[at] = 1;
        }
    iso_point_view points = *w->points;
    if (!w->curved) points.curvatures = NULL;
    const iso_target target = {view, &g, pool, 0, NULL};
    test_ok(iso_draw_point_surface(&target, &points, &(iso_point_surface_opts){0}, &error), &error);
    return g;
}

/* A scene drawn behind something looks like one that is drawn alone, but for what is hidden; the bytes do not
 * depend on threads, instruction sets and strips. */
static void earlier_surfaces_hide_points(void **state) {
    (void)state;
    static const char *const names[] = {"head", "gyroid"};
    for (int n = 0; n < 2; n++) {
        const iso_points_opts opts = {.curvature = true, .primitive = ISO_PRIMITIVE_EDGE};
        test_scene s = test_scene_make(names[n], 40, &opts, true);
        for (int zoom = 1; zoom <= 8; zoom *= 2) {
            const iso_view view = test_look_at(&s, n + zoom, zoom, zoom == 4, 150, 140);
            iso_point_workspace *workspace;
            assert_int_equal(iso_point_workspace_create(&workspace, NULL), ISO_OK);
            iso_gbuffer alone =
                test_drawn(&view, &s.points, &(iso_point_surface_opts){.workspace = workspace}, NULL);
            float depths[2] = {INFINITY, 0};
            for (int i = 0; i < 150 * 140; i++) {
                if (alone.surface[i] == ISO_SURFACE_NONE) continue;
                depths[0] = alone.depth[i] < depths[0] ? alone.depth[i] : depths[0];
                depths[1] = alone.depth[i] > depths[1] ? alone.depth[i] : depths[1];
            }
            const walled w = {&s.points, 0.8f * depths[0] + 0.2f * depths[1], true};
            iso_gbuffer g = draw_behind_wall(&w, &view, NULL);
            int differ = 0, seen = 0;
            for (int i = 0; i < 150 * 140; i++) {
                const bool wall = i % 150 % 50 >= 12, behind = wall && !(alone.depth[i] < w.wall);
                seen += !behind && alone.surface[i] == 0;
                if (behind)
                    differ += g.surface[i] != 1 || g.depth[i] != w.wall;
                else
                    differ += g.surface[i] != alone.surface[i] || g.depth[i] != alone.depth[i] ||
                              g.normal[2][i] != alone.normal[2][i];
            }
            assert_true(seen > 500);
            if (differ > seen / 50) fail_msg("%s: %d of %d samples differ", names[n], differ, seen);
            test_variants_of(draw_behind_wall, &w, &view, &g);
            test_strips_of(draw_behind_wall, &w, &view, 8, &g);
            iso_gbuffer_free(&alone);
            iso_gbuffer_free(&g);
            iso_point_workspace_destroy(workspace);
        }
        test_scene_free(&s);
    }
}

/* Layers of points one behind the other, each near enough to the next one to be averaged with it, and a wall
 * behind the fourth layer: layers that are farther behind the wall than a disc is thick are left out, also
 * where nearer ones would join them with what is seen. */
static void layers_behind_a_wall_are_left_out(void **state) {
    (void)state;
    enum { LAYERS = 10, SEEN = 5, ROW = 20 };
    static iso_surfel surfels[LAYERS * ROW * ROW];
    for (int i = 0; i < LAYERS * ROW * ROW; i++) /* the farthest layer first */
        surfels[i] = (iso_surfel){{(float)(i % ROW - ROW / 2), (float)(i / ROW % ROW - ROW / 2),
                                   (float)(20 + LAYERS - 1 - i / (ROW * ROW))},
                                  {0, 0, -1}};
    const iso_point_span spans[] = {{.count = LAYERS * ROW * ROW},
                                    {.first = (LAYERS - SEEN) * ROW * ROW, .count = SEEN * ROW * ROW}};
    for (int large = 0; large < 2; large++) {
        const iso_view view = test_plain_view(100, 100, true, large ? 12 : 3);
        iso_gbuffer pictures[2];
        for (int k = 0; k < 2; k++) {
            const iso_point_view points = {.surfels = surfels,
                                           .spans = &spans[k],
                                           .span_count = 1,
                                           .transform = iso_transform_identity(),
                                           .radius = 0.70710678};
            const walled w = {&points, 23.2f, false};
            pictures[k] = draw_behind_wall(&w, &view, NULL);
        }
        for (int i = 0; i < 100 * 100; i++) {
            if (i % 100 % 50 < 12) continue; /* beside the wall all layers are averaged */
            if (pictures[0].depth[i] != pictures[1].depth[i])
                fail_msg("%g instead of %g at %d", (double)pictures[0].depth[i], (double)pictures[1].depth[i],
                         i);
        }
        for (int k = 0; k < 2; k++) iso_gbuffer_free(&pictures[k]);
    }
}

/* Points behind a wall are not drawn, and hardly looked at. */
static void counts_tell_what_is_hidden(void **state) {
    (void)state;
    test_scene s = test_scene_make("head", 100, NULL, true);
    const iso_view view = test_look_at(&s, 1, 1, false, 200, 200);
    iso_selection_counts counts[2];
    for (int k = 0; k < 2; k++) {
        iso_error error = {0};
        iso_point_workspace *workspace;
        assert_int_equal(iso_point_workspace_create(&workspace, NULL), ISO_OK);
        iso_gbuffer g = test_clear_gbuffer(200, 200, false);
        for (int i = 0; i < 200 * 200 && k; i++) g.depth[i] = 0.5f;
        const iso_target target = {&view, &g, NULL, 0, NULL};
        test_ok(iso_draw_point_surface(&target, &s.points, &(iso_point_surface_opts){.workspace = workspace},
                                       &error),
                &error);
        counts[k] = iso_point_workspace_counts(workspace);
        assert_int_equal(counts[k].points, iso_point_view_count(&s.points));
        assert_true(counts[k].drawn <= counts[k].tested);
        iso_gbuffer_free(&g);
        iso_point_workspace_destroy(workspace);
    }
    assert_true(counts[0].drawn > counts[0].points / 10);
    assert_true(counts[0].tested < 3 * (double)counts[0].points);
    assert_int_equal(counts[1].tested, 0);
    test_scene_free(&s);
}

/* ---- instances */

enum { WIDTH = 120, HEIGHT = 90 };

static iso_gbuffer draw_forest(iso_instance_drawing *drawing, const test_forest *f, const iso_view *view,
                               bool hidden, iso_instance_counts *counts) {
    iso_error error = {0};
    iso_instances all = f->all;
    all.draw_hidden = hidden;
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, NULL, 0, NULL};
    test_ok(iso_draw_instances(drawing, &target, &all, counts, &error), &error);
    assert_int_equal(counts->drawn + counts->outside + counts->hidden, all.count);
    return g;
}

static void hidden_instances_are_not_missed(void **state) {
    (void)state;
    test_forest *f = test_forest_make(TEST_FOREST_MOST);
    size_t hidden = 0, drawn = 0;
    for (int frame = 0; frame < 60; frame += 3) {
        const iso_view view = test_forest_view(f, frame, WIDTH, HEIGHT);
        static const iso_reconstruction by[] = {ISO_RECONSTRUCTION_CURVED, ISO_RECONSTRUCTION_FLAT,
                                                ISO_RECONSTRUCTION_EWA, ISO_RECONSTRUCTION_ONEPASS,
                                                ISO_RECONSTRUCTION_MEAN};
        f->all.reconstruction = by[frame / 3 % 5];
        f->all.lod_pixels = frame % 2 * (1 + frame % 5); /* up to discs of many pixels */
        iso_instance_drawing drawing = {0};
        iso_instance_counts few, all;
        iso_gbuffer a = draw_forest(&drawing, f, &view, false, &few),
                    b = draw_forest(&drawing, f, &view, true, &all);
        test_same_rows(&a, 0, &b);
        assert_int_equal(all.hidden, 0);
        assert_int_equal(all.outside, few.outside);
        hidden += few.hidden;
        drawn += few.drawn;
        for (int y = 0; y < HEIGHT; y += 31) {
            const iso_view rows = iso_view_rows(&view, y, HEIGHT - y < 31 ? HEIGHT - y : 31);
            iso_gbuffer strip = draw_forest(&drawing, f, &rows, false, &few);
            test_same_rows(&a, y, &strip);
            iso_gbuffer_free(&strip);
        }
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        iso_instance_drawing_free(&drawing);
    }
    if (2 * hidden < drawn) fail_msg("%zu hidden, %zu drawn", hidden, drawn);
    test_forest_free(f);
}

/* Filtered discs are hit before their points, and what is averaged with a front may lie before it. */
static void discs_reach_before_their_points(void **state) {
    (void)state;
    static const iso_reconstruction by[] = {ISO_RECONSTRUCTION_CURVED, ISO_RECONSTRUCTION_FLAT,
                                            ISO_RECONSTRUCTION_EWA, ISO_RECONSTRUCTION_ONEPASS,
                                            ISO_RECONSTRUCTION_MEAN};
    static test_wall wall;
    size_t hidden = 0;
    for (int k = 0; k < 5 * 20; k++) {
        const iso_view view = test_wall_view(40, 40, k % 2);
        iso_instance_drawing drawing = {0};
        iso_instance_counts few, all;
        test_wall_make(&wall, 0.01 + 0.2 * (k / 10));
        test_forest f = {.all = wall.all};
        f.all.reconstruction = by[k / 2 % 5];
        iso_gbuffer a = draw_forest(&drawing, &f, &view, false, &few),
                    b = draw_forest(&drawing, &f, &view, true, &all);
        test_same_rows(&a, 0, &b);
        hidden += few.hidden;
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        iso_instance_drawing_free(&drawing);
    }
    assert_true(hidden > 20);
}

/* Makes the points of a set others: every picture after it is one of the new points. */
static void edit_points(test_forest *f, int frame) {
    iso_point *points = (iso_point *)f->scenes[frame % TEST_FOREST_SETS].points.packed;
    const iso_point_view *view = &f->scenes[frame % TEST_FOREST_SETS].points;
    for (size_t s = (size_t)frame % 7; s < view->span_count; s += 7)
        for (size_t i = view->spans[s].first; i < view->spans[s].first + view->spans[s].count; i++) {
            iso_surfel p = iso_point_unpack(points[i]);
            p.position[frame % 3] += frame % 2 ? 0.4f : -0.4f;
            points[i] = iso_point_pack(&p);
        }
    test_forest_make_lods(f);
}

/* No picture depends on those drawn before: in a walk with jumps by 180 degrees and edits every frame is the
 * same as one drawn by itself. */
static void pictures_do_not_depend_on_earlier_ones(void **state) {
    (void)state;
    test_forest *f = test_forest_make(60);
    iso_instance_drawing drawing = {0};
    f->all.lod_pixels = 1;
    for (int frame = 0; frame < 200; frame++) {
        if (frame % 9 == 8) {
            for (int s = 0; s < TEST_FOREST_SETS;
                 s++) /* boxes that points leave are told nothing of the edit */
                f->scenes[s].points.bounds = NULL;
            edit_points(f, frame);
        }
        const iso_view view = test_forest_view(f, frame, WIDTH, HEIGHT);
        iso_instance_drawing fresh = {0};
        iso_instance_counts counts;
        iso_gbuffer a = draw_forest(&drawing, f, &view, false, &counts),
                    b = draw_forest(&fresh, f, &view, frame % 2, &counts);
        test_same_rows(&a, 0, &b);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
        iso_instance_drawing_free(&fresh);
    }
    iso_instance_drawing_free(&drawing);
    test_forest_free(f);
}

/* Instances around the eye and behind it, and none at all. */
static void eye_among_instances(void **state) {
    (void)state;
    test_forest *f = test_forest_make(40);
    iso_instance_drawing drawing = {0};
    iso_instance_counts few, all;
    for (int i = 0; i < 40; i += 5) {
        const iso_transform *t = &f->instances[i].transform;
        iso_camera camera = {.view_up = {0, 0, 1}, .view_angle = 100};
        camera.position = iso_vec3_make(t->origin[0], t->origin[1], 0.4 * test_forest_side(f));
        camera.focal_point =
            iso_vec3_make(t->origin[0] + 1, t->origin[1] + i - 20, 0.4 * test_forest_side(f));
        const iso_view view = iso_view_make(&camera, WIDTH, HEIGHT);
        iso_gbuffer a = draw_forest(&drawing, f, &view, false, &few),
                    b = draw_forest(&drawing, f, &view, true, &all);
        test_same_rows(&a, 0, &b);
        assert_true(few.outside > 0);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
    }
    f->all.count = 0;
    const iso_view view = test_forest_view(f, 0, WIDTH, HEIGHT);
    iso_gbuffer none = draw_forest(&drawing, f, &view, false, &few);
    for (int i = 0; i < WIDTH * HEIGHT; i++) assert_int_equal(none.surface[i], ISO_SURFACE_NONE);
    iso_gbuffer_free(&none);
    iso_instance_drawing_free(&drawing);
    test_forest_free(f);
}

/* ---- one instance */

/* A picture of a set as one instance. */
static iso_gbuffer draw_one(const iso_view *view, const iso_point_view *points, const iso_transform *place,
                            const iso_rgb *color) {
    const iso_lod lod = {.points = *points, .count = 1};
    const iso_instanced set = {&lod, iso_point_view_bounds(points), points->radii ? 4 : points->radius};
    const iso_instance instance = {0, *place};
    const iso_instances all = {
        .sets = &set, .instances = &instance, .set_count = 1, .count = 1, .colors = color};
    iso_instance_drawing drawing = {0};
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, NULL, 0, NULL};
    test_ok(iso_draw_instances(&drawing, &target, &all, NULL, &error), &error);
    iso_instance_drawing_free(&drawing);
    return g;
}

/* An instance where the set is has the bytes of the set, with curvatures and without. */
static void an_instance_in_place_is_the_set(void **state) {
    (void)state;
    for (int curved = 0; curved < 2; curved++) {
        const iso_points_opts opts = {.curvature = curved, .primitive = ISO_PRIMITIVE_EDGE};
        test_scene s = test_scene_make("gyroid", 40, &opts, true);
        const iso_placement here = {.scale = 1};
        const iso_transform place = iso_placement_transform(&here, &s.points.transform);
        assert_memory_equal(&place, &s.points.transform, sizeof place);
        for (int zoom = 1; zoom <= 8; zoom *= 2) {
            const iso_view view = test_look_at(&s, zoom, zoom, zoom == 4, 150, 140);
            iso_gbuffer plain = test_drawn(&view, &s.points, &(iso_point_surface_opts){0}, NULL),
                        placed = draw_one(&view, &s.points, &place, NULL);
            test_same_rows(&plain, 0, &placed);
            iso_gbuffer_free(&plain);
            iso_gbuffer_free(&placed);
        }
        test_scene_free(&s);
    }
}

/* The discs of coarse levels of detail reach far beyond the box of their points: strips of the picture beside
 * the box have them, too. */
static void coarse_discs_reach_beyond_boxes(void **state) {
    (void)state;
    test_scene s = test_scene_make("cube", 24, NULL, true);
    s.points.curvatures = NULL;
    iso_lod lod = {.count = 0};
    assert_int_equal(iso_lod_update(&lod, &s.points, NULL, NULL), ISO_OK);
    const iso_instanced set = {&lod, iso_point_view_bounds(&s.points), s.points.radius};
    const iso_instance instance = {0, s.points.transform};
    test_forest f = {.all = {.sets = &set, .instances = &instance, .set_count = 1, .count = 1}};
    iso_instance_drawing drawing = {0};
    iso_instance_counts counts;
    for (int pixels = 0; pixels <= 24; pixels += 6) {
        const iso_view view = test_look_at(&s, 2, 0.4, pixels % 12 == 6, WIDTH, HEIGHT);
        f.all.lod_pixels = pixels;
        iso_gbuffer whole = draw_forest(&drawing, &f, &view, false, &counts);
        size_t strips = 0;
        for (int y = 0; y < HEIGHT; y++) {
            const iso_view row = iso_view_rows(&view, y, 1);
            iso_gbuffer strip = draw_forest(&drawing, &f, &row, false, &counts);
            test_same_rows(&whole, y, &strip);
            strips += counts.drawn;
            iso_gbuffer_free(&strip);
        }
        assert_true(strips > 10 && strips < HEIGHT);
        iso_gbuffer_free(&whole);
    }
    iso_instance_drawing_free(&drawing);
    iso_lod_free(&lod);
    test_scene_free(&s);
}

/* Radii of the points' own grow with an instance: of another size, it is the set with other spacings and
 * radii. */
static void radii_grow_with_instances(void **state) {
    (void)state;
    test_scene s = test_scene_make("head", 30, NULL, true);
    const size_t count = iso_point_view_count(&s.points);
    float *radii = malloc(2 * count * sizeof *radii);
    uint32_t seed = 5;
    assert_non_null(radii);
    s.points.curvatures = NULL;
    for (size_t i = 0; i < count; i++) {
        radii[i] = (float)(s.points.radius * (0.5 + uniform(&seed)));
        radii[count + i] = 0.75f * radii[i];
    }
    const iso_placement small = {.scale = 0.75, .position = {3, -2, 1}, .rotation = {0.1, 0.2, 0.3, 0.9}};
    iso_point_view scaled = s.points;
    scaled.transform = iso_placement_transform(&small, &s.points.transform);
    scaled.radii = radii + count;
    s.points.radii = radii;
    for (int zoom = 1; zoom <= 8; zoom *= 2) {
        const iso_view view = test_look_at(&s, zoom, zoom, zoom == 4, 150, 140);
        iso_gbuffer copied = test_drawn(&view, &scaled, &(iso_point_surface_opts){0}, NULL),
                    placed = draw_one(&view, &s.points, &scaled.transform, NULL);
        test_same_rows(&copied, 0, &placed);
        iso_gbuffer_free(&copied);
        iso_gbuffer_free(&placed);
    }
    test_scene_free(&s);
    free(radii);
}

/* The colour of an instance takes the place of the surface's in all of its samples, and nothing else
 * changes. */
static void instances_have_colors(void **state) {
    (void)state;
    const iso_points_opts opts = {.curvature = true, .primitive = ISO_PRIMITIVE_EDGE};
    test_scene s = test_scene_make("head", 40, &opts, true);
    const iso_rgb red = {200, 30, 7};
    for (int zoom = 1; zoom <= 16; zoom *= 4) {
        const iso_view view = test_look_at(&s, 1, zoom, false, 150, 140);
        iso_gbuffer plain = draw_one(&view, &s.points, &s.points.transform, NULL),
                    placed = draw_one(&view, &s.points, &s.points.transform, &red);
        assert_null(plain.color);
        assert_non_null(placed.color);
        for (int i = 0; i < 150 * 140; i++) {
            assert_true(plain.depth[i] == placed.depth[i] && plain.surface[i] == placed.surface[i]);
            if (placed.surface[i] == 0) assert_int_equal(placed.color[i], 0x01071EC8);
        }
        iso_gbuffer_free(&plain);
        iso_gbuffer_free(&placed);
    }
    test_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pyramid_hides_what_is_hidden),
        cmocka_unit_test(earlier_surfaces_hide_points),
        cmocka_unit_test(layers_behind_a_wall_are_left_out),
        cmocka_unit_test(counts_tell_what_is_hidden),
        cmocka_unit_test(hidden_instances_are_not_missed),
        cmocka_unit_test(discs_reach_before_their_points),
        cmocka_unit_test(pictures_do_not_depend_on_earlier_ones),
        cmocka_unit_test(eye_among_instances),
        cmocka_unit_test(an_instance_in_place_is_the_set),
        cmocka_unit_test(coarse_discs_reach_beyond_boxes),
        cmocka_unit_test(radii_grow_with_instances),
        cmocka_unit_test(instances_have_colors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
