/* triangles: normals of meshes from files: smooth on curved surfaces, sharp at edges, whether a file shares
 * vertices or repeats them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "check_support.h"
#include "io/mesh/mesh_read.h"
#include "render/raster/raster.h"
#include "render/raster/triangles.h"
#include "scene_support.h"

/* A ball of rings and sectors around (3, -2, 5); the poles have triangles without an area. */
enum { RINGS = 40, SECTORS = 80 };
static const double RADIUS = 7, CENTRE[3] = {3, -2, 5};

static iso_triangles make_ball(void) {
    iso_triangles ball = {.vertices = iso_alloc((RINGS + 1) * SECTORS * sizeof *ball.vertices),
                          .triangles = iso_alloc((size_t)2 * RINGS * SECTORS * sizeof *ball.triangles)};
    for (int ring = 0; ring <= RINGS; ring++)
        for (int sector = 0; sector < SECTORS; sector++) {
            const double down = M_PI * ring / RINGS, around = 2 * M_PI * sector / SECTORS;
            const double r = ring % RINGS ? sin(down) : 0; /* the same pole for every sector */
            const double unit[3] = {r * cos(around), r * sin(around), cos(down)};
            for (int k = 0; k < 3; k++)
                ball.vertices[ball.vertex_count][k] = (float)(CENTRE[k] + RADIUS * unit[k]);
            ball.vertex_count++;
        }
    for (int ring = 0; ring < RINGS; ring++)
        for (int sector = 0; sector < SECTORS; sector++) {
            const uint32_t a = (uint32_t)(ring * SECTORS + sector),
                           b = (uint32_t)(ring * SECTORS + (sector + 1) % SECTORS);
            const uint32_t corners[2][3] = {{a, a + SECTORS, b}, {b, a + SECTORS, b + SECTORS}};
            for (int t = 0; t < 2; t++)
                memcpy(ball.triangles[ball.triangle_count++], corners[t], sizeof corners[t]);
        }
    return ball;
}

/* The same mesh with vertices of their own for each triangle. */
static iso_triangles repeat_vertices(const iso_triangles *mesh) {
    iso_triangles soup = {.vertices = iso_alloc(3 * mesh->triangle_count * sizeof *soup.vertices),
                          .triangles = iso_alloc(mesh->triangle_count * sizeof *soup.triangles),
                          .vertex_count = 3 * mesh->triangle_count,
                          .triangle_count = mesh->triangle_count};
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (size_t k = 0; k < 3; k++) {
            memcpy(soup.vertices[3 * t + k], mesh->vertices[mesh->triangles[t][k]], 3 * sizeof(float));
            soup.triangles[t][k] = (uint32_t)(3 * t + k);
        }
    return soup;
}

static iso_triangle_spans make_spans(const iso_triangles *mesh) {
    iso_triangle_spans spans = {.span_count = 0};
    iso_error error = {0};
    test_ok(iso_triangle_spans_make(mesh, &spans, &error), &error);
    return spans;
}

static void curved_surfaces_are_smooth(void **state) {
    (void)state;
    iso_triangles ball = make_ball();
    iso_triangle_spans spans = make_spans(&ball);
    const iso_mesh_view view = iso_triangle_spans_view(&spans);
    assert_int_equal(iso_mesh_view_triangle_count(&view), 2 * (RINGS - 1) * SECTORS); /* none without area */
    double least = 1;
    for (size_t s = 0; s < view.span_count; s++)
        for (uint32_t i = 0; i < view.spans[s].vertex_count; i++) {
            const iso_surfel *v = &view.vertices[view.spans[s].first_vertex + i];
            double dot = 0;
            for (int k = 0; k < 3; k++)
                dot += (double)v->normal[k] * ((double)v->position[k] - CENTRE[k]) / RADIUS;
            least = fmin(least, dot);
        }
    assert_true(least > cos(1.5 * M_PI / 180));
    iso_triangle_spans_free(&spans);
    iso_triangles_free(&ball);
}

static void repeated_vertices_change_nothing(void **state) {
    (void)state;
    iso_triangles ball = make_ball(), soup = repeat_vertices(&ball);
    iso_triangle_spans a = make_spans(&ball), b = make_spans(&soup);
    assert_int_equal(a.span_count, b.span_count);
    const iso_mesh_view view = iso_triangle_spans_view(&a);
    assert_memory_equal(a.vertices, b.vertices, 3 * iso_mesh_view_triangle_count(&view) * sizeof *a.vertices);
    iso_triangle_spans_free(&a);
    iso_triangle_spans_free(&b);
    iso_triangles_free(&ball);
    iso_triangles_free(&soup);
}

/* The corners of a cube have the normals of their faces. */
static void edges_stay_sharp(void **state) {
    (void)state;
    iso_triangles cube = {.vertices = iso_alloc(8 * sizeof *cube.vertices),
                          .triangles = iso_alloc(12 * sizeof *cube.triangles),
                          .vertex_count = 8};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) cube.vertices[i][k] = (float)(i >> k & 1);
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, at = side << axis;
            const int quad[4] = {at, at + u, at + u + v, at + v};
            for (int t = 0; t < 2; t++) {
                const int corners[3] = {quad[0], quad[t + 1], quad[t + 2]};
                for (int k = 0; k < 3; k++)
                    cube.triangles[cube.triangle_count][k] = (uint32_t)corners[side ? k : 2 - k];
                cube.triangle_count++;
            }
        }
    iso_triangle_spans spans = make_spans(&cube);
    for (int t = 0; t < 12; t++) /* four triangles an axis, two on each side */
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++) {
                const float wanted = axis == t / 4 ? (t / 2 % 2 ? 1.0f : -1.0f) : 0.0f;
                assert_true(spans.vertices[3 * t + k].normal[axis] == wanted);
            }
    iso_triangle_spans_free(&spans);
    iso_triangles_free(&cube);
}

/* Every sample shows the triangle of the file that is nearest when it is drawn alone, also where triangles
 * were left out and where the near plane cuts them. */
static void elements_are_triangles_of_the_file(void **state) {
    (void)state;
    iso_triangles ball = make_ball();
    iso_triangle_spans spans = make_spans(&ball);
    assert_non_null(spans.numbers);
    for (int cut = 0; cut < 2; cut++) {
        iso_view view = test_plain_view(40, 40, false, 60);
        view.eye = iso_vec3_make(CENTRE[0] + 1, CENTRE[1], CENTRE[2] - 20);
        view.near = cut ? 16 : 1;
        iso_gbuffer all = test_clear_gbuffer(40, 40, false), one = test_clear_gbuffer(40, 40, false);
        assert_int_equal(iso_gbuffer_add_elements(&all, NULL), ISO_OK);
        const iso_target target = {.view = &view, .gbuffer = &all};
        const iso_mesh_view mesh = iso_triangle_spans_view(&spans);
        assert_int_equal(iso_draw_mesh(&target, &mesh, NULL), ISO_OK);
        uint32_t wanted[40 * 40] = {0};
        for (size_t t = 0; t < ball.triangle_count; t++) {
            iso_triangles single = {ball.vertices, ball.triangles + t, ball.vertex_count, 1, NULL};
            iso_triangle_spans alone = make_spans(&single);
            const iso_target apart = {.view = &view, .gbuffer = &one};
            const iso_mesh_view triangle = iso_triangle_spans_view(&alone);
            iso_gbuffer_clear(&one);
            assert_int_equal(iso_draw_mesh(&apart, &triangle, NULL), ISO_OK);
            for (int i = 0; i < 40 * 40; i++)
                if (isfinite(one.depth[i]) && one.depth[i] <= all.depth[i] && !wanted[i])
                    wanted[i] = (uint32_t)t + 1;
            iso_triangle_spans_free(&alone);
        }
        size_t covered = 0;
        for (int i = 0; i < 40 * 40; i++) {
            covered += all.surface[i] != ISO_SURFACE_NONE;
            assert_int_equal(all.element[i] ? spans.numbers[all.element[i] - 1] + 1 : 0, wanted[i]);
        }
        assert_true(covered > 500);
        iso_gbuffer_free(&all);
        iso_gbuffer_free(&one);
    }
    iso_triangle_spans_free(&spans);
    iso_triangles_free(&ball);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curved_surfaces_are_smooth),
        cmocka_unit_test(repeated_vertices_change_nothing),
        cmocka_unit_test(edges_stay_sharp),
        cmocka_unit_test(elements_are_triangles_of_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
