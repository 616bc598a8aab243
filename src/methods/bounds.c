/* bounds: world boxes of points, meshes and cells. */
#include "methods/bounds.h"

bool iso_bounds_is_oblique(const iso_transform *transform) {
    int zeros = 0;
    for (int i = 0; i < 9; i++) zeros += transform->direction[i] == 0;
    return zeros < 6;
}

iso_box iso_bounds_of_each_point(const iso_point_view *view, const iso_affine *affine) {
    iso_box box = iso_box_empty();
    for (size_t s = 0; s < view->span_count; s++)
        for (uint32_t i = 0; i < view->spans[s].count; i++) {
            iso_surfel surfel = iso_point_view_get(view, view->spans[s].first + i);
            iso_box_add(&box,
                        iso_affine_point(affine, iso_brick_position(view->spans[s].brick, surfel.position)));
        }
    return box;
}

iso_box iso_bounds_of_each_vertex(const iso_mesh_view *view, const iso_affine *affine) {
    iso_box box = iso_box_empty();
    for (size_t s = 0; s < view->span_count; s++)
        for (uint32_t i = 0; i < view->spans[s].owned_count; i++) {
            const iso_surfel *vertex = &view->vertices[view->spans[s].first_vertex + i];
            iso_box_add(&box,
                        iso_affine_point(affine, iso_brick_position(view->spans[s].brick, vertex->position)));
        }
    return box;
}

iso_box iso_bounds_of_points(const iso_point_view *view) {
    const iso_affine affine = iso_transform_affine(&view->transform);
    if (iso_bounds_is_oblique(&view->transform)) return iso_bounds_of_each_point(view, &affine);
    const iso_box box = iso_point_view_bounds(view);
    return iso_box_is_empty(&box) ? box : iso_box_transform(&box, &affine);
}

iso_box iso_bounds_of_mesh(const iso_mesh_view *view) {
    const iso_affine affine = iso_transform_affine(&view->transform);
    if (iso_bounds_is_oblique(&view->transform)) return iso_bounds_of_each_vertex(view, &affine);
    const iso_box box = iso_mesh_view_bounds(view);
    return iso_box_is_empty(&box) ? box : iso_box_transform(&box, &affine);
}

iso_box iso_bounds_of_cells(const iso_exact *cells, const iso_transform *transform) {
    const iso_affine affine = iso_transform_affine(transform);
    if (iso_bounds_is_oblique(transform)) return iso_exact_bounds(cells, &affine);
    const iso_box box = iso_exact_bounds(cells, NULL);
    return iso_box_is_empty(&box) ? box : iso_box_transform(&box, &affine);
}

void iso_bounds_add(iso_box *box, const iso_box *more) {
    if (iso_box_is_empty(more)) return;
    iso_box_add(box, more->lo);
    iso_box_add(box, more->hi);
}
