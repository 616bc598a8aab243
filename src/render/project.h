/* project: what the drawing methods share: index coordinates to view space, which rows of the picture a brick
 * can reach, and how rows are dealt out to threads.
 *
 * Nothing here depends on where in a larger picture the view's rows lie, except the row numbers themselves:
 * pictures drawn in strips are the same bytes. */
#ifndef ISO_RENDER_PROJECT_H
#define ISO_RENDER_PROJECT_H

#include <stdbool.h>

#include "base/parallel.h"
#include "base/primitives.h"
#include "image/camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* (not fmin and fmax, which are calls) */
static inline double iso_least(double a, double b) {
    return a < b ? a : b;
}

static inline double iso_most(double a, double b) {
    return a > b ? a : b;
}

typedef struct iso_projector {
    const iso_view *view;        /* borrowed */
    double matrix[9], origin[3]; /* index to view space */
    float normal[9];             /* index covector to view space; lengths are not kept */
} iso_projector;

iso_projector iso_projector_make(const iso_view *view, const iso_transform *transform);

/* View space position of a brick-relative one. The same world position gives the same bits from every brick:
 * the global index coordinate is exact. */
static inline iso_vec3 iso_projector_point(const iso_projector *projector, const int32_t brick[3],
                                           const float position[3]) {
    const double *m = projector->matrix, *o = projector->origin;
    double x = brick[0] * (double)ISO_BRICK + position[0], y = brick[1] * (double)ISO_BRICK + position[1],
           z = brick[2] * (double)ISO_BRICK + position[2];
    return iso_vec3_make(m[0] * x + m[1] * y + m[2] * z + o[0], m[3] * x + m[4] * y + m[5] * z + o[1],
                         m[6] * x + m[7] * y + m[8] * z + o[2]);
}

/* The eye in index coordinates, or (orthographic) the direction of the view. */
void iso_projector_eye(const iso_projector *projector, const iso_transform *transform, double eye[3]);

/* Unit view space normal of an index space one; towards the viewer when that one has no direction. */
void iso_projector_normal(const iso_projector *projector, const float normal[3], float out[3]);

/* Pixels per millimetre at depth z. */
static inline double iso_projector_scale(const iso_projector *projector, double z) {
    return projector->view->orthographic ? projector->view->focal : projector->view->focal / z;
}

/* Rows first .. last; none when first > last. */
typedef struct iso_rows {
    int first, last;
} iso_rows;

/* Rows of the view that primitives with centres in `box` (index coordinates) and of `radius` mm can touch:
 * too many rather than too few; none when they are all out of sight. */
iso_rows iso_projector_rows(const iso_projector *projector, const iso_box *box, double radius);

/* Whether everything in a span's bounds faces the eye, or away from it, by far more than a primitive's own
 * test can err; `eye` is iso_projector_eye's. */
typedef enum iso_facing { ISO_FACING_BOTH, ISO_FACING_EYE, ISO_FACING_AWAY } iso_facing;
iso_facing iso_projector_facing(const iso_projector *projector, const double eye[3], const int32_t brick[3],
                                const iso_point_bounds *bounds);

/* Box of surfels in index coordinates; those that are not finite are left out. */
iso_box iso_surfel_bounds(const iso_surfel *surfels, size_t count, const int32_t brick[3]);

/* Rows of a picture dealt out in bands: one for one thread, else several for each. */
int iso_band_count(const iso_pool *pool, int height);
iso_rows iso_band_rows(int height, int band_count, size_t band);

static inline bool iso_rows_meet(iso_rows a, iso_rows b) {
    return a.first <= b.last && b.first <= a.last;
}

#ifdef __cplusplus
}
#endif
#endif
