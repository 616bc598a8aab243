/* layers: lists of translucent surfaces. A renderer lists the surfaces behind each sample as fragments,
 * sorted by depth; the lists are then composited front to back into the picture (compose.h).
 *
 * A band of rows is listed at a time. Fragments of 64 neighbouring samples of a row are stored together, so
 * that compositing works on vectors of neighbours; only groups with many layers take more memory.
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

/* How much light passes a surface and its solid. */
typedef struct iso_translucency {
    float opacity; /* share of the light that the surface stops where it is seen face on, 0 .. 1 */
    bool constant; /* the opacity is the same at every angle. If not, the surface acts as a thin slab, which
                      stops more light from slanting rays: 1 - (1 - opacity)^(1 / cos) (Kay and Greenberg
                      1979) */
    float absorption_length; /* the solid absorbs light: mm after which 1/e of the light is left (Beer and
                                Lambert); what is absorbed becomes the surface's colour.
                                0: the solid is clear */
    int most_layers;         /* number of crossings along a ray that are drawn, from the nearest on; 0: all */
    float gap; /* where rays leave the solid by less than this before an opaque surface, mm, that surface is
                  its border, as between labels, and no layer of its own; 0: everywhere else */
} iso_translucency;

/* Compositing of a sample ends when less than this share of the light passes all layers so far. */
#define ISO_LAYER_CUT (1 / 512.0f)

/* A crossing of a surface behind a sample, as it is composited. */
typedef struct iso_fragment {
    float depth;    /* mm, counted from iso_layer_lists.middle */
    float opacity;  /* 0 .. 1; packing makes 1 a little less */
    float color[3]; /* shaded, 0 .. 1; in lists that are not composited the normal (view space) as (normal +
                       1) / 2 */
    int surface;    /* number of the surface, below ISO_LAYER_SURFACES */
    bool leaves;    /* the ray leaves the surface's solid; else it enters it */
} iso_fragment;

/* A fragment in 16 bytes, because the speed of listing is limited by memory. Colours are multiples of 1 /
 * ISO_LAYER_COLOR and opacities of 1 / ISO_LAYER_OPACITY, finer steps than those of a picture. Bits of
 * `words`, from the lowest of the first one: red 22, green 22, blue 22, leaves 1, surface 6, opacity 23. */
typedef struct iso_packed_fragment {
    float depth;
    uint32_t words[3];
} iso_packed_fragment;

enum {
    ISO_LAYER_SURFACES = 64, /* largest number of surfaces in a picture */
    ISO_LAYER_COLOR = (1 << 22) - 1,
    ISO_LAYER_OPACITY = 1 << 23,
    ISO_LAYER_GROUP = 64, /* samples that share a group */
    ISO_LAYER_CHUNK = 8   /* layers of a chunk */
};

/* A component of a normal is stored as (component + 1) * this. */
#define ISO_LAYER_NORMAL_SCALE 0.5f

static inline iso_packed_fragment iso_fragment_pack(const iso_fragment *fragment) {
    uint32_t color[3];
    for (int k = 0; k < 3; k++) {
        const float value = fragment->color[k];
        color[k] = (uint32_t)((value > 0 ? value < 1 ? value : 1 : 0) * ISO_LAYER_COLOR + 0.5f);
    }
    const uint32_t stops = (uint32_t)(fragment->opacity * ISO_LAYER_OPACITY + 0.5f),
                   opacity = stops < ISO_LAYER_OPACITY ? stops : ISO_LAYER_OPACITY - 1;
    return (iso_packed_fragment){.depth = fragment->depth,
                                 .words = {color[0] | color[1] << 22, color[1] >> 10 | color[2] << 12,
                                           color[2] >> 20 | (uint32_t)fragment->leaves << 2 |
                                               (uint32_t)fragment->surface << 3 | opacity << 9}};
}

static inline float iso_packed_opacity(const iso_packed_fragment *packed) {
    return (float)(packed->words[2] >> 9) * (1.0f / ISO_LAYER_OPACITY);
}

static inline bool iso_packed_leaves(const iso_packed_fragment *packed) {
    return packed->words[2] >> 2 & 1;
}

static inline iso_fragment iso_fragment_unpack(const iso_packed_fragment *packed) {
    const uint32_t mask = ISO_LAYER_COLOR, *words = packed->words;
    const uint32_t green = (words[0] >> 22 | words[1] << 10) & mask,
                   blue = (words[1] >> 12 | words[2] << 20) & mask;
    return (iso_fragment){.depth = packed->depth,
                          .opacity = iso_packed_opacity(packed),
                          .color = {(float)(words[0] & mask) * (1.0f / ISO_LAYER_COLOR),
                                    (float)green * (1.0f / ISO_LAYER_COLOR),
                                    (float)blue * (1.0f / ISO_LAYER_COLOR)},
                          .surface = (int)(words[2] >> 3 & (ISO_LAYER_SURFACES - 1)),
                          .leaves = iso_packed_leaves(packed)};
}

/* Computes the normal of a fragment that stores one instead of a colour; its length is 1 only
 * approximately. */
static inline void iso_fragment_normal(const iso_fragment *fragment, float normal[3]) {
    for (int k = 0; k < 3; k++) normal[k] = fragment->color[k] * (1 / ISO_LAYER_NORMAL_SCALE) - 1;
}

/* A few layers of a group's fragments. */
typedef struct iso_layer_chunk {
    iso_packed_fragment layer[ISO_LAYER_CHUNK][ISO_LAYER_GROUP];
    struct iso_layer_chunk *next; /* of deeper layers; or NULL */
} iso_layer_chunk;

/* The list of a sample. All members except `count` refer to the surface that is being listed. */
typedef struct iso_layer_list {
    float through; /* share of the light that passes the surface's fragments; 0 when nothing more of the
                      surface can be seen behind them */
    float last;    /* depth of the surface's last fragment, -INFINITY before the first; the lowest bit is set
                      if the ray leaves the solid there */
    int32_t own;   /* number of the surface's fragments */
    int32_t count; /* number of the fragments of all surfaces */
} iso_layer_list;

/* The lists of 64 neighbouring samples of a row: layer k of sample i is fragment i of the k-th layer. */
typedef struct iso_layer_group {
    iso_layer_list list[ISO_LAYER_GROUP];
    iso_layer_chunk *first; /* NULL: no fragment yet */
    uint64_t doubtful;      /* bit by sample: fragments of the pass may be wrong or missing */
    uint64_t unused[6];     /* aligns groups to cache lines */
} iso_layer_group;

/* The surface whose fragments are being listed. */
typedef struct iso_layer_pass {
    int surface;     /* its number */
    int most_layers; /* see iso_translucency */
    float gap;
    float tolerance; /* mm: two crossings in the same direction that are closer than this are one crossing,
                        found twice */
} iso_layer_pass;

/* The fragments of a band of rows. Not thread-safe. */
typedef struct iso_layer_lists {
    int width, rows, row_groups; /* samples; groups of a row */
    iso_layer_group *groups;     /* rows * row_groups */
    iso_layer_pass pass;
    /* NULL, or for each sample of the band the depth (mm) of the opaque surface there, behind which nothing
     * is listed. */
    const float *limit;
    float middle;             /* the depth (mm) that fragments' depths are counted from */
    size_t most_chunks;       /* limit of `chunks`; 0: none */
    size_t chunks;            /* in use */
    bool full;                /* fragments were left out: most_chunks was reached, or memory ran out */
    iso_layer_chunk **blocks; /* memory: arrays of chunks */
    size_t block_count;
} iso_layer_lists;

/* Makes room for a band of `rows` rows of `width` samples. Zero-initialise, iso_layer_lists_free when done.
 * ISO_ERR_NOMEM. */
iso_status iso_layer_lists_reserve(iso_layer_lists *lists, int width, int rows, iso_error *error);
void iso_layer_lists_free(iso_layer_lists *lists);

/* Empties the lists for a band of the reserved width and at most the reserved rows. */
void iso_layer_lists_clear(iso_layer_lists *lists, int rows);
/* Begins to list a surface. The surfaces of a picture may be listed in any order. */
void iso_layer_lists_begin(iso_layer_lists *lists, const iso_layer_pass *pass);
/* Removes the fragments of the pass from one sample, so that they can be listed again. row: counted from the
 * band's first row. */
void iso_layer_lists_restart(iso_layer_lists *lists, int x, int row);

/* Returns the chunk after *link, which is allocated if there is none; NULL, and lists->full is set, if there
 * is no memory. */
iso_layer_chunk *iso_layer_chunk_after(iso_layer_lists *lists, iso_layer_chunk **link);

static inline iso_layer_group *iso_layer_group_at(const iso_layer_lists *lists, int x, int row) {
    return &lists->groups[(ptrdiff_t)row * lists->row_groups + x / ISO_LAYER_GROUP];
}

/* Returns layer k of a group, which must exist. */
static inline iso_packed_fragment *iso_layer_at(const iso_layer_group *group, int k) {
    iso_layer_chunk *chunk = group->first;
    for (; k >= ISO_LAYER_CHUNK; k -= ISO_LAYER_CHUNK) chunk = chunk->next;
    return chunk->layer[k];
}

/* Returns layer k of a group, which is allocated if it is the next new one; NULL if there is no memory. */
static inline iso_packed_fragment *iso_layer_reserve(iso_layer_lists *lists, iso_layer_group *group, int k) {
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
                                    const iso_packed_fragment *fragment) {
    iso_layer_list *list = &group->list[column];
    int k = list->count;
    iso_packed_fragment *layer = iso_layer_reserve(lists, group, k);
    if (!layer) return;
    list->count++;
    if (list->own < k) /* fragments of other surfaces have to be moved */
        for (; k > 0; k--) {
            iso_packed_fragment *before = iso_layer_at(group, k - 1);
            if (before[column].depth <= fragment->depth) break;
            layer[column] = before[column];
            layer = before;
        }
    layer[column] = *fragment;
}

/* Marks a sample as doubtful: its fragments may be wrong or missing. */
static inline void iso_layer_doubt(iso_layer_lists *lists, int x, int row) {
    iso_layer_group_at(lists, x, row)->doubtful |= (uint64_t)1 << x % ISO_LAYER_GROUP;
}

/* Adds a crossing of the surface that is being listed. Crossings of one sample arrive front to back; a
 * crossing in the face between two cells may arrive twice, and the second one is dropped. doubtful: it is
 * uncertain whether this is a crossing, or whether it arrives only once. Returns whether the sample is done,
 * because nothing of the surface can be seen behind this crossing. x: sample in the row; row: counted from
 * the band's first row. */
static inline bool iso_layer_add_packed(iso_layer_lists *lists, int x, int row,
                                        const iso_packed_fragment *fragment, bool doubtful) {
    iso_layer_group *group = iso_layer_group_at(lists, x, row);
    const int column = x % ISO_LAYER_GROUP;
    iso_layer_list *list = &group->list[column];
    const uint32_t leaves = iso_packed_leaves(fragment);
    if (list->through < ISO_LAYER_CUT) return true;
    group->doubtful |= (uint64_t)doubtful << column;
    uint32_t last;
    memcpy(&last, &list->last, sizeof last);
    if ((last & 1) == leaves && fragment->depth - list->last < lists->pass.tolerance) return false;
    if (lists->limit) {
        const float limit = lists->limit[(ptrdiff_t)row * lists->width + x],
                    depth = fragment->depth + lists->middle;
        if (!(depth < limit)) {
            list->through = 0;
            return true;
        }
        if (leaves && !(depth < limit - lists->pass.gap)) return false;
    }
    iso_layer_insert(lists, group, column, fragment);
    memcpy(&last, &fragment->depth, sizeof last);
    last = (last & ~1u) | leaves;
    memcpy(&list->last, &last, sizeof last);
    list->through *= 1 - iso_packed_opacity(fragment);
    if (++list->own == lists->pass.most_layers) list->through = 0;
    return list->through < ISO_LAYER_CUT;
}

static inline bool iso_layer_add(iso_layer_lists *lists, int x, int row, const iso_fragment *fragment,
                                 bool doubtful) {
    const iso_packed_fragment packed = iso_fragment_pack(fragment);
    return iso_layer_add_packed(lists, x, row, &packed, doubtful);
}

/* Prefetches the memory that is read when a fragment is added to a sample. */
static inline void iso_layer_prefetch(const iso_layer_lists *lists, int x, int row) {
    const iso_layer_group *group = iso_layer_group_at(lists, x, row);
    __builtin_prefetch(&group->list[x % ISO_LAYER_GROUP], 1);
    __builtin_prefetch(&group->first);
}

/* Prefetches the memory that the next fragment of a sample will be written to. */
static inline void iso_layer_prefetch_next(const iso_layer_lists *lists, int x, int row) {
    const iso_layer_group *group = iso_layer_group_at(lists, x, row);
    const int column = x % ISO_LAYER_GROUP;
    int k = group->list[column].count;
    const iso_layer_chunk *chunk = group->first;
    for (; chunk && k >= ISO_LAYER_CHUNK; k -= ISO_LAYER_CHUNK) chunk = chunk->next;
    if (chunk) __builtin_prefetch(&chunk->layer[k][column], 1);
}

#endif
