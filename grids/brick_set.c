/* Incremental extraction. Tasks extract chunks of bricks (CHUNK_BRICKS of the list) into memory of their own;
 * the results of a chunk are then copied to the set's arrays in the order of bricks. */
#include "grids/brick_set.h"

#include <string.h>

#include "base/foresee.h"
#include "base/primitives.h"

enum {
    CHUNK_BRICKS = 32,        /* bricks that one task extracts */
    TRIMMED_BYTES = 32 << 20, /* of a set with so much, freed memory goes back to the system */
    ASKED_BRICKS = 1 << 12,   /* bricks that one thread alone extracts before it asks whether to go on */
    SURVEY_BRICKS = 1 << 12   /* bricks that one task tests by may_exist */
};

/* A brick that has a span, and the blocks that the span occupies. */
typedef struct slot {
    uint32_t brick;
    iso_brick_location location;
    uint32_t block[ISO_SET_HEAPS];
} slot;

/* One extracted brick of a chunk. The items of a chunk's bricks follow each other in the chunk's arrays. */
typedef struct result {
    uint32_t brick, own;
    uint32_t count[ISO_SET_HEAPS];
    size_t first[ISO_SET_HEAPS]; /* index of the brick's first item in the set's arrays, once stored */
} result;

/* The results of one task; the memory is reused by later tasks. */
typedef struct chunk {
    iso_buffer array[ISO_SET_ARRAYS];
    size_t used[ISO_SET_HEAPS];
    result results[CHUNK_BRICKS];
    size_t count, stored;
    size_t extracted, rejected;
    bool failed;
} chunk;

/* The extraction of a list of bricks. */
typedef struct extraction {
    iso_brick_set *set;
    const uint32_t *bricks;
    size_t count;
    iso_status status; /* status of storing results; after a failure nothing more is stored */
    iso_error *error;
} extraction;

void iso_brick_set_coordinates(const iso_brick_set *set, uint32_t number, int brick[3]) {
    uint32_t columns = (uint32_t)set->bricks[0], rows = (uint32_t)set->bricks[1];
    brick[0] = (int)(number % columns);
    brick[1] = (int)(number / columns % rows);
    brick[2] = (int)(number / columns / rows);
}

static size_t brick_total(const iso_brick_set *set) {
    return (size_t)set->bricks[0] * (size_t)set->bricks[1] * (size_t)set->bricks[2];
}

static slot *slot_at(const iso_brick_set *set, size_t number) {
    return (slot *)set->slots.data + number;
}

const uint64_t *iso_brick_set_versions(const iso_brick_set *set) {
    return set->versions.data;
}

static chunk *chunk_at(const iso_brick_set *set, size_t number) {
    return (chunk *)set->chunks.data + number;
}

/* ---- storing results */

static void release_blocks(iso_brick_set *set, slot *entry) {
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) {
        if (entry->block[heap] != ISO_SPAN_NONE) iso_span_heap_release(&set->heap[heap], entry->block[heap]);
        entry->block[heap] = ISO_SPAN_NONE;
    }
}

static void write_span(iso_brick_set *set, size_t number) {
    slot *entry = slot_at(set, number);
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) {
        uint32_t block = entry->block[heap];
        entry->location.first[heap] =
            block == ISO_SPAN_NONE ? 0 : iso_span_heap_block(&set->heap[heap], block)->first;
    }
    set->kernel.write_span((char *)set->spans.data + number * set->kernel.span_bytes, &entry->location);
}

/* Removes the span of a brick; the last span takes its place. */
static void remove_slot(iso_brick_set *set, uint32_t brick) {
    size_t number = set->span_of[brick] - 1, last = --set->span_count;
    release_blocks(set, slot_at(set, number));
    set->span_of[brick] = 0;
    if (number == last) return;
    *slot_at(set, number) = *slot_at(set, last);
    uint64_t *versions = set->versions.data;
    versions[number] = versions[last];
    set->span_of[slot_at(set, number)->brick] = (uint32_t)number + 1;
    write_span(set, number);
}

static iso_status add_slot(iso_brick_set *set, uint32_t brick, iso_error *error) {
    size_t count = set->span_count, span_bytes = set->kernel.span_bytes;
    ISO_TRY(iso_buffer_reserve(&set->slots, (count + 1) * sizeof(slot), count * sizeof(slot), error));
    ISO_TRY(iso_buffer_reserve(&set->spans, (count + 1) * span_bytes, count * span_bytes, error));
    ISO_TRY(
        iso_buffer_reserve(&set->versions, (count + 1) * sizeof(uint64_t), count * sizeof(uint64_t), error));
    slot *entry = slot_at(set, count);
    *entry = (slot){.brick = brick};
    int coordinates[3];
    iso_brick_set_coordinates(set, brick, coordinates);
    for (int axis = 0; axis < 3; axis++)
        entry->location.brick[axis] = coordinates[axis] + set->region.origin[axis];
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) entry->block[heap] = ISO_SPAN_NONE;
    set->span_of[brick] = (uint32_t)++set->span_count;
    return ISO_OK;
}

/* Sets *block to a block with room for `count` items: the old block if it is large enough, else a new one. */
static iso_status fit_block(iso_brick_set *set, iso_span_heap *heap, uint32_t *block, size_t count,
                            iso_error *error) {
    if (*block != ISO_SPAN_NONE) {
        if (count && iso_span_heap_block(heap, *block)->capacity >= count) {
            iso_span_heap_trim(heap, *block, count);
            return ISO_OK;
        }
        iso_span_heap_release(heap, *block);
        *block = ISO_SPAN_NONE;
    }
    if (!count) return ISO_OK;
    /* edited bricks get more room because they tend to grow again; in a full extraction no room is wasted */
    size_t room = set->full ? count : count + count / 8 + 8;
    return iso_span_heap_alloc(heap, room, block, error);
}

static iso_status store_result(iso_brick_set *set, const result *made, iso_error *error) {
    bool empty = true;
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) empty = empty && !made->count[heap];
    if (empty) {
        if (set->span_of[made->brick]) remove_slot(set, made->brick);
        return ISO_OK;
    }
    if (!set->span_of[made->brick]) ISO_TRY(add_slot(set, made->brick, error));
    size_t number = set->span_of[made->brick] - 1;
    slot *entry = slot_at(set, number);
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) {
        iso_status status = fit_block(set, &set->heap[heap], &entry->block[heap], made->count[heap], error);
        if (status != ISO_OK) {
            remove_slot(set, made->brick);
            return status;
        }
        entry->location.count[heap] = made->count[heap];
    }
    entry->location.own = made->own;
    ((uint64_t *)set->versions.data)[number] = ++set->stored;
    write_span(set, number);
    return ISO_OK;
}

/* ---- the output of kernels that extract several bricks at once */

/* Items go to the chunk `part` of a task. If `part` is NULL they go directly to the set's arrays: a full
 * extraction by one thread needs no copy. */
struct iso_brick_sink {
    iso_brick_set *set;
    chunk *part;
    size_t total; /* number of bricks to extract; without a part */
    void *scratch;
    iso_status status;
    iso_error *error;
};

void *iso_brick_sink_room(iso_brick_sink *sink, int array, size_t count) {
    iso_span_heap *heap = &sink->set->heap[array / ISO_SPAN_ARRAYS];
    iso_buffer *buffer = sink->part ? &sink->part->array[array] : &heap->array[array % ISO_SPAN_ARRAYS];
    size_t used = sink->part ? sink->part->used[array / ISO_SPAN_ARRAYS] : heap->end,
           bytes = sink->set->kernel.item_bytes[array];
    /* one item more than needed, so that the result is not NULL for a count of 0 */
    size_t wanted = (used + count + 1) * bytes;
    if (!sink->part && wanted > buffer->bytes) {
        const size_t foreseen =
            iso_foresee_bytes(used * bytes, sink->set->full ? sink->set->extracted : 0, sink->total);
        if (foreseen > wanted) wanted = foreseen;
    }
    iso_status status = iso_buffer_reserve(buffer, wanted, used * bytes, sink->error);
    if (status == ISO_OK) return (char *)buffer->data + used * bytes;
    sink->status = status;
    return NULL;
}

void iso_brick_sink_add(iso_brick_sink *sink, uint32_t brick, const iso_brick_output *output) {
    result made = {.brick = brick, .own = output->own};
    memcpy(made.count, output->count, sizeof made.count);
    chunk *part = sink->part;
    if (part) {
        for (int heap = 0; heap < ISO_SET_HEAPS; heap++) part->used[heap] += made.count[heap];
        part->results[part->count++] = made;
        part->extracted++;
        part->rejected += output->rejected;
    } else {
        sink->set->extracted++;
        sink->set->rejected += output->rejected;
        iso_status status = store_result(sink->set, &made, sink->error);
        if (status != ISO_OK) sink->status = status;
    }
}

bool iso_brick_sink_failed(const iso_brick_sink *sink) {
    return sink->status != ISO_OK;
}

/* Extracts one brick into scratch memory and copies the result to the sink. */
void iso_brick_sink_extract(iso_brick_sink *sink, uint32_t number) {
    const iso_brick_kernel *kernel = &sink->set->kernel;
    int brick[3];
    iso_brick_set_coordinates(sink->set, number, brick);
    iso_brick_output output = {0};
    kernel->extract(sink->set->context, brick, sink->scratch, &output);
    for (int i = 0; i < ISO_SET_ARRAYS; i++) {
        size_t count = output.count[i / ISO_SPAN_ARRAYS];
        if (!count || !kernel->item_bytes[i]) continue;
        void *room = iso_brick_sink_room(sink, i, count);
        if (!room) return;
        memcpy(room, output.items[i], count * kernel->item_bytes[i]);
    }
    iso_brick_sink_add(sink, number, &output);
}

/* Extracts bricks for which may_exist is known to be true. */
static void extract_present(iso_brick_sink *sink, const uint32_t *bricks, size_t count) {
    const iso_brick_kernel *kernel = &sink->set->kernel;
    if (kernel->extract_many) {
        if (count) kernel->extract_many(sink->set->context, bricks, count, sink->scratch, sink);
        return;
    }
    for (size_t i = 0; i < count && !iso_brick_sink_failed(sink); i++)
        iso_brick_sink_extract(sink, bricks[i]);
}

static void extract_chunk(void *context, size_t index, size_t number, int worker) {
    const extraction *work = context;
    iso_brick_set *set = work->set;
    chunk *part = chunk_at(set, number);
    memset(part->used, 0, sizeof part->used);
    part->count = part->stored = part->extracted = part->rejected = 0;
    iso_brick_sink sink = {.set = set, .part = part};
    sink.scratch = (char *)set->scratch.data + (size_t)worker * set->kernel.scratch_bytes;
    size_t start = index * CHUNK_BRICKS, end = start + CHUNK_BRICKS;
    if (end > work->count) end = work->count;
    for (size_t i = start; i < end && !iso_brick_sink_failed(&sink); i++) {
        int brick[3];
        iso_brick_set_coordinates(set, work->bricks[i], brick);
        if (set->full || set->kernel.may_exist(set->context, brick)) continue;
        extract_present(&sink, work->bricks + start, i - start);
        if (!iso_brick_sink_failed(&sink)) part->results[part->count++] = (result){.brick = work->bricks[i]};
        start = i + 1;
    }
    if (!iso_brick_sink_failed(&sink)) extract_present(&sink, work->bricks + start, end - start);
    part->failed = iso_brick_sink_failed(&sink);
}

/* Whether storing a chunk neither moves blocks nor reallocates the arrays: true in a full extraction while
 * the arrays have room. */
static bool fits_in_place(const iso_brick_set *set, const chunk *part) {
    for (int i = 0; i < ISO_SET_ARRAYS; i++) {
        const iso_span_heap *heap = &set->heap[i / ISO_SPAN_ARRAYS];
        const size_t end = heap->end + part->used[i / ISO_SPAN_ARRAYS];
        if (end * set->kernel.item_bytes[i] > heap->array[i % ISO_SPAN_ARRAYS].bytes) return false;
    }
    return set->full;
}

/* Sets `first` of each of the chunk's results: where its items are to be copied. If the heap has moved its
 * blocks together, all spans are written again before. */
static void set_locations(iso_brick_set *set, chunk *part) {
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) {
        if (!set->heap[heap].moved) continue;
        for (size_t i = 0; i < set->span_count; i++) write_span(set, i);
        set->heap[heap].moved = false;
    }
    for (size_t r = 0; r < part->stored; r++) {
        result *made = &part->results[r];
        if (!set->span_of[made->brick]) continue; /* nothing was found in the brick: it has no span */
        const iso_brick_location *location = &slot_at(set, set->span_of[made->brick] - 1)->location;
        memcpy(made->first, location->first, sizeof made->first);
    }
}

/* Reserves the set's arrays for a chunk that does not fit in them, and for what is foreseen. */
static iso_status make_room(extraction *work, const chunk *part) {
    iso_brick_set *set = work->set;
    for (int i = 0; i < ISO_SET_ARRAYS; i++) {
        iso_span_heap *heap = &set->heap[i / ISO_SPAN_ARRAYS];
        iso_buffer *array = &heap->array[i % ISO_SPAN_ARRAYS];
        const size_t bytes = set->kernel.item_bytes[i], used = heap->end * bytes;
        if (used + part->used[i / ISO_SPAN_ARRAYS] * bytes > array->bytes)
            ISO_TRY(iso_buffer_reserve(array, iso_foresee_bytes(used, set->extracted, work->count), used,
                                       work->error));
    }
    return ISO_OK;
}

static bool store_chunk(void *context, size_t number, bool alone) {
    extraction *work = context;
    iso_brick_set *set = work->set;
    chunk *part = chunk_at(set, number);
    if (!alone && !fits_in_place(set, part)) return false;
    if (alone && set->full && work->status == ISO_OK) work->status = make_room(work, part);
    while (part->stored < part->count && work->status == ISO_OK) {
        work->status = store_result(set, &part->results[part->stored], work->error);
        if (work->status == ISO_OK) part->stored++;
    }
    if (work->status == ISO_OK && part->failed)
        work->status = iso_fail(work->error, ISO_ERR_NOMEM, "out of memory while extracting bricks");
    set->extracted += part->extracted;
    if (set->full) set->rejected += part->rejected;
    set_locations(set, part);
    return true;
}

/* Copies an array of a chunk to the locations of its bricks. Neighbouring locations are joined to one copy;
 * in a full extraction all are. */
static void copy_array(const iso_brick_set *set, const chunk *part, int array) {
    const int heap = array / ISO_SPAN_ARRAYS;
    const size_t bytes = set->kernel.item_bytes[array];
    const char *source = part->array[array].data;
    char *target = set->heap[heap].array[array % ISO_SPAN_ARRAYS].data;
    size_t from = 0, to = 0, count = 0, next = 0; /* in items: the range that is to be copied next, and the
                                                     start of the next brick in the source */
    for (size_t r = 0; r < part->stored; r++) {
        const result *made = &part->results[r];
        if (!made->count[heap]) continue;
        const size_t first = made->first[heap];
        if (count && first != to + count) {
            iso_copy_stream(target + to * bytes, source + from * bytes, count * bytes);
            count = 0;
        }
        if (!count) {
            from = next;
            to = first;
        }
        count += made->count[heap];
        next += made->count[heap];
    }
    if (count) iso_copy_stream(target + to * bytes, source + from * bytes, count * bytes);
}

static void copy_chunk(void *context, size_t number) {
    const extraction *work = context;
    for (int i = 0; i < ISO_SET_ARRAYS; i++)
        if (work->set->kernel.item_bytes[i]) copy_array(work->set, chunk_at(work->set, number), i);
    iso_copy_stream_end();
}

/* ---- the bricks to extract */

static iso_status reserve_chunks(iso_brick_set *set, size_t wanted, iso_error *error) {
    size_t have = set->chunks.bytes / sizeof(chunk);
    if (wanted <= have) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&set->chunks, wanted * sizeof(chunk), have * sizeof(chunk), error));
    size_t now = set->chunks.bytes / sizeof(chunk);
    memset(chunk_at(set, have), 0, (now - have) * sizeof(chunk));
    return ISO_OK;
}

static iso_status extract_bricks(iso_brick_set *set, const uint32_t *bricks, size_t count, iso_error *error) {
    const size_t workers = (size_t)iso_pool_threads(set->pool),
                 chunks = (count + CHUNK_BRICKS - 1) / CHUNK_BRICKS;
    if (set->full && set->kernel.extract_many && workers == 1) {
        ISO_TRY(iso_buffer_reserve(&set->scratch, set->kernel.scratch_bytes, 0, error));
        iso_brick_sink sink = {.set = set, .total = count, .scratch = set->scratch.data, .error = error};
        for (size_t i = 0; i < count && !iso_brick_sink_failed(&sink) && !iso_pool_ask(set->pool);
             i += ASKED_BRICKS)
            extract_present(&sink, bricks + i, count - i < ASKED_BRICKS ? count - i : ASKED_BRICKS);
        return sink.status != ISO_OK ? sink.status : iso_pool_check(set->pool, "the surface", error);
    }
    iso_ordered steps = {.work = extract_chunk,
                         .place = store_chunk,
                         .finish = copy_chunk,
                         .slots = iso_ordered_slots(set->pool)};
    if (steps.slots > chunks) steps.slots = chunks ? chunks : 1;
    ISO_TRY(reserve_chunks(set, steps.slots, error));
    ISO_TRY(iso_buffer_reserve(&set->scratch, workers * set->kernel.scratch_bytes, 0, error));
    extraction work = {set, bricks, count, ISO_OK, error};
    iso_parallel_ordered(set->pool, chunks, &steps, &work);
    return work.status != ISO_OK ? work.status : iso_pool_check(set->pool, "the surface", error);
}

/* A survey of all bricks of the grid, on all threads: the result of may_exist by brick. */
typedef struct survey {
    const iso_brick_set *set;
    uint8_t *may_exist;
} survey;

static void survey_task(void *context, size_t index, int worker) {
    (void)worker;
    const survey *look = context;
    size_t end = (index + 1) * SURVEY_BRICKS, total = brick_total(look->set);
    for (size_t i = index * SURVEY_BRICKS; i < end && i < total; i++) {
        int brick[3];
        iso_brick_set_coordinates(look->set, (uint32_t)i, brick);
        look->may_exist[i] = look->set->kernel.may_exist(look->set->context, brick);
    }
}

/* Lists the bricks that the kernel's isovalue crosses, found by the index of an rgrid. */
static iso_status list_crossed(iso_brick_set *set, size_t *count, iso_error *error) {
    const iso_brick_index *index;
    ISO_TRY(iso_brick_index_of(set->grid.rgrid, set->pool, &index, error));
    ISO_TRY(iso_brick_index_query(index, set->kernel.isovalue(set->context), &set->query, error));
    *count = set->query.count;
    return ISO_OK;
}

/* Lists the cells of an hgrid that have a brick; cells have the same numbers as the set's bricks. */
static iso_status list_bricks(iso_brick_set *set, size_t *count, iso_error *error) {
    const iso_hgrid *grid = set->grid.hgrid;
    size_t total = brick_total(set), found = 0;
    ISO_TRY(iso_buffer_reserve(&set->list, iso_hgrid_brick_count(grid) * sizeof(uint32_t), 0, error));
    uint32_t *list = set->list.data;
    for (size_t i = 0; i < total; i++)
        if (grid->cell[i] >= 0) list[found++] = (uint32_t)i;
    *count = found;
    return ISO_OK;
}

/* Lists the bricks for which may_exist is true. */
static iso_status list_surveyed(iso_brick_set *set, size_t *count, iso_error *error) {
    size_t total = brick_total(set), found = 0;
    uint8_t *may_exist = iso_alloc(total);
    if (!may_exist) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a table of %zu bricks", total);
    iso_parallel_for(set->pool, (total + SURVEY_BRICKS - 1) / SURVEY_BRICKS, survey_task,
                     &(survey){set, may_exist});
    for (size_t i = 0; i < total; i++) found += may_exist[i];
    iso_status status = iso_buffer_reserve(&set->list, found * sizeof(uint32_t), 0, error);
    if (status == ISO_OK) {
        uint32_t *list = set->list.data;
        *count = 0;
        for (size_t i = 0; i < total; i++)
            if (may_exist[i]) list[(*count)++] = (uint32_t)i;
    }
    iso_free(may_exist);
    return status;
}

/* Lists the bricks of a chunk that the isovalue crosses. There is no index for one extraction: reading the
 * bricks' ranges takes less time. */
static iso_status list_chunk(iso_brick_set *set, size_t *count, iso_error *error) {
    const iso_brick_box *box = &set->region.box;
    const int *origin = set->region.origin;
    const size_t total = iso_brick_box_count(box);
    const float isovalue = set->kernel.isovalue(set->context);
    iso_brick_range *read = set->region.ranges ? NULL : iso_alloc(total * sizeof *read);
    if (!set->region.ranges && !read)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a table of %zu bricks", total);
    if (read) iso_grid_chunk_ranges(set->grid.rgrid, &set->region, set->pool, read);
    const iso_brick_range *range = read ? read : set->region.ranges;
    iso_status status = iso_buffer_reserve(&set->list, total * sizeof(uint32_t), 0, error);
    uint32_t *list = set->list.data;
    *count = 0;
    for (int z = box->first[2]; z < box->end[2] && status == ISO_OK; z++)
        for (int y = box->first[1]; y < box->end[1]; y++)
            for (int x = box->first[0]; x < box->end[0]; x++, range++)
                if (range->lo < isovalue && isovalue <= range->hi)
                    list[(*count)++] =
                        (uint32_t)(((z - origin[2]) * set->bricks[1] + y - origin[1]) * set->bricks[0] + x -
                                   origin[0]);
    iso_free(read);
    return status;
}

/* Lists all bricks of the grid that may have results, in ascending order. */
static iso_status list_all(iso_brick_set *set, const uint32_t **list, size_t *count, iso_error *error) {
    if (set->restricted) {
        ISO_TRY(list_chunk(set, count, error));
        *list = set->list.data;
        return ISO_OK;
    }
    if (set->grid.rgrid && set->kernel.isovalue) {
        ISO_TRY(list_crossed(set, count, error));
        *list = set->query.bricks.data;
        return ISO_OK;
    }
    bool sparse = set->grid.hgrid && set->kernel.bricks_only;
    ISO_TRY(sparse ? list_bricks(set, count, error) : list_surveyed(set, count, error));
    *list = set->list.data;
    return ISO_OK;
}

static void clear_spans(iso_brick_set *set) {
    for (size_t i = 0; i < set->span_count; i++) set->span_of[slot_at(set, i)->brick] = 0;
    set->span_count = 0;
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) iso_span_heap_clear(&set->heap[heap]);
}

static iso_status list_changed(iso_brick_set *set, size_t *count, iso_error *error) {
    const iso_change *changes = NULL;
    size_t change_count = iso_change_log_since(iso_grid_log(&set->grid), set->seen, &changes);
    const iso_changes all = {changes, change_count, set->bricks};
    return iso_halo_bricks(&all, set->kernel.halo, &set->list, count, error);
}

/* Frees what extracting all bricks took: later updates extract a few. */
static void free_working_memory(iso_brick_set *set) {
    size_t bytes = 0; /* of the set's own memory */
    for (size_t c = 0; c < set->chunks.bytes / sizeof(chunk); c++)
        for (int i = 0; i < ISO_SET_ARRAYS; i++) iso_buffer_free(&chunk_at(set, c)->array[i]);
    for (int i = 0; i < ISO_SET_ARRAYS; i++)
        bytes += set->heap[i / ISO_SPAN_ARRAYS].end * set->kernel.item_bytes[i];
    iso_buffer_free(&set->chunks);
    iso_buffer_free(&set->scratch);
    iso_buffer_free(&set->list);
    iso_brick_query_free(&set->query);
    if (bytes > TRIMMED_BYTES) iso_memory_trim();
}

iso_status iso_brick_set_update(iso_brick_set *set, iso_error *error) {
    uint64_t now = iso_change_log_now(iso_grid_log(&set->grid));
    const uint32_t *list = NULL;
    size_t count = 0;
    set->extracted = 0;
    if (set->full) {
        set->rejected = 0;
        clear_spans(set);
        ISO_TRY(list_all(set, &list, &count, error));
    } else {
        ISO_TRY(list_changed(set, &count, error));
        list = set->list.data;
    }
    iso_status status = extract_bricks(set, list, count, error);
    if (set->full) free_working_memory(set);
    if (status != ISO_OK) {
        if (set->full) clear_spans(set);
        return status;
    }
    set->full = false;
    set->seen = now;
    return ISO_OK;
}

iso_status iso_brick_set_init(iso_brick_set *set, const iso_brick_kernel *kernel, const void *context,
                              const iso_grid *grid, iso_pool *pool, iso_error *error) {
    *set = (iso_brick_set){.kernel = *kernel, .context = context, .grid = *grid, .pool = pool, .full = true};
    iso_grid_bricks(grid, set->bricks);
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) {
        memcpy(set->heap[heap].item_bytes, kernel->item_bytes + heap * ISO_SPAN_ARRAYS,
               sizeof set->heap[heap].item_bytes);
        iso_span_heap_clear(&set->heap[heap]);
    }
    set->span_of = iso_alloc_zero(brick_total(set), sizeof *set->span_of);
    if (!set->span_of)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a table of %zu bricks", brick_total(set));
    return ISO_OK;
}

void iso_brick_set_restrict(iso_brick_set *set, const iso_grid_chunk *region) {
    set->restricted = true;
    set->region = *region;
}

void iso_brick_set_free(iso_brick_set *set) {
    free_working_memory(set);
    for (int heap = 0; heap < ISO_SET_HEAPS; heap++) iso_span_heap_free(&set->heap[heap]);
    iso_buffer_free(&set->spans);
    iso_buffer_free(&set->slots);
    iso_buffer_free(&set->versions);
    iso_free(set->span_of);
}

const int *iso_brick_set_dims(const iso_brick_set *set) {
    return set->restricted ? set->region.dims : iso_grid_dims(&set->grid);
}

void iso_brick_set_reset(iso_brick_set *set) {
    set->full = true;
}

const void *iso_brick_set_items(const iso_brick_set *set, int heap, int array) {
    return set->heap[heap].live ? set->heap[heap].array[array].data : NULL;
}
