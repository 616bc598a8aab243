/* Points, triangles and ribbons in one pyramid, against each of them drawn alone and the nearer one kept:
 * outlines of triangles are the same to the sample; a line of one pixel over a wall is not lost in it, and
 * behind it not seen; points lose little around what is before them; hybrid surfaces beside other triangles;
 * colours and surface numbers; and the same bytes for every instruction set, number of threads and strip. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "check_support.h"
#include "lines_support.h"
#include "render/pullpush/hybrid.h"
#include "render/pullpush/sets.h"
#include "render/raster/raster.h"
#include "scene_support.h"

enum { POINTS = 1, MESH = 2, RIBBONS = 5 };

static test_lines scene_lines;

static iso_gbuffer draw_sets(const iso_view *view, const iso_pyramid_set *sets, size_t count,
                             iso_pool *pool) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, true);
    const iso_target target = {view, &g, pool, 77, NULL};
    test_ok(iso_draw_pyramid_sets(&target, sets, count, NULL, &error), &error);
    return g;
}

/* Each set alone, into one gbuffer. */
static iso_gbuffer draw_alone(const iso_view *view, const iso_pyramid_set *sets, size_t count) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, true);
    for (size_t i = 0; i < count; i++) {
        const iso_target target = {view, &g, NULL, sets[i].surface, NULL};
        const iso_pullpush_opts gaussian = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN};
        /* points and lines in a pyramid of their own with the rules of one pyramid: iso_draw_pullpush fills
         * gaps and ends discs at the grid's border, and iso_draw_pyramid_lines averages no fragments */
        if (sets[i].mesh)
            test_ok(iso_draw_mesh(&target, sets[i].mesh, &error), &error);
        else
            test_ok(iso_draw_pyramid_sets(&target, &sets[i], 1, &gaussian, &error), &error);
    }
    return g;
}

/* ---- triangles over points */

/* A triangle in world coordinates. */
typedef struct one_triangle {
    iso_surfel corners[3];
    uint16_t triangles[1][3];
    iso_mesh_span span;
    iso_mesh_view view;
} one_triangle;

static void set_triangle(one_triangle *t, const iso_vec3 corners[3]) {
    const iso_vec3 normal = iso_vec3_unit(
        iso_vec3_cross(iso_vec3_sub(corners[1], corners[0]), iso_vec3_sub(corners[2], corners[0])));
    *t = (one_triangle){.triangles = {{0, 1, 2}},
                        .span = {.vertex_count = 3, .owned_count = 3, .triangle_count = 1}};
    for (int i = 0; i < 3; i++) {
        const double at[3] = {corners[i].x, corners[i].y, corners[i].z},
                     n[3] = {normal.x, normal.y, normal.z};
        for (int k = 0; k < 3; k++) {
            t->corners[i].position[k] = (float)at[k];
            t->corners[i].normal[k] = (float)n[k];
        }
    }
    t->view = (iso_mesh_view){.vertices = t->corners,
                              .triangles = (const uint16_t(*)[3])t->triangles,
                              .spans = &t->span,
                              .span_count = 1,
                              .transform = iso_transform_identity()};
}

/* A triangle through the middle of the scene, in a plane that turns with `turn`. */
static void cut_scene(const test_surfaces *b, int turn, one_triangle *t) {
    const iso_box box = test_scene_box(&b->scene);
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5),
                   half = iso_vec3_scale(iso_vec3_sub(box.hi, box.lo), 0.5);
    iso_vec3 corners[3];
    for (int i = 0; i < 3; i++) {
        double sine, cosine, tilt, rest;
        iso_sincos(turn + i * 2 * ISO_PI / 3, &sine, &cosine);
        iso_sincos(0.7 * turn, &tilt, &rest);
        corners[i] = iso_vec3_add(middle, iso_vec3_make(1.3 * half.x * cosine, 1.3 * half.y * sine * rest,
                                                        1.3 * half.z * sine * tilt));
    }
    set_triangle(t, corners);
}

typedef struct difference {
    size_t wanted, other; /* samples that show anything; another surface, or nothing */
    size_t grown;         /* samples with triangles where alone there are none */
    size_t lost;          /* nothing, where alone there is something */
} difference;

static difference compare(const iso_gbuffer *g, const iso_gbuffer *alone, const iso_gbuffer *mesh) {
    difference d = {0};
    for (size_t i = 0; i < (size_t)g->width * (size_t)g->height; i++) {
        d.wanted += alone->surface[i] != ISO_SURFACE_NONE;
        d.other += alone->surface[i] != g->surface[i];
        d.lost += alone->surface[i] != ISO_SURFACE_NONE && g->surface[i] == ISO_SURFACE_NONE;
        if (g->surface[i] != MESH) continue;
        if (mesh->surface[i] != MESH) {
            d.grown++;
            continue;
        }
        assert_true(g->depth[i] == mesh->depth[i]);
        const double dot = iso_vec3_dot(iso_gbuffer_normal(g, i), iso_gbuffer_normal(mesh, i));
        assert_true(fabs(dot) > 1 - 1e-4); /* keys have normals in 22 bits */
    }
    return d;
}

/* Outlines of triangles do not grow; where a surface of points is behind or before them, samples differ near
 * outlines only. */
static void triangles_do_not_grow(void **state) {
    (void)state;
    const char *const names[] = {"sphere", "torus", "gyroid"};
    size_t wanted = 0, other = 0, lost = 0;
    for (int i = 0; i < 3; i++) {
        test_surfaces b = test_surfaces_make(names[i], 56, false);
        for (int turn = 0; turn < 6; turn++) {
            const iso_view view = test_look_at(&b.scene, turn, turn % 3 ? 1 : 2.5, turn & 1, 300, 260);
            one_triangle t;
            cut_scene(&b, turn, &t);
            const iso_pyramid_set sets[] = {{.surface = POINTS, .points = &b.scene.points},
                                            {.surface = MESH, .mesh = &t.view}};
            iso_gbuffer g = draw_sets(&view, sets, 2, NULL), alone = draw_alone(&view, sets, 2),
                        mesh = draw_alone(&view, sets + 1, 1);
            const difference d = compare(&g, &alone, &mesh);
            print_message("%s, side %d: %zu samples, %zu with another surface, %zu lost\n", names[i], turn,
                          d.wanted, d.other, d.lost);
            assert_int_equal(d.grown, 0);
            assert_true(d.wanted > 5000 && d.other * 100 < d.wanted && d.lost * 500 < d.wanted);
            wanted += d.wanted;
            other += d.other;
            lost += d.lost;
            iso_gbuffer_free(&g);
            iso_gbuffer_free(&alone);
            iso_gbuffer_free(&mesh);
        }
        test_surfaces_free(&b);
    }
    print_message("in one pyramid %.2f %% of the samples show another surface, %.3f %% nothing\n",
                  100.0 * (double)other / (double)wanted, 100.0 * (double)lost / (double)wanted);
}

/* Triangles some tenths of a voxel behind a surface of few points, nearer than the points' depth intervals
 * are long, do not show between the points. */
static void triangles_behind_points(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("sphere", 32, false);
    const iso_box box = test_scene_box(&b.scene);
    const double middle[3] = {0.5 * (box.lo.x + box.hi.x), 0.5 * (box.lo.y + box.hi.y),
                              0.5 * (box.lo.z + box.hi.z)};
    iso_mesh_view inner = b.mesh;
    for (int k = 0; k < 3; k++) {
        inner.transform.spacing[k] *= 0.97;
        inner.transform.origin[k] = middle[k] - 0.97 * (middle[k] - inner.transform.origin[k]);
    }
    size_t through = 0, wanted = 0;
    for (int side = 0; side < 6; side++) {
        const iso_view view = test_look_at(&b.scene, side, 1, side & 1, 400, 400);
        const iso_pyramid_set sets[] = {{.surface = POINTS, .points = &b.scene.points},
                                        {.surface = MESH, .mesh = &inner}};
        iso_gbuffer g = draw_sets(&view, sets, 2, NULL), alone = draw_alone(&view, sets, 1);
        for (size_t i = 0; i < 400 * 400; i++) {
            wanted += alone.surface[i] == POINTS;
            through += alone.surface[i] == POINTS && g.surface[i] == MESH;
        }
        iso_gbuffer_free(&g);
        iso_gbuffer_free(&alone);
    }
    print_message("%zu of %zu samples show triangles behind the points\n", through, wanted);
    assert_true(wanted > 100000 && through * 500 < wanted);
    test_surfaces_free(&b);
}

/* Triangles alone are as iso_draw_mesh draws them, to the sample. */
static void triangles_alone(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("torus", 48, false);
    for (int parallel = 0; parallel < 2; parallel++) {
        const iso_view view = test_look_at(&b.scene, 3, 1.5, parallel, 200, 150);
        const iso_pyramid_set set = {.surface = MESH, .mesh = &b.mesh};
        iso_gbuffer g = draw_sets(&view, &set, 1, NULL), mesh = draw_alone(&view, &set, 1);
        assert_memory_equal(g.depth, mesh.depth, 200 * 150 * sizeof(float));
        assert_memory_equal(g.surface, mesh.surface, 200 * 150);
        iso_gbuffer_free(&g);
        iso_gbuffer_free(&mesh);
    }
    test_surfaces_free(&b);
}

/* ---- thin lines and walls */

static iso_pyramid_lines *make_ribbons(double radius) {
    iso_error error = {0};
    const iso_shapes_opts opts = {.radius = radius, .min_pixels = 1, .style = ISO_LINE_RIBBON};
    iso_pyramid_lines *lines;
    scene_lines.lines.radii = NULL;
    test_ok(iso_pyramid_lines_create(&scene_lines.lines, &opts, &lines, &error), &error);
    return lines;
}

/* A line of one pixel along a slanted wall of triangles, half a pixel before or behind it: before it, it is
 * seen along its whole length; behind it, nowhere. */
static void thin_lines_over_walls(void **state) {
    (void)state;
    iso_error error = {0};
    for (int slant = 0; slant < 4; slant++)
        for (int behind = 0; behind < 2; behind++) {
            const iso_view view =
                test_plain_view(256, 256, slant & 1, slant & 1 ? 256.0 / 24 : 256 * 100 / 24.0);
            const double rise = slant, step = behind ? 0.3 : -0.3;
            const iso_vec3 corners[3] = {
                {-30, -30, 100 - 30 * rise}, {60, -30, 100 + 60 * rise}, {-30, 60, 100 - 30 * rise}};
            one_triangle wall;
            set_triangle(&wall, corners);
            test_lines_start(&scene_lines, 0, 0, 0);
            for (int i = 0; i < 3; i++)
                for (int end = -1; end <= 1; end += 2) {
                    const double x = 8 * end, y = 4.3 * (i - 1) + 3 * end;
                    test_lines_add(&scene_lines, x, y, 100 + x * rise + step * sqrt(1 + rise * rise), 1);
                    if (end > 0) test_lines_end(&scene_lines);
                }
            test_ok(iso_lines_add_normals(&scene_lines.lines, &error), &error);
            for (size_t i = 0; i < scene_lines.lines.vertex_count; i++)
                for (int k = 0; k < 3; k++) scene_lines.lines.normals[i][k] = wall.corners[0].normal[k];
            iso_pyramid_lines *lines = make_ribbons(1e-3);
            const iso_pyramid_set sets[] = {{.surface = MESH, .mesh = &wall.view},
                                            {.surface = RIBBONS, .ribbons = lines}};
            iso_gbuffer g = draw_sets(&view, sets, 2, NULL), alone = draw_alone(&view, sets, 2);
            size_t seen = 0, wanted = 0;
            for (size_t i = 0; i < 256 * 256; i++) {
                seen += g.surface[i] == RIBBONS;
                wanted += alone.surface[i] == RIBBONS;
                assert_int_equal(g.surface[i] == ISO_SURFACE_NONE, alone.surface[i] == ISO_SURFACE_NONE);
            }
            print_message("rise %g, %s: %zu samples of the lines, alone %zu\n", rise,
                          behind ? "behind" : "before", seen, wanted);
            if (behind) assert_int_equal(seen, 0);
            if (!behind) assert_true(wanted > 300 && seen * 20 >= wanted * 19 && seen <= wanted * 21 / 20);
            iso_gbuffer_free(&g);
            iso_gbuffer_free(&alone);
            iso_pyramid_lines_destroy(lines);
            iso_free(scene_lines.lines.normals);
            scene_lines.lines.normals = NULL;
        }
}

/* Great circles around a sphere of points, `above` mm outside of it. */
static void add_circles(const test_surfaces *b, double above) {
    iso_error error = {0};
    const iso_box box = test_scene_box(&b->scene);
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    const double radius = 0.5 * (box.hi.x - box.lo.x) + above;
    test_lines_start(&scene_lines, middle.x, middle.y, middle.z);
    for (int circle = 0; circle < 3; circle++) {
        for (int i = 0; i <= 90; i++) {
            double at[3] = {0};
            iso_sincos(i * 2 * ISO_PI / 90, &at[circle], &at[(circle + 1) % 3]);
            test_lines_add(&scene_lines, radius * at[0], radius * at[1], radius * at[2], 1);
        }
        test_lines_end(&scene_lines);
    }
    test_ok(iso_lines_add_normals(&scene_lines.lines, &error), &error);
    for (size_t i = 0; i < scene_lines.lines.vertex_count; i++)
        for (int k = 0; k < 3; k++)
            scene_lines.lines.normals[i][k] = (float)((double)scene_lines.vertices[i][k] / radius);
}

/* Lines of one pixel half a voxel outside a surface of points are seen along their whole length, though its
 * points have depth intervals of more than a voxel; half a voxel inside they are not seen. */
static void thin_lines_over_points(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("sphere", 56, false);
    const double voxel = b.scene.points.transform.spacing[0];
    for (int inside = 0; inside < 2; inside++) {
        size_t seen = 0, wanted = 0;
        add_circles(&b, inside ? -0.5 * voxel : 0.5 * voxel);
        iso_pyramid_lines *lines = make_ribbons(1e-3);
        const iso_pyramid_set sets[] = {{.surface = POINTS, .points = &b.scene.points},
                                        {.surface = RIBBONS, .ribbons = lines}};
        for (int side = 0; side < 6; side++) {
            const iso_view view = test_look_at(&b.scene, side, 1.2, side & 1, 320, 300);
            iso_gbuffer g = draw_sets(&view, sets, 2, NULL), alone = draw_alone(&view, sets, 2);
            for (size_t i = 0; i < 320 * 300; i++) {
                seen += g.surface[i] == RIBBONS;
                wanted += alone.surface[i] == RIBBONS;
            }
            iso_gbuffer_free(&g);
            iso_gbuffer_free(&alone);
        }
        print_message("%s: %zu samples of the lines, alone %zu\n", inside ? "inside" : "outside", seen,
                      wanted);
        if (inside) assert_true(seen <= wanted + 50);
        if (!inside) assert_true(wanted > 5000 && seen * 50 >= wanted * 49);
        iso_pyramid_lines_destroy(lines);
        iso_free(scene_lines.lines.normals);
        scene_lines.lines.normals = NULL;
    }
    test_surfaces_free(&b);
}

/* ---- everything together */

/* Random ribbons with colours in the scene's box. */
static iso_pyramid_lines *scatter_ribbons(const test_surfaces *b, double radius) {
    iso_error error = {0};
    const iso_box box = test_scene_box(&b->scene);
    const iso_vec3 size = iso_vec3_sub(box.hi, box.lo);
    uint32_t seed = 9;
    test_lines_start(&scene_lines, 0, 0, 0);
    for (int i = 0; i < 40; i++)
        for (int end = 0; end < 2; end++) {
            test_lines_add(&scene_lines, box.lo.x + size.x * (1.4 * uniform(&seed) - 0.2),
                           box.lo.y + size.y * (1.4 * uniform(&seed) - 0.2),
                           box.lo.z + size.z * (1.4 * uniform(&seed) - 0.2), radius);
            if (end) test_lines_end(&scene_lines);
        }
    for (size_t i = 0; i < scene_lines.lines.vertex_count; i++)
        for (int k = 0; k < 3; k++) scene_lines.colors[i][k] = (uint8_t)(40 + 60 * k);
    scene_lines.lines.colors = scene_lines.colors;
    test_ok(iso_lines_add_normals(&scene_lines.lines, &error), &error);
    return make_ribbons(radius);
}

static void free_ribbons(iso_pyramid_lines *lines) {
    iso_pyramid_lines_destroy(lines);
    iso_free(scene_lines.lines.normals);
    scene_lines.lines.normals = NULL;
    scene_lines.lines.colors = NULL;
}

/* Points, ribbons, triangles and a hybrid surface beside each other are nearly what they are alone; samples
 * of ribbons have the ribbons' colour, all others none. */
static void all_together(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("gyroid", 64, false), other = test_surfaces_make("torus", 64, false);
    const iso_box box = test_scene_box(&b.scene);
    iso_pyramid_lines *lines = scatter_ribbons(&b, 0.02 * (box.hi.x - box.lo.x));
    for (int hybrid = 0; hybrid < 2; hybrid++)
        for (int side = 0; side < 6; side++) {
            const iso_view view = test_look_at(&b.scene, side, hybrid ? 3 : 1, side & 1, 320, 300);
            const iso_pyramid_set sets[] = {
                {.surface = POINTS, .points = &b.scene.points, .mesh = hybrid ? &b.mesh : NULL},
                {.surface = MESH, .mesh = &other.mesh},
                {.surface = RIBBONS, .ribbons = lines}};
            iso_gbuffer g = draw_sets(&view, sets, 3, NULL), alone = draw_alone(&view, sets, 3);
            size_t wanted = 0, differ = 0, lost = 0, ribbons = 0;
            for (size_t i = 0; i < 320 * 300; i++) {
                const uint8_t s = g.surface[i];
                wanted += alone.surface[i] != ISO_SURFACE_NONE;
                differ += alone.surface[i] != s;
                lost += alone.surface[i] != ISO_SURFACE_NONE && s == ISO_SURFACE_NONE;
                ribbons += s == RIBBONS;
                if (s == RIBBONS)
                    assert_true(g.color[i] == (uint32_t)(40 | 100 << 8 | 160 << 16 | (RIBBONS + 1) << 24));
                if (s != RIBBONS) assert_true(g.color[i] >> 24 == 0);
            }
            print_message("%s, side %d: %zu samples, %.2f %% of another surface, %.3f %% lost\n",
                          hybrid ? "hybrid" : "points", side, wanted, 100.0 * (double)differ / (double)wanted,
                          100.0 * (double)lost / (double)wanted);
            assert_true(wanted > 20000 && ribbons > 500 && differ * 50 < wanted && lost * 200 < wanted);
            iso_gbuffer_free(&g);
            iso_gbuffer_free(&alone);
        }
    free_ribbons(lines);
    test_surfaces_free(&b);
    test_surfaces_free(&other);
}

/* The sets of a picture. */
typedef struct drawing {
    const iso_pyramid_set *sets;
    size_t count;
} drawing;

static iso_gbuffer draw_again(const void *context, const iso_view *view, iso_pool *pool) {
    const drawing *d = context;
    return draw_sets(view, d->sets, d->count, pool);
}

static void bytes_are_the_same(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("gyroid", 64, false), other = test_surfaces_make("torus", 64, false);
    const iso_box box = test_scene_box(&b.scene);
    iso_pyramid_lines *lines = scatter_ribbons(&b, 0.02 * (box.hi.x - box.lo.x));
    const iso_pyramid_set sets[] = {{.surface = RIBBONS, .ribbons = lines},
                                    {.surface = POINTS, .points = &b.scene.points, .mesh = &b.mesh},
                                    {.surface = MESH, .mesh = &other.mesh}};
    const drawing d = {sets, 3};
    for (int parallel = 0; parallel < 2; parallel++) {
        const iso_view view = test_look_at(&b.scene, 4, 2, parallel, 210, 170);
        iso_gbuffer wanted = draw_again(&d, &view, NULL);
        test_variants_of(draw_again, &d, &view, &wanted);
        test_strips_of(draw_again, &d, &view, 7, &wanted);
        iso_gbuffer_free(&wanted);
    }
    free_ribbons(lines);
    test_surfaces_free(&b);
    test_surfaces_free(&other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_do_not_grow),  cmocka_unit_test(triangles_behind_points),
        cmocka_unit_test(triangles_alone),        cmocka_unit_test(thin_lines_over_walls),
        cmocka_unit_test(thin_lines_over_points), cmocka_unit_test(all_together),
        cmocka_unit_test(bytes_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
