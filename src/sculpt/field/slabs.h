/* slabs: bricks to work in, by number. More of them never move those there are, so growing copies nothing and
 * costs a page or two of fresh memory at a time. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_SLABS_H
#define ISO_SCULPT_FIELD_SLABS_H

#include "base/memory.h"
#include "base/primitives.h"

/* Bricks of a slab: 2 MiB, a huge page. */
enum { ISO_SLAB_BRICKS = 128 };

/* Zero-initialise; iso_slabs_free when done. */
typedef struct iso_slabs {
    iso_buffer table; /* float *, one per slab */
    size_t count;
} iso_slabs;

/* Room for so many bricks in all. ISO_ERR_NOMEM keeps what there is. */
iso_status iso_slabs_reserve(iso_slabs *slabs, size_t bricks, iso_error *error);
/* Touches the memory of all slabs, for who has time now and not then. */
void iso_slabs_touch(iso_slabs *slabs);
void iso_slabs_free(iso_slabs *slabs);

static inline float *iso_slabs_brick(const iso_slabs *slabs, size_t number) {
    return ((float **)slabs->table.data)[number / ISO_SLAB_BRICKS] +
           number % ISO_SLAB_BRICKS * ISO_BRICK_VOXELS;
}

#endif
