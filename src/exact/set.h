/* set: the definition of iso_exact: the crossed cells of a grid by brick, and their order. Internal to exact.
 */
#ifndef ISO_EXACT_SET_H
#define ISO_EXACT_SET_H

#include "exact/cells.h"
#include "exact/exact.h"
#include "grids/brick_set.h"
#include "grids/threshold.h"

struct iso_exact {
    iso_brick_set set; /* heap 0 of the brick set stores octants, heap 1 groups of corner values */
    iso_grid grid;     /* of a chunk, if only a chunk is drawn */
    /* Of the whole, which is the grid unless that is a chunk's. */
    int dims[3];
    iso_transform transform;
    int origin[3]; /* the brick of the whole that is the grid's first */
    iso_exact_opts opts;
    iso_threshold surface;
    iso_type type; /* of the corners */
    iso_exact_extract *extract;
    /* Arrays of uint32_t. order: the numbers of all spans, sorted by z, y, x of their bricks. rows: the index
     * in `order` of the first span of each row of the grid's bricks; row r = z * (number of bricks along y) +
     * y. One more entry marks the end. */
    iso_buffer order, rows;
    bool sorted; /* order and rows are up to date; false when there was no memory: nothing is drawn then */
    size_t cells;
};

/* Working memory for extracting a brick. */
typedef struct iso_exact_extraction {
    iso_exact_output output;
    /* voxels of the grid's type, at most as large as floats */
    float window[ISO_EXACT_LATTICE * ISO_EXACT_LATTICE * ISO_EXACT_LATTICE];
} iso_exact_extraction;

/* Finds the crossed cells of a brick of the grid; false: it has no cells at all. */
bool iso_exact_find_cells(const iso_exact *exact, const int brick[3], iso_exact_extraction *extraction);

/* An iso_exact of the cells of one brick at a time, which are extracted to be drawn and not stored. Large:
 * one for each worker. */
typedef struct iso_exact_single {
    iso_exact exact; /* whose only span is `span` */
    iso_exact_span span;
    iso_exact_extraction extraction;
} iso_exact_single;

static inline const iso_exact_span *iso_exact_spans(const iso_exact *exact) {
    return (const iso_exact_span *)exact->set.spans.data;
}
static inline const iso_exact_octant *iso_exact_octants(const iso_exact *exact) {
    return (const iso_exact_octant *)iso_brick_set_items(&exact->set, 0, 0);
}
/* The corner values of an octant's cells: eight planes of iso_exact_groups(cells) * ISO_EXACT_GROUP
 * values. */
static inline const void *iso_exact_corners(const iso_exact *exact, const iso_exact_span *span,
                                            const iso_exact_octant *octant) {
    const char *groups = (const char *)iso_brick_set_items(&exact->set, 1, 0);
    return groups + (span->group + octant->group) * iso_exact_group_bytes(exact->type);
}

#endif
