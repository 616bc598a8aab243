/* cell_items: what cells of a field have beside their distances: of each kind an item of a fixed size, or
 * none, which is the same as an item of zeros. The kinds are the mask and the paint of a field (mask.h,
 * paint.h).
 *
 * Copies share items, so they cost next to nothing: an item that is shared is not written, but replaced. One
 * thread writes the items of a field; a copy may be read and freed by another one. Internal to sculpt, except
 * reading. */
#ifndef ISO_SCULPT_FIELD_CELL_ITEMS_H
#define ISO_SCULPT_FIELD_CELL_ITEMS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/status.h"

ISO_C_BEGIN

/* Zero-initialise; iso_cell_items_free when done. */
typedef struct iso_cell_items {
    void **cell;      /* indexed by cell: its item; NULL: none */
    size_t cells;     /* cells of the grid */
    size_t used;      /* cells that have an item */
    size_t bytes;     /* of an item: a multiple of 4 */
    const char *name; /* for messages: "the mask"; a static string */
} iso_cell_items;

/* Prepares for a grid of `cells` cells, which have no items. ISO_ERR_NOMEM. */
iso_status iso_cell_items_init(iso_cell_items *items, const char *name, size_t cells, size_t bytes,
                               iso_error *error);
void iso_cell_items_free(iso_cell_items *items);
/* Removes all items. */
void iso_cell_items_clear(iso_cell_items *items);

/* Makes sure that a cell has an item of its own that is not shared, of zeros if it had none, so that
 * iso_cell_items_set cannot fail for it. ISO_ERR_NOMEM: all is as before. */
iso_status iso_cell_items_reserve(iso_cell_items *items, size_t cell, iso_error *error);
/* Sets the item of a cell to a copy of `item`. NULL, or an item of zeros, removes the cell's. ISO_ERR_NOMEM:
 * all is as before. */
iso_status iso_cell_items_set(iso_cell_items *items, size_t cell, const void *item, iso_error *error);
/* Makes `copy`, which is overwritten, a copy. ISO_ERR_NOMEM. */
iso_status iso_cell_items_copy(const iso_cell_items *items, iso_cell_items *copy, iso_error *error);

/* Items on their own, with one owner each. Make one, uninitialised (NULL: no memory); for any thread. */
void *iso_item_create(size_t bytes);
/* Makes one more owner of an item, which returns it, and ends the ownership of one; NULL is allowed. */
void *iso_item_share(void *item);
void iso_item_release(void *item);
/* Gives an item, or none (NULL), to a cell, which owns it from now on. */
void iso_cell_items_give(iso_cell_items *items, size_t cell, void *item);

/* Lossless compression of an item: a bit for each word that differs from the one before it, then those words.
 * _size_ returns the size in bytes of what _pack_ writes. _unpack_: false: it is no packed item of this size.
 */
size_t iso_item_pack_size(const void *item, size_t bytes);
void iso_item_pack(const void *item, size_t bytes, uint8_t *packed);
bool iso_item_unpack(const uint8_t *packed, size_t size, size_t bytes, void *item);

/* ---- all kinds */

typedef enum iso_item_kind { ISO_ITEM_MASK, ISO_ITEM_PAINT, ISO_ITEM_KINDS } iso_item_kind;
typedef struct iso_field_items {
    iso_cell_items of[ISO_ITEM_KINDS];
} iso_field_items;

/* The same for all kinds. */
iso_status iso_field_items_init(iso_field_items *items, size_t cells, iso_error *error);
void iso_field_items_free(iso_field_items *items);
void iso_field_items_clear(iso_field_items *items);
iso_status iso_field_items_copy(const iso_field_items *items, iso_field_items *copy, iso_error *error);

ISO_C_END
#endif
