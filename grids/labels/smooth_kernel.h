/* smooth_kernel: the loops of label smoothing: which rows are needed, distances to the voxels of a mask,
 * separable Gaussian filters, and what is kept of them. Every instruction set gives the same bits. Rows are
 * read and written in whole vectors: all arrays have ISO_LABEL_SLACK more items than are used, and the values
 * of up to so many items behind the last result of a row are lost, which those of the next row replace. A set
 * of voxels of a row is a word of 64 bits, the first voxel lowest. Internal to grids/labels. */
#ifndef ISO_GRIDS_LABELS_SMOOTH_KERNEL_H
#define ISO_GRIDS_LABELS_SMOOTH_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"

enum {
    ISO_LABEL_RADIUS = 7, /* greatest of a filter */
    ISO_LABEL_REACH = 5,  /* distances up to this many voxels are exact */
    ISO_LABEL_FAR_SQUARE = (ISO_LABEL_REACH + 1) * (ISO_LABEL_REACH + 1), /* of all that are farther away */
    ISO_LABEL_ROW = 64,                                                   /* voxels of a row, at most */
    ISO_LABEL_SLACK = 64,
    ISO_LABEL_GUARD = ISO_LABEL_ROW * ISO_LABEL_RADIUS
};

/* What of a step's results is needed. */
enum {
    ISO_LABEL_RESULTS,   /* of the filter along y and x */
    ISO_LABEL_Z_PASS,    /* of the filter along z */
    ISO_LABEL_DISTANCES, /* and of the squared distances along y and x */
    ISO_LABEL_Z_SQUARES, /* of the squared distances along z */
    ISO_LABEL_MASK,
    ISO_LABEL_STEPS
};

/* A box of n[0] x n[1] x n[2] voxels, x fastest, in which the field of a label is computed; its distances
 * are needed up to `margin` around it, its mask up to ISO_LABEL_REACH around these. Which results are needed,
 * voxels lo .. hi - 1 of each row, of none lo = 255 and hi = 0, of row y, z at index (z + edge) * pitch + y +
 * edge with edge = margin + ISO_LABEL_REACH and pitch = n[1] + 2 edge. Before and behind the rows, arrays
 * have ISO_LABEL_GUARD items, which need nothing. */
typedef struct iso_label_box {
    int n[3], margin, radius; /* radius: of the filter; <= margin */
    uint8_t *lo[ISO_LABEL_STEPS], *hi[ISO_LABEL_STEPS];
} iso_label_box;

/* Two Gaussians: the weights w[0], and w[k] at +-k for k = 1 .. radius, along all axes; the filter is
 * (1 + back) * the first one - back * the second one, which is the wider one. */
typedef struct iso_label_filter {
    int radius[2]; /* 5 and 7, or 3 and 4 */
    float w[2][ISO_LABEL_RADIUS + 1];
    float back;
} iso_label_filter;

typedef struct iso_smooth_kernel {
    /* Which voxels of a row have the label; which have different labels in two rows. n: up to ISO_LABEL_ROW.
     */
    uint64_t (*equal)(const uint16_t *row, int n, uint16_t label);
    uint64_t (*differ)(const uint16_t *a, const uint16_t *b, int n);
    /* Makes every label of a row but 0 a 1. */
    void (*present)(uint16_t *row, int n);
    /* to = the voxels `from` of ny x nz rows and those up to `below` before and `above` behind them on each
     * axis; `work`: as many rows. */
    void (*spread)(const uint64_t *from, int ny, int nz, int below, int above, uint64_t *work, uint64_t *to);
    /* From which results are needed follows what else is. */
    void (*needs)(const iso_label_box *box);
    /* mask[i] = 0 where row[i] is the label, else UINT8_MAX. */
    void (*mask)(const uint16_t *row, int n, uint16_t label, uint8_t *mask);
    /* The squared distance d from each voxel to the nearest one whose mask[] is not the same, at most
     * ISO_LABEL_FAR_SQUARE: d where the mask is 0, else ~d. `work`: a byte for each voxel of the mask, and
     * ISO_LABEL_SLACK more. */
    void (*squares)(const uint8_t *mask, const iso_label_box *box, int8_t *work, int8_t *squares);
    /* The distance to the border of a label, voxels: positive inside. The border lies half a voxel from
     * voxels' centres. */
    void (*signed_distance)(const int8_t *squares, const iso_label_box *box, float *distance);
    /* out = the filter of the distances. `work`: 4 floats for each of these, and
     * ISO_LABEL_SLACK more for each of the four. */
    void (*filter)(const float *distance, const iso_label_box *box, const iso_label_filter *filter,
                   float *work, float *out);
    /* Adds the field of a label to what is known of the voxels `set` of a row: the field of their own
     * label and what it is less than the distance, the greatest one of others, the greatest one of a group.
     */
    void (*keep)(uint64_t set, const uint16_t *row, uint16_t label, const float *field, const float *distance,
                 float *own, float *loss, float *other, float *best);
    /* The same, of what nothing is known before, for two labels whose fields are opposite: `field` is that of
     * `label`. least: what fields are at least but those of voxels' own labels. best: of `label` and of the
     * other one. */
    void (*keep_pair)(uint64_t set, const uint16_t *row, uint16_t label, float least, const float *field,
                      const float *distance, float *own, float *loss, float *other, float *const best[2]);
    /* Sets the items `set` of a row. */
    void (*fill)(uint64_t set, float value, float *row);
    /* The voxels of a row with own < other - change, or loss > most. */
    uint64_t (*thin)(const float *own, const float *other, const float *loss, int n, float change,
                     float most);
    /* The voxels of a row with own < other + lead + weight * more; weight may be NULL. */
    uint64_t (*weak)(const float *own, const float *other, const float *weight, int n, float lead,
                     float more);
} iso_smooth_kernel;
ISO_KERNEL_UNITS(const iso_smooth_kernel, iso_smooth_kernel);

#endif
