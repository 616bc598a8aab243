/* layers: translucent surfaces. A renderer lists what it finds behind each sample as fragments, sorted by
 * depth; the lists are then composited front to back into the picture (compose.h).
 *
 * A band of rows is listed at a time. Fragments are stored for 64 neighbouring samples of a row together, so
 * that compositing works on vectors of neighbours; groups with many layers take more memory than others.
 *
 * Sources: Porter and Duff 1984, "Compositing digital images", for the composition; Carpenter 1984, "The
 * A-buffer, an antialiased hidden surface method", for sorted lists of fragments; Kay and Greenberg 1979,
 * "Transparency for computer synthesized images", for the opacity by angle. */
#ifndef ISO_RENDER_LAYERS_LAYERS_H
#define ISO_RENDER_LAYERS_LAYERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/parallel.h"
#include "base/status.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How light passes a surface and its solid. */
typedef struct iso_translucency {
    float opacity;   /* share of the light that the surface stops where it is seen face on, 0 .. 1 */
    bool constant;   /* the same share at every angle. Else the surface is a thin slab, of which slanting rays
                      pass more: it stops 1 - (1 - opacity)^(1 / cos) (Kay and Greenberg 1979) */
    float mean_path; /* mm of the solid after which 1/e of the light is left (Beer and Lambert); the rest of
                        it becomes the surface's colour. 0: the solid is clear */
    int most_layers; /* only the first so many crossings along a ray are drawn; 0: all */
} iso_translucency;

/* Compositing ends when less than this share of the light is left to see. */
#define ISO_LAYER_CUT (1 / 512.0f)

/* A crossing of a surface behind a sample. */
typedef struct iso_fragment {
    float depth;     /* mm, counted from iso_layer_lists.middle */
    float opacity;   /* 0 .. 1 */
    float color[3];  /* shaded, 0 .. 1; in lists that are not composited the normal (view space) */
    int32_t surface; /* number of the surface * 2, + 1 where the ray leaves its solid */
    float unused[2]; /* so that vectors of fragments are loaded in whole quads */
} iso_fragment;

enum {
    ISO_LAYER_GROUP = 64, /* samples that share a group */
    ISO_LAYER_CHUNK = 4,  /* layers of a chunk */
    ISO_FRAGMENT_FLOATS = sizeof(iso_fragment) / sizeof(float)
};

/* A few layers of a group's fragments. */
typedef struct iso_layer_chunk {
    iso_fragment layer[ISO_LAYER_CHUNK][ISO_LAYER_GROUP];
    struct iso_layer_chunk *next; /* of deeper layers; or NULL */
} iso_layer_chunk;

/* The lists of 64 neighbouring samples of a row: layer k of sample i is fragment i of the k-th layer. */
typedef struct iso_layer_group {
    iso_layer_chunk *first;          /* NULL: no fragment yet */
    uint64_t doubtful;               /* bit by sample: the fragments of the pass may not be right */
    uint16_t count[ISO_LAYER_GROUP]; /* number of fragments */
    /* Of the surface that is being listed: number of its fragments; share of the light that passes them, 0
     * when nothing of the surface can be seen behind them; depth of the last one, -INFINITY before the first,
     * with the lowest bit set when the ray leaves the solid there. */
    uint16_t own[ISO_LAYER_GROUP];
    float through[ISO_LAYER_GROUP], last[ISO_LAYER_GROUP];
} iso_layer_group;

/* The surface whose fragments are being listed. */
typedef struct iso_layer_pass {
    int surface;     /* its number */
    int most_layers; /* as iso_translucency.most_layers */
    float tolerance; /* mm: crossings in the same direction closer than this are one, found twice */
} iso_layer_pass;

/* The fragments of a band of rows. For one thread. */
typedef struct iso_layer_lists {
    int width, rows, row_groups; /* samples; groups of a row */
    iso_layer_group *groups;     /* rows * row_groups */
    iso_layer_pass pass;
    const float *limit; /* NULL, or depths (mm) by sample of the band that surfaces end at: of what is opaque
                         */
    float middle;       /* the depth (mm) that fragments' depths are counted from */
    size_t most_chunks; /* limit of `chunks`; 0: none */
    size_t chunks;      /* in use */
    bool full;          /* fragments were left out: most_chunks was reached, or memory ran out */
    iso_layer_chunk **blocks; /* memory: arrays of chunks */
    size_t block_count;
} iso_layer_lists;

/* Makes room for a band of `rows` rows of `width` samples. Zero-initialise, iso_layer_lists_free when done.
 * ISO_ERR_NOMEM. */
iso_status iso_layer_lists_reserve(iso_layer_lists *lists, int width, int rows, iso_error *error);
void iso_layer_lists_free(iso_layer_lists *lists);

/* Empties the lists for a band of the reserved width and at most the reserved rows. */
void iso_layer_lists_clear(iso_layer_lists *lists, int rows);
/* Begins to list a surface. Surfaces are listed one after the other, in any order of depth. */
void iso_layer_lists_begin(iso_layer_lists *lists, const iso_layer_pass *pass);
/* Removes the fragments of the pass from one sample, to list them anew. row: counted from the band's first.
 */
void iso_layer_lists_restart(iso_layer_lists *lists, int x, int row);

/* The next chunk after *link, allocated if there is none; NULL, and lists->full, without memory. */
iso_layer_chunk *iso_layer_chunk_after(iso_layer_lists *lists, iso_layer_chunk **link);

static inline iso_layer_group *iso_layer_group_at(const iso_layer_lists *lists, int x, int row) {
    return &lists->groups[(ptrdiff_t)row * lists->row_groups + x / ISO_LAYER_GROUP];
}

/* Layer k of a group, which has that many layers. */
static inline iso_fragment *iso_layer_at(const iso_layer_group *group, int k) {
    iso_layer_chunk *chunk = group->first;
    for (; k >= ISO_LAYER_CHUNK; k -= ISO_LAYER_CHUNK) chunk = chunk->next;
    return chunk->layer[k];
}

/* Layer k of a group, allocated if it is the first behind the last one; NULL without memory. */
static inline iso_fragment *iso_layer_reserve(iso_layer_lists *lists, iso_layer_group *group, int k) {
    iso_layer_chunk **link = &group->first;
    for (;; k -= ISO_LAYER_CHUNK) {
        iso_layer_chunk *chunk = *link ? *link : iso_layer_chunk_after(lists, link);
        if (!chunk) return NULL;
        if (k < ISO_LAYER_CHUNK) return chunk->layer[k];
        link = &chunk->next;
    }
}

/* Inserts a fragment by its depth; of equal depths the earlier one stays in front. */
static inline void iso_layer_insert(iso_layer_lists *lists, iso_layer_group *group, int column,
                                    const iso_fragment *fragment) {
    int k = group->count[column];
    iso_fragment *layer = k < UINT16_MAX ? iso_layer_reserve(lists, group, k) : NULL;
    if (!layer) return;
    group->count[column]++;
    if (group->own[column] < k) /* there are other surfaces' fragments */
        for (; k > 0; k--) {
            iso_fragment *before = iso_layer_at(group, k - 1);
            if (before[column].depth <= fragment->depth) break;
            layer[column] = before[column];
            layer = before;
        }
    layer[column] = *fragment;
}

/* Adds a crossing of the surface that is being listed. Those of one sample come front to back, but a crossing
 * in the face between two cells may come twice: the second one is dropped. doubtful: it is not certain that
 * this is a crossing, or that it comes only once. Returns whether the sample is done: nothing of the surface
 * can be seen behind this. x: sample in the row; row: counted from the band's first. */
static inline bool iso_layer_add(iso_layer_lists *lists, int x, int row, const iso_fragment *fragment,
                                 bool doubtful) {
    iso_layer_group *group = iso_layer_group_at(lists, x, row);
    const int column = x % ISO_LAYER_GROUP;
    const uint32_t leaves = (uint32_t)fragment->surface & 1;
    if (group->through[column] < ISO_LAYER_CUT) return true;
    group->doubtful |= (uint64_t)doubtful << column;
    uint32_t last;
    memcpy(&last, &group->last[column], sizeof last);
    if ((last & 1) == leaves && fragment->depth - group->last[column] < lists->pass.tolerance) return false;
    if (lists->limit &&
        !(fragment->depth + lists->middle < lists->limit[(ptrdiff_t)row * lists->width + x])) {
        group->through[column] = 0;
        return true;
    }
    iso_layer_insert(lists, group, column, fragment);
    memcpy(&last, &fragment->depth, sizeof last);
    last = (last & ~1u) | leaves;
    memcpy(&group->last[column], &last, sizeof last);
    group->through[column] *= 1 - fragment->opacity;
    if (++group->own[column] == lists->pass.most_layers) group->through[column] = 0;
    return group->through[column] < ISO_LAYER_CUT;
}

#ifdef __cplusplus
}
#endif
#endif
