/* study: the standard views in which methods are compared, and pictures of them with depth, normals and
 * coverage.
 *
 * A volume is seen from one side at three scales: the whole surface, and 4 and 16 times magnified around a
 * pixel near silhouettes. Pictures are square. Views are in the grid's world coordinates; for a study that
 * does not depend on the volume's position and orientation in its file, give the grid the local transform
 * (iso_transform_local). */
#ifndef ISO_COMPARE_STUDY_H
#define ISO_COMPARE_STUDY_H

#include "compare/metrics.h"
#include "image/aov.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/shading/shading.h"
#include "scene/method.h"

/* A ball that contains the surface: around the centre of its box, with its farthest vertex on the sphere. */
typedef struct iso_study_ball {
    iso_vec3 center; /* world */
    double radius;   /* mm */
} iso_study_ball;

/* Computes the ball from a mesh's vertices. ISO_ERR_EMPTY when there are none. */
iso_status iso_study_bound(const iso_mesh_view *mesh, iso_study_ball *ball, iso_error *error);

/* The view in which the ball exactly fits a square picture of side x side pixels: full angle 30 degrees, z
 * up, seen from 34.4 + `azimuth` degrees to the right of the front (-y) and 20 degrees from above. */
iso_view iso_study_fit(const iso_study_ball *ball, int side, double azimuth);

/* The same from any direction: `outward` is a unit vector from the ball's centre to the eye. */
iso_view iso_study_fit_from(const iso_study_ball *ball, int side, iso_vec3 outward);

/* Returns the view of iso_study_fit magnified `zoom` times, with its pixel `aim` in the middle of the
 * picture. */
iso_view iso_study_zoom(const iso_view *fit, const int aim[2], double zoom);

/* Chooses the pixel for magnified views: the covered pixel nearest to the middle for which squares of 1/4 and
 * 1/16 of the side around it are 50 to 95 percent covered, so that silhouettes are visible with 4 and 16
 * times magnification. The middle when there is no such pixel. `side` must be a multiple of 32.
 * ISO_ERR_NOMEM. */
iso_status iso_study_aim(const uint8_t *mask, int side, int aim[2], iso_error *error);

/* A picture by a method; without float channels the planes of `aov` are NULL. iso_study_frame_free when done.
 */
typedef struct iso_study_frame {
    iso_image image;
    iso_aov aov;
} iso_study_frame;

/* Appearance of pictures. */
typedef struct iso_study_look {
    iso_rgb color, background;
    int samples;     /* per pixel, a square number; 0 means 1 */
    int transparent; /* 1: the background has alpha 0 */
} iso_study_look;

/* Allocates a frame for pictures of side x side pixels, with or without float channels, uninitialised.
 * ISO_ERR_USAGE (the side), ISO_ERR_NOMEM. */
iso_status iso_study_frame_create(int side, bool channels, iso_study_frame *frame, iso_error *error);
void iso_study_frame_free(iso_study_frame *frame);

/* Draws a picture into a frame of the view's size. ISO_ERR_USAGE (samples), ISO_ERR_NOMEM, and the errors of
 * the method. */
iso_status iso_study_draw(const iso_scene_surface *surface, const iso_renderer *method, const iso_view *view,
                          const iso_study_look *look, iso_study_frame *frame, iso_error *error);

/* Returns the frame as an input of iso_compare, which borrows it. */
iso_compare_picture iso_study_picture(const iso_study_frame *frame);

/* Returns the median of times or of other values, the mean of the two in the middle when their number is
 * even; NaN without values. Sorts the values. */
double iso_study_median(double *values, size_t count);

#endif
