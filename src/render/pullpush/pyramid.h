/* pyramid: where points become a picture: the picture with a guard band around it at 1, 1/2, 1/4 .. of its
 * resolution (Marroquim, Kraus and Cavalcanti 2008, section 3), in planes of floats. Internal to render.
 *
 * Points go into level `base`, one to a pixel, as keys; they are averaged up to level `top` (pull), and gaps
 * are filled downwards to level 0 (push). The lattice of pixels starts at the corner of the whole picture's
 * guard band, and a strip of a picture takes in as many rows around its own as any of its pixels can depend
 * on: each pixel is the same in the strip and in the whole. */
#ifndef ISO_RENDER_PULLPUSH_PYRAMID_H
#define ISO_RENDER_PULLPUSH_PYRAMID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "image/camera.h"

enum {
    ISO_PYRAMID_TOP = 10,   /* the highest level */
    ISO_PYRAMID_GUARD = 512 /* the widest guard band, pixels */
};

/* What a pixel of a level holds. All are finite, even where nothing is, but for ISO_PLANE_WIDE there. */
enum {
    ISO_PLANE_NX, /* view space normal, of any length */
    ISO_PLANE_NY,
    ISO_PLANE_NZ,
    ISO_PLANE_DEPTH, /* mean depth, mm */
    ISO_PLANE_LOW,   /* depth interval, mm; ISO_NOWHERE where there is no point */
    ISO_PLANE_HIGH,
    ISO_PLANE_DX, /* from the pixel's centre to the ellipse's, in pixels of the level */
    ISO_PLANE_DY,
    /* The ellipse: at a distance d, in pixels of the level, from its centre, q = WIDE d.d + (d.THIN)^2;
     * inside q < 1 and d.THIN <= OUT, THIN pointing to where the surface ends. WIDE is infinite where there
     * is no point. Before ellipses are made, HIDDEN says where a surface goes on behind the end of another:
     * there OUT is more, else there would be a gap between the two; it is in the last bit of OUT then. */
    ISO_PLANE_WIDE,
    ISO_PLANE_HIDDEN = ISO_PLANE_WIDE, /* 1 or 0 */
    ISO_PLANE_THIN_X,
    ISO_PLANE_THIN_Y,
    ISO_PLANE_OUT,
    /* Averages that only some points need; level 0 has no plane but these. */
    ISO_PLANE_RADIUS, /* mm */
    ISO_PLANE_RED,    /* 0 .. 255 */
    ISO_PLANE_GREEN,
    ISO_PLANE_BLUE,
    ISO_PLANES,
    ISO_PLANE_OPTIONAL = ISO_PLANE_RADIUS
};

/* A depth beyond all others, finite so that it can be weighted by zero. */
#define ISO_NOWHERE 1e30f

/* A key is the depth's bits, made to order like the depth itself, above a payload: bits 0..21 the normal as
 * an iso_point has it (index space), 22..26 and 27..31 where in its pixel the point lies, in 1/32. The
 * smallest key of a pixel is its point. */
#define ISO_KEY_NONE INT64_MAX

/* Keys of a row that are emptied together, with those of the row below: rows 2y and 2y + 1. */
enum { ISO_KEY_PIECE = 32 };

/* Pixel (x, y) is at [y * stride + x]; there is a border of no points around, at least one pixel wide and so
 * that vectors may begin before the left end and go beyond the right. */
typedef struct iso_pyramid_level {
    int width, height;
    size_t stride;
    float *plane[ISO_PLANES];
} iso_pyramid_level;

/* What decides a pyramid's layout. Zero-initialise. */
typedef struct iso_pyramid_layout {
    int base, top, guard;
    int column, row;   /* the view's pixel that is the pyramid's (0, 0) of level 0 */
    int rows_before;   /* rows of the whole picture and its guard band before that, a multiple of 2^top */
    int width, height; /* level 0 */
    uint32_t planes;   /* optional ones that are there, a bit for each */
    int indexed;       /* 1: there is an index */
} iso_pyramid_layout;

typedef struct iso_pyramid {
    iso_pyramid_layout layout;
    iso_pyramid_level level[ISO_PYRAMID_TOP + 1];
    int64_t *keys; /* of level `base`: its height + 1 rows of key_stride, the last empty */
    size_t key_stride;
    uint8_t *used;  /* of each piece of keys: whether there has been a point in it since it was emptied; as
                       many  in a row as key_stride has */
    int32_t *index; /* the points' numbers, laid out like the keys; NULL unless asked for */
    iso_buffer memory;
} iso_pyramid;

/* The levels that discs of projected radii radius[0] .. radius[1] need, with low_pass (pixels^2) added to
 * their squares: up to that of which the largest is half a pixel, and down to that in which the smallest
 * are 8. */
void iso_pyramid_levels(const float radius[2], float low_pass, int *base, int *top);

/* The shape of a view's pyramid: its levels and what there is in it */
iso_pyramid_layout iso_pyramid_layout_of(const iso_view *view, int base, int top);

/* A level's size, without planes. */
iso_pyramid_level iso_pyramid_level_of(const iso_pyramid_layout *layout, int number);

/* Bytes that a pyramid of this shape takes; SIZE_MAX when it is impossible. */
size_t iso_pyramid_bytes(const iso_pyramid_layout *layout);

/* Gives the pyramid this shape; what lay in it is lost, its memory is kept and reused. Borders are made,
 * pixels are not. ISO_ERR_NOMEM. */
iso_status iso_pyramid_resize(iso_pyramid *pyramid, const iso_pyramid_layout *layout, iso_error *error);
void iso_pyramid_free(iso_pyramid *pyramid);

#endif
