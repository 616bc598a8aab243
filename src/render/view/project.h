/* project: what the drawing methods share: the transform from index coordinates to view space, the rows of
 * the picture that a brick can cover, and the division of a picture's rows into bands, one task each.
 *
 * Except for row numbers, no result depends on where in a larger picture the view's rows lie, so that a
 * picture drawn in strips has the same bytes as one drawn at once. */
#ifndef ISO_RENDER_VIEW_PROJECT_H
#define ISO_RENDER_VIEW_PROJECT_H

#include <stdbool.h>

#include "base/numbers.h"
#include "base/parallel.h"
#include "base/primitives.h"
#include "image/camera.h"

typedef struct iso_projector {
    const iso_view *view;        /* borrowed */
    double matrix[9], origin[3]; /* index to view space */
    float normal[9];             /* normals from index to view space; the result is not unit */
} iso_projector;

iso_projector iso_projector_make(const iso_view *view, const iso_transform *transform);

/* View space position (mm) of a position relative to a brick (voxels). A position that two bricks share gives
 * the same bits from both, because its index coordinates are computed exactly first. */
static inline iso_vec3 iso_projector_point(const iso_projector *projector, const int32_t brick[3],
                                           const float position[3]) {
    const double *m = projector->matrix, *o = projector->origin;
    double x = brick[0] * (double)ISO_BRICK + position[0], y = brick[1] * (double)ISO_BRICK + position[1],
           z = brick[2] * (double)ISO_BRICK + position[2];
    return iso_vec3_make(m[0] * x + m[1] * y + m[2] * z + o[0], m[3] * x + m[4] * y + m[5] * z + o[1],
                         m[6] * x + m[7] * y + m[8] * z + o[2]);
}

/* The eye in index coordinates; with orthographic views the direction of view instead. */
void iso_projector_eye(const iso_projector *projector, const iso_transform *transform, double eye[3]);

/* Unit normal in view space, given one in index space. A zero normal becomes (0, 0, -1), towards the
 * viewer. */
void iso_projector_normal(const iso_projector *projector, const float normal[3], float out[3]);

/* Pixels per millimetre at depth z. */
static inline double iso_projector_scale(const iso_projector *projector, double z) {
    return projector->view->orthographic ? projector->view->focal : projector->view->focal / z;
}

/* Rows first .. last; none when first > last. */
typedef struct iso_rows {
    int first, last;
} iso_rows;

/* A part of the picture, and the least depth of what lies there. */
typedef struct iso_area {
    iso_rows columns, rows; /* none: it is empty */
    double nearest;         /* mm */
} iso_area;

static inline bool iso_area_is_empty(const iso_area *area) {
    return area->columns.first > area->columns.last || area->rows.first > area->rows.last;
}

/* The pixels of the view that spheres of `radius` mm with centres in `box` (index coordinates) can cover, and
 * the least depth of the spheres, with a margin for rounding: a conservative estimate, empty when all lie
 * outside the picture. */
iso_area iso_projector_area(const iso_projector *projector, const iso_box *box, double radius);
/* The rows of that area. */
iso_rows iso_projector_rows(const iso_projector *projector, const iso_box *box, double radius);

/* Whether all points or triangles within a span's bounds face the eye, or all face away from it. Certain:
 * by a margin that is larger than the rounding error of a test of each of them. `eye` is the result of
 * iso_projector_eye. */
typedef enum iso_facing { ISO_FACING_BOTH, ISO_FACING_EYE, ISO_FACING_AWAY } iso_facing;
iso_facing iso_projector_facing(const iso_projector *projector, const double eye[3], const int32_t brick[3],
                                const iso_point_bounds *bounds);

/* Bounding box of surfels in index coordinates; positions that are not finite are left out. */
iso_box iso_surfel_bounds(const iso_surfel *surfels, size_t count, const int32_t brick[3]);

/* Into how many bands a picture of `height` rows is divided: one when there is one thread, else several per
 * thread, so that all threads finish at about the same time. */
int iso_band_count(const iso_pool *pool, int height);
/* The rows of band `band` of `band_count`. */
iso_rows iso_band_rows(int height, int band_count, size_t band);

static inline bool iso_rows_meet(iso_rows a, iso_rows b) {
    return a.first <= b.last && b.first <= a.last;
}

#endif
