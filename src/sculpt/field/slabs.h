/* slabs: a pool of numbered bricks, for working memory. Growing never moves a brick. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_SLABS_H
#define ISO_SCULPT_FIELD_SLABS_H

#include "base/memory.h"
#include "base/primitives.h"

/* The number of bricks of a slab, which is allocated at once: 2 MiB, the size of a huge page. */
enum { ISO_SLAB_BRICKS = 128 };

/* Zero-initialise; iso_slabs_free when done. */
typedef struct iso_slabs {
    iso_buffer table; /* float *, one for each slab */
    size_t count;
} iso_slabs;

/* Makes room for bricks 0 .. bricks - 1. ISO_ERR_NOMEM: the bricks so far stay valid. */
iso_status iso_slabs_reserve(iso_slabs *slabs, size_t bricks, iso_error *error);
/* Writes to every page of all slabs, so that page faults happen now and not during a stroke. Overwrites the
 * bricks. */
void iso_slabs_prefault(iso_slabs *slabs);
void iso_slabs_free(iso_slabs *slabs);

/* Returns brick `number`, which must have been reserved; uninitialised. */
static inline float *iso_slabs_get(const iso_slabs *slabs, size_t number) {
    return ((float **)slabs->table.data)[number / ISO_SLAB_BRICKS] +
           number % ISO_SLAB_BRICKS * ISO_BRICK_VOXELS;
}

#endif
