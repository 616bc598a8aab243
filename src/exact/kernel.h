/* kernel: draws visible octants into a band of rows. Internal to exact.
 *
 * One source (draw_simd.h), compiled once for each instruction set; every variant gives the same bytes. An
 * octant's cells are set up as vectors of cells. The free pixels of each cell are then tested as vectors of
 * pixels. Pixels whose ray hits the surface are queued, from any cells and octants, until there are enough
 * of them to compute roots and normals in full vectors. Octants and cells are drawn front to back, so the
 * first crossing found for a pixel is the nearest one; one bit per pixel tells whether the pixel is free (no
 * crossing was found yet).
 *
 * Cells are handled in one of three ways, by their size in the picture:
 * - small cells: pairs of a pixel and a cell, from several cells, are tested together (ray_cell_simd.h);
 * - large cells: each is tested alone (large_cells_simd.h);
 * - outlined cells: larger still, with tighter bounds on their pixels (cell_outlines_simd.h,
 *   outlined_cells_simd.h, outlined_roots_simd.h). */
#ifndef ISO_EXACT_KERNEL_H
#define ISO_EXACT_KERNEL_H

#include <stdalign.h>

#include "base/cpu.h"
#include "exact/projection.h"
#include "render/layers/layers.h"

/* Array sizes. A list is processed when it holds the number of items that ISO_EXACT_..LIST or ISO_EXACT_HITS
 * says; ISO_EXACT_..ROOM is the size of its arrays. The difference is for the items of one more step, and for
 * whole vectors stored at the end. */
enum {
    ISO_EXACT_CELL_ROOM = ISO_EXACT_CELLS + ISO_LANES_MAX,
    ISO_EXACT_LIST = 1024, /* pairs of small cells */
    ISO_EXACT_LIST_ROOM = ISO_EXACT_LIST + 64 + ISO_LANES_MAX,
    ISO_EXACT_HITS = 256,       /* queued pixels */
    ISO_EXACT_LARGE_LIST = 256, /* pairs of a large cell */
    ISO_EXACT_LARGE_ROOM = ISO_EXACT_LARGE_LIST + 64,
    ISO_EXACT_PATCH_LIST = 256, /* pixels of an outlined cell */
    ISO_EXACT_PATCH_ROOM = ISO_EXACT_PATCH_LIST + 64 + 2 * ISO_LANES_MAX,
    /* a ray crosses the surface in a cell up to three times */
    ISO_EXACT_HIT_ROOM = ISO_EXACT_HITS + 3 * ISO_EXACT_LARGE_ROOM + 4 * ISO_LANES_MAX,
};

/* A cell as pixels are tested against it, in the cell's coordinates u, v, w: -1 and 1 at its faces. The field
 * minus the isovalue is f[0] + f[1] u + f[2] v + f[3] w + f[4] uv + f[5] vw + f[6] uw + f[7] uvw, scaled (for
 * float voxels) so that its largest corner is about 1.
 *
 * The reference point is the cell's centre. Where cells are large in the picture it is the centre of the box
 * in which the surface lies (`half`, `shift`), u, v and w are relative to it, and rays are clipped to that
 * box and not to the cell. The ray of a pixel passes the depth of the reference point at `eye` + `scale` *
 * (pixel - place), a position in the view's x and y. */
typedef struct iso_exact_cell {
    float field[8]; /* the coefficients f */
    float place[2]; /* the projected reference point, in pixels from iso_exact_octant_projection.origin */
    float scale;    /* mm per pixel at the reference point's depth; 0 if the cell is next to the eye: its
                     * rays then start at `eye` */
    float depth;    /* of the reference point, mm, relative to iso_exact_projection.middle */
    float half[4];  /* half extents in u, v, w of the box in which the surface lies; [3] is unused */
    float shift[4]; /* centre of that box minus the cell's centre, u v w; [3] is unused */
    float eye[3];   /* the eye in the cell's coordinates where scale is 0, else 0 */
    float behind;   /* `depth` minus the depth of the near plane, mm */
} iso_exact_cell;

/* Flags of a cell. Bits 0 .. 5: all four corners of its face -x +x -y +y -z +z equal the isovalue (a tie).
 * TOUCHING: no corner is above the isovalue and there is a tie, so that the surface in the cell consists of
 * ties only. UNSEEN: no corner is above the isovalue and there is no tie, so that the cell shows nothing. */
enum { ISO_EXACT_FACES = 63, ISO_EXACT_TOUCHING = 64, ISO_EXACT_UNSEEN = 128 };

/* The queue of pixels whose rays cross the surface. Along the ray through the cell, with x from 0 to 1, the
 * field is the cubic f[0] + f[1] x + f[2] x^2 + f[3] x^3, which changes its sign once. The position on the
 * ray is entry + x * step in the cell's coordinates, its depth is depth + x * length. A slot is a cell that
 * queued pixels belong to. shade_hits replaces some of the arrays by its results: `entry` by normals, `depth`
 * by the depth of the surface, `pixel` by the index of the sample. */
typedef struct iso_exact_hits {
    int count, slots;
    float cubic[4][ISO_EXACT_HIT_ROOM], entry[3][ISO_EXACT_HIT_ROOM], step[3][ISO_EXACT_HIT_ROOM],
        depth[ISO_EXACT_HIT_ROOM], length[ISO_EXACT_HIT_ROOM];
    int32_t pixel[ISO_EXACT_HIT_ROOM], slot[ISO_EXACT_HIT_ROOM]; /* pixel: y << 16 | x */
    float root[ISO_EXACT_HIT_ROOM];                              /* x of the crossing */
    /* When a picture is painted without a gbuffer: RGBA of the pixel. When layers are listed: flags of the
     * cell, which shade_fragments replaces by whether the hit is doubtful. */
    int32_t word[ISO_EXACT_HIT_ROOM];
    uint32_t place[ISO_EXACT_HIT_ROOM];       /* by slot, for keys: the brick's place (iso_exact_place) */
    int voxel[ISO_EXACT_HIT_ROOM][3];         /* by slot: the cell's first corner, a voxel of the grid */
    float gradient[ISO_EXACT_HIT_ROOM][8][4]; /* by slot: x, y, z at the cell's corners; [3] is unused */
} iso_exact_hits;

/* Up to 64 neighbouring pixels in a row of the picture. Those whose bits in `listed` are set are tested
 * against a large cell. */
typedef struct iso_exact_row_window {
    uint64_t listed; /* bit n: the pixel n to the right of the first is to be tested */
    int32_t pixel;   /* the first pixel, y << 16 | x */
} iso_exact_row_window;

/* Bounds on the pixels whose rays can meet the surface in a large cell. With x and y in pixels from the
 * projected reference point, low[n] + slope[n] * y <= x <= high[n] + slope[n] * y for each n. */
enum { ISO_EXACT_LINES = 3 };
typedef struct iso_exact_outline {
    float slope[4], low[4], high[4]; /* [3] is unused */
} iso_exact_outline;

/* The rays through an outlined cell, in its coordinates. The ray of the pixel x, y (counted from the
 * projected reference point) passes the reference point's depth at p = `right` * x + `down` * y, and its
 * direction is `along` + `turn` * p per mm of depth. With L the linear part of the field (f[1] u + f[2] v +
 * f[3] w), L changes along this ray by `rate` + `turn` * L(p) per mm.
 *
 * A cell is *flat* when its field is so nearly linear that a ray meets the surface there at most once, not
 * farther than `reach` from where the ray meets the plane f[0] + L = 0, and Newton's method from that plane
 * converges to it. */
typedef struct iso_exact_rays {
    float right[3], turn;
    float down[3], reach; /* mm */
    float along[3], rate;
    float close; /* flat cells: how exactly a root must be found, mm */
    float flat;  /* 1 when the cell is flat, else 0 */
    float unused[2];
} iso_exact_rays;

/* Neighbouring pixels of a row. */
typedef struct iso_exact_pixel_run {
    int32_t pixel; /* the first pixel, y << 16 | x */
    int count;     /* number of pixels, at most 64 */
} iso_exact_pixel_run;

/* Pixels of one outlined cell, and the results of the tests on them. `depth`, `normal` and `word` of pixel i
 * are stored at index i + ISO_LANES_MAX, so that vectors can be read that begin before the first pixel.
 * (ISO_EXACT_PATCH_ROOM is a multiple of ISO_LANES_MAX, so that no vector crosses a cache line.) */
typedef struct iso_exact_patch {
    int cell, count, runs;                         /* number of the cell; number of pixels; number of runs */
    iso_exact_pixel_run run[ISO_EXACT_PATCH_ROOM]; /* the pixels, in their order */
    /* x, y: pixels from the cell's projected reference point; depth: of the surface, mm */
    alignas(64) float x[ISO_EXACT_PATCH_ROOM], y[ISO_EXACT_PATCH_ROOM], depth[ISO_EXACT_PATCH_ROOM];
    float normal[3][ISO_EXACT_PATCH_ROOM]; /* until shade_patch: the position u, v, w in the cell */
    /* Intermediate values. Curved cells: the chord's cubic, entry, step, depth at entry, length, and a first
     * approximation of the root. Flat cells: the ray_series in cubic[0 .. 2], the point on the plane
     * in `entry`, the direction in `step`, the distance (backwards) from the reference depth to the plane in
     * `begin`. */
    float cubic[4][ISO_EXACT_PATCH_ROOM], entry[3][ISO_EXACT_PATCH_ROOM], step[3][ISO_EXACT_PATCH_ROOM],
        begin[ISO_EXACT_PATCH_ROOM], length[ISO_EXACT_PATCH_ROOM], guess[ISO_EXACT_PATCH_ROOM];
    /* When a picture is painted without a gbuffer: the rays (u, v, 1) of the pixels, and their RGBA. */
    float u[ISO_EXACT_PATCH_ROOM], v[ISO_EXACT_PATCH_ROOM];
    int32_t word[ISO_EXACT_PATCH_ROOM];
    /* Bit i & 63 of word i / 64. hit: pixel i shows the cell; unsure: pixel i may show the cell, and the
     * general test must decide. */
    uint64_t hit[ISO_EXACT_PATCH_ROOM / 64 + 2], unsure[ISO_EXACT_PATCH_ROOM / 64 + 2];
    float gradient[8][4]; /* the gradient's coefficients of 1, u, v, w, uv, vw, uw, uvw; view space */
} iso_exact_patch;

/* A body of iso_exact_projection.clip that cuts the octant that is being drawn. Positions q are in voxels
 * from the octant's centre. A face is in front of q if x * q.x + y * q.y + z * q.z + offset < 0; q lies in a
 * ball if constant + linear . q + q . (square q) < 0, where `square` is a symmetric matrix: xx yy zz xy yz
 * xz. */
typedef struct iso_exact_cut {
    int faces; /* 0: a ball */
    bool keeps;
    float face[ISO_CLIP_FACES][4];
    float constant, linear[3], square[6];
} iso_exact_cut;

/* The working memory of one worker, for one band of rows at a time. */
typedef struct iso_exact_scratch {
    iso_rows rows;            /* the band */
    iso_exact_single *single; /* of key images: for bricks, which are extracted as they are drawn */
    iso_layer_lists *lists;   /* of the band; only for the kernel that lists layers */
    int words;                /* 64-bit words of `open` per row; the last one is always 0 */
    uint64_t *open;           /* bit x & 63 of word x / 64 of row y - rows.first: the pixel is still free */

    /* The octant that is being drawn. Arrays of ISO_EXACT_CELL_ROOM items are indexed by the number of the
     * crossed cell in the octant. */
    const iso_exact_span *span;
    uint32_t place; /* of the span's brick, for keys */
    const iso_exact_octant *octant;
    const void *corners;
    iso_exact_octant_projection octant_projection;
    int clip[4];                            /* the octant's pixels x0 x1 y0 y1 in the band */
    uint16_t position[ISO_EXACT_CELL_ROOM]; /* cell in the octant: z << 6 | y << 3 | x */
    iso_exact_cell record[ISO_EXACT_CELL_ROOM];
    int32_t box[4][ISO_EXACT_CELL_ROOM]; /* pixels x0 x1 y0 y1; x1 < x0 or y1 < y0: none */
    int32_t flags[ISO_EXACT_CELL_ROOM];  /* ISO_EXACT_FACES .. */
    int32_t slot[ISO_EXACT_CELL_ROOM];   /* index of the cell in hits.voxel; -1: none yet */
    uint64_t drawable[ISO_EXACT_SIDE];   /* bit r: there is a cell of front-to-back rank r with pixels */
    uint16_t cell_of[ISO_EXACT_CELLS];   /* the number of the cell, by rank */

    /* Pairs of a pixel (y << 16 | x) and the cell that it is tested against (the index of its record, in
     * floats), front to back. Pairs before index `general` may need the general test. */
    int32_t pixel[ISO_EXACT_LIST_ROOM], owner[ISO_EXACT_LIST_ROOM];
    int pairs, general;
    bool large; /* the octant's cells are large: each is tested alone, with `window` and `hit_bits` */
    int windows;
    iso_exact_row_window window[ISO_EXACT_LARGE_ROOM]; /* the pixels of the pairs, in their order */
    uint64_t hit_bits[ISO_EXACT_LARGE_ROOM / 64 + 1];  /* bit by pair: its pixel shows the cell */
    iso_exact_hits hits;
    bool bounded;  /* has_outlines is true of the octant: `outline` is set */
    bool outlined; /* and its cells are so large that they are drawn as patches: `rays` are set */
    iso_exact_outline outline[ISO_EXACT_CELL_ROOM];
    iso_exact_rays rays[ISO_EXACT_CELL_ROOM];
    iso_exact_patch patch;
    int cuts; /* bodies that cut the octant */
    iso_exact_cut cut[ISO_CLIP_BODIES];
    bool is_cut[ISO_EXACT_CELL_ROOM]; /* with cuts: the cell is cut by some of them */
} iso_exact_scratch;

/* Whether a pixel in the rectangle `clip` (x0 x1 y0 y1, in the band) is free. */
static inline bool iso_exact_any_open(const iso_exact_scratch *scratch, const int clip[4]) {
    const int first = clip[0] >> 6, last = clip[1] >> 6;
    const uint64_t from = ~(uint64_t)0 << (clip[0] & 63), to = ~(uint64_t)0 >> (63 - (clip[1] & 63));
    for (int y = clip[2]; y <= clip[3]; y++) {
        const uint64_t *row = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words;
        if (first == last) {
            if (row[first] & from & to) return true;
            continue;
        }
        uint64_t open = (row[first] & from) | (row[last] & to);
        for (int word = first + 1; word < last; word++) open |= row[word];
        if (open) return true;
    }
    return false;
}

/* Sets `clip` to the pixels of a box that lie in the band; false when there are none, or none is free. */
static inline bool iso_exact_is_open(const iso_exact_scratch *scratch, const iso_exact_box *box,
                                     int clip[4]) {
    if (box->y0 > scratch->rows.last || box->y1 < scratch->rows.first) return false;
    clip[0] = box->x0;
    clip[1] = box->x1;
    clip[2] = box->y0 > scratch->rows.first ? box->y0 : scratch->rows.first;
    clip[3] = box->y1 < scratch->rows.last ? box->y1 : scratch->rows.last;
    return iso_exact_any_open(scratch, clip);
}

typedef struct iso_exact_kernel {
    /* Draws the octants of `visible` that have free pixels in the band. visible: `count` octants, sorted
     * front to back. */
    void (*draw)(const iso_exact_projection *projection, const iso_exact_visible *visible, int count,
                 iso_exact_scratch *scratch);
    /* Shades and writes the pixels that are still in the queue: call it when all octants are drawn. */
    void (*flush)(const iso_exact_projection *projection, iso_exact_scratch *scratch);
} iso_exact_kernel;

/* The first kernel shows the first crossing of each ray; the other one lists all crossings as fragments
 * (render/layers), and for it a pixel is free as long as something of the surface can be seen behind the
 * fragments listed so far. */
ISO_KERNEL_UNITS(const iso_exact_kernel, iso_exact_kernel);
ISO_KERNEL_UNITS(const iso_exact_kernel, iso_exact_layers_kernel);

/* Sets scratch->record and scratch->box of the cells of an octant next to the eye, one by one in double
 * precision. Boxes of cells that cannot be seen are empty. */
void iso_exact_project_near_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch);

/* Sets scratch->cuts .. is_cut of the octant that is being drawn, and empties the boxes of the cells that are
 * cut away. */
void iso_exact_cut_octant(const iso_exact_projection *projection, iso_exact_scratch *scratch);

#endif
