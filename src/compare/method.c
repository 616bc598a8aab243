#include "compare/method.h"

#include <assert.h>

/* ---- parts ---- */

static iso_status make_points(iso_subject *subject, iso_error *error) {
    if (!subject->workspace) ISO_TRY(iso_pullpush_create(&subject->workspace, error));
    iso_points_opts opts = {.isovalue = subject->isovalue,
                            .primitive = ISO_PRIMITIVE_EDGE, /* what refined is best with */
                            .shapes = true,
                            .pool = subject->pool};
    ISO_TRY(iso_point_set_create(subject->grid, &opts, &subject->points, error));
    return iso_point_set_update(subject->points, error);
}

static iso_status make_mesh(iso_subject *subject, iso_error *error) {
    iso_mesh_opts opts = {.isovalue = subject->isovalue, .pool = subject->pool};
    ISO_TRY(iso_mesh_set_create(subject->grid, &opts, &subject->mesh, error));
    return iso_mesh_set_update(subject->mesh, error);
}

static iso_status make_cells(iso_subject *subject, iso_error *error) {
    iso_exact_opts opts = {.isovalue = subject->isovalue, .pool = subject->pool};
    ISO_TRY(iso_exact_create(subject->grid, &opts, &subject->exact, error));
    return iso_exact_update(subject->exact, error);
}

bool iso_subject_has(const iso_subject *subject, iso_part part) {
    const void *parts[] = {subject->points, subject->mesh, subject->exact, subject->caster};
    return parts[part] != NULL;
}

iso_status iso_subject_prepare(iso_subject *subject, iso_part part, iso_error *error) {
    if (iso_subject_has(subject, part)) return ISO_OK;
    switch (part) {
    case ISO_PART_POINTS:
        return make_points(subject, error);
    case ISO_PART_MESH:
        return make_mesh(subject, error);
    case ISO_PART_CELLS:
        return make_cells(subject, error);
    case ISO_PART_CASTER:
        return iso_raycaster_create(subject->grid, subject->isovalue, subject->pool, &subject->caster, error);
    case ISO_PART_COUNT:
        break;
    }
    assert(!"a part");
    return ISO_OK;
}

void iso_subject_free(iso_subject *subject) {
    iso_point_set_destroy(subject->points);
    iso_pullpush_destroy(subject->workspace);
    iso_mesh_set_destroy(subject->mesh);
    iso_exact_destroy(subject->exact);
    iso_raycaster_destroy(subject->caster);
    *subject = (iso_subject){.grid = subject->grid, .isovalue = subject->isovalue, .pool = subject->pool};
}

const char *iso_part_name(iso_part part) {
    static const char *const names[] = {"points", "mesh", "cells", "ray caster's index"};
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
    if (part == ISO_PART_CELLS && subject->exact) {
        iso_exact_totals totals = iso_exact_stats(subject->exact);
        return (iso_part_size){totals.cells, totals.bytes};
    }
    return (iso_part_size){0, 0};
}

/* ---- methods ---- */

static iso_status draw_points(const iso_subject *subject, const iso_target *target, iso_error *error) {
    iso_point_view view = iso_point_set_view(subject->points);
    return iso_draw_points(target, &view, error);
}

static iso_status draw_mesh(const iso_subject *subject, const iso_target *target, iso_error *error) {
    iso_mesh_view view = iso_mesh_set_view(subject->mesh);
    return iso_draw_mesh(target, &view, error);
}

static iso_status draw_pyramid(const iso_subject *subject, const iso_target *target,
                               iso_reconstruction reconstruction, iso_error *error) {
    iso_point_view view = iso_point_set_view(subject->points);
    iso_pullpush_opts opts = {reconstruction, subject->workspace};
    return iso_draw_pullpush(target, &view, &opts, error);
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
    CASTER = 1 << ISO_PART_CASTER
};

static const iso_method METHODS[] = {
    {"points", "attenuated points (2003)", POINTS, draw_points},
    {"pullpush-box", "pull-push, box filter (2008)", POINTS, draw_box},
    {"pullpush-gaussian", "pull-push, Gaussian filter (2008)", POINTS, draw_gaussian},
    {"pullpush", "pull-push, curved discs", POINTS, draw_refined},
    {"mesh", "Marching Cubes mesh", MESH, draw_mesh},
    {"exact", "the trilinear surface, cell by cell", CELLS, draw_exact},
};

static const iso_method TRUTH = {"raycast", "rays through the trilinear field", CASTER, draw_raycast};

const iso_method *iso_method_list(size_t *count) {
    *count = sizeof METHODS / sizeof *METHODS;
    return METHODS;
}

const iso_method *iso_method_truth(void) {
    return &TRUTH;
}
