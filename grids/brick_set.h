/* brick_set: incremental extraction, shared by points, meshes and exact surfaces. A brick set follows a
 * grid's change log and stores the primitives that a kernel extracts from each brick. Internal to the
 * library.
 *
 * The kernel extracts single bricks. The set decides which bricks to extract, runs the kernel over threads
 * and stores the results in arrays, in the order of bricks for every number of threads. A brick is extracted
 * again only if voxels that it reads have changed (grids/halo.h), and then moves no other brick's data
 * (grids/spans.h). */
#ifndef ISO_GRIDS_BRICK_SET_H
#define ISO_GRIDS_BRICK_SET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "grids/brick_index.h"
#include "grids/grid.h"
#include "grids/grid_chunk.h"
#include "grids/halo.h"
#include "grids/spans.h"

/* Results are stored in two heaps (grids/spans.h): one of vertices, or points, and one of triangles. A heap
 * has parallel arrays, for example one of positions and one of edge keys. */
enum { ISO_SET_HEAPS = 2, ISO_SET_ARRAYS = ISO_SET_HEAPS * ISO_SPAN_ARRAYS };

/* The result of a kernel for one brick. items[heap * ISO_SPAN_ARRAYS + array] point into the scratch memory
 * of the worker; they are valid until the worker's next call of the kernel. */
typedef struct iso_brick_output {
    uint32_t count[ISO_SET_HEAPS];
    uint32_t own;      /* a number for write_span, for example of the vertices that the brick owns */
    uint32_t rejected; /* a number for statistics, added up in iso_brick_set.rejected */
    const void *items[ISO_SET_ARRAYS];
} iso_brick_output;

/* Where the results of a brick are stored: items first .. first + count - 1 of each heap. */
typedef struct iso_brick_location {
    int32_t brick[3];
    uint32_t own;
    uint32_t count[ISO_SET_HEAPS];
    size_t first[ISO_SET_HEAPS];
} iso_brick_location;

/* The output of a kernel that extracts several bricks in one call, brick after brick. */
typedef struct iso_brick_sink iso_brick_sink;

/* Returns memory for `count` items of an array, valid until the next call for this array. NULL: out of
 * memory. */
void *iso_brick_sink_room(iso_brick_sink *sink, int array, size_t count);
/* Assigns the next made->count items of the memory from iso_brick_sink_room to a brick (made->items is not
 * read). */
void iso_brick_sink_add(iso_brick_sink *sink, uint32_t brick, const iso_brick_output *made);
/* Whether memory has run out, so that the kernel can stop. */
bool iso_brick_sink_failed(const iso_brick_sink *sink);
/* Extracts a single brick with the kernel's `extract`. */
void iso_brick_sink_extract(iso_brick_sink *sink, uint32_t brick);

/* What a brick set extracts, and how: the sizes of the results and the callbacks that make them. `context` is
 * the pointer that was passed to iso_brick_set_init. */
typedef struct iso_brick_kernel {
    size_t item_bytes[ISO_SET_ARRAYS]; /* 0: no such array */
    size_t scratch_bytes;              /* of the scratch memory that each worker gets */
    size_t span_bytes;                 /* size of a span, as write_span writes it */
    iso_halo halo;
    /* Whether a brick may have results. Never false for a brick that has some. */
    bool (*may_exist)(const void *context, const int brick[3]);
    void (*extract)(const void *context, const int brick[3], void *scratch, iso_brick_output *output);
    /* Optional: extracts several bricks, for all of which may_exist is true. Each brick must be added to the
     * sink once, in the order of the list. */
    void (*extract_many)(const void *context, const uint32_t *bricks, size_t count, void *scratch,
                         iso_brick_sink *sink);
    /* Optional: returns the stored isovalue, if only bricks that it crosses have results. Those bricks of an
     * rgrid are then found with its index, and may_exist is called for edited bricks only. */
    float (*isovalue)(const void *context);
    bool bricks_only; /* empty cells of an hgrid have no results: may_exist is not called for them */
    /* Writes to *span, an element of the array of spans, where the results of a brick are stored. */
    void (*write_span)(void *span, const iso_brick_location *location);
} iso_brick_kernel;

typedef struct iso_brick_set {
    iso_brick_kernel kernel;
    const void *context;
    iso_grid grid;
    iso_pool *pool;
    int bricks[3];
    bool restricted;       /* to a chunk; else `region` is zero */
    iso_grid_chunk region; /* whose bricks are extracted; its origin is added to the numbers in write_span */
    bool full;             /* the next update extracts all bricks */
    uint64_t seen;         /* the last edit that the set includes */
    uint64_t stored;       /* number of results stored so far: the source of versions */
    uint32_t *span_of;     /* by brick: 1 + its span's number, 0: none */
    iso_buffer spans, slots, versions;
    size_t span_count;
    iso_span_heap heap[ISO_SET_HEAPS];
    iso_buffer scratch, list, chunks;
    iso_brick_query query;
    size_t extracted, rejected; /* bricks extracted by the last update; sum of iso_brick_output.rejected */
} iso_brick_set;

/* Initialises a set; `context`, the grid and the pool are borrowed until free. ISO_ERR_NOMEM. */
iso_status iso_brick_set_init(iso_brick_set *set, const iso_brick_kernel *kernel, const void *context,
                              const iso_grid *grid, iso_pool *pool, iso_error *error);
void iso_brick_set_free(iso_brick_set *set);

/* Restricts a new set to the bricks of a chunk, whose grid the set's grid is. write_span then gets the
 * whole's brick numbers; may_exist and extract still get those of the chunk's grid. Such a set does not
 * follow edits: it is updated once. */
void iso_brick_set_restrict(iso_brick_set *set, const iso_grid_chunk *region);

/* Extracts everything that has changed since the last update. ISO_ERR_NOMEM, ISO_ERR_IO (the pool's watch
 * has cancelled): the set is consistent, but some bricks are outdated or missing; the next update extracts
 * them. */
iso_status iso_brick_set_update(iso_brick_set *set, iso_error *error);

/* The size of the whole: of the grid, or of the volume whose chunk it is. */
const int *iso_brick_set_dims(const iso_brick_set *set);

/* Makes the next update extract all bricks. */
void iso_brick_set_reset(iso_brick_set *set);

/* Computes the position of a brick from its number, (z * bricks_y + y) * bricks_x + x. */
void iso_brick_set_coordinates(const iso_brick_set *set, uint32_t number, int brick[3]);

/* Returns the version of each span: a number, never 0, that changes when the content of the span changes or
 * the span becomes another brick's, but not when the content is only moved. NULL if there are no spans. */
const uint64_t *iso_brick_set_versions(const iso_brick_set *set);

/* Returns an array of a heap; NULL if it is empty. */
const void *iso_brick_set_items(const iso_brick_set *set, int heap, int array);

#endif
