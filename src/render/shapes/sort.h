/* sort: orders points so that neighbours follow each other, and cuts the order into blocks. Internal to
 * shapes. */
#ifndef ISO_RENDER_SHAPES_SORT_H
#define ISO_RENDER_SHAPES_SORT_H

#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"

/* A counting sort into the cells of a grid, each of which becomes a block. A cell with too many points is
 * sorted again into a grid of its own, so that clustered points have small blocks too. */
typedef struct iso_shapes_sort {
    const float (*points)[3];
    uint32_t *order;       /* numbers of points; sorted in place */
    uint32_t *spare;       /* room for as many */
    uint32_t wanted, most; /* points of a block: on average, at most */
    iso_buffer firsts;     /* result: uint32_t, the first place in `order` of each block */
    size_t block_count;
} iso_shapes_sort;

/* Sorts order[0 .. count - 1]; the points that it names must be finite. The order of the points of a block
 * that have equal positions is kept. The caller frees `firsts`. ISO_ERR_NOMEM. */
iso_status iso_shapes_sort_run(iso_shapes_sort *sort, uint32_t count, iso_error *error);

#endif
