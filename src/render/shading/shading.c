/* shading: prepares colours, and shades bands of rows with all threads. The kernel is shading_kernel.c. */
#include "render/shading/shading.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "base/kernel_units.h"
#include "render/shading/phong_simd.h"
#include "render/shading/shading_kernel.h"
#include "render/view/project.h"

static iso_shade_params make_params(const iso_shading *shading, const iso_strip *strip,
                                    const iso_image *image) {
    const iso_rgb back = shading->background, ink = shading->ink;
    iso_shade_params params = {.strip = strip,
                               .one_color = true,
                               .transparent = shading->transparent,
                               .background = {(float)back.r / 255, (float)back.g / 255, (float)back.b / 255},
                               .ink = {(float)ink.r / 255, (float)ink.g / 255, (float)ink.b / 255},
                               .rgba = image->rgba + (size_t)strip->y0 * (size_t)image->width * 4};
    int last = shading->color_count - 1;
    for (int surface = 0; surface <= ISO_SURFACE_NONE; surface++) {
        iso_rgb color = shading->colors[surface < last ? surface : last];
        params.one_color &= iso_rgb_equal(color, shading->colors[0]);
        params.base[0][surface] = (float)color.r / 255;
        params.base[1][surface] = (float)color.g / 255;
        params.base[2][surface] = (float)color.b / 255;
    }
    const uint8_t opaque[4] = {back.r, back.g, back.b, 255};
    if (!shading->transparent) memcpy(params.empty, opaque, 4);
    return params;
}

typedef struct bands {
    const iso_shade_params *params;
    iso_shade_rows_fn *shade;
    int rows, count;
    atomic_size_t covered;
} bands;

static void shade_band(void *context, size_t index, int worker) {
    (void)worker;
    bands *b = context;
    iso_rows rows = iso_band_rows(b->rows, b->count, index);
    size_t covered = b->shade(b->params, rows.first, rows.last);
    atomic_fetch_add_explicit(&b->covered, covered, memory_order_relaxed);
}

size_t iso_shade(const iso_shading *shading, const iso_strip *strip, iso_image *image, iso_pool *pool) {
    assert(shading->color_count > 0 && strip->factor >= 1 && strip->factor <= ISO_FACTOR_MAX);
    assert(image->width * strip->factor == strip->gbuffer->width);
    const iso_shade_params params = make_params(shading, strip, image);
    int rows = strip->gbuffer->height / strip->factor;
    bands b = {&params, ISO_KERNEL_UNIT(iso_shade_rows, iso_cpu_best()), rows, iso_band_count(pool, rows), 0};
    iso_parallel_for(pool, (size_t)b.count, shade_band, &b);
    return atomic_load_explicit(&b.covered, memory_order_relaxed);
}

void iso_average_samples(const iso_shading *shading, const iso_shaded_samples *shaded, iso_image *image) {
    const int factor = shaded->factor;
    const iso_gbuffer size = {.width = image->width * factor, .height = shaded->rows * factor};
    const iso_strip strip = {.gbuffer = &size, .factor = factor, .y0 = shaded->y0};
    const iso_shade_params params = make_params(shading, &strip, image);
    ISO_KERNEL_UNIT(iso_average_rows, iso_cpu_best())(&params, shaded->samples);
}

/* Shades a vector (of the generic level) of equal samples, so that the model is implemented only once. */
/* open: the shares of the light, ambient and key, that reach the sample; NULL: all of it. */
static void shade_sample(const float normal[3], const float to_eye[3], iso_rgb color, const float *open,
                         float rgb[3]) {
    const float base[3] = {(float)color.r / 255, (float)color.g / 255, (float)color.b / 255};
    vf n[3], eye[3], b[3], out[3];
    for (int axis = 0; axis < 3; axis++) {
        n[axis] = v_set(normal[axis]);
        eye[axis] = v_set(to_eye[axis]);
        b[axis] = v_set(base[axis]);
    }
    if (open)
        phong_open(n, eye, b, v_set(open[0]), v_set(open[1]), out);
    else
        phong(n, eye, b, out);
    for (int c = 0; c < 3; c++) rgb[c] = out[c][0];
}

void iso_shade_sample(const float normal[3], const float to_eye[3], iso_rgb color, float rgb[3]) {
    shade_sample(normal, to_eye, color, NULL, rgb);
}

uint32_t iso_shade_pixel(const float normal[3], const float to_eye[3], iso_rgb color) {
    float rgb[3];
    shade_sample(normal, to_eye, color, NULL, rgb);
    const vf all[3] = {v_set(rgb[0]), v_set(rgb[1]), v_set(rgb[2])};
    return (uint32_t)pack_pixels(all, v_seti(255))[0];
}

void iso_shade_occluded(const float normal[3], const float to_eye[3], iso_rgb color, float ambient, float key,
                        float rgb[3]) {
    shade_sample(normal, to_eye, color, (const float[2]){ambient, key}, rgb);
}

iso_rgb iso_shading_palette(int surface) {
    static const iso_rgb palette[] = {{0xE5, 0xDC, 0xC8}, {0x8F, 0x2D, 0x2D}, {0x3F, 0x6F, 0xA8},
                                      {0x5B, 0x8E, 0x4B}, {0x7D, 0x5B, 0x9B}, {0xC7, 0x7A, 0x3A}};
    enum { COLORS = sizeof palette / sizeof *palette };
    return palette[surface % COLORS];
}

int32_t iso_shading_empty(const iso_shading *shading) {
    const iso_rgb back = shading->background;
    const uint8_t opaque[4] = {back.r, back.g, back.b, 255};
    int32_t word = 0;
    if (!shading->transparent) memcpy(&word, opaque, sizeof word);
    return word;
}
