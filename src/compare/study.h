/* study: the views in which methods are judged, and pictures of them with their float channels.
 *
 * A volume is seen from one side at three scales: fit, and narrowed to 4 and 16 times that around a spot
 * where silhouettes are in view. Pictures are square. World is the grid's, so a study that shall not depend
 * on how a file lies in space gives its grid the local transform. */
#ifndef ISO_COMPARE_STUDY_H
#define ISO_COMPARE_STUDY_H

#include "compare/metrics.h"
#include "image/aov.h"
#include "image/camera.h"
#include "image/image.h"
#include "methods/method.h"
#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The ball that the surface is seen in: around the middle of its box, reaching to its farthest vertex. */
typedef struct iso_study_ball {
    iso_vec3 center; /* world */
    double radius;   /* mm */
} iso_study_ball;

/* From a mesh's vertices. ISO_ERR_EMPTY when there is none. */
iso_status iso_study_bound(const iso_mesh_view *mesh, iso_study_ball *ball, iso_error *error);

/* The ball exactly in a square picture of side x side pixels, full angle 30 degrees, z up, seen from 34.4
 * degrees to the right of the front (-y), then `azimuth` degrees more, and 20 degrees from above. */
iso_view iso_study_fit(const iso_study_ball *ball, int side, double azimuth);

/* Narrows the fit view: `zoom` times larger, pixel `aim` of it in the middle. */
iso_view iso_study_zoom(const iso_view *fit, const int aim[2], double zoom);

/* The covered pixel nearest the middle whose surroundings, squares of 1/4 and 1/16 of the side, are covered
 * by one half to 95 percent: silhouettes will be in sight at 4 and 16 times. The middle when there is none.
 * side must be a multiple of 32. ISO_ERR_NOMEM. */
iso_status iso_study_aim(const uint8_t *mask, int side, int aim[2], iso_error *error);

/* A picture of a method, with its channels or without (then aov's planes are NULL). iso_study_frame_free when
 * done. */
typedef struct iso_study_frame {
    iso_image image;
    iso_aov aov;
} iso_study_frame;

/* What pictures look like. */
typedef struct iso_study_look {
    iso_rgb color, background;
    int samples;     /* per pixel, a square number; 0 means 1 */
    int transparent; /* 1: the background's alpha is 0 */
} iso_study_look;

/* A frame for pictures of side x side pixels, with channels or without, nothing in it. ISO_ERR_USAGE (the
 * side), ISO_ERR_NOMEM. */
iso_status iso_study_frame_create(int side, bool channels, iso_study_frame *frame, iso_error *error);
void iso_study_frame_free(iso_study_frame *frame);

/* Draws into a frame of the view's size. ISO_ERR_USAGE (samples), ISO_ERR_NOMEM, and what the method returns.
 */
iso_status iso_study_draw(const iso_subject *subject, const iso_renderer *method, const iso_view *view,
                          const iso_study_look *look, iso_study_frame *frame, iso_error *error);

/* The frame as a side of a comparison; borrows. */
iso_compare_picture iso_study_picture(const iso_study_frame *frame);

/* Unrounded colours of a frame with channels, width * height * 3 display values 0 .. 255, for errors finer
 * than a step of a byte: Phong's model with one light at the eye (ambient 0.15, diffuse 0.8, specular 0.3 of
 * exponent 40), both sides lit, the look's colour and background. */
void iso_study_light(const iso_study_frame *frame, const iso_view *view, const iso_study_look *look,
                     float *color);

/* Mean change between two frames: mean |difference| of R, G and B, 0 .. 255, over the union of silhouettes
 * (frames must have channels); NaN when both are empty. */
double iso_study_change(const iso_study_frame *a, const iso_study_frame *b);

#ifdef __cplusplus
}
#endif
#endif
