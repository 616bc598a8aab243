/* cut: a plane is moved by writing its text anew, of which the cut is made: so pictures in the window are cut
 * exactly as those that isorender draws with the text. */
#include "apps/isosculpt/viewport/cut.h"

#include <stdio.h>
#include <string.h>

/* Of a plane's normal, towards the eye: from here on it is moved as if it were seen face on. */
static const double FACE_ON = 0.95;
/* Degrees that a pixel of dragging tilts the plane by. */
static const double DEGREES_A_PIXEL = 0.5;

static iso_vec3 outward_of(const iso_clip_body *body) {
    const double *f = body->face[0], side = body->keeps ? 1 : -1; /* the face points out of the body */
    return iso_vec3_make(side * f[0], side * f[1], side * f[2]);
}

/* Gives a cut that is a plane the handle, next to a point. */
static void give_handle(isosculpt_cut *cut, int number, iso_vec3 point) {
    const double *f = cut->cuts[number].body.face[0];
    const iso_vec3 normal = {f[0], f[1], f[2]};
    cut->plane = number;
    cut->outward = outward_of(&cut->cuts[number].body);
    cut->handle = iso_vec3_add(point, iso_vec3_scale(normal, f[3] - iso_vec3_dot(normal, point)));
}

iso_status isosculpt_cut_add(isosculpt_cut *cut, const char *text, iso_vec3 middle, iso_error *error) {
    if (cut->count == ISO_CLIP_BODIES)
        return iso_fail(error, ISO_ERR_LIMIT, "more than %d cuts", ISO_CLIP_BODIES);
    if (strlen(text) >= ISOSCULPT_CUT_TEXT)
        return iso_fail(error, ISO_ERR_LIMIT, "a cut of more than %d characters", ISOSCULPT_CUT_TEXT - 1);
    ISO_TRY(iso_cut_parse(text, &cut->cuts[cut->count], error));
    iso_cut_set_middle(&cut->cuts[cut->count], middle);
    snprintf(cut->texts[cut->count], ISOSCULPT_CUT_TEXT, "%s", text);
    if (cut->cuts[cut->count].plane && cut->plane < 0) give_handle(cut, cut->count, middle);
    cut->count++;
    return ISO_OK;
}

void isosculpt_cut_place(isosculpt_cut *cut, iso_vec3 point, iso_vec3 outward) {
    const int number = cut->plane >= 0 ? cut->plane : cut->count;
    const iso_vec3 p = point, n = iso_vec3_unit(outward);
    char text[ISOSCULPT_CUT_TEXT], things[64] = "";
    if (number == ISO_CLIP_BODIES) return;
    const char *at = number < cut->count ? strchr(cut->texts[number], '@') : NULL;
    if (at) snprintf(things, sizeof things, "%.63s", at);
    snprintf(text, sizeof text, "%.9g,%.9g,%.9g:%.9g,%.9g,%.9g%s", p.x, p.y, p.z, n.x, n.y, n.z, things);
    iso_cut parsed;
    if (iso_cut_parse(text, &parsed, NULL) != ISO_OK) return; /* farther away than a cut can be */
    cut->cuts[number] = parsed;
    memcpy(cut->texts[number], text, sizeof text);
    if (number == cut->count) cut->count++;
    cut->plane = number;
    cut->handle = point;
    cut->outward = n;
}

void isosculpt_cut_remove_plane(isosculpt_cut *cut) {
    if (cut->plane < 0) return;
    const size_t behind = (size_t)(--cut->count - cut->plane);
    memmove(&cut->cuts[cut->plane], &cut->cuts[cut->plane + 1], behind * sizeof *cut->cuts);
    memmove(cut->texts[cut->plane], cut->texts[cut->plane + 1], behind * sizeof *cut->texts);
    cut->plane = -1;
}

/* ---- the handle */

static bool find_pixel(const iso_view *view, iso_vec3 point, double *x, double *y, double *mm) {
    const iso_vec3 p = iso_view_point(view, point);
    if (!(p.z > view->near)) return false;
    *mm = (view->orthographic ? 1 : p.z) / view->focal;
    *x = view->cx + p.x / *mm;
    *y = view->cy + p.y / *mm;
    return true;
}

bool isosculpt_cut_find_handle(const isosculpt_cut *cut, const iso_view *view, double scale,
                               isosculpt_cut_handle *handle) {
    double unused;
    if (cut->plane < 0 || !find_pixel(view, cut->handle, &handle->x, &handle->y, &handle->mm)) return false;
    const iso_vec3 arrow = iso_vec3_scale(cut->outward, scale * ISOSCULPT_CUT_ARROW * handle->mm);
    return find_pixel(view, iso_vec3_add(cut->handle, arrow), &handle->tip_x, &handle->tip_y, &unused);
}

static bool is_near(double dx, double dy, double distance) {
    return dx * dx + dy * dy <= distance * distance;
}

isosculpt_cut_part isosculpt_cut_hit(const isosculpt_cut_handle *handle, double scale, double x, double y) {
    const double grip = scale * ISOSCULPT_CUT_GRIP;
    if (is_near(x - handle->x, y - handle->y, grip)) return ISOSCULPT_CUT_POINT;
    return is_near(x - handle->tip_x, y - handle->tip_y, grip) ? ISOSCULPT_CUT_TIP : ISOSCULPT_CUT_NOTHING;
}

void isosculpt_cut_drag(isosculpt_cut *cut, const iso_view *view, double dx, double dy) {
    isosculpt_cut_handle h;
    const iso_vec3 n = iso_view_vector(view, cut->outward);
    if (!isosculpt_cut_find_handle(cut, view, 1, &h)) return;
    const double beside = n.x * n.x + n.y * n.y;
    const double pixels = fabs(n.z) > FACE_ON ? (n.z > 0 ? -dy : dy) : (dx * n.x + dy * n.y) / beside;
    isosculpt_cut_place(cut, iso_vec3_add(cut->handle, iso_vec3_scale(cut->outward, pixels * h.mm)),
                        cut->outward);
}

/* `v` turned about a unit axis. */
static iso_vec3 turn(iso_vec3 v, iso_vec3 axis, double degrees) {
    double sine, cosine;
    iso_sincos(degrees * ISO_PI / 180, &sine, &cosine);
    const iso_vec3 along = iso_vec3_scale(axis, iso_vec3_dot(axis, v) * (1 - cosine)),
                   across = iso_vec3_scale(iso_vec3_cross(axis, v), sine);
    return iso_vec3_add(iso_vec3_scale(v, cosine), iso_vec3_add(along, across));
}

void isosculpt_cut_tilt(isosculpt_cut *cut, const iso_view *view, double dx, double dy) {
    const double *r = view->rotation;
    /* The side of the arrow that is nearer to the eye follows the pointer. */
    const double side = iso_view_vector(view, cut->outward).z > 0 ? -1 : 1;
    const iso_vec3 right = {r[0], r[1], r[2]}, down = {r[3], r[4], r[5]};
    const iso_vec3 turned = turn(cut->outward, down, -side * DEGREES_A_PIXEL * dx);
    isosculpt_cut_place(cut, cut->handle, turn(turned, right, side * DEGREES_A_PIXEL * dy));
}
