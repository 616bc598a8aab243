/* the study of transparency: against what must hold for every volume, and the crossings that it is made from
 * against the truth's own picture. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "compare/transparency.h"
#include "extract_support.h"
#include "grids/scenes/scenes.h"
#include "truth/raycast_layers.h"

enum { SIDE = 96 };

static const iso_study_look look = {.color = {217, 179, 108}, .background = {250, 245, 240}};

typedef struct fixture {
    iso_grid grid;
    iso_scene_surface surface;
    iso_study_ball ball;
    iso_view view;
} fixture;

/* Takes f->grid and f->surface.isovalue. */
static void prepare(fixture *f, iso_pool *pool) {
    const iso_part parts[] = {ISO_PART_MESH, ISO_PART_POINTS, ISO_PART_CELLS, ISO_PART_CASTER};
    f->surface.grid = f->grid;
    f->surface.pool = pool;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        assert_int_equal(iso_scene_surface_prepare(&f->surface, parts[i], NULL), ISO_OK);
    const iso_mesh_view mesh = iso_mesh_set_view(f->surface.mesh);
    assert_int_equal(iso_study_bound(&mesh, &f->ball, NULL), ISO_OK);
    f->view = iso_study_fit(&f->ball, SIDE, 0);
}

static fixture open_scene(const char *name, iso_pool *pool) {
    fixture f = {0};
    const iso_scene_opts opts = {.size = 32};
    assert_int_equal(iso_scene_create(name, &opts, &f.grid, &f.surface.isovalue, NULL), ISO_OK);
    prepare(&f, pool);
    return f;
}

static void close_fixture(fixture *f) {
    iso_scene_surface_free(&f->surface);
    iso_grid_destroy(&f->grid);
}

static iso_transparency_study study_of(const fixture *f) {
    iso_transparency_study study;
    iso_error error = {0};
    test_ok(iso_study_transparency(&f->surface, &f->ball, &f->view, &look, &study, &error), &error);
    return study;
}

static void only_exact_is_the_truth(void **state) {
    (void)state;
    static const char *const scenes[] = {"torus", "gyroid"};
    for (int s = 0; s < 2; s++) {
        fixture f = open_scene(scenes[s], NULL);
        const iso_transparency_study study = study_of(&f);
        assert_true(study.most_layers >= 4 && study.mean_layers > 1.5);
        assert_true(study.covered > 1000 && study.covered < SIDE * SIDE);
        for (int i = 0; i < ISO_TRANSPARENCY_OPACITIES; i++) {
            assert_int_equal(study.wrong_layers[i], 0);
            assert_true(study.psnr[ISO_COMPOSITING_EXACT][i] >= 80);
            for (int c = ISO_COMPOSITING_AVERAGE; c < ISO_COMPOSITINGS; c++)
                assert_true(study.psnr[c][i] > 15 && study.psnr[c][i] < 60);
        }
        /* the more the first layer hides, the more a mean is wrong, and the more a weight by depth helps */
        const double *average = study.psnr[ISO_COMPOSITING_AVERAGE];
        assert_true(average[0] > average[1] && average[1] > average[2]);
        assert_true(study.psnr[ISO_COMPOSITING_WEIGHTED][2] > average[2] + 2);
        close_fixture(&f);
    }
}

/* A half-space: every ray that meets its surface meets it once. */
static void one_layer_needs_no_order(void **state) {
    (void)state;
    const int dims[3] = {24, 24, 24};
    fixture f = {.grid = test_rgrid(dims, ISO_FLOAT32), .surface = {.isovalue = 0}};
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) test_set(&f.grid, x, y, z, 11.3 - z + 0.1 * x);
    prepare(&f, NULL);
    const iso_transparency_study study = study_of(&f);
    assert_int_equal(study.most_layers, 1);
    assert_true(study.mean_layers == 1 && study.covered > 1000);
    for (int i = 0; i < ISO_TRANSPARENCY_OPACITIES; i++) {
        assert_int_equal(study.wrong_layers[i], 0);
        assert_true(study.psnr[ISO_COMPOSITING_EXACT][i] >= 90);
        assert_true(study.psnr[ISO_COMPOSITING_AVERAGE][i] == iso_psnr(0, 1));
        assert_true(study.psnr[ISO_COMPOSITING_WEIGHTED][i] == iso_psnr(0, 1));
    }
    close_fixture(&f);
}

static void threads_change_nothing(void **state) {
    (void)state;
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    fixture alone = open_scene("gyroid", NULL), many = open_scene("gyroid", pool);
    const iso_transparency_study a = study_of(&alone), b = study_of(&many);
    assert_memory_equal(a.psnr, b.psnr, sizeof a.psnr);
    assert_memory_equal(a.wrong_layers, b.wrong_layers, sizeof a.wrong_layers);
    assert_true(a.mean_layers == b.mean_layers && a.most_layers == b.most_layers);
    close_fixture(&alone);
    close_fixture(&many);
    iso_pool_destroy(pool);
}

/* ---- the crossings */

/* Crossings composited as they come. */
typedef struct composed {
    double color[3], through, depth;
    int layers;
} composed;

static void compose(void *context, int x, int y, const iso_raycast_crossing *crossing) {
    composed *pixel = (composed *)context + y * SIDE + x;
    assert_true(crossing->depth >= pixel->depth);
    pixel->depth = crossing->depth;
    if (pixel->through < (double)ISO_LAYER_CUT) return;
    for (int k = 0; k < 3; k++)
        pixel->color[k] += pixel->through * crossing->opacity * (double)crossing->rgb[k];
    pixel->through *= 1 - crossing->opacity;
    pixel->layers++;
}

static void crossings_in_order_are_the_picture(void **state) {
    (void)state;
    fixture f = open_scene("gyroid", NULL);
    static composed pixels[SIDE * SIDE];
    static float layers[SIDE * SIDE], coverage[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) pixels[i] = (composed){.through = 1};
    iso_image image;
    assert_int_equal(iso_image_create(SIDE, SIDE, &image, NULL), ISO_OK);
    const iso_gbuffer size = {.width = SIDE, .height = SIDE};
    const iso_strip strip = {&f.view, &size, 1, 0};
    const iso_shading shading = {&look.color, 1, look.background, 1, {0, 0, 0}};
    const iso_raycast_layer layer = {f.surface.caster, look.color, {.opacity = 0.6f}, NULL, NULL};
    const iso_raycast_layers picture = {&layer, 1, {&strip, &shading, &image, layers, coverage, NULL}};
    iso_layer_totals totals = {0};
    iso_shade_raycast_layers(&picture, &totals);
    iso_read_raycast_layers(&picture, &(iso_raycast_reader){compose, pixels});
    for (int i = 0; i < SIDE * SIDE; i++) {
        assert_int_equal(pixels[i].layers, (int)layers[i]);
        assert_true((float)(1 - pixels[i].through) == coverage[i]);
        for (int k = 0; k < 3 && pixels[i].layers; k++)
            near(image.rgba[4 * i + k], 255 * pixels[i].color[k] / (1 - pixels[i].through), 0.51);
    }
    iso_image_free(&image);
    close_fixture(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_exact_is_the_truth),
        cmocka_unit_test(one_layer_needs_no_order),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(crossings_in_order_are_the_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
