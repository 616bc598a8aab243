/* camera: rotations, fits and views. Uses no function of libm whose result differs between machines. */
#include "image/camera.h"

#include <assert.h>
#include <float.h>
#include <stddef.h>

/* The eye is at a pole when the sine of the angle between the view direction and view_up is below this. */
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

/* Applies to v the shortest rotation that turns z to `up`; for up = -z half a turn about y, which keeps the
 * front view's direction. */
static iso_vec3 rotate_z_to(iso_vec3 v, iso_vec3 up) {
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
    *forward = rotate_z_to(iso_vec3_unit(table[direction][0]), up);
    *view_up = rotate_z_to(table[direction][1], up);
}

/* Unit vectors to the right, upwards and into the picture, in world coordinates. */
typedef struct view_axes {
    iso_vec3 right, up, forward;
} view_axes;

static view_axes view_axes_of(iso_vec3 forward, iso_vec3 view_up) {
    view_axes f = {.forward = iso_vec3_unit(forward)};
    f.right = iso_vec3_unit(iso_vec3_cross(f.forward, view_up));
    f.up = iso_vec3_cross(f.right, f.forward);
    return f;
}

void iso_camera_orbit(iso_camera *camera, double azimuth, double elevation) {
    iso_vec3 arm = iso_vec3_sub(camera->position, camera->focal_point);
    arm = rotate(arm, iso_vec3_unit(camera->view_up), azimuth);
    view_axes before = view_axes_of(iso_vec3_scale(arm, -1), camera->view_up);
    iso_vec3 axis = iso_vec3_scale(before.right, -1);
    arm = rotate(arm, axis, elevation);
    camera->position = iso_vec3_add(camera->focal_point, arm);
    iso_vec3 up = rotate(before.up, axis, elevation);
    if (iso_vec3_dot(up, iso_vec3_unit(camera->view_up)) < POLE) camera->view_up = up;
}

static double fill_of(const iso_fit *fit) {
    return fit->fill > 0 ? fit->fill : 1 - 2 * ISO_FIT_MARGIN;
}

void iso_camera_fit(iso_camera *camera, const iso_box *box, double aspect, int turns) {
    iso_camera_fit_box(camera, box, &(iso_fit){.aspect = aspect, .turns = turns});
}

void iso_camera_fit_box(iso_camera *camera, const iso_box *box, const iso_fit *fit) {
    const double aspect = fit->aspect, fill = fill_of(fit);
    const int turns = fit->turns > 0 ? fit->turns : 1;
    assert(!iso_box_is_empty(box) && aspect > 0);
    iso_vec3 center = iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5);
    iso_vec3 forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position));
    iso_vec3 pole = iso_vec3_unit(camera->view_up);
    double reach_y = iso_tan(radians(camera->view_angle) / 2) * fill;
    double distance = 0, scale = 0;
    for (int turn = 0; turn < turns; turn++) {
        view_axes f = view_axes_of(rotate(forward, pole, 360.0 * turn / turns), camera->view_up);
        for (int corner = 0; corner < 8; corner++) {
            iso_vec3 p = iso_vec3_sub(iso_box_corner(box, corner), center);
            double y = fmax(fabs(iso_vec3_dot(p, f.up)), fabs(iso_vec3_dot(p, f.right)) / aspect);
            double z = iso_vec3_dot(p, f.forward);
            scale = fmax(scale, y / fill);
            /* a box without width must lie in front of the near plane, too */
            distance = fmax(distance, fmax(y / reach_y - z, -1.001 * z));
        }
    }
    if (!(distance > 0)) { /* a single point: show the millimetre around it */
        distance = 1 / reach_y;
        scale = 1;
    }
    camera->focal_point = center;
    camera->position = iso_vec3_sub(center, iso_vec3_scale(forward, distance));
    if (camera->orthographic) camera->parallel_scale = scale > 0 ? scale : distance;
}

/* ---- fitting the points */

/* The extent of all points relative to two planes that bound the visible region. Both planes contain `center`
 * and diverge by `slope` mm for each mm of depth. */
typedef struct reach {
    double high; /* largest distance of a point beyond the plane on the side of +axis, along the axis;
                    negative: all points are inside */
    double low;  /* the same on the side of -axis */
    double near; /* least depth, relative to the center */
} reach;

static reach reach_of(const iso_fit *fit, iso_vec3 center, const view_axes *f, iso_vec3 axis, double slope) {
    const iso_vec3 back = iso_vec3_scale(f->forward, slope);
    const iso_vec3 vectors[3] = {iso_vec3_sub(axis, back), iso_vec3_add(axis, back), f->forward};
    const iso_box box = fit->bounds(fit->context, vectors);
    return (reach){box.hi.x - iso_vec3_dot(vectors[0], center), iso_vec3_dot(vectors[1], center) - box.lo.y,
                   box.lo.z - iso_vec3_dot(f->forward, center)};
}

/* The extent of the points on one axis of the picture. */
typedef struct extent {
    double needed; /* perspective: distance of the eye from the center at which all points are visible;
                      orthographic: half of the visible length, mm */
    double middle; /* middle of the points on the axis, relative to the center, mm */
    double near;   /* least depth, relative to the center */
} extent;

static extent extent_of(const iso_fit *fit, iso_vec3 center, const view_axes *f, iso_vec3 axis,
                        double slope) {
    const reach r = reach_of(fit, center, f, axis, slope);
    const double half = (r.high + r.low) / 2;
    return (extent){slope > 0 ? half / slope : half, (r.high - r.low) / 2, r.near};
}

/* Returns the middle of the points on an axis, as seen from `distance`. This is the extent's middle for the
 * slope whose needed distance is `distance`. The needed distance is a convex, increasing function of the
 * inverse of the slope, so the method of false position (Illinois variant) finds the slope in a few rounds.
 * `slope` is that of the picture's side, where the search begins. */
static double middle_at_distance(const iso_fit *fit, iso_vec3 center, const view_axes *f, iso_vec3 axis,
                                 double slope, double distance) {
    enum { DOUBLINGS = 12, ROUNDS = 40 };
    const double close = 1e-7 * fabs(distance);
    double low = 1 / slope, high = low;
    extent at = extent_of(fit, center, f, axis, slope);
    double below = at.needed - distance, above = below;
    for (int i = 0; i < DOUBLINGS && above < -close; i++) {
        high *= 2;
        at = extent_of(fit, center, f, axis, 1 / high);
        above = at.needed - distance;
    }
    if (above < 0 || below > -close)
        return at.middle; /* the search interval has no root, as when all points
                                                          coincide */
    for (int i = 0, side = 0; i < ROUNDS; i++) {
        const double inverse = (low * above - high * below) / (above - below);
        at = extent_of(fit, center, f, axis, 1 / inverse);
        const double now = at.needed - distance;
        if (fabs(now) <= close) break;
        if (now < 0) {
            low = inverse;
            below = now;
            if (side < 0) above /= 2;
            side = -1;
        } else {
            high = inverse;
            above = now;
            if (side > 0) below /= 2;
            side = 1;
        }
    }
    return at.middle;
}

/* Fits one view: the middle of the projected points becomes the middle of the picture. */
static void fit_one_view(iso_camera *camera, iso_vec3 center, const iso_fit *fit, const view_axes *f) {
    const double fill = fill_of(fit);
    const double y_slope = camera->orthographic ? 0 : iso_tan(radians(camera->view_angle) / 2) * fill;
    const double x_slope = y_slope * fit->aspect;
    const extent x = extent_of(fit, center, f, f->right, x_slope),
                 y = extent_of(fit, center, f, f->up, y_slope);
    double distance = 1, right = x.middle, up = y.middle;
    if (camera->orthographic) {
        camera->parallel_scale = fmax(x.needed / fit->aspect, y.needed) / fill;
        if (!(camera->parallel_scale > 0)) camera->parallel_scale = 1; /* a single point */
        distance = fmax(camera->parallel_scale, -1.001 * x.near);
    } else {
        distance = fmax(fmax(x.needed, y.needed), -1.001 * x.near);
        if (!(distance > 0)) distance = 1 / y_slope;
        right = middle_at_distance(fit, center, f, f->right, x_slope, distance);
        up = middle_at_distance(fit, center, f, f->up, y_slope, distance);
    }
    center = iso_vec3_add(center, iso_vec3_add(iso_vec3_scale(f->right, right), iso_vec3_scale(f->up, up)));
    camera->focal_point = center;
    camera->position = iso_vec3_sub(center, iso_vec3_scale(f->forward, distance));
}

/* Returns the needed distance (or half length) if the center must stay in the middle: the larger one of both
 * sides. */
static double needed_with_fixed_center(const iso_fit *fit, iso_vec3 center, const view_axes *f, iso_vec3 axis,
                                       double slope) {
    const reach r = reach_of(fit, center, f, axis, slope);
    const double half = fmax(r.high, r.low);
    return fmax(slope > 0 ? half / slope : half, slope > 0 ? -1.001 * r.near : 0);
}

/* Fits all views of a turntable. */
static void fit_all_turns(iso_camera *camera, iso_vec3 center, const iso_fit *fit, const view_axes *first) {
    const double fill = fill_of(fit);
    const double y_slope = camera->orthographic ? 0 : iso_tan(radians(camera->view_angle) / 2) * fill;
    const iso_vec3 pole = iso_vec3_unit(camera->view_up);
    double needed = 0;
    for (int turn = 0; turn < fit->turns; turn++) {
        const view_axes f =
            view_axes_of(rotate(first->forward, pole, 360.0 * turn / fit->turns), camera->view_up);
        const double x = needed_with_fixed_center(fit, center, &f, f.right, y_slope * fit->aspect);
        const double y = needed_with_fixed_center(fit, center, &f, f.up, y_slope);
        needed = fmax(needed, fmax(camera->orthographic ? x / fit->aspect : x, y));
    }
    if (!(needed > 0)) needed = 1;
    if (camera->orthographic) camera->parallel_scale = needed / fill;
    camera->focal_point = center;
    camera->position = iso_vec3_sub(center, iso_vec3_scale(first->forward, needed));
}

void iso_camera_fit_tight(iso_camera *camera, iso_vec3 center, const iso_fit *fit) {
    const view_axes f = view_axes_of(iso_vec3_sub(camera->focal_point, camera->position), camera->view_up);
    if (fit->turns > 1)
        fit_all_turns(camera, center, fit, &f);
    else
        fit_one_view(camera, center, fit, &f);
}

double iso_camera_mm_per_pixel(const iso_camera *camera, int height) {
    return camera->orthographic ? 2 * camera->parallel_scale / height : 0;
}

/* atan(t) for t > 0, without libm, whose results differ between machines: Newton's method for the root of
 * sin(x - atan t). */
static double arc_tangent(double t) {
    double x = t < 1 ? 0.8 * t : ISO_PI / 2 - 0.8 / t;
    for (int i = 0; i < 4; i++) { /* converges cubically, from an error of at most 0.2 */
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

static bool equal_vectors(iso_vec3 a, iso_vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool iso_camera_equal(const iso_camera *a, const iso_camera *b) {
    return equal_vectors(a->position, b->position) && equal_vectors(a->focal_point, b->focal_point) &&
           equal_vectors(a->view_up, b->view_up) && a->view_angle == b->view_angle &&
           a->orthographic == b->orthographic && a->parallel_scale == b->parallel_scale;
}

iso_status iso_camera_check(const iso_camera *camera, iso_error *error) {
    if (!iso_vec3_is_finite(camera->position) || !iso_vec3_is_finite(camera->focal_point) ||
        !iso_vec3_is_finite(camera->view_up))
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

iso_view iso_view_make(const iso_camera *camera, int width, int height) {
    iso_vec3 arm = iso_vec3_sub(camera->focal_point, camera->position);
    view_axes f = view_axes_of(arm, camera->view_up);
    iso_view view = {.eye = camera->position,
                     .cx = width / 2.0,
                     .cy = height / 2.0,
                     .width = width,
                     .height = height,
                     .orthographic = camera->orthographic};
    iso_vec3_store(f.right, view.rotation);
    iso_vec3_store(iso_vec3_scale(f.up, -1), view.rotation + 3);
    iso_vec3_store(f.forward, view.rotation + 6);
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
