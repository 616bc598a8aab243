/* spans: a heap, which allocates ranges of a growing array (or of parallel arrays) for the primitives of
 * bricks.
 *
 * A block is a range of items for one brick. It is not moved while it is allocated, so an edit moves no other
 * brick's data. Freed blocks are joined with free neighbours and reused, smallest sufficient size class first
 * (segregated fits with eight classes an octave, as in Masmano et al. 2004, "TLSF"). The only exception: if
 * the array would grow beyond twice the items in use plus ISO_SPAN_HEAP_SLACK, all blocks are moved together
 * and `moved` is set. Internal to the library. */
#ifndef ISO_GRIDS_SPANS_H
#define ISO_GRIDS_SPANS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"

enum {
    ISO_SPAN_ARRAYS = 2, /* largest number of parallel arrays */
    ISO_SPAN_CLASSES = 512,
    ISO_SPAN_HEAP_SLACK = 1 << 15
};

#define ISO_SPAN_NONE UINT32_MAX

/* The record of a block, used or free. */
typedef struct iso_span_block {
    size_t first, capacity;  /* items */
    uint32_t before, after;  /* blocks before and after it in the array */
    uint32_t previous, next; /* in the list of free blocks of a class; `next` also links unused records */
    bool used;
} iso_span_block;

/* A heap. Initialise with zeros, set item_bytes (0: no such array), then call iso_span_heap_clear. */
typedef struct iso_span_heap {
    size_t item_bytes[ISO_SPAN_ARRAYS];
    iso_buffer array[ISO_SPAN_ARRAYS];
    iso_buffer records; /* of iso_span_block */
    size_t record_count;
    uint32_t unused, first, last;    /* first unused record; first and last block of the array */
    size_t end;                      /* items up to the end of the last block */
    size_t live;                     /* items in used blocks */
    uint32_t bins[ISO_SPAN_CLASSES]; /* the first free block of each size class */
    uint64_t
        occupied[ISO_SPAN_CLASSES / 64]; /* one bit for each class: whether bins[class] has a free block */
    bool moved; /* the heap sets it when it has moved all blocks together; its owner clears it */
} iso_span_heap;

/* Removes all blocks but keeps the memory. */
void iso_span_heap_clear(iso_span_heap *heap);
void iso_span_heap_free(iso_span_heap *heap);

/* Allocates a block of at least `count` >= 1 items, uninitialised. ISO_ERR_NOMEM: the heap is as before. */
iso_status iso_span_heap_alloc(iso_span_heap *heap, size_t count, uint32_t *block, iso_error *error);
void iso_span_heap_release(iso_span_heap *heap, uint32_t block);

/* Makes the items of a block beyond `count` a free block, if they are many. The block does not move. */
void iso_span_heap_trim(iso_span_heap *heap, uint32_t block, size_t count);

static inline const iso_span_block *iso_span_heap_block(const iso_span_heap *heap, uint32_t block) {
    return (const iso_span_block *)heap->records.data + block;
}

#endif
