/* Glass, and translucent surfaces of points, through the public interface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "lent_ball.h"

static double psnr(const iso_image *a, const iso_image *b) {
    iso_difference difference = {0};
    assert_int_equal(iso_compare_images(a, b, NULL, &difference, NULL), ISO_OK);
    return difference.psnr;
}

/* Glass of the field and of its points, and what is no glass. */
static void glass(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(2);
    iso_surface *surface = NULL;
    assert_int_equal(iso_surface_create(volume, NULL, &surface, NULL), ISO_OK);
    iso_image field = {0}, points = {0}, other = {0};
    iso_glass_opts solid = {.ior = 1.5, .refraction = ISO_REFRACTION_TWO_SIDED};
    iso_render_opts opts = {.width = 64, .height = 48, .samples = 4, .glass = &solid};
    assert_int_equal(iso_render(surface, &opts, &field, NULL), ISO_OK);
    opts.method = ISO_METHOD_SPLATS;
    assert_int_equal(iso_render(surface, &opts, &points, NULL), ISO_OK);
    assert_true(psnr(&field, &points) > 20);
    solid.refraction = ISO_REFRACTION_AUTO;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_OK);
    assert_memory_equal(points.rgba, other.rgba, bytes_of(&points));
    opts.method = ISO_METHOD_RAYCAST;
    assert_int_equal(iso_render(surface, &opts, &field, NULL), ISO_OK);
    opts.method = ISO_METHOD_EXACT;
    solid.refraction = ISO_REFRACTION_TRACED;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_OK);
    assert_memory_equal(field.rgba, other.rgba, bytes_of(&field));
    solid.refraction = ISO_REFRACTION_LAYERS;
    solid.surface_opacity = 0.3;
    solid.dispersion = 20;
    solid.attenuation_distance = 10;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_OK);
    const iso_glass_opts bad[] = {{.ior = 0},
                                  {.ior = NAN},
                                  {.ior = 1.5, .refraction = ISO_REFRACTIONS},
                                  {.ior = 1.5, .dispersion = 0.5},
                                  {.ior = 1.5, .attenuation_distance = -1},
                                  {.ior = 1.5, .surface_opacity = 2},
                                  {.ior = 1.5, .surface_opacity = 0.5}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        opts.glass = &bad[i];
        assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_USAGE);
    }
    solid = (iso_glass_opts){.ior = 1.5, .environment = "/nowhere/at_all.png"};
    opts.glass = &solid;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_IO);
    solid = (iso_glass_opts){.ior = 1.5, .refraction = ISO_REFRACTION_TRACED};
    opts.method = ISO_METHOD_SPLATS;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_USAGE);
    opts.method = ISO_METHOD_MESH;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_USAGE);
    iso_image_free(&field);
    iso_image_free(&points);
    iso_image_free(&other);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

/* The three ways to composite translucent points: near to each other, but not the same. Each gives the same
 * picture whatever was drawn before it, though the groups of the surface's points differ. */
static void transparencies(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(2);
    iso_surface *surface = NULL, *fresh = NULL, *opaque = NULL;
    const iso_surface_opts half = {.opacity = 0.5};
    assert_int_equal(iso_surface_create(volume, &half, &surface, NULL), ISO_OK);
    assert_int_equal(iso_surface_create(volume, NULL, &opaque, NULL), ISO_OK);
    iso_image first[ISO_TRANSPARENCIES] = {0}, again = {0};
    iso_render_opts opts = {.method = ISO_METHOD_SPLATS, .width = 96, .height = 64, .samples = 4};
    for (int t = 0; t < ISO_TRANSPARENCIES; t++) {
        opts.transparency = (iso_transparency)t;
        assert_int_equal(iso_render(surface, &opts, &first[t], NULL), ISO_OK);
        assert_int_equal(iso_surface_create(volume, &half, &fresh, NULL), ISO_OK);
        assert_int_equal(iso_render(fresh, &opts, &again, NULL), ISO_OK);
        assert_memory_equal(first[t].rgba, again.rgba, bytes_of(&again));
        iso_surface_destroy(fresh);
    }
    for (int t = 1; t < ISO_TRANSPARENCIES; t++) {
        assert_memory_not_equal(first[0].rgba, first[t].rgba, bytes_of(&again));
        assert_true(psnr(&first[0], &first[t]) > 25);
    }
    opts.transparency = ISO_TRANSPARENCY_GROUPS; /* without effect on opaque surfaces */
    assert_int_equal(iso_render(opaque, &opts, &first[0], NULL), ISO_OK);
    opts.transparency = ISO_TRANSPARENCY_SORTED;
    assert_int_equal(iso_render(opaque, &opts, &again, NULL), ISO_OK);
    assert_memory_equal(first[0].rgba, again.rgba, bytes_of(&again));
    opts.transparency = ISO_TRANSPARENCIES;
    assert_int_equal(iso_render(surface, &opts, &again, NULL), ISO_ERR_USAGE);
    opts.transparency = ISO_TRANSPARENCY_NEAREST;
    opts.method = ISO_METHOD_EXACT;
    assert_int_equal(iso_render(surface, &opts, &again, NULL), ISO_ERR_USAGE);
    for (int t = 0; t < ISO_TRANSPARENCIES; t++) iso_image_free(&first[t]);
    iso_image_free(&again);
    iso_surface_destroy(surface);
    iso_surface_destroy(opaque);
    iso_volume_destroy(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(glass), cmocka_unit_test(transparencies)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
