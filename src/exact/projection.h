/* projection: how a grid, its octants and its cells are projected into one picture. Internal to exact.
 *
 * Floats are precise enough because each quantity is relative to something near: pixels to a whole pixel next
 * to the projected octant, cells to the octant's centre, rays to the cell's centre, depths to the depth of
 * the grid's centre. Large quantities (an octant's position in view space, the eye in index coordinates) are
 * computed in double. Pixel coordinates are first taken relative to the optical axis, so that a picture drawn
 * in strips has the same bytes as one drawn at once. */
#ifndef ISO_EXACT_PROJECTION_H
#define ISO_EXACT_PROJECTION_H

#include "exact/gradient.h"
#include "exact/set.h"
#include "render/layers/opacity.h"
#include "render/view/project.h"

/* The picture of iso_paint_exact or iso_draw_exact_keys: pixels are shaded as soon as they are found, without
 * a gbuffer. */
typedef struct iso_exact_paint {
    int32_t *pixels;    /* of the image, RGBA; NULL: `keys` is set instead */
    ptrdiff_t skipped;  /* how many pixels of the image come before the first of `pixels` */
    uint64_t *keys;     /* of a key image: place of the brick << 32 | RGBA */
    uint64_t *depths;   /* place of the brick << 32 | bits of the depth; NULL: not kept */
    const float *u, *v; /* rays (u, v, 1): u by column (with ISO_LANES_MAX readable items more), v by row */
    float base[3];      /* the surface's colour, 0 .. 1 */
    int32_t empty;      /* RGBA of a pixel without a surface */
} iso_exact_paint;

/* How the crossings of a translucent surface become fragments (render/layers). */
typedef struct iso_exact_fragments {
    iso_layer_opacity opacity;
    bool normals;        /* fragments get the normal (view space) instead of the shaded colour */
    int32_t surface;     /* number of the surface */
    int32_t fall_leaves; /* 1: where the field falls along a ray, the ray leaves the solid; 0: it enters it */
} iso_exact_fragments;

typedef struct iso_exact_projection {
    const iso_target *target;
    const iso_exact_paint *paint; /* NULL: draws into the gbuffer. Else of the target's gbuffer only the size
                                     is set */
    const iso_exact_fragments *fragments; /* of the kernel that lists layers; it needs `paint` as well, for
                                             rays and colour */
    const iso_exact *exact;
    iso_exact_gradients *gradients;
    iso_exact_voxels voxels;
    bool perspective;
    double matrix[9], origin[3]; /* index to view space */
    double eye[3];               /* in index coordinates; used with perspective only */
    double half_depth;           /* half the extent of a cell along the view direction, mm */
    /* The cell on each axis where the front-to-back order turns: from cell `split` on, smaller coordinates
     * are nearer to the eye; before it, larger ones. */
    int split[3];
    int axis[2];      /* the pixel in which the optical axis lies */
    double offset[2]; /* position of a pixel's centre relative to the optical axis: pixel - axis + offset */
    double middle;    /* depth of the grid's centre, rounded to float: depths in cells are relative to it */
    float ray[3][3];  /* [k][i]: component i of view axis k in cell coordinates (half voxels), per mm */
    float per_focal;  /* 1 / focal; 0 when rays are parallel */
    float isovalue_ceil,
        residual;    /* of the surface; a quarter of both for float voxels, so that differences stay finite */
    float normal[9]; /* matrix from gradient to outward normal in view space, not of unit length */
    const iso_clip *clip; /* what is cut away; NULL: nothing */
    iso_affine to_world;  /* from index coordinates */
} iso_exact_projection;

/* First and last column, first and last row. */
typedef struct iso_exact_box {
    uint16_t x0, x1, y0, y1;
} iso_exact_box;

/* A brick and the pixels that its cells can touch. */
typedef struct iso_exact_visible_brick {
    uint32_t number; /* the index of its span in the set's array; for key images its number in the grid */
    iso_exact_box box;
} iso_exact_visible_brick;

/* An octant and the pixels that its cells can touch. */
typedef struct iso_exact_visible {
    uint32_t span, octant; /* indices in the set's arrays of spans and octants */
    iso_exact_box box;
    const void *corners; /* values at the corners of the octant's cells (iso_exact_corners) */
} iso_exact_visible;

/* How the cells of one octant are projected, in floats. The reference direction is that of the ray to the
 * octant's centre, rounded to float. */
typedef struct iso_exact_octant_projection {
    bool near;           /* some cells may lie next to the eye: use iso_exact_project_near_cells */
    bool clip;           /* the near plane may cut cells */
    int origin[2];       /* the pixel that pixels are counted from */
    float off_axis[2];   /* distance of that pixel's centre from the optical axis, pixels */
    float place[2];      /* projected centre of the octant, in pixels from `origin` */
    float residue[2];    /* x and y of the octant's centre minus `reference` * its depth, mm: the rounding
                            error of `reference` */
    float reference[2];  /* x / z and y / z of the reference direction */
    float sheared[2][3]; /* `across` minus `reference` * `along` */
    float across[2][3], along[3]; /* a step of one voxel on each index axis in view space: x and y, z; mm */
    float focal;                  /* of the camera, pixels */
    float depth;                  /* of the octant's centre, mm */
    float relative;               /* `depth` minus iso_exact_projection.middle, mm */
    float behind;                 /* `depth` minus the depth of the near plane, mm */
    float cell_pixels;            /* about how many pixels the bounding box of a projected cell has */
} iso_exact_octant_projection;

/* The projection for a target and an iso_exact that is up to date; both are borrowed. */
iso_exact_projection iso_exact_projection_make(const iso_target *target, const iso_exact *exact);

/* Element i of the front-to-back order of the numbers 0 .. count - 1 on an axis: split, split + 1, ..,
 * count - 1, then split - 1, .., 0. */
static inline int iso_exact_front_to_back(int i, int count, int split) {
    int first = split < 0 ? 0 : split > count ? count : split;
    return i < count - first ? first + i : count - 1 - i;
}
/* The inverse of iso_exact_front_to_back: the index of number `n` in the front-to-back order. */
static inline int iso_exact_rank(int n, int count, int split) {
    int first = split < 0 ? 0 : split > count ? count : split;
    return n >= first ? n - first : count - 1 - n;
}

/* The brick of the whole in which the front-to-back order turns on an axis; -1: before the first. */
static inline int iso_exact_brick_split(const iso_exact_projection *projection, int axis) {
    const int cells = projection->split[axis];
    return cells >= 0 ? cells / ISO_BRICK : -1;
}

/* The place of a brick of the whole in the order in which bricks are drawn, front to back. */
static inline uint32_t iso_exact_place(const iso_exact_projection *projection, const int32_t brick[3]) {
    uint32_t place = 0;
    for (int axis = 2; axis >= 0; axis--) {
        const int bricks = (projection->exact->dims[axis] - 1) / ISO_BRICK + 1;
        place = place * (uint32_t)bricks +
                (uint32_t)iso_exact_rank(brick[axis], bricks, iso_exact_brick_split(projection, axis));
    }
    return place;
}

/* Whether the picture can show a brick of the whole; sets `box` to its pixels then. */
bool iso_exact_brick_is_visible(const iso_exact_projection *projection, const int32_t brick[3],
                                iso_exact_box *box);

/* Writes the octants of a visible brick that the picture can show, front to back; returns their number (up to
 * ISO_EXACT_OCTANTS). */
int iso_exact_list_visible_octants(const iso_exact_projection *projection, uint32_t span,
                                   iso_exact_visible *visible);

/* The projection of one octant of a span. */
iso_exact_octant_projection iso_exact_project_octant(const iso_exact_projection *projection,
                                                     const iso_exact_span *span,
                                                     const iso_exact_octant *octant);

/* What is left of the box with the half extents `half` around `centre`, both in index coordinates;
 * iso_clip_of_box. All, if nothing is cut away. */
iso_clip_rest iso_exact_clip_of_box(const iso_exact_projection *projection, const double centre[3],
                                    const double half[3], unsigned *cutting);

/* The pixels x0 x1 y0 y1 whose rays can meet a box at or behind the near plane, clipped to the pixels `clip`
 * (in the same order); false when there are none. The box has the half extents `half` around `centre`, both
 * in index coordinates. */
bool iso_exact_pixel_box(const iso_exact_projection *projection, const double centre[3], const double half[3],
                         const int clip[4], int pixels[4]);

#endif
