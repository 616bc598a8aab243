/* smooth_kernel: the loops of label smoothing: distances to the voxels of a mask, and separable Gaussian
 * filters. Every instruction set gives the same bits.
 * Rows are read and written in whole vectors: all arrays have ISO_LABEL_SLACK more items than are used, and
 * the values of up to so many items behind the last result are lost.
 * Internal to grids/labels. */
#ifndef ISO_GRIDS_LABELS_SMOOTH_KERNEL_H
#define ISO_GRIDS_LABELS_SMOOTH_KERNEL_H

#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"

enum {
    ISO_LABEL_RADIUS = 7,      /* greatest of a filter */
    ISO_LABEL_REACH = 5,       /* distances up to this many voxels are exact */
    ISO_LABEL_FAR_SQUARE = 36, /* the squared distance of all voxels that are farther away */
    ISO_LABEL_SLACK = 64
};

/* Blocks of voxels have the sizes n[0] x n[1] x n[2], x fastest, without gaps. */
typedef struct iso_smooth_kernel {
    /* mask[i] = 0 where row[i] is the label, else ISO_LABEL_FAR_SQUARE. */
    void (*mask)(const uint16_t *row, int n, uint16_t label, uint8_t *mask);
    /* far[i] = the squared distance from voxel i to the nearest one with in[] == 0, of voxels with 0 or
     * ISO_LABEL_FAR_SQUARE; at most ISO_LABEL_FAR_SQUARE. `in` is larger than `far` by ISO_LABEL_REACH on all
     * six sides. `n`: of `far`. `work`: 2 bytes for each voxel of `in`. */
    void (*squares)(const uint8_t *in, const int n[3], uint8_t *work, uint8_t *far);
    /* signed_distance[i] = the distance to the border of a label, voxels: positive inside, where the squared
     * distance to the nearest voxel outside is not 0. The border lies half a voxel from voxels' centres. */
    void (*signed_distance)(const uint8_t *to_outside, const uint8_t *to_inside, size_t count,
                            float *signed_distance);
    /* out = the filter with the weights w[0], and w[k] at +-k for k = 1 .. radius, along all axes. `in` is
     * larger than `out` by `margin` >= radius on all six sides. n: of `out`. `work`: 2 floats for each voxel
     * of `in`. radius: 3, 4, 5 or 7. */
    void (*filter)(const float *in, const int n[3], int margin, int radius, const float *w, float *work,
                   float *out);
} iso_smooth_kernel;
ISO_KERNEL_UNITS(const iso_smooth_kernel, iso_smooth_kernel);

#endif
