/* set: what a prepared set of shapes consists of. Internal to shapes and render/gl. */
#ifndef ISO_RENDER_SHAPES_SET_H
#define ISO_RENDER_SHAPES_SET_H

#include <math.h>

#include "render/shapes/shapes.h"

/* Neighbouring shapes that are culled as one. */
typedef struct iso_shapes_block {
    float origin[3];       /* relative to the set's origin */
    float half[3];         /* all centres or vertices are in the box origin +- half */
    float reach;           /* the farthest that a shape reaches from them, mm */
    uint32_t first, count; /* glyphs, or runs of segments */
} iso_shapes_block;

enum {
    ISO_SHAPES_BLOCK = 256, /* the most glyphs or segments of a block */
    ISO_SHAPES_RUN = 8,     /* the most segments of a run */
    ISO_SHAPES_SIZES = 256  /* the most radii that are numbered */
};

typedef enum iso_shape_kind {
    ISO_SHAPE_SPHERE,
    ISO_SHAPE_TUBE,
    ISO_SHAPE_RIBBON,
    ISO_SHAPE_SOLID
} iso_shape_kind;

/* Consecutive segments of a line: vertices first .. first + length. */
typedef struct iso_shapes_runs {
    uint32_t *first;
    uint8_t *length;
    uint8_t *ends; /* ISO_RUN_...: which ends of the line the run has */
} iso_shapes_runs;
enum { ISO_RUN_STARTS = 1, ISO_RUN_ENDS = 2 };

struct iso_shapes {
    iso_shape_kind kind;
    iso_glyph glyph; /* of solids */
    bool billboards; /* of glyphs: iso_shapes_opts.projection */
    double radius, scale, min_pixels;
    iso_caps caps;
    iso_vec3 origin; /* world; everything is relative to it */
    iso_shapes_block *blocks;
    size_t block_count, count, skipped, bytes;
    iso_box bounds;
    /* Glyphs, by place in the order of blocks: positions relative to their block's origin, and the lower 16
     * and upper bits of the glyph's number (iso_shapes_id). ISO_LANES_MAX values more can be read. One
     * allocation, which begins with x. */
    float *x, *y, *z;
    uint16_t *id_low;
    uint8_t *id_high;       /* of sets with numbers below 2^24; else NULL */
    uint16_t *id_high_wide; /* of other sets; else NULL */
    /* Spheres of few radii, as atoms, have by place the number of theirs in `sizes`, which are scaled (one
     * allocation, which begins with sizes). NULL: other sets. */
    float *sizes;
    uint8_t *size;
    /* Lines: x, y, z and radius of each vertex, and the runs in the order of blocks (one allocation). */
    float (*vertices)[4];
    uint16_t (*across)[3]; /* of ribbons: vectors from the line to an edge (iso_shapes_across) */
    iso_shapes_runs runs;
    const size_t *line_starts; /* of lines; borrowed: iso_lines.starts */
    size_t line_count;
    /* Borrowed, by the number of the glyph or vertex; NULL: none. */
    const float *radii;
    const float (*directions)[3], (*axes)[9];
    const uint8_t (*colors)[3];
};

/* Flags of tubes, and ISO_TUBE_WIDENED of ribbons. */
enum {
    ISO_TUBE_CUT_FIRST = 1, /* flat caps */
    ISO_TUBE_CUT_LAST = 2,
    ISO_TUBE_WIDENED = 4,    /* to the least width */
    ISO_TUBE_SECOND_ONLY = 8 /* the second vertex's sphere holds the first's */
};

/* The kind of a set's shapes. With ISO_SHAPES_ARE_LINES, as in pages, there are no glyphs: compilers then
 * leave out what draws them. */
static inline iso_shape_kind iso_shapes_kind(const iso_shapes *shapes) {
#ifdef ISO_SHAPES_ARE_LINES
    return shapes->kind == ISO_SHAPE_RIBBON ? ISO_SHAPE_RIBBON : ISO_SHAPE_TUBE;
#else
    return shapes->kind;
#endif
}

static inline bool iso_shapes_are_lines(const iso_shapes *shapes) {
    const iso_shape_kind kind = iso_shapes_kind(shapes);
    return kind == ISO_SHAPE_TUBE || kind == ISO_SHAPE_RIBBON;
}

/* The number of the glyph at a place in the order of blocks. */
static inline uint32_t iso_shapes_id(const iso_shapes *shapes, size_t place) {
    const uint32_t high = shapes->id_high ? shapes->id_high[place] : shapes->id_high_wide[place];
    return high << 16 | shapes->id_low[place];
}

/* Unit vectors across ribbons are stored in 47 bits: the number of the largest component and whether it is
 * negative, and the others as multiples of 2^-21. */
enum {
    ISO_ACROSS_NONE = 3, /* instead of the largest component: the vertex has no vector */
    ISO_ACROSS_BITS = 22
};

/* The unit vector from the line to an edge of the ribbon; false, and 0, where there is none. */
static inline bool iso_shapes_across(const iso_shapes *shapes, size_t vertex, float across[3]) {
    const uint16_t *words = shapes->across[vertex];
    const uint64_t bits = (uint64_t)words[2] << 32 | (uint64_t)words[1] << 16 | words[0];
    const int largest = (int)(bits & 3);
    float square = 1;
    across[0] = across[1] = across[2] = 0;
    if (largest == ISO_ACROSS_NONE) return false;
    for (int i = 0; i < 2; i++) {
        const int32_t steps = (int32_t)(bits >> (3 + i * ISO_ACROSS_BITS) & ((1 << ISO_ACROSS_BITS) - 1));
        const float value = (float)(steps - (1 << (ISO_ACROSS_BITS - 1))) / (1 << (ISO_ACROSS_BITS - 1));
        across[(largest + 1 + i) % 3] = value;
        square -= value * value;
    }
    across[largest] = bits & 4 ? -sqrtf(square) : sqrtf(square);
    return true;
}

/* The radius of a sphere, mm. */
static inline float iso_shapes_radius(const iso_shapes *shapes, uint32_t id) {
    return shapes->radii ? shapes->radii[id] * (float)shapes->scale : (float)(shapes->radius * shapes->scale);
}

/* Lists the segments of a block: the numbers of their first vertices, and their flags. There are at most
 * ISO_SHAPES_BLOCK; returns how many. */
static inline int iso_shapes_list_segments(const iso_shapes *set, const iso_shapes_block *block, int32_t *ids,
                                           int32_t *flags) {
    const bool flat = set->caps == ISO_CAPS_FLAT;
    int count = 0;
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const int length = set->runs.length[i], ends = flat ? set->runs.ends[i] : 0, first = count;
        for (int k = 0; k < length; k++, count++) {
            ids[count] = (int32_t)set->runs.first[i] + k;
            flags[count] = 0;
        }
        if (ends & ISO_RUN_STARTS) flags[first] |= ISO_TUBE_CUT_FIRST;
        if (ends & ISO_RUN_ENDS) flags[count - 1] |= ISO_TUBE_CUT_LAST;
    }
    return count;
}

#endif
