/* Surfaces as points and triangles in one pyramid: vertices of the mesh are the edge points, bit for
 * bit; where bricks of both kinds meet there are no holes, and fewer places than with points alone where one
 * sees through the surface; with one kind only the picture is that of pull-push or of the mesh; and the same
 * bytes for every instruction set, number of threads and strip. */
#include <math.h>
#include <string.h>

#include "base/cpu.h"
#include "check_support.h"
#include "render/pullpush/hybrid.h"
#include "render/raster/raster.h"
#include "scene_support.h"

enum { SURFACE = 1 };

static iso_gbuffer hybrid(const test_surfaces *b, const iso_view *view, double pixels, iso_pool *pool) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, pool, SURFACE, NULL};
    const iso_hybrid_opts opts = {.pixels = pixels};
    test_ok(iso_draw_hybrid(&target, &b->scene.points, &b->mesh, &opts, &error), &error);
    return g;
}

static iso_gbuffer triangles(const test_surfaces *b, const iso_view *view) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, NULL, SURFACE, NULL};
    test_ok(iso_draw_mesh(&target, &b->mesh, &error), &error);
    return g;
}

/* The size of a cell in the middle of the scene, pixels. */
static double middle_cell(const test_surfaces *b, const iso_view *view) {
    const iso_box world = test_scene_box(&b->scene);
    const iso_vec3 middle = iso_vec3_make((world.lo.x + world.hi.x) / 2, (world.lo.y + world.hi.y) / 2,
                                          (world.lo.z + world.hi.z) / 2);
    const double *s = b->scene.points.transform.spacing;
    return fmax(s[0], fmax(s[1], s[2])) * view->focal / iso_view_point(view, middle).z;
}

static void vertices_are_points(void **state) {
    (void)state;
    const char *const names[] = {"sphere", "torus", "gyroid"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        test_surfaces b = test_surfaces_make(names[i], 48, true);
        size_t matched = 0;
        for (size_t m = 0; m < b.mesh.span_count; m++) {
            const iso_mesh_span *span = &b.mesh.spans[m];
            for (size_t p = 0; p < b.scene.points.span_count; p++) {
                const iso_point_span *other = &b.scene.points.spans[p];
                if (memcmp(other->brick, span->brick, sizeof span->brick) != 0) continue;
                assert_int_equal(other->count, span->owned_count);
                for (uint32_t k = 0; k < span->owned_count; k++)
                    assert_memory_equal(b.mesh.vertices[span->first_vertex + k].position,
                                        b.scene.points.surfels[other->first + k].position, 3 * sizeof(float));
                matched += span->owned_count;
            }
        }
        assert_int_equal(matched, iso_point_view_count(&b.scene.points));
        test_surfaces_free(&b);
    }
}

typedef struct judged {
    size_t covered, holes, through, beyond;
} judged;

/* Whether the triangles cover a sample and all around it at about the same depth. */
static bool is_inner(const iso_gbuffer *g, int x, int y, double voxel) {
    const double depth = (double)g->depth[y * g->width + x];
    if (!isfinite(depth)) return false;
    for (int k = 0; k < 9; k++) {
        const double other = (double)g->depth[(y + k / 3 - 1) * g->width + x + k % 3 - 1];
        if (!(fabs(other - depth) <= 2 * voxel)) return false;
    }
    return true;
}

static judged compare(const iso_gbuffer *drawn, const iso_gbuffer *wanted, double voxel) {
    judged j = {0};
    for (int y = 1; y + 1 < drawn->height; y++)
        for (int x = 1; x + 1 < drawn->width; x++) {
            const size_t i = (size_t)(y * drawn->width + x);
            j.covered += isfinite(wanted->depth[i]);
            j.beyond += isfinite(drawn->depth[i]) && !isfinite(wanted->depth[i]);
            if (!is_inner(wanted, x, y, voxel)) continue;
            j.holes += !isfinite(drawn->depth[i]);
            j.through +=
                isfinite(drawn->depth[i]) && (double)drawn->depth[i] > (double)wanted->depth[i] + 2 * voxel;
        }
    return j;
}

static void seams_are_closed(void **state) {
    (void)state;
    const char *const names[] = {"sphere", "torus", "gyroid"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        test_surfaces b = test_surfaces_make(names[i], 80, false);
        for (int side = 0; side < 6; side += 2)
            for (int zoom = 0; zoom < 3; zoom++) {
                const iso_view view =
                    test_look_at(&b.scene, side, zoom == 0 ? 1 : 2.5 * zoom, false, 300, 260);
                const double cell = middle_cell(&b, &view);
                iso_gbuffer drawn = hybrid(&b, &view, 1.1 * cell, NULL), wanted = triangles(&b, &view),
                            points = hybrid(&b, &view, 1e9, NULL);
                const judged j = compare(&drawn, &wanted, b.scene.points.radius * 1.5),
                             p = compare(&points, &wanted, b.scene.points.radius * 1.5);
                print_message(
                    "%s, side %d, zoom %d (cells of %.1f px): %zu samples, %zu holes (points %zu), %zu "
                    "through (%zu), %zu beyond (%zu)\n",
                    names[i], side, zoom, cell, j.covered, j.holes, p.holes, j.through, p.through, j.beyond,
                    p.beyond);
                assert_true(j.covered > 1000);
                assert_true(j.holes <= p.holes && j.through <= p.through);
                assert_true(j.through * 1000 <= j.covered);
                iso_gbuffer_free(&points);
                iso_gbuffer_free(&drawn);
                iso_gbuffer_free(&wanted);
            }
        test_surfaces_free(&b);
    }
}

static void one_kind_is_its_method(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("torus", 48, false);
    for (int parallel = 0; parallel < 2; parallel++) {
        const iso_view view = test_look_at(&b.scene, 2, 1, parallel, 200, 150);
        const iso_point_surface_opts gaussian = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN};
        iso_gbuffer points = test_drawn(&view, &b.scene.points, &gaussian, NULL), mesh = triangles(&b, &view),
                    small = hybrid(&b, &view, 1e6, NULL), large = hybrid(&b, &view, 1e-6, NULL);
        assert_memory_equal(small.depth, points.depth, 200 * 150 * sizeof(float));
        assert_memory_equal(large.depth, mesh.depth, 200 * 150 * sizeof(float));
        iso_gbuffer_free(&points);
        iso_gbuffer_free(&mesh);
        iso_gbuffer_free(&small);
        iso_gbuffer_free(&large);
    }
    test_surfaces_free(&b);
}

typedef struct hybrid_drawing {
    const test_surfaces *b;
    double pixels;
} hybrid_drawing;

static iso_gbuffer draw_hybrid(const void *context, const iso_view *view, iso_pool *pool) {
    const hybrid_drawing *d = context;
    return hybrid(d->b, view, d->pixels, pool);
}

static void bytes_are_the_same(void **state) {
    (void)state;
    test_surfaces b = test_surfaces_make("gyroid", 64, false);
    const iso_view view = test_look_at(&b.scene, 4, 1.5, false, 210, 170);
    const hybrid_drawing d = {&b, 1.1 * middle_cell(&b, &view)};
    iso_gbuffer wanted = draw_hybrid(&d, &view, NULL);
    test_variants_of(draw_hybrid, &d, &view, &wanted);
    test_strips_of(draw_hybrid, &d, &view, 7, &wanted);
    iso_gbuffer_free(&wanted);
    test_surfaces_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_are_points),
        cmocka_unit_test(seams_are_closed),
        cmocka_unit_test(one_kind_is_its_method),
        cmocka_unit_test(bytes_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
