/* A picture of Gaussians that runs out of memory says so and leaks nothing: calls for memory are refused from
 * a chosen one on (the linker's --wrap). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "image/image.h"
#include "refused_memory.h"
#include "render/gaussians/gaussians.h"
#include "scene_support.h"

enum { COUNT = 40, SIZE = 50 };

static iso_status draw(iso_image *image) {
    static float positions[COUNT][3], axes[COUNT][9], opacities[COUNT];
    for (int i = 0; i < COUNT; i++) {
        positions[i][0] = (float)(i % 7) - 3;
        positions[i][1] = (float)(i / 7) - 3;
        positions[i][2] = 20;
        axes[i][0] = axes[i][4] = axes[i][8] = 0.5f;
        opacities[i] = 0.5f;
    }
    const iso_gaussians gaussians = {.positions = (const float(*)[3])positions,
                                     .axes = (const float(*)[9])axes,
                                     .opacities = opacities,
                                     .color = {200, 100, 50},
                                     .count = COUNT};
    const iso_view view = test_plain_view(SIZE, SIZE, true, 5);
    const iso_rgb color = {0, 0, 0};
    const iso_shading shading = {.colors = &color, .color_count = 1};
    const iso_gbuffer size = {.width = SIZE, .height = SIZE};
    const iso_strip strip = {&view, &size, 1, 0};
    const iso_layer_picture picture = {.strip = &strip, .shading = &shading, .image = image};
    iso_layer_totals totals = {0};
    return iso_shade_gaussians(&gaussians, &picture, &totals, NULL);
}

static iso_status draw_again(const void *context, iso_error *error) {
    iso_image *const *image = context;
    (void)error;
    return draw(*image);
}

static void refusals_are_reported(void **state) {
    (void)state;
    static uint8_t wanted[4 * SIZE * SIZE];
    iso_image image, *target = &image;
    assert_int_equal(iso_image_create(SIZE, SIZE, &image, NULL), ISO_OK);
    assert_int_equal(draw(&image), ISO_OK);
    memcpy(wanted, image.rgba, sizeof wanted);
    assert_int_equal(test_refuse_each(draw_again, &target, NULL), 9);
    assert_memory_equal(wanted, image.rgba, sizeof wanted);
    iso_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
