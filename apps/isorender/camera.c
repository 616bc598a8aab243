/* The camera: presets, framing and turntables. */
#include <math.h>

#include "apps/isorender/chunks.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/flat.h"
#include "apps/isorender/picture_record.h"
#include "apps/isorender/resolution_level.h"
#include "scene/bounds.h"

static bool is_given(const double v[3]) {
    return !isnan(v[0]);
}

static iso_vec3 vector(const double v[3]) {
    return iso_vec3_make(v[0], v[1], v[2]);
}

static double degrees_between_frames(const isorender_settings *settings) {
    return settings->turntable ? 360.0 / settings->turntable : 0;
}

/* ---- framing */

iso_box isorender_bounds_of_all(isorender_job *job, const iso_vec3 vectors[3]) {
    iso_box box = isorender_bounds(job, vectors);
    for (int i = 0; i < job->object_count; i++) {
        const iso_box object = isorender_object_bounds_along(&job->objects[i], vectors);
        iso_bounds_add(&box, &object);
    }
    return box;
}

/* iso_fit.bounds */
static iso_box bounds_along(void *context, const iso_vec3 vectors[3]) {
    iso_box box = isorender_bounds_of_all(context, vectors);
    const iso_box slices = isorender_slice_bounds(context, vectors);
    iso_bounds_add(&box, &slices);
    return box;
}

iso_box isorender_bounds_shown(const isorender_job *job) {
    static const iso_vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    iso_box box = job->bounds_world;
    const iso_box slices = isorender_slice_bounds(job, axes);
    iso_bounds_add(&box, &slices);
    return box;
}

/* The box that a picture of points frames: around their middles, but around all of the discs of a few points,
 * which are large in it. */
static iso_box frame_of_cloud(const isorender_job *job) {
    enum { FEW_ACROSS = 20 };
    iso_box box = job->cloud.frame;
    const double radius = job->cloud.discs.radius, size = iso_vec3_length(iso_vec3_sub(box.hi, box.lo));
    const bool chosen = job->settings->radius > 0 && size > 0; /* the user knows how large they are */
    if (1.01 * FEW_ACROSS * radius < size || chosen) return box;
    const double reach = ISO_BOUNDS_DISC_REACH * radius;
    const iso_vec3 more = {reach, reach, reach};
    return (iso_box){iso_vec3_sub(box.lo, more), iso_vec3_add(box.hi, more)};
}

/* The box that the camera frames. */
static iso_box framed_box(const isorender_job *job) {
    if (job->settings->film->has_bounds) return job->settings->film->bounds;
    if (!job->loader.has_points) return isorender_bounds_shown(job);
    iso_box box = frame_of_cloud(job);
    if (isorender_has_instances(job, 0)) {
        const iso_box own = box, index = iso_point_view_bounds(&job->read_points);
        box = iso_placed_bounds(&job->instances.placements, &job->cloud.discs.transform, &index, &own, NULL);
    }
    for (int i = 1; i < job->surface_count; i++) iso_bounds_add(&box, &job->surfaces[i].bounds);
    for (int i = 0; i < job->object_count; i++) iso_bounds_add(&box, &job->objects[i].bounds);
    return box;
}

/* What fills the picture of a whole volume, or of anything else, when --fit does not say it: the surface as
 * it is seen, unless
 * - the camera's place is said, or is that of several inputs: a box leaves room around the first one;
 * - it is Gaussians, which extend beyond their middles;
 * - a few points lie so far from the others that these would become specks. */
static isorender_fit usual_fit(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    const bool shared = settings->first && !settings->panel,
               placed = is_given(settings->position) || is_given(settings->focal_point) || shared;
    return placed || job->gaussians || job->cloud.outside ? ISORENDER_FIT_BOX : ISORENDER_FIT_TIGHT;
}

/* What fills the picture. In chunks it is the box when --fit does not say it: to find how far the surface
 * extends as it is seen, all chunks would be read several times more. That is done for a volume that fits
 * into memory, so that pictures do not depend on how much memory happens to be free. */
static isorender_fit fit_of(const isorender_job *job) {
    if (job->settings->film->has_bounds) return ISORENDER_FIT_BOX; /* of several pictures */
    if (job->settings->fit != ISORENDER_FIT_UNCHOSEN) return (isorender_fit)job->settings->fit;
    return job->chunks && !job->chunks->fits ? ISORENDER_FIT_BOX : usual_fit(job);
}

const char *isorender_camera_record(const isorender_job *job) {
    const bool unchosen = job->settings->fit == ISORENDER_FIT_UNCHOSEN;
    return unchosen && fit_of(job) != usual_fit(job) ? " --fit=box" : "";
}

static void log_outside(const isorender_job *job) {
    if (job->cloud.outside)
        isorender_log(
            job, "note: %zu of %zu points lie far from the others, and are not framed (--fit tight does)",
            job->cloud.outside, job->cloud.discs.count);
}

static void note_patient(const isorender_job *job) {
    const bool named = job->settings->direction > (int)ISO_ISOMETRIC &&
                       job->settings->direction != ISORENDER_DIRECTION_UNCHOSEN;
    if (named && !(job->has_volume && job->loader.volume.info.anatomical))
        isorender_log(job, "note: the file does not say where a patient's front and head are: its axes are "
                           "taken as LPS");
}

static iso_vec3 middle_of(const iso_box *box) {
    return iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5);
}

static void frame_surface(isorender_job *job, isorender_fit fitting, iso_camera *camera) {
    const isorender_settings *settings = job->settings;
    const iso_fit fit = {.aspect = (double)settings->width / settings->height,
                         .turns = settings->turntable,
                         .fill = isnan(settings->margin) ? 0 : 1 - 2 * settings->margin,
                         .bounds = bounds_along,
                         .context = job};
    if (fitting == ISORENDER_FIT_TIGHT)
        iso_camera_fit_tight(camera, middle_of(&job->bounds_world), &fit);
    else
        iso_camera_fit_box(camera, &job->bounds_framed, &fit);
}

static int axis_of(iso_vec3 v) {
    return v.x != 0 ? 0 : v.y != 0 ? 1 : 2;
}

/* Whether the framed box is flat along an axis: at most `ratio` of its other two sides. */
static bool is_flat(const isorender_job *job, int axis, double ratio) {
    const iso_vec3 size = iso_vec3_sub(job->bounds_framed.hi, job->bounds_framed.lo);
    const double sides[3] = {size.x, size.y, size.z};
    return sides[axis] < ratio * fmin(sides[(axis + 1) % 3], sides[(axis + 2) % 3]);
}

/* Whether the framed box is a line along an axis: its other two sides are at most `ratio` of it. */
static bool is_line(const isorender_job *job, int axis, double ratio) {
    const iso_vec3 size = iso_vec3_sub(job->bounds_framed.hi, job->bounds_framed.lo);
    const double sides[3] = {size.x, size.y, size.z};
    return fmax(sides[(axis + 1) % 3], sides[(axis + 2) % 3]) < ratio * sides[axis];
}

/* The least part of its area that a flat thing shows to an eye that does not see it from the edge. */
static const double FACE_ON = 0.1;

/* The one of left and iso that looks more squarely at a plane with this normal. */
static iso_direction facing_direction(iso_vec3 normal, iso_vec3 world_up) {
    iso_vec3 left, isometric, up;
    iso_direction_vectors(ISO_LEFT, world_up, &left, &up);
    iso_direction_vectors(ISO_ISOMETRIC, world_up, &isometric, &up);
    return fabs(iso_vec3_dot(normal, isometric)) > fabs(iso_vec3_dot(normal, left)) ? ISO_ISOMETRIC
                                                                                    : ISO_LEFT;
}

/* The direction of a value of --camera: of iso_direction, or of the four names for patients behind them. */
static iso_direction named_direction(int value) {
    static const iso_direction of_patients[] = {ISO_FRONT, ISO_BACK, ISO_TOP, ISO_BOTTOM};
    return value > (int)ISO_ISOMETRIC ? of_patients[value - 1 - (int)ISO_ISOMETRIC] : (iso_direction)value;
}

/* The direction that --camera names. Without it flat things are not looked at from their edge: they lie, as
 * landscapes of points do already if their height is at most 0.3 of their sides, or stand, along an axis or
 * obliquely. Nor are straight lines looked at from their end, but from iso: their discs may face any way. */
static iso_direction direction_of(const isorender_job *job) {
    static const double LANDSCAPE = 0.3, EDGE_ON = 0.02;
    const isorender_settings *settings = job->settings;
    if (settings->direction != ISORENDER_DIRECTION_UNCHOSEN) return named_direction(settings->direction);
    if (settings->azimuth != 0 || settings->elevation != 0 || job->has_volume) return ISO_FRONT;
    iso_vec3 forward, up, across;
    iso_direction_vectors(ISO_FRONT, settings->up, &forward, &up);
    if (is_flat(job, axis_of(up), job->loader.has_points ? LANDSCAPE : EDGE_ON)) return ISO_ISOMETRIC;
    if (is_flat(job, 3 - axis_of(up) - axis_of(forward), EDGE_ON)) return ISO_LEFT;
    if (is_line(job, axis_of(forward), EDGE_ON)) return ISO_ISOMETRIC;
    const bool edge_on =
        isorender_is_flat(job, EDGE_ON, &across) && fabs(iso_vec3_dot(across, forward)) < FACE_ON;
    return edge_on ? facing_direction(across, settings->up) : ISO_FRONT;
}

/* A patient is seen from the top with the front at the picture's top, as from the bottom; other volumes as
 * the maps that they may be, with +y at the top. */
static bool is_from_top_of_patient(const isorender_job *job) {
    return job->has_volume && job->loader.volume.info.anatomical && direction_of(job) == ISO_TOP &&
           job->settings->up.z > 0;
}

/* The camera without --camera-position: the preset, turned, at the distance that shows everything. */
static iso_camera fitted_camera(isorender_job *job, isorender_fit fitting) {
    const isorender_settings *settings = job->settings;
    iso_camera camera = {
        .view_angle = settings->view_angle, .orthographic = settings->orthographic != 0, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors(direction_of(job), settings->up, &forward, &camera.view_up);
    if (is_from_top_of_patient(job)) camera.view_up = iso_vec3_make(0, -1, 0); /* anterior */
    if (is_given(settings->view_up)) camera.view_up = vector(settings->view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_orbit(&camera, settings->azimuth, settings->elevation);
    frame_surface(job, fitting, &camera);
    if (is_given(settings->focal_point)) {
        iso_vec3 shift = iso_vec3_sub(vector(settings->focal_point), camera.focal_point);
        camera.focal_point = vector(settings->focal_point);
        camera.position = iso_vec3_add(camera.position, shift);
    }
    return camera;
}

/* A position that is given is where the eye is; azimuth and elevation turn it from there. Else the direction
 * that is given as up stays as it is, so that scenes have all bits of a camera. */
static void place_camera(const isorender_job *job, iso_camera *camera) {
    const isorender_settings *settings = job->settings;
    camera->position = vector(settings->position);
    if (settings->azimuth != 0 || settings->elevation != 0)
        iso_camera_orbit(camera, settings->azimuth, settings->elevation);
    else if (is_given(settings->view_up))
        camera->view_up = vector(settings->view_up);
}

/* The camera of the settings, at a distance that shows job->bounds_framed or, if the fit is tight, the
 * surface. */
static iso_camera make_camera(isorender_job *job, isorender_fit fitting) {
    const isorender_settings *settings = job->settings;
    iso_camera camera = fitted_camera(job, fitting);
    if (is_given(settings->position)) place_camera(job, &camera);
    if (settings->zoom != 1) iso_camera_zoom(&camera, settings->zoom);
    if (settings->mm_per_pixel > 0) camera.parallel_scale = settings->mm_per_pixel * settings->height / 2;
    return camera;
}

iso_camera isorender_camera_of_box(isorender_job *job, const iso_box *box) {
    job->bounds_framed = *box;
    return make_camera(job, ISORENDER_FIT_BOX);
}

iso_status isorender_camera_make(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    isorender_same_view *first = settings->first;
    job->bounds_framed = framed_box(job);
    const isorender_panel *panel = settings->panel && !settings->panel->is_survey ? settings->panel : NULL;
    if (panel ? panel->has_camera : first && first->has_camera) {
        job->camera = panel ? panel->camera : first->camera;
        job->shares_view = !panel;
        return ISO_OK;
    }
    if (panel) {
        job->camera = isorender_camera_of_box(job, &panel->box);
        return iso_camera_check(&job->camera, error);
    }
    const isorender_fit fitting = fit_of(job);
    note_patient(job);
    if (!is_given(settings->position) && fitting == ISORENDER_FIT_BOX) log_outside(job);
    const iso_camera camera = make_camera(job, fitting);
    ISO_TRY(iso_camera_check(&camera, error));
    job->camera = camera;
    if (first && !settings->panel)
        *first = (isorender_same_view){first->has_isovalue, true, first->isovalue, camera};
    return ISO_OK;
}

iso_camera isorender_camera_of_frame(const isorender_job *job, int frame) {
    iso_camera camera = job->camera;
    const int turns = job->settings->keyframes ? 0 : job->settings->film->first + frame;
    if (turns) iso_camera_orbit(&camera, turns * degrees_between_frames(job->settings), 0);
    return camera;
}
