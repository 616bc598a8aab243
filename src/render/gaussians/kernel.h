/* kernel: composites one Gaussian after the other into the samples of a tile. Internal to gaussians. */
#ifndef ISO_RENDER_GAUSSIANS_KERNEL_H
#define ISO_RENDER_GAUSSIANS_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"

enum { ISO_GAUSSIAN_TILE = 16 }; /* columns of a tile: a multiple of the lanes of all instruction sets */

/* A Gaussian in the picture, 64 bytes: its opacity at the offset (dx, dy) from the centre, in samples, is
 * opacity * 2^-(xx dx^2 + xy dx dy + yy dy^2). */
typedef struct iso_gaussian_ellipse {
    int32_t x, y; /* the sample of the centre; rows are those of the whole picture */
    float fx, fy; /* from that sample to the centre, 0 .. 1 */
    float xx, xy, yy;
    float opacity, color[3];
    float depth;             /* of the centre, view z in mm */
    int32_t first_x, last_x; /* samples outside of these columns .. */
    int32_t first_y, last_y; /* .. and rows get less than ISO_GAUSSIAN_LEAST */
} iso_gaussian_ellipse;

/* A band of rows of samples: planes of `stride` floats a row. */
typedef struct iso_gaussian_band {
    float *color[3], *through, *layers;
    size_t stride;
    int first, last;    /* rows of the whole picture */
    const float *depth; /* of the opaque surfaces, by sample, from row `first` on; NULL: there are none */
    size_t depth_stride;
    int width;
} iso_gaussian_band;

/* Adds a Gaussian to the samples of the tile that begins at column x, a multiple of the tile's width. */
typedef void iso_gaussian_add(const iso_gaussian_ellipse *ellipse, const iso_gaussian_band *band, int x);

/* Whether all samples of a tile are finished. */
typedef bool iso_gaussian_finished(const iso_gaussian_band *band, int x);

typedef struct iso_gaussian_kernel {
    iso_gaussian_add *add;
    iso_gaussian_finished *finished;
} iso_gaussian_kernel;
ISO_KERNEL_UNITS(const iso_gaussian_kernel, iso_gaussian_kernel);

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_gaussian_kernel *iso_gaussian_kernel_get(iso_cpu_level level);

#endif
