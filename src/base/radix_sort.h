/* radix_sort: sorts numbered items by whole numbers, in time proportional to their count. */
#ifndef ISO_BASE_RADIX_SORT_H
#define ISO_BASE_RADIX_SORT_H

#include <stddef.h>
#include <stdint.h>

/* An item: the number that it is sorted by, and which item it is. */
typedef struct iso_radix_item {
    uint32_t key, index;
} iso_radix_item;

/* Sorts items by the lowest `bits` bits of their keys, which have no other bits; items with equal keys keep
 * their order. `spare` has room for as many items. Returns the array that has the result: `items` or `spare`;
 * the contents of the other one are undefined. */
iso_radix_item *iso_radix_sort(iso_radix_item *items, iso_radix_item *spare, size_t count, int bits);

#endif
