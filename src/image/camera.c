#include "image/camera.h"

#include <assert.h>
#include <float.h>
#include <stddef.h>

/* Left free on each side of the picture by iso_camera_fit, as a part of the picture. */
static const double FIT_MARGIN = 0.04;
/* An eye is at the pole when the sine of the angle between its view and view_up is below this. */
static const double POLE = 1e-6;

static double radians(double degrees) {
    return degrees * (ISO_PI / 180);
}

/* Right-hand rotation about a unit axis (Rodrigues). */
static iso_vec3 rotate(iso_vec3 v, iso_vec3 axis, double degrees) {
    double sine, cosine;
    iso_sincos(radians(degrees), &sine, &cosine);
    iso_vec3 along = iso_vec3_scale(axis, iso_vec3_dot(axis, v) * (1 - cosine));
    iso_vec3 across = iso_vec3_scale(iso_vec3_cross(axis, v), sine);
    return iso_vec3_add(iso_vec3_scale(v, cosine), iso_vec3_add(along, across));
}

/* The shortest rotation that takes z to `up`; for up = -z half a turn about y, which keeps the front view's
 * direction. */
static iso_vec3 tilt(iso_vec3 v, iso_vec3 up) {
    double cosine = up.z;
    if (cosine < -1 + 1e-12) return iso_vec3_make(-v.x, v.y, -v.z);
    iso_vec3 axis = iso_vec3_cross(iso_vec3_make(0, 0, 1), up);
    iso_vec3 along = iso_vec3_scale(axis, iso_vec3_dot(axis, v) / (1 + cosine));
    return iso_vec3_add(iso_vec3_scale(v, cosine), iso_vec3_add(along, iso_vec3_cross(axis, v)));
}

void iso_direction_vectors(iso_direction direction, iso_vec3 up, iso_vec3 *forward, iso_vec3 *view_up) {
    static const iso_vec3 table[][2] = {
        [ISO_FRONT] = {{0, 1, 0}, {0, 0, 1}},       [ISO_BACK] = {{0, -1, 0}, {0, 0, 1}},
        [ISO_LEFT] = {{-1, 0, 0}, {0, 0, 1}},       [ISO_RIGHT] = {{1, 0, 0}, {0, 0, 1}},
        [ISO_TOP] = {{0, 0, -1}, {0, 1, 0}},        [ISO_BOTTOM] = {{0, 0, 1}, {0, -1, 0}},
        [ISO_ISOMETRIC] = {{-1, 1, -1}, {0, 0, 1}},
    };
    assert((size_t)direction < sizeof table / sizeof table[0]);
    *forward = tilt(iso_vec3_unit(table[direction][0]), up);
    *view_up = tilt(table[direction][1], up);
}

/* Unit vectors to the right and upwards in the picture. */
typedef struct frame {
    iso_vec3 right, up, forward;
} frame;

static frame frame_of(iso_vec3 forward, iso_vec3 view_up) {
    frame f = {.forward = iso_vec3_unit(forward)};
    f.right = iso_vec3_unit(iso_vec3_cross(f.forward, view_up));
    f.up = iso_vec3_cross(f.right, f.forward);
    return f;
}

void iso_camera_orbit(iso_camera *camera, double azimuth, double elevation) {
    iso_vec3 arm = iso_vec3_sub(camera->position, camera->focal_point);
    arm = rotate(arm, iso_vec3_unit(camera->view_up), azimuth);
    frame before = frame_of(iso_vec3_scale(arm, -1), camera->view_up);
    iso_vec3 axis = iso_vec3_scale(before.right, -1);
    arm = rotate(arm, axis, elevation);
    camera->position = iso_vec3_add(camera->focal_point, arm);
    iso_vec3 up = rotate(before.up, axis, elevation);
    if (iso_vec3_dot(up, iso_vec3_unit(camera->view_up)) < POLE) camera->view_up = up;
}

void iso_camera_fit(iso_camera *camera, const iso_box *box, double aspect, int turns) {
    assert(!iso_box_is_empty(box) && aspect > 0 && turns >= 1);
    iso_vec3 center = iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5);
    iso_vec3 forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position));
    iso_vec3 pole = iso_vec3_unit(camera->view_up);
    double reach_y = iso_tan(radians(camera->view_angle) / 2) * (1 - 2 * FIT_MARGIN);
    double distance = 0, scale = 0;
    for (int turn = 0; turn < turns; turn++) {
        frame f = frame_of(rotate(forward, pole, 360.0 * turn / turns), camera->view_up);
        for (int corner = 0; corner < 8; corner++) {
            iso_vec3 p = iso_vec3_sub(iso_box_corner(box, corner), center);
            double y = fmax(fabs(iso_vec3_dot(p, f.up)), fabs(iso_vec3_dot(p, f.right)) / aspect);
            double z = iso_vec3_dot(p, f.forward);
            scale = fmax(scale, y / (1 - 2 * FIT_MARGIN));
            /* a box without width must still lie in front of the near plane */
            distance = fmax(distance, fmax(y / reach_y - z, -1.001 * z));
        }
    }
    if (!(distance > 0)) { /* a single point: show a millimetre around it */
        distance = 1 / reach_y;
        scale = 1;
    }
    camera->focal_point = center;
    camera->position = iso_vec3_sub(center, iso_vec3_scale(forward, distance));
    if (camera->orthographic) camera->parallel_scale = scale > 0 ? scale : distance;
}

/* Newton's method on sin(x - atan t), which has no far field to get lost in. t > 0. */
static double arc_tangent(double t) {
    double x = t < 1 ? 0.8 * t : ISO_PI / 2 - 0.8 / t;
    for (int i = 0; i < 4; i++) { /* cubic: the first guess is within 0.2 */
        double sine, cosine;
        iso_sincos(x, &sine, &cosine);
        x -= (sine - t * cosine) / (cosine + t * sine);
    }
    return x;
}

void iso_camera_zoom(iso_camera *camera, double factor) {
    double half = arc_tangent(iso_tan(radians(camera->view_angle) / 2) / factor);
    camera->view_angle = 2 * half * (180 / ISO_PI);
    camera->parallel_scale /= factor;
}

static bool is_finite(iso_vec3 v) {
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

iso_status iso_camera_check(const iso_camera *camera, iso_error *error) {
    if (!is_finite(camera->position) || !is_finite(camera->focal_point) || !is_finite(camera->view_up))
        return iso_fail(error, ISO_ERR_USAGE, "camera: position, focal point and view up must be finite");
    iso_vec3 forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position));
    if (!(iso_vec3_length(forward) > 0.5))
        return iso_fail(error, ISO_ERR_USAGE, "camera: position and focal point are the same");
    if (!(iso_vec3_length(iso_vec3_cross(forward, iso_vec3_unit(camera->view_up))) > 1e-9))
        return iso_fail(error, ISO_ERR_USAGE, "camera: view up is zero or parallel to the view direction");
    if (!(camera->view_angle > 0 && camera->view_angle < 180))
        return iso_fail(error, ISO_ERR_USAGE, "camera: view angle %g is not between 0 and 180 degrees",
                        camera->view_angle);
    if (camera->orthographic && !(camera->parallel_scale > 0 && isfinite(camera->parallel_scale)))
        return iso_fail(error, ISO_ERR_USAGE, "camera: parallel scale %g is not positive",
                        camera->parallel_scale);
    return ISO_OK;
}

static void set_row(double row[3], iso_vec3 v) {
    row[0] = v.x;
    row[1] = v.y;
    row[2] = v.z;
}

iso_view iso_view_make(const iso_camera *camera, int width, int height) {
    iso_vec3 arm = iso_vec3_sub(camera->focal_point, camera->position);
    frame f = frame_of(arm, camera->view_up);
    iso_view view = {.eye = camera->position,
                     .cx = width / 2.0,
                     .cy = height / 2.0,
                     .width = width,
                     .height = height,
                     .orthographic = camera->orthographic};
    set_row(view.rotation, f.right);
    set_row(view.rotation + 3, iso_vec3_scale(f.up, -1));
    set_row(view.rotation + 6, f.forward);
    view.focal = height / 2.0 /
                 (camera->orthographic ? camera->parallel_scale : iso_tan(radians(camera->view_angle) / 2));
    view.near = camera->orthographic ? -DBL_MAX : 1e-4 * iso_vec3_length(arm);
    return view;
}

iso_view iso_view_scaled(const iso_view *view, int factor) {
    iso_view scaled = *view;
    scaled.focal *= factor;
    scaled.cx *= factor;
    scaled.cy *= factor;
    scaled.width *= factor;
    scaled.height *= factor;
    scaled.above *= factor;
    scaled.below *= factor;
    return scaled;
}

iso_view iso_view_rows(const iso_view *view, int y0, int height) {
    iso_view rows = *view;
    rows.cy -= y0;
    rows.above += y0;
    rows.below += view->height - y0 - height;
    rows.height = height;
    return rows;
}

iso_vec3 iso_view_vector(const iso_view *view, iso_vec3 v) {
    const double *r = view->rotation;
    return iso_vec3_make(r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
                         r[6] * v.x + r[7] * v.y + r[8] * v.z);
}

iso_vec3 iso_view_point(const iso_view *view, iso_vec3 world) {
    return iso_view_vector(view, iso_vec3_sub(world, view->eye));
}

static iso_vec3 to_world(const iso_view *view, iso_vec3 v) {
    const double *r = view->rotation;
    return iso_vec3_make(r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
                         r[2] * v.x + r[5] * v.y + r[8] * v.z);
}

void iso_view_ray(const iso_view *view, double px, double py, iso_vec3 *origin, iso_vec3 *direction) {
    double x = (px - view->cx) / view->focal, y = (py - view->cy) / view->focal;
    if (view->orthographic) {
        *origin = iso_vec3_add(view->eye, to_world(view, iso_vec3_make(x, y, 0)));
        *direction = to_world(view, iso_vec3_make(0, 0, 1));
    } else {
        *origin = view->eye;
        *direction = to_world(view, iso_vec3_make(x, y, 1));
    }
}
