/* Values of options that change in time. */
#include "apps/isorender/keyframes.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/resolution_level.h"
#include "base/file.h"
#include "scene/bounds.h"

/* What can change. Text: everything of it is replaced; the numbers of cuts are interpolated if both keyframes
 * have cuts of one kind. */
typedef enum track {
    AZIMUTH,
    ELEVATION,
    ZOOM,
    MM_PER_PIXEL,
    VIEW_ANGLE,
    WINDOW,
    ABSORPTION,
    ISOVALUE,
    OPACITY,
    CLIP,
    SLICE,
    PRESET,
    POSITION,
    FOCAL_POINT,
    VIEW_UP,
    TRACKS
} track;
#define AT(member) offsetof(isorender_settings, member)
static const struct {
    const char *option;
    size_t offset, count; /* where the numbers of a track are; 0: it has none of a fixed place */
    bool geometric;       /* they are factors: in the middle of 1 and 4 is 2 */
} tracks[TRACKS] = {[AZIMUTH] = {"azimuth", AT(azimuth), 1, false},
                    [ELEVATION] = {"elevation", AT(elevation), 1, false},
                    [ZOOM] = {"zoom", AT(zoom), 1, true},
                    [MM_PER_PIXEL] = {"mm-per-pixel", AT(mm_per_pixel), 1, true},
                    [VIEW_ANGLE] = {"view-angle", AT(view_angle), 1, false},
                    [WINDOW] = {"window", AT(window), 2, false},
                    [ABSORPTION] = {"absorption", AT(absorption_length), 1, true},
                    [ISOVALUE] = {"isovalue", AT(isovalues), ISORENDER_SURFACES, false},
                    [OPACITY] = {"opacity", AT(opacities), ISORENDER_SURFACES, false},
                    [CLIP] = {"clip", 0, 0, false},
                    [SLICE] = {"slice", 0, 0, false},
                    [PRESET] = {"camera", 0, 0, false},
                    [POSITION] = {"camera-position", 0, 0, false},
                    [FOCAL_POINT] = {"camera-focal-point", 0, 0, false},
                    [VIEW_UP] = {"camera-view-up", 0, 0, false}};
#undef AT
enum {
    PLACES = 1u << PRESET | 1u << POSITION | 1u << FOCAL_POINT | 1u << VIEW_UP
}; /* interpolated together */
enum { MOST_FRAMES = 1000000, MOST_KEYFRAMES = 10000 };

typedef struct keyframe {
    int frame;
    unsigned named; /* the tracks that it has values of, as bits */
    isorender_settings *settings;
} keyframe;

struct isorender_keyframes {
    json_t *file; /* whose texts the settings borrow */
    keyframe *items;
    int count;
    bool smooth;
    unsigned named; /* by any of them */
    isorender_settings now;
};

/* ---- reading */

static int track_of(const iso_option *option) {
    for (int i = 0; i < TRACKS; i++)
        if (option && strcmp(tracks[i].option, option->name) == 0) return i;
    return -1;
}

/* A list that an option collects begins anew in a keyframe. */
static void clear(isorender_settings *settings, track which) {
    if (which == ISOVALUE) settings->isovalue_count = 0;
    if (which == OPACITY) settings->opacity_count = 0;
    if (which == CLIP) settings->cut_count = 0;
    if (which == SLICE) settings->slice_count = 0;
}

static iso_status fail_at(const isorender_settings *settings, int frame, const char *name, const char *reason,
                          iso_error *error) {
    return iso_fail(error, ISO_ERR_USAGE, "%s: frame %d: %s: %s", settings->keyframe_file, frame, name,
                    reason);
}

/* The text of a value: a number's is made, and kept with the file. */
static const char *text_of(json_t *parent, const char *name, json_t *value) {
    if (!json_is_number(value)) return json_string_value(value);
    char *number = json_dumps(value, JSON_ENCODE_ANY);
    const bool kept = number && json_object_set_new(parent, name, json_string(number)) == 0;
    free(number);
    return kept ? json_string_value(json_object_get(parent, name)) : NULL;
}

static iso_status store(keyframe *key, const isorender_settings *base, json_t *parent, const char *name,
                        json_t *value, iso_error *error) {
    const iso_option *option = iso_options_find(isorender_program(), name, strlen(name));
    const int which = track_of(option);
    iso_error reason = {0};
    char known[256] = "";
    for (int i = 0; i < TRACKS && which < 0; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "",
                 tracks[i].option);
    if (which < 0) {
        char text[320];
        snprintf(text, sizeof text, "it does not change in time; these do: %s", known);
        return fail_at(base, key->frame, name, text, error);
    }
    const char *text = text_of(parent, name, value);
    if (!text) return fail_at(base, key->frame, name, "the value is no text or number", error);
    if (!(key->named & 1u << which)) clear(key->settings, (track)which);
    key->named |= 1u << which;
    if (iso_option_store(option, text, key->settings, &reason) != ISO_OK)
        return fail_at(base, key->frame, name, reason.text, error);
    return ISO_OK;
}

/* Numbers of lists are as many as there are surfaces. */
static iso_status complete(keyframe *key, isorender_settings *base, iso_error *error) {
    isorender_settings *s = key->settings;
    const int surfaces = base->isovalue_count ? base->isovalue_count : 1;
    if (key->named & 1u << ISOVALUE) {
        if (s->isovalue_auto || base->isovalue_auto || base->volume_count || base->no_input)
            return fail_at(base, key->frame, "isovalue",
                           "only numbers, of the input's surfaces, change in time", error);
        for (int i = 0; i < s->isovalue_count; i++)
            if (isnan(s->isovalues[i]) || s->isovalue_sigmas[i] ||
                (base->isovalue_count && base->isovalue_sigmas[i]))
                return fail_at(base, key->frame, "isovalue", "auto and sigmas are no numbers that change",
                               error);
        if (!base->isovalue_count) /* that of the first picture */
            memcpy(base->isovalues, s->isovalues, sizeof s->isovalues),
                base->isovalue_count = s->isovalue_count;
        if (s->isovalue_count != base->isovalue_count)
            return fail_at(base, key->frame, "isovalue", "there are as many as surfaces in every picture",
                           error);
        if (base->closed || iso_input_drops_parts(&base->common.input))
            return fail_at(base, key->frame, "isovalue",
                           "--closed, --largest and --min-size are of a surface that stays", error);
    }
    if (key->named & 1u << OPACITY && (base->no_input || base->volume_count))
        return fail_at(base, key->frame, "opacity", "only those of an input's surfaces change in time",
                       error);
    if (key->named & 1u << OPACITY && s->opacity_count > surfaces)
        return fail_at(base, key->frame, "opacity", "there are more than surfaces", error);
    if (key->named & 1u << MM_PER_PIXEL && !(base->mm_per_pixel > 0))
        return fail_at(base, key->frame, "mm-per-pixel", "the command line gives that of the first picture",
                       error);
    if (key->named & 1u << ABSORPTION && !(base->absorption_length > 0))
        return fail_at(base, key->frame, "absorption", "the command line gives that of the first picture",
                       error);
    return ISO_OK;
}

/* An opacity for each surface: the last one given repeats, and without any it is 1. */
static void fill_opacities(isorender_settings *s) {
    const int given = s->opacity_count, surfaces = s->isovalue_count ? s->isovalue_count : 1;
    for (int i = given; i < surfaces; i++) s->opacities[i] = given ? s->opacities[given - 1] : 1;
    s->opacity_count = surfaces;
}

static iso_status read_keyframe(isorender_settings *base, json_t *json, keyframe *key, int after,
                                iso_error *error) {
    json_t *frame = json_object_get(json, "frame"), *options = json_object_get(json, "options"), *option,
           *value;
    const char *name;
    size_t i;
    void *next;
    if (!json_is_integer(frame) || json_integer_value(frame) <= after ||
        json_integer_value(frame) >= MOST_FRAMES)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: a keyframe has a \"frame\": a number from 0, above that of the keyframe before",
                        base->keyframe_file);
    if (options && !json_is_array(options))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: the \"options\" of a keyframe are an array, as in a scene", base->keyframe_file);
    key->frame = (int)json_integer_value(frame);
    key->settings = malloc(sizeof *key->settings);
    if (!key->settings) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    *key->settings = *base;
    json_array_foreach(options, i, option) {
        json_object_foreach_safe(option, next, name, value)
            ISO_TRY(store(key, base, option, name, value, error));
    }
    return complete(key, base, error);
}

static iso_status read_items(isorender_settings *settings, struct isorender_keyframes *all,
                             iso_error *error) {
    json_t *items = json_object_get(all->file, "keyframes"),
           *smooth = json_object_get(all->file, "interpolation");
    const char *how = json_string_value(smooth);
    const size_t count = json_array_size(items);
    if (count < 2 || count > MOST_KEYFRAMES)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: it has an array \"keyframes\" of 2 to %d objects",
                        settings->keyframe_file, MOST_KEYFRAMES);
    if (smooth && (!how || (strcmp(how, "linear") != 0 && strcmp(how, "smooth") != 0)))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: \"interpolation\" is \"linear\" or \"smooth\"",
                        settings->keyframe_file);
    all->smooth = how && *how == 's';
    all->items = calloc(count, sizeof *all->items);
    if (!all->items) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < count; i++) {
        const int after = i ? all->items[i - 1].frame : -1;
        ISO_TRY(read_keyframe(settings, json_array_get(items, i), &all->items[all->count++], after, error));
        all->named |= all->items[i].named;
    }
    for (int i = 0; i < all->count && all->named & 1u << OPACITY; i++) {
        all->items[i].settings->isovalue_count = settings->isovalue_count;
        fill_opacities(all->items[i].settings);
    }
    if (all->named & 1u << OPACITY) fill_opacities(settings);
    return ISO_OK;
}

iso_status isorender_keyframes_read(isorender_settings *settings, iso_error *error) {
    json_error_t reason;
    FILE *stream;
    if (!settings->keyframe_file) return ISO_OK;
    struct isorender_keyframes *all = settings->keyframes = calloc(1, sizeof *all);
    if (!all) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    ISO_TRY(iso_file_open(settings->keyframe_file, &stream, NULL, error));
    all->file = json_loadf(stream, JSON_REJECT_DUPLICATES, &reason);
    fclose(stream);
    if (!all->file)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: line %d: %s", settings->keyframe_file, reason.line,
                        reason.text);
    ISO_TRY(read_items(settings, all, error));
    if (settings->pictures > 0 && settings->turntable)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--keyframes says how many pictures there are: a turn is an azimuth from 0 to 360, not "
            "--turntable");
    if (settings->aov && all->named & 1u << OPACITY)
        return iso_fail(error, ISO_ERR_USAGE, "--aov has no opacities that change (--keyframes)");
    if (settings->fit == ISORENDER_FIT_TIGHT)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--keyframes frame a box that all pictures share, not --fit tight");
    if (!settings->series_of) settings->pictures = isorender_keyframes_pictures(all);
    return ISO_OK;
}

void isorender_keyframes_free(isorender_settings *settings) {
    struct isorender_keyframes *all = settings->keyframes;
    if (!all) return;
    for (int i = 0; i < all->count; i++) free(all->items[i].settings);
    free(all->items);
    json_decref(all->file);
    free(all);
    settings->keyframes = NULL;
}

int isorender_keyframes_count(const struct isorender_keyframes *all) {
    return all ? all->count : 0;
}

isorender_settings *isorender_keyframe(const struct isorender_keyframes *all, int i) {
    return all->items[i].settings;
}

int isorender_keyframes_pictures(const struct isorender_keyframes *all) {
    return all->items[all->count - 1].frame + 1;
}

bool isorender_keyframes_change_isovalues(const struct isorender_keyframes *all) {
    return all && all->named & 1u << ISOVALUE;
}

bool isorender_keyframes_change_opacities(const struct isorender_keyframes *all) {
    return all && all->named & 1u << OPACITY;
}

/* ---- interpolation. Only square roots, which all machines round alike. */

static double mix(double a, double b, double part) {
    return a + (b - a) * part;
}

static iso_vec3 mix_points(iso_vec3 a, iso_vec3 b, double part) {
    return iso_vec3_make(mix(a.x, b.x, part), mix(a.y, b.y, part), mix(a.z, b.z, part));
}

/* a to the power 1 - part, times b to the power part; both above 0. */
static double mix_factors(double a, double b, double part) {
    for (int bit = 0; bit < 52 && a != b; bit++) {
        const double middle = sqrt(a) * sqrt(b);
        part *= 2;
        if (part >= 1)
            a = middle, part -= 1;
        else
            b = middle;
    }
    return a;
}

typedef struct quaternion {
    double v[4];
} quaternion;

static quaternion unit(quaternion q) {
    double square = 0;
    for (int i = 0; i < 4; i++) square += q.v[i] * q.v[i];
    for (int i = 0; i < 4; i++) q.v[i] /= sqrt(square);
    return q;
}

/* The shorter way from one rotation to another on a great circle (Shoemake 1985), by halving. */
static quaternion mix_rotations(quaternion a, quaternion b, double part) {
    double cosine = 0;
    for (int i = 0; i < 4; i++) cosine += a.v[i] * b.v[i];
    for (int i = 0; i < 4 && cosine < 0; i++) b.v[i] = -b.v[i];
    for (int bit = 0; bit < 52; bit++) {
        quaternion middle;
        for (int i = 0; i < 4; i++) middle.v[i] = a.v[i] + b.v[i];
        middle = unit(middle);
        part *= 2;
        if (part >= 1)
            a = middle, part -= 1;
        else
            b = middle;
    }
    return a;
}

/* Of the rotation whose columns are these. */
static quaternion rotation_of(iso_vec3 x, iso_vec3 y, iso_vec3 z) {
    const double trace[4] = {x.x + y.y + z.z, x.x - y.y - z.z, y.y - x.x - z.z, z.z - x.x - y.y};
    const double sums[3] = {y.z - z.y, z.x - x.z, x.y - y.x}, products[3] = {z.y + y.z, x.z + z.x, y.x + x.y};
    int largest = 0;
    for (int i = 1; i < 4; i++)
        if (trace[i] > trace[largest]) largest = i;
    quaternion q = {{0, 0, 0, 0}}; /* w x y z, all times four times the largest */
    q.v[largest] = 1 + trace[largest];
    for (int i = 1; i < 4; i++) {
        if (largest == 0) q.v[i] = sums[i - 1];
        if (largest && i != largest) q.v[i] = products[6 - i - largest - 1];
    }
    if (largest) q.v[0] = sums[largest - 1];
    return unit(q);
}

static iso_vec3 rotate(const quaternion *q, iso_vec3 p) {
    const iso_vec3 axis = {q->v[1], q->v[2], q->v[3]}, t = iso_vec3_scale(iso_vec3_cross(axis, p), 2);
    return iso_vec3_add(iso_vec3_add(p, iso_vec3_scale(t, q->v[0])), iso_vec3_cross(axis, t));
}

static quaternion orientation_of(const iso_camera *camera, double *distance) {
    const iso_vec3 away = iso_vec3_sub(camera->position, camera->focal_point), z = iso_vec3_unit(away),
                   x = iso_vec3_unit(iso_vec3_cross(camera->view_up, z));
    *distance = iso_vec3_length(away);
    return rotation_of(x, iso_vec3_cross(z, x), z);
}

static iso_camera mix_cameras(const iso_camera *a, const iso_camera *b, double part) {
    double far[2];
    const quaternion qa = orientation_of(a, &far[0]), qb = orientation_of(b, &far[1]),
                     q = mix_rotations(qa, qb, part);
    const iso_vec3 focal = mix_points(a->focal_point, b->focal_point, part);
    const double distance = mix_factors(far[0], far[1], part);
    return (iso_camera){.position = iso_vec3_add(focal, rotate(&q, iso_vec3_make(0, 0, distance))),
                        .focal_point = focal,
                        .view_up = rotate(&q, iso_vec3_make(0, 1, 0)),
                        .view_angle = mix(a->view_angle, b->view_angle, part),
                        .orthographic = a->orthographic,
                        .parallel_scale = mix_factors(a->parallel_scale, b->parallel_scale, part)};
}

/* A plane whose normal turns; one that turns around stays, until the keyframe. */
static void mix_face(const double *b, double part, double *a) {
    double mixed[4], square = 0;
    for (int i = 0; i < 4; i++) mixed[i] = mix(a[i], b[i], part);
    for (int i = 0; i < 3; i++) square += mixed[i] * mixed[i];
    for (int i = 0; i < 4 && square > 1e-6; i++) a[i] = mixed[i] / sqrt(square);
}

static void mix_body(const iso_clip_body *b, double part, iso_clip_body *a) {
    for (int face = 0; face < a->faces; face++) mix_face(b->face[face], part, a->face[face]);
    a->centre = mix_points(a->centre, b->centre, part);
    a->radius = mix(a->radius, b->radius, part);
}

/* Cuts of the same number and kinds; others change at the keyframe. */
static void mix_cuts(const iso_cut *b, int b_count, double part, iso_cut *a, int a_count) {
    bool alike = a_count == b_count;
    for (int i = 0; alike && i < a_count; i++)
        alike = a[i].by_depth == b[i].by_depth && a[i].plane == b[i].plane &&
                a[i].by_middle == b[i].by_middle && a[i].body.faces == b[i].body.faces &&
                a[i].body.keeps == b[i].body.keeps;
    for (int i = 0; alike && i < a_count; i++) {
        a[i].depth = mix(a[i].depth, b[i].depth, part);
        mix_body(&b[i].body, part, &a[i].body);
    }
}

/* Between which settings one or several tracks are at a picture, and how far. Before the first keyframe that
 * has them these are the settings without keyframes, at picture 0. */
typedef struct place {
    const isorender_settings *before, *after;
    double part;
} place;

static place place_of(const struct isorender_keyframes *all, const isorender_settings *base, unsigned which,
                      int frame) {
    place p = {base, NULL, 0};
    int from = 0, to = 0;
    for (int i = 0; i < all->count && !p.after; i++) {
        if (!(all->items[i].named & which)) continue;
        if (all->items[i].frame <= frame)
            p.before = all->items[i].settings, from = all->items[i].frame;
        else
            p.after = all->items[i].settings, to = all->items[i].frame;
    }
    if (!p.after) return (place){p.before, p.before, 0};
    const double part = (double)(frame - from) / (to - from);
    p.part = all->smooth ? part * part * (3 - 2 * part) : part;
    return p;
}

static const double *numbers(const isorender_settings *settings, int which) {
    return (const double *)(const void *)((const char *)settings + tracks[which].offset);
}

static void take_cuts(isorender_settings *now, const place *p) {
    memcpy(now->cuts, p->before->cuts, sizeof now->cuts);
    memcpy(now->cut_texts, p->before->cut_texts, sizeof now->cut_texts);
    now->cut_count = p->before->cut_count;
    mix_cuts(p->after->cuts, p->after->cut_count, p->part, now->cuts, now->cut_count);
}

static void take_slices(isorender_settings *now, const place *p) {
    memcpy(now->slices, p->before->slices, sizeof now->slices);
    now->slice_count = p->before->slice_count;
    mix_cuts(p->after->slices, p->after->slice_count, p->part, now->slices, now->slice_count);
}

const isorender_settings *isorender_keyframes_at(const isorender_settings *settings, int frame) {
    struct isorender_keyframes *all = settings->keyframes;
    if (!all) return settings;
    isorender_settings *now = &all->now;
    *now = *settings;
    for (int which = 0; which < TRACKS; which++) {
        if (!(all->named & 1u << which)) continue;
        const place p = place_of(all, settings, 1u << which, frame);
        double *to = (double *)(void *)((char *)now + tracks[which].offset);
        const double *a = numbers(p.before, which), *b = numbers(p.after, which);
        for (size_t i = 0; i < tracks[which].count; i++)
            to[i] = p.part == 0               ? a[i]
                    : tracks[which].geometric ? mix_factors(a[i], b[i], p.part)
                                              : mix(a[i], b[i], p.part);
        if (which == CLIP) take_cuts(now, &p);
        if (which == SLICE) take_slices(now, &p);
    }
    return now;
}

/* ---- the job */

static void take_place(isorender_settings *to, const isorender_settings *from) {
    to->direction = from->direction;
    memcpy(to->position, from->position, sizeof to->position);
    memcpy(to->focal_point, from->focal_point, sizeof to->focal_point);
    memcpy(to->view_up, from->view_up, sizeof to->view_up);
}

/* The camera of `now` in the place of `from`. One that is fitted is as far away as the picture that needs
 * most. */
static iso_camera camera_in(isorender_job *job, isorender_settings *now, const isorender_settings *from) {
    const isorender_film *film = job->given->film;
    take_place(now, from);
    iso_camera camera = isorender_camera_of_box(job, &film->bounds);
    if (!(film->distance > 0) || !isnan(now->position[0])) return camera;
    const iso_vec3 away = iso_vec3_unit(iso_vec3_sub(camera.position, camera.focal_point));
    camera.position = iso_vec3_add(camera.focal_point, iso_vec3_scale(away, film->distance));
    if (camera.orthographic && !(now->mm_per_pixel > 0)) camera.parallel_scale = film->scale / now->zoom;
    return camera;
}

/* The camera of job->settings, which are those of this picture. */
static iso_camera camera_at(isorender_job *job, int frame) {
    struct isorender_keyframes *all = job->given->keyframes;
    const place p = place_of(all, job->given, PLACES, frame);
    const iso_camera after = camera_in(job, &all->now, p.after), before = camera_in(job, &all->now, p.before);
    return p.part == 0 ? before : mix_cameras(&before, &after, p.part);
}

/* Finds how far away the cameras of all pictures are. */
static void measure_distance(isorender_job *job) {
    struct isorender_keyframes *all = job->given->keyframes;
    isorender_film *film = job->given->film;
    const isorender_settings *settings = job->settings;
    double distance = 0, scale = 0;
    const int pictures = isorender_keyframes_pictures(all);
    for (int frame = 0; frame < pictures && !(film->distance > 0); frame++) {
        job->settings = isorender_keyframes_at(job->given, frame);
        all->now.zoom = 1;
        const place p = place_of(all, job->given, PLACES, frame);
        for (int end = 0; end < 2; end++) {
            const iso_camera camera = camera_in(job, &all->now, end ? p.after : p.before);
            distance = fmax(distance, iso_vec3_length(iso_vec3_sub(camera.position, camera.focal_point)));
            scale = fmax(scale, camera.parallel_scale);
        }
    }
    film->scale = film->distance > 0 ? film->scale : scale;
    film->distance = film->distance > 0 ? film->distance : distance;
    job->settings = settings;
}

static iso_status update_surface(isorender_surface *surface, double isovalue, iso_error *error) {
    surface->scene.isovalue = isovalue;
    for (int part = 0; part < ISO_PART_COUNT; part++)
        if (iso_scene_surface_has(&surface->scene, (iso_part)part))
            ISO_TRY(iso_scene_surface_update(&surface->scene, (iso_part)part, error));
    return ISO_OK;
}

/* Brings the surfaces to the isovalues of `settings`. */
static iso_status update_isovalues(isorender_job *job, const isorender_settings *settings, bool *remade,
                                   iso_error *error) {
    for (int i = 0; i < job->input_surface_count; i++) {
        if (job->surfaces[i].scene.isovalue == settings->isovalues[i]) continue;
        ISO_TRY(update_surface(&job->surfaces[i], settings->isovalues[i], error));
        *remade = true;
    }
    return ISO_OK;
}

/* Sets film->bounds to the box of the surfaces at the isovalues of all keyframes. */
static iso_status measure_bounds(isorender_job *job, iso_error *error) {
    static const iso_vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct isorender_keyframes *all = job->given->keyframes;
    isorender_film *film = job->given->film;
    bool remade;
    if (job->chunks && isorender_keyframes_change_isovalues(all))
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--keyframes changes isovalues of volumes in memory: this one is drawn in chunks (--max-memory)");
    film->bounds = isorender_bounds_of_all(job, axes);
    film->has_bounds = true;
    for (int i = 0; i < all->count; i++) {
        if (!(all->items[i].named & 1u << ISOVALUE)) continue;
        ISO_TRY(update_isovalues(job, all->items[i].settings, &remade, error));
        const iso_box box = isorender_bounds_of_all(job, axes);
        iso_bounds_add(&film->bounds, &box);
    }
    return isorender_keyframes_change_isovalues(all) ? update_isovalues(job, job->settings, &remade, error)
                                                     : ISO_OK;
}

iso_status isorender_keyframes_measure(isorender_job *job, iso_error *error) {
    if (!job->given->keyframes) return ISO_OK;
    if (!job->given->film->has_bounds) ISO_TRY(measure_bounds(job, error));
    measure_distance(job);
    return ISO_OK;
}

iso_status isorender_keyframes_show(isorender_job *job, int frame, bool *remade, iso_error *error) {
    const struct isorender_keyframes *all = job->given->keyframes;
    *remade = false;
    if (!all) return ISO_OK;
    frame += job->given->film->first;
    const isorender_settings *now = job->settings = isorender_keyframes_at(job->given, frame);
    if (isorender_keyframes_change_isovalues(all)) ISO_TRY(update_isovalues(job, now, remade, error));
    job->camera = camera_at(job, frame);
    ISO_TRY(iso_camera_check(&job->camera, error));
    bool translucent = false;
    for (int i = 0; i < job->surface_count; i++) {
        iso_translucency *translucency = &job->surfaces[i].translucency;
        if (i < job->input_surface_count && isorender_keyframes_change_opacities(all))
            translucency->opacity = (float)now->opacities[i];
        if (i < job->input_surface_count) translucency->absorption_length = (float)now->absorption_length;
        translucent |= translucency->opacity < 1;
    }
    for (int i = 0; i < job->object_count; i++) translucent |= job->objects[i].settings->opacity < 1;
    job->translucent = translucent;
    return ISO_OK;
}
