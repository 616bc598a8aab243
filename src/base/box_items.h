/* box_items: the box of the positions in items, such as spans of bricks, for each of which a larger box is
 * known. Only the items at the border of the result are looked into. */
#ifndef ISO_BASE_BOX_ITEMS_H
#define ISO_BASE_BOX_ITEMS_H

#include <stddef.h>

#include "base/geometry.h"

typedef struct iso_box_items {
    const void *context;
    size_t count;
    /* Returns a box, in index coordinates, that contains all positions of an item; empty: there are none.
     * NULL: no boxes are known, and all items are looked into. */
    iso_box (*around)(const void *context, size_t item);
    /* Adds the positions of an item to *box, in the coordinates to which `affine` (NULL: the identity) maps
     * index coordinates. Positions that lie in *box already may be left out. May be called twice. */
    void (*add)(const void *context, size_t item, const iso_affine *affine, iso_box *box);
} iso_box_items;

/* Returns the box of all positions, in the coordinates to which `affine` (NULL: the identity) maps index
 * coordinates. */
iso_box iso_box_of_items(const iso_box_items *items, const iso_affine *affine);

/* Whether `box` contains the box to which `affine` (NULL: the identity) maps the corners of `index`. */
bool iso_box_contains_mapped(const iso_box *box, const iso_box *index, const iso_affine *affine);

#endif
