#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "render/groups/coverage.h"
#include "render/groups/disc_layers.h"
#include "render/picture.h"
#include "render/view/gbuffer.h"
#include "scene_support.h"
#include "splats_reference.h"

static const iso_rgb BACKGROUND = {31, 33, 41}, COLOR = {191, 140, 102}, OPAQUE = {20, 200, 90};

/* What is drawn. */
typedef struct drawing {
    iso_transparency transparency;
    const iso_splat_layer *layers;
    int count;
    float *opaque; /* depths of an opaque surface, or NULL */
    iso_pool *pool;
} drawing;

/* Draws rows y0 .. y0 + view->height - 1 of the image; view: of those rows. */
static iso_layer_totals draw_rows(const drawing *d, const iso_view *view, int y0, int factor,
                                  iso_image *image) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false);
    const iso_rgb colors[2] = {COLOR, OPAQUE};
    const iso_shading shading = {.colors = colors, .color_count = 2, .background = BACKGROUND};
    iso_gbuffer seen = g;
    if (!d->opaque) seen.depth = NULL;
    for (size_t i = 0; d->opaque && i < (size_t)view->width * (size_t)view->height; i++) {
        g.depth[i] = d->opaque[i];
        g.surface[i] = d->opaque[i] < INFINITY ? 1 : ISO_SURFACE_NONE;
        g.normal[2][i] = -1;
    }
    const iso_strip strip = {view, &seen, factor, y0};
    const iso_splat_layers picture = {.transparency = d->transparency,
                                      .layers = d->layers,
                                      .count = d->count,
                                      .picture = {&strip, &shading, image, NULL, NULL, d->pool}};
    iso_layer_totals totals = {0};
    test_ok(iso_shade_splat_layers(&picture, &totals, &error), &error);
    iso_gbuffer_free(&g);
    return totals;
}

static iso_image drawn(const drawing *d, const iso_view *view, iso_layer_totals *totals) {
    iso_image image;
    assert_int_equal(iso_image_create(view->width, view->height, &image, NULL), ISO_OK);
    const iso_layer_totals found = draw_rows(d, view, 0, 1, &image);
    if (totals) *totals = found;
    return image;
}

static bool same_pixel(const iso_image *a, const iso_image *b, size_t i, int tolerance) {
    bool same = true;
    for (size_t k = 0; k < 4; k++) same &= abs(a->rgba[4 * i + k] - b->rgba[4 * i + k]) <= tolerance;
    return same;
}

static bool is_background(const iso_image *image, size_t i) {
    const uint8_t *p = image->rgba + 4 * i;
    return p[0] == BACKGROUND.r && p[1] == BACKGROUND.g && p[2] == BACKGROUND.b;
}

/* dB over the pixels that show something. */
static double psnr(const iso_image *a, const iso_image *b) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++) {
        if (is_background(a, i) && is_background(b, i)) continue;
        count += 3;
        for (size_t k = 0; k < 3; k++) {
            const double d = a->rgba[4 * i + k] - (double)b->rgba[4 * i + k];
            sum += d * d;
        }
    }
    return 10 * log10(255 * 255 / (sum / count + 1e-9));
}

/* ---- sorted */

enum { MOST = 80 };

typedef struct cloud {
    iso_surfel surfels[MOST];
    float radii[MOST];
    uint8_t colors[MOST][3], opacities[MOST];
    iso_point_span span;
    iso_splat_layer layer;
} cloud;

static void make_cloud(cloud *c, double depth, double radius, uint32_t seed) {
    c->span = (iso_point_span){.count = MOST};
    for (uint32_t i = 0; i < MOST; i++) {
        for (int k = 0; k < 3; k++) {
            c->surfels[i].position[k] = (float)((uniform(&seed) - 0.5) * 10 + (k == 2 ? depth : 0));
            c->surfels[i].normal[k] = (float)(uniform(&seed) - 0.5);
        }
        c->radii[i] = (float)(radius * (0.2 + uniform(&seed)));
    }
    c->layer = (iso_splat_layer){.points = {.surfels = c->surfels,
                                            .radii = c->radii,
                                            .spans = &c->span,
                                            .span_count = 1,
                                            .transform = iso_transform_identity(),
                                            .closed = true}, /* nothing is culled all the same */
                                 .color = COLOR,
                                 .translucency = {.opacity = 0.4f}};
}

/* Gives the points colours and opacities, among these 0 with a colour of its own, and 1. */
static void make_opacities(cloud *c, uint32_t seed) {
    for (size_t i = 0; i < MOST; i++) {
        for (size_t k = 0; k < 3; k++) c->colors[i][k] = (uint8_t)(255 * uniform(&seed));
        c->opacities[i] = i % 4 ? (uint8_t)(255 * uniform(&seed)) : i % 8 ? 255 : 0;
    }
    c->layer.points.colors = (const uint8_t(*)[3])c->colors;
    c->layer.points.opacities = c->opacities;
    c->layer.translucency.opacity = seed % 3 ? 1 : 0.7f;
}

static void test_sorted(void **state) {
    (void)state;
    static cloud c;
    for (int k = 0; k < 16; k++) {
        const bool orthographic = k % 4 == 3;
        make_cloud(&c, k % 4 == 1 ? 6 : 20, k % 4 == 2 ? 2 : 1, 5 + (uint32_t)k);
        if (k >= 8) make_opacities(&c, (uint32_t)k);
        c.layer.translucency.constant = k % 8 < 4;
        iso_view view = test_plain_view(120, 100, orthographic, orthographic ? 12 : 180);
        if (!orthographic) view.near = 1.5;
        const drawing d = {.layers = &c.layer, .count = 1};
        iso_image got = drawn(&d, &view, NULL), wanted;
        assert_int_equal(iso_image_create(120, 100, &wanted, NULL), ISO_OK);
        test_draw_sorted_layers(&view, &c.layer, BACKGROUND, &wanted);
        size_t different = 0, covered = 0;
        for (size_t i = 0; i < 120 * 100; i++) {
            covered += !is_background(&wanted, i);
            different += !same_pixel(&got, &wanted, i, 2);
        }
        assert_true(covered > 2000);
        if (different > covered / 200) fail_msg("%zu of %zu pixels differ", different, covered);
        iso_image_free(&got);
        iso_image_free(&wanted);
    }
}

/* ---- scenes */

typedef struct fixture {
    test_scene scene;
    iso_groups groups;
    iso_splat_layer layer;
    iso_view view;
} fixture;

static fixture make_fixture(const char *name, int size, int pixels, float opacity) {
    fixture f = {.scene = test_scene_make(name, size, NULL, true)};
    const iso_groups_opts grouping = iso_splat_layers_grouping(NULL);
    assert_int_equal(iso_groups_make(&f.scene.points, &grouping, &f.groups, NULL), ISO_OK);
    f.view = test_look_at(&f.scene, 1, 1, false, pixels, pixels);
    f.layer = (iso_splat_layer){
        .points = f.scene.points, .color = COLOR, .translucency = {.opacity = opacity, .constant = true}};
    return f;
}

static void free_fixture(fixture *f) {
    iso_groups_free(&f->groups);
    test_scene_free(&f->scene);
}

/* Algorithms 2 and 3 against sorted layers, with both ways to enlarge discs. */
static void test_algorithms(void **state) {
    (void)state;
    const char *const scenes[] = {"sphere", "gyroid", "head"};
    double gain[2] = {0, 0};
    for (int k = 0; k < 3; k++)
        for (int a = 3; a < 8; a += 4) {
            fixture f = make_fixture(scenes[k], 48, 300, (float)a / 10);
            iso_image image[3];
            f.layer.groups = &f.groups;
            for (int t = 0; t < 3; t++) {
                const drawing d = {.transparency = (iso_transparency)t, .layers = &f.layer, .count = 1};
                image[t] = drawn(&d, &f.view, NULL);
            }
            const double groups = psnr(&image[1], &image[0]), nearest = psnr(&image[2], &image[0]);
            printf("%s, opacity 0.%d: groups %.1f dB, nearest %.1f\n", scenes[k], a, groups, nearest);
            assert_true(groups > 27 && nearest > 30);
            assert_int_equal(
                iso_groups_cover(&f.scene.points, (double)ISO_GROUPS_DISC, NULL, &f.groups, NULL), ISO_OK);
            for (int t = 1; t < 3; t++) {
                const drawing d = {.transparency = (iso_transparency)t, .layers = &f.layer, .count = 1};
                iso_image covered = drawn(&d, &f.view, NULL);
                const double better = psnr(&covered, &image[0]);
                printf("  discs enlarged until groups cover the surface: %.1f dB\n", better);
                assert_true(better > (t == 1 ? 27 : 30));
                gain[t - 1] += better - (t == 1 ? groups : nearest);
                iso_image_free(&covered);
            }
            for (int t = 0; t < 3; t++) iso_image_free(&image[t]);
            free_fixture(&f);
        }
    assert_true(gain[0] > 0 && gain[1] > 0);
}

/* A sphere has two layers at most, but at its silhouette; --layers leaves the first. */
static void test_counts(void **state) {
    (void)state;
    fixture f = make_fixture("sphere", 40, 200, 0.5f);
    iso_layer_totals all, first;
    const drawing d = {.layers = &f.layer, .count = 1};
    iso_image image = drawn(&d, &f.view, &all);
    iso_image_free(&image);
    f.layer.translucency.most_layers = 1;
    image = drawn(&d, &f.view, &first);
    iso_image_free(&image);
    assert_in_range(all.most, 2, 4);
    assert_int_equal(first.most, 1);
    assert_int_equal(first.layers, first.covered);
    assert_true(all.covered > 12000 && fabs((double)all.layers / (double)all.covered - 2) < 0.1);
    free_fixture(&f);
}

/* What lies behind an opaque surface is not seen, and the surface is seen through what lies before it. */
static void test_opaque(void **state) {
    (void)state;
    fixture f = make_fixture("sphere", 40, 200, 0.5f);
    f.layer.groups = &f.groups;
    enum { SAMPLES = 200 * 200 };
    static float depth[SAMPLES];
    const float eye[2] = {1, 1e6f}; /* before and behind everything */
    for (int t = 0; t < 3; t++) {
        drawing d = {.transparency = (iso_transparency)t, .layers = &f.layer, .count = 1};
        iso_image alone = drawn(&d, &f.view, NULL);
        for (int behind = 0; behind < 2; behind++) {
            for (int i = 0; i < SAMPLES; i++) depth[i] = eye[behind];
            d.opaque = depth;
            iso_layer_totals totals;
            iso_image image = drawn(&d, &f.view, &totals);
            size_t changed = 0;
            for (size_t i = 0; i < SAMPLES; i++) changed += !same_pixel(&image, &alone, i, 0);
            if (!behind) assert_int_equal(totals.layers, 0);
            assert_true(changed > SAMPLES / 2);
            iso_image_free(&image);
        }
        for (int i = 0; i < SAMPLES; i++) depth[i] = INFINITY; /* nothing opaque */
        iso_image image = drawn(&d, &f.view, NULL);
        assert_memory_equal(image.rgba, alone.rgba, 4 * SAMPLES);
        iso_image_free(&image);
        iso_image_free(&alone);
    }
    free_fixture(&f);
}

/* ---- the same bytes */

static void test_threads_and_strips(void **state) {
    (void)state;
    fixture f = make_fixture("head", 40, 140, 0.4f);
    f.layer.groups = &f.groups;
    f.view = iso_view_scaled(&f.view, 2);
    const size_t bytes = 4 * 140 * 140;
    for (int t = 0; t < 3; t++) {
        drawing d = {.transparency = (iso_transparency)t, .layers = &f.layer, .count = 1};
        iso_image wanted, got;
        assert_int_equal(iso_image_create(140, 140, &wanted, NULL), ISO_OK);
        assert_int_equal(iso_image_create(140, 140, &got, NULL), ISO_OK);
        draw_rows(&d, &f.view, 0, 2, &wanted);
        for (int threads = 2; threads < 4; threads++) {
            assert_int_equal(iso_pool_create(threads, &d.pool, NULL), ISO_OK);
            draw_rows(&d, &f.view, 0, 2, &got);
            assert_memory_equal(got.rgba, wanted.rgba, bytes);
            iso_pool_destroy(d.pool);
            d.pool = NULL;
        }
        memset(got.rgba, 0, bytes);
        for (int y = 0; y < 140; y += 33) {
            const int rows = 140 - y < 33 ? 140 - y : 33;
            const iso_view view = iso_view_rows(&f.view, 2 * y, 2 * rows);
            draw_rows(&d, &view, y, 2, &got);
        }
        assert_memory_equal(got.rgba, wanted.rgba, bytes);
        iso_image_free(&wanted);
        iso_image_free(&got);
    }
    free_fixture(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sorted),
        cmocka_unit_test(test_algorithms),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_opaque),
        cmocka_unit_test(test_threads_and_strips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
