/* Contents of cells as chains of versions, and the cells whose contents differ between two lists. */
#include "sculpt/session/version_cells.h"

#include <string.h>

/* Bricks of the old list that are kept for comparing; more cells than these are dirty without being looked
 * at. */
enum { OLD_BRICKS = 8192, BRICK_BYTES = ISO_BRICK_VOXELS * sizeof(float) };

iso_status iso_versions_no_memory(iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the versions of strokes");
}

iso_cell_items *iso_versions_items(const iso_versions *v, iso_cell_key key) {
    const int part = iso_part_of_key(key);
    return part == ISO_PART_DISTANCES ? NULL : &iso_editor_items(v->editor)->of[part - 1];
}

static const float *empty_distances(const iso_versions *v, int32_t state) {
    return v->constant[state == ISO_CELL_INSIDE];
}

const float *iso_work_distances(const iso_versions *v, uint32_t cell) {
    const int32_t entry = v->grid->cell[cell];
    return entry >= 0 ? iso_hgrid_brick(v->grid, entry) : empty_distances(v, entry);
}

/* ---- versions */

void iso_version_free(iso_versions *v, iso_cell_version *at) {
    iso_version_store_give(&v->store, at->bytes, at->touches + at->end);
    iso_version_store_give(&v->store, at->frame, at->frame_size);
    at->bytes = at->frame = NULL;
}

void iso_drawn_free(iso_versions *v, iso_drawn *d) {
    if (!d) return;
    for (size_t i = 0; i < d->count; i++) iso_version_free(v, &d->versions[i]);
    iso_free(d->versions);
    iso_free(d->cells);
    iso_free(d->reads);
    iso_free(d);
}

static iso_status set_frame(iso_versions *v, iso_cell_version *at, const float *whole, iso_error *error) {
    uint8_t packed[ISO_CELL_DELTA_MAX];
    const size_t size = iso_cell_delta_pack(v->constant[0], whole, v->grid->band, packed);
    at->frame = iso_version_store_take(&v->store, size);
    if (!at->frame) return iso_versions_no_memory(error);
    at->frame_size = (uint32_t)size;
    at->depth = 0;
    memcpy(at->frame, packed, size);
    return ISO_OK;
}

iso_status iso_version_set(iso_versions *v, iso_cell_version *at, const uint8_t *touches, const uint8_t *end,
                           uint32_t depth, const float *whole, iso_error *error) {
    if (at->touches + at->end) {
        at->bytes = iso_version_store_take(&v->store, at->touches + at->end);
        if (!at->bytes) return iso_versions_no_memory(error);
        if (at->touches) memcpy(at->bytes, touches, at->touches);
        if (at->end) memcpy(at->bytes + at->touches, end, at->end);
    }
    at->depth = at->state < 0 ? 0 : depth + 1;
    return at->depth >= ISO_VERSION_FRAMES ? set_frame(v, at, whole, error) : ISO_OK;
}

iso_status iso_version_set_item(iso_versions *v, iso_cell_version *at, iso_error *error) {
    const iso_cell_items *items = iso_versions_items(v, at->key);
    const void *item = items->cell[iso_cell_of_key(at->key)];
    at->state = item ? 0 : ISO_CELL_OUTSIDE;
    if (!item) return ISO_OK;
    const size_t size = iso_item_pack_size(item, items->bytes);
    at->bytes = iso_version_store_take(&v->store, size);
    if (!at->bytes) return iso_versions_no_memory(error);
    at->touches = (uint32_t)size;
    iso_item_pack(item, items->bytes, at->bytes);
    return ISO_OK;
}

iso_status iso_version_keep_first(iso_versions *v, iso_cell_key key, iso_error *error) {
    if (v->first[key]) return ISO_OK;
    iso_cell_version *first = iso_alloc_zero(1, sizeof *first);
    if (!first) return iso_versions_no_memory(error);
    const uint32_t cell = iso_cell_of_key(key);
    first->key = key;
    iso_status status = ISO_OK;
    if (iso_part_of_key(key) != ISO_PART_DISTANCES)
        status = iso_version_set_item(v, first, error);
    else if (v->grid->cell[cell] >= 0)
        status = set_frame(v, first, iso_work_distances(v, cell), error);
    else
        first->state = v->grid->cell[cell];
    if (status == ISO_OK)
        v->first[key] = first;
    else
        iso_free(first);
    return status;
}

/* Whether the content of a version is known without those before it. */
static bool is_whole(const iso_cell_version *at) {
    return at->frame || at->state < 0;
}

void iso_version_read(const iso_versions *v, const iso_cell_version *at, int list, uint64_t held,
                      float *brick) {
    iso_cell_version *from = (iso_cell_version *)at; /* only its `next` is written */
    from->next = NULL;
    while (from->serial != held && !is_whole(from)) {
        iso_cell_version *before = (iso_cell_version *)iso_or_first(v, at->key, from->before[list]);
        before->next = from;
        from = before;
    }
    if (from->serial != held)
        memcpy(brick, empty_distances(v, from->frame ? ISO_CELL_OUTSIDE : from->state), BRICK_BYTES);
    if (from->serial != held) iso_cell_delta_apply(from->frame, from->frame_size, v->grid->band, brick);
    for (from = from->next; from; from = from->next) {
        if (!from->bytes) continue; /* no voxel changed */
        iso_cell_delta_apply(from->bytes, from->touches, v->grid->band, brick);
        iso_cell_delta_apply(from->bytes + from->touches, from->end, v->grid->band, brick);
    }
}

void iso_version_read_item(const iso_versions *v, const iso_cell_version *at, void *item) {
    iso_item_unpack(at->bytes, at->touches, iso_versions_items(v, at->key)->bytes, item);
}

iso_status iso_versions_restore_later(iso_versions *v, iso_cell_key key, iso_error *error) {
    const iso_cell_version *at = iso_or_first(v, key, v->after[key]);
    const uint32_t cell = iso_cell_of_key(key);
    int where[3];
    float *brick;
    if (!at || v->held[key] == at->serial) return ISO_OK;
    if (iso_part_of_key(key) != ISO_PART_DISTANCES) {
        iso_paint_item item; /* the largest */
        if (at->state == 0) iso_version_read_item(v, at, &item);
        ISO_TRY(iso_cell_items_set(iso_versions_items(v, key), cell, at->state == 0 ? &item : NULL, error));
    } else {
        iso_hgrid_cell_position(v->grid, cell, where);
        if (at->state == 0) {
            const size_t bytes = v->stale_count * sizeof(iso_stale);
            ISO_TRY(iso_buffer_reserve(&v->stale, bytes + sizeof(iso_stale), bytes, error));
            ISO_TRY(iso_hgrid_split(v->grid, where[0], where[1], where[2], &brick, error));
            ((iso_stale *)v->stale.data)[v->stale_count++] = (iso_stale){at, v->held[key]};
        } else
            iso_hgrid_coalesce(v->grid, where[0], where[1], where[2], at->state);
    }
    v->held[key] = at->serial;
    return ISO_OK;
}

static void read_stale(void *context, size_t index, int worker) {
    const iso_versions *v = context;
    const iso_stale *stale = (const iso_stale *)v->stale.data + index;
    const uint32_t cell = iso_cell_of_key(stale->version->key);
    (void)worker;
    iso_version_read(v, stale->version, iso_list_made(v), stale->held,
                     iso_hgrid_brick(v->grid, v->grid->cell[cell]));
}

void iso_versions_read_stale(iso_versions *v) {
    iso_parallel_for(v->pool, v->stale_count, read_stale, v);
    v->stale_count = 0;
}

iso_status iso_versions_restore(iso_versions *v, iso_cell_key key, iso_error *error) {
    const iso_status status = iso_versions_restore_later(v, key, error);
    iso_versions_read_stale(v);
    return status;
}

/* ---- what differs */

static float *take_old_brick(iso_versions *v) {
    float **spare = v->spare.data;
    if (v->spare_count) return spare[--v->spare_count];
    if (v->old_bricks == OLD_BRICKS) return NULL;
    const size_t bytes = v->old_bricks * sizeof(float *);
    if (iso_buffer_reserve(&v->spare, bytes + sizeof(float *), 0, NULL) != ISO_OK) return NULL;
    float *brick = iso_alloc(BRICK_BYTES);
    v->old_bricks += brick != NULL;
    return brick;
}

static void give_old_brick(iso_versions *v, iso_dirty *dirty) {
    if (dirty->old) ((float **)v->spare.data)[v->spare_count++] = dirty->old;
    dirty->old = NULL;
}

void iso_versions_clear_dirty(iso_versions *v) {
    for (size_t i = 0; i < v->dirty_count; i++) {
        give_old_brick(v, &v->dirty[i]);
        v->dirty_at[v->dirty[i].key] = 0;
    }
    v->dirty_count = 0;
}

void iso_versions_set_clean(iso_versions *v, iso_cell_key key) {
    if (!v->dirty_at[key]) return;
    iso_dirty *dirty = &v->dirty[v->dirty_at[key] - 1], *last = &v->dirty[--v->dirty_count];
    give_old_brick(v, dirty);
    v->dirty_at[last->key] = v->dirty_at[key];
    v->dirty_at[key] = 0;
    if (dirty != last) *dirty = *last;
}

/* Makes a key dirty, or unknown again; NULL: there is no memory. */
static iso_dirty *set_dirty(iso_versions *v, iso_cell_key key) {
    if (!v->dirty_at[key]) {
        if (v->dirty_count == v->dirty_room) {
            const size_t room = v->dirty_room ? 2 * v->dirty_room : 256;
            iso_dirty *dirty = iso_alloc(room * sizeof *dirty);
            if (!dirty) return NULL;
            if (v->dirty_count) memcpy(dirty, v->dirty, v->dirty_count * sizeof *dirty);
            iso_free(v->dirty);
            v->dirty = dirty;
            v->dirty_room = room;
        }
        iso_dirty *made = &v->dirty[v->dirty_count++];
        made->key = key;
        made->old = NULL;
        v->dirty_at[key] = (uint32_t)v->dirty_count;
    }
    iso_dirty *dirty = &v->dirty[v->dirty_at[key] - 1];
    dirty->unknown = true;
    return dirty;
}

const float *iso_dirty_old(iso_versions *v, iso_dirty *dirty) {
    const iso_cell_version *at = iso_or_first(v, dirty->key, v->before[dirty->key]);
    if (!dirty->old) {
        dirty->old = take_old_brick(v);
        dirty->held = ISO_NO_SERIAL;
    }
    if (dirty->old && dirty->held != at->serial) {
        iso_version_read(v, at, v->list_now, dirty->held, dirty->old);
        dirty->held = at->serial;
    }
    return dirty->old;
}

/* Finds the voxels whose bits differ; returns whether there are any. */
static bool find_different(const float *a, const float *b, iso_voxel_bits *bits) {
    bool any = false;
    for (int row = 0; row < ISO_BRICK_ROWS; row++, a += ISO_BRICK, b += ISO_BRICK) {
        uint32_t p[ISO_BRICK], q[ISO_BRICK], differ = 0;
        memcpy(p, a, sizeof p);
        memcpy(q, b, sizeof q);
        for (int x = 0; x < ISO_BRICK; x++) differ |= (uint32_t)(p[x] != q[x]) << x;
        bits->row[row] = (uint16_t)differ;
        any |= differ != 0;
    }
    return any;
}

static bool is_same_item(const iso_cell_version *a, const iso_cell_version *b) {
    return a->state == b->state && a->touches == b->touches &&
           (!a->touches || memcmp(a->bytes, b->bytes, a->touches) == 0);
}

/* Compares the contents of a dirty key, which becomes clean if they are the same. */
static iso_status compare(iso_versions *v, iso_dirty *dirty, iso_error *error) {
    const iso_cell_key key = dirty->key;
    const iso_cell_version *before = iso_or_first(v, key, v->before[key]),
                           *after = iso_or_first(v, key, v->after[key]);
    bool same = before == after;
    if (!same && iso_part_of_key(key) != ISO_PART_DISTANCES)
        same = is_same_item(before, after);
    else if (!same) {
        ISO_TRY(iso_versions_restore(v, key, error));
        const float *old = iso_dirty_old(v, dirty);
        if (!old) return ISO_OK; /* there is no room to look: it stays unknown */
        dirty->unknown = false;
        same = !find_different(old, iso_work_distances(v, iso_cell_of_key(key)), &dirty->bits) &&
               before->state == after->state;
    }
    if (same) iso_versions_set_clean(v, key);
    return ISO_OK;
}

iso_status iso_versions_judge(iso_versions *v, iso_cell_key key, iso_error *error) {
    iso_dirty *dirty = set_dirty(v, key);
    if (!dirty) return iso_versions_no_memory(error);
    return v->blind ? ISO_OK : compare(v, dirty, error);
}

iso_status iso_versions_settle(iso_versions *v, iso_error *error) {
    for (size_t i = v->dirty_count; i-- > 0;) {
        ISO_TRY(compare(v, &v->dirty[i], error));
        if (i < v->dirty_count) give_old_brick(v, &v->dirty[i]);
    }
    return ISO_OK;
}
