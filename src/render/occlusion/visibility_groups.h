/* visibility_groups: where the nodes of a visibility lie in memory. Internal to render/occlusion. */
#ifndef ISO_RENDER_OCCLUSION_VISIBILITY_GROUPS_H
#define ISO_RENDER_OCCLUSION_VISIBILITY_GROUPS_H

#include <stdatomic.h>

#include "render/occlusion/visibility.h"

/* Voxels of a group along y and z; along x it is a word. */
enum {
    ISO_VISIBILITY_Y = 16,
    ISO_VISIBILITY_Z = 4,
    ISO_VISIBILITY_ROWS = ISO_VISIBILITY_Y * ISO_VISIBILITY_Z
};

/* The light at a node: with a normal n the sum of linear[i] n[i], quadratic[i] n[i]^2, and mixed[0] n[0]
 * n[1], mixed[1] n[0] n[2], mixed[2] n[1] n[2]; all times 1 / ISO_NODE_ONE. */
typedef struct iso_node {
    int16_t linear[3], quadratic[3], mixed[3];
} iso_node;
enum { ISO_NODE_TERMS = 9, ISO_NODE_ONE = 8192 };
/* Not less than this where all directions are free: terms are rounded, those of eight directions together. */
enum { ISO_NODE_ALL = ISO_NODE_ONE - ISO_DIRECTIONS_MAX / 8 };

/* The nodes of a group, row by row: those of a row are its set bits, and lie at nodes[first]. */
typedef struct iso_node_group {
    uint32_t node[ISO_VISIBILITY_ROWS];
    uint16_t first[ISO_VISIBILITY_ROWS];
    iso_node nodes[];
} iso_node_group;

/* The terms of eight directions, by the mask of those that are free. */
typedef int16_t iso_node_terms[256][16];

/* A voxel that a ray passes, relative to its node: words to the right, and the bit in the word. */
typedef struct iso_ray_step {
    int column, shift, y, z;
} iso_ray_step;

typedef struct iso_visibility_ray {
    iso_ray_step *steps;
    int count;
} iso_visibility_ray;

struct iso_visibility {
    const iso_solid_bits *bits;
    iso_directions directions;
    iso_visibility_ray rays[ISO_DIRECTIONS_MAX];
    iso_ray_step *steps; /* of all rays */
    iso_node_terms *terms;
    int reach[3]; /* the most voxels that a ray goes along each axis */
    int groups[3];
    iso_node_group **group; /* NULL: not computed */
    atomic_uchar *wanted;   /* of each group */
    uint32_t *list;         /* of those that are to be computed */
    atomic_bool any_wanted, failed;
};

static inline size_t iso_group_number(const iso_visibility *v, int x, int y, int z) {
    return ((size_t)z * (size_t)v->groups[1] + (size_t)y) * (size_t)v->groups[0] + (size_t)x;
}

typedef enum iso_found { ISO_FOUND_NONE, ISO_FOUND_NODE, ISO_FOUND_MISSING } iso_found;

static inline unsigned iso_count_bits(uint32_t word) {
    word -= word >> 1 & 0x55555555u;
    word = (word & 0x33333333u) + (word >> 2 & 0x33333333u);
    return ((word + (word >> 4)) & 0x0F0F0F0Fu) * 0x01010101u >> 24;
}

/* Looks for a node at voxel (x, y, z), which may lie outside the lattice. MISSING: it has not been computed,
 * and is asked for now. Thread-safe. */
static inline iso_found iso_visibility_node(iso_visibility *v, int x, int y, int z, const iso_node **node) {
    const int *dims = v->bits->dims;
    if ((unsigned)x >= (unsigned)dims[0] || (unsigned)y >= (unsigned)dims[1] ||
        (unsigned)z >= (unsigned)dims[2])
        return ISO_FOUND_NONE;
    const unsigned i = (unsigned)x / ISO_SOLID_WORD, j = (unsigned)y / ISO_VISIBILITY_Y,
                   k = (unsigned)z / ISO_VISIBILITY_Z;
    const size_t number = iso_group_number(v, (int)i, (int)j, (int)k);
    const iso_node_group *g = v->group[number];
    if (!g) {
        atomic_store_explicit(&v->wanted[number], 1, memory_order_relaxed);
        atomic_store_explicit(&v->any_wanted, true, memory_order_relaxed);
        return ISO_FOUND_MISSING;
    }
    const unsigned row = (unsigned)z % ISO_VISIBILITY_Z * ISO_VISIBILITY_Y + (unsigned)y % ISO_VISIBILITY_Y,
                   bit = (unsigned)x % ISO_SOLID_WORD;
    if (!(g->node[row] >> bit & 1)) return ISO_FOUND_NONE;
    *node = &g->nodes[g->first[row] + iso_count_bits(g->node[row] & ((1u << bit) - 1))];
    return ISO_FOUND_NODE;
}

#endif
