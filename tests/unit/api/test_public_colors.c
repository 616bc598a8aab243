/* Surfaces coloured by data, and smooth ones, through the public interface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "lent_ball.h"

static void surfaces_are_colored_by_data(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(2);
    iso_surface *surface = NULL;
    iso_image plain = {0}, colored = {0}, truth = {0}, other = {0};
    assert_int_equal(iso_surface_create(volume, NULL, &surface, NULL), ISO_OK);
    iso_render_opts opts = {.width = 64, .height = 48, .samples = 1};
    assert_int_equal(iso_render(surface, &opts, &plain, NULL), ISO_OK);
    for (int source = 0; source <= (int)ISO_COLOR_BY_NORMAL; source++) {
        iso_color_by by = {.source = (iso_color_source)source, .volume = volume, .isovalue = 1};
        opts.color_by = &by;
        if (source == (int)ISO_COLOR_BY_VOLUME) by.range[0] = -1, by.range[1] = 1; /* it is constant there */
        opts.color_by_count = 1;
        opts.method = ISO_METHOD_EXACT;
        assert_int_equal(iso_render(surface, &opts, &colored, NULL), ISO_OK);
        assert_memory_not_equal(plain.rgba, colored.rgba, bytes_of(&plain));
        opts.method = ISO_METHOD_RAYCAST;
        assert_int_equal(iso_render(surface, &opts, &truth, NULL), ISO_OK);
        iso_difference difference = {0};
        assert_int_equal(iso_compare_images(&truth, &colored, NULL, &difference, NULL), ISO_OK);
        if (difference.psnr < 45) fail_msg("source %d: %g dB", source, difference.psnr);
    }
    /* the surface has its own colour again */
    opts.color_by_count = 0;
    opts.method = ISO_METHOD_EXACT;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_OK);
    assert_memory_equal(plain.rgba, other.rgba, bytes_of(&plain));
    const iso_color_by bad[] = {{.surface = 1, .source = ISO_COLOR_BY_DEPTH},
                                {.surface = -1, .source = ISO_COLOR_BY_DEPTH},
                                {.source = (iso_color_source)7},
                                {.source = ISO_COLOR_BY_VOLUME},
                                {.source = ISO_COLOR_BY_DISTANCE, .volume = volume, .isovalue = NAN},
                                {.source = ISO_COLOR_BY_DEPTH, .range = {3, 1}},
                                {.source = ISO_COLOR_BY_DEPTH, .colormap = "virdis"}};
    opts.color_by_count = 1;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        opts.color_by = &bad[i];
        assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_USAGE);
    }
    const iso_color_by empty = {.source = ISO_COLOR_BY_DISTANCE, .volume = volume, .isovalue = 1e6};
    opts.color_by = &empty;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_EMPTY);
    iso_image_free(&plain);
    iso_image_free(&colored);
    iso_image_free(&truth);
    iso_image_free(&other);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

/* The smooth surface is another picture, is the ray caster's but for a hem of its outline
 * (docs/smooth.md), and goes with linear again. */
static void surfaces_are_smooth_by_a_filter(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(2);
    iso_surface *surface = NULL;
    iso_image plain = {0}, smooth = {0}, truth = {0}, other = {0};
    assert_int_equal(iso_surface_create(volume, NULL, &surface, NULL), ISO_OK);
    iso_render_opts opts = {.width = 64, .height = 48, .samples = 1};
    assert_int_equal(iso_render(surface, &opts, &plain, NULL), ISO_OK);
    opts.filter = ISO_FILTER_CUBIC;
    assert_int_equal(iso_render(surface, &opts, &smooth, NULL), ISO_OK);
    assert_memory_not_equal(plain.rgba, smooth.rgba, bytes_of(&plain));
    opts.method = ISO_METHOD_RAYCAST;
    assert_int_equal(iso_render(surface, &opts, &truth, NULL), ISO_OK);
    int hits = 0, missing = 0;
    const uint8_t white[4] = {255, 255, 255, 255};
    for (size_t i = 0; i < bytes_of(&truth); i += 4) {
        const bool covered = memcmp(smooth.rgba + i, white, 4) != 0;
        hits += memcmp(truth.rgba + i, white, 4) != 0;
        missing += !covered && memcmp(truth.rgba + i, white, 4) != 0;
        for (size_t k = i; covered && k < i + 4; k++)
            assert_in_range(smooth.rgba[k] - truth.rgba[k] + 1, 0, 2);
    }
    if (missing > hits / 100) fail_msg("%d of %d pixels are missing", missing, hits);
    opts.method = ISO_METHOD_MESH;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_USAGE);
    opts.method = ISO_METHOD_EXACT;
    opts.filter = (iso_filter)3;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_ERR_USAGE);
    opts.filter = ISO_FILTER_LINEAR;
    assert_int_equal(iso_render(surface, &opts, &other, NULL), ISO_OK);
    assert_memory_equal(plain.rgba, other.rgba, bytes_of(&plain));
    iso_image_free(&plain);
    iso_image_free(&smooth);
    iso_image_free(&truth);
    iso_image_free(&other);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(surfaces_are_colored_by_data),
                                       cmocka_unit_test(surfaces_are_smooth_by_a_filter)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
