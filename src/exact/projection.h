/* projection: how a grid, its blocks and its cells are projected into one picture. Internal to exact.
 *
 * Arithmetic is in floats relative to something near: pixels count from a whole pixel next to the projected
 * block, cells from the block's centre, rays from the cell's centre, depths from the grid's middle. What is
 * large (the block's place in view space, the eye in index space) is computed in double. Pixels count from
 * the optical axis before anything else, so that strips of a picture are the same bytes as the whole. */
#ifndef ISO_EXACT_FRAME_H
#define ISO_EXACT_FRAME_H

#include "exact/gradient.h"
#include "exact/set.h"
#include "render/project.h"

/* A picture without a gbuffer: samples are shaded as they are found. */
typedef struct iso_exact_paint {
    int32_t *pixels;    /* of the image */
    const float *u, *v; /* of rays (u, v, 1) by column, with room for ISO_LANES_MAX more, and by row */
    float base[3];      /* colour, 0 .. 1 */
    int32_t empty;      /* a pixel that shows nothing */
} iso_exact_paint;

typedef struct iso_exact_projection {
    const iso_target *target;
    const iso_exact_paint *paint; /* or NULL. With one, the target's gbuffer has but its size */
    const iso_exact *exact;
    iso_exact_gradients *gradients;
    bool perspective;
    double matrix[9], origin[3]; /* index to view space */
    double eye[3];               /* perspective: in index coordinates */
    double half_depth;           /* of a cell along the view, mm */
    /* Cells of an axis from `split` on are nearer the smaller they are, those before it the larger. */
    int split[3];
    int axis[2];      /* pixel that the optical axis meets, */
    double offset[2]; /* and where pixel centres lie relative to it: pixel - axis + offset */
    double middle;    /* depth that depths are relative to; a float */
    float ray[3][3];  /* [k][i]: index axis i of view axis k, times 2: a cell is [-1, 1] */
    float per_focal;  /* 1 / focal; 0 when rays are parallel */
    float isovalue_ceil,
        residual;    /* of the surface; for float voxels a quarter, so that differences stay finite */
    float normal[9]; /* gradient to outward view space normal; its length is not kept */
} iso_exact_projection;

/* A block and the pixels that its cells can touch. */
typedef struct iso_exact_visible {
    uint32_t span, block; /* block: counted from the first of the set */
    uint16_t x0, x1, y0, y1;
    const void *corners; /* of its cells */
} iso_exact_visible;

/* How the cells of one block are projected, in floats. */
typedef struct iso_exact_block_projection {
    bool near;           /* some cells may lie next to the eye: they are done one by one, relative to it */
    bool clip;           /* the near plane may cut cells */
    int origin[2];       /* pixel that pixels are counted from, */
    float off_axis[2];   /* and how far its centre is from the optical axis */
    float place[2];      /* projected centre of the block, pixels from there */
    float residue[2];    /* what the reference direction misses of the centre, mm */
    float reference[2];  /* x / z of the reference direction */
    float sheared[2][3]; /* view x and y of index axes, less the reference direction's share */
    float across[2][3], along[3]; /* view x and y, and z, of index axes */
    float focal, depth;           /* of the block's centre */
    float relative;               /* the same less projection->middle */
    float behind;                 /* the same less the near plane's */
    float cell_pixels;            /* about as many as a cell's box has */
} iso_exact_block_projection;

/* The projection for a target and an up-to-date set, both borrowed. */
iso_exact_projection iso_exact_projection_make(const iso_target *target, const iso_exact *exact);

/* Numbers 0 .. count - 1 of an axis front to back: the i-th of them, when those from `split` on ascend. */
static inline int iso_exact_front_to_back(int i, int count, int split) {
    int first = split < 0 ? 0 : split > count ? count : split;
    return i < count - first ? first + i : count - 1 - i;
}
/* And back: the place of number `n`. */
static inline int iso_exact_rank(int n, int count, int split) {
    int first = split < 0 ? 0 : split > count ? count : split;
    return n >= first ? n - first : count - 1 - n;
}

/* Writes the visible blocks of a brick's span, front to back; returns their number. */
int iso_exact_list_visible_blocks(const iso_exact_projection *projection, uint32_t span,
                                  iso_exact_visible *visible);

iso_exact_block_projection iso_exact_project_block(const iso_exact_projection *projection,
                                                   const iso_exact_span *span, const iso_exact_block *block);

/* Pixels x0 x1 y0 y1 whose rays can meet the box of half extents `half` around `centre` (index coordinates)
 * at or behind the near plane, clipped to `clip` (the same four); false when there are none. */
bool iso_exact_pixel_box(const iso_exact_projection *projection, const double centre[3], const double half[3],
                         const int clip[4], int pixels[4]);

#endif
