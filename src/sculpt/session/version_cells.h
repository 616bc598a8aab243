/* version_cells: the contents of cells at a place of a list of strokes, and which of them an update has made
 * different: the part of versions.h below its walk along the lists.
 *
 * A version of distances is two deltas (cell_delta.h): what the stroke's touches changed, and what its end
 * did. A delta only says what is new where the stroke changed something, so that it stays true if other
 * voxels of the cell become different. Contents are therefore a chain of versions, from the content before
 * all strokes on; every ISO_VERSION_FRAMES versions or so one has the whole content as well. Internal to
 * src/sculpt/session. */
#ifndef ISO_SCULPT_SESSION_VERSION_CELLS_H
#define ISO_SCULPT_SESSION_VERSION_CELLS_H

#include "sculpt/field/cell_delta.h"
#include "sculpt/session/history.h"
#include "sculpt/session/version_store.h"
#include "sculpt/session/versions.h"

/* A part of a cell: its distances (0), or its item of a kind (1 + the kind). */
enum { ISO_PART_DISTANCES = 0, ISO_PARTS = 1 + ISO_ITEM_KINDS };
/* A part of a cell: ISO_PARTS times the cell's number, and the part. */
typedef uint32_t iso_cell_key;

enum { ISO_VERSION_FRAMES = 32, ISO_LISTS = 2 };
/* The serial of a content that is that of no version. */
#define ISO_NO_SERIAL UINT64_MAX

/* The content of a part of a cell after a stroke or before all of them. */
typedef struct iso_cell_version {
    iso_cell_key key;
    int32_t state;         /* as in iso_cell_change */
    uint64_t serial;       /* each content has its own; 0: before all strokes */
    uint32_t touches, end; /* sizes of the deltas of the stroke's touches and of its end; of an item, which is
                              whole: its size, and 0 */
    uint32_t frame_size, depth; /* depth: versions since the last one with a frame */
    uint8_t *bytes;             /* the deltas, one after the other, or the item; in the store */
    uint8_t *frame; /* the whole content, as a delta from an empty cell outside, in the store; NULL:
                       there is none */
    const struct iso_cell_version *before[ISO_LISTS]; /* by list: the version before; NULL: the first */
    struct iso_cell_version *next;                    /* of the chain that is being followed */
} iso_cell_version;

/* A stroke as it was drawn. */
typedef struct iso_drawn {
    unsigned number;
    iso_brush brush;
    size_t path;                /* iso_stroke.path */
    iso_cell_version *versions; /* what it wrote */
    size_t count;
    iso_index_box *cells; /* all that it can read; the first contains the others */
    iso_index_box *reads; /* the voxels whose distances its touches read */
    size_t cell_count, read_count;
    bool fine; /* it read and wrote nothing but distances, and its touches wrote only within `reads` */
    bool kept; /* by the update that is being made */
} iso_drawn;

/* A part of a cell whose content differs between the lists, at this place. */
typedef struct iso_dirty {
    iso_cell_key key;
    bool unknown;        /* it may also be the same */
    uint64_t held;       /* of the version that `old` holds */
    float *old;          /* the distances of the old list; NULL: not looked at */
    iso_voxel_bits bits; /* the distances that differ, if !unknown */
} iso_dirty;

struct iso_versions {
    iso_hgrid *grid; /* the work grid; each cell is at some time of the list: see `held` */
    iso_editor *editor;
    iso_history *history; /* of the stroke that is being drawn: keeps what its cells were, for MOVE */
    iso_versions_check *check;
    void *context;
    size_t keys;
    iso_cell_version **first; /* by key: the content before all strokes; NULL: never written */
    uint64_t *held;           /* by key: the serial of the version in the work grid */
    const iso_cell_version **before, **after; /* by key: at this place of the old and of the new list; NULL:
                                            `first` */
    iso_dirty *dirty;
    uint32_t *dirty_at; /* by key: 1 + its index in `dirty`; 0: clean */
    size_t dirty_count, dirty_room, old_bricks;
    iso_buffer spare; /* float *: bricks that were those of dirty cells */
    size_t spare_count;
    bool blind;   /* no stroke that comes can be kept: what differs is found out at the end */
    int list_now; /* which of iso_cell_version.before is that of the present list, the old one of an update */
    iso_drawn **list; /* owned */
    size_t count;
    iso_version_store store;
    uint64_t serials;
    iso_versions_stats stats;
    float *constant[2]; /* bricks of +band and of -band */
    float *room;        /* a brick */
    iso_buffer stale;   /* iso_stale: what iso_versions_read_stale is to read */
    size_t stale_count;
    iso_pool *pool;
    /* of the stroke that is being drawn: */
    iso_buffer written; /* iso_draft */
    size_t written_count;
    iso_buffer packed;        /* the deltas of its touches */
    iso_buffer ranges, reads; /* iso_index_box */
    size_t range_count, read_count;
    struct cast_cache *cache; /* of iso_versions_cast; NULL until it is needed */
};

/* Distances that a cell of the work grid is to have, and the serial of those that it has. */
typedef struct iso_stale {
    const iso_cell_version *version;
    uint64_t held;
} iso_stale;

/* What a stroke that is being drawn has written. */
typedef struct iso_draft {
    iso_cell_key key;
    uint32_t touches; /* size of the delta of its touches */
    size_t at;        /* of it in iso_versions.packed */
} iso_draft;

static inline uint32_t iso_cell_of_key(iso_cell_key key) {
    return key / ISO_PARTS;
}
static inline int iso_part_of_key(iso_cell_key key) {
    return (int)(key % ISO_PARTS);
}
static inline const iso_cell_version *iso_or_first(const iso_versions *v, iso_cell_key key,
                                                   const iso_cell_version *at) {
    return at ? at : v->first[key];
}
static inline bool iso_index_box_holds(const iso_index_box *box, const int at[3]) {
    return at[0] >= box->lo[0] && at[0] <= box->hi[0] && at[1] >= box->lo[1] && at[1] <= box->hi[1] &&
           at[2] >= box->lo[2] && at[2] <= box->hi[2];
}
/* The number in iso_cell_version.before of the list that an update makes. */
static inline int iso_list_made(const iso_versions *v) {
    return 1 - v->list_now;
}

iso_status iso_versions_no_memory(iso_error *error);
/* The items of the work grid that a key is one of; NULL: it is of distances. */
iso_cell_items *iso_versions_items(const iso_versions *v, iso_cell_key key);
/* The distances that a cell has in the work grid. */
const float *iso_work_distances(const iso_versions *v, uint32_t cell);

/* ---- versions */

void iso_version_free(iso_versions *v, iso_cell_version *at);
void iso_drawn_free(iso_versions *v, iso_drawn *drawn); /* NULL is fine */
/* Gives a version of distances its deltas, which are copied, and its frame if it is time for one: of `whole`,
 * its content, if state is 0. depth: that of the version before, or 0. ISO_ERR_NOMEM. */
iso_status iso_version_set(iso_versions *v, iso_cell_version *at, const uint8_t *touches, const uint8_t *end,
                           uint32_t depth, const float *whole, iso_error *error);
/* Gives a version the item that its key has in the work grid. ISO_ERR_NOMEM. */
iso_status iso_version_set_item(iso_versions *v, iso_cell_version *at, iso_error *error);
/* Makes the content before all strokes that of the work grid, unless it is known. ISO_ERR_NOMEM. */
iso_status iso_version_keep_first(iso_versions *v, iso_cell_key key, iso_error *error);

/* Writes the distances of a version of a list to a brick, which holds those of the version `held`. */
void iso_version_read(const iso_versions *v, const iso_cell_version *at, int list, uint64_t held,
                      float *brick);
/* Writes an item. */
void iso_version_read_item(const iso_versions *v, const iso_cell_version *at, void *item);
/* Bring a key of the work grid to this place of the new list; _later_: distances with the next
 * iso_versions_read_stale, which reads those of all such cells in parallel. ISO_ERR_NOMEM. */
iso_status iso_versions_restore_later(iso_versions *v, iso_cell_key key, iso_error *error);
void iso_versions_read_stale(iso_versions *v);
iso_status iso_versions_restore(iso_versions *v, iso_cell_key key, iso_error *error);

/* ---- what differs */

void iso_versions_clear_dirty(iso_versions *v);
/* Finds out whether a key differs now; while the update is blind, only notes it. ISO_ERR_NOMEM. */
iso_status iso_versions_judge(iso_versions *v, iso_cell_key key, iso_error *error);
void iso_versions_set_clean(iso_versions *v, iso_cell_key key);
/* Finds out the same of all keys that were only noted. ISO_ERR_NOMEM. */
iso_status iso_versions_settle(iso_versions *v, iso_error *error);
/* The distances of a dirty cell at this place of the old list. */
const float *iso_dirty_old(iso_versions *v, iso_dirty *dirty);

/* ---- drawing (version_draw.c) */

/* Draws a stroke at this place of the new list. *out: it, also if it fails (or NULL). The errors of touches;
 * ISO_ERR_NOMEM. */
iso_status iso_versions_draw(iso_versions *v, const iso_stroke *stroke, iso_drawn **out, iso_error *error);

/* How what differs concerns a stroke as it was drawn. */
typedef enum iso_concern {
    ISO_CONCERN_NONE,   /* it comes out the same */
    ISO_CONCERN_END,    /* its touches change the same voxels, but its end may not */
    ISO_CONCERN_TOUCHES /* it has to be drawn again */
} iso_concern;
iso_status iso_versions_find_concern(iso_versions *v, const iso_drawn *drawn, iso_concern *concern,
                                     iso_error *error);
/* Makes a copy of a stroke whose touches change the same, with its end as it is now. *out: it, also if it
 * fails (or NULL). ISO_ERR_NOMEM. */
iso_status iso_versions_end_again(iso_versions *v, const iso_drawn *drawn, iso_drawn **out, iso_error *error);

#endif
