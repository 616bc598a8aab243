/* Instances by OpenGL: against the cpu engine, and against pictures of all of them: what is left out changes
 * nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/placement.h"
#include "forest_support.h"
#include "gl_support.h"
#include "render/gl/instances.h"
#include "render/gl/surface.h"

enum { WIDTH = 240, HEIGHT = 180 };

/* What became of instances. */
typedef struct tally {
    size_t drawn, hidden, points;
} tally;

/* Draws by the engine, or by the cpu (NULL). */
static iso_gbuffer draw(iso_gl_engine *engine, const iso_instances *instances, const iso_view *view,
                        bool draw_hidden, tally *to) {
    static uint8_t states[TEST_FOREST_MOST];
    iso_error error = {ISO_OK, ""};
    iso_instance_drawing drawing = {0};
    iso_instance_counts counts;
    iso_instances all = *instances;
    all.draw_hidden = draw_hidden;
    all.states = states;
    memset(states, ISO_INSTANCE_OUTSIDE, sizeof states);
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_target target = {view, &g, NULL, 0, NULL};
    test_ok(engine ? iso_gl_draw_instances(engine, &drawing, &target, &all, &counts, &error)
                   : iso_draw_instances(&drawing, &target, &all, &counts, &error),
            &error);
    iso_instance_drawing_free(&drawing);
    *to = (tally){.points = counts.points};
    for (size_t i = 0; i < all.count; i++) {
        to->drawn += states[i] == ISO_INSTANCE_DRAWN;
        to->hidden += states[i] == ISO_INSTANCE_HIDDEN;
    }
    return g;
}

/* Draws all instances, and those that the engine does not find hidden; checks that both have the same bytes.
 * Adds what became of the latter to sum[0], by the cpu to sum[1]. Returns the PSNR against the cpu. */
static double compare(iso_gl_engine *engine, const iso_instances *all, const iso_view *view, tally sum[2]) {
    tally every, of[2];
    iso_gbuffer whole = draw(engine, all, view, true, &every), few = draw(engine, all, view, false, &of[0]),
                cpu = draw(NULL, all, view, false, &of[1]);
    test_same_rows(&whole, 0, &few);
    assert_int_equal(every.hidden, 0);
    assert_int_equal(every.drawn, of[0].drawn + of[0].hidden);
    assert_true(of[0].drawn >= of[1].drawn);
    for (int k = 0; k < 2; k++) {
        sum[k].drawn += of[k].drawn;
        sum[k].hidden += of[k].hidden;
    }
    const gl_difference d = gl_compare(view, &cpu, &few);
    iso_gbuffer_free(&whole);
    iso_gbuffer_free(&few);
    iso_gbuffer_free(&cpu);
    return d.psnr;
}

/* A walk through a forest, by all reconstructions that the engine has, with and without levels of detail. */
static void hidden_instances_are_not_missed(iso_gl_engine *engine) {
    static const iso_reconstruction by[] = {ISO_RECONSTRUCTION_CURVED, ISO_RECONSTRUCTION_FLAT,
                                            ISO_RECONSTRUCTION_EWA};
    test_forest *f = test_forest_make(TEST_FOREST_MOST);
    tally sum[2] = {{0, 0, 0}, {0, 0, 0}};
    double least = INFINITY;
    for (int frame = 0; frame < 42; frame += 3) {
        const iso_view view = test_forest_view(f, frame, WIDTH, HEIGHT);
        f->all.lod_pixels = frame / 3 % 4;
        f->all.reconstruction = by[frame / 3 % 3];
        least = fmin(least, compare(engine, &f->all, &view, sum));
    }
    printf("%s: %.1f dB or more from the cpu; %zu drawn and %zu hidden, by the cpu %zu and %zu\n",
           engine->context->name, least, sum[0].drawn, sum[0].hidden, sum[1].drawn, sum[1].hidden);
    assert_true(least >= 43 && 10 * sum[0].hidden > 8 * sum[1].hidden);
    test_forest_free(f);
}

/* Eyes inside instances, a few voxels from points, whose discs are large in the picture. */
static void eyes_may_be_inside(iso_gl_engine *engine) {
    static const iso_reconstruction by[] = {ISO_RECONSTRUCTION_CURVED, ISO_RECONSTRUCTION_FLAT,
                                            ISO_RECONSTRUCTION_EWA};
    test_forest *f = test_forest_make(40);
    tally sum[2] = {{0, 0, 0}, {0, 0, 0}};
    double least = INFINITY;
    uint32_t seed = 7;
    for (int k = 0; k < 24; k++) {
        const iso_instance *in = &f->instances[k];
        const iso_affine affine = iso_transform_affine(&in->transform);
        const iso_point_view *points = &f->scenes[in->set].points;
        iso_camera camera = {.view_up = {0, 0, 1}, .view_angle = 50, .parallel_scale = 1};
        iso_vec3 at[2];
        for (int i = 0; i < 2; i++) {
            const iso_point_span *span = &points->spans[(size_t)(uniform(&seed) * points->span_count)];
            const iso_surfel p =
                iso_point_view_get(points, span->first + (size_t)(uniform(&seed) * span->count));
            const double inside = i ? 0 : 1 + 2 * uniform(&seed);
            double voxel[3];
            for (int axis = 0; axis < 3; axis++)
                voxel[axis] = (double)p.position[axis] + span->brick[axis] * ISO_BRICK -
                              inside * (double)p.normal[axis];
            at[i] = iso_vec3_make(voxel[0], voxel[1], voxel[2]);
        }
        camera.position = iso_affine_point(&affine, at[0]);
        camera.focal_point = iso_affine_point(&affine, at[1]);
        const iso_view view = iso_view_make(&camera, WIDTH, HEIGHT);
        f->all.reconstruction = by[k % 3];
        f->all.lod_pixels = k / 12;
        least = fmin(least, compare(engine, &f->all, &view, sum));
    }
    printf("%s: %.1f dB or more from the cpu\n", engine->context->name, least);
    assert_true(least >= 60);
    test_forest_free(f);
}

/* Filtered discs are hit before their points, and what is averaged with a front may lie before it. */
static void discs_reach_before_their_points(iso_gl_engine *engine) {
    static const iso_reconstruction by[] = {ISO_RECONSTRUCTION_CURVED, ISO_RECONSTRUCTION_FLAT,
                                            ISO_RECONSTRUCTION_EWA};
    static test_wall wall;
    tally sum[2] = {{0, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 3 * 20; k++) {
        const iso_view view = test_wall_view(40, 40, k % 2);
        test_wall_make(&wall, 0.01 + 0.2 * (k / 6));
        wall.all.reconstruction = by[k / 2 % 3];
        compare(engine, &wall.all, &view, sum);
    }
    assert_true(sum[0].hidden > 10);
}

/* Gives a forest's points radii of their own and colours. */
static void vary_points(test_forest *f, bool with_radii, bool with_colors) {
    enum { MOST = 20000 };
    static uint8_t colors[TEST_FOREST_SETS][MOST][3];
    static float radii[TEST_FOREST_SETS][MOST];
    uint32_t seed = 3;
    for (int s = 0; s < TEST_FOREST_SETS; s++) {
        iso_point_view *points = &f->scenes[s].points;
        size_t end = 0; /* of the arrays, which may have gaps */
        for (size_t i = 0; i < points->span_count; i++) {
            const size_t last = points->spans[i].first + points->spans[i].count;
            end = last > end ? last : end;
        }
        assert_true(end <= MOST);
        for (size_t i = 0; i < end; i++) {
            radii[s][i] = (float)(points->radius * (0.8 + 0.6 * uniform(&seed)));
            for (int c = 0; c < 3; c++) colors[s][i][c] = (uint8_t)(255 * uniform(&seed));
        }
        points->versions = NULL; /* levels of detail are all made again */
        if (with_radii) points->radii = radii[s];
        if (with_colors) points->colors = (const uint8_t(*)[3])colors[s];
    }
    test_forest_make_lods(f);
    for (int s = 0; s < TEST_FOREST_SETS; s++)
        if (with_radii) f->sets[s].reach = 1.4 * f->scenes[s].points.radius;
}

/* Draws strips of 50 rows. */
static iso_gbuffer draw_strips(iso_gl_engine *engine, const iso_instances *all, const iso_view *view) {
    const size_t storage = engine->max_storage;
    tally of;
    engine->max_storage = (size_t)WIDTH * 50 * 6 * sizeof(float);
    iso_gbuffer strips = draw(engine, all, view, false, &of);
    engine->max_storage = storage;
    return strips;
}

/* Radii of the points' own and colours, between levels of detail and of each instance; strips of the picture,
 * which small storage buffers ask for, look like the whole. */
static void points_of_all_kinds(iso_gl_engine *engine) {
    static iso_rgb colors[TEST_FOREST_MOST];
    double least = INFINITY;
    tally sum[2] = {{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < TEST_FOREST_MOST; i++) colors[i] = (iso_rgb){(uint8_t)i, (uint8_t)(5 * i), 90};
    for (int kind = 0; kind < 4; kind++) {
        test_forest *f = test_forest_make(150);
        vary_points(f, kind & 1, kind & 2);
        for (int frame = 0; frame < 16; frame += 4) {
            const iso_view view = test_forest_view(f, frame, WIDTH, HEIGHT);
            tally of;
            f->all.lod_pixels = frame / 4 % 2;
            f->all.colors = frame / 8 ? colors : NULL;
            f->all.reconstruction = frame / 8 ? ISO_RECONSTRUCTION_CURVED : ISO_RECONSTRUCTION_FLAT;
            least = fmin(least, compare(engine, &f->all, &view, sum));
            iso_gbuffer whole = draw(engine, &f->all, &view, false, &of),
                        strips = draw_strips(engine, &f->all, &view);
            assert_true(gl_compare(&view, &whole, &strips).psnr > 55);
            iso_gbuffer_free(&whole);
            iso_gbuffer_free(&strips);
        }
        test_forest_free(f);
    }
    printf("%s: %.1f dB or more from the cpu\n", engine->context->name, least);
    assert_true(least >= 43);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_engine_test(hidden_instances_are_not_missed),
        gl_engine_test(eyes_may_be_inside),
        gl_engine_test(discs_reach_before_their_points),
        gl_engine_test(points_of_all_kinds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
