/* Matcaps: pictures of lit spheres, computed from the colour of the surface, and colours looked up in them.
 */
#include "apps/isosculpt/viewport/shading.h"

#include <math.h>

enum { SIDE = ISOSCULPT_MATCAP_SIDE };

/* The state shared by the threads that shade rows. */
typedef struct matcap_pass {
    const iso_strip *strip;
    iso_image *image;
    iso_rgb background;
    const isosculpt_matcap *matcap;
} matcap_pass;

const char *isosculpt_shading_name(isosculpt_shading shading) {
#define SHADING_TEXT(name, text) text,
    static const char *const names[] = {ISOSCULPT_SHADINGS(SHADING_TEXT)};
#undef SHADING_TEXT
    return names[shading];
}

/* ---- making a matcap */

/* A smooth step from 0 at `low` to 1 at `high`. */
static double ramp(double low, double high, double value) {
    double t = fmin(fmax((value - low) / (high - low), 0), 1);
    return t * t * (3 - 2 * t);
}

static double eighth_power(double value) {
    value = fmax(value, 0);
    value *= value;
    value *= value;
    return value * value;
}

/* The colour at a normal (x right, y down, z towards the eye), as a share of the surface's colour and a share
 * of white light. */
typedef struct brightness {
    double surface, light;
} brightness;

static brightness brightness_of(isosculpt_shading shading, double x, double y, double z) {
    const double key = -0.45 * x - 0.62 * y + 0.64 * z; /* light from above left */
    switch (shading) {
    case ISOSCULPT_SHADING_CLAY: /* light from all around, dark where the surface faces down */
        return (brightness){0.30 + 0.80 * ramp(-0.7, 1, key), 0.10 * eighth_power(key)};
    case ISOSCULPT_SHADING_PEARL: /* a bright rim, as of thin material against the light */
        return (brightness){0.55 + 0.45 * ramp(-0.4, 1, key),
                            0.25 * eighth_power(1 - z) + 0.35 * eighth_power(key * key)};
    default: /* a dark room with two windows: shows every dent */
        return (brightness){0.22 + 0.30 * ramp(-1, 1, -y) + 0.45 * ramp(0.25, 0.7, key),
                            0.50 * ramp(0.80, 0.95, key) + 0.18 * ramp(0.55, 0.85, x + 0.4 * y)};
    }
}

static uint8_t mix_color(brightness b, uint8_t surface) {
    return (uint8_t)fmin(fmax(surface * b.surface + 255 * b.light, 0), 255);
}

static void make_matcap(const isosculpt_material *material, isosculpt_matcap *matcap) {
    const iso_rgb color = material->color;
    matcap->shading = material->shading;
    matcap->color = color;
    for (int row = 0; row < SIDE; row++)
        for (int column = 0; column < SIDE; column++) {
            double x = (column + 0.5) * 2 / SIDE - 1, y = (row + 0.5) * 2 / SIDE - 1, r = x * x + y * y;
            double z = r < 1 ? sqrt(1 - r) : 0, length = r < 1 ? 1 : sqrt(r);
            brightness b = brightness_of(material->shading, x / length, y / length, z);
            matcap->rgb[row][column][0] = mix_color(b, color.r);
            matcap->rgb[row][column][1] = mix_color(b, color.g);
            matcap->rgb[row][column][2] = mix_color(b, color.b);
        }
}

static bool matches(const isosculpt_matcap *matcap, const isosculpt_material *material) {
    return matcap->shading == material->shading && iso_rgb_equal(matcap->color, material->color);
}

/* ---- shading with a matcap */

static const uint8_t *look_up_color(const matcap_pass *pass, size_t sample) {
    const iso_gbuffer *gbuffer = pass->strip->gbuffer;
    float turned =
        gbuffer->normal[2][sample] > 0 ? -1.0f : 1.0f; /* the back of the surface is shaded like its front */
    int column = (int)((gbuffer->normal[0][sample] * turned * 0.5f + 0.5f) * SIDE);
    int row = (int)((gbuffer->normal[1][sample] * turned * 0.5f + 0.5f) * SIDE);
    column = column < 0 ? 0 : column >= SIDE ? SIDE - 1 : column;
    row = row < 0 ? 0 : row >= SIDE ? SIDE - 1 : row;
    return pass->matcap->rgb[row][column];
}

static void shade_pixel(const matcap_pass *pass, size_t first, uint8_t rgba[4]) {
    const iso_gbuffer *gbuffer = pass->strip->gbuffer;
    const int factor = pass->strip->factor;
    const uint8_t empty[3] = {pass->background.r, pass->background.g, pass->background.b};
    unsigned sum[3] = {0, 0, 0}, samples = (unsigned)(factor * factor);
    for (int y = 0; y < factor; y++)
        for (int x = 0; x < factor; x++) {
            size_t at = first + (size_t)y * (size_t)gbuffer->width + (size_t)x;
            const uint8_t *rgb = gbuffer->surface[at] == ISO_SURFACE_NONE ? empty : look_up_color(pass, at);
            for (int k = 0; k < 3; k++) sum[k] += rgb[k];
        }
    for (int k = 0; k < 3; k++) rgba[k] = (uint8_t)((sum[k] + samples / 2) / samples);
    rgba[3] = 255;
}

static void shade_row(void *context, size_t row, int worker) {
    (void)worker;
    const matcap_pass *pass = context;
    const size_t factor = (size_t)pass->strip->factor, width = (size_t)pass->image->width;
    const size_t first = row * factor * (size_t)pass->strip->gbuffer->width;
    uint8_t *out = pass->image->rgba + ((size_t)pass->strip->y0 + row) * width * 4;
    for (size_t x = 0; x < width; x++) shade_pixel(pass, first + x * factor, out + 4 * x);
}

const isosculpt_matcap *isosculpt_material_matcap(const isosculpt_material *material,
                                                  isosculpt_matcap *matcap) {
    if (material->shading == ISOSCULPT_SHADING_LAMPS) return NULL;
    if (!matches(matcap, material)) make_matcap(material, matcap);
    return matcap;
}

void isosculpt_material_strip(const isosculpt_material *material, isosculpt_matcap *matcap,
                              const iso_strip *strip, iso_image *image, iso_pool *pool) {
    const isosculpt_matcap *lit = isosculpt_material_matcap(material, matcap);
    if (!lit) {
        iso_shading shading = {
            .colors = &material->color, .color_count = 1, .background = material->background};
        iso_shade(&shading, strip, image, pool);
        return;
    }
    matcap_pass pass = {strip, image, material->background, lit};
    iso_parallel_for(pool, (size_t)(strip->gbuffer->height / strip->factor), shade_row, &pass);
}
