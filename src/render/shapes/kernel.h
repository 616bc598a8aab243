/* kernel: draws the blocks of a bin; one variant for each instruction set. Internal to shapes.
 *
 * A bin keeps for each of its pixels the nearest depth so far and the number of the record that it belongs
 * to; for each tile of 8 x 8 pixels the farthest of their depths: blocks, shapes and tiles that cannot be
 * nearer are skipped. A record is what the equations of a shape need; when all blocks have been drawn, those
 * that are seen are evaluated once more for the normal. */
#ifndef ISO_RENDER_SHAPES_KERNEL_H
#define ISO_RENDER_SHAPES_KERNEL_H

#include "base/cpu.h"
#include "base/memory.h"
#include "render/shapes/frame.h"
#include "render/shapes/near.h"

enum {
    ISO_SHAPES_TILE = 8,
    /* Patches of pixels begin at any pixel of a bin and may reach this far over its right and lower edges. */
    ISO_SHAPES_MARGIN = 8,
    ISO_SHAPES_PITCH = ISO_SHAPES_BIN + 3 * ISO_SHAPES_MARGIN,
    ISO_SHAPES_PIXELS = ISO_SHAPES_PITCH * (ISO_SHAPES_BIN + ISO_SHAPES_MARGIN) + ISO_LANES_MAX,
    ISO_SHAPES_TILES = ISO_SHAPES_BIN / ISO_SHAPES_TILE,      /* in a row of a bin */
    ISO_SHAPES_TILE_PITCH = ISO_SHAPES_TILES + ISO_LANES_MAX, /* vectors of tiles may be read past a row */
    ISO_SHAPES_CHUNK = ISO_SHAPES_BLOCK + 2 * ISO_LANES_MAX,
    ISO_SHAPES_LARGE =
        20000,           /* pixels: the radius from which on floats are too coarse for a shape's outline */
    ISO_SHAPES_NONE = -1 /* the record of a pixel that shows none of the shapes */
};

/* The fields of a shape. A record is a head (the pixel of the shape's centre, x and y; its number; flags) and
 * the fields. */
enum {
    ISO_FIELD_X, /* the centre's place in its pixel, 0 to 1; of a tube, the first vertex's */
    ISO_FIELD_Y,
    ISO_FIELD_Z, /* its depth */
    ISO_FIELD_R, /* its radius */
    ISO_SPHERE_FIELDS,
    /* Tubes: the second vertex; an orthonormal frame (E1, E2, A) with A along the axis and E1 perpendicular
     * to the ray through the first vertex, of which E2 and A have the given components. */
    ISO_FIELD_Z1 = ISO_SPHERE_FIELDS,
    ISO_FIELD_X1, /* pixels from the first vertex */
    ISO_FIELD_Y1,
    ISO_FIELD_R1,
    ISO_FIELD_E1X,
    ISO_FIELD_E1Y,
    ISO_FIELD_E2X,
    ISO_FIELD_E2Y,
    ISO_FIELD_AX,
    ISO_FIELD_AY,
    ISO_FIELD_RAY_E2,
    ISO_FIELD_RAY_A,
    ISO_FIELD_LENGTH,
    ISO_FIELD_SINE, /* difference of the radii / length */
    ISO_FIELD_COSINE2,
    ISO_FIELD_CONE, /* radius * slope - sine * k * RAY_A */
    ISO_TUBE_FIELDS,
    /* Solids: what the inverse of the glyph's map makes of the picture's x and y axes and of the centre's ray
     */
    ISO_FIELD_UNIT_X = ISO_FIELD_Z + 1,
    ISO_FIELD_UNIT_Y = ISO_FIELD_UNIT_X + 3,
    ISO_FIELD_UNIT_RAY = ISO_FIELD_UNIT_Y + 3,
    ISO_SOLID_FIELDS = ISO_FIELD_UNIT_RAY + 3,
    /* Ribbons: vectors of three components, see ribbon_simd.h */
    ISO_FIELD_PATH = ISO_FIELD_Z + 1,
    ISO_FIELD_FIRST_EDGE = ISO_FIELD_PATH + 3,
    ISO_FIELD_LAST_EDGE = ISO_FIELD_FIRST_EDGE + 3,
    ISO_RIBBON_FIELDS = ISO_FIELD_LAST_EDGE + 3,
    ISO_SHAPES_FIELDS = ISO_TUBE_FIELDS /* the most */
};
enum {
    ISO_RECORD_HEAD = 4,
    ISO_SPHERE_RECORD = ISO_RECORD_HEAD + ISO_SPHERE_FIELDS,
    ISO_TUBE_RECORD = ISO_RECORD_HEAD + ISO_TUBE_FIELDS,
    ISO_RIBBON_RECORD = ISO_RECORD_HEAD + ISO_RIBBON_FIELDS,
    ISO_SOLID_RECORD = ISO_RECORD_HEAD + ISO_SOLID_FIELDS
};

/* Shapes of a block that remain after culling, with their boxes; fields apart. */
typedef struct iso_shapes_chunk {
    int count;
    int32_t x0[ISO_SHAPES_CHUNK], y0[ISO_SHAPES_CHUNK], x1[ISO_SHAPES_CHUNK], y1[ISO_SHAPES_CHUNK];
    float nearest[ISO_SHAPES_CHUNK];
    int32_t pixel_x[ISO_SHAPES_CHUNK], pixel_y[ISO_SHAPES_CHUNK], id[ISO_SHAPES_CHUNK],
        flags[ISO_SHAPES_CHUNK];
    float field[ISO_SHAPES_FIELDS][ISO_SHAPES_CHUNK];
} iso_shapes_chunk;

/* The memory of one worker, and the bin that it draws. */
typedef struct iso_shapes_bin {
    const iso_shapes_frame *frame;
    const struct iso_shapes_kernel *kernel;
    iso_shapes_rect rect;
    float depth[ISO_SHAPES_PIXELS];    /* -INFINITY outside the bin: nothing is drawn there */
    int32_t record[ISO_SHAPES_PIXELS]; /* number of a record; ISO_SHAPES_NONE; or -2 - number in `near` */
    float farthest[ISO_SHAPES_TILE_PITCH * (ISO_SHAPES_TILES + 1)];
    iso_shapes_chunk chunk;
    iso_buffer records, near; /* floats; iso_near_shape */
    size_t record_count, near_count;
    iso_shapes_drawn drawn;
    iso_status status; /* ISO_ERR_NOMEM: a buffer could not grow */
} iso_shapes_bin;

typedef struct iso_shapes_kernel {
    /* Sets the farthest depths of all tiles. */
    void (*measure)(iso_shapes_bin *bin);
    /* Whether all pixels of the rectangle, which is within the bin, show something nearer or as near. */
    bool (*hidden)(const iso_shapes_bin *bin, const iso_shapes_rect *rect, float nearest);
    /* Draws a block. The buffers must have room for all its shapes. */
    void (*draw)(iso_shapes_bin *bin, const iso_shapes_seen *seen);
    /* Writes the pixels that show one of the records into the target's gbuffer, and counts them. */
    void (*resolve)(iso_shapes_bin *bin);
} iso_shapes_kernel;

ISO_KERNEL_UNITS(const iso_shapes_kernel, iso_shapes_kernel);

/* Floats of a record. */
static inline int iso_shapes_record_floats(iso_shape_kind kind) {
    static const int floats[] = {[ISO_SHAPE_SPHERE] = ISO_SPHERE_RECORD,
                                 [ISO_SHAPE_TUBE] = ISO_TUBE_RECORD,
                                 [ISO_SHAPE_RIBBON] = ISO_RIBBON_RECORD,
                                 [ISO_SHAPE_SOLID] = ISO_SOLID_RECORD};
    return floats[kind];
}

/* The index of a pixel of the bin in `depth` and `record`. */
static inline size_t iso_shapes_pixel(const iso_shapes_bin *bin, int x, int y) {
    return (size_t)(y - bin->rect.y0) * ISO_SHAPES_PITCH + (size_t)(x - bin->rect.x0);
}

/* The colour of a glyph, or at `along` (0 to 1) of the segment between the vertices `id` and `id` + 1, of a
 * set that has colours. */
iso_rgb iso_shapes_color_at(const iso_shapes *shapes, uint32_t id, float along);
/* Writes the colour of a sample, if the set has colours. */
void iso_shapes_write_color(const iso_shapes_frame *frame, size_t sample, uint32_t id, float along);
/* Writes the element of a sample, if the target's gbuffer has elements. */
void iso_shapes_write_element(const iso_shapes_frame *frame, size_t sample, uint32_t id);

#endif
