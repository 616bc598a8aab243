/* The span allocator: blocks do not overlap, free space is reused, and a fragmented heap is compacted. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "extract_support.h"
#include "grids/spans.h"

enum { HEAP_BLOCKS = 300 };

/* Blocks lie one after another, free ones never side by side nor last, and each free one is in one list. */
static void check_heap_links(const iso_span_heap *heap) {
    size_t end = 0, live = 0, idle = 0, listed = 0;
    uint32_t before = ISO_SPAN_NONE;
    bool free_before = false;
    for (uint32_t block = heap->first; block != ISO_SPAN_NONE;) {
        const iso_span_block *record = iso_span_heap_block(heap, block);
        assert_int_equal(record->first, end);
        assert_int_equal(record->before, before);
        assert_true(record->capacity > 0 && (record->used || !free_before));
        free_before = !record->used;
        idle += free_before;
        live += record->used ? record->capacity : 0;
        end += record->capacity;
        before = block;
        block = record->after;
    }
    assert_false(free_before);
    assert_int_equal(heap->last, before);
    assert_int_equal(heap->end, end);
    assert_int_equal(heap->live, live);
    for (unsigned bin = 0; bin < ISO_SPAN_CLASSES; bin++) {
        bool occupied = heap->occupied[bin / 64] >> bin % 64 & 1;
        assert_int_equal(occupied, heap->bins[bin] != ISO_SPAN_NONE);
        for (uint32_t block = heap->bins[bin]; block != ISO_SPAN_NONE; listed++) {
            assert_false(iso_span_heap_block(heap, block)->used);
            block = iso_span_heap_block(heap, block)->next;
        }
    }
    assert_int_equal(listed, idle);
}

/* Every item of a block carries the block's number: nobody else may write there. */
static void check_heap_contents(const iso_span_heap *heap, const uint32_t block[], const size_t count[]) {
    check_heap_links(heap);
    for (int b = 0; b < HEAP_BLOCKS; b++) {
        if (block[b] == ISO_SPAN_NONE) continue;
        const iso_span_block *record = iso_span_heap_block(heap, block[b]);
        assert_true(record->capacity >= count[b]);
        for (size_t i = 0; i < count[b]; i++) {
            assert_int_equal(((const uint32_t *)heap->array[0].data)[record->first + i], b);
            assert_int_equal(((const uint8_t *)heap->array[1].data)[record->first + i], b % 256);
        }
    }
}

static void blocks_keep_apart(void **state) {
    (void)state;
    iso_span_heap heap = {.item_bytes = {4, 1}};
    iso_span_heap_clear(&heap);
    uint32_t block[HEAP_BLOCKS];
    size_t count[HEAP_BLOCKS] = {0};
    for (int b = 0; b < HEAP_BLOCKS; b++) block[b] = ISO_SPAN_NONE;
    test_random random = {61};
    size_t peak = 0;
    for (int step = 0; step < 60000; step++) {
        int b = test_random_int(&random, 0, HEAP_BLOCKS - 1), phase = step / 10000 % 2;
        if (block[b] != ISO_SPAN_NONE && test_random_int(&random, 0, 3) == 0) {
            count[b] = (size_t)test_random_int(&random, 1, (int)count[b]);
            iso_span_heap_trim(&heap, block[b], count[b]);
        } else if (block[b] != ISO_SPAN_NONE) {
            iso_span_heap_release(&heap, block[b]);
            block[b] = ISO_SPAN_NONE;
        } else {
            int most = phase ? 100 : 3000;
            count[b] = (size_t)test_random_int(&random, 1, most);
            assert_int_equal(iso_span_heap_alloc(&heap, count[b], &block[b], NULL), ISO_OK);
            const iso_span_block *record = iso_span_heap_block(&heap, block[b]);
            assert_true(record->capacity < count[b] + 16); /* what is left over is free again */
            size_t first = record->first;
            for (size_t i = 0; i < count[b]; i++) {
                ((uint32_t *)heap.array[0].data)[first + i] = (uint32_t)b;
                ((uint8_t *)heap.array[1].data)[first + i] = (uint8_t)b;
            }
        }
        if (heap.live > peak) peak = heap.live;
        assert_true(heap.end <= 2 * peak + ISO_SPAN_HEAP_SLACK);
        if (step % 100 == 0) check_heap_contents(&heap, block, count);
    }
    check_heap_contents(&heap, block, count);
    for (int b = 0; b < HEAP_BLOCKS; b++)
        if (block[b] != ISO_SPAN_NONE) iso_span_heap_release(&heap, block[b]);
    check_heap_links(&heap);
    assert_int_equal(heap.end, 0);
    iso_span_heap_free(&heap);
}

/* Free space in pieces too small for anything: the blocks slide together, whole and in order. */
static void holes_are_closed(void **state) {
    (void)state;
    enum { BLOCKS = 4000, ITEMS = 100 };
    iso_span_heap heap = {.item_bytes = {4}};
    iso_span_heap_clear(&heap);
    uint32_t block[BLOCKS], large;
    for (uint32_t b = 0; b < BLOCKS; b++) {
        assert_int_equal(iso_span_heap_alloc(&heap, ITEMS, &block[b], NULL), ISO_OK);
        size_t first = iso_span_heap_block(&heap, block[b])->first;
        assert_int_equal(first, b * ITEMS);
        for (size_t i = 0; i < ITEMS; i++) ((uint32_t *)heap.array[0].data)[first + i] = b;
    }
    for (uint32_t b = 0; b < BLOCKS; b++)
        if (b % 4) iso_span_heap_release(&heap, block[b]);
    assert_false(heap.moved);
    assert_int_equal(iso_span_heap_alloc(&heap, 30 * ITEMS, &large, NULL), ISO_OK);
    assert_true(heap.moved);
    check_heap_links(&heap);
    assert_int_equal(heap.end, (BLOCKS / 4 + 30) * ITEMS);
    for (uint32_t b = 0; b < BLOCKS; b += 4) {
        size_t first = iso_span_heap_block(&heap, block[b])->first;
        assert_int_equal(first, b / 4 * ITEMS);
        for (size_t i = 0; i < ITEMS; i++) assert_int_equal(((uint32_t *)heap.array[0].data)[first + i], b);
    }
    iso_span_heap_free(&heap);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_keep_apart),
        cmocka_unit_test(holes_are_closed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
