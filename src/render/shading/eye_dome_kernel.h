/* eye_dome_kernel: finds the light of samples by the depths around them. Internal to eye_dome. */
#ifndef ISO_RENDER_SHADING_EYE_DOME_KERNEL_H
#define ISO_RENDER_SHADING_EYE_DOME_KERNEL_H

#include "base/cpu.h"
#include "render/shading/eye_dome.h"
#include "render/view/strip.h"

enum {
    TILE = 512, /* columns whose light is found together */
    SIDE = ISO_EYE_DOME_REACH * ISO_FACTOR_MAX,
    ROWS = 2 * ISO_EYE_DOME_RINGS + 1, /* of depths that a row of light needs */
    STRIDE = TILE + 2 * SIDE + ISO_LANES_MAX
};

/* What the rows have in common. */
typedef struct light_rows {
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int factor, first, last, bands;
} light_rows;

/* The depths around a part of a row: row ISO_EYE_DOME_RINGS is the row itself, and the others are those 1, 2,
 * 4 pixels above and below it. A part begins SIDE columns before its first sample. */
typedef float depths[ROWS][STRIDE];

/* The distance in pixels of row `number` from the row whose light is found. */
static inline int distance_of(int number) {
    const int step = number - ISO_EYE_DOME_RINGS;
    return step < 0 ? -(1 << (-step - 1)) : step > 0 ? 1 << (step - 1) : 0;
}

/* Finds the light of `count` samples: part[i] of sample i of the row in the middle of `around`. */
typedef void light_fn(const light_rows *r, const depths around, int count, float *part);
ISO_KERNEL_UNITS(light_fn, iso_eye_dome_light_samples);

#endif
