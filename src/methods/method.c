/* method: the table of methods, and the parts that they draw from. */
#include "methods/method.h"

#include <assert.h>
#include <string.h>

#include "base/coverage.h"
#include "grids/change_log.h"
#include "render/pullpush/hybrid.h"
#include "render/splats/layers.h"

/* ---- parts ---- */

static iso_status make_points(iso_subject *subject, iso_error *error) {
    if (!subject->workspace) ISO_TRY(iso_pullpush_create(&subject->workspace, error));
    iso_points_opts opts = {.isovalue = subject->isovalue,
                            .primitive = subject->primitive ? subject->primitive : ISO_PRIMITIVE_EDGE,
                            .curvature = true,
                            .pool = subject->pool};
    return iso_point_set_create(subject->grid, &opts, &subject->points, error);
}

static iso_status update_points(iso_subject *subject, iso_error *error) {
    if (!subject->points) ISO_TRY(make_points(subject, error));
    ISO_TRY(iso_point_set_update(subject->points, error));
    return subject->bounded ? iso_point_set_bound(subject->points, error) : ISO_OK;
}

static iso_status update_mesh(iso_subject *subject, iso_error *error) {
    iso_mesh_opts opts = {.isovalue = subject->isovalue, .pool = subject->pool};
    if (!subject->mesh) ISO_TRY(iso_mesh_set_create(subject->grid, &opts, &subject->mesh, error));
    return iso_mesh_set_update(subject->mesh, error);
}

static iso_status update_cells(iso_subject *subject, iso_error *error) {
    iso_exact_opts opts = {.isovalue = subject->isovalue, .pool = subject->pool};
    if (!subject->exact) ISO_TRY(iso_exact_create(subject->grid, &opts, &subject->exact, error));
    return iso_exact_update(subject->exact, error);
}

/* Creates the ray caster again, because it does not follow edits. */
static iso_status update_caster(iso_subject *subject, iso_error *error) {
    const uint64_t now = iso_change_log_now(iso_grid_log(subject->grid));
    if (subject->caster && subject->caster_edit == now) return ISO_OK;
    iso_raycaster_destroy(subject->caster);
    subject->caster = NULL;
    subject->caster_edit = now;
    return iso_raycaster_create(subject->grid, subject->isovalue, subject->pool, &subject->caster, error);
}

static iso_status update_groups(iso_subject *subject, iso_error *error) {
    const uint64_t now = iso_change_log_now(iso_grid_log(subject->grid));
    const bool sorted = subject->transparency == ISO_TRANSPARENCY_SORTED;
    if (subject->grouped_for != subject->transparency) iso_groups_free(&subject->groups);
    if (subject->groups.group && subject->groups_edit == now) return ISO_OK;
    if (!subject->points) ISO_TRY(update_points(subject, error));
    subject->groups_edit = now;
    subject->grouped_for = subject->transparency;
    const iso_point_view view = iso_point_set_view(subject->points);
    const iso_groups_opts opts =
        sorted ? iso_splats_grouping(subject->pool) : iso_splat_layers_grouping(subject->pool);
    ISO_TRY(iso_groups_update(&view, &opts, &subject->groups, error));
    if (sorted) return ISO_OK;
    const iso_status status = iso_groups_cover(&view, opts.disc, subject->pool, &subject->groups, error);
    if (status != ISO_OK) iso_groups_free(&subject->groups); /* they are made again */
    return status;
}

iso_status iso_subject_update(iso_subject *subject, iso_part part, iso_error *error) {
    switch (part) {
    case ISO_PART_POINTS:
        return update_points(subject, error);
    case ISO_PART_MESH:
        return update_mesh(subject, error);
    case ISO_PART_CELLS:
        return update_cells(subject, error);
    case ISO_PART_CASTER:
        return update_caster(subject, error);
    case ISO_PART_GROUPS:
        return update_groups(subject, error);
    case ISO_PART_COUNT:
        break;
    }
    assert(!"a part");
    return ISO_OK;
}

void iso_subject_set_isovalue(iso_subject *subject, double isovalue) {
    subject->isovalue = isovalue;
    if (subject->points) iso_point_set_isovalue(subject->points, isovalue);
    if (subject->mesh) iso_mesh_set_isovalue(subject->mesh, isovalue);
    if (subject->exact) iso_exact_set_isovalue(subject->exact, isovalue);
    iso_raycaster_destroy(subject->caster);
    subject->caster = NULL;
    iso_groups_free(&subject->groups);
}

bool iso_subject_has(const iso_subject *subject, iso_part part) {
    const void *parts[] = {subject->points, subject->mesh, subject->exact, subject->caster,
                           subject->groups.group};
    return parts[part] != NULL;
}

iso_status iso_subject_prepare(iso_subject *subject, iso_part part, iso_error *error) {
    return iso_subject_has(subject, part) ? ISO_OK : iso_subject_update(subject, part, error);
}

void iso_subject_free(iso_subject *subject) {
    iso_point_set_destroy(subject->points);
    iso_pullpush_destroy(subject->workspace);
    iso_mesh_set_destroy(subject->mesh);
    iso_exact_destroy(subject->exact);
    iso_raycaster_destroy(subject->caster);
    iso_groups_free(&subject->groups);
    *subject = (iso_subject){.grid = subject->grid,
                             .isovalue = subject->isovalue,
                             .pool = subject->pool,
                             .bounded = subject->bounded,
                             .primitive = subject->primitive};
}

const char *iso_part_name(iso_part part) {
    static const char *const names[] = {"points", "mesh", "cells", "ray caster's index", "groups"};
    return names[part];
}

static iso_part_size points_size(const iso_point_view *view) {
    size_t count = iso_point_view_count(view);
    size_t each =
        (view->surfels ? sizeof(iso_surfel) : sizeof(iso_point)) + (view->radii ? sizeof(float) : 0);
    return (iso_part_size){count, count * each + view->span_count * sizeof *view->spans};
}

static iso_part_size mesh_size(const iso_mesh_view *view) {
    size_t triangles = iso_mesh_view_triangle_count(view), vertices = 0;
    for (size_t s = 0; s < view->span_count; s++) vertices += view->spans[s].vertex_count;
    return (iso_part_size){triangles, triangles * sizeof *view->triangles +
                                          vertices * sizeof *view->vertices +
                                          view->span_count * sizeof *view->spans};
}

iso_part_size iso_subject_size(const iso_subject *subject, iso_part part) {
    if (part == ISO_PART_POINTS && subject->points) {
        iso_point_view view = iso_point_set_view(subject->points);
        return points_size(&view);
    }
    if (part == ISO_PART_MESH && subject->mesh) {
        iso_mesh_view view = iso_mesh_set_view(subject->mesh);
        return mesh_size(&view);
    }
    if (part == ISO_PART_GROUPS && subject->groups.group) {
        iso_point_view view = iso_point_set_view(subject->points);
        return (iso_part_size){(size_t)subject->groups.count,
                               iso_point_view_count(&view) + iso_groups_memory_bytes(&subject->groups)};
    }
    if (part == ISO_PART_CELLS && subject->exact) {
        iso_exact_totals totals = iso_exact_stats(subject->exact);
        return (iso_part_size){totals.cells, totals.bytes};
    }
    return (iso_part_size){0, 0};
}

/* ---- methods ---- */

iso_point_view iso_subject_points(const iso_subject *subject) {
    return subject->given ? *subject->given : iso_point_set_view(subject->points);
}

static iso_status draw_points(const iso_subject *subject, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_subject_points(subject);
    return iso_draw_points(target, &view, error);
}

static iso_status draw_mesh(const iso_subject *subject, const iso_target *target, iso_error *error) {
    iso_mesh_view view = iso_mesh_set_view(subject->mesh);
    return iso_draw_mesh(target, &view, error);
}

static iso_status draw_pyramid(const iso_subject *subject, const iso_target *target,
                               iso_reconstruction reconstruction, iso_error *error) {
    iso_point_view view = iso_subject_points(subject);
    const iso_pullpush_opts opts = {
        .reconstruction = reconstruction, .workspace = subject->workspace, .selection = subject->selection};
    if (!subject->lod) return iso_draw_pullpush(target, &view, &opts, error);
    iso_lod_cut *cut = subject->cut;
    ISO_TRY(iso_lod_cut_make(cut, subject->lod, target->view, subject->lod_pixels, target->pool, error));
    for (int k = 0; k < cut->levels; k++)
        if (cut->view[k].span_count) ISO_TRY(iso_draw_pullpush(target, &cut->view[k], &opts, error));
    return ISO_OK;
}

static iso_status draw_refined(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_REFINED, error);
}

static iso_status draw_gaussian(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_GAUSSIAN, error);
}

static iso_status draw_box(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_BOX, error);
}

static iso_status draw_flat(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_FLAT, error);
}

static iso_status draw_onepass(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_ONEPASS, error);
}

static iso_status draw_ewa(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_EWA, error);
}

static iso_status draw_mean(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return draw_pyramid(subject, target, ISO_RECONSTRUCTION_MEAN, error);
}

static iso_status draw_splats(const iso_subject *subject, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_subject_points(subject);
    iso_splats_opts opts = {&subject->groups, subject->bins};
    return iso_draw_splats(target, &view, &opts, error);
}

static iso_status draw_hybrid(const iso_subject *subject, const iso_target *target, iso_error *error) {
    const iso_point_view points = iso_subject_points(subject);
    const iso_mesh_view mesh = iso_mesh_set_view(subject->mesh);
    const iso_hybrid_opts opts = {.workspace = subject->workspace};
    return iso_draw_hybrid(target, &points, &mesh, &opts, error);
}

static iso_status draw_exact(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return iso_draw_exact(target, subject->exact, error);
}

static iso_status draw_raycast(const iso_subject *subject, const iso_target *target, iso_error *error) {
    return iso_draw_raycast(target, subject->caster, error);
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
