/* Phong's model (1975) with two lights that hang on the camera. */
#include "render/shading.h"

#include <math.h>
#include <string.h>

static const float AMBIENT = 0.16f, KEY = 0.58f, FILL = 0.34f, SPECULAR = 0.16f;
/* Directions to the lights, unit, view space (y down): from above left, 41 degrees off the axis; the eye. */
static const float KEY_LIGHT[3] = {-0.40f, -0.52f, -0.7547185f};
static const float FILL_LIGHT[3] = {0, 0, -1};

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float positive(float value) {
    return value > 0 ? value : 0;
}

/* value^32 */
static float lobe(float value) {
    for (int i = 0; i < 5; i++) value *= value;
    return value;
}

void iso_shade_sample(const float normal[3], const float to_eye[3], iso_rgb color, float rgb[3]) {
    float side = dot(normal, to_eye) < 0 ? -1.0f : 1.0f;
    const float n[3] = {side * normal[0], side * normal[1], side * normal[2]};
    float key = positive(dot(n, KEY_LIGHT)), fill = positive(dot(n, FILL_LIGHT));
    /* the mirrored light against the eye: (2 (n.l) n - l).v */
    float mirror = key > 0 ? positive(2 * key * dot(n, to_eye) - dot(KEY_LIGHT, to_eye)) : 0;
    float diffuse = (AMBIENT + KEY * key + FILL * fill) / 255, white = SPECULAR * lobe(mirror);
    const float base[3] = {color.r, color.g, color.b};
    for (int c = 0; c < 3; c++) {
        float value = base[c] * diffuse + white;
        rgb[c] = value < 1 ? value : 1;
    }
}

typedef struct shade {
    const iso_shading *shading;
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int factor, y0;
    iso_image *image;
} shade;

static void eye_direction(const iso_view *view, int x, int y, float out[3]) {
    out[0] = out[1] = 0;
    out[2] = -1;
    if (view->orthographic) return;
    float u = (float)((x + 0.5 - view->cx) / view->focal), v = (float)((y + 0.5 - view->cy) / view->focal);
    float length = sqrtf(u * u + v * v + 1);
    out[0] = -u / length;
    out[1] = -v / length;
    out[2] = -1 / length;
}

static iso_rgb surface_color(const iso_shading *shading, int surface) {
    int last = shading->color_count - 1;
    return shading->colors[surface < last ? surface : last];
}

/* Adds the samples of pixel (x, y) that show a surface to sum, and returns their number. */
static int gather(const shade *s, int x, int y, float sum[3]) {
    int covered = 0;
    for (int j = y * s->factor; j < (y + 1) * s->factor; j++) {
        size_t row = (size_t)j * (size_t)s->gbuffer->width;
        for (int i = x * s->factor; i < (x + 1) * s->factor; i++) {
            size_t index = row + (size_t)i;
            if (s->gbuffer->surface[index] == ISO_SURFACE_NONE) continue;
            float to_eye[3], rgb[3];
            eye_direction(s->view, i, j, to_eye);
            const float normal[3] = {s->gbuffer->normal[0][index], s->gbuffer->normal[1][index],
                                     s->gbuffer->normal[2][index]};
            iso_shade_sample(normal, to_eye, surface_color(s->shading, s->gbuffer->surface[index]), rgb);
            for (int c = 0; c < 3; c++) sum[c] += rgb[c];
            covered++;
        }
    }
    return covered;
}

static uint8_t to_byte(float value) {
    return (uint8_t)(value * 255 + 0.5f);
}

static void resolve(const shade *s, const float sum[3], int covered, uint8_t rgba[4]) {
    int samples = s->factor * s->factor;
    const iso_rgb back = s->shading->background;
    const uint8_t background[4] = {back.r, back.g, back.b, 255};
    if (covered == 0) {
        if (s->shading->transparent)
            memset(rgba, 0, 4);
        else
            memcpy(rgba, background, 4);
        return;
    }
    float part = (float)covered / (float)samples;
    for (int c = 0; c < 3; c++) {
        float mean = sum[c] / (float)covered;
        float over = mean * part + (float)background[c] / 255 * (1 - part);
        rgba[c] = to_byte(s->shading->transparent ? mean : over);
    }
    rgba[3] = s->shading->transparent ? to_byte(part) : 255;
}

static void shade_row(void *context, size_t row, int worker) {
    (void)worker;
    const shade *s = context;
    uint8_t *out = s->image->rgba + ((size_t)s->y0 + row) * (size_t)s->image->width * 4;
    for (int x = 0; x < s->image->width; x++) {
        float sum[3] = {0, 0, 0};
        int covered = gather(s, x, (int)row, sum);
        resolve(s, sum, covered, out + 4 * x);
    }
}

void iso_shade(const iso_shading *shading, const iso_view *view, const iso_gbuffer *gbuffer, int factor,
               int y0, iso_image *image, iso_pool *pool) {
    shade s = {shading, view, gbuffer, factor, y0, image};
    iso_parallel_for(pool, (size_t)(gbuffer->height / factor), shade_row, &s);
}
