/* shading_kernel: what shading_kernel_body.inc needs. A unit for each instruction set
 * (base/kernel_units.h). */
#include "render/shading/shading_kernel.h"

#include "render/shading/phong_vectors.h"

enum {
    TILE = 1024, /* columns of samples that are shaded in all rows before the next ones, so that their u stay
                    in the cache */
    SUMS = 4     /* red, green, blue, number of samples */
};

/* Samples of one row, from the first column of a tile on. */
typedef struct sample_row {
    const float *normal[3];
    const uint8_t *surface;
    const uint32_t *color;            /* iso_gbuffer.color, or NULL */
    const float *light;               /* iso_gbuffer.light, or NULL */
    const float *ambient, *key, *ink; /* of the gbuffer, or NULL */
    const float *u;                   /* the rays are (u, v, 1) */
    float v;
    size_t below; /* offset of the row below, which is prefetched; 0: none */
} sample_row;

static sample_row row_at(const iso_shade_params *params, const float *u, int x, int y) {
    const iso_gbuffer *g = params->strip->gbuffer;
    const iso_view *view = params->strip->view;
    size_t at = (size_t)y * (size_t)g->width + (size_t)x;
    return (sample_row){{g->normal[0] + at, g->normal[1] + at, g->normal[2] + at},
                        g->surface + at,
                        g->color ? g->color + at : NULL,
                        g->light ? g->light + at : NULL,
                        g->ambient ? g->ambient + at : NULL,
                        g->key ? g->key + at : NULL,
                        g->ink ? g->ink + at : NULL,
                        u,
                        iso_slope_of_row(view, y),
                        y + 1 < g->height ? (size_t)g->width : 0};
}

/* Copy of the last samples of a row, when they do not fill a vector; the rest shows no surface. */
typedef struct last_samples {
    float normal[3][ISO_LANES_MAX], light[ISO_LANES_MAX], ambient[ISO_LANES_MAX], key[ISO_LANES_MAX],
        ink[ISO_LANES_MAX], u[ISO_LANES_MAX];
    uint8_t surface[ISO_LANES_MAX];
    uint32_t color[ISO_LANES_MAX];
} last_samples;

static sample_row copy_last(const sample_row *row, int at, int count, last_samples *last) {
    *last = (last_samples){0};
    memset(last->surface, ISO_SURFACE_NONE, sizeof last->surface);
    size_t floats = (size_t)count * sizeof(float);
    for (int axis = 0; axis < 3; axis++) memcpy(last->normal[axis], row->normal[axis] + at, floats);
    memcpy(last->u, row->u + at, floats);
    memcpy(last->surface, row->surface + at, (size_t)count);
    if (row->light) memcpy(last->light, row->light + at, floats);
    if (row->ambient) memcpy(last->ambient, row->ambient + at, floats);
    if (row->key) memcpy(last->key, row->key + at, floats);
    if (row->ink) memcpy(last->ink, row->ink + at, floats);
    if (row->color) memcpy(last->color, row->color + at, (size_t)count * sizeof *last->color);
    return (sample_row){{last->normal[0], last->normal[1], last->normal[2]},
                        last->surface,
                        row->color ? last->color : NULL,
                        row->light ? last->light : NULL,
                        row->ambient ? last->ambient : NULL,
                        row->key ? last->key : NULL,
                        row->ink ? last->ink : NULL,
                        last->u,
                        row->v,
                        0};
}

/* Adds up the `factor` columns of each pixel. */
static void add_columns(float columns[SUMS][TILE + ISO_LANES_MAX], int factor, int pixels,
                        float sums[SUMS][TILE + ISO_LANES_MAX]) {
    for (int k = 0; k < SUMS; k++)
        for (int x = 0; x < pixels; x++) {
            float sum = columns[k][x * factor];
            for (int i = 1; i < factor; i++) sum += columns[k][x * factor + i];
            sums[k][x] = sum;
        }
}

#define ISO_KERNEL_BODY "render/shading/shading_kernel_body.inc"
#include "base/kernel_levels.inc"
