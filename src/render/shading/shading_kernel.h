/* shading_kernel: shades rows of samples and averages them to pixels, once per instruction set, all with
 * the same result. Internal to render. */
#ifndef ISO_RENDER_SHADING_SHADING_KERNEL_H
#define ISO_RENDER_SHADING_SHADING_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"
#include "render/shading/shading.h"

/* What all rows of a strip have in common. */
typedef struct iso_shade_params {
    const iso_strip *strip;
    bool one_color; /* all surfaces have the same colour */
    bool transparent;
    float base[3][ISO_SURFACE_NONE + 1]; /* colours by surface, 0 .. 1 */
    float background[3], ink[3];         /* 0 .. 1 */
    uint8_t empty[4];                    /* the RGBA of a pixel that shows no surface */
    uint8_t *rgba;                       /* the strip's first row in the image */
} iso_shade_params;

/* Shades pixel rows first .. last of the strip; returns the number of samples that show a surface. */
typedef size_t iso_shade_rows_fn(const iso_shade_params *params, int first, int last);
ISO_KERNEL_UNITS(iso_shade_rows_fn, iso_shade_rows);

/* Averages shaded samples (iso_shaded_samples.samples, of the rows of `params->strip`) into the rows of
 * pixels of `params`. */
typedef void iso_average_rows_fn(const iso_shade_params *params, const int32_t *samples);
ISO_KERNEL_UNITS(iso_average_rows_fn, iso_average_rows);

#endif
