/* label_colors_kernel: vectors of doubles, half as many as floats. */
#include "scene/label_colors_kernel.h"

#include <string.h>

#include "base/kernel.h"

enum { LANES = ISO_LANES / 2 };

typedef double vd __attribute__((vector_size(8 * LANES)));
typedef int64_t vl __attribute__((vector_size(8 * LANES)));
typedef float vh __attribute__((vector_size(4 * LANES)));
typedef int32_t vi __attribute__((vector_size(4 * LANES)));

ISO_INLINE vd set(double value) {
    return value - (vd){0};
}

ISO_INLINE vd choose(vl mask, vd a, vd b) {
    return (vd)(((vl)a & mask) | ((vl)b & ~mask));
}

void ISO_KERNEL_NAME(iso_label_samples_place)(const iso_label_rays *r, int x, iso_label_samples *s) {
    vd column;
    for (int i = 0; i < LANES; i++) column[i] = x + i;
    for (int i = 0; i < ISO_LABEL_SAMPLES; i += LANES, column += LANES) {
        vh depths;
        memcpy(&depths, s->depth + i, sizeof depths);
        const vd depth = __builtin_convertvector(depths, vd);
        for (int k = 0; k < 3; k++) {
            const vd origin = set(r->origin[k]) + set(r->origin_step[k]) * column,
                     direction = set(r->direction[k]) + set(r->direction_step[k]) * column,
                     place = origin + direction * depth, zero = set(0), most = set(r->most[k]),
                     inside = choose(place > zero, choose(place >= most, most, place), zero);
            const vi cell = __builtin_convertvector(inside, vi);
            memcpy(s->place[k] + i, &place, sizeof place);
            memcpy(s->cell[k] + i, &cell, sizeof cell);
        }
    }
}
