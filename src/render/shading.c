/* Phong's model (1975) with two lights that hang on the camera. */
#include "render/shading.h"

#include <math.h>
#include <string.h>

#include "base/simd.h"

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
    float diffuse = AMBIENT / 255 + KEY / 255 * key + FILL / 255 * fill, white = SPECULAR * lobe(mirror);
    const float base[3] = {color.r, color.g, color.b};
    for (int c = 0; c < 3; c++) {
        float value = base[c] * diffuse + white;
        rgb[c] = value < 1 ? value : 1;
    }
}

/* ---- a whole gbuffer: kernels shade runs of samples in a row with the same arithmetic */

enum {
    RUN = 512, /* samples at a time: small enough for the first cache */
    ROWS_PER_TASK = 16
};

struct shade_run;
/* Where byte k of a pixel in memory lies in a 32-bit number. */
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define BYTE_SHIFT(k) (8 * (k))
#else
#define BYTE_SHIFT(k) (24 - 8 * (k))
#endif

typedef struct shade {
    const iso_shading *shading;
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int factor, y0;
    iso_image *image;
    float base[3][256];  /* colours of surfaces */
    uint32_t background; /* bytes of a pixel in which nothing is seen */
    void (*samples)(const struct shade *s, struct shade_run *run);
    void (*pack)(const struct shade *s, const struct shade_run *run, uint8_t *rgba);
} shade;

/* Samples of one row. */
typedef struct shade_run {
    size_t index; /* of the first one in the gbuffer */
    int count;
    const float *u; /* x of the ray through each, at depth 1; not for orthographic views */
    float v;
    float rgb[3][RUN + ISO_LANES_MAX]; /* comes out, 0 .. 1; where nothing is seen it means nothing */
} shade_run;

#define ISO_LEVEL generic
#include "render/shading_body.inc"
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "render/shading_body.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "render/shading_body.inc"
#undef ISO_LEVEL
#endif

static void choose_kernels(shade *s) {
    s->samples = shade_samples_generic;
    s->pack = pack_pixels_generic;
#if ISO_HAVE_X86
    if (iso_cpu_best() == ISO_CPU_AVX2) {
        s->samples = shade_samples_avx2;
        s->pack = pack_pixels_avx2;
    } else if (iso_cpu_best() == ISO_CPU_AVX512) {
        s->samples = shade_samples_avx512;
        s->pack = pack_pixels_avx512;
    }
#endif
}

static void choose_colors(shade *s) {
    const iso_shading *shading = s->shading;
    for (int surface = 0; surface < 256; surface++) {
        int last = shading->color_count - 1;
        iso_rgb color = shading->colors[surface < last ? surface : last];
        s->base[0][surface] = color.r;
        s->base[1][surface] = color.g;
        s->base[2][surface] = color.b;
    }
    const iso_rgb back = shading->background;
    const uint8_t pixel[4] = {back.r, back.g, back.b, 255};
    if (!shading->transparent) memcpy(&s->background, pixel, 4);
}

static uint8_t to_byte(float value) {
    return (uint8_t)(value * 255 + 0.5f);
}

/* A pixel of several samples: the mean of those that show a surface, over the background. */
static void resolve(const shade *s, const float sum[3], int covered, uint8_t rgba[4]) {
    int samples = s->factor * s->factor;
    const iso_rgb back = s->shading->background;
    const float background[3] = {back.r, back.g, back.b};
    memcpy(rgba, &s->background, 4);
    if (covered == 0) return;
    float part = (float)covered / (float)samples;
    for (int c = 0; c < 3; c++) {
        float mean = sum[c] / (float)covered;
        float over = mean * part + background[c] / 255 * (1 - part);
        rgba[c] = to_byte(s->shading->transparent ? mean : over);
    }
    rgba[3] = s->shading->transparent ? to_byte(part) : 255;
}

/* Sums of the samples of each pixel, and how many there are. */
typedef struct pixel_sums {
    float rgb[RUN][3];
    int covered[RUN];
} pixel_sums;

static void add_samples(const shade *s, const shade_run *run, pixel_sums *sums) {
    const uint8_t *surface = s->gbuffer->surface + run->index;
    for (int i = 0, x = 0; i < run->count; x++)
        for (int end = i + s->factor; i < end; i++) {
            if (surface[i] == ISO_SURFACE_NONE) continue;
            for (int c = 0; c < 3; c++) sums->rgb[x][c] += run->rgb[c][i];
            sums->covered[x]++;
        }
}

/* Pixels first .. first + count - 1 of a row; u of their samples. */
static void shade_pixels(const shade *s, int row, int first, int count, const float *u) {
    uint8_t *out =
        s->image->rgba + (((size_t)s->y0 + (size_t)row) * (size_t)s->image->width + (size_t)first) * 4;
    shade_run run = {.count = count * s->factor, .u = u};
    pixel_sums sums;
    if (s->factor > 1) memset(&sums, 0, sizeof sums);
    for (int j = row * s->factor; j < (row + 1) * s->factor; j++) {
        run.index = (size_t)j * (size_t)s->gbuffer->width + (size_t)(first * s->factor);
        run.v = (float)((j + 0.5 - s->view->cy) / s->view->focal);
        s->samples(s, &run);
        if (s->factor == 1)
            s->pack(s, &run, out);
        else
            add_samples(s, &run, &sums);
    }
    for (int x = 0; s->factor > 1 && x < count; x++) resolve(s, sums.rgb[x], sums.covered[x], out + 4 * x);
}

static void shade_rows(void *context, size_t index, int worker) {
    (void)worker;
    const shade *s = context;
    int rows = s->gbuffer->height / s->factor, width = s->image->width, most = RUN / s->factor;
    int top = (int)index * ROWS_PER_TASK, bottom = top + ROWS_PER_TASK < rows ? top + ROWS_PER_TASK : rows;
    for (int first = 0; first < width; first += most) {
        int count = width - first < most ? width - first : most;
        float u[RUN];
        for (int i = 0; i < count * s->factor; i++)
            u[i] = (float)((first * s->factor + i + 0.5 - s->view->cx) / s->view->focal);
        for (int row = top; row < bottom; row++) shade_pixels(s, row, first, count, u);
    }
}

void iso_shade(const iso_shading *shading, const iso_view *view, const iso_gbuffer *gbuffer, int factor,
               int y0, iso_image *image, iso_pool *pool) {
    shade s = {
        .shading = shading, .view = view, .gbuffer = gbuffer, .factor = factor, .y0 = y0, .image = image};
    choose_kernels(&s);
    choose_colors(&s);
    size_t rows = (size_t)(gbuffer->height / factor);
    iso_parallel_for(pool, (rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK, shade_rows, &s);
}
