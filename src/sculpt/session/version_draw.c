/* Draws strokes on the work grid and keeps what they write as versions; finds out which strokes need not be
 * drawn because they read nothing that differs. */
#include <string.h>

#include "sculpt/brush/dab.h"
#include "sculpt/field/crease.h"
#include "sculpt/session/pen.h"
#include "sculpt/session/version_cells.h"

/* ---- what a stroke writes */

static iso_status note_written(iso_versions *v, iso_cell_key key, iso_error *error) {
    const size_t bytes = v->written_count * sizeof(iso_draft);
    ISO_TRY(iso_buffer_reserve(&v->written, bytes + sizeof(iso_draft), bytes, error));
    ISO_TRY(iso_version_keep_first(v, key, error)); /* (not written before, the work grid has what it was) */
    ((iso_draft *)v->written.data)[v->written_count++] = (iso_draft){.key = key};
    return ISO_OK;
}

static iso_status note_cell(void *context, uint32_t cell, int32_t state, const float *brick,
                            iso_error *error) {
    iso_versions *v = context;
    const iso_step_opts step = iso_history_step_opts(v->history);
    ISO_TRY(note_written(v, ISO_PARTS * cell, error));
    return step.observer.before(step.observer.context, cell, state, brick, error);
}

static iso_status note_item(void *context, iso_item_kind kind, uint32_t cell, void *item, iso_error *error) {
    iso_versions *v = context;
    const iso_step_opts step = iso_history_step_opts(v->history);
    ISO_TRY(note_written(v, ISO_PARTS * cell + 1 + (iso_cell_key)kind, error));
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

/* The distances of a cell that the stroke has written, before it. */
static const float *distances_before(iso_versions *v, uint32_t cell) {
    int32_t state = ISO_CELL_OUTSIDE;
    const float *brick = original(v, cell, &state);
    return brick ? brick : v->constant[state == ISO_CELL_INSIDE];
}

/* ---- what a stroke reads */

static bool contains(const iso_index_box *outer, const iso_index_box *inner) {
    return iso_index_box_holds(outer, inner->lo) && iso_index_box_holds(outer, inner->hi);
}

/* Adds a box to a list, unless one of the last `recent` ones from `first` on contains it. */
static iso_status add_box(iso_buffer *list, size_t *count, size_t first, size_t recent,
                          const iso_index_box *box, iso_error *error) {
    const iso_index_box *boxes = list->data;
    for (size_t k = *count; k-- > first && k + recent >= *count;)
        if (contains(&boxes[k], box)) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(list, (*count + 1) * sizeof *box, *count * sizeof *box, error));
    ((iso_index_box *)list->data)[(*count)++] = *box;
    return ISO_OK;
}

/* iso_pen.touch: adds the ranges of a touch to those of its stroke. */
static iso_status add_ranges(void *context, const iso_brush *brush, const iso_touch *touch,
                             iso_error *error) {
    iso_versions *v = context;
    iso_editor_range made[ISO_EDITOR_RANGES];
    ISO_TRY(iso_brush_check(brush, error));
    const int count = iso_editor_ranges(v->editor, brush, touch, made);
    const size_t recent = count > 8 ? 2 * (size_t)count : 16; /* those of the last two touches */
    if (!v->range_count)
        ISO_TRY(add_box(&v->ranges, &v->range_count, 0, 0, &made[0].cells, error)); /* contains all */
    for (int i = 0; i < count; i++) {
        iso_index_box *all = v->ranges.data;
        for (int axis = 0; axis < 3; axis++) {
            if (made[i].cells.lo[axis] < all->lo[axis]) all->lo[axis] = made[i].cells.lo[axis];
            if (made[i].cells.hi[axis] > all->hi[axis]) all->hi[axis] = made[i].cells.hi[axis];
        }
        ISO_TRY(add_box(&v->ranges, &v->range_count, 1, recent, &made[i].cells, error));
        ISO_TRY(add_box(&v->reads, &v->read_count, 0, recent, &made[i].voxels, error));
    }
    return ISO_OK;
}

/* Adds the voxels of a cell that lie in a box, whose bounds are those of voxels relative to the cell. */
static void add_box_bits(const int lo[3], const int hi[3], iso_voxel_bits *bits) {
    int first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = lo[axis] > 0 ? lo[axis] : 0;
        last[axis] = hi[axis] < ISO_BRICK ? hi[axis] : ISO_BRICK - 1;
        if (first[axis] > last[axis]) return;
    }
    const uint16_t x = (uint16_t)((2u << last[0]) - (1u << first[0]));
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++) bits->row[z * ISO_BRICK + y] |= x;
}

/* Finds the voxels of a cell that a stroke's touches read. Returns whether there are any. */
static bool find_read_bits(const iso_drawn *d, const int cell[3], iso_voxel_bits *bits) {
    bool any = false;
    memset(bits, 0, sizeof *bits);
    for (size_t i = 0; i < d->read_count; i++) {
        int lo[3], hi[3];
        bool near = true;
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = d->reads[i].lo[axis] - ISO_BRICK * cell[axis];
            hi[axis] = d->reads[i].hi[axis] - ISO_BRICK * cell[axis];
            near &= lo[axis] < ISO_BRICK && hi[axis] >= 0;
        }
        if (near) add_box_bits(lo, hi, bits);
        any |= near;
    }
    return any;
}

/* Whether the voxels that the touches of a stroke read tell all that it depends on, but for what
 * iso_versions_find_concern looks at: nothing in its reach is frozen or painted, nor does it paint. */
static bool reads_distances_only(const iso_versions *v, const iso_drawn *d) {
    const iso_tool tool = d->brush.tool;
    const iso_field_items *items = iso_editor_items(v->editor);
    if (tool >= ISO_TOOL_MASK || d->brush.has_color) return false;
    if (iso_tool_is_warp(tool) && iso_brush_image_count(&d->brush) > 1) return false;
    for (int kind = 0; kind < ISO_ITEM_KINDS; kind++) {
        const iso_index_box *box = &d->cells[0];
        for (int z = box->lo[2]; items->of[kind].used && z <= box->hi[2]; z++)
            for (int y = box->lo[1]; y <= box->hi[1]; y++)
                for (int x = box->lo[0]; x <= box->hi[0]; x++)
                    if (items->of[kind].cell[iso_hgrid_cell_index(v->grid, x, y, z)]) return false;
    }
    return true;
}

static iso_status copy_boxes(const iso_index_box *from, size_t count, iso_index_box **to, iso_error *error) {
    *to = iso_alloc((count + 1) * sizeof **to);
    if (!*to) return iso_versions_no_memory(error);
    if (count) memcpy(*to, from, count * sizeof **to);
    return ISO_OK;
}

/* ---- drawing */

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

static iso_status restore_later(iso_versions *v, const iso_drawn *d, iso_error *error) {
    for (size_t i = 1; i < d->cell_count; i++)
        for (int z = d->cells[i].lo[2]; z <= d->cells[i].hi[2]; z++)
            for (int y = d->cells[i].lo[1]; y <= d->cells[i].hi[1]; y++) {
                const size_t row = iso_hgrid_cell_index(v->grid, 0, y, z);
                for (int x = d->cells[i].lo[0]; x <= d->cells[i].hi[0]; x++)
                    for (iso_cell_key part = 0; part < ISO_PARTS; part++)
                        ISO_TRY(iso_versions_restore_later(
                            v, (iso_cell_key)(ISO_PARTS * (row + (size_t)x)) + part, error));
            }
    const bool whole_mask = iso_tool_is_whole_mask(d->brush.tool);
    for (iso_cell_key key = 1 + ISO_ITEM_MASK; whole_mask && key < v->keys; key += ISO_PARTS)
        ISO_TRY(iso_versions_restore_later(v, key, error));
    return ISO_OK;
}

/* Brings all that a stroke can read to this place of the new list. */
static iso_status restore_ranges(iso_versions *v, const iso_drawn *d, iso_error *error) {
    const iso_status status = restore_later(v, d, error);
    iso_versions_read_stale(v);
    return status;
}

/* Keeps what the touches have made of the distances. */
static iso_status pack_touches(iso_versions *v, iso_error *error) {
    iso_draft *drafts = v->written.data;
    size_t bytes = 0;
    for (size_t i = 0; i < v->written_count; i++) {
        const uint32_t cell = iso_cell_of_key(drafts[i].key);
        if (iso_part_of_key(drafts[i].key) != ISO_PART_DISTANCES) continue;
        ISO_TRY(iso_buffer_reserve(&v->packed, bytes + ISO_CELL_DELTA_MAX, bytes, error));
        drafts[i].at = bytes;
        drafts[i].touches =
            (uint32_t)iso_cell_delta_pack(distances_before(v, cell), iso_work_distances(v, cell),
                                          v->grid->band, (uint8_t *)v->packed.data + bytes);
        bytes += drafts[i].touches;
    }
    return ISO_OK;
}

static uint32_t depth_before(const iso_versions *v, iso_cell_key key) {
    const iso_cell_version *before = iso_or_first(v, key, v->after[key]);
    return before ? before->depth : 0;
}

/* Makes versions of what the stroke wrote. */
static iso_status keep_written(iso_versions *v, iso_drawn *d, iso_error *error) {
    const iso_draft *drafts = v->written.data;
    d->versions = iso_alloc_zero(v->written_count + 1, sizeof *d->versions);
    if (!d->versions) return iso_versions_no_memory(error);
    for (size_t i = 0; i < v->written_count; i++) {
        const iso_cell_key key = drafts[i].key;
        const uint32_t cell = iso_cell_of_key(key);
        uint8_t end[ISO_CELL_DELTA_MAX];
        iso_cell_version *at = &d->versions[d->count++];
        at->key = key;
        at->serial = ++v->serials;
        if (iso_part_of_key(key) != ISO_PART_DISTANCES) {
            d->fine = false;
            ISO_TRY(iso_version_set_item(v, at, error));
        } else {
            const uint8_t *touches = (const uint8_t *)v->packed.data + drafts[i].at;
            const float *now = iso_work_distances(v, cell);
            memcpy(v->room, distances_before(v, cell), ISO_BRICK_VOXELS * sizeof *v->room);
            iso_cell_delta_apply(touches, drafts[i].touches, v->grid->band, v->room);
            at->touches = drafts[i].touches;
            at->end = (uint32_t)iso_cell_delta_pack(v->room, now, v->grid->band, end);
            at->state = v->grid->cell[cell] < 0 ? v->grid->cell[cell] : 0;
            ISO_TRY(iso_version_set(v, at, touches, end, depth_before(v, key), now, error));
        }
        v->held[key] = at->serial;
    }
    return ISO_OK;
}

/* Adds to each voxel those before it in the cube of 2^3 voxels, which its delta reads. */
static void add_predictors(iso_voxel_bits *bits) {
    for (int row = 0; row < ISO_BRICK_ROWS; row++) bits->row[row] |= bits->row[row] >> 1;
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        if (row % ISO_BRICK + 1 < ISO_BRICK) bits->row[row] |= bits->row[row + 1];
    for (int row = 0; row + ISO_BRICK < ISO_BRICK_ROWS; row++) bits->row[row] |= bits->row[row + ISO_BRICK];
}

/* Whether the touches wrote only voxels that they are known to read, and their deltas read no others. */
static bool writes_what_it_reads(const iso_versions *v, const iso_drawn *d) {
    uint32_t beyond = 0;
    for (size_t i = 0; i < d->count && !beyond; i++) {
        iso_voxel_bits written = {{0}}, read;
        int at[3];
        iso_hgrid_cell_position(v->grid, iso_cell_of_key(d->versions[i].key), at);
        find_read_bits(d, at, &read);
        iso_cell_delta_add_bits(d->versions[i].bytes, d->versions[i].touches, &written);
        add_predictors(&written);
        for (int row = 0; row < ISO_BRICK_ROWS; row++) beyond |= written.row[row] & ~(uint32_t)read.row[row];
    }
    return !beyond;
}

/* Draws the stroke on the work grid, which is at its place. */
static iso_status draw_touches(iso_versions *v, const iso_stroke *stroke, iso_drawn *d, iso_error *error) {
    iso_step_opts step = {.observer = {note_cell, note_item, v},
                          .original = original,
                          .original_paint = original_paint,
                          .stamp = stroke->stamp};
    v->written_count = 0;
    ISO_TRY(iso_history_begin(v->history, "", error));
    iso_editor_begin_step(v->editor, &step);
    iso_status status = follow(v, stroke, touch_work_grid, error);
    if (status == ISO_OK) status = pack_touches(v, error);
    if (status == ISO_OK) status = iso_editor_finalize(v->editor, error);
    const iso_draft *drafts = v->written.data;
    for (size_t i = 0; i < v->written_count; i++)
        v->held[drafts[i].key] = ISO_NO_SERIAL; /* of no version yet */
    if (status == ISO_OK) status = keep_written(v, d, error);
    iso_history_forget(v->history);
    return status;
}

iso_status iso_versions_draw(iso_versions *v, const iso_stroke *stroke, iso_drawn **out, iso_error *error) {
    iso_drawn *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return iso_versions_no_memory(error);
    *out = d;
    d->number = stroke->number;
    d->brush = stroke->brush;
    d->path = stroke->path;
    const iso_step_opts step = {.stamp = stroke->stamp}; /* whose size the ranges depend on */
    iso_editor_begin_step(v->editor, &step);
    v->range_count = v->read_count = 0;
    ISO_TRY(follow(v, stroke, add_ranges, error));
    d->cell_count = v->range_count;
    d->read_count = v->read_count;
    ISO_TRY(copy_boxes(v->ranges.data, v->range_count, &d->cells, error));
    ISO_TRY(copy_boxes(v->reads.data, v->read_count, &d->reads, error));
    ISO_TRY(restore_ranges(v, d, error));
    d->fine = reads_distances_only(v, d);
    ISO_TRY(draw_touches(v, stroke, d, error));
    d->fine = d->fine && writes_what_it_reads(v, d);
    v->stats.drawn++;
    return ISO_OK;
}

/* ---- what differs */

/* Of the voxels of a cell that the touches of a stroke do not read: on which sides of the surface there are
 * any (bits 0 and 1), and, if the touches read others of the cell, in which of its 27 parts (3 voxels at each
 * face, and between these) some are in the band. */
static uint32_t look_beyond(const float *brick, float band, const iso_voxel_bits *read, bool parts) {
    enum { EDGE = 3 };
    uint32_t found = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const int y = row % ISO_BRICK, z = row / ISO_BRICK,
                  part = 3 * ((y >= EDGE) + (y >= ISO_BRICK - EDGE)) +
                         9 * ((z >= EDGE) + (z >= ISO_BRICK - EDGE));
        for (uint32_t left = (uint16_t)~read->row[row]; left; left &= left - 1) {
            const int x = __builtin_ctz(left);
            const float value = brick[row * ISO_BRICK + x];
            found |= value < 0 ? 2 : 1;
            if (parts && value < band && value > -band)
                found |= 4u << (part + (x >= EDGE) + (x >= ISO_BRICK - EDGE));
        }
    }
    return found;
}

/* Whether what differs in a cell of distances within a stroke's reach makes its touches come out differently:
 * they read some of it, or the cell may tell them something else as a whole: that it has a brick, that there
 * is a surface in it or near one of its faces (transaction.h). What they do not read stays as it is, so these
 * are the same during the whole stroke if they are before it; and if the touches have emptied a cell that
 * lost its surface, they have written voxels that they do not read. */
static iso_status reads_cell(iso_versions *v, const iso_drawn *d, iso_dirty *dirty, bool *reads,
                             iso_error *error) {
    iso_voxel_bits read;
    int at[3];
    const iso_cell_key key = dirty->key;
    *reads = true;
    if (dirty->unknown || iso_or_first(v, key, v->before[key])->state ||
        iso_or_first(v, key, v->after[key])->state)
        return ISO_OK;
    iso_hgrid_cell_position(v->grid, iso_cell_of_key(key), at);
    const bool parts = find_read_bits(d, at, &read);
    uint32_t both = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) both |= (uint32_t)(read.row[row] & dirty->bits.row[row]);
    if (both) return ISO_OK;
    const float *old = iso_dirty_old(v, dirty);
    ISO_TRY(iso_versions_restore(v, key, error));
    *reads = look_beyond(old, v->grid->band, &read, parts) !=
             look_beyond(iso_work_distances(v, iso_cell_of_key(key)), v->grid->band, &read, parts);
    return ISO_OK;
}

/* Whether a dirty voxel lies within ISO_CREASE_MARGIN voxels of a cell, which stands at an offset. */
static bool is_near(const iso_voxel_bits *bits, const int side[3]) {
    enum { M = ISO_CREASE_MARGIN };
    int lo[3], hi[3];
    iso_voxel_bits within = {{0}};
    uint32_t any = 0;
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = side[axis] < 0 ? ISO_BRICK - M : 0;
        hi[axis] = side[axis] > 0 ? M - 1 : ISO_BRICK - 1;
    }
    add_box_bits(lo, hi, &within);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) any |= (uint32_t)(within.row[row] & bits->row[row]);
    return any != 0;
}

/* The keys of the distances of a cell and of those around it; -1: outside of the grid. */
static void find_around(const iso_versions *v, iso_cell_key key, int64_t around[27]) {
    int at[3];
    iso_hgrid_cell_position(v->grid, iso_cell_of_key(key), at);
    for (int k = 0; k < 27; k++) {
        const int p[3] = {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1};
        bool within = true;
        for (int axis = 0; axis < 3; axis++) within &= p[axis] >= 0 && p[axis] < v->grid->cells[axis];
        around[k] = within ? (int64_t)(ISO_PARTS * iso_hgrid_cell_index(v->grid, p[0], p[1], p[2])) : -1;
    }
}

/* Whether the end of a stroke has to look again at a cell that it has written. */
static bool ends_again(const iso_versions *v, const iso_cell_version *at) {
    int64_t around[27];
    if (at->state) return false;
    find_around(v, at->key, around);
    for (int k = 0; k < 27; k++) {
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        const uint32_t number = around[k] < 0 ? 0 : v->dirty_at[around[k]];
        if (number && is_near(&v->dirty[number - 1].bits, side)) return true;
    }
    return false;
}

iso_status iso_versions_find_concern(iso_versions *v, const iso_drawn *d, iso_concern *concern,
                                     iso_error *error) {
    const bool whole_mask = iso_tool_is_whole_mask(d->brush.tool);
    bool reads = false, near = false;
    for (size_t i = 0; i < v->dirty_count && !reads; i++) {
        iso_dirty *dirty = &v->dirty[i];
        int at[3];
        bool within = false;
        reads = whole_mask && iso_part_of_key(dirty->key) == 1 + ISO_ITEM_MASK;
        iso_hgrid_cell_position(v->grid, iso_cell_of_key(dirty->key), at);
        if (!iso_index_box_holds(&d->cells[0], at)) continue;
        for (size_t k = 1; k < d->cell_count && !within; k++) within = iso_index_box_holds(&d->cells[k], at);
        if (!within) continue;
        near = true;
        if (!d->fine || iso_part_of_key(dirty->key) != ISO_PART_DISTANCES)
            reads = true;
        else
            ISO_TRY(reads_cell(v, d, dirty, &reads, error));
    }
    *concern = reads ? ISO_CONCERN_TOUCHES : ISO_CONCERN_NONE;
    for (size_t i = 0; near && !reads && i < d->count && *concern == ISO_CONCERN_NONE; i++)
        if (ends_again(v, &d->versions[i])) *concern = ISO_CONCERN_END;
    return ISO_OK;
}

/* ---- the end of a stroke alone */

/* Brings the work grid to the place after a stroke's touches where its end looks again at cells, and lists
 * these (indices of versions). */
static iso_status restore_after_touches(iso_versions *v, const iso_drawn *d, size_t *again, size_t *count,
                                        iso_error *error) {
    for (size_t i = 0; i < d->count; i++) {
        int64_t around[27];
        if (!ends_again(v, &d->versions[i])) continue;
        again[(*count)++] = i;
        find_around(v, d->versions[i].key, around);
        for (int k = 0; k < 27; k++)
            if (around[k] >= 0) ISO_TRY(iso_versions_restore(v, (iso_cell_key)around[k], error));
    }
    for (size_t i = 0; i < d->count; i++) {
        const iso_cell_version *at = &d->versions[i];
        const uint32_t cell = iso_cell_of_key(at->key);
        int where[3];
        float *brick;
        iso_hgrid_cell_position(v->grid, cell, where);
        ISO_TRY(iso_versions_restore(v, at->key, error));
        v->held[at->key] = ISO_NO_SERIAL;
        if (!at->touches) continue;
        ISO_TRY(iso_hgrid_split(v->grid, where[0], where[1], where[2], &brick, error));
        iso_cell_delta_apply(at->bytes, at->touches, v->grid->band, brick);
    }
    return ISO_OK;
}

/* Makes the copy of a version, with the end `ending`, or its own (NULL), and brings the work grid to it. */
static iso_status end_version(iso_versions *v, const iso_cell_version *at, const float *ending,
                              iso_cell_version *out, iso_error *error) {
    const uint32_t cell = iso_cell_of_key(at->key);
    const int32_t entry = v->grid->cell[cell];
    float *brick = entry >= 0 ? iso_hgrid_brick(v->grid, entry) : NULL;
    const uint8_t *end = at->bytes + at->touches;
    uint8_t made[ISO_CELL_DELTA_MAX];
    *out = (iso_cell_version){.key = at->key, .state = at->state, .touches = at->touches, .end = at->end};
    out->serial = ++v->serials;
    if (ending) {
        out->end = (uint32_t)iso_cell_delta_pack(brick, ending, v->grid->band, made);
        end = made;
    }
    if (brick) iso_cell_delta_apply(end, out->end, v->grid->band, brick);
    ISO_TRY(iso_version_set(v, out, at->bytes, end, depth_before(v, at->key), brick, error));
    if (at->state == 0 && brick) v->held[at->key] = out->serial;
    return ISO_OK;
}

iso_status iso_versions_end_again(iso_versions *v, const iso_drawn *d, iso_drawn **out, iso_error *error) {
    iso_drawn *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_versions_no_memory(error);
    *made = (iso_drawn){.number = d->number,
                        .brush = d->brush,
                        .path = d->path,
                        .cell_count = d->cell_count,
                        .read_count = d->read_count,
                        .fine = true};
    *out = made;
    ISO_TRY(copy_boxes(d->cells, d->cell_count, &made->cells, error));
    ISO_TRY(copy_boxes(d->reads, d->read_count, &made->reads, error));
    made->versions = iso_alloc_zero(d->count + 1, sizeof *made->versions);
    size_t *again = iso_alloc((d->count + 1) * sizeof *again), count = 0;
    uint32_t *cells = iso_alloc((d->count + 1) * sizeof *cells);
    bool *any = iso_alloc((d->count + 1) * sizeof *any);
    float *bricks = NULL;
    iso_status status = made->versions && again && cells && any ? ISO_OK : iso_versions_no_memory(error);
    if (status == ISO_OK) status = restore_after_touches(v, d, again, &count, error);
    if (status == ISO_OK) {
        bricks = iso_alloc((count + 1) * ISO_BRICK_VOXELS * sizeof(float));
        for (size_t i = 0; i < count; i++) cells[i] = iso_cell_of_key(d->versions[again[i]].key);
        status = bricks ? iso_editor_correct(v->editor, cells, count, bricks, any, error)
                        : iso_versions_no_memory(error);
    }
    for (size_t i = 0, k = 0; i < d->count && status == ISO_OK; i++) {
        const bool listed = k < count && again[k] == i;
        const float *ending = !listed  ? NULL
                              : any[k] ? bricks + k * ISO_BRICK_VOXELS
                                       : iso_work_distances(v, cells[k]);
        status = end_version(v, &d->versions[i], ending, &made->versions[i], error);
        made->count++;
        k += listed;
    }
    iso_free(again);
    iso_free(cells);
    iso_free(any);
    iso_free(bricks);
    return status;
}
