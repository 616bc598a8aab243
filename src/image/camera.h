/* camera: where the picture is taken from, and the view that turns world points into pixels.
 *
 * World is right-handed millimetres. View space is right-handed too: x right, y down, z forward (depth, mm).
 * The pixel of a view point is (cx + focal * x / z, cy + focal * y / z), or (cx + focal * x, cy + focal * y)
 * when orthographic; pixel (i, j) is sampled at (i + 0.5, j + 0.5). Names of camera values are F3D's. */
#ifndef ISO_IMAGE_CAMERA_H
#define ISO_IMAGE_CAMERA_H

#include <stdbool.h>

#include "base/geometry.h"
#include "base/status.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* View direction (from the eye into the scene) and up vector of a preset, for a world whose up axis is `up`
 * (unit; z up is {0,0,1}; for another up axis the presets are rotated with it). */
void iso_direction_vectors(iso_direction direction, iso_vec3 up, iso_vec3 *forward, iso_vec3 *view_up);

/* Turns the camera about its focal point: azimuth degrees around view_up (counter-clockwise seen from above:
 * the eye moves to the right), then elevation degrees upwards. As VTK's vtkCamera::Azimuth and Elevation, but
 * view_up is turned along at the poles and beyond them, where VTK's view would degenerate or flip; before
 * them it is kept, so that azimuths add up to a turntable. */
void iso_camera_orbit(iso_camera *camera, double azimuth, double elevation);

/* Moves the eye back (or sets parallel_scale) along its direction so that `box` (world) fits into a picture
 * of `aspect` (width / height) with a margin of 4 % on each side, exactly, for `turns` (>= 1) views spaced
 * evenly in azimuth: one framing for all. The focal point becomes the box's centre. An empty box is a
 * programming mistake. */
void iso_camera_fit(iso_camera *camera, const iso_box *box, double aspect, int turns);

/* What iso_camera_fit_tight frames. */
typedef struct iso_fit {
    double aspect; /* width / height of the picture */
    int turns;     /* views spaced evenly in azimuth that share one framing; 0: 1 */
    double
        fill; /* part of the picture's width or height that is filled, up to 1; 0: 0.92 as iso_camera_fit */
    /* The box of all points in the space in which a point's coordinates are its products with three world
     * vectors; empty when there are none. */
    iso_box (*bounds)(void *context, const iso_vec3 vectors[3]);
    void *context;
} iso_fit;

/* Margin of iso_camera_fit, as a part of the picture on each side. */
#define ISO_FIT_MARGIN 0.04

/* As iso_camera_fit with margins of (1 - fill) / 2 instead of 4 %. */
void iso_camera_fit_box(iso_camera *camera, const iso_box *box, const iso_fit *fit);

/* Frames the points themselves instead of a box around them: moves eye and focal point so that the box of the
 * points in the picture is in its middle and fills it in width or in height, exactly. `center` (world) lies
 * at the depth of the focal point. With several turns the focal point is `center`, about which they turn, and
 * the distance is what all of them need. */
void iso_camera_fit_tight(iso_camera *camera, iso_vec3 center, const iso_fit *fit);

/* Orthographic: mm a pixel's side covers in a picture of `height` rows; perspective: 0, there is no one
 * scale. */
double iso_camera_mm_per_pixel(const iso_camera *camera, int height);

/* Narrows view_angle and parallel_scale so that things appear `factor` times larger, exactly (VTK divides the
 * angle instead); factor > 0. */
void iso_camera_zoom(iso_camera *camera, double factor);

/* ISO_ERR_USAGE when the camera cannot see: eye at the focal point, view_up parallel to the view, a bad
 * angle, a value that is not finite. */
iso_status iso_camera_check(const iso_camera *camera, iso_error *error);

/* What renderers use. A window of a larger picture has its cx, cy moved. */
typedef struct iso_view {
    double rotation[9]; /* row-major; rows are view x, y, z in world */
    iso_vec3 eye;       /* world */
    double focal;       /* perspective: pixels per unit of x/z; orthographic: pixels per mm */
    double cx, cy;      /* pixel of the optical axis */
    int width, height;
    int above,
        below; /* rows of the picture over and under these, for what looks beyond a pixel; 0 when whole */
    bool orthographic;
    double near; /* mm; nothing nearer than this is drawn (perspective: > 0; orthographic: may be negative) */
} iso_view;

/* The view of a checked camera for a picture of width x height. near is 1e-4 of the distance to the focal
 * point for perspective views; orthographic ones see everything (-DBL_MAX). */
iso_view iso_view_make(const iso_camera *camera, int width, int height);

/* The same picture sampled `factor` x `factor` times as densely. */
iso_view iso_view_scaled(const iso_view *view, int factor);
/* Rows y0 .. y0 + height - 1 of it. */
iso_view iso_view_rows(const iso_view *view, int y0, int height);

iso_vec3 iso_view_point(const iso_view *view, iso_vec3 world);  /* world to view space */
iso_vec3 iso_view_vector(const iso_view *view, iso_vec3 world); /* the same for vectors */
/* Ray of picture position (px, py) in world: position = origin + t * direction, t = depth. */
void iso_view_ray(const iso_view *view, double px, double py, iso_vec3 *origin, iso_vec3 *direction);

#ifdef __cplusplus
}
#endif
#endif
