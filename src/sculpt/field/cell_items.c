/* Stores items, counts their owners, and packs them. */
#include "sculpt/field/cell_items.h"

#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "sculpt/field/mask.h"
#include "sculpt/field/paint.h"

/* What lies before an item; as large as the alignment of items. */
typedef union item_head {
    atomic_size_t owners;
    uint8_t room[64];
} item_head;

static item_head *head_of(void *item) {
    return (item_head *)item - 1;
}

void *iso_item_create(size_t bytes) {
    item_head *head = iso_alloc(sizeof *head + bytes);
    if (!head) return NULL;
    atomic_init(&head->owners, 1);
    return head + 1;
}

void *iso_item_share(void *item) {
    if (item) atomic_fetch_add(&head_of(item)->owners, 1);
    return item;
}

void iso_item_release(void *item) {
    if (item && atomic_fetch_sub(&head_of(item)->owners, 1) == 1) iso_free(head_of(item));
}

static iso_status no_memory(const iso_cell_items *items, iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %s", items->name);
}

iso_status iso_cell_items_init(iso_cell_items *items, const char *name, size_t cells, size_t bytes,
                               iso_error *error) {
    *items = (iso_cell_items){.cells = cells, .bytes = bytes, .name = name};
    items->cell = iso_alloc_zero(cells, sizeof *items->cell);
    return items->cell ? ISO_OK : no_memory(items, error);
}

void iso_cell_items_give(iso_cell_items *items, size_t cell, void *item) {
    items->used += (item != NULL) - (size_t)(items->cell[cell] != NULL);
    iso_item_release(items->cell[cell]);
    items->cell[cell] = item;
}

void iso_cell_items_clear(iso_cell_items *items) {
    for (size_t i = 0; items->used && i < items->cells; i++) iso_cell_items_give(items, i, NULL);
}

void iso_cell_items_free(iso_cell_items *items) {
    iso_cell_items_clear(items);
    iso_free(items->cell);
    items->cell = NULL;
}

static bool any_set(const void *item, size_t bytes) {
    const uint32_t *words = item;
    uint32_t any = 0;
    for (size_t i = 0; i < bytes / sizeof *words; i++) any |= words[i];
    return any != 0;
}

iso_status iso_cell_items_reserve(iso_cell_items *items, size_t cell, iso_error *error) {
    void *now = items->cell[cell];
    if (now && atomic_load(&head_of(now)->owners) == 1) return ISO_OK;
    void *own = iso_item_create(items->bytes);
    if (!own) return no_memory(items, error);
    if (now)
        memcpy(own, now, items->bytes);
    else
        memset(own, 0, items->bytes);
    iso_cell_items_give(items, cell, own);
    return ISO_OK;
}

iso_status iso_cell_items_set(iso_cell_items *items, size_t cell, const void *item, iso_error *error) {
    if (!item || !any_set(item, items->bytes)) {
        iso_cell_items_give(items, cell, NULL);
        return ISO_OK;
    }
    if (item == items->cell[cell]) return ISO_OK;
    ISO_TRY(iso_cell_items_reserve(items, cell, error));
    memcpy(items->cell[cell], item, items->bytes);
    return ISO_OK;
}

iso_status iso_cell_items_copy(const iso_cell_items *items, iso_cell_items *copy, iso_error *error) {
    ISO_TRY(iso_cell_items_init(copy, items->name, items->cells, items->bytes, error));
    for (size_t i = 0; items->used && i < items->cells; i++)
        if (items->cell[i]) iso_cell_items_give(copy, i, iso_item_share(items->cell[i]));
    return ISO_OK;
}

/* ---- packing */

/* Bytes of the bits for the words of an item. */
static size_t bit_bytes(size_t bytes) {
    return (bytes / sizeof(uint32_t) + 7) / 8;
}

size_t iso_item_pack_size(const void *item, size_t bytes) {
    const uint32_t *words = item;
    size_t other = 0;
    for (size_t i = 0; i < bytes / sizeof *words; i++) other += words[i] != (i ? words[i - 1] : 0);
    return bit_bytes(bytes) + other * sizeof *words;
}

void iso_item_pack(const void *item, size_t bytes, uint8_t *packed) {
    const uint32_t *words = item;
    uint8_t *at = packed + bit_bytes(bytes);
    memset(packed, 0, bit_bytes(bytes));
    for (size_t i = 0; i < bytes / sizeof *words; i++) {
        if (words[i] == (i ? words[i - 1] : 0)) continue;
        packed[i / 8] = (uint8_t)(packed[i / 8] | 1u << i % 8);
        memcpy(at, &words[i], sizeof *words);
        at += sizeof *words;
    }
}

bool iso_item_unpack(const uint8_t *packed, size_t size, size_t bytes, void *item) {
    uint32_t *words = item, word = 0;
    if (size < bit_bytes(bytes)) return false;
    const uint8_t *at = packed + bit_bytes(bytes), *end = packed + size;
    for (size_t i = 0; i < bytes / sizeof *words; i++) {
        if (packed[i / 8] >> i % 8 & 1) {
            if (end - at < (ptrdiff_t)sizeof word) return false;
            memcpy(&word, at, sizeof word);
            at += sizeof word;
        }
        words[i] = word;
    }
    return at == end;
}

/* ---- all kinds */

iso_status iso_field_items_init(iso_field_items *items, size_t cells, iso_error *error) {
    items->of[ISO_ITEM_PAINT] = (iso_cell_items){.cells = 0};
    ISO_TRY(iso_mask_init(&items->of[ISO_ITEM_MASK], cells, error));
    const iso_status status =
        iso_cell_items_init(&items->of[ISO_ITEM_PAINT], "the paint", cells, sizeof(iso_paint_item), error);
    if (status != ISO_OK) iso_cell_items_free(&items->of[ISO_ITEM_MASK]);
    return status;
}

void iso_field_items_free(iso_field_items *items) {
    for (int i = 0; i < ISO_ITEM_KINDS; i++) iso_cell_items_free(&items->of[i]);
}

void iso_field_items_clear(iso_field_items *items) {
    for (int i = 0; i < ISO_ITEM_KINDS; i++) iso_cell_items_clear(&items->of[i]);
}

iso_status iso_field_items_copy(const iso_field_items *items, iso_field_items *copy, iso_error *error) {
    *copy = (iso_field_items){.of = {{.cells = 0}}};
    for (int i = 0; i < ISO_ITEM_KINDS; i++) {
        const iso_status status = iso_cell_items_copy(&items->of[i], &copy->of[i], error);
        if (status == ISO_OK) continue;
        iso_field_items_free(copy);
        return status;
    }
    return ISO_OK;
}
