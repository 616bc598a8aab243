/* method: the table of methods, and how each draws. */
#include "scene/method.h"

#include <stdio.h>
#include <string.h>

#include "exact/spline_hits.h"
#include "render/pullpush/hybrid.h"

static iso_status draw_points(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(surface);
    return iso_draw_points(target, &view, error);
}

/* The target with what is cut away of the surface. */
static iso_target clipped(const iso_scene_surface *surface, const iso_target *target) {
    iso_target made = *target;
    made.clip = surface->clip;
    return made;
}

static iso_status draw_mesh(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    const iso_target to = clipped(surface, target);
    iso_mesh_view view = iso_mesh_set_view(surface->mesh);
    return iso_draw_mesh(&to, &view, error);
}

static iso_point_workspace *workspace_of(const iso_scene_surface *surface) {
    return surface->workspace ? surface->workspace : surface->own_workspace;
}

iso_status iso_draw_reconstructed(const iso_scene_surface *surface, const iso_target *target,
                                  iso_reconstruction reconstruction, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(surface);
    const iso_target to = clipped(surface, target);
    const iso_point_surface_opts opts = {.reconstruction = reconstruction,
                                         .workspace = workspace_of(surface),
                                         .selection = surface->selection};
    const bool cut = to.clip && to.clip->count; /* one sees what faces away, too */
    view.closed &= !cut;
    if (!iso_scene_surface_uses_levels(surface)) return iso_draw_point_surface(&to, &view, &opts, error);
    iso_lod_cut *levels = surface->cut;
    ISO_TRY(iso_lod_cut_make(levels, &surface->lod, target->view, surface->lod_pixels, target->pool, error));
    for (int k = 0; k < levels->levels; k++) {
        levels->view[k].closed &= !cut;
        if (levels->view[k].span_count) ISO_TRY(iso_draw_point_surface(&to, &levels->view[k], &opts, error));
    }
    return ISO_OK;
}

static iso_status draw_splats(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(surface);
    iso_draw_groups_opts opts = {&surface->groups, surface->bins};
    const iso_target to = clipped(surface, target);
    view.closed &= !(to.clip && to.clip->count); /* one sees what faces away, too */
    return iso_draw_groups(&to, &view, &opts, error);
}

static iso_status draw_hybrid(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    const iso_point_view points = iso_scene_surface_points(surface);
    const iso_mesh_view mesh = iso_mesh_set_view(surface->mesh);
    const iso_hybrid_opts opts = {.workspace = iso_point_workspace_pullpush(workspace_of(surface))};
    return iso_draw_hybrid(target, &points, &mesh, &opts, error);
}

static iso_status draw_exact(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    const iso_target to = clipped(surface, target);
    if (!surface->spline) return iso_draw_exact(&to, surface->exact, error);
    const iso_exact_spline of = {surface->exact, surface->spline, surface->tracer,
                                 iso_grid_stored(&surface->grid, surface->isovalue)};
    return iso_draw_exact_spline(&to, &of, error);
}

static iso_status draw_raycast(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    const iso_target to = clipped(surface, target);
    return iso_draw_raycast(&to, surface->caster, error);
}

enum {
    POINTS = 1 << ISO_PART_POINTS,
    MESH = 1 << ISO_PART_MESH,
    CELLS = 1 << ISO_PART_CELLS,
    CASTER = 1 << ISO_PART_CASTER,
    GROUPS = 1 << ISO_PART_GROUPS
};

/* What several methods can do. */
enum {
    GBUFFER = ISO_CAN_OCCLUSION | ISO_CAN_COLORS, /* of all methods that draw into a gbuffer */
    PYRAMID = GBUFFER | ISO_CAN_CLOUDS | ISO_CAN_PYRAMID | ISO_CAN_LEVELS | ISO_CAN_CHUNKS | ISO_CAN_GL,
    DISCS = GBUFFER | ISO_CAN_CLOUDS | ISO_CAN_LEVELS | ISO_CAN_SELECTION | ISO_CAN_INSTANCES | ISO_CAN_CLIP,
    LAYERS = GBUFFER | ISO_CAN_LAYERS | ISO_CAN_GLASS,
    DISC_LAYERS = LAYERS | ISO_CAN_CLOUDS | ISO_CAN_GL | ISO_CAN_GL_LAYERS,
    SMOOTH = LAYERS | ISO_CAN_ABSORPTION | ISO_CAN_COLOR_LAYERS | ISO_CAN_CLIP | ISO_CAN_CLIP_LAYERS |
             ISO_CAN_SMOOTH | ISO_CAN_LIT_LAYERS | ISO_CAN_TRACED
};

static const iso_renderer METHODS[] = {
    {ISO_METHOD_POINTS, "points", "attenuated points (2003)",
     "discs parallel to the picture: to see the samples themselves", ISO_METHOD_POINTS, NULL,
     ISO_RECONSTRUCTION_CURVED, POINTS, GBUFFER | ISO_CAN_CLOUDS | ISO_CAN_GL | ISO_CAN_ATTENUATED,
     draw_points},
    {ISO_METHOD_PULLPUSH_BOX, "pullpush-box", "pull-push, equal weights (2008)", NULL, ISO_METHOD_PULLPUSH,
     "box", ISO_RECONSTRUCTION_BOX, POINTS, PYRAMID, NULL},
    {ISO_METHOD_PULLPUSH, "pullpush", "pull-push, Gaussian weights (2008)",
     "points, and the surface between them reconstructed in an image pyramid: Marroquim et al. 2008; --lines "
     "are drawn that way, too",
     ISO_METHOD_PULLPUSH, "gaussian", ISO_RECONSTRUCTION_GAUSSIAN, POINTS, PYRAMID, NULL},
    {ISO_METHOD_DISCS, "discs", "points as curved discs",
     "points as discs that follow the surface's curvature: the best picture of points", ISO_METHOD_DISCS,
     "curved", ISO_RECONSTRUCTION_CURVED, POINTS, DISCS | ISO_CAN_GL, NULL},
    {ISO_METHOD_SPLATS, "splats", "splats in groups, one pass (2006)",
     "points as flat discs with smooth edges: for files of points", ISO_METHOD_SPLATS, "groups",
     ISO_RECONSTRUCTION_CURVED, POINTS | GROUPS, DISC_LAYERS | ISO_CAN_GROUPS | ISO_CAN_CLIP, draw_splats},
    {ISO_METHOD_MESH, "mesh", "Marching Cubes mesh",
     "Marching Cubes: to see what --mesh exports, or to compare with other programs", ISO_METHOD_MESH, NULL,
     ISO_RECONSTRUCTION_CURVED, MESH, GBUFFER | ISO_CAN_GL | ISO_CAN_CLIP | ISO_CAN_STRIPS, draw_mesh},
    {ISO_METHOD_EXACT, "exact", "the trilinear surface, cell by cell",
     "the trilinear surface itself, at any zoom: choose it for pictures", ISO_METHOD_EXACT, NULL,
     ISO_RECONSTRUCTION_CURVED, CELLS, SMOOTH | ISO_CAN_OBJECT_LAYERS | ISO_CAN_CHUNKS | ISO_CAN_PAGE,
     draw_exact},
};

/* Not in the list of what is compared. Where cells are small hybrid is pullpush, where they are large it is
 * mesh; flat discs are discs without curvatures, which are for points of files. */
static const iso_renderer OTHERS[] = {
    {ISO_METHOD_HYBRID, "hybrid", "points and triangles (2008)",
     "triangles where the volume's cells are larger than 3 pixels, points elsewhere: also of 2008",
     ISO_METHOD_HYBRID, NULL, ISO_RECONSTRUCTION_CURVED, POINTS | MESH,
     GBUFFER | ISO_CAN_PYRAMID | ISO_CAN_GL, draw_hybrid},
    {ISO_METHOD_SPLATS_FLAT, "splats-flat", "splats, flat discs", NULL, ISO_METHOD_SPLATS, "flat",
     ISO_RECONSTRUCTION_FLAT, POINTS, DISCS | DISC_LAYERS, NULL},
    {ISO_METHOD_SPLATS_FLAT, "splats-flat", "splats, flat discs", NULL, ISO_METHOD_DISCS, "flat",
     ISO_RECONSTRUCTION_FLAT, POINTS, DISCS | ISO_CAN_GL, NULL},
    {ISO_METHOD_SPLATS_ONEPASS, "splats-onepass", "splats, front to back (2003)", NULL, ISO_METHOD_SPLATS,
     "onepass", ISO_RECONSTRUCTION_ONEPASS, POINTS, DISCS, NULL},
    {ISO_METHOD_SPLATS_EWA, "splats-ewa", "splats, EWA filter", NULL, ISO_METHOD_SPLATS, "ewa",
     ISO_RECONSTRUCTION_EWA, POINTS, DISCS | ISO_CAN_GL, NULL},
    {ISO_METHOD_SPLATS_MEAN, "splats-mean", "mean of a pixel's points", NULL, ISO_METHOD_SPLATS, "mean",
     ISO_RECONSTRUCTION_MEAN, POINTS, DISCS, NULL},
};

/* A name that a method had before. */
static const char OLD_PULLPUSH[] = "pullpush-gaussian";

static const iso_renderer TRUTH = {ISO_METHOD_RAYCAST,
                                   "raycast",
                                   "rays through the trilinear field",
                                   "rays through the field, slow: to check the others",
                                   ISO_METHOD_RAYCAST,
                                   NULL,
                                   ISO_RECONSTRUCTION_CURVED,
                                   CASTER,
                                   SMOOTH,
                                   draw_raycast};

const iso_renderer *iso_renderer_list(size_t *count) {
    *count = sizeof METHODS / sizeof *METHODS;
    return METHODS;
}

const iso_renderer *iso_renderer_truth(void) {
    return &TRUTH;
}

/* All rows in turn; NULL behind the last one. */
static const iso_renderer *row(size_t i) {
    enum { LISTED = sizeof METHODS / sizeof *METHODS, OTHER = sizeof OTHERS / sizeof *OTHERS };
    return i < LISTED            ? &METHODS[i]
           : i < LISTED + OTHER  ? &OTHERS[i - LISTED]
           : i == LISTED + OTHER ? &TRUTH
                                 : NULL;
}

const iso_renderer *iso_renderer_get(iso_method method) {
    for (size_t i = 0; row(i); i++)
        if (row(i)->method == method) return row(i);
    return NULL;
}

const iso_renderer *iso_renderer_find(iso_method family, const char *reconstruction) {
    if (!reconstruction) return iso_renderer_get(family);
    for (size_t i = 0; row(i); i++)
        if (row(i)->family == family && row(i)->reconstruction &&
            strcmp(row(i)->reconstruction, reconstruction) == 0)
            return row(i);
    return NULL;
}

bool iso_method_can(iso_method method, iso_capability capability) {
    const iso_renderer *renderer = iso_renderer_get(method);
    return renderer && renderer->can & (unsigned)capability;
}

/* ---- words */

static const iso_method families[] = {ISO_METHOD_EXACT,   ISO_METHOD_POINTS, ISO_METHOD_PULLPUSH,
                                      ISO_METHOD_DISCS,   ISO_METHOD_SPLATS, ISO_METHOD_MESH,
                                      ISO_METHOD_RAYCAST, ISO_METHOD_HYBRID};
enum { FAMILIES = sizeof families / sizeof *families };
_Static_assert((int)FAMILIES <= (int)ISO_METHOD_FAMILIES_MOST,
               "names of families are listed in arrays of this size");

const iso_method *iso_method_families(int *count) {
    *count = FAMILIES;
    return families;
}

/* A list of names as text: all but the last are known to have one behind them. */
typedef struct list {
    char *text;
    const char *pending; /* the name that is written when the next one, or the end, is known */
    bool several;
} list;

static void put(list *to, const char *joint, const char *name) {
    const size_t used = strlen(to->text);
    snprintf(to->text + used, ISO_METHODS_TEXT - used, "%s%s", to->several ? joint : "", name);
    to->several = true;
}

static void add(list *to, const char *name) {
    if (to->pending) put(to, ", ", to->pending);
    to->pending = name;
}

static const char *end(list *to) {
    if (to->pending) put(to, " or ", to->pending);
    return to->text;
}

static bool has_all(const iso_renderer *renderer, unsigned capabilities) {
    return (renderer->can & capabilities) == capabilities;
}

/* Writes the reconstructions of a family that have all capabilities, its usual one first. */
static const char *list_reconstructions(iso_method family, unsigned capabilities,
                                        char text[ISO_METHODS_TEXT]) {
    const iso_renderer *usual = iso_renderer_get(family);
    list names = {.text = text};
    *text = 0;
    if (!usual->reconstruction) return text;
    if (has_all(usual, capabilities)) add(&names, usual->reconstruction);
    for (size_t i = 0; row(i); i++)
        if (row(i)->family == family && row(i) != usual && has_all(row(i), capabilities))
            add(&names, row(i)->reconstruction);
    return end(&names);
}

/* How many rows of a family have all capabilities. */
static int count_rows(iso_method family, unsigned capabilities) {
    int count = 0;
    for (size_t i = 0; row(i); i++) count += row(i)->family == family && has_all(row(i), capabilities);
    return count;
}

const char *iso_methods_that_can(unsigned capabilities, char text[ISO_METHODS_TEXT]) {
    char some[ISO_METHODS_TEXT], names[FAMILIES][ISO_METHODS_TEXT];
    list named = {.text = text};
    *text = 0;
    for (int i = 0; i < FAMILIES; i++) {
        const iso_method family = families[i];
        const int count = count_rows(family, capabilities);
        const char *name = iso_renderer_get(family)->name;
        if (!count) continue;
        if (count < count_rows(family, 0))
            snprintf(names[i], sizeof names[i], "%s (%s)", name,
                     list_reconstructions(family, capabilities, some));
        else
            snprintf(names[i], sizeof names[i], "%s", name);
        add(&named, names[i]);
    }
    return end(&named);
}

const char *iso_method_reconstructions(iso_method family, char text[ISO_METHODS_TEXT]) {
    return list_reconstructions(family, 0, text);
}

const char *iso_methods_with_reconstruction(const char *reconstruction, char text[ISO_METHODS_TEXT]) {
    list named = {.text = text};
    *text = 0;
    for (int i = 0; i < FAMILIES; i++)
        if (iso_renderer_find(families[i], reconstruction)) add(&named, iso_renderer_get(families[i])->name);
    return end(&named);
}

iso_status iso_renderer_require(const iso_renderer *renderer, unsigned capabilities, const char *called,
                                const char *what, iso_error *error) {
    const bool others = count_rows(renderer->family, capabilities) > 0;
    char who[ISO_METHODS_TEXT];
    if (has_all(renderer, capabilities)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s %s%s%s%s cannot draw %s: that needs %s", called,
                    iso_renderer_get(renderer->family)->name, others ? " (" : "",
                    others ? renderer->reconstruction : "", others ? ")" : "", what,
                    iso_methods_that_can(capabilities, who));
}

/* ---- names */

const char *const iso_filter_names[] = {"linear", "cubic", "interpolating", NULL};

int iso_method_samples(iso_method method) {
    return method == ISO_METHOD_EXACT ? 4 : 1;
}

const char *iso_method_name(iso_method method) {
    const iso_renderer *renderer = iso_renderer_get(method);
    return renderer ? renderer->name : NULL;
}

iso_status iso_method_find(const char *name, iso_method *method, iso_error *error) {
    if (name && strcmp(name, OLD_PULLPUSH) == 0) name = iso_method_name(ISO_METHOD_PULLPUSH);
    for (size_t i = 0; row(i) && name; i++) {
        if (strcmp(row(i)->name, name) != 0) continue;
        *method = row(i)->method;
        return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_USAGE, "there is no method '%s'", name ? name : "");
}
