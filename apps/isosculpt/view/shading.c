#include "apps/isosculpt/view/shading.h"

#include <math.h>

enum { SIDE = ISOSCULPT_SPHERE };

typedef struct matcap {
    const iso_strip *strip;
    iso_image *image;
    iso_rgb background;
    const isosculpt_matcap *sphere;
} matcap;

const char *isosculpt_shading_name(isosculpt_shading light) {
#define LIGHT_TEXT(name, text) text,
    static const char *const names[] = {ISOSCULPT_SHADINGS(LIGHT_TEXT)};
#undef LIGHT_TEXT
    return names[light];
}

/* ---- spheres */

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

/* How bright the sphere is at normal (x, y down, z towards the eye), and how much of that is the light's
 * colour instead of the surface's. */
typedef struct brightness {
    double surface, light;
} brightness;

static brightness bright(isosculpt_shading light, double x, double y, double z) {
    const double key = -0.45 * x - 0.62 * y + 0.64 * z; /* from above left */
    switch (light) {
    case ISOSCULPT_SHADING_CLAY: /* light all around, dark in creases that look down */
        return (brightness){0.30 + 0.80 * ramp(-0.7, 1, key), 0.10 * eighth_power(key)};
    case ISOSCULPT_SHADING_PEARL: /* a bright rim, as thin things have against the light */
        return (brightness){0.55 + 0.45 * ramp(-0.4, 1, key),
                            0.25 * eighth_power(1 - z) + 0.35 * eighth_power(key * key)};
    default: /* a dark room with two windows: shows every dent */
        return (brightness){0.22 + 0.30 * ramp(-1, 1, -y) + 0.45 * ramp(0.25, 0.7, key),
                            0.50 * ramp(0.80, 0.95, key) + 0.18 * ramp(0.55, 0.85, x + 0.4 * y)};
    }
}

static uint8_t mixed(brightness b, uint8_t surface) {
    return (uint8_t)fmin(fmax(surface * b.surface + 255 * b.light, 0), 255);
}

static void make_sphere(const isosculpt_material *paint, isosculpt_matcap *sphere) {
    const iso_rgb color = paint->color;
    sphere->light = paint->light;
    sphere->color = color;
    for (int row = 0; row < SIDE; row++)
        for (int column = 0; column < SIDE; column++) {
            double x = (column + 0.5) * 2 / SIDE - 1, y = (row + 0.5) * 2 / SIDE - 1, r = x * x + y * y;
            double z = r < 1 ? sqrt(1 - r) : 0, length = r < 1 ? 1 : sqrt(r);
            brightness b = bright(paint->light, x / length, y / length, z);
            sphere->rgb[row][column][0] = mixed(b, color.r);
            sphere->rgb[row][column][1] = mixed(b, color.g);
            sphere->rgb[row][column][2] = mixed(b, color.b);
        }
}

static bool is_of(const isosculpt_matcap *sphere, const isosculpt_material *paint) {
    return sphere->light == paint->light && iso_rgb_equal(sphere->color, paint->color);
}

/* ---- looking up */

static const uint8_t *look_up(const matcap *cap, size_t sample) {
    const iso_gbuffer *gbuffer = cap->strip->gbuffer;
    float turned = gbuffer->normal[2][sample] > 0 ? -1.0f : 1.0f; /* both sides are seen */
    int column = (int)((gbuffer->normal[0][sample] * turned * 0.5f + 0.5f) * SIDE);
    int row = (int)((gbuffer->normal[1][sample] * turned * 0.5f + 0.5f) * SIDE);
    column = column < 0 ? 0 : column >= SIDE ? SIDE - 1 : column;
    row = row < 0 ? 0 : row >= SIDE ? SIDE - 1 : row;
    return cap->sphere->rgb[row][column];
}

static void shade_pixel(const matcap *cap, size_t first, uint8_t rgba[4]) {
    const iso_gbuffer *gbuffer = cap->strip->gbuffer;
    const int factor = cap->strip->factor;
    const uint8_t empty[3] = {cap->background.r, cap->background.g, cap->background.b};
    unsigned sum[3] = {0, 0, 0}, samples = (unsigned)(factor * factor);
    for (int y = 0; y < factor; y++)
        for (int x = 0; x < factor; x++) {
            size_t at = first + (size_t)y * (size_t)gbuffer->width + (size_t)x;
            const uint8_t *rgb = gbuffer->surface[at] == ISO_SURFACE_NONE ? empty : look_up(cap, at);
            for (int k = 0; k < 3; k++) sum[k] += rgb[k];
        }
    for (int k = 0; k < 3; k++) rgba[k] = (uint8_t)((sum[k] + samples / 2) / samples);
    rgba[3] = 255;
}

static void shade_row(void *context, size_t row, int worker) {
    (void)worker;
    const matcap *cap = context;
    const size_t factor = (size_t)cap->strip->factor, width = (size_t)cap->image->width;
    const size_t first = row * factor * (size_t)cap->strip->gbuffer->width;
    uint8_t *out = cap->image->rgba + ((size_t)cap->strip->y0 + row) * width * 4;
    for (size_t x = 0; x < width; x++) shade_pixel(cap, first + x * factor, out + 4 * x);
}

const isosculpt_matcap *isosculpt_material_matcap(const isosculpt_material *paint, isosculpt_matcap *sphere) {
    if (paint->light == ISOSCULPT_SHADING_LAMPS) return NULL;
    if (!is_of(sphere, paint)) make_sphere(paint, sphere);
    return sphere;
}

void isosculpt_material_strip(const isosculpt_material *paint, isosculpt_matcap *sphere,
                              const iso_strip *strip, iso_image *image, iso_pool *pool) {
    const isosculpt_matcap *lit = isosculpt_material_matcap(paint, sphere);
    if (!lit) {
        iso_shading shading = {.colors = &paint->color, .color_count = 1, .background = paint->background};
        iso_shade(&shading, strip, image, pool);
        return;
    }
    matcap cap = {strip, image, paint->background, lit};
    iso_parallel_for(pool, (size_t)(strip->gbuffer->height / strip->factor), shade_row, &cap);
}
