/* banded_discs: points as flat discs in view space, with exact perspective: which pixels a disc covers, and
 * where the ray of a pixel meets it. Used by groups, and by layers of discs.
 *
 * The ray of a pixel is intersected with the disc's plane; e is the squared distance of the intersection
 * from the centre in units of the disc's radius, and the disc covers the pixel when e < 1. A disc that is
 * small or seen edge-on covers the pixels whose centres lie within ISO_DISC_LOW_PASS pixels of its own,
 * too: e is the smaller of both distances (Botsch et al. 2005, "High-quality surface splatting on today's
 * GPUs", section 4). Internal to render. */
#ifndef ISO_RENDER_GROUPS_BANDED_DISCS_H
#define ISO_RENDER_GROUPS_BANDED_DISCS_H

#include <math.h>

#include "base/memory.h"
#include "render/view/project.h"

/* Pixels: the smallest radius with which a disc always covers a pixel's centre. */
#define ISO_DISC_LOW_PASS 0.70711f

/* A disc in view space. */
typedef struct iso_disc {
    float x, y;      /* the centre in the picture, pixels from the optical axis */
    float z;         /* the centre's depth, mm */
    float normal[3]; /* unit */
    float radius;    /* mm */
    uint32_t point;  /* index in the view's arrays */
} iso_disc;

/* The parts of a view that intersecting discs requires. */
typedef struct iso_disc_view {
    float slope;   /* perspective: change of a ray's x and y (mm) for one pixel and 1 mm of depth; else 0 */
    float scale;   /* orthographic: mm for one pixel; else 0 */
    float near;    /* mm */
    double axis_x; /* pixel of the optical axis in the whole picture, */
    double axis_y; /* and in the rows of this part */
    int above;     /* rows of the whole picture above this part */
} iso_disc_view;

/* Where the ray of a pixel meets a disc. */
typedef struct iso_disc_hit {
    float depth; /* mm */
    float e;     /* 0 at the centre, 1 at the rim */
    bool away;   /* the disc is back-facing: its normal points away from the eye */
} iso_disc_hit;

/* Columns and rows of pixels, both inclusive; none when first > last. */
typedef struct iso_disc_box {
    iso_rows columns, rows;
} iso_disc_box;

/* All discs of a view, in the order of the spans, and the discs that each band of rows may show.
 * Zero-initialise; free with iso_banded_discs_free. */
typedef struct iso_banded_discs {
    iso_disc_view view;
    iso_buffer disc, rows; /* iso_disc; iso_rows, which are empty if a disc is not drawn */
    iso_buffer columns; /* float: iso_disc_column of each column of the picture, and a vector's worth more */
    size_t count;
    float depth[2];       /* smallest and largest depth of all discs, also of those outside the picture; mm */
    int height;           /* rows of the picture */
    int band_rows, bands; /* rows of a band; number of bands */
    /* uint32_t order[], size_t start[]: band b shows discs order[start[b]] .. order[start[b + 1] - 1]. */
    iso_buffer order, start;
} iso_banded_discs;

iso_disc_view iso_disc_view_make(const iso_view *view);

/* Projects the points of a view as discs of `factor` times their radii. Left out are points whose position is
 * not finite, whose radius is not above 0, or that are nearer than view->near; and, if the set is closed and
 * the eye is outside the box around it, points that face away. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points
 * or more. */
iso_status iso_banded_discs_project(iso_banded_discs *discs, const iso_view *view,
                                    const iso_point_view *points, float factor, iso_pool *pool,
                                    iso_error *error);
/* The order of the discs of a band: that of the spans, or the order of the depths of their centres. */
typedef enum iso_disc_order {
    ISO_DISC_ORDER_GIVEN,
    ISO_DISC_ORDER_FRONT_TO_BACK,
    ISO_DISC_ORDER_BACK_TO_FRONT
} iso_disc_order;

/* Lists the discs of each band in an order; of equal depths the disc of the smaller number is nearer.
 * ISO_ERR_NOMEM. */
iso_status iso_banded_discs_assign(iso_banded_discs *discs, int height, int band_rows, iso_disc_order order,
                                   iso_error *error);
/* Returns the rows of a band. */
iso_rows iso_banded_discs_band(const iso_banded_discs *discs, size_t band);
void iso_banded_discs_free(iso_banded_discs *discs);

/* Returns those pixels of `within` that a disc may cover. */
iso_disc_box iso_disc_bounds(const iso_disc_view *view, const iso_disc *disc, const iso_disc_box *within);

/* Returns the centre of column or row `at`, in pixels from the optical axis. */
static inline float iso_disc_column(const iso_disc_view *view, int at) {
    return (float)(at + 0.5 - view->axis_x);
}

static inline float iso_disc_row(const iso_disc_view *view, int at) {
    return (float)(at + view->above + 0.5 - (view->axis_y + view->above));
}

/* Intersects a disc with the ray through (x, y), in pixels from the optical axis; returns false if the disc
 * does not cover it. */
static inline bool iso_disc_intersect(const iso_disc_view *view, const iso_disc *disc, float x, float y,
                                      iso_disc_hit *hit) {
    const float dx = x - disc->x, dy = y - disc->y, mm = view->scale + disc->z * view->slope;
    const float u = x * view->slope, v = y * view->slope, *n = disc->normal;
    const float facing = n[0] * u + n[1] * v + n[2];
    /* starting at the ray's point at the depth of the disc's centre, which is `t` in front of the disc's
     * plane */
    const float qx = dx * mm, qy = dy * mm, t = -(n[0] * qx + n[1] * qy) / facing;
    const float px = qx + t * u, py = qy + t * v, r = disc->radius;
    const float exact = (px * px + py * py + t * t) / (r * r),
                low = (dx * dx + dy * dy) / (ISO_DISC_LOW_PASS * ISO_DISC_LOW_PASS);
    const bool on_disc = exact < low && disc->z + t >= view->near;
    hit->away = facing > 0;
    hit->e = on_disc ? exact : low;
    hit->depth = disc->z + (on_disc || fabsf(t) <= r ? t : t > r ? r : t < -r ? -r : 0);
    hit->depth = hit->depth < view->near ? view->near : hit->depth;
    return hit->e < 1;
}

/* Returns the weight of a hit, exp(-3 e), with an error below 0.0005. */
static inline float iso_disc_weight(float e) {
    const float y = 1.5f * e,
                root = 1 + y * (1 + y * (1.0f / 2 + y * (1.0f / 6 + y * (1.0f / 24 + y / 120))));
    return 1 / (root * root);
}

#endif
