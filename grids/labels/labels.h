/* labels: a volume of labels (a segmentation): each voxel has the number of the thing it belongs to, 0: the
 * background. What is known of each label: its voxels, its box. */
#ifndef ISO_GRIDS_LABELS_LABELS_H
#define ISO_GRIDS_LABELS_LABELS_H

#include <string.h>

#include "base/parallel.h"
#include "grids/grid.h"
#include "grids/parts/components.h"

enum { ISO_LABEL_VALUE_MAX = 65535 };

typedef struct iso_label {
    int value;        /* in the file, 0 .. ISO_LABEL_VALUE_MAX */
    uint64_t voxels;  /* how many have it */
    uint64_t runs;    /* and how many rows of them along x, which nothing interrupts */
    int lo[3], hi[3]; /* the box of these voxels, inclusive; of none: lo > hi */
    uint64_t sums[3]; /* of their index coordinates */
} iso_label;

/* Where the run of equal numbers that begins at x ends, in a row of n. */
static inline int iso_label_run_end(const uint16_t *row, int x, int n) {
    const uint16_t label = row[x];
    const uint64_t four = label * (uint64_t)0x0001000100010001;
    uint64_t next[4];
    for (; x + 16 <= n; x += 16) {
        memcpy(next, row + x, sizeof next);
        if (((next[0] ^ four) | (next[1] ^ four)) | ((next[2] ^ four) | (next[3] ^ four))) break;
    }
    for (; x + 4 <= n; x += 4) {
        memcpy(next, row + x, sizeof *next);
        if (next[0] != four) break;
    }
    while (x < n && row[x] == label) x++;
    return x;
}

/* Sets the numbers x .. end - 1 of a row. */
static inline void iso_label_fill(uint16_t *row, int x, int end, uint16_t label) {
    const uint64_t four[2] = {label * (uint64_t)0x0001000100010001, label * (uint64_t)0x0001000100010001};
    for (; x + 8 <= end; x += 8) memcpy(row + x, four, sizeof four);
    for (; x < end; x++) row[x] = label;
}

/* Zero-initialised it is empty. */
typedef struct iso_labels {
    int dims[3];
    iso_transform transform;
    uint16_t *number; /* of every voxel, x fastest: the place of its label in `label` */
    iso_label *label; /* by value, ascending; label[0] is the background, also if no voxel has it */
    int count;
} iso_labels;

/* The parts of each label (connected along the edges of the grid) that are kept: those that meet both. */
typedef struct iso_label_parts {
    size_t largest;    /* only this many of the largest of each label; 0: all */
    double min_volume; /* smallest volume, mm3; 0: any */
} iso_label_parts;

/* Makes a volume of labels of a grid of whole numbers; voxels that are NaN are background. `keep`: the voxels
 * of other parts are background, as `totals` counts them; NULL, and no totals: all are kept. iso_labels_free
 * when done. ISO_ERR_FORMAT: a voxel is no whole number from 0 to ISO_LABEL_VALUE_MAX, or the grid is a level
 * set; ISO_ERR_EMPTY: no part of a label is as large as asked; ISO_ERR_LIMIT: parts beyond 2^32;
 * ISO_ERR_NOMEM. `pool` may be NULL. */
iso_status iso_labels_make(const iso_grid *grid, iso_pool *pool, const iso_label_parts *keep,
                           iso_labels *labels, iso_components_totals *totals, iso_error *error);
void iso_labels_free(iso_labels *labels);

/* Which labels touch: have voxels that share a face. Zero-initialised it is empty. */
typedef struct iso_label_contacts {
    uint16_t (*pair)[2]; /* places in `label`, ascending; without the background */
    size_t count;
} iso_label_contacts;
/* iso_label_contacts_free when done. ISO_ERR_NOMEM. */
iso_status iso_labels_contacts(const iso_labels *labels, iso_label_contacts *contacts, iso_error *error);
void iso_label_contacts_free(iso_label_contacts *contacts);

/* Makes all voxels of the labels with group[place] != 0 voxels of the label at place `to`, and those of all
 * others background. The list of labels stays as it is. */
void iso_labels_join(iso_labels *labels, const uint8_t *group, int to);

/* The place of a value in `label`; -1: no voxel has it. */
int iso_labels_find(const iso_labels *labels, int value);

/* The label of a voxel, as its place in `label`; 0 outside the volume. */
static inline int iso_labels_at(const iso_labels *labels, int x, int y, int z) {
    const int *n = labels->dims;
    if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2]) return 0;
    return labels->number[((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x];
}

#endif
