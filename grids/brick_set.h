/* brick_set: the part that points and meshes share: a consumer of a grid's change log that keeps what a
 * kernel makes of each brick. Internal to the library.
 *
 * The kernel knows one brick and nothing of sets; the set knows which bricks to do, runs them over threads,
 * and gives their results places in arrays, in brick order whatever the thread count. A brick is extracted
 * again only when the log says that voxels which it reads have changed (grids/halo.h); a brick that grows
 * or shrinks moves no other (grids/spans.h). */
#ifndef ISO_GRIDS_BRICK_SET_H
#define ISO_GRIDS_BRICK_SET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "grids/brick_index.h"
#include "grids/grid.h"
#include "grids/halo.h"
#include "grids/spans.h"

/* Results come in heaps (vertices, triangles); a heap has parallel arrays (positions, keys). */
enum { ISO_SET_HEAPS = 2, ISO_SET_ARRAYS = ISO_SET_HEAPS * ISO_SPAN_ARRAYS };

/* What a kernel made of one brick: items[heap * ISO_SPAN_ARRAYS + array] lie in the worker's scratch until
 * its next call. */
typedef struct iso_brick_output {
    uint32_t count[ISO_SET_HEAPS];
    uint32_t own; /* handed on to the span */
    uint32_t rejected;
    const void *items[ISO_SET_ARRAYS];
} iso_brick_output;

/* Where a brick's results lie. */
typedef struct iso_brick_location {
    int32_t brick[3];
    uint32_t own;
    uint32_t count[ISO_SET_HEAPS];
    size_t first[ISO_SET_HEAPS];
} iso_brick_location;

/* Where a kernel that does several bricks at once puts what it makes, brick after brick. */
typedef struct iso_brick_sink iso_brick_sink;

/* Room for `count` items of an array; NULL when there is no memory. Valid until the next call for that array.
 */
void *iso_brick_sink_room(iso_brick_sink *sink, int array, size_t count);
/* The next made->count items of those rooms are the brick's (made->items is not read). */
void iso_brick_sink_add(iso_brick_sink *sink, uint32_t brick, const iso_brick_output *made);
/* Whether memory ran out: what is still to do can be left. */
bool iso_brick_sink_failed(const iso_brick_sink *sink);
/* Does a brick with the kernel's `extract`. */
void iso_brick_sink_extract(iso_brick_sink *sink, uint32_t brick);

/* What a kernel is. `context` is the set's owner. */
typedef struct iso_brick_kernel {
    size_t item_bytes[ISO_SET_ARRAYS]; /* 0: no such array */
    size_t scratch_bytes;              /* one worker's */
    size_t span_bytes;
    iso_halo halo;
    /* Whether the brick may have anything: never false wrongly. */
    bool (*may_exist)(const void *context, const int brick[3]);
    void (*extract)(const void *context, const int brick[3], void *scratch, iso_brick_output *output);
    /* Optional: several bricks of the list at once, none of which may_exist refuses. Each must come to the
     * sink once, in the order of the list. */
    void (*extract_many)(const void *context, const uint32_t *bricks, size_t count, void *scratch,
                         iso_brick_sink *sink);
    /* Optional: the stored isovalue, without whose crossing a brick has nothing. In an rgrid the bricks are
     * then found through the grid's index, and may_exist is asked of edited ones only. */
    float (*isovalue)(const void *context);
    bool bricks_only; /* cells of an hgrid that have no brick have nothing: may_exist need not be asked */
    void (*write_span)(void *span, const iso_brick_location *location);
} iso_brick_kernel;

typedef struct iso_brick_set {
    iso_brick_kernel kernel;
    const void *context;
    iso_grid grid;
    iso_pool *pool;
    int bricks[3];
    bool full;         /* the next update does all bricks */
    uint64_t seen;     /* edits up to this one are in the set */
    uint64_t stored;   /* results that got a place so far */
    uint32_t *span_of; /* by brick: 1 + its span's number, 0: none */
    iso_buffer spans, slots, versions;
    size_t span_count;
    iso_span_heap heap[ISO_SET_HEAPS];
    iso_buffer scratch, list, chunks;
    iso_brick_query query;
    size_t extracted, rejected;
} iso_brick_set;

/* Zero-initialised storage; `context` and grid are borrowed until free. */
iso_status iso_brick_set_init(iso_brick_set *set, const iso_brick_kernel *kernel, const void *context,
                              const iso_grid *grid, iso_pool *pool, iso_error *error);
void iso_brick_set_free(iso_brick_set *set);

/* Brings the set up to date. ISO_ERR_NOMEM: what is in the set is sound but older, or misses bricks; the next
 * update does everything that this one did not. */
iso_status iso_brick_set_update(iso_brick_set *set, iso_error *error);

/* The next update starts from nothing. */
void iso_brick_set_reset(iso_brick_set *set);

/* Where a brick lies, by its number ((z * bricks_y + y) * bricks_x + x). */
void iso_brick_set_coordinates(const iso_brick_set *set, uint32_t number, int brick[3]);

/* A number for each span, never 0, that changes whenever what is in the span does or another brick's comes
 * there. Not when it only moves. NULL when there is no span. */
const uint64_t *iso_brick_set_versions(const iso_brick_set *set);

/* An array of a heap; NULL when nothing is in it. */
const void *iso_brick_set_items(const iso_brick_set *set, int heap, int array);

#endif
