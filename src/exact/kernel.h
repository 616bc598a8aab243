/* kernel: draws visible blocks into a band of rows. Internal to exact.
 *
 * One kernel body (kernel_body.inc), included once per instruction set; every variant gives the same
 * bytes. A block's cells are set up as vectors of cells, each cell's free pixels are then tested as vectors
 * of pixels, and the pixels that it fills wait in a queue, from any cells and blocks, until there are enough
 * of them to find roots and normals as whole vectors. Blocks and cells come front to back, so the first
 * crossing that a pixel meets is the nearest one: a bit per pixel says that it is still free. */
#ifndef ISO_EXACT_KERNEL_H
#define ISO_EXACT_KERNEL_H

#include <stdalign.h>

#include "base/simd.h"
#include "exact/projection.h"

enum {
    ISO_EXACT_CELL_ROOM = ISO_EXACT_CELLS + ISO_LANES_MAX,
    ISO_EXACT_LIST = 1024,
    ISO_EXACT_LIST_ROOM = ISO_EXACT_LIST + 64 + ISO_LANES_MAX,
    ISO_EXACT_HITS = 256,
    ISO_EXACT_LARGE_LIST = 256, /* pairs of a large cell */
    ISO_EXACT_LARGE_ROOM = ISO_EXACT_LARGE_LIST + 64,
    ISO_EXACT_PATCH_LIST = 256, /* pixels of an outlined cell */
    ISO_EXACT_PATCH_ROOM = ISO_EXACT_PATCH_LIST + 64 + 2 * ISO_LANES_MAX,
    ISO_EXACT_HIT_ROOM = ISO_EXACT_HITS + ISO_EXACT_LARGE_ROOM + 3 * ISO_LANES_MAX,
};

/* A cell as pixels are tested against it. The field, scaled so that its largest corner is about 1, is f[0] +
 * f[1] u + f[2] v + f[3] w + f[4] uv + f[5] vw + f[6] uw + f[7] uvw over u, v, w in [-1, 1]. Where cells are
 * large in the picture, u, v and w count from the middle of the box in which the surface lies, which then is
 * the cell's part that pixels are tested against. A pixel's ray passes the middle's depth `depth` at `eye` +
 * `scale`
 * * (pixel - place) across the view. */
typedef struct iso_exact_cell {
    float field[8];
    float place[2]; /* the projected middle, pixels from view.origin */
    float scale;    /* mm per pixel at the middle's depth; 0: rays start at `eye` instead */
    float depth;    /* relative to projection->middle */
    float half[4];  /* of the box in which the surface lies, u v w */
    float shift[4]; /* its middle in the cell's coordinates, u v w */
    float eye[3];   /* the eye in the cell's coordinates where scale is 0, else 0 */
    float behind;   /* mm from the near plane to `depth` */
} iso_exact_cell;

/* Bits 0 .. 5 of a cell's flags: all four corners of its face -x +x -y +y -z +z equal the isovalue.
 * TOUCHING: no corner is above it, so the surface is in faces only. UNSEEN: and there are none. */
enum { ISO_EXACT_FACES = 63, ISO_EXACT_TOUCHING = 64, ISO_EXACT_UNSEEN = 128 };

/* Pixels that will be drawn: the cubic f[0] + f[1] x + .. along the ray through the cell, x in [0, 1], with
 * one change of state in it; where the ray is at x = 0 and how it goes on; depths there. */
typedef struct iso_exact_hits {
    int count, slots;
    float cubic[4][ISO_EXACT_HIT_ROOM], entry[3][ISO_EXACT_HIT_ROOM], step[3][ISO_EXACT_HIT_ROOM],
        depth[ISO_EXACT_HIT_ROOM], length[ISO_EXACT_HIT_ROOM];
    int32_t pixel[ISO_EXACT_HIT_ROOM], slot[ISO_EXACT_HIT_ROOM];
    float root[ISO_EXACT_HIT_ROOM];
    int32_t word[ISO_EXACT_HIT_ROOM]; /* for a picture: the pixel's */
    int voxel[ISO_EXACT_HIT_ROOM][3]; /* by slot: the cell, */
    float gradient[ISO_EXACT_HIT_ROOM][8]
                  [4]; /* and the gradients at its corners: x, y, z; the fourth float is unused */
} iso_exact_hits;

/* Up to 64 pixels of a row, some of which are paired with a large cell. */
typedef struct iso_exact_row_window {
    uint64_t listed; /* bit n: the pixel n to the right of the first */
    int32_t pixel;   /* the first, y << 16 | x */
} iso_exact_row_window;

/* What a large cell leaves of a row of pixels: those between low + slope * y and high + slope * y for each of
 * several pairs of lines, x and y from the projected middle. */
enum { ISO_EXACT_LINES = 6 };
typedef struct iso_exact_outline {
    float slope[8], low[8], high[8];
} iso_exact_outline;

/* How rays go through a large cell: they pass the middle's depth at `right` * x + `down` * y, x and y pixels
 * from the projected middle, and go on `along` + `turn` * that per mm, on which the field's linear part
 * changes by `rate` + `turn` * what it changes by there. A cell is flat where the field is so nearly linear
 * that a ray which meets the surface there meets it once, and within `reach` of where it meets the plane of
 * the linear part, from where it is sure to be found. */
typedef struct iso_exact_rays {
    float right[3], turn;
    float down[3], reach; /* mm */
    float along[3], rate;
    float close; /* so near must a place in a flat cell be found, mm */
    float flat;  /* 1; 0: the cell is not */
    float unused[2];
} iso_exact_rays;

/* Neighbouring pixels of a row. */
typedef struct iso_exact_pixel_run {
    int32_t pixel; /* the first, y << 16 | x */
    int count;     /* at most 64 */
} iso_exact_pixel_run;

/* Pixels of one outlined cell: where they are from its projected middle, and what is found out about them,
 * which is stored ISO_LANES_MAX items later so that vectors can be read that begin before the first one.
 * (Rooms are multiples of ISO_LANES_MAX: no vector of any array lies across lines of a cache.) */
typedef struct iso_exact_patch {
    int cell, count, runs;
    iso_exact_pixel_run run[ISO_EXACT_PATCH_ROOM];
    alignas(64) float x[ISO_EXACT_PATCH_ROOM], y[ISO_EXACT_PATCH_ROOM], depth[ISO_EXACT_PATCH_ROOM];
    float normal[3][ISO_EXACT_PATCH_ROOM]; /* before that, places in the cell's coordinates */
    /* on the way: a ray's cubic or what stands for it, where it begins and how it goes on; depths there, or
     * how far back it begins; about where the cubic is 0 */
    float cubic[4][ISO_EXACT_PATCH_ROOM], entry[3][ISO_EXACT_PATCH_ROOM], step[3][ISO_EXACT_PATCH_ROOM],
        begin[ISO_EXACT_PATCH_ROOM], length[ISO_EXACT_PATCH_ROOM], guess[ISO_EXACT_PATCH_ROOM];
    float u[ISO_EXACT_PATCH_ROOM], v[ISO_EXACT_PATCH_ROOM]; /* for a picture: of their rays, */
    int32_t word[ISO_EXACT_PATCH_ROOM];                     /* and their words */
    uint64_t hit[ISO_EXACT_PATCH_ROOM / 64 + 2], unsure[ISO_EXACT_PATCH_ROOM / 64 + 2]; /* bits */
    float gradient[8][4]; /* in view space, as the field's coefficients are ordered */
} iso_exact_patch;

/* One worker's. */
typedef struct iso_exact_scratch {
    iso_rows rows;  /* of the band */
    int words;      /* of `open` per row; the last one stays 0 */
    uint64_t *open; /* bit x & 63 of word x / 64 of row y - rows.first: the pixel is still free */

    /* the block that is being drawn */
    const iso_exact_span *span;
    const iso_exact_block *block;
    const void *corners;
    iso_exact_block_projection view;
    int clip[4];                            /* x0 x1 y0 y1 */
    uint16_t position[ISO_EXACT_CELL_ROOM]; /* z << 6 | y << 3 | x */
    iso_exact_cell record[ISO_EXACT_CELL_ROOM];
    int32_t box[4][ISO_EXACT_CELL_ROOM]; /* x0 x1 y0 y1 */
    int32_t flags[ISO_EXACT_CELL_ROOM], slot[ISO_EXACT_CELL_ROOM];
    uint64_t drawable[ISO_EXACT_SIDE]; /* by front-to-back rank, */
    uint16_t cell_of[ISO_EXACT_CELLS]; /* and which cell that is */

    /* Pairs of a pixel (y << 16 | x) and the cell (its record, counted in floats) that it is to be tested
     * against, front to back. Those before index `general` may need the general test. */
    int32_t pixel[ISO_EXACT_LIST_ROOM], owner[ISO_EXACT_LIST_ROOM];
    int pairs, general;
    bool large; /* cells are so large that each is tested by itself; then.. */
    int windows;
    iso_exact_row_window window[ISO_EXACT_LARGE_ROOM]; /* ..these are where the pairs lie, */
    uint64_t hit_bits[ISO_EXACT_LARGE_ROOM / 64 + 1];  /* and bits of the pairs that hit */
    iso_exact_hits hits;
    bool outlined; /* cells are large, and far from the eye: these are set */
    iso_exact_outline outline[ISO_EXACT_CELL_ROOM];
    iso_exact_rays rays[ISO_EXACT_CELL_ROOM];
    iso_exact_patch patch;
} iso_exact_scratch;

typedef struct iso_exact_kernel {
    /* Draws those of `count` blocks that are visible in the band. */
    void (*draw)(const iso_exact_projection *projection, const iso_exact_visible *visible, int count,
                 iso_exact_scratch *scratch);
    /* Writes what is still in the queue. */
    void (*flush)(const iso_exact_projection *projection, iso_exact_scratch *scratch);
} iso_exact_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_exact_kernel *iso_exact_kernel_get(iso_cpu_level level);

/* Places and boxes of the cells of a block next to the eye, one by one in double. Boxes of cells that cannot
 * be seen are empty. */
void iso_exact_project_near_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch);

#endif
