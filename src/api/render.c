/* The functions of isopoint.h for pictures: cameras, rendering of one or several surfaces by any method, and
 * writing picture files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "api/coloring.h"
#include "api/internal.h"
#include "base/memory.h"
#include "image/aov.h"
#include "image/camera.h"
#include "image/exr.h"
#include "image/image.h"
#include "image/image_file.h"
#include "io/glyphs/placements_read.h"
#include "render/picture.h"
#include "scene/bounds.h"
#include "scene/cuts.h"
#include "scene/picture.h"

enum { DEFAULT_SIDE = 1024 };
static const double DEFAULT_VIEW_ANGLE = 30;

/* ---- camera ---- */

static iso_status check_fit(const iso_fit_opts *o, iso_vec3 up, iso_error *error) {
    if (o->direction < ISO_FRONT || o->direction > ISO_ISOMETRIC)
        return iso_fail(error, ISO_ERR_USAGE, "there is no direction %d", (int)o->direction);
    if (!iso_vec3_is_finite(up) || iso_vec3_length(up) == 0)
        return iso_fail(error, ISO_ERR_USAGE, "the axis that is up is no direction");
    if (!isfinite(o->azimuth) || !isfinite(o->elevation))
        return iso_fail(error, ISO_ERR_USAGE, "an angle of the camera is not finite");
    if (!(o->zoom >= 0) || !isfinite(o->zoom))
        return iso_fail(error, ISO_ERR_USAGE, "zoom %g is not above 0", o->zoom);
    if (!(o->view_angle >= 0 && o->view_angle < 180))
        return iso_fail(error, ISO_ERR_USAGE, "view angle %g is not between 0 and 180", o->view_angle);
    return o->turns >= 0 ? ISO_OK : iso_fail(error, ISO_ERR_USAGE, "%d turns", o->turns);
}

iso_status iso_camera_of_box(const iso_box *box, int width, int height, const iso_fit_opts *opts,
                             iso_camera *camera, iso_error *error) {
    static const iso_fit_opts defaults;
    if (!opts) opts = &defaults;
    const iso_vec3 up = opts->up ? *opts->up : iso_vec3_make(0, 0, 1);
    ISO_TRY(check_fit(opts, up, error));
    if (width < 1 || height < 1)
        return iso_fail(error, ISO_ERR_USAGE, "a picture of %d x %d pixels", width, height);
    if (iso_box_is_empty(box) || !iso_vec3_is_finite(box->lo) || !iso_vec3_is_finite(box->hi))
        return iso_fail(error, ISO_ERR_USAGE, "the box to look at is empty or not finite");
    iso_camera made = {.view_angle = opts->view_angle > 0 ? opts->view_angle : DEFAULT_VIEW_ANGLE,
                       .orthographic = opts->orthographic,
                       .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors(opts->direction, iso_vec3_unit(up), &forward, &made.view_up);
    made.position = iso_vec3_scale(forward, -1);
    iso_camera_orbit(&made, opts->azimuth, opts->elevation);
    iso_camera_fit(&made, box, (double)width / height, opts->turns > 0 ? opts->turns : 1);
    if (opts->zoom > 0) iso_camera_zoom(&made, opts->zoom);
    ISO_TRY(iso_camera_check(&made, error));
    *camera = made;
    return ISO_OK;
}

/* ---- pictures ---- */

/* One call of iso_render_surfaces. */
typedef struct rendering {
    iso_surface *const *surfaces;
    int count;
    iso_shape_set *const *shapes; /* their surface numbers follow those of the surfaces */
    int shapes_count;
    const iso_renderer *renderer;
    const iso_render_opts *opts;
    iso_placed placed; /* with opts->instances */
    iso_api_colorings colorings;
    iso_picture_opts picture;
    iso_camera camera;
    iso_rgb colors[ISO_SURFACE_MAX];
    iso_layered_surface layered[ISO_SURFACE_MAX];
    iso_scene_object objects[ISO_SURFACE_MAX], *object[ISO_SURFACE_MAX]; /* the sets of shapes */
    bool translucent, translucent_shapes; /* at least one surface or set; one set */
    bool gaussians;                       /* the first surface are Gaussians */
    iso_refraction refraction;            /* of glass; not AUTO */
    iso_cut cuts[ISO_CLIP_BODIES];
    iso_clip *clips; /* of surfaces, then of sets; NULL: there are no cuts. Owned */
    iso_capped solids[ISO_SURFACE_MAX];
    iso_cut_caps caps;
    iso_pool *pool;      /* of a picture without surfaces; owned */
    iso_api_watch watch; /* with opts->progress */
} rendering;

/* Returns the bits of the parts that the picture is drawn from. */
static unsigned needs_of(const rendering *r) {
    const unsigned glass = r->opts->glass ? 1u << iso_glass_part(r->renderer->method, r->refraction) : 0;
    return r->renderer->needs | glass;
}

/* Returns the part whose box frames the picture. The ray caster has no box; it uses that of the exact
 * surface, which looks the same. */
static iso_part framing_part(const iso_renderer *renderer) {
    if (renderer->needs & 1u << ISO_PART_POINTS) return ISO_PART_POINTS;
    return renderer->needs & 1u << ISO_PART_MESH ? ISO_PART_MESH : ISO_PART_CELLS;
}

/* The box of a surface, or of all its instances. */
static iso_box bounds_of(const rendering *r, int i, iso_part framed) {
    const iso_box own = iso_api_surface_bounds(r->surfaces[i], framed);
    if (!r->opts->instances) return own;
    const iso_point_view points = iso_scene_surface_points(&r->surfaces[i]->scene);
    const iso_box index = iso_point_view_bounds(&points);
    return iso_placed_bounds(r->opts->instances, &points.transform, &index, &own, NULL);
}

/* Makes the levels of detail, or brings them up to date. */
static iso_status prepare_levels(const rendering *r, iso_error *error) {
    for (int i = 0; i < r->count; i++) {
        iso_scene_surface *scene = &r->surfaces[i]->scene;
        scene->lod_pixels = r->opts->lod;
        if (r->opts->lod > 0) ISO_TRY(iso_scene_surface_make_levels(scene, error));
    }
    return ISO_OK;
}

/* ---- progress */

/* What is told of a surface's loops; NULL: nobody. */
static iso_api_watch *watch_of(rendering *r, int surface) {
    const iso_surface *s = r->surfaces[surface];
    if (r->opts->progress) return &r->watch;
    return s->volume ? &s->volume->watch : NULL;
}

static void begin_watch(rendering *r) {
    r->watch = (iso_api_watch){.tell = r->opts->progress, .context = r->opts->progress_context};
    for (int i = 0; i < r->count; i++)
        if (watch_of(r, i)) iso_api_watch_begin(r->surfaces[i]->pool, watch_of(r, i));
    if (!r->count) iso_api_watch_begin(r->pool, &r->watch);
}

static void end_watch(const rendering *r) {
    for (int i = 0; i < r->count; i++) iso_api_watch_end(r->surfaces[i]->pool);
}

/* The share of a picture's time that extraction gets, as far as progress is concerned. */
static const double EXTRACTION = 0.2;

/* iso_scene_progress.strip. */
static void tell_strip(void *context, double from, double to) {
    rendering *r = context;
    iso_api_watch *watch = r->count ? watch_of(r, 0) : &r->watch;
    if (watch)
        iso_api_watch_part(watch, EXTRACTION + (1 - EXTRACTION) * from, EXTRACTION + (1 - EXTRACTION) * to);
}

static iso_status prepare(rendering *r, iso_box *box, iso_error *error) {
    const iso_part framed = framing_part(r->renderer);
    *box = iso_box_empty();
    for (int i = 0; i < r->shapes_count; i++) {
        const iso_box own = iso_shape_set_bounds(r->shapes[i]);
        iso_bounds_add(box, &own);
    }
    for (int i = 0; i < r->count; i++) {
        r->surfaces[i]->scene.transparency = r->translucent ? r->opts->transparency : ISO_TRANSPARENCY_SORTED;
        if (iso_api_is_gaussians(r->surfaces[i])) {
            iso_bounds_add(box, &r->surfaces[i]->cloud->made.frame);
            continue;
        }
        if (r->surfaces[i]->volume) iso_api_watch_part(watch_of(r, i), 0, EXTRACTION);
        r->surfaces[i]->scene.filter = r->opts->filter;
        ISO_TRY(iso_api_surface_part(r->surfaces[i], framed, error));
        for (int part = 0; part < ISO_PART_COUNT; part++)
            if (part != (int)framed && needs_of(r) & 1u << part)
                ISO_TRY(iso_api_surface_part(r->surfaces[i], (iso_part)part, error));
        const iso_box own = bounds_of(r, i, framed);
        iso_bounds_add(box, &own);
    }
    ISO_TRY(prepare_levels(r, error));
    return iso_box_is_empty(box) ? iso_fail(error, ISO_ERR_EMPTY, "there is no surface") : ISO_OK;
}

/* Allocates image and aov, unless they have the right size already. */
static iso_status make_room(int width, int height, iso_image *image, iso_aov *aov, iso_error *error) {
    if (image->width != width || image->height != height || !image->rgba) {
        iso_image_free(image);
        ISO_TRY(iso_image_create(width, height, image, error));
    }
    if (!aov || (aov->width == width && aov->height == height && aov->depth)) return ISO_OK;
    iso_aov_free(aov);
    return iso_aov_create(width, height, aov, error);
}

/* Allocates the planes of ids if there are shapes, and frees them if not. */
static iso_status make_room_for_ids(int shapes, iso_aov *aov, iso_error *error) {
    if (aov && shapes) return iso_aov_add_ids(aov, error);
    if (aov) iso_aov_remove_ids(aov);
    return ISO_OK;
}

static float smallest_spacing(const rendering *r) {
    double smallest = INFINITY;
    for (int i = 0; i < r->count; i++)
        for (int axis = 0; axis < 3 && !r->surfaces[i]->cloud; axis++)
            smallest = fmin(smallest, iso_grid_transform(&r->surfaces[i]->scene.grid)->spacing[axis]);
    return isfinite(smallest) ? (float)smallest : 0;
}

/* Checks clouds: a method must draw points; Gaussians are the first surface, among what is opaque. */
static iso_status check_clouds(iso_surface *const *surfaces, int count, const iso_render_opts *opts,
                               iso_error *error) {
    const iso_renderer *renderer = iso_renderer_get(opts->method);
    for (int i = 0; i < count; i++) {
        if (!surfaces[i]->cloud) continue;
        if (iso_api_is_gaussians(surfaces[i])) {
            if (i > 0)
                return iso_fail(error, ISO_ERR_USAGE, "surface %d are Gaussians, which must be the first", i);
            if (opts->aov || opts->glass || opts->instances || opts->clip_count || opts->occlusion != 0 ||
                opts->shadow || opts->outline > 0)
                return iso_fail(error, ISO_ERR_USAGE,
                                "Gaussians have no depths (aov), glass, instances, clips, occlusion, shadow "
                                "and outline");
        } else if (renderer->needs & ~(1u << ISO_PART_POINTS | 1u << ISO_PART_GROUPS)) {
            return iso_fail(error, ISO_ERR_USAGE,
                            "surface %d is a cloud of points: the method %s needs a volume; %s draw it", i,
                            renderer->name,
                            iso_methods_that_can(ISO_CAN_CLOUDS, (char[ISO_METHODS_TEXT]){0}));
        }
    }
    return ISO_OK;
}

static iso_status require(iso_method method, unsigned capabilities, const char *what, iso_error *error) {
    return iso_renderer_require(iso_renderer_get(method), capabilities, "the method", what, error);
}

static iso_status check(iso_surface *const *surfaces, int count, const iso_render_opts *opts,
                        iso_error *error) {
    const int shapes = opts->shapes_count;
    if (count < 0 || shapes < 0 || shapes > ISO_SURFACE_MAX || count > ISO_SURFACE_MAX - shapes ||
        count + shapes == 0)
        return iso_fail(error, ISO_ERR_USAGE, "%d surfaces and %d sets of shapes: a picture has 1 to %d",
                        count, shapes, ISO_SURFACE_MAX);
    for (int i = 0; i < shapes; i++)
        if (!opts->shapes[i]) return iso_fail(error, ISO_ERR_USAGE, "set of shapes %d is NULL", i);
    for (int i = 0; i < count; i++)
        if (!surfaces[i]) return iso_fail(error, ISO_ERR_USAGE, "surface %d is NULL", i);
    if (!iso_renderer_get(opts->method))
        return iso_fail(error, ISO_ERR_USAGE, "there is no method %d", (int)opts->method);
    for (int i = 0; i < count && opts->method == ISO_METHOD_HYBRID; i++)
        if (surfaces[i]->scene.primitive > ISO_PRIMITIVE_EDGE)
            return iso_fail(
                error, ISO_ERR_USAGE,
                "the method hybrid joins edge points to triangles: the primitive %s lies elsewhere",
                iso_primitive_name(surfaces[i]->scene.primitive));
    if ((int)opts->transparency < 0 || opts->transparency >= ISO_TRANSPARENCIES)
        return iso_fail(error, ISO_ERR_USAGE, "there is no transparency %d", (int)opts->transparency);
    if (opts->transparency)
        ISO_TRY(require(opts->method, ISO_CAN_GROUPS, "by the transparencies GROUPS and NEAREST", error));
    if (opts->transparency && opts->glass)
        return iso_fail(error, ISO_ERR_USAGE,
                        "the transparencies GROUPS and NEAREST are for translucent surfaces, not for glass");
    if (opts->instances) ISO_TRY(require(opts->method, ISO_CAN_INSTANCES, "instances", error));
    if (!(opts->lod >= 0 && opts->lod <= 1000))
        return iso_fail(error, ISO_ERR_USAGE, "lod %g is not from 0 to 1000", opts->lod);
    if (opts->lod > 0) ISO_TRY(require(opts->method, ISO_CAN_LEVELS, "levels of detail", error));
    if ((int)opts->filter < 0 || opts->filter > ISO_FILTER_INTERPOLATING)
        return iso_fail(error, ISO_ERR_USAGE, "there is no filter %d", (int)opts->filter);
    if (opts->filter) ISO_TRY(require(opts->method, ISO_CAN_SMOOTH, "smooth surfaces", error));
    if (opts->filter && (opts->glass || opts->cap))
        return iso_fail(error, ISO_ERR_USAGE, "glass and caps are of trilinear surfaces");
    ISO_TRY(check_clouds(surfaces, count, opts, error));
    return opts->camera ? iso_camera_check(opts->camera, error) : ISO_OK;
}

static void set_up(rendering *r, const iso_render_opts *opts) {
    const iso_rgb white = {255, 255, 255};
    for (int i = 0; i < r->count; i++)
        r->colors[i] = r->surfaces[i]->has_color ? r->surfaces[i]->color : iso_shading_palette(i);
    for (int i = 0; i < r->shapes_count; i++)
        r->colors[r->count + i] =
            r->shapes[i]->has_color ? r->shapes[i]->color : iso_shading_palette(r->count + i);
    r->picture = (iso_picture_opts){.camera = &r->camera,
                                    .width = opts->width ? opts->width : DEFAULT_SIDE,
                                    .height = opts->height ? opts->height : DEFAULT_SIDE,
                                    .samples = opts->samples,
                                    .shading = {.colors = r->colors,
                                                .color_count = r->count + r->shapes_count,
                                                .background = opts->background ? *opts->background : white,
                                                .transparent = opts->transparent},
                                    .pool = r->count ? r->surfaces[0]->pool : r->pool,
                                    .aov = opts->aov};
}

/* Refuses translucent surfaces that the method does not draw as the options ask. */
static iso_status require_layers(const iso_render_opts *o, iso_error *error) {
    const bool absorb = o->absorption_length > 0, cut = o->clip_count > 0, colored = o->color_by_count > 0,
               lit = o->occlusion != 0 || o->shadow;
    const unsigned needed = ISO_CAN_LAYERS | (absorb ? ISO_CAN_ABSORPTION : 0u) |
                            (cut ? ISO_CAN_CLIP_LAYERS : 0u) | (colored ? ISO_CAN_COLOR_LAYERS : 0u) |
                            (lit ? ISO_CAN_LIT_LAYERS : 0u);
    char what[128];
    snprintf(what, sizeof what, "translucent surfaces%s%s%s%s", absorb ? " that absorb light" : "",
             cut ? ", cut" : "", colored ? ", coloured by data" : "", lit ? ", with occlusion" : "");
    return require(o->method, needed, what, error);
}

static iso_status check_layers(const rendering *r, const iso_render_opts *opts, iso_error *error) {
    const bool absorbs = opts->absorption_length > 0;
    const iso_method method = opts->method;
    if (!(opts->absorption_length >= 0) || !isfinite(opts->absorption_length) || opts->most_layers < 0)
        return iso_fail(error, ISO_ERR_USAGE, "an absorption length of %g mm, %d layers",
                        opts->absorption_length, opts->most_layers);
    if (absorbs && opts->most_layers)
        return iso_fail(error, ISO_ERR_USAGE,
                        "most_layers leaves out where rays leave the solid, which absorption must know");
    if (r->translucent_shapes)
        ISO_TRY(require(method, ISO_CAN_OBJECT_LAYERS, "translucent lines and glyphs", error));
    if (r->translucent && opts->instances)
        return iso_fail(error, ISO_ERR_USAGE, "instances are opaque: nothing translucent can be beside them");
    if (r->translucent) ISO_TRY(require_layers(opts, error));
    if (r->translucent && opts->lod > 0)
        return iso_fail(error, ISO_ERR_USAGE, "levels of detail are of opaque surfaces");
    if (absorbs) ISO_TRY(require(method, ISO_CAN_ABSORPTION, "solids that absorb light", error));
    for (int i = 1; i < r->count && r->translucent && absorbs; i++)
        if (r->surfaces[i]->volume != r->surfaces[0]->volume)
            return iso_fail(error, ISO_ERR_USAGE, "absorption is for surfaces of one volume");
    return ISO_OK;
}

static void set_up_objects(rendering *r, const iso_render_opts *opts) {
    for (int i = 0; i < r->shapes_count; i++) {
        iso_scene_object *object = r->object[i] = &r->objects[i];
        *object = r->shapes[i]->object;
        object->color = r->colors[r->count + i];
        object->translucency = (iso_translucency){.opacity = (float)r->shapes[i]->opacity,
                                                  .constant = opts->constant_opacity,
                                                  .most_layers = opts->most_layers};
        r->translucent_shapes |= !iso_scene_object_is_opaque(object);
    }
    r->translucent |= r->translucent_shapes;
}

/* Shows the opacities of a cloud's discs to methods that draw them. Returns whether it has some. */
static bool set_up_opacities(const rendering *r, iso_api_cloud *cloud) {
    const bool drawn = iso_method_is_splats(r->renderer->method) && !r->opts->glass &&
                       r->opts->occlusion == 0 && !r->opts->shadow && r->opts->outline == 0;
    cloud->view.opacities = drawn ? cloud->made.discs.opacities : NULL;
    return cloud->view.opacities != NULL;
}

/* Sets up the picture's translucent surfaces and sets of shapes, if it has some. */
static iso_status set_up_layers(rendering *r, const iso_render_opts *opts, iso_error *error) {
    for (int i = 0; i < r->count; i++) {
        r->layered[i] = (iso_layered_surface){&r->surfaces[i]->scene,
                                              {.opacity = (float)r->surfaces[i]->opacity,
                                               .constant = opts->constant_opacity,
                                               .absorption_length = (float)opts->absorption_length,
                                               .most_layers = opts->most_layers}};
        r->surfaces[i]->scene.layered = r->layered[i].translucency.opacity < 1;
        r->translucent |= r->layered[i].translucency.opacity < 1;
        if (r->surfaces[i]->cloud) r->translucent |= set_up_opacities(r, r->surfaces[i]->cloud);
    }
    set_up_objects(r, opts);
    if (r->gaussians && r->translucent)
        return iso_fail(error, ISO_ERR_USAGE, "Gaussians are drawn among opaque surfaces and shapes only");
    ISO_TRY(check_layers(r, opts, error));
    if (!r->picture.samples)
        r->picture.samples = r->translucent || opts->glass ? 1 : iso_method_samples(r->renderer->method);
    if (opts->aov && !r->translucent) iso_aov_remove_layers(opts->aov);
    if (!r->translucent) return ISO_OK;
    return opts->aov ? iso_aov_add_layers(opts->aov, error) : ISO_OK;
}

/* ---- glass ---- */

/* Checks the options of glass, and chooses its refraction. */
static iso_status set_up_glass(rendering *r, iso_error *error) {
    const iso_glass_opts *glass = r->opts->glass;
    if (!glass) return ISO_OK;
    if (r->count != 1 || r->shapes_count || r->translucent || r->opts->instances)
        return iso_fail(error, ISO_ERR_USAGE,
                        "glass is drawn alone: one opaque surface, no shapes or instances");
    ISO_TRY(require(r->opts->method, ISO_CAN_GLASS, "glass", error));
    if (!(glass->ior >= 1 && glass->ior <= 10))
        return iso_fail(error, ISO_ERR_USAGE, "index of refraction %g is not in 1 .. 10", glass->ior);
    if ((int)glass->refraction < 0 || glass->refraction >= ISO_REFRACTIONS)
        return iso_fail(error, ISO_ERR_USAGE, "there is no refraction %d", (int)glass->refraction);
    if (!(glass->dispersion == 0 || (glass->dispersion >= 1 && isfinite(glass->dispersion))))
        return iso_fail(error, ISO_ERR_USAGE, "Abbe number %g is not 1 or more", glass->dispersion);
    if (!(glass->attenuation_distance >= 0 && isfinite(glass->attenuation_distance)))
        return iso_fail(error, ISO_ERR_USAGE, "attenuation distance %g is not above 0",
                        glass->attenuation_distance);
    if (!(glass->surface_opacity >= 0 && glass->surface_opacity <= 1))
        return iso_fail(error, ISO_ERR_USAGE, "surface opacity %g is not in 0 .. 1", glass->surface_opacity);
    const bool points = iso_glass_part(r->renderer->method, ISO_REFRACTION_TRACED) == ISO_PART_POINTS;
    r->refraction =
        glass->refraction ? glass->refraction : iso_glass_usual_refraction(points, ISO_TRANSPARENCY_SORTED);
    if (points && r->refraction == ISO_REFRACTION_TRACED)
        return iso_fail(error, ISO_ERR_USAGE, "rays cannot be traced through points");
    if (glass->surface_opacity > 0 && r->refraction >= ISO_REFRACTION_TWO_SIDED)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "the opacity of glass counts surfaces: it needs the refraction LAYERS, SINGLE or NONE");
    return ISO_OK;
}

/* ---- cuts ---- */

static iso_status check_cut(const rendering *r, const iso_cut *cut, const char *text, iso_error *error) {
    for (int i = r->count + r->shapes_count; i < ISO_CUT_THINGS && cut->things.named; i++)
        if (iso_cut_is_for(cut, i))
            return iso_fail(error, ISO_ERR_USAGE, "clip '%s': there is no @%d", text, i + 1);
    return ISO_OK;
}

/* Parses and checks the options of cuts. */
static iso_status set_up_cuts(rendering *r, iso_error *error) {
    const iso_render_opts *o = r->opts;
    if ((int)o->cap < 0 || o->cap >= ISO_CUT_CAPS || o->clip_count < 0 || o->clip_count > ISO_CLIP_BODIES)
        return iso_fail(error, ISO_ERR_USAGE, "%d clips, cap %d", o->clip_count, (int)o->cap);
    if (o->cap && !o->clip_count) return iso_fail(error, ISO_ERR_USAGE, "caps close cuts: there is no clip");
    if (o->cap == ISO_CUT_CAP_SLICE &&
        !(o->cap_values[0] < o->cap_values[1] && isfinite(o->cap_values[0]) && isfinite(o->cap_values[1])))
        return iso_fail(error, ISO_ERR_USAGE, "cap_values %g and %g are not in ascending order",
                        o->cap_values[0], o->cap_values[1]);
    if (!o->clip_count) return ISO_OK;
    ISO_TRY(require(o->method, ISO_CAN_CLIP, "cuts", error));
    if (o->glass || o->instances || o->absorption_length > 0)
        return iso_fail(error, ISO_ERR_USAGE, "glass, instances and what absorbs light are not cut");
    for (int i = 0; i < o->clip_count; i++) {
        if (!o->clips[i]) return iso_fail(error, ISO_ERR_USAGE, "clip %d is NULL", i);
        ISO_TRY(iso_cut_parse(o->clips[i], &r->cuts[i], error));
        ISO_TRY(check_cut(r, &r->cuts[i], o->clips[i], error));
    }
    r->clips = iso_alloc_zero((size_t)(r->count + r->shapes_count), sizeof *r->clips);
    return r->clips ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for clips");
}

/* The least distance of a box along the view. */
static double front_of(const iso_box *box, const iso_camera *camera) {
    const iso_vec3 forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position));
    double least = INFINITY;
    for (int corner = 0; corner < 8; corner++)
        least = fmin(least, iso_vec3_dot(forward, iso_box_corner(box, corner)));
    return least;
}

/* Cuts the surfaces and sets until end_cuts. `box`: of everything. */
static void begin_cuts(rendering *r, const iso_box *box) {
    const iso_render_opts *o = r->opts;
    if (!r->clips) return;
    const iso_grid *grid = r->count ? &r->surfaces[0]->scene.grid : NULL;
    const iso_vec3 middle = grid && (grid->rgrid || grid->hgrid)
                                ? iso_cut_middle(iso_grid_transform(grid), iso_grid_dims(grid))
                                : iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5);
    for (int i = 0; i < o->clip_count; i++) iso_cut_set_middle(&r->cuts[i], middle);
    for (int i = 0; i < r->count + r->shapes_count; i++)
        r->clips[i] = iso_cuts_clip(r->cuts, o->clip_count, i, &r->camera, front_of(box, &r->camera));
    for (int i = 0; i < r->shapes_count; i++) r->objects[i].clip = &r->clips[r->count + i];
    for (int i = 0; i < r->count; i++) {
        iso_scene_surface *scene = &r->surfaces[i]->scene;
        scene->clip = &r->clips[i];
        r->solids[i] =
            (iso_capped){&scene->grid, scene->isovalue, (uint8_t)i, r->colors[i], scene->clip, false};
    }
    r->caps = (iso_cut_caps){.solids = r->solids,
                             .count = r->count,
                             .caps = true,
                             .shows = o->cap == ISO_CUT_CAP_SLICE,
                             .look = {o->cap_values[0], o->cap_values[1], ISO_COLORMAP_GRAY},
                             .factor = iso_picture_factor(r->picture.samples)};
}

static void end_cuts(rendering *r) {
    for (int i = 0; i < r->count; i++) r->surfaces[i]->scene.clip = NULL;
    iso_free(r->clips);
}

static iso_status open_environment(const rendering *r, iso_environment **environment, iso_error *error) {
    const iso_render_opts *opts = r->opts;
    const char *path = opts->glass->environment;
    ISO_TRY(path ? iso_environment_read(path, UINT64_MAX, r->picture.pool, environment, error)
                 : iso_environment_studio(environment, error));
    if (opts->fit.up) iso_environment_set_up(*environment, iso_vec3_unit(*opts->fit.up));
    return ISO_OK;
}

/* Checks the options of light that shows shape. */
static iso_status set_up_light(rendering *r, const iso_render_opts *opts, iso_error *error) {
    const bool range =
        opts->occlusion == ISO_OCCLUSION_USUAL || (opts->occlusion >= 0 && isfinite(opts->occlusion));
    if (!range || !(opts->outline >= 0 && opts->outline <= ISO_OUTLINE_MOST))
        return iso_fail(error, ISO_ERR_USAGE, "occlusion within %g mm, an outline of %g pixels",
                        opts->occlusion, opts->outline);
    r->picture.outline = opts->outline;
    if (opts->occlusion == 0 && !opts->shadow && opts->outline == 0) return ISO_OK;
    if ((r->translucent && opts->outline > 0) || opts->glass)
        return iso_fail(error, ISO_ERR_USAGE, "occlusion, shadows and outlines are of opaque surfaces%s",
                        opts->glass ? "" : ": beside translucent ones there are the first two");
    if (opts->instances && (opts->occlusion != 0 || opts->shadow))
        return iso_fail(error, ISO_ERR_USAGE, "instances do not darken each other");
    return require(opts->method, ISO_CAN_OCCLUSION, "occlusion, shadows and outlines", error);
}

static iso_status draw_picture(rendering *r, iso_image *image, size_t *covered, iso_error *error) {
    const iso_render_opts *opts = r->opts;
    const iso_glass_opts *given = opts->glass;
    iso_environment *environment = NULL;
    iso_scene_glass glass;
    iso_occluders together = {.coarse = 0};
    iso_gaussians gaussians;
    if (given) {
        ISO_TRY(open_environment(r, &environment, error));
        glass = (iso_scene_glass){.glass = {.ior = given->ior,
                                            .surface_opacity = given->surface_opacity,
                                            .environment = environment},
                                  .refraction = r->refraction,
                                  .abbe = given->dispersion,
                                  .shows_environment = !opts->background && !opts->transparent};
        if (given->attenuation_distance > 0)
            iso_glass_set_absorption(&glass.glass, given->attenuation_color, given->attenuation_distance);
    }
    iso_scene scene = {.renderer = r->renderer,
                       .surfaces = r->layered,
                       .count = r->count,
                       .translucent = r->translucent,
                       .objects = r->object,
                       .object_count = r->shapes_count,
                       .placed = &r->placed,
                       .placed_count = opts->instances ? r->count : 0,
                       .glass = given ? &glass : NULL,
                       .caps = opts->cap ? &r->caps : NULL,
                       .occlusion = {.ambient = opts->occlusion != 0,
                                     .range = opts->occlusion > 0 ? opts->occlusion : 0,
                                     .shadow = opts->shadow},
                       .occluders = r->count == 1 ? &r->surfaces[0]->occluders : &together,
                       .progress = &(iso_scene_progress){.strip = tell_strip, .surface = NULL, .context = r},
                       .transparency = opts->transparency};
    if (r->gaussians) {
        gaussians = iso_api_cloud_gaussians(r->surfaces[0]->cloud, r->colors[0]);
        gaussians.clip = r->surfaces[0]->scene.clip;
        scene.gaussians = &gaussians;
    }
    const iso_status status = iso_scene_render(&scene, &r->picture, image, covered, error);
    iso_environment_destroy(environment);
    iso_occluders_free(&together);
    return status;
}

/* Renders what was checked and set up. */
static iso_status render(rendering *r, iso_image *image, iso_error *error) {
    const iso_render_opts *opts = r->opts;
    const int width = r->picture.width, height = r->picture.height;
    iso_box box;
    if (opts->instances) ISO_TRY(iso_placed_begin(&r->placed, opts->instances, error));
    ISO_TRY(prepare(r, &box, error));
    if (opts->camera)
        r->camera = *opts->camera;
    else
        ISO_TRY(iso_camera_of_box(&box, width, height, &opts->fit, &r->camera, error));
    if (opts->camera_used) *opts->camera_used = r->camera;
    if (opts->aov) opts->aov->voxel = smallest_spacing(r);
    begin_cuts(r, &box);
    const iso_view view = iso_view_make(&r->camera, width, height);
    const iso_api_colored colored = {r->surfaces, r->count, r->renderer, r->translucent, r->colors};
    ISO_TRY(iso_api_colorings_begin(&colored, opts, &view, &r->colorings, error));
    size_t covered = 0;
    ISO_TRY(draw_picture(r, image, &covered, error));
    if (opts->instance_counts) *opts->instance_counts = iso_placed_counts(&r->placed);
    return covered ? ISO_OK : iso_fail(error, ISO_ERR_EMPTY, "nothing of the surface is in view");
}

/* Sets up and renders what was checked. */
static iso_status render_with(rendering *r, iso_image *image, iso_error *error) {
    const iso_render_opts *opts = r->opts;
    set_up(r, opts);
    ISO_TRY(make_room(r->picture.width, r->picture.height, image, opts->aov, error));
    ISO_TRY(make_room_for_ids(opts->shapes_count, opts->aov, error));
    ISO_TRY(set_up_layers(r, opts, error));
    ISO_TRY(set_up_glass(r, error));
    ISO_TRY(set_up_light(r, opts, error));
    ISO_TRY(iso_api_colorings_check(r->surfaces, r->count, opts, r->renderer, error));
    iso_status status = set_up_cuts(r, error);
    if (status == ISO_OK) {
        begin_watch(r);
        status = render(r, image, error);
        end_watch(r);
    }
    iso_placed_free(&r->placed);
    iso_api_colorings_end(&r->colorings);
    end_cuts(r);
    return status;
}

iso_status iso_render_surfaces(iso_surface *const *surfaces, int count, const iso_render_opts *opts,
                               iso_image *image, iso_error *error) {
    static const iso_render_opts defaults;
    if (!opts) opts = &defaults;
    ISO_TRY(check(surfaces, count, opts, error));
    rendering r = {.surfaces = surfaces,
                   .count = count,
                   .shapes = opts->shapes,
                   .shapes_count = opts->shapes_count,
                   .renderer = iso_renderer_get(opts->method),
                   .gaussians = count && iso_api_is_gaussians(surfaces[0]),
                   .opts = opts};
    if (!count) ISO_TRY(iso_api_pool(opts->threads, &r.pool, error));
    iso_status status = render_with(&r, image, error);
    iso_pool_destroy(r.pool);
    return status;
}

iso_status iso_render(iso_surface *surface, const iso_render_opts *opts, iso_image *image, iso_error *error) {
    return iso_render_surfaces(&surface, 1, opts, image, error);
}

iso_status iso_placements_read(const char *path, iso_placements *placements, iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    return iso_placements_read_file(path, NULL, placements, error);
}

/* ---- files ---- */

static iso_status check_image(const iso_image *image, const char *path, iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    return image->rgba ? ISO_OK : iso_fail(error, ISO_ERR_USAGE, "%s: there is no picture to write", path);
}

static iso_png_text software_text(char software[64]) {
    snprintf(software, 64, "isopoint %s", iso_version());
    return (iso_png_text){"Software", software};
}

iso_status iso_image_write(const iso_image *image, const char *path, iso_error *error) {
    char software[64];
    const iso_png_text text = software_text(software);
    ISO_TRY(check_image(image, path, error));
    return iso_png_write(path, image, &text, 1, error);
}

iso_status iso_image_encode(const iso_image *image, uint8_t **bytes, size_t *size, iso_error *error) {
    char software[64];
    const iso_png_text text = software_text(software);
    ISO_TRY(check_image(image, "a picture in memory", error));
    return iso_png_encode(image, &(iso_png_opts){.texts = &text, .text_count = 1}, bytes, size, error);
}

void iso_bytes_free(uint8_t *bytes) {
    free(bytes);
}

iso_status iso_image_read(const char *path, iso_image *image, iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    return iso_image_file_read(path, image, error);
}

iso_status iso_aov_write(const iso_aov *aov, const char *path, iso_error *error) {
    if (!path || !aov->depth)
        return iso_fail(error, ISO_ERR_USAGE, "%s",
                        path ? "there is no picture to write" : "no file is named");
    const iso_exr_info info = {.software = "isopoint"};
    return iso_exr_write(path, aov, &info, NULL, error);
}

iso_status iso_aov_read(const char *path, iso_aov *aov, iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    return iso_exr_read(path, NULL, aov, error);
}
