/* Mixes the colours of voxels, in integers. */
#include "sculpt/field/paint.h"

#include <math.h>

#include "grids/grid.h"

/* A weight below this changes nothing: half of a 255th. */
enum { LEAST_WEIGHT = ISO_PAINT_ONE / 510 };

static int part_of_color(uint32_t color, int k) {
    return (int)(color >> 8 * k & 255);
}

/* Moves a value towards another one by part / whole of the way, at least by 1. */
static int64_t approach(int64_t from, int64_t to, int64_t part, int64_t whole) {
    const int64_t way = (to > from ? to - from : from - to) * part, step = (way + whole - 1) / whole;
    return to > from ? from + step : from - step;
}

uint32_t iso_paint_over(uint32_t color, uint32_t brush, int weight) {
    if (weight < LEAST_WEIGHT) return color;
    const int64_t amount = iso_paint_amount(color), full = brush ? 255 : 0,
                  now = approach(amount, full, weight, ISO_PAINT_ONE);
    unsigned rgb[3];
    /* what the layer and the colour below it contribute to the result */
    const int64_t above = 255 * (int64_t)weight, below = amount * (ISO_PAINT_ONE - weight);
    for (int k = 0; k < 3; k++)
        rgb[k] = (unsigned)(brush ? approach(part_of_color(color, k), part_of_color(brush, k), above,
                                             above + below)
                                  : part_of_color(color, k));
    return iso_paint_make(rgb[0], rgb[1], rgb[2], (unsigned)now);
}

/* Sums of colours that are weighted by their amounts, as whole numbers. */
typedef struct color_sums {
    uint64_t amount, part[3];
} color_sums;

static void add_color(color_sums *sums, uint32_t color, uint64_t weight) {
    const uint64_t amount = weight * iso_paint_amount(color);
    sums->amount += amount;
    for (int k = 0; k < 3; k++) sums->part[k] += amount * (uint64_t)part_of_color(color, k);
}

/* Divides the sums by the weights' sum. */
static uint32_t divide(const color_sums *sums, uint64_t weights) {
    unsigned rgb[3];
    if (!sums->amount) return 0;
    for (int k = 0; k < 3; k++) rgb[k] = (unsigned)((sums->part[k] + sums->amount / 2) / sums->amount);
    return iso_paint_make(rgb[0], rgb[1], rgb[2], (unsigned)((sums->amount + weights / 2) / weights));
}

uint32_t iso_paint_mean(const uint32_t *colors, int count) {
    color_sums sums = {0};
    for (int i = 0; i < count; i++) add_color(&sums, colors[i], 1);
    return count ? divide(&sums, (uint64_t)count) : 0;
}

uint32_t iso_paint_mix(const uint32_t corners[8], const uint32_t part[3]) {
    color_sums sums = {0};
    for (int k = 0; k < 8; k++) { /* (the sums are below 2^48 * 255 * 255 < 2^64) */
        uint64_t weight = 1;
        for (int axis = 0; axis < 3; axis++)
            weight *= k >> axis & 1 ? part[axis] : (uint32_t)ISO_PAINT_ONE - part[axis];
        add_color(&sums, corners[k], weight);
    }
    return divide(&sums, (uint64_t)1 << 48);
}

uint32_t iso_paint_voxel(const iso_paint_view *view, const int at[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (at[axis] < 0 || at[axis] >= ISO_BRICK * view->cells[axis]) return 0;
    const size_t cell = ((size_t)(at[2] / ISO_BRICK) * (size_t)view->cells[1] + (size_t)(at[1] / ISO_BRICK)) *
                            (size_t)view->cells[0] +
                        (size_t)(at[0] / ISO_BRICK);
    const iso_paint_item *item = (const iso_paint_item *)view->paint->cell[cell];
    return item ? item->voxel[(at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK) * ISO_BRICK +
                              at[0] % ISO_BRICK]
                : 0;
}

uint32_t iso_paint_at(const iso_paint_view *view, iso_vec3 place) {
    const double p[3] = {place.x, place.y, place.z};
    int low[3];
    uint32_t part[3], corners[8], any = 0;
    for (int axis = 0; axis < 3; axis++) {
        if (!(p[axis] > -1 && p[axis] < ISO_BRICK * (double)view->cells[axis])) return 0;
        const double down = floor(p[axis]);
        low[axis] = (int)down;
        part[axis] = (uint32_t)((p[axis] - down) * ISO_PAINT_ONE);
    }
    for (int k = 0; k < 8; k++) {
        const int at[3] = {low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2)};
        any |= corners[k] = iso_paint_voxel(view, at);
    }
    return any ? iso_paint_mix(corners, part) : 0;
}
