/* label_colors_kernel: in which cells of a grid the samples of a row lie. Internal to scene. */
#ifndef ISO_SCENE_LABEL_COLORS_KERNEL_H
#define ISO_SCENE_LABEL_COLORS_KERNEL_H

#include <stdint.h>

#include "base/cpu.h"

enum { ISO_LABEL_SAMPLES = 64 }; /* that are computed at a time */

/* The rays of a row of samples, in index coordinates: from origin + x * origin_step along direction + x *
 * direction_step, of column x. */
typedef struct iso_label_rays {
    double origin[3], origin_step[3], direction[3], direction_step[3];
    double most[3]; /* the greatest index of a cell */
} iso_label_rays;

typedef struct iso_label_samples {
    float depth[ISO_LABEL_SAMPLES];
    double place[3][ISO_LABEL_SAMPLES]; /* in index coordinates */
    int32_t cell[3][ISO_LABEL_SAMPLES]; /* around these, or the nearest one of the grid */
} iso_label_samples;

/* Computes places and cells of ISO_LABEL_SAMPLES samples from column x on, from their depths. */
typedef void iso_label_samples_fn(const iso_label_rays *rays, int x, iso_label_samples *samples);
ISO_KERNEL_UNITS(iso_label_samples_fn, iso_label_samples_place);

#endif
