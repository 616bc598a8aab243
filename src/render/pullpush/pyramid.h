/* pyramid: the image pyramid of pull-push: the picture with a guard band around it at 1, 1/2, 1/4 .. of its
 * resolution (Marroquim, Kraus and Cavalcanti 2008, section 3), as planes of floats. Internal to render.
 *
 * Points are projected into level `base`, one per pixel, as keys; pull averages them up to level `top`, push
 * fills gaps downwards to level 0. Pixels of every level are counted from the corner of the guard band of the
 * whole picture, also when only a strip of the picture is drawn. The pyramid of a strip includes all rows
 * around the strip that its pixels depend on, so that they are the same as in the whole picture. */
#ifndef ISO_RENDER_PULLPUSH_PYRAMID_H
#define ISO_RENDER_PULLPUSH_PYRAMID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "image/camera.h"
#include "render/points/point_blocks.h"

enum {
    ISO_PYRAMID_TOP = 10,   /* the highest level */
    ISO_PYRAMID_GUARD = 512 /* the widest guard band, pixels */
};

/* The planes of a level: what each of its pixels stores. Values are finite even in pixels without a point,
 * except ISO_PLANE_WIDE there. */
enum {
    ISO_PLANE_NX, /* mean normal, of tubes mean tangent, in view space, not unit */
    ISO_PLANE_NY,
    ISO_PLANE_NZ,
    ISO_PLANE_DEPTH, /* mean depth, mm */
    ISO_PLANE_LOW, /* depth interval, mm; both ISO_NOWHERE where there is no point. Of a surface alone LOW is
                        the mean depth, and HIGH is not used */
    ISO_PLANE_HIGH,
    ISO_PLANE_DX, /* from the pixel's centre to the ellipse's centre, in pixels of the level */
    ISO_PLANE_DY,
    /* The ellipse. At offset d from its centre, in pixels of the level, q = WIDE d.d + (d.THIN)^2; d is
     * inside when q < 1 and d.THIN <= OUT. THIN is the direction of the shorter axis, towards the silhouette:
     * the side on which a surface that curves away ends. WIDE is infinite where there is no point.
     * Until the ellipse is computed, the plane of WIDE contains HIDDEN instead: 1 where another surface
     * continues behind this pixel's, else 0. There OUT is larger, because otherwise gaps would show between
     * the front surface's silhouette and the surface behind. Of a surface alone it is 1 in pixels that push
     * has made WEAK (gaps_simd.h). Afterwards it is the bit ISO_OUT_MARK of OUT. */
    ISO_PLANE_WIDE,
    ISO_PLANE_HIDDEN = ISO_PLANE_WIDE,
    ISO_PLANE_THIN_X,
    ISO_PLANE_THIN_Y,
    ISO_PLANE_OUT,
    /* Optional planes, for points with radii or colours of their own, and for line fragments. Level 0 has no
     * others. */
    ISO_PLANE_RADIUS, /* mm */
    ISO_PLANE_RED,    /* 0 .. 255 */
    ISO_PLANE_GREEN,
    ISO_PLANE_BLUE,
    ISO_PLANE_INTERVAL, /* length of the depth interval, mm; without this plane it is the radius */
    /* The ellipse as a symmetric matrix M, in pixels^2 of level 0: d is inside when d' M^-1 d < 1. With these
     * planes ellipses are not made from normals and radii, and OUT limits nothing. */
    ISO_PLANE_SHAPE_XX,
    ISO_PLANE_SHAPE_XY,
    ISO_PLANE_SHAPE_YY,
    /* Of line fragments: the line's direction in the picture, as cosine and sine of twice its angle, so that
     * opposite directions are the same. ROOM: of ribbons, how far the line goes on in this direction, pixels
     * of level 0; of tubes, the distance to the nearer end of the line's leg, mm, less than 0 if the leg
     * begins there. */
    ISO_PLANE_TWICE_X,
    ISO_PLANE_TWICE_Y,
    ISO_PLANE_ROOM,
    /* In a pyramid of several sets: which set a pixel shows. Its surface number, plus ISO_SET_RIBBON and
     * ISO_SET_COLORED. */
    ISO_PLANE_SET,
    /* Of lines alone: the only planes of the levels from 1 on, and the others only of the base level. Not
     * floats but int32_t: the number of the line fragment that a pixel shows, plus 1, and of one that lies
     * behind it; 0: none. */
    ISO_PLANE_PLACE,
    ISO_PLANE_BEHIND,
    ISO_PLANES,
    ISO_PLANE_OPTIONAL = ISO_PLANE_RADIUS
};

/* The lowest bits of ISO_PLANE_OUT: HIDDEN; of a surface alone: the disc may reach the grid's border. */
enum { ISO_OUT_MARK = 1, ISO_OUT_BORDER = 2 };

/* In values of ISO_PLANE_SET: the set's pixels are line fragments of ribbons, not of a surface; it has
 * colours of its own. */
enum { ISO_SET_RIBBON = 256, ISO_SET_COLORED = 512 };

/* A key represents a projected point. The high 32 bits are the depth's bits, mapped so that keys compare like
 * depths; the low 32 bits are the payload: bits 0..21 the normal as in an iso_point (index space), bits
 * 22..26 and 27..31 the point's column and row within its pixel, in 1/32. Of the points in a pixel, the one
 * with the smallest key is kept. */
#define ISO_KEY_NONE INT64_MAX

/* A key of a depth, with the payload 0: a payload is added. */
static inline int64_t iso_key_of_depth(float depth) {
    int32_t bits;
    memcpy(&bits, &depth, sizeof bits);
    bits ^= bits >> 31 & INT32_MAX;
    return (int64_t)bits * ((int64_t)1 << 32);
}

static inline float iso_key_depth(int64_t key) {
    int32_t bits = (int32_t)(key >> 32);
    float depth;
    bits ^= bits >> 31 & INT32_MAX;
    memcpy(&depth, &bits, sizeof depth);
    return depth;
}

/* In the index: the pixel's fragment is not a point, and has its attributes in the planes already. */
enum { ISO_INDEX_NONE = -1 };

/* Keys are emptied in pieces of this many columns and two rows, 2y and 2y + 1. */
enum { ISO_KEY_PIECE = 32 };

/* Pixel (x, y) of a plane is at [y * stride + x]. Around the pixels is a border without points, one row high
 * and wide enough that vectors may begin left of the first column and end right of the last. */
typedef struct iso_pyramid_level {
    int width, height;
    size_t stride;
    float *plane[ISO_PLANES];
} iso_pyramid_level;

/* The size and contents of a pyramid. Zero-initialise: layouts are compared byte by byte. */
typedef struct iso_pyramid_layout {
    int base, top;   /* level that points are projected into; highest level */
    int guard;       /* width of the guard band, pixels of level 0 */
    int column, row; /* the view's pixel that is pixel (0, 0) of level 0 */
    int rows_before; /* rows of the whole picture and its guard band above that pixel; a multiple of 2^top */
    int width, height; /* of level 0, pixels */
    uint32_t planes;   /* bit p is set: optional plane p exists */
    int indexed;       /* 1: the number of each pixel's point is kept */
} iso_pyramid_layout;

typedef struct iso_line_fragment iso_line_fragment; /* line_graph.h */

/* Zero-initialise; free with iso_pyramid_free. */
typedef struct iso_pyramid {
    iso_pyramid_layout layout;
    iso_pyramid_level level[ISO_PYRAMID_TOP + 1];
    int64_t *keys;     /* of level `base`: its height + 1 rows of key_stride, the last one empty */
    size_t key_stride; /* a multiple of ISO_KEY_PIECE */
    uint8_t *used;     /* 1 for each piece that may contain a key; key_stride / ISO_KEY_PIECE in a row */
    int32_t *index;    /* the points' numbers, arranged like the keys; NULL unless layout.indexed */
    /* Of lines alone: their fragments, an array of iso_line_fragment, row by row; the number of the first of
     * each row of the base level, and of the end. The index has their numbers. */
    iso_buffer line_fragments;
    int32_t *line_starts;
    iso_buffer memory;
} iso_pyramid;

/* Chooses the levels for discs with projected radii from radius[0] to radius[1] pixels, where low_pass
 * (pixels^2) is added to the squares. *top: the first level in which the largest disc's radius is at most
 * half a pixel, within limits; *base: the highest level below *top in which the smallest disc's radius is
 * at least 8 pixels, or 0. */
void iso_pyramid_levels(const float radius[2], float low_pass, int *base, int *top);

/* The layout of a view's pyramid with these levels, without optional planes and index. */
iso_pyramid_layout iso_pyramid_layout_of(const iso_view *view, int base, int top);

/* Size and stride of level `number`, without planes. */
iso_pyramid_level iso_pyramid_level_of(const iso_pyramid_layout *layout, int number);

/* Bytes of memory of a pyramid with this layout; SIZE_MAX: it is too large. */
size_t iso_pyramid_bytes(const iso_pyramid_layout *layout);

/* The rows of the base level, in bands of `band_rows`. */
static inline iso_level_bands iso_pyramid_bands(const iso_pyramid *pyramid, int band_rows) {
    const int base = pyramid->layout.base;
    return (iso_level_bands){base, pyramid->layout.row, pyramid->level[base].height, band_rows};
}

/* Gives the pyramid this layout and sets its borders. Pixels and keys are undefined afterwards unless the
 * layout is unchanged. Memory is reused. ISO_ERR_NOMEM. */
iso_status iso_pyramid_resize(iso_pyramid *pyramid, const iso_pyramid_layout *layout, iso_error *error);
void iso_pyramid_free(iso_pyramid *pyramid);

#endif
