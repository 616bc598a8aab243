/* set: what a prepared set of shapes consists of. Internal to shapes. */
#ifndef ISO_RENDER_SHAPES_SET_H
#define ISO_RENDER_SHAPES_SET_H

#include "render/shapes/shapes.h"

/* Neighbouring shapes that are culled as one. */
typedef struct iso_shapes_block {
    double origin[3]; /* world; positions are relative to it */
    float half[3];    /* all positions are in the box origin +- half */
    float reach;      /* the farthest that a shape reaches from its position, mm */
    uint32_t first, count;
} iso_shapes_block;

enum { ISO_SHAPES_BLOCK = 256 }; /* the most glyphs of a block */

struct iso_shapes {
    iso_glyph glyph;
    double radius, scale;
    iso_shapes_block *blocks;
    size_t block_count, count, skipped;
    /* By place in the order of blocks: positions relative to their block's origin, and the glyph's number.
     * ISO_LANES_MAX values more can be read. One allocation, which begins with x. */
    float *x, *y, *z;
    uint32_t *id;
    iso_box bounds;
    size_t bytes;
    /* Borrowed, by the glyph's number; NULL: none. */
    const float *radii;
    const uint8_t (*colors)[3];
};

/* The radius of a sphere, mm. */
static inline float iso_shapes_radius(const iso_shapes *shapes, uint32_t id) {
    return shapes->radii ? shapes->radii[id] * (float)shapes->scale : (float)(shapes->radius * shapes->scale);
}

#endif
