/* caps_kernel: where the rays of a row of samples meet a plane that cuts a solid, and the volume's values
 * there. Internal to scene. */
#ifndef ISO_SCENE_CAPS_KERNEL_H
#define ISO_SCENE_CAPS_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
#include "grids/rgrid.h"

enum { ISO_CAP_BLOCK = 64 }; /* samples that are computed at a time */

/* A number that depends linearly on the column: first + x * next. */
typedef struct iso_cap_linear {
    double first, next;
} iso_cap_linear;

/* A solid that one plane cuts, for a row of samples. With the slope of a ray towards what is left, the ray
 * meets the plane at depth / slope, at the index coordinates place / slope. */
typedef struct iso_cap_row {
    iso_cap_linear slope, depth, place[3];
    int begin, end;         /* columns in which that can be in the volume */
    double near;            /* of the view */
    double low[3], high[3]; /* index coordinates between which there are caps */
    double last[3];         /* the index of the last voxel */
    int32_t origin[3];      /* the index of the first voxel of `grid`: a part of the volume, or 0 */
    const iso_rgrid *grid;  /* with at least two voxels on each axis; NULL: values are not asked for */
} iso_cap_row;

/* Where the rays meet the plane: by sample, in the order of columns. */
typedef struct iso_cap_block {
    double depth[ISO_CAP_BLOCK];    /* INFINITY: nowhere, or not behind the near plane */
    double place[3][ISO_CAP_BLOCK]; /* in index coordinates */
    double value[ISO_CAP_BLOCK];    /* stored; NAN: not between low and high, or beside a voxel without one */
} iso_cap_block;

/* A plane along the border lies in the volume, voxels. */
#define ISO_CAP_SLACK 1e-9

/* Computes `count` samples (at most ISO_CAP_BLOCK) from column x on; what is beyond them in the block is
 * undefined. All in double precision. */
typedef void iso_cap_kernel_fn(const iso_cap_row *row, int x, int count, iso_cap_block *block);
ISO_KERNEL_UNITS(iso_cap_kernel_fn, iso_cap_kernel);

/* How the caps of a solid are painted. */
typedef struct iso_cap_paint {
    double isovalue; /* stored; inside is at or above it, or below it in a level set */
    bool level_set;
    bool shows;                      /* the volume, in gray: at physical values low .. high */
    double scale, offset, low, high; /* physical = stored * scale + offset; low < high */
    uint32_t color, surface;         /* of caps that do not show it; what is written above the colour */
    float normal[3];
    int number; /* of the surface */
} iso_cap_paint;

/* Samples of a gbuffer, in a row. */
typedef struct iso_cap_samples {
    float *depth, *normal[3];
    uint32_t *color;
    uint8_t *surface;
} iso_cap_samples;

/* Paints the samples of a block that begin in the solid and are not behind what is drawn. Returns how many
 * of the samples have been looked at, the rest, less than a vector, is left. */
typedef int iso_cap_painter_fn(const iso_cap_block *block, int count, const iso_cap_paint *paint,
                               const iso_cap_samples *samples);
ISO_KERNEL_UNITS(iso_cap_painter_fn, iso_cap_painter);

#endif
