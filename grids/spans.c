/* The span allocator. Each block has a record; the records form a doubly linked list in the order of the
 * array, and those of free blocks also the list of their size class. */
#include "grids/spans.h"

#include <string.h>

/* If fewer items than this remain when a block is divided, they stay with the block, because so small a block
 * would hardly be used again. */
enum { SMALLEST_SPLIT = 16 };

static iso_span_block *record_at(iso_span_heap *heap, uint32_t block) {
    return (iso_span_block *)heap->records.data + block;
}

/* Returns the class of a size: one class for each size below 8, then eight for each power of two. */
static unsigned class_of(size_t size) {
    if (size < 8) return (unsigned)size;
    unsigned octave = 63 - (unsigned)__builtin_clzll(size);
    return (octave - 2) * 8 + (size >> (octave - 3) & 7);
}

/* Returns the lowest class whose blocks all have at least `size` items. */
static unsigned class_above(size_t size) {
    if (size < 8) return (unsigned)size;
    unsigned octave = 63 - (unsigned)__builtin_clzll(size);
    return class_of(size + ((size_t)1 << (octave - 3)) - 1);
}

static void bin_insert(iso_span_heap *heap, uint32_t block) {
    iso_span_block *record = record_at(heap, block);
    unsigned bin = class_of(record->capacity);
    record->used = false;
    record->previous = ISO_SPAN_NONE;
    record->next = heap->bins[bin];
    if (record->next != ISO_SPAN_NONE) record_at(heap, record->next)->previous = block;
    heap->bins[bin] = block;
    heap->occupied[bin / 64] |= (uint64_t)1 << bin % 64;
}

static void bin_remove(iso_span_heap *heap, uint32_t block) {
    iso_span_block *record = record_at(heap, block);
    unsigned bin = class_of(record->capacity);
    if (record->next != ISO_SPAN_NONE) record_at(heap, record->next)->previous = record->previous;
    if (record->previous != ISO_SPAN_NONE)
        record_at(heap, record->previous)->next = record->next;
    else
        heap->bins[bin] = record->next;
    if (heap->bins[bin] == ISO_SPAN_NONE) heap->occupied[bin / 64] &= ~((uint64_t)1 << bin % 64);
}

static uint32_t bin_find(const iso_span_heap *heap, size_t count) {
    unsigned bin = class_above(count), word = bin / 64;
    uint64_t bits = heap->occupied[word] & ~(uint64_t)0 << bin % 64;
    while (!bits && ++word < ISO_SPAN_CLASSES / 64) bits = heap->occupied[word];
    if (bits) return heap->bins[word * 64 + (unsigned)__builtin_ctzll(bits)];
    uint32_t block = heap->bins[class_of(count)]; /* the first block of a lower class may be large enough */
    if (block != ISO_SPAN_NONE && iso_span_heap_block(heap, block)->capacity >= count) return block;
    return ISO_SPAN_NONE;
}

static iso_status reserve_record(iso_span_heap *heap, iso_error *error) {
    if (heap->unused != ISO_SPAN_NONE) return ISO_OK;
    size_t bytes = sizeof(iso_span_block);
    return iso_buffer_reserve(&heap->records, (heap->record_count + 1) * bytes, heap->record_count * bytes,
                              error);
}

/* Takes a record and links it into the list after `before`. reserve_record has made room for it. */
static uint32_t link_record(iso_span_heap *heap, uint32_t before) {
    uint32_t block = heap->unused;
    if (block != ISO_SPAN_NONE)
        heap->unused = record_at(heap, block)->next;
    else
        block = (uint32_t)heap->record_count++;
    uint32_t after = before != ISO_SPAN_NONE ? record_at(heap, before)->after : heap->first;
    *record_at(heap, block) = (iso_span_block){.before = before, .after = after, .used = true};
    *(before != ISO_SPAN_NONE ? &record_at(heap, before)->after : &heap->first) = block;
    *(after != ISO_SPAN_NONE ? &record_at(heap, after)->before : &heap->last) = block;
    return block;
}

static void unlink_record(iso_span_heap *heap, uint32_t block) {
    iso_span_block *record = record_at(heap, block);
    uint32_t before = record->before, after = record->after;
    *(before != ISO_SPAN_NONE ? &record_at(heap, before)->after : &heap->first) = after;
    *(after != ISO_SPAN_NONE ? &record_at(heap, after)->before : &heap->last) = before;
    record->next = heap->unused;
    heap->unused = block;
}

void iso_span_heap_clear(iso_span_heap *heap) {
    heap->record_count = 0;
    heap->unused = heap->first = heap->last = ISO_SPAN_NONE;
    heap->end = heap->live = 0;
    for (int bin = 0; bin < ISO_SPAN_CLASSES; bin++) heap->bins[bin] = ISO_SPAN_NONE;
    memset(heap->occupied, 0, sizeof heap->occupied);
    heap->moved = false;
}

void iso_span_heap_free(iso_span_heap *heap) {
    for (int i = 0; i < ISO_SPAN_ARRAYS; i++) iso_buffer_free(&heap->array[i]);
    iso_buffer_free(&heap->records);
}

static void move_items(iso_span_heap *heap, size_t from, size_t to, size_t count) {
    for (int i = 0; i < ISO_SPAN_ARRAYS; i++) {
        char *data = heap->array[i].data;
        size_t bytes = heap->item_bytes[i];
        if (bytes) memmove(data + to * bytes, data + from * bytes, count * bytes);
    }
}

/* Moves all used blocks to the beginning of the array, without gaps. */
static void compact_blocks(iso_span_heap *heap) {
    size_t end = 0;
    for (uint32_t block = heap->first, after; block != ISO_SPAN_NONE; block = after) {
        iso_span_block *record = record_at(heap, block);
        after = record->after;
        if (!record->used) {
            bin_remove(heap, block);
            unlink_record(heap, block);
            continue;
        }
        if (record->first != end) move_items(heap, record->first, end, record->capacity);
        record->first = end;
        end += record->capacity;
    }
    heap->end = end;
    heap->moved = true;
}

static iso_status append_block(iso_span_heap *heap, size_t count, uint32_t *block, iso_error *error) {
    if (heap->end + count > 2 * (heap->live + count) + ISO_SPAN_HEAP_SLACK) compact_blocks(heap);
    for (int i = 0; i < ISO_SPAN_ARRAYS; i++) {
        size_t bytes = heap->item_bytes[i];
        ISO_TRY(iso_buffer_reserve(&heap->array[i], (heap->end + count) * bytes, heap->end * bytes, error));
    }
    *block = link_record(heap, heap->last);
    record_at(heap, *block)->first = heap->end;
    record_at(heap, *block)->capacity = count;
    heap->end += count;
    heap->live += count;
    return ISO_OK;
}

/* Makes the items of a used block from item `count` on a free block. reserve_record has made room for its
 * record. */
static void split_block(iso_span_heap *heap, uint32_t block, size_t count) {
    uint32_t rest = link_record(heap, block);
    iso_span_block *record = record_at(heap, block), *tail = record_at(heap, rest);
    tail->first = record->first + count;
    tail->capacity = record->capacity - count;
    record->capacity = count;
    iso_span_heap_release(heap, rest);
}

iso_status iso_span_heap_alloc(iso_span_heap *heap, size_t count, uint32_t *block, iso_error *error) {
    ISO_TRY(reserve_record(heap, error));
    uint32_t found = bin_find(heap, count);
    if (found == ISO_SPAN_NONE) return append_block(heap, count, block, error);
    bin_remove(heap, found);
    iso_span_block *record = record_at(heap, found);
    record->used = true;
    heap->live += record->capacity;
    if (record->capacity - count >= SMALLEST_SPLIT) split_block(heap, found, count);
    *block = found;
    return ISO_OK;
}

/* Joins a block with the free block `next` that follows it. */
static void merge_blocks(iso_span_heap *heap, uint32_t block, uint32_t next) {
    record_at(heap, block)->capacity += record_at(heap, next)->capacity;
    unlink_record(heap, next);
}

void iso_span_heap_release(iso_span_heap *heap, uint32_t block) {
    heap->live -= record_at(heap, block)->capacity;
    uint32_t after = record_at(heap, block)->after, before = record_at(heap, block)->before;
    if (after != ISO_SPAN_NONE && !record_at(heap, after)->used) {
        bin_remove(heap, after);
        merge_blocks(heap, block, after);
    }
    if (before != ISO_SPAN_NONE && !record_at(heap, before)->used) {
        bin_remove(heap, before);
        merge_blocks(heap, before, block);
        block = before;
    }
    if (heap->last == block) { /* the array never ends in free space */
        heap->end = record_at(heap, block)->first;
        unlink_record(heap, block);
    } else {
        bin_insert(heap, block);
    }
}

void iso_span_heap_trim(iso_span_heap *heap, uint32_t block, size_t count) {
    size_t capacity = record_at(heap, block)->capacity, wanted = count + count / 8 + SMALLEST_SPLIT;
    if (capacity < 2 * wanted) return;
    if (reserve_record(heap, NULL) == ISO_OK) split_block(heap, block, wanted);
}
