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
    const iso_view view = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                           .focal = 5,
                           .cx = SIZE / 2,
                           .cy = SIZE / 2,
                           .width = SIZE,
                           .height = SIZE,
                           .orthographic = true,
                           .near = -1e300};
    const iso_rgb color = {0, 0, 0};
    const iso_shading shading = {.colors = &color, .color_count = 1};
    const iso_gbuffer size = {.width = SIZE, .height = SIZE};
    const iso_strip strip = {&view, &size, 1, 0};
    const iso_layer_picture picture = {.strip = &strip, .shading = &shading, .image = image};
    iso_layer_totals totals = {0};
    return iso_shade_gaussians(&gaussians, &picture, &totals, NULL);
}

static void refusals_are_reported(void **state) {
    (void)state;
    static uint8_t wanted[4 * SIZE * SIZE];
    iso_image image;
    assert_int_equal(iso_image_create(SIZE, SIZE, &image, NULL), ISO_OK);
    assert_int_equal(draw(&image), ISO_OK);
    memcpy(wanted, image.rgba, sizeof wanted);
    long place = 0;
    for (;; place++) {
        test_refuse_memory_after(place);
        const iso_status status = draw(&image);
        test_grant_memory();
        if (!test_refusals()) {
            assert_int_equal(status, ISO_OK);
            break;
        }
        assert_int_equal(status, ISO_ERR_NOMEM);
    }
    assert_int_equal(place, 9);
    assert_memory_equal(wanted, image.rgba, sizeof wanted);
    iso_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
