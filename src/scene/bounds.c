/* bounds: world boxes of points, meshes and cells. */
#include "scene/bounds.h"

#include <math.h>

#include "base/box_items.h"

bool iso_bounds_is_oblique(const iso_transform *transform) {
    int zeros = 0;
    for (int i = 0; i < 9; i++) zeros += transform->direction[i] == 0;
    return zeros < 6;
}

/* A box, in index coordinates, of positions relative to a brick: by default of those that packed points can
 * have. */
static iso_box in_brick(const int32_t brick[3], const iso_point_bounds *bounds) {
    static const iso_point_bounds most = {{-2, -2, -2}, {18, 18, 18}, {0}, {0}};
    if (!bounds) bounds = &most;
    if (bounds->lo[0] > bounds->hi[0]) return iso_box_empty();
    return (iso_box){iso_brick_position(brick, bounds->lo), iso_brick_position(brick, bounds->hi)};
}

/* Points of files that are not packed may lie anywhere. */
static bool knows_boxes(const iso_point_view *view) {
    return view->packed || view->bounds;
}

static iso_box around_points(const void *context, size_t span) {
    const iso_point_view *view = context;
    return in_brick(view->spans[span].brick, view->bounds ? &view->bounds[span] : NULL);
}

static void add_points(const void *context, size_t span, const iso_affine *affine, iso_box *box) {
    const iso_point_view *view = context;
    for (uint32_t i = 0; i < view->spans[span].count; i++) {
        iso_surfel surfel = iso_point_view_get(view, view->spans[span].first + i);
        iso_box_add(box,
                    iso_affine_point(affine, iso_brick_position(view->spans[span].brick, surfel.position)));
    }
}

iso_box iso_bounds_of_each_point(const iso_point_view *view, const iso_affine *affine) {
    const iso_box_items spans = {view, view->span_count, knows_boxes(view) ? around_points : NULL,
                                 add_points};
    return iso_box_of_items(&spans, affine);
}

typedef struct discs {
    const iso_point_view *view;
    iso_affine world;
    const iso_vec3 *vectors;
    double most; /* how far the largest disc reaches, in index coordinates */
} discs;

/* How far a disc reaches, mm. */
static double reach_of(const discs *d, size_t point) {
    const iso_point_view *view = d->view;
    const double scale = (double)iso_point_view_radii_scale(view);
    return ISO_BOUNDS_DISC_REACH * (view->radii ? scale * (double)view->radii[point] : view->radius);
}

/* The length of the part of v that is perpendicular to a unit vector n, or of all of it if n is 0. */
static double share_across(iso_vec3 n, iso_vec3 v) {
    const double along = iso_vec3_dot(n, v);
    return sqrt(fmax(iso_vec3_dot(v, v) - along * along, 0));
}

static iso_box around_discs(const void *context, size_t span) {
    const discs *d = context;
    iso_box box = around_points(d->view, span);
    if (iso_box_is_empty(&box)) return box;
    const iso_vec3 most = {d->most, d->most, d->most};
    return (iso_box){iso_vec3_sub(box.lo, most), iso_vec3_add(box.hi, most)};
}

static void add_discs(const void *context, size_t span, const iso_affine *affine, iso_box *box) {
    const discs *d = context;
    const iso_point_view *view = d->view;
    for (uint32_t i = 0; i < view->spans[span].count; i++) {
        const size_t point = view->spans[span].first + i;
        const iso_surfel surfel = iso_point_view_get(view, point);
        const iso_vec3 p =
            iso_affine_point(affine, iso_brick_position(view->spans[span].brick, surfel.position));
        const iso_vec3 n =
            iso_affine_normal(&d->world, iso_vec3_make((double)surfel.normal[0], (double)surfel.normal[1],
                                                       (double)surfel.normal[2]));
        const double reach = reach_of(d, point);
        const iso_vec3 more = {reach * share_across(n, d->vectors[0]), reach * share_across(n, d->vectors[1]),
                               reach * share_across(n, d->vectors[2])};
        iso_box_add(box, iso_vec3_sub(p, more));
        iso_box_add(box, iso_vec3_add(p, more));
    }
}

iso_box iso_bounds_of_each_disc(const iso_point_view *view, const iso_affine *along,
                                const iso_vec3 vectors[3]) {
    const double *s = view->transform.spacing;
    discs d = {.view = view, .world = iso_transform_affine(&view->transform), .vectors = vectors};
    for (size_t span = 0; span < view->span_count; span++)
        for (uint32_t i = 0; i < view->spans[span].count; i++) {
            const double reach = reach_of(&d, view->spans[span].first + i);
            if (reach > d.most) d.most = reach; /* (fmax is an internal error of gcc 12 for ARM) */
        }
    d.most /= fmin(s[0], fmin(s[1], s[2]));
    const iso_box_items spans = {&d, view->span_count, knows_boxes(view) ? around_discs : NULL, add_discs};
    return iso_box_of_items(&spans, along);
}

static iso_box around_vertices(const void *context, size_t span) {
    const iso_mesh_view *view = context;
    return in_brick(view->spans[span].brick, view->bounds ? &view->bounds[span] : NULL);
}

static void add_vertices(const void *context, size_t span, const iso_affine *affine, iso_box *box) {
    const iso_mesh_view *view = context;
    for (uint32_t i = 0; i < view->spans[span].owned_count; i++) {
        const iso_surfel *vertex = &view->vertices[view->spans[span].first_vertex + i];
        iso_box_add(box,
                    iso_affine_point(affine, iso_brick_position(view->spans[span].brick, vertex->position)));
    }
}

iso_box iso_bounds_along(const iso_scene_surface *surface, iso_part part, const iso_affine *affine) {
    if (part == ISO_PART_CELLS) return iso_exact_bounds(surface->exact, affine);
    if (part == ISO_PART_MESH) { /* its vertices lie in their bricks or at most two voxels beyond them */
        const iso_mesh_view mesh = iso_mesh_set_view(surface->mesh);
        const iso_box_items spans = {&mesh, mesh.span_count, around_vertices, add_vertices};
        return affine ? iso_box_of_items(&spans, affine) : iso_mesh_view_bounds(&mesh);
    }
    const iso_point_view points = iso_scene_surface_points(surface);
    return affine ? iso_bounds_of_each_point(&points, affine) : iso_point_view_bounds(&points);
}

iso_box iso_bounds_of_points(const iso_point_view *view) {
    const iso_scene_surface surface = {.given = view};
    return iso_bounds_of_part(&surface, ISO_PART_POINTS);
}

iso_box iso_bounds_of_part(const iso_scene_surface *surface, iso_part part) {
    const iso_transform *transform =
        surface->given ? &surface->given->transform : iso_grid_transform(&surface->grid);
    const iso_affine affine = iso_transform_affine(transform);
    if (iso_bounds_is_oblique(transform)) return iso_bounds_along(surface, part, &affine);
    const iso_box box = iso_bounds_along(surface, part, NULL);
    return iso_box_is_empty(&box) ? box : iso_box_transform(&box, &affine);
}

void iso_bounds_add(iso_box *box, const iso_box *more) {
    if (iso_box_is_empty(more)) return;
    iso_box_add(box, more->lo);
    iso_box_add(box, more->hi);
}
