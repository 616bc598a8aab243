/* shading: whole gbuffers, at every level and for several threads, against one sample at a time. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "render/shading.h"

static const iso_rgb COLORS[3] = {{200, 100, 50}, {3, 255, 130}, {90, 90, 250}};

static uint32_t next(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static double uniform(uint32_t *seed) {
    return (double)next(seed) / (1 << 24);
}

/* Patches of four surfaces, one more than there are colours, and of nothing, where the normals are anything.
 */
static void fill(iso_gbuffer *g, uint32_t *seed) {
    static const float odd[] = {0, NAN, INFINITY, 1e30f};
    uint8_t surface = ISO_SURFACE_NONE;
    for (size_t i = 0; i < (size_t)g->width * (size_t)g->height; i++) {
        uint32_t choice = next(seed) % 24;
        if (choice < 5) surface = choice == 4 ? ISO_SURFACE_NONE : (uint8_t)choice;
        float square = 0;
        for (int axis = 0; axis < 3; axis++) {
            g->normal[axis][i] = (float)(uniform(seed) - 0.5);
            square += g->normal[axis][i] * g->normal[axis][i];
        }
        for (int axis = 0; axis < 3; axis++) g->normal[axis][i] /= sqrtf(square);
        if (surface == ISO_SURFACE_NONE || next(seed) % 50 == 0)
            g->normal[next(seed) % 3][i] = odd[next(seed) % 4];
        g->surface[i] = surface;
        g->depth[i] = 1;
    }
}

static uint8_t to_byte(float value) {
    return (uint8_t)(value * 255 + 0.5f);
}

static void reference_sample(const iso_shading *shading, const iso_view *view, const iso_gbuffer *g,
                             const int at[2], float rgb[3]) {
    size_t index = (size_t)at[1] * (size_t)g->width + (size_t)at[0];
    int surface = g->surface[index], last = shading->color_count - 1;
    float to_eye[3] = {0, 0, -1};
    if (!view->orthographic) {
        float u = (float)((at[0] + 0.5 - view->cx) / view->focal),
              v = (float)((at[1] + 0.5 - view->cy) / view->focal);
        float scale = -1 / sqrtf(u * u + v * v + 1);
        to_eye[0] = u * scale;
        to_eye[1] = v * scale;
        to_eye[2] = scale;
    }
    const float normal[3] = {g->normal[0][index], g->normal[1][index], g->normal[2][index]};
    iso_shade_sample(normal, to_eye, shading->colors[surface < last ? surface : last], rgb);
}

/* What the header promises of a pixel. */
static void reference_pixel(const iso_shading *shading, const iso_view *view, const iso_gbuffer *g,
                            int factor, const int pixel[2], uint8_t rgba[4]) {
    const uint8_t background[4] = {shading->background.r, shading->background.g, shading->background.b, 255};
    float sum[3] = {0, 0, 0};
    int covered = 0;
    for (int j = 0; j < factor; j++)
        for (int i = 0; i < factor; i++) {
            const int at[2] = {pixel[0] * factor + i, pixel[1] * factor + j};
            if (g->surface[(size_t)at[1] * (size_t)g->width + (size_t)at[0]] == ISO_SURFACE_NONE) continue;
            float rgb[3];
            reference_sample(shading, view, g, at, rgb);
            for (int c = 0; c < 3; c++) sum[c] += rgb[c];
            covered++;
        }
    float part = (float)covered / (float)(factor * factor);
    for (int c = 0; c < 3; c++) {
        float mean = covered ? sum[c] / (float)covered : 0;
        float over = mean * part + (float)background[c] / 255 * (1 - part);
        rgba[c] = to_byte(shading->transparent ? mean : over);
    }
    rgba[3] = shading->transparent ? to_byte(part) : 255;
}

typedef struct shading_case {
    int width, height, factor, transparent;
    bool orthographic;
} shading_case;

static void check_levels(const shading_case *c, const iso_view *view, const iso_gbuffer *g, iso_pool *pool) {
    const iso_shading shading = {COLORS, 3, {12, 200, 33}, c->transparent};
    iso_image image;
    assert_int_equal(iso_image_create(c->width, c->height, &image, NULL), ISO_OK);
    for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
        iso_cpu_limit((iso_cpu_level)level);
        memset(image.rgba, 77, (size_t)c->width * (size_t)c->height * 4);
        iso_shade(&shading, view, g, c->factor, 0, &image, pool);
        for (int y = 0; y < c->height; y++)
            for (int x = 0; x < c->width; x++) {
                const int pixel[2] = {x, y};
                uint8_t wanted[4];
                reference_pixel(&shading, view, g, c->factor, pixel, wanted);
                const uint8_t *got = image.rgba + ((size_t)y * (size_t)c->width + (size_t)x) * 4;
                for (int k = 0; k < 4; k++)
                    if (got[k] != wanted[k])
                        fail_msg("%s, %dx%d, %d samples: pixel %d, %d byte %d is %d, wanted %d",
                                 iso_cpu_level_name((iso_cpu_level)level), c->width, c->height,
                                 c->factor * c->factor, x, y, k, got[k], wanted[k]);
            }
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_image_free(&image);
}

static void every_level_shades_alike(void **state) {
    (void)state;
    static const shading_case cases[] = {
        {1, 1, 1, 0, false},    {3, 40, 1, 1, false},    {17, 5, 1, 0, true},
        {530, 35, 1, 0, false}, {1100, 19, 1, 1, false}, {16, 16, 2, 0, false},
        {300, 37, 2, 1, false}, {19, 7, 3, 0, true},     {70, 5, 8, 0, false},
    };
    uint32_t seed = 3;
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const shading_case *c = &cases[i];
        iso_gbuffer g;
        assert_int_equal(iso_gbuffer_create(c->width * c->factor, c->height * c->factor, &g, NULL), ISO_OK);
        fill(&g, &seed);
        iso_view view = {.focal = 0.9 * g.width,
                         .cx = 0.4 * g.width,
                         .cy = 0.7 * g.height,
                         .width = g.width,
                         .height = g.height,
                         .orthographic = c->orthographic};
        check_levels(c, &view, &g, NULL);
        check_levels(c, &view, &g, pool);
        iso_gbuffer_free(&g);
    }
    iso_pool_destroy(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_level_shades_alike)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
