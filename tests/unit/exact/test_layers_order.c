/* A translucent isosurface and opaque tubes that go through it: in every pixel as many layers lie in front
 * of the tube as crossings that rays in extended and double precision find there, except where a crossing is
 * nearer to the tube than 1e-3 voxel. */
#include <math.h>
#include <stdlib.h>

#include "check_support.h"
#include "exact/layers.h"
#include "exact_support.h"
#include "extract_support.h"
#include "lines_support.h"
#include "render/shapes/shapes.h"
#include "shapes_truth.h"
#include "truth/raycast_layers.h"
#include "view_support.h"

enum { SIDE = 160, MOST = 64, TUBES = 1 };

static test_lines lines;

/* Tubes of several directions and radii through the grid. */
static void make_tubes(const iso_grid *grid, test_random *random) {
    const iso_transform *t = iso_grid_transform(grid);
    const iso_affine affine = iso_transform_affine(t);
    const double *s = t->spacing, voxel = fmin(s[0], fmin(s[1], s[2]));
    const int *dims = iso_grid_dims(grid);
    const iso_vec3 first = iso_affine_point(&affine, iso_vec3_make(0, 0, 0));
    test_lines_start(&lines, first.x, first.y, first.z);
    for (int i = 0; i < 14; i++) {
        const double radius = voxel * test_random_real(random, 0.1, 1.5);
        for (int k = 0; k < 5; k++) {
            const iso_vec3 index = iso_vec3_make(test_random_real(random, -2, dims[0] + 2),
                                                 test_random_real(random, -2, dims[1] + 2),
                                                 test_random_real(random, -2, dims[2] + 2));
            const iso_vec3 at = iso_vec3_sub(iso_affine_point(&affine, index), first);
            test_lines_add(&lines, at.x, at.y, at.z, radius);
        }
        test_lines_end(&lines);
    }
}

/* What the picture has: depths of tubes, and how many layers are in front of them. */
typedef struct drawn {
    iso_gbuffer gbuffer;
    iso_image image;
    float *counts;
} drawn;

static drawn draw(const iso_grid *grid, double isovalue, const iso_view *view, const iso_shapes_opts *opts) {
    static const iso_rgb colors[2] = {{200, 180, 150}, {60, 90, 200}};
    const iso_shading shading = {colors, 2, {255, 255, 255}, 0, {0, 0, 0}};
    iso_error error = {0};
    drawn d = {.gbuffer = empty_picture(view), .counts = calloc(SIDE * SIDE, sizeof *d.counts)};
    iso_shapes *shapes;
    test_ok(iso_image_create(SIDE, SIDE, &d.image, &error), &error);
    test_ok(iso_shapes_from_lines(&lines.lines, opts, &shapes, &error), &error);
    const iso_target target = {view, &d.gbuffer, NULL, TUBES, NULL};
    test_ok(iso_draw_shapes(&target, shapes, NULL, &error), &error);
    iso_exact *exact = make_exact(grid, isovalue, NULL);
    const iso_exact_layer layer = {exact, colors[0], {.opacity = 0.05f, .constant = true}, NULL, NULL};
    const iso_strip strip = {.view = view, .gbuffer = &d.gbuffer, .factor = 1};
    const iso_exact_layers input = {
        .layers = &layer, .count = 1, .picture = {&strip, &shading, &d.image, d.counts, NULL, NULL}};
    iso_exact_layers_totals totals = {.retraced = 0};
    test_ok(iso_shade_exact_layers(&input, &totals, &error), &error);
    iso_exact_destroy(exact);
    iso_shapes_destroy(shapes);
    return d;
}

static void free_drawn(drawn *d) {
    iso_gbuffer_free(&d->gbuffer);
    iso_image_free(&d->image);
    free(d->counts);
}

/* The crossings of every pixel. */
typedef struct crossings {
    int count[SIDE * SIDE];
    double depth[SIDE * SIDE][MOST];
} crossings;

static void read_crossing(void *context, int x, int y, const iso_raycast_crossing *crossing) {
    crossings *all = context;
    const int at = y * SIDE + x;
    if (all->count[at] < MOST) all->depth[at][all->count[at]++] = crossing->depth;
}

static crossings *find_crossings(const iso_grid *grid, double isovalue, const iso_view *view) {
    crossings *all = calloc(1, sizeof *all);
    assert_non_null(all);
    iso_error error = {0};
    iso_raycaster *caster;
    test_ok(iso_raycaster_create(grid, isovalue, NULL, &caster, &error), &error);
    const iso_raycast_layer layer = {
        caster, {200, 180, 150}, {.opacity = 0.05f, .constant = true}, NULL, NULL};
    const iso_gbuffer nothing = {.width = SIDE, .height = SIDE};
    const iso_strip strip = {.view = view, .gbuffer = &nothing, .factor = 1};
    const iso_raycast_layers input = {&layer, 1, {.strip = &strip}};
    const iso_raycast_reader reader = {read_crossing, all};
    iso_read_raycast_layers(&input, &reader);
    iso_raycaster_destroy(caster);
    return all;
}

typedef struct verdict {
    size_t tubes, through; /* pixels that show a tube; of these, with layers before it and behind it */
    size_t near, wrong;    /* another number of layers, with a crossing that near; all others */
} verdict;

static void judge_order(const iso_grid *grid, double isovalue, const iso_view *view, verdict *v) {
    const iso_shapes_opts opts = {.radius = 1};
    const iso_shapes_scene scene = {NULL, &lines.lines, opts};
    const double *s = iso_grid_transform(grid)->spacing, close = 1e-3 * fmin(s[0], fmin(s[1], s[2]));
    iso_error error = {0};
    iso_shapes_truth *truth;
    test_ok(iso_shapes_truth_create(&scene, view, &truth, &error), &error);
    drawn d = draw(grid, isovalue, view, &opts);
    crossings *all = find_crossings(grid, isovalue, view);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const iso_shapes_hit hit = iso_shapes_truth_ray(truth, i % SIDE + 0.5, i / SIDE + 0.5);
        if (!hit.hit || d.gbuffer.surface[i] != TUBES || fabs((double)d.gbuffer.depth[i] - hit.depth) > close)
            continue; /* outlines of tubes: test_tubes */
        int before = 0;
        bool nearby = false;
        for (int k = 0; k < all->count[i]; k++) {
            before += all->depth[i][k] < hit.depth;
            nearby |= fabs(all->depth[i][k] - hit.depth) <= close;
        }
        const bool same = before == (int)d.counts[i];
        v->tubes++;
        v->through += before > 0 && before < all->count[i];
        v->near += !same && nearby;
        v->wrong += !same && !nearby;
    }
    free(all);
    free_drawn(&d);
    iso_shapes_truth_destroy(truth);
}

static void layers_lie_before_or_behind(void **state) {
    (void)state;
    test_random random = {17};
    verdict v = {0};
    for (int round = 0; round < TEST_TRANSFORMS * TEST_VIEWS; round++) {
        iso_grid grid = test_rgrid((const int[3]){20, 18, 22}, round % 2 ? ISO_FLOAT32 : ISO_UINT8);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        test_fill(&grid, round % 3 == 2 ? TEST_NOISE : TEST_SMOOTH, &random);
        make_tubes(&grid, &random);
        const iso_view view =
            test_view_make(&grid, round / TEST_TRANSFORMS % TEST_VIEWS, SIDE, test_random_direction(&random));
        judge_order(&grid, 100, &view, &v);
        iso_grid_destroy(&grid);
    }
    print_message("%zu pixels of tubes, %zu between layers: %zu differ within 1e-3 voxel, %zu beyond\n",
                  v.tubes, v.through, v.near, v.wrong);
    assert_true(v.through > 20000);
    assert_int_equal(v.wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(layers_lie_before_or_behind)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
