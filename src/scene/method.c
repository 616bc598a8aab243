/* method: the table of methods, and how each draws. */
#include "scene/method.h"

#include <string.h>

#include "render/pullpush/hybrid.h"

static iso_status draw_points(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(surface);
    return iso_draw_points(target, &view, error);
}

static iso_status draw_mesh(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    iso_mesh_view view = iso_mesh_set_view(surface->mesh);
    return iso_draw_mesh(target, &view, error);
}

static iso_pullpush *workspace_of(const iso_scene_surface *surface) {
    return surface->workspace ? surface->workspace : surface->own_workspace;
}

static iso_status draw_pyramid(const iso_scene_surface *surface, const iso_target *target,
                               iso_reconstruction reconstruction, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(surface);
    const iso_pullpush_opts opts = {.reconstruction = reconstruction,
                                    .workspace = workspace_of(surface),
                                    .selection = surface->selection};
    if (!iso_scene_surface_uses_levels(surface)) return iso_draw_pullpush(target, &view, &opts, error);
    iso_lod_cut *cut = surface->cut;
    ISO_TRY(iso_lod_cut_make(cut, &surface->lod, target->view, surface->lod_pixels, error));
    for (int k = 0; k < cut->levels; k++)
        if (cut->view[k].span_count) ISO_TRY(iso_draw_pullpush(target, &cut->view[k], &opts, error));
    return ISO_OK;
}

static iso_status draw_refined(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_REFINED, error);
}

static iso_status draw_gaussian(const iso_scene_surface *surface, const iso_target *target,
                                iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_GAUSSIAN, error);
}

static iso_status draw_box(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_BOX, error);
}

static iso_status draw_flat(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_FLAT, error);
}

static iso_status draw_onepass(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_ONEPASS, error);
}

static iso_status draw_ewa(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_EWA, error);
}

static iso_status draw_mean(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return draw_pyramid(surface, target, ISO_RECONSTRUCTION_MEAN, error);
}

static iso_status draw_splats(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(surface);
    iso_splats_opts opts = {&surface->groups, surface->bins};
    return iso_draw_splats(target, &view, &opts, error);
}

static iso_status draw_hybrid(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    const iso_point_view points = iso_scene_surface_points(surface);
    const iso_mesh_view mesh = iso_mesh_set_view(surface->mesh);
    const iso_hybrid_opts opts = {.workspace = workspace_of(surface)};
    return iso_draw_hybrid(target, &points, &mesh, &opts, error);
}

static iso_status draw_exact(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return iso_draw_exact(target, surface->exact, error);
}

static iso_status draw_raycast(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    return iso_draw_raycast(target, surface->caster, error);
}

enum {
    POINTS = 1 << ISO_PART_POINTS,
    MESH = 1 << ISO_PART_MESH,
    CELLS = 1 << ISO_PART_CELLS,
    CASTER = 1 << ISO_PART_CASTER,
    GROUPS = 1 << ISO_PART_GROUPS
};

static const iso_renderer METHODS[] = {
    {ISO_METHOD_POINTS, "points", "attenuated points (2003)", POINTS, draw_points},
    {ISO_METHOD_PULLPUSH_BOX, "pullpush-box", "pull-push, equal weights (2008)", POINTS, draw_box},
    {ISO_METHOD_PULLPUSH, "pullpush", "pull-push, Gaussian weights (2008)", POINTS, draw_gaussian},
    {ISO_METHOD_DISCS, "discs", "points as curved discs", POINTS, draw_refined},
    {ISO_METHOD_SPLATS, "splats", "splats in groups, one pass (2006)", POINTS | GROUPS, draw_splats},
    {ISO_METHOD_MESH, "mesh", "Marching Cubes mesh", MESH, draw_mesh},
    {ISO_METHOD_EXACT, "exact", "the trilinear surface, cell by cell", CELLS, draw_exact},
};

/* Not in the list of what is compared. Where cells are small hybrid is pullpush, where they are large it is
 * mesh; flat discs are discs without curvatures, which are for points of files. */
static const iso_renderer OTHERS[] = {
    {ISO_METHOD_HYBRID, "hybrid", "points and triangles (2008)", POINTS | MESH, draw_hybrid},
    {ISO_METHOD_SPLATS_FLAT, "splats-flat", "splats, flat discs", POINTS, draw_flat},
    {ISO_METHOD_SPLATS_ONEPASS, "splats-onepass", "splats, front to back (2003)", POINTS, draw_onepass},
    {ISO_METHOD_SPLATS_EWA, "splats-ewa", "splats, EWA filter", POINTS, draw_ewa},
    {ISO_METHOD_SPLATS_MEAN, "splats-mean", "mean of a pixel's points", POINTS, draw_mean},
};

/* A name that a method had before. */
static const char OLD_PULLPUSH[] = "pullpush-gaussian";

static const iso_renderer TRUTH = {ISO_METHOD_RAYCAST, "raycast", "rays through the trilinear field", CASTER,
                                   draw_raycast};

const iso_renderer *iso_renderer_list(size_t *count) {
    *count = sizeof METHODS / sizeof *METHODS;
    return METHODS;
}

const iso_renderer *iso_renderer_truth(void) {
    return &TRUTH;
}

const iso_renderer *iso_renderer_get(iso_method method) {
    if (method == TRUTH.method) return &TRUTH;
    for (size_t i = 0; i < sizeof METHODS / sizeof *METHODS; i++)
        if (METHODS[i].method == method) return &METHODS[i];
    for (size_t i = 0; i < sizeof OTHERS / sizeof *OTHERS; i++)
        if (OTHERS[i].method == method) return &OTHERS[i];
    return NULL;
}

int iso_method_samples(iso_method method) {
    return method == ISO_METHOD_EXACT ? 4 : 1;
}

const char *iso_method_name(iso_method method) {
    const iso_renderer *renderer = iso_renderer_get(method);
    return renderer ? renderer->name : NULL;
}

iso_status iso_method_find(const char *name, iso_method *method, iso_error *error) {
    if (name && strcmp(name, OLD_PULLPUSH) == 0) name = iso_method_name(ISO_METHOD_PULLPUSH);
    for (int i = 0; i < ISO_METHODS; i++) {
        const iso_renderer *renderer = iso_renderer_get((iso_method)i);
        if (!name || strcmp(renderer->name, name) != 0) continue;
        *method = renderer->method;
        return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_USAGE, "there is no method '%s'", name ? name : "");
}
