/* disjoint_sets: sets of numbered items that can be united, for connected components (union-find with path
 * halving; Tarjan and van Leeuwen 1984). parent[i] is i itself or a lower number of the same set; begin with
 * parent[i] = i. The root of a set is its lowest number, in whatever order sets are united. One thread at a
 * time. Internal. */
#ifndef ISO_BASE_DISJOINT_SETS_H
#define ISO_BASE_DISJOINT_SETS_H

#include <stdint.h>

/* Returns the root of the set that item i belongs to. */
static inline uint32_t iso_set_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

/* Unites the sets that items a and b belong to. */
static inline void iso_set_unite(uint32_t *parent, uint32_t a, uint32_t b) {
    a = iso_set_root(parent, a);
    b = iso_set_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

#endif
