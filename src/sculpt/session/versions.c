/* Keeps the versions of cells by stroke, and draws edited lists of strokes with them. */
#include "sculpt/session/versions.h"

#include <math.h>
#include <string.h>

#include "sculpt/brush/dab.h"
#include "sculpt/field/cell_pack.h"
#include "sculpt/session/history.h"
#include "sculpt/session/pen.h"
#include "sculpt/session/version_store.h"

/* A part of a cell: its distances (0), or its item of a kind (1 + the kind). */
enum { DISTANCES = 0, PARTS = 1 + ISO_ITEM_KINDS };
/* A part of a cell: PARTS times the cell's number, and the part. */
typedef uint32_t cell_key;

static uint32_t cell_of(cell_key key) {
    return key / PARTS;
}
static int part_of(cell_key key) {
    return (int)(key % PARTS);
}

/* The content of a part of a cell after a stroke or before all of them. */
typedef struct version {
    cell_key key;
    int32_t state;   /* as in iso_cell_change */
    uint32_t size;   /* of the packed values */
    uint64_t serial; /* each version has its own; 0: before all strokes */
    uint8_t *bytes;  /* in the store */
} version;

/* A stroke as it was drawn. */
typedef struct drawn {
    unsigned number;
    iso_brush brush;
    size_t path;       /* iso_stroke.path */
    version *versions; /* what it wrote */
    size_t count;
    iso_cell_box *ranges; /* of all that it can read; the first contains the others */
    size_t range_count;
    bool kept; /* by the update that is being made */
} drawn;

struct iso_versions {
    iso_hgrid *grid; /* the work grid; each cell is at some time of the list: see `held` */
    iso_editor *editor;
    iso_history *history; /* of the stroke that is being drawn: keeps what its cells were, for MOVE */
    iso_versions_check *check;
    void *context;
    size_t keys;
    version **first;                 /* by key: the content before all strokes; NULL: never written */
    uint64_t *held;                  /* by key: the serial of the version in the work grid */
    const version **before, **after; /* by key: at this place of the old and of the new list; NULL: `first` */
    cell_key *dirty;                 /* the keys whose contents differ */
    uint32_t *dirty_at;              /* by key: 1 + its index in `dirty`; 0: clean */
    size_t dirty_count;
    drawn **list; /* owned */
    size_t count;
    iso_version_store store;
    uint64_t serials;
    iso_versions_stats stats;
    /* of the stroke that is being drawn: */
    iso_buffer written; /* cell_key */
    size_t written_count;
    iso_buffer ranges; /* iso_cell_box */
    size_t range_count;
    struct cast_cache *cache; /* of iso_versions_cast; NULL until it is needed */
};

/* Bricks of versions, unpacked. */
enum { CACHED = 64 };
typedef struct cast_cache {
    const version *of[CACHED];
    float bricks[CACHED][ISO_BRICK_VOXELS];
} cast_cache;

/* ---- memory */

static void free_version(iso_versions *v, version *at) {
    iso_version_store_give(&v->store, at->bytes, at->size);
    at->bytes = NULL;
}

static void free_drawn(iso_versions *v, drawn *d) {
    if (!d) return;
    for (size_t i = 0; i < d->count; i++) free_version(v, &d->versions[i]);
    iso_free(d->versions);
    iso_free(d->ranges);
    iso_free(d);
}

void iso_versions_destroy(iso_versions *v) {
    if (!v) return;
    for (size_t i = 0; i < v->count; i++) free_drawn(v, v->list[i]);
    for (size_t i = 0; v->first && i < v->keys; i++) {
        if (v->first[i]) free_version(v, v->first[i]);
        iso_free(v->first[i]);
    }
    iso_version_store_free(&v->store);
    iso_history_destroy(v->history);
    iso_editor_destroy(v->editor);
    iso_hgrid_destroy(v->grid);
    iso_free(v->list);
    iso_free(v->first);
    iso_free(v->held);
    iso_free(v->before);
    iso_free(v->after);
    iso_free(v->dirty);
    iso_free(v->dirty_at);
    iso_buffer_free(&v->written);
    iso_buffer_free(&v->ranges);
    iso_free(v->cache);
    iso_free(v);
}

static iso_status no_memory(iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the versions of strokes");
}

static iso_status set_up(iso_versions *v, const iso_cell_items *paint, iso_pool *pool, iso_error *error) {
    const iso_editor_opts editor = {.pool = pool};
    ISO_TRY(iso_editor_create(v->grid, &editor, &v->editor, error));
    if (paint->cell) ISO_TRY(iso_editor_set_paint(v->editor, paint, error));
    const iso_history_opts history = {.items = iso_editor_items(v->editor)};
    ISO_TRY(iso_history_create(v->grid, &history, &v->history, error));
    v->keys = PARTS * iso_hgrid_cell_count(v->grid);
    v->first = iso_alloc_zero(v->keys, sizeof *v->first);
    v->held = iso_alloc_zero(v->keys, sizeof *v->held);
    v->before = iso_alloc_zero(v->keys, sizeof *v->before);
    v->after = iso_alloc_zero(v->keys, sizeof *v->after);
    v->dirty = iso_alloc_zero(v->keys, sizeof *v->dirty);
    v->dirty_at = iso_alloc_zero(v->keys, sizeof *v->dirty_at);
    return v->first && v->held && v->before && v->after && v->dirty && v->dirty_at ? ISO_OK
                                                                                   : no_memory(error);
}

iso_status iso_versions_create(iso_hgrid *first, const iso_cell_items *paint, size_t memory, iso_pool *pool,
                               iso_versions_check *check, void *context, iso_versions **versions,
                               iso_error *error) {
    iso_versions *v = iso_alloc_zero(1, sizeof *v);
    if (!v) {
        iso_hgrid_destroy(first);
        return no_memory(error);
    }
    v->grid = first;
    v->store.limit = memory;
    v->check = check;
    v->context = context;
    iso_status status = set_up(v, paint, pool, error);
    if (status == ISO_OK)
        *versions = v;
    else
        iso_versions_destroy(v);
    return status;
}

/* ---- versions of cells */

/* The items of the work grid that a key is one of; NULL: it is of distances. */
static iso_cell_items *items_of(const iso_versions *v, cell_key key) {
    return part_of(key) == DISTANCES ? NULL : &iso_editor_items(v->editor)->of[part_of(key) - 1];
}

/* Packs the content that a key has in the work grid. */
static iso_status pack(iso_versions *v, cell_key key, uint64_t serial, version *out, iso_error *error) {
    const iso_cell_items *items = items_of(v, key);
    const void *item = items ? items->cell[cell_of(key)] : NULL;
    const int32_t entry = v->grid->cell[cell_of(key)];
    const float *brick = !items && entry >= 0 ? iso_hgrid_brick(v->grid, entry) : NULL;
    *out = (version){.key = key, .serial = serial};
    if (!item && !brick) {
        out->state = items ? ISO_CELL_OUTSIDE : entry;
        return ISO_OK;
    }
    out->size =
        (uint32_t)(item ? iso_item_pack_size(item, items->bytes) : iso_cell_pack_size(brick, v->grid->band));
    out->bytes = iso_version_store_take(&v->store, out->size);
    if (!out->bytes) {
        out->size = 0;
        return no_memory(error);
    }
    if (item)
        iso_item_pack(item, items->bytes, out->bytes);
    else
        iso_cell_pack(brick, v->grid->band, out->bytes);
    return ISO_OK;
}

static bool is_same(const version *a, const version *b) {
    if (a == b) return true;
    if (!a || !b) return false; /* (`first` is there for every key that a stroke wrote) */
    return a->state == b->state && a->size == b->size &&
           (!a->size || memcmp(a->bytes, b->bytes, a->size) == 0);
}

static const version *or_first(const iso_versions *v, cell_key key, const version *at) {
    return at ? at : v->first[key];
}

/* Notes whether the contents of a key differ now. */
static void judge(iso_versions *v, cell_key key) {
    const bool dirty = !is_same(or_first(v, key, v->before[key]), or_first(v, key, v->after[key]));
    if (dirty == (v->dirty_at[key] > 0)) return;
    if (dirty) {
        v->dirty[v->dirty_count++] = key;
        v->dirty_at[key] = (uint32_t)v->dirty_count;
    } else {
        const cell_key last = v->dirty[--v->dirty_count];
        v->dirty[v->dirty_at[key] - 1] = last;
        v->dirty_at[last] = v->dirty_at[key];
        v->dirty_at[key] = 0;
    }
}

/* Moves a list on by a stroke. */
static void apply(iso_versions *v, const drawn *d, bool in_old, bool in_new) {
    for (size_t i = 0; i < d->count; i++) {
        const cell_key key = d->versions[i].key;
        if (in_old) v->before[key] = &d->versions[i];
        if (in_new) v->after[key] = &d->versions[i];
        judge(v, key);
    }
}

static void unpack(const iso_versions *v, const version *at, void *values) {
    const iso_cell_items *items = items_of(v, at->key);
    if (items)
        iso_item_unpack(at->bytes, at->size, items->bytes, values);
    else
        iso_cell_unpack(at->bytes, at->size, v->grid->band, values);
}

/* Brings a key of the work grid to this place of the new list. */
static iso_status restore(iso_versions *v, cell_key key, iso_error *error) {
    const version *at = or_first(v, key, v->after[key]);
    int where[3];
    float *brick;
    if (!at || v->held[key] == at->serial) return ISO_OK;
    if (part_of(key) != DISTANCES) {
        iso_paint_item item; /* the largest */
        if (at->size) unpack(v, at, &item);
        ISO_TRY(iso_cell_items_set(items_of(v, key), cell_of(key), at->size ? &item : NULL, error));
    } else {
        iso_hgrid_cell_position(v->grid, cell_of(key), where);
        if (at->size) {
            ISO_TRY(iso_hgrid_split(v->grid, where[0], where[1], where[2], &brick, error));
            unpack(v, at, brick);
        } else
            iso_hgrid_coalesce(v->grid, where[0], where[1], where[2], at->state);
    }
    v->held[key] = at->serial;
    return ISO_OK;
}

/* ---- drawing a stroke */

static iso_status note_written(iso_versions *v, cell_key key, iso_error *error) {
    const size_t bytes = v->written_count * sizeof key;
    ISO_TRY(iso_buffer_reserve(&v->written, bytes + sizeof key, bytes, error));
    if (!v->first[key]) { /* it has not been written before, so the work grid has what it was */
        version *first = iso_alloc_zero(1, sizeof *first);
        if (!first) return no_memory(error);
        const iso_status status = pack(v, key, 0, first, error);
        if (status != ISO_OK) {
            iso_free(first);
            return status;
        }
        v->first[key] = first;
    }
    ((cell_key *)v->written.data)[v->written_count++] = key;
    return ISO_OK;
}

static iso_status note_cell(void *context, uint32_t cell, int32_t state, const float *brick,
                            iso_error *error) {
    iso_versions *v = context;
    const iso_step_opts step = iso_history_step_opts(v->history);
    ISO_TRY(note_written(v, PARTS * cell, error));
    return step.observer.before(step.observer.context, cell, state, brick, error);
}

static iso_status note_item(void *context, iso_item_kind kind, uint32_t cell, void *item, iso_error *error) {
    iso_versions *v = context;
    const iso_step_opts step = iso_history_step_opts(v->history);
    ISO_TRY(note_written(v, PARTS * cell + 1 + (cell_key)kind, error));
    return step.observer.item_before(step.observer.context, kind, cell, item, error);
}

static const float *original(void *context, uint32_t cell, int32_t *state) {
    iso_versions *v = context;
    return iso_history_step_opts(v->history).original(v->history, cell, state);
}

static const iso_paint_item *original_paint(void *context, uint32_t cell, bool *kept) {
    iso_versions *v = context;
    return iso_history_step_opts(v->history).original_paint(v->history, cell, kept);
}

static bool contains(const iso_cell_box *outer, const iso_cell_box *inner) {
    bool within = true;
    for (int axis = 0; axis < 3; axis++)
        within &= inner->lo[axis] >= outer->lo[axis] && inner->hi[axis] <= outer->hi[axis];
    return within;
}

/* iso_pen.touch: adds the ranges of a touch to those of its stroke. */
static iso_status add_ranges(void *context, const iso_brush *brush, const iso_touch *touch,
                             iso_error *error) {
    iso_versions *v = context;
    iso_cell_box made[ISO_EDITOR_RANGES];
    ISO_TRY(iso_brush_check(brush, error));
    const int count = iso_editor_ranges(v->editor, brush, touch, made);
    const size_t recent = count > 8 ? 2 * (size_t)count : 16; /* those of the last two touches */
    ISO_TRY(iso_buffer_reserve(&v->ranges, (v->range_count + (size_t)count + 1) * sizeof *made,
                               v->range_count * sizeof *made, error));
    iso_cell_box *ranges = v->ranges.data;
    if (!v->range_count) ranges[v->range_count++] = made[0];
    for (int i = 0; i < count; i++) {
        bool known = false;
        for (size_t k = v->range_count; k-- > 1 && k + recent > v->range_count && !known;)
            known = contains(&ranges[k], &made[i]);
        for (int axis = 0; axis < 3; axis++) {
            if (made[i].lo[axis] < ranges[0].lo[axis]) ranges[0].lo[axis] = made[i].lo[axis];
            if (made[i].hi[axis] > ranges[0].hi[axis]) ranges[0].hi[axis] = made[i].hi[axis];
        }
        if (!known) ranges[v->range_count++] = made[i];
    }
    return ISO_OK;
}

static iso_status touch_work_grid(void *context, const iso_brush *brush, const iso_touch *touch,
                                  iso_error *error) {
    iso_versions *v = context;
    if (v->check) ISO_TRY(v->check(v->context, iso_editor_cost(v->editor), error));
    return iso_editor_touch(v->editor, brush, touch, NULL, error);
}

static iso_status follow(iso_versions *v, const iso_stroke *stroke,
                         iso_status (*touch)(void *, const iso_brush *, const iso_touch *, iso_error *),
                         iso_error *error) {
    iso_pen pen = {.touch = touch, .context = v};
    ISO_TRY(iso_pen_begin(&pen, &stroke->brush, &stroke->samples[0], error));
    for (size_t i = 1; i < stroke->count; i++) ISO_TRY(iso_pen_move(&pen, &stroke->samples[i], error));
    return iso_pen_end(&pen, stroke->samples, stroke->count, error);
}

/* Brings all that a stroke can read to this place of the new list. */
static iso_status restore_ranges(iso_versions *v, bool whole_mask, iso_error *error) {
    const iso_cell_box *ranges = v->ranges.data;
    for (size_t i = 1; i < v->range_count; i++)
        for (int z = ranges[i].lo[2]; z <= ranges[i].hi[2]; z++)
            for (int y = ranges[i].lo[1]; y <= ranges[i].hi[1]; y++) {
                const size_t row = iso_hgrid_cell_index(v->grid, 0, y, z);
                for (int x = ranges[i].lo[0]; x <= ranges[i].hi[0]; x++)
                    for (cell_key part = 0; part < PARTS; part++)
                        ISO_TRY(restore(v, (cell_key)(PARTS * (row + (size_t)x)) + part, error));
            }
    for (cell_key key = 1 + ISO_ITEM_MASK; whole_mask && key < v->keys; key += PARTS)
        ISO_TRY(restore(v, key, error));
    return ISO_OK;
}

/* Draws the stroke on the work grid, which is at its place. */
static iso_status draw_touches(iso_versions *v, const iso_stroke *stroke, iso_error *error) {
    iso_step_opts step = {.observer = {note_cell, note_item, v},
                          .original = original,
                          .original_paint = original_paint,
                          .stamp = stroke->stamp};
    v->written_count = 0;
    ISO_TRY(iso_history_begin(v->history, "", error));
    iso_editor_begin_step(v->editor, &step);
    iso_status status = follow(v, stroke, touch_work_grid, error);
    if (status == ISO_OK) status = iso_editor_finalize(v->editor, error);
    iso_history_forget(v->history);
    return status;
}

/* Packs what the stroke wrote. */
static iso_status keep_written(iso_versions *v, drawn *d, iso_error *error) {
    const cell_key *written = v->written.data;
    d->versions = iso_alloc(v->written_count * sizeof *d->versions);
    if (!d->versions && v->written_count) return no_memory(error);
    for (size_t i = 0; i < v->written_count; i++) {
        ISO_TRY(pack(v, written[i], ++v->serials, &d->versions[d->count], error));
        v->held[written[i]] = v->serials;
        d->count++;
    }
    return ISO_OK;
}

static iso_status draw_stroke(iso_versions *v, const iso_stroke *stroke, drawn **out, iso_error *error) {
    drawn *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return no_memory(error);
    *out = d;
    d->number = stroke->number;
    d->brush = stroke->brush;
    d->path = stroke->path;
    const iso_step_opts step = {.stamp = stroke->stamp}; /* whose size the ranges depend on */
    iso_editor_begin_step(v->editor, &step);
    v->range_count = 0;
    ISO_TRY(follow(v, stroke, add_ranges, error));
    d->ranges = iso_alloc(v->range_count * sizeof *d->ranges);
    if (!d->ranges) return no_memory(error);
    memcpy(d->ranges, v->ranges.data, v->range_count * sizeof *d->ranges);
    d->range_count = v->range_count;
    ISO_TRY(restore_ranges(v, iso_tool_is_whole_mask(stroke->brush.tool), error));
    iso_status status = draw_touches(v, stroke, error);
    const cell_key *written = v->written.data;
    for (size_t i = 0; i < v->written_count; i++) v->held[written[i]] = UINT64_MAX; /* of no version yet */
    if (status == ISO_OK) status = keep_written(v, d, error);
    v->stats.drawn += status == ISO_OK;
    return status;
}

/* ---- updating */

/* Whether a stroke reads a key that is dirty. */
static bool reads_dirty(const iso_versions *v, const drawn *d) {
    const bool whole_mask = iso_tool_is_whole_mask(d->brush.tool);
    for (size_t i = 0; i < v->dirty_count; i++) {
        iso_cell_box cell;
        if (whole_mask && part_of(v->dirty[i]) == 1 + ISO_ITEM_MASK) return true;
        iso_hgrid_cell_position(v->grid, cell_of(v->dirty[i]), cell.lo);
        memcpy(cell.hi, cell.lo, sizeof cell.hi);
        if (!contains(&d->ranges[0], &cell)) continue;
        for (size_t k = 1; k < d->range_count; k++)
            if (contains(&d->ranges[k], &cell)) return true;
    }
    return false;
}

/* An update: the strokes of the new list that are drawn, with the old ones that they keep. */
typedef struct update {
    iso_stroke **strokes;
    drawn **old;  /* by stroke: as it was drawn in the old list, in the same order there; NULL: not at all */
    drawn **made; /* by stroke: new, owned until the update succeeds; NULL: `old` is kept */
    size_t count;
} update;

static void free_update(iso_versions *v, update *u) {
    for (size_t i = 0; u->made && i < u->count; i++) free_drawn(v, u->made[i]);
    iso_free(u->strokes);
    iso_free(u->old);
    iso_free(u->made);
}

/* Finds the longest sequence of strokes that are in the same order in both lists; the others are drawn anew.
 * places: by stroke of the new list its place in the old one, or SIZE_MAX. Sets the others' to SIZE_MAX. */
static bool keep_longest_order(size_t *places, size_t count) {
    size_t *ends = iso_alloc(2 * count * sizeof *ends), *from = ends ? ends + count : NULL, length = 0;
    if (!ends) return false;
    for (size_t i = 0; i < count; i++) {
        size_t lo = 0, hi = length;
        if (places[i] == SIZE_MAX) continue;
        while (lo < hi) {
            const size_t middle = (lo + hi) / 2;
            if (places[ends[middle]] < places[i])
                lo = middle + 1;
            else
                hi = middle;
        }
        from[i] = lo ? ends[lo - 1] : SIZE_MAX;
        ends[lo] = i;
        length += lo == length;
    }
    size_t next = length ? ends[length - 1] : SIZE_MAX;
    for (size_t i = count; i-- > 0;)
        if (i == next)
            next = from[i];
        else
            places[i] = SIZE_MAX;
    iso_free(ends);
    return true;
}

/* Matches the strokes of the new list with those of the old one. */
static iso_status match(iso_versions *v, const iso_stroke_list *list, update *u, iso_error *error) {
    unsigned most = 0;
    for (size_t i = 0; i < v->count; i++) most = v->list[i]->number > most ? v->list[i]->number : most;
    u->strokes = iso_alloc_zero(list->count + 1, sizeof *u->strokes);
    u->old = iso_alloc_zero(list->count + 1, sizeof *u->old);
    u->made = iso_alloc_zero(list->count + 1, sizeof *u->made);
    size_t *by_number = iso_alloc_zero((size_t)most + 1, sizeof *by_number),
           *places = iso_alloc_zero(list->count + 1, sizeof *places);
    bool whole = u->strokes && u->old && u->made && by_number && places;
    for (size_t i = 0; whole && i < v->count; i++) by_number[v->list[i]->number] = i + 1;
    for (size_t i = 0; whole && i < list->count; i++) {
        iso_stroke *stroke = iso_stroke_at(list, i);
        if (!stroke->muted) u->strokes[u->count++] = stroke;
    }
    for (size_t i = 0; whole && i < u->count; i++) {
        const unsigned number = u->strokes[i]->number;
        places[i] = number <= most && by_number[number] ? by_number[number] - 1 : SIZE_MAX;
    }
    whole = whole && (u->count == 0 || keep_longest_order(places, u->count));
    for (size_t i = 0; whole && i < u->count; i++)
        if (places[i] != SIZE_MAX) u->old[i] = v->list[places[i]];
    iso_free(by_number);
    iso_free(places);
    return whole ? ISO_OK : no_memory(error);
}

static bool is_drawn_so(const drawn *d, const iso_stroke *stroke) {
    return d->path == stroke->path && iso_brush_is_same(&d->brush, &stroke->brush);
}

/* Walks both lists and draws what must be drawn. */
static iso_status walk(iso_versions *v, update *u, const iso_versions_visitor *visitor,
                       const iso_progress *progress, iso_error *error) {
    size_t old = 0;
    for (size_t i = 0; i < u->count; i++) {
        drawn *kept = u->old[i];
        ISO_TRY(iso_progress_tell(progress, "the strokes", (double)i / (double)u->count, error));
        while (kept && v->list[old] != kept) apply(v, v->list[old++], true, false);
        old += kept != NULL;
        if (visitor) ISO_TRY(visitor->visit(visitor->context, v, u->strokes[i], error));
        if (kept && is_drawn_so(kept, u->strokes[i]) && !reads_dirty(v, kept)) {
            apply(v, kept, true, true);
            continue;
        }
        ISO_TRY(draw_stroke(v, u->strokes[i], &u->made[i], error));
        if (kept) apply(v, kept, true, false);
        apply(v, u->made[i], false, true);
    }
    while (old < v->count) apply(v, v->list[old++], true, false);
    return ISO_OK;
}

/* Makes the new list the present one and frees the versions that it does not have (changes refer to those of
 * the new list). */
static void accept(iso_versions *v, update *u) {
    for (size_t i = 0; i < u->count; i++)
        if (!u->made[i]) u->old[i]->kept = true;
    for (size_t i = 0; i < v->count; i++)
        if (v->list[i]->kept)
            v->list[i]->kept = false;
        else
            free_drawn(v, v->list[i]);
    for (size_t i = 0; i < u->count; i++) {
        if (u->made[i]) u->old[i] = u->made[i];
        u->made[i] = NULL;
    }
    iso_free(v->list);
    v->list = u->old;
    v->count = u->count;
    u->old = NULL;
}

iso_status iso_versions_update(iso_versions *v, const iso_stroke_list *list,
                               const iso_versions_visitor *visitor, const iso_progress *progress,
                               iso_error *error) {
    update u = {.count = 0};
    memset(v->before, 0, v->keys * sizeof *v->before);
    memset(v->after, 0, v->keys * sizeof *v->after);
    memset(v->dirty_at, 0, v->keys * sizeof *v->dirty_at);
    v->dirty_count = 0;
    if (v->cache) memset(v->cache->of, 0, sizeof v->cache->of);
    iso_status status = match(v, list, &u, error);
    if (status == ISO_OK) status = walk(v, &u, visitor, progress, error);
    if (status == ISO_OK) {
        v->stats.strokes += u.count;
        accept(v, &u);
    } else
        v->dirty_count = 0;
    free_update(v, &u);
    return status;
}

/* ---- results */

size_t iso_versions_change_count(const iso_versions *v) {
    return v->dirty_count;
}

static const version *changed_to(const iso_versions *v, size_t index) {
    const cell_key key = v->dirty[index];
    return or_first(v, key, v->after[key]);
}

iso_cell_change iso_versions_change(const iso_versions *v, size_t index) {
    const version *at = changed_to(v, index);
    return (iso_cell_change){.cell = cell_of(at->key), .kind = part_of(at->key) - 1, .state = at->state};
}

void iso_versions_change_values(const iso_versions *v, size_t index, void *values) {
    unpack(v, changed_to(v, index), values);
}

/* The eight voxels around a place: of each its cell's key, its number there, its distance and weight. */
typedef struct corners {
    cell_key key[8];
    int voxel[8];
    double value[8], weight[8];
} corners;

/* Takes the distances of the corners that lie in the cell of a version, or else in that of a brick. */
static bool take_values(const iso_versions *v, const version *at, corners *c) {
    float brick[ISO_BRICK_VOXELS];
    bool any = false;
    for (int k = 0; k < 8; k++) {
        if (c->key[k] != at->key) continue;
        if (!any && at->size) unpack(v, at, brick);
        c->value[k] = at->size                       ? (double)brick[c->voxel[k]]
                      : at->state == ISO_CELL_INSIDE ? -(double)v->grid->band
                                                     : (double)v->grid->band;
        any = true;
    }
    return any;
}

static double interpolate(const corners *c) {
    double sum = 0;
    for (int k = 0; k < 8; k++) sum += c->weight[k] * c->value[k];
    return sum;
}

unsigned iso_versions_find(const iso_versions *v, const double at[3]) {
    const double least = 0.05;
    corners c = {.key = {0}};
    unsigned found = 0;
    for (int k = 0; k < 8; k++) {
        int voxel[3];
        c.weight[k] = 1;
        for (int axis = 0; axis < 3; axis++) {
            const double down = floor(at[axis]), part = at[axis] - down;
            if (!(down >= 0 && down < v->grid->dims[axis] - 1)) return 0;
            voxel[axis] = (int)down + (k >> axis & 1);
            c.weight[k] *= k >> axis & 1 ? part : 1 - part;
        }
        c.key[k] = (cell_key)(PARTS * iso_hgrid_cell_index(v->grid, voxel[0] / ISO_BRICK,
                                                           voxel[1] / ISO_BRICK, voxel[2] / ISO_BRICK));
        c.voxel[k] =
            (voxel[2] % ISO_BRICK * ISO_BRICK + voxel[1] % ISO_BRICK) * ISO_BRICK + voxel[0] % ISO_BRICK;
        if (v->first[c.key[k]]) take_values(v, v->first[c.key[k]], &c); /* (else no stroke wrote the cell) */
    }
    double before = interpolate(&c);
    for (size_t i = 0; i < v->count; i++) {
        bool any = false;
        for (size_t m = 0; m < v->list[i]->count; m++) any |= take_values(v, &v->list[i]->versions[m], &c);
        const double now = any ? interpolate(&c) : before;
        if (fabs(now - before) > least) found = v->list[i]->number;
        before = now;
    }
    return found;
}

/* ---- the surface along a line */

/* Returns the distance at a voxel, at this place of the new list. */
static double value_at(iso_versions *v, const int at[3]) {
    const size_t cell =
        iso_hgrid_cell_index(v->grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    const cell_key key = (cell_key)(PARTS * cell);
    const version *is = or_first(v, key, v->after[key]);
    const int voxel = (at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK) * ISO_BRICK + at[0] % ISO_BRICK;
    const int32_t state = is ? is->state : v->grid->cell[cell];
    if (is && is->size) {
        const int slot = (int)(cell % CACHED);
        if (v->cache->of[slot] != is) unpack(v, is, v->cache->bricks[slot]);
        v->cache->of[slot] = is;
        return (double)v->cache->bricks[slot][voxel];
    }
    if (!is && state >= 0) return (double)iso_hgrid_brick(v->grid, state)[voxel];
    return state == ISO_CELL_INSIDE ? -(double)v->grid->band : (double)v->grid->band;
}

/* A line in voxels; t: along it. */
typedef struct line {
    double from[3], along[3];
} line;

/* The distance at a place of the line; NAN outside of the grid. */
static double value_on(iso_versions *v, const line *l, double t) {
    double part[3], sum = 0;
    int down[3];
    for (int axis = 0; axis < 3; axis++) {
        const double at = l->from[axis] + t * l->along[axis];
        if (!(at >= 0 && at < v->grid->dims[axis] - 1)) return NAN;
        down[axis] = (int)at;
        part[axis] = at - down[axis];
    }
    for (int k = 0; k < 8; k++) {
        double weight = 1;
        int at[3];
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = down[axis] + (k >> axis & 1);
            weight *= k >> axis & 1 ? part[axis] : 1 - part[axis];
        }
        if (weight > 0) sum += weight * value_at(v, at);
    }
    return sum;
}

/* Where the distance, which is inside at lo and outside at hi, is 0. */
static double find_root(iso_versions *v, const line *l, double lo, double hi) {
    for (int i = 0; i < 30; i++) {
        const double middle = 0.5 * (lo + hi);
        *(value_on(v, l, middle) > 0 ? &hi : &lo) = middle;
    }
    return 0.5 * (lo + hi);
}

iso_status iso_versions_cast(iso_versions *v, const iso_sample *sample, double *distance, iso_error *error) {
    const double step = 0.5;
    const iso_affine affine = iso_transform_affine(&v->grid->transform);
    const iso_vec3 from = iso_affine_point_to_index(&affine, sample->position),
                   along = iso_affine_vector_to_index(&affine, iso_vec3_unit(sample->normal));
    const double voxels = iso_vec3_length(along); /* to one mm */
    const int *dims = v->grid->dims, most = dims[0] > dims[1] ? dims[0] : dims[1],
              steps = (most > dims[2] ? most : dims[2]) / 2;
    line l;
    *distance = NAN;
    if (!v->cache) v->cache = iso_alloc_zero(1, sizeof *v->cache);
    if (!v->cache) return no_memory(error);
    if (!(voxels > 0)) return ISO_OK;
    iso_vec3_store(from, l.from);
    iso_vec3_store(iso_vec3_scale(along, 1 / voxels), l.along);
    double ahead = value_on(v, &l, 0), behind = ahead;
    for (int i = 1; i <= steps; i++) {
        const double next = value_on(v, &l, i * step), last = value_on(v, &l, -i * step);
        const bool leaves = ahead <= 0 && next > 0, left = last <= 0 && behind > 0;
        if (leaves || left) {
            const double lo = leaves ? (i - 1) * step : -i * step;
            *distance = find_root(v, &l, lo, lo + step) / voxels;
            return ISO_OK;
        }
        ahead = next;
        behind = last;
    }
    return ISO_OK;
}

iso_versions_stats iso_versions_get_stats(const iso_versions *v) {
    iso_versions_stats stats = v->stats;
    stats.cost = iso_editor_cost(v->editor);
    stats.bytes = v->store.in_memory + v->store.in_files;
    stats.in_files = v->store.in_files;
    return stats;
}
