/* disjoint_sets: union-find over the numbers 0 .. n - 1, with path halving (Tarjan and van Leeuwen 1984).
 * parent[i] is i itself or a lower number of the same set; initialise parent[i] = i. The root of a set is its
 * lowest number, so that results do not depend on the order of unions. Internal; one thread at a time. */
#ifndef ISO_BASE_DISJOINT_SETS_H
#define ISO_BASE_DISJOINT_SETS_H

#include <stdint.h>

static inline uint32_t iso_set_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void iso_set_unite(uint32_t *parent, uint32_t a, uint32_t b) {
    a = iso_set_root(parent, a);
    b = iso_set_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

#endif
