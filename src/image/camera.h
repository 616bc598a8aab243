/* camera: where the picture is taken from, and the view that turns world points into pixels.
 *
 * World is right-handed millimetres. View space is right-handed too: x right, y down, z forward (depth, mm).
 * The pixel of a view point is (cx + focal * x / z, cy + focal * y / z), or (cx + focal * x, cy + focal * y)
 * when orthographic; pixel (i, j) is sampled at (i + 0.5, j + 0.5). Camera values have the names of F3D. */
#ifndef ISO_IMAGE_CAMERA_H
#define ISO_IMAGE_CAMERA_H

#include <stdbool.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/status.h"
#include "isopoint.h"

ISO_C_BEGIN

/* View direction (from the eye into the scene) and up vector of a preset, for a world whose up axis is `up`
 * (unit; z up is {0,0,1}; for another up axis the presets are rotated with it). */
void iso_direction_vectors(iso_direction direction, iso_vec3 up, iso_vec3 *forward, iso_vec3 *view_up);

/* Turns the camera about its focal point: azimuth degrees around view_up (counter-clockwise seen from above:
 * the eye moves to the right), then elevation degrees upwards, like vtkCamera::Azimuth and Elevation. When
 * the eye reaches or passes a pole, where VTK's view would degenerate or flip, view_up is turned with it;
 * otherwise view_up stays, so that several azimuths add up to a turntable. */
void iso_camera_orbit(iso_camera *camera, double azimuth, double elevation);

/* Keeps the camera's direction, and sets its distance (or parallel_scale) so that `box` (world) exactly fits
 * into a picture of `aspect` (width / height) with a margin of 4 % on each side. With `turns` > 1 the box
 * fits into each of so many views spaced evenly in azimuth. The focal point becomes the box's centre. The box
 * must not be empty. */
void iso_camera_fit(iso_camera *camera, const iso_box *box, double aspect, int turns);

/* The options of iso_camera_fit_box and iso_camera_fit_tight. */
typedef struct iso_fit {
    double aspect; /* width / height of the picture */
    int turns;     /* number of views, spaced evenly in azimuth, that all must fit; 0 means 1 */
    double
        fill; /* part of the picture's width or height that is filled, up to 1; 0: 0.92 as iso_camera_fit */
    /* For iso_camera_fit_tight: returns the ranges of the dot products of all points (world) with each of
     * three vectors, as a box whose x, y and z belong to the first, second and third vector; an empty box
     * when there are no points. */
    iso_box (*bounds)(void *context, const iso_vec3 vectors[3]);
    void *context;
} iso_fit;

/* Margin of iso_camera_fit, as a part of the picture on each side. */
#define ISO_FIT_MARGIN 0.04

/* Works as iso_camera_fit, but with margins of (1 - fill) / 2 instead of 4 %. fit->bounds is not used. */
void iso_camera_fit_box(iso_camera *camera, const iso_box *box, const iso_fit *fit);

/* Fits the projected points instead of a box around them: keeps the camera's direction, and sets eye and
 * focal point so that the rectangle of the points in the picture is centred and exactly fills it in width or
 * in height. `center` (world) is at the depth of the focal point. With several turns the focal point is
 * `center`, the axis of the turns, and the distance is the least with which every view shows all points. */
void iso_camera_fit_tight(iso_camera *camera, iso_vec3 center, const iso_fit *fit);

/* Returns the size of a pixel in mm in a picture of `height` rows; 0 for perspective cameras, which have no
 * single scale. */
double iso_camera_mm_per_pixel(const iso_camera *camera, int height);

/* Changes view_angle and parallel_scale so that the picture is magnified exactly by `factor` > 0 (VTK divides
 * the angle instead, which is not exact). */
void iso_camera_zoom(iso_camera *camera, double factor);

/* Whether two cameras have the same values. */
bool iso_camera_equal(const iso_camera *a, const iso_camera *b);

/* ISO_ERR_USAGE when the camera cannot see: eye at the focal point, view_up parallel to the view, a bad
 * angle, a value that is not finite. */
iso_status iso_camera_check(const iso_camera *camera, iso_error *error);

/* The mapping from world to pixels that renderers use. For a part of a larger picture, cx and cy are relative
 * to the part. */
typedef struct iso_view {
    double rotation[9]; /* row-major; rows are view x, y, z in world */
    iso_vec3 eye;       /* world */
    double focal;       /* perspective: pixels per unit of x/z; orthographic: pixels per mm */
    double cx, cy;      /* pixel of the optical axis */
    int width, height;
    int above,
        below; /* number of rows of the whole picture above and below this part; 0 for a whole picture */
    bool orthographic;
    double near; /* mm; nothing nearer than this is drawn (perspective: > 0; orthographic: may be negative) */
} iso_view;

/* The view of a checked camera for a picture of width x height. near is 1e-4 of the distance to the focal
 * point for perspective views; orthographic ones see everything (-DBL_MAX). */
iso_view iso_view_make(const iso_camera *camera, int width, int height);

/* The view of the same picture with `factor` times as many pixels on each side. */
iso_view iso_view_scaled(const iso_view *view, int factor);
/* The view of rows y0 .. y0 + height - 1 of a picture. */
iso_view iso_view_rows(const iso_view *view, int y0, int height);

iso_vec3 iso_view_point(const iso_view *view, iso_vec3 world);  /* world to view space */
iso_vec3 iso_view_vector(const iso_view *view, iso_vec3 world); /* the same for vectors */
/* Computes the ray through the position (px, py) of the picture, in world space: position = origin + t *
 * direction; t is the depth. */
void iso_view_ray(const iso_view *view, double px, double py, iso_vec3 *origin, iso_vec3 *direction);

ISO_C_END
#endif
