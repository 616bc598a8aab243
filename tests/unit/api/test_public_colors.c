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

/* A sculpt that is painted all over is drawn as a plain one of that colour. */
static void sculpts_are_drawn_in_their_paint(void **state) {
    (void)state;
    const iso_rgb red = {200, 40, 30};
    const iso_brush brush = {.tool = ISO_TOOL_PAINT,
                             .falloff = ISO_FALLOFF_CONSTANT,
                             .strength = 1,
                             .radius = 25,
                             .has_color = true,
                             .color = red};
    const iso_sample sample = {.normal = {0, 0, 1}, .pressure = 1};
    const iso_sculpt_opts small = {.dims = {64, 64, 64}};
    const iso_surface_opts in_red = {.color = &red};
    iso_sculpt *sculpt;
    iso_surface *plain, *colored;
    iso_image wanted = {0}, drawn = {0}, before = {0};
    assert_int_equal(iso_sculpt_create(&small, &sculpt, NULL), ISO_OK);
    assert_int_equal(iso_surface_create(iso_sculpt_volume(sculpt), NULL, &plain, NULL), ISO_OK);
    assert_int_equal(iso_surface_create(iso_sculpt_volume(sculpt), &in_red, &colored, NULL), ISO_OK);
    iso_render_opts opts = {.width = 64, .height = 48, .samples = 1};
    assert_int_equal(iso_render(plain, &opts, &before, NULL), ISO_OK);
    const iso_method methods[] = {ISO_METHOD_EXACT, ISO_METHOD_MESH, ISO_METHOD_DISCS};
    iso_image reds[3] = {{0}};
    for (int i = 0; i < 3; i++) {
        opts.method = methods[i];
        assert_int_equal(iso_render(colored, &opts, &reds[i], NULL), ISO_OK);
    }
    assert_int_equal(iso_sculpt_begin(sculpt, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_sculpt_end(sculpt, NULL), ISO_OK);
    for (int i = 0; i < 3; i++) {
        iso_difference difference = {0};
        opts.method = methods[i];
        assert_int_equal(iso_render(plain, &opts, &drawn, NULL), ISO_OK);
        assert_int_equal(iso_compare_images(&reds[i], &drawn, NULL, &difference, NULL), ISO_OK);
        if (!(difference.psnr > 50)) fail_msg("method %d: %g dB", i, difference.psnr);
    }
    const iso_color_by by = {.source = ISO_COLOR_BY_NORMAL}; /* is instead of the paint */
    opts.method = ISO_METHOD_EXACT;
    opts.color_by = &by;
    opts.color_by_count = 1;
    assert_int_equal(iso_render(plain, &opts, &wanted, NULL), ISO_OK);
    assert_memory_not_equal(wanted.rgba, reds[0].rgba, bytes_of(&wanted));
    opts.color_by_count = 0;
    assert_int_equal(iso_sculpt_undo(sculpt, NULL), ISO_OK);
    assert_int_equal(iso_render(plain, &opts, &drawn, NULL), ISO_OK);
    assert_memory_equal(before.rgba, drawn.rgba, bytes_of(&before));
    iso_image *const images[] = {&wanted, &drawn, &before, &reds[0], &reds[1], &reds[2]};
    for (int i = 0; i < 6; i++) iso_image_free(images[i]);
    iso_surface_destroy(plain);
    iso_surface_destroy(colored);
    iso_sculpt_destroy(sculpt);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(surfaces_are_colored_by_data),
                                       cmocka_unit_test(sculpts_are_drawn_in_their_paint),
                                       cmocka_unit_test(surfaces_are_smooth_by_a_filter)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
