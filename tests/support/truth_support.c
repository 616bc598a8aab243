/* truth_support: PSNR, holes and dilation of a picture against the truth's. */
#include "truth_support.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

#include "image/image.h"
#include "render/shading/shading.h"
#include "view_support.h"

double test_psnr(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b) {
    const iso_rgb color = {0xD9, 0xB3, 0x6C};
    const iso_shading shading = {.colors = &color, .color_count = 1, .background = {40, 40, 60}};
    const iso_gbuffer *g[2] = {a, b};
    iso_image image[2];
    for (int k = 0; k < 2; k++) {
        assert_int_equal(iso_image_create(view->width, view->height, &image[k], NULL), ISO_OK);
        iso_strip strip = {view, g[k], 1, 0};
        iso_shade(&shading, &strip, &image[k], NULL);
    }
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)view->width * (size_t)view->height; i++) {
        if (a->surface[i] == ISO_SURFACE_NONE && b->surface[i] == ISO_SURFACE_NONE) continue;
        count += 3;
        for (int c = 0; c < 3; c++) {
            double d = image[0].rgba[4 * i + (size_t)c] - (double)image[1].rgba[4 * i + (size_t)c];
            sum += d * d;
        }
    }
    for (int k = 0; k < 2; k++) iso_image_free(&image[k]);
    return 10 * log10(255 * 255 / (sum / count));
}

size_t test_holes(const iso_gbuffer *truth, const iso_gbuffer *got, size_t *inside) {
    size_t missing = 0;
    *inside = 0;
    for (int y = 2; y < truth->height - 2; y++)
        for (int x = 2; x < truth->width - 2; x++) {
            bool in = true;
            for (int k = 0; k < 25; k++)
                in &= truth->surface[(y + k / 5 - 2) * truth->width + x + k % 5 - 2] != ISO_SURFACE_NONE;
            *inside += in;
            missing += in && got->surface[y * truth->width + x] == ISO_SURFACE_NONE;
        }
    return missing;
}

double test_dilation(const iso_gbuffer *truth, const iso_gbuffer *got) {
    size_t outline = 0;
    for (int y = 1; y < truth->height - 1; y++)
        for (int x = 1; x < truth->width - 1; x++) {
            const uint8_t *at = truth->surface + y * truth->width + x;
            bool open = at[-1] == ISO_SURFACE_NONE || at[1] == ISO_SURFACE_NONE ||
                        at[-truth->width] == ISO_SURFACE_NONE || at[truth->width] == ISO_SURFACE_NONE;
            outline += *at != ISO_SURFACE_NONE && open;
        }
    return outline ? ((double)test_covered(got) - (double)test_covered(truth)) / (double)outline : 0;
}
