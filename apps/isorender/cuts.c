/* cuts: --clip, from its words to the clips of surfaces. */
#include "apps/isorender/cuts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/isorender.h"
#include "base/parse.h"
#include "scene/bounds.h"

iso_status isorender_apply_clip(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (settings->cut_count == ISO_CLIP_BODIES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d cuts", ISO_CLIP_BODIES);
    ISO_TRY(iso_cut_parse(value, &settings->cuts[settings->cut_count], error));
    settings->cut_texts[settings->cut_count++] = value;
    return ISO_OK;
}

iso_status isorender_apply_cap(void *target, const char *value, iso_error *error) {
    return iso_cap_style_parse(value, &((isorender_settings *)target)->cap, error);
}

iso_status isorender_apply_slice(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (settings->slice_count == ISO_SLICES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d slices", ISO_SLICES);
    settings->slice_texts[settings->slice_count] = value;
    return iso_cut_parse_plane(value, &settings->slices[settings->slice_count++], error);
}

iso_status isorender_apply_window(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->window_auto = strcmp(value, "auto") == 0;
    settings->window[0] = settings->window[1] = NAN;
    if (settings->window_auto || iso_parse_reals(value, 2, settings->window)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not CENTER,WIDTH or auto", value);
}

bool isorender_has_caps(const isorender_settings *settings) {
    return settings->cap.kind != ISO_CAP_NONE || settings->slice_count;
}

bool isorender_shows_slices(const isorender_settings *settings) {
    return settings->cap.kind == ISO_CAP_SLICE || settings->slice_count;
}

/* Options of caps and slices without what they are for. */
static iso_status check_caps(const isorender_settings *settings, iso_error *error) {
    const bool shows = isorender_shows_slices(settings);
    if (settings->cap.kind != ISO_CAP_NONE && !settings->cut_count)
        return iso_fail(error, ISO_ERR_USAGE, "--cap closes what --clip cuts: it needs --clip");
    if ((!isnan(settings->window[0]) || settings->window_auto) && !shows)
        return iso_fail(error, ISO_ERR_USAGE, "--window is for --slice and --cap slice");
    if (!isnan(settings->window[0]) && !(settings->window[1] > 0))
        return iso_fail(error, ISO_ERR_USAGE, "--window: the width, %g, is not above 0", settings->window[1]);
    const bool labels = settings->labels || settings->smooth; /* which have caps of their own */
    const char *unfit = settings->no_input && shows && labels ? "labels alone"
                        : settings->no_input && !labels       ? "no input"
                        : settings->object_options.has_cloud  ? "points"
                        : settings->ior > 0                   ? "--ior"
                                                              : NULL;
    if (unfit && isorender_has_caps(settings))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s cannot be combined with %s: it shows the values of a volume",
                        settings->slice_count ? "--slice" : "--cap", unfit);
    return ISO_OK;
}

iso_status isorender_cuts_check(const isorender_settings *settings, iso_error *error) {
    ISO_TRY(check_caps(settings, error));
    if (!settings->cut_count) return ISO_OK;
    const bool cloud = settings->object_options.has_cloud; /* isorender_cuts_check_points */
    const bool layers = isorender_is_translucent(settings);
    if (!cloud)
        ISO_TRY(isorender_method_require(settings, layers ? ISO_CAN_CLIP_LAYERS : ISO_CAN_CLIP,
                                         layers ? "cuts (--clip) of what is translucent" : "cuts (--clip)",
                                         error));
    const char *unfit = settings->ior > 0                 ? "--ior"
                        : settings->absorption_length > 0 ? "--absorption"
                        : settings->instances             ? "--instances"
                                                          : NULL;
    if (unfit) return iso_fail(error, ISO_ERR_USAGE, "--clip cannot be combined with %s", unfit);
    return ISO_OK;
}

iso_status isorender_cuts_check_points(const isorender_job *job, iso_error *error) {
    if (!job->settings->cut_count || !job->loader.has_points) return ISO_OK;
    const char *unfit = job->gaussians                            ? NULL
                        : !(job->renderer->can & ISO_CAN_CLIP)    ? job->renderer->title
                        : isorender_is_translucent(job->settings) ? "translucent discs"
                                                                  : NULL;
    if (!unfit) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "--clip cuts no %s: opaque points by --method %s, Gaussians and --glyphs of the file are "
                    "cut",
                    unfit, iso_methods_that_can(ISO_CAN_CLOUDS | ISO_CAN_CLIP, (char[ISO_METHODS_TEXT]){0}));
}

/* The number of things that cuts can name. */
static int thing_count(const isorender_job *job) {
    return job->surface_count + job->object_count;
}

static iso_status check_names(const isorender_job *job, iso_error *error) {
    const int things = thing_count(job);
    for (int i = 0; i < job->settings->cut_count; i++)
        for (int number = things; number < ISO_CUT_THINGS && job->settings->cuts[i].things.named; number++)
            if (iso_cut_is_for(&job->settings->cuts[i], number))
                return iso_fail(error, ISO_ERR_USAGE,
                                "--clip %s: there is no @%d: the picture has %d thing%s",
                                job->settings->cut_texts[i], number + 1, things, things == 1 ? "" : "s");
    return ISO_OK;
}

static iso_vec3 row(const double *m) {
    return iso_vec3_make(m[0], m[1], m[2]);
}

/* A corner of the volume: of its first or last voxels along each axis, by the bits of `which`. */
static iso_vec3 volume_corner(const isorender_job *job, int which) {
    const iso_volume_info *info = &job->loader.volume.info;
    const iso_affine affine = iso_transform_affine(&info->transform);
    return iso_affine_point(&affine, iso_vec3_make((which & 1) * (info->dims[0] - 1),
                                                   (which >> 1 & 1) * (info->dims[1] - 1),
                                                   (which >> 2 & 1) * (info->dims[2] - 1)));
}

iso_cut isorender_cut_placed(const isorender_job *job, const iso_cut *cut) {
    iso_cut placed = *cut;
    const iso_volume_info *info = &job->loader.volume.info;
    const iso_box *all = &job->bounds_world;
    iso_cut_set_middle(&placed, job->has_volume ? iso_cut_middle(&info->transform, info->dims)
                                                : iso_vec3_scale(iso_vec3_add(all->lo, all->hi), 0.5));
    return placed;
}

/* Adds where a plane meets the edges of the volume. */
static void add_slice(const isorender_job *job, const double plane[4], const iso_vec3 vectors[3],
                      iso_box *box) {
    for (int corner = 0; corner < 8; corner++)
        for (int axis = 0; axis < 3; axis++) {
            if (corner >> axis & 1) continue;
            const iso_vec3 a = volume_corner(job, corner), b = volume_corner(job, corner | 1 << axis);
            const double of_a = iso_vec3_dot(row(plane), a) - plane[3],
                         of_b = iso_vec3_dot(row(plane), b) - plane[3];
            if (of_a * of_b > 0 || of_a == of_b) continue;
            const iso_vec3 at = iso_vec3_add(a, iso_vec3_scale(iso_vec3_sub(b, a), of_a / (of_a - of_b)));
            const iso_vec3 along = iso_vec3_make(iso_vec3_dot(vectors[0], at), iso_vec3_dot(vectors[1], at),
                                                 iso_vec3_dot(vectors[2], at));
            iso_bounds_add(box, &(iso_box){along, along});
        }
}

iso_box isorender_slice_bounds(const isorender_job *job, const iso_vec3 vectors[3]) {
    iso_box box = iso_box_empty();
    for (int i = 0; job->has_volume && i < job->settings->slice_count; i++) {
        const iso_cut cut = isorender_cut_placed(job, &job->settings->slices[i]);
        if (!cut.by_depth) add_slice(job, cut.body.face[0], vectors, &box);
    }
    return box;
}

void isorender_cuts_note(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    bool open = false;
    for (int i = 0; i < settings->cut_count + settings->slice_count; i++) {
        const bool slice = i >= settings->cut_count;
        const iso_cut *cut = slice ? &settings->slices[i - settings->cut_count] : &settings->cuts[i];
        open |= !cut->by_depth && !cut->by_middle && !cut->space_stated &&
                (cut->body.faces != 1 || cut->body.face[0][0] != 0 || cut->body.face[0][1] != 0);
    }
    if (open && job->has_volume && strcmp(job->loader.volume.info.format, "nifti") == 0)
        isorender_log(
            job,
            "note: %s takes LPS, in which x and y have the opposite signs of the file's RAS (%s ras:.. "
            "takes these, lps:.. states the others)",
            settings->cut_count ? "--clip" : "--slice", settings->cut_count ? "--clip" : "--slice");
}

/* How near the scene comes to a camera: the least dot product of its points with the direction of view. */
static double front_of(isorender_job *job, const iso_camera *camera) {
    const iso_view view = iso_view_make(camera, job->settings->width, job->settings->height);
    const iso_vec3 vectors[3] = {row(view.rotation), row(view.rotation + 3), row(view.rotation + 6)};
    const iso_box box = isorender_bounds_of_all(job, vectors);
    return box.lo.z;
}

/* The bin in which the voxel after this share of them lies. */
static int find_bin(const iso_histogram *histogram, double share) {
    uint64_t below = 0;
    int bin = 0;
    while (bin < ISO_HISTOGRAM_BINS - 1 &&
           (double)(below += histogram->bins[bin]) <= share * (double)histogram->counted)
        bin++;
    return bin;
}

/* Sets which values slices show: all, if --window does not say it. */
static iso_status choose_window(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const double centre = settings->window[0], width = settings->window[1];
    iso_slice_look *look = &job->slice_look;
    *look = (iso_slice_look){centre - width / 2, centre + width / 2, settings->cap.map};
    if (!isnan(centre) || !job->has_volume) return ISO_OK;
    ISO_TRY(iso_loader_histogram(&job->loader, error));
    const iso_histogram *histogram = &job->loader.histogram;
    look->low = histogram->minimum;
    look->high = histogram->maximum;
    if (!settings->window_auto) return ISO_OK;
    look->low = histogram->low + histogram->width * find_bin(histogram, 0.01);
    look->high = histogram->low + histogram->width * (find_bin(histogram, 0.99) + 1);
    return ISO_OK;
}

static iso_status make_slices(isorender_job *job, const iso_camera *camera, double front, iso_error *error) {
    const isorender_settings *settings = job->settings;
    if (!isorender_has_caps(settings)) return ISO_OK;
    for (int i = 0; i < settings->slice_count; i++) {
        const iso_cut cut = isorender_cut_placed(job, &settings->slices[i]);
        const iso_clip_body body = iso_cut_solve(&cut, camera, front);
        memcpy(job->slices[i].plane, body.face[0], sizeof job->slices[i].plane);
    }
    return choose_window(job, error);
}

iso_cut_caps isorender_caps(const isorender_job *job, iso_capped solids[ISORENDER_SURFACES]) {
    const isorender_settings *settings = job->settings;
    for (int i = 0; i < job->surface_count; i++) {
        const isorender_surface *surface = &job->surfaces[i];
        solids[i] = (iso_capped){
            &surface->scene.grid, surface->scene.isovalue,
            (uint8_t)i,           settings->cap.kind == ISO_CAP_COLOR ? settings->cap.color : surface->color,
            surface->scene.clip,  surface->label_group != 0};
    }
    return (iso_cut_caps){.solids = solids,
                          .count = job->surface_count,
                          .caps = settings->cap.kind != ISO_CAP_NONE,
                          .shows = settings->cap.kind == ISO_CAP_SLICE,
                          .slices = job->slices,
                          .slice_count = settings->slice_count,
                          .look = job->slice_look,
                          .factor = iso_picture_factor(job->samples)};
}

iso_status isorender_cuts_make(isorender_job *job, int frame, iso_error *error) {
    if (!job->settings->cut_count && !isorender_has_caps(job->settings)) return ISO_OK;
    ISO_TRY(check_names(job, error));
    const size_t things = (size_t)thing_count(job);
    if (!job->clips) job->clips = calloc(things, sizeof *job->clips);
    if (!job->clips) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const iso_camera camera = isorender_camera_of_frame(job, frame);
    const double front = front_of(job, &camera);
    iso_cut cuts[ISO_CLIP_BODIES];
    for (int i = 0; i < job->settings->cut_count; i++)
        cuts[i] = isorender_cut_placed(job, &job->settings->cuts[i]);
    for (int i = 0; i < (int)things; i++)
        job->clips[i] = iso_cuts_clip(cuts, job->settings->cut_count, i, &camera, front);
    for (int i = 0; i < job->surface_count; i++) job->surfaces[i].scene.clip = &job->clips[i];
    for (int i = 0; i < job->object_count; i++)
        job->objects[i].scene.clip = &job->clips[job->surface_count + i];
    return make_slices(job, &camera, front, error);
}

/* ---- what is said of cuts that show little */

/* The corners of a box, by the bits of `which`. */
static iso_vec3 corner_of(const iso_box *box, int which) {
    return iso_vec3_make(which & 1 ? box->hi.x : box->lo.x, which & 2 ? box->hi.y : box->lo.y,
                         which & 4 ? box->hi.z : box->lo.z);
}

/* How far a point lies in front of a plane, mm. */
static double in_front(const double face[4], iso_vec3 p) {
    return iso_vec3_dot(row(face), p) - face[3];
}

/* Whether a body surely has nothing of a box or, if it keeps what it has, all of it. */
static bool removes_nothing(const iso_clip_body *body, const iso_box *box) {
    bool holds = true, misses = false;
    for (int k = 0; k < body->faces; k++) {
        bool all_behind = true, all_in_front = true;
        for (int i = 0; i < 8; i++) {
            const bool front = in_front(body->face[k], corner_of(box, i)) >= 0;
            all_behind &= !front;
            all_in_front &= front;
        }
        holds &= all_behind;
        misses |= all_in_front;
    }
    if (!body->faces) {
        const iso_vec3 c = body->centre, nearest = {iso_min(iso_max(c.x, box->lo.x), box->hi.x),
                                                    iso_min(iso_max(c.y, box->lo.y), box->hi.y),
                                                    iso_min(iso_max(c.z, box->lo.z), box->hi.z)};
        misses = iso_vec3_length(iso_vec3_sub(nearest, c)) >= body->radius;
        for (int i = 0; i < 8; i++)
            holds &= iso_vec3_length(iso_vec3_sub(corner_of(box, i), c)) < body->radius;
    }
    return body->keeps ? holds : misses;
}

/* The direction of --camera that looks at a plane from the side that a normal points to; NULL: at a slant. */
static const char *direction_to(iso_vec3 normal) {
    static const double near = 0.999; /* 2.5 degrees */
    return normal.x < -near   ? "right"
           : normal.x > near  ? "left"
           : normal.y < -near ? "front"
           : normal.y > near  ? "back"
           : normal.z < -near ? "bottom"
           : normal.z > near  ? "top"
                              : NULL;
}

static void log_turn(const isorender_job *job, const char *option, const char *text, const char *seen,
                     iso_vec3 normal) {
    const char *direction = direction_to(normal);
    if (direction)
        isorender_log(job, "note: %s %s is seen %s: --camera %s looks at it", option, text, seen, direction);
    else
        isorender_log(job, "note: %s %s is seen %s: --azimuth and --elevation turn the view", option, text,
                      seen);
}

/* The sine of the angle at which a camera sees the front of a plane; below 0: its back. */
static double find_slant(const iso_camera *camera, const double plane[4]) {
    const iso_vec3 view = iso_vec3_sub(camera->focal_point, camera->position);
    return camera->orthographic ? -iso_vec3_dot(row(plane), iso_vec3_unit(view))
                                : in_front(plane, camera->position) / iso_vec3_length(view);
}

/* Of the two sides of a slice the one that it is mostly looked at from: right, front or top. */
static iso_vec3 usual_side(iso_vec3 normal) {
    const bool lies = fabs(normal.z) > 0.5;
    return iso_vec3_scale(normal, (lies ? normal.z : -normal.x - normal.y) < 0 ? -1 : 1);
}

static void note_slices(const isorender_job *job, const iso_camera *camera) {
    static const double edge_on = 0.02;
    const isorender_settings *settings = job->settings;
    for (int i = 0; i < settings->slice_count; i++) {
        const double *plane = job->slices[i].plane;
        bool before = false, behind = false;
        for (int k = 0; k < 8; k++) {
            const double d = in_front(plane, volume_corner(job, k));
            before |= d >= 0;
            behind |= d <= 0;
        }
        if (before != behind)
            isorender_log(job, "note: --slice %s does not meet the volume: nothing of it is seen",
                          settings->slice_texts[i]);
        else if (fabs(find_slant(camera, plane)) < edge_on)
            log_turn(job, "--slice", settings->slice_texts[i], "edge-on", usual_side(row(plane)));
    }
}

/* Says which cuts change nothing, and whether what they open is hidden behind what is left. */
static void note_clips(const isorender_job *job, const iso_clip *all, const iso_camera *camera) {
    const isorender_settings *settings = job->settings;
    bool hidden = !job->translucent && all->count > 0;
    for (int i = 0; i < all->count; i++) {
        const iso_clip_body *body = &all->body[i];
        const bool nothing = removes_nothing(body, &job->bounds_world);
        if (nothing)
            isorender_log(job,
                          "note: --clip %s removes nothing: the picture reaches from %g,%g,%g to %g,%g,%g mm",
                          settings->cut_texts[i], job->bounds_world.lo.x, job->bounds_world.lo.y,
                          job->bounds_world.lo.z, job->bounds_world.hi.x, job->bounds_world.hi.y,
                          job->bounds_world.hi.z);
        const double slant = body->faces == 1 ? find_slant(camera, body->face[0]) : 0;
        hidden &= !nothing && body->faces == 1 && (body->keeps ? -slant : slant) > 0;
    }
    if (!hidden) return;
    const iso_clip_body *first = &all->body[0];
    log_turn(job, "--clip", settings->cut_texts[0], "from behind",
             iso_vec3_scale(row(first->face[0]), first->keeps ? 1 : -1));
}

void isorender_cuts_note_seen(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    const iso_camera camera = isorender_camera_of_frame(job, 0);
    if (!isorender_plan_draws(job->plan) || job->frame_count > 1 || settings->film->first) return;
    iso_cut cuts[ISO_CLIP_BODIES];
    bool for_all = true;
    for (int i = 0; i < settings->cut_count; i++) {
        cuts[i] = isorender_cut_placed(job, &settings->cuts[i]);
        for_all &= !cuts[i].things.named && !cuts[i].by_depth;
    }
    const iso_clip clip = iso_cuts_clip(cuts, settings->cut_count, 0, &camera, 0);
    if (for_all) note_clips(job, &clip, &camera);
    note_slices(job, &camera);
    if (settings->cap.is_gray && job->has_volume)
        isorender_log(job, "note: --cap gray is one colour: --cap slice shows the volume in grays");
    if (settings->cap.kind == ISO_CAP_SURFACE && settings->coloring_count)
        isorender_log(job,
                      "note: --cap surface has the surface's plain colour: --surface-color-by is for what is "
                      "left of the surface, and --cap slice:COLORMAP shows the volume");
    if (isorender_shows_slices(settings) && isnan(settings->window[0]))
        isorender_log(
            job, "note: slices show the values from %g to %g%s", job->slice_look.low, job->slice_look.high,
            settings->window_auto ? "" : ", which are all: --window CENTER,WIDTH or auto shows fewer");
}

/* The direction of a plane's normal, of two the one whose greatest component is positive: for messages. */
static iso_vec3 positive(const double face[4]) {
    const double *n = face;
    const int axis = fabs(n[0]) >= fabs(n[1]) && fabs(n[0]) >= fabs(n[2]) ? 0
                     : fabs(n[1]) >= fabs(n[2])                           ? 1
                                                                          : 2;
    const double sign = n[axis] < 0 ? -1 : 1;
    return iso_vec3_make(sign * n[0] + 0.0, sign * n[1] + 0.0, sign * n[2] + 0.0);
}

/* Fails if the half-space of a cut leaves nothing. */
static iso_status fail_plane(isorender_job *job, int number, const iso_clip_body *body, iso_error *error) {
    const double *face = body->face[0];
    const iso_vec3 normal = positive(face), vectors[3] = {normal, normal, normal};
    const iso_box reach = isorender_bounds_of_all(job, vectors);
    const double at = iso_vec3_dot(normal, row(face)) * face[3] + 0.0, ends[2] = {reach.lo.x, reach.hi.x};
    const bool above = iso_vec3_dot(normal, row(face)) < 0; /* the body lies above the plane */
    const bool cuts_above = above != body->keeps;
    if (cuts_above ? ends[0] < at : ends[1] > at) return ISO_OK; /* something is left */
    return iso_fail(
        error, ISO_ERR_EMPTY,
        "--clip %s leaves nothing: along %.4g,%.4g,%.4g the plane is at %g mm, and the surface reaches "
        "from %g to %g mm",
        job->settings->cut_texts[number], normal.x, normal.y, normal.z, at, ends[0], ends[1]);
}

iso_status isorender_cuts_fail_empty(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    if (!settings->cut_count) return ISO_OK;
    const iso_camera camera = isorender_camera_of_frame(job, job->frame);
    const double front = front_of(job, &camera);
    for (int i = 0; i < settings->cut_count; i++) {
        const iso_cut cut = isorender_cut_placed(job, &settings->cuts[i]);
        const iso_clip_body body = iso_cut_solve(&cut, &camera, front);
        if (cut.plane || cut.by_depth) ISO_TRY(fail_plane(job, i, &body, error));
    }
    const iso_box *all = &job->bounds_world;
    return iso_fail(
        error, ISO_ERR_EMPTY,
        "nothing of what --clip leaves is in view: the surface reaches from %g,%g,%g to %g,%g,%g mm",
        all->lo.x, all->lo.y, all->lo.z, all->hi.x, all->hi.y, all->hi.z);
}

bool isorender_slice_bar(const isorender_job *job, iso_color_bar *bar) {
    if (!isorender_shows_slices(job->settings)) return false;
    const iso_slice_look *look = &job->slice_look;
    *bar = (iso_color_bar){.map = look->map, .low = look->low, .high = look->high};
    snprintf(bar->title, sizeof bar->title, "%.*s", (int)sizeof bar->title - 1, job->loader.volume.info.name);
    return true;
}
