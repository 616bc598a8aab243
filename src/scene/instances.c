/* instances: from placements to the instances of one surface, and what became of them. */
#include "scene/instances.h"

#include <string.h>

#include "base/placement.h"

iso_status iso_placed_begin(iso_placed *placed, const iso_placements *placements, iso_error *error) {
    const size_t count = placements->count;
    iso_error reason = {ISO_OK, ""};
    size_t bytes;
    for (size_t i = 0; i < count; i++)
        if (iso_placement_check(&placements->items[i], &reason) != ISO_OK)
            return iso_fail(error, ISO_ERR_USAGE, "placement %zu: %s", i, reason.text);
    if (count > UINT32_MAX || !iso_size_multiply(count, sizeof(iso_instance), &bytes))
        return iso_fail(error, ISO_ERR_LIMIT, "more than %lu placements", (unsigned long)UINT32_MAX);
    ISO_TRY(iso_buffer_reserve(&placed->instances, bytes, 0, error));
    ISO_TRY(iso_buffer_reserve(&placed->states, count, 0, error));
    if (count) memset(placed->states.data, ISO_INSTANCE_OUTSIDE, count);
    placed->placements = placements;
    placed->points = 0;
    return ISO_OK;
}

/* The largest radius of a point, mm. */
static double largest_radius(const iso_point_view *points) {
    double largest = points->radii ? 0 : points->radius;
    for (size_t s = 0; points->radii && s < points->span_count; s++) {
        const iso_point_span *span = &points->spans[s];
        for (size_t i = span->first; i < span->first + span->count; i++)
            largest = iso_max((double)points->radii[i], largest);
    }
    return largest;
}

iso_status iso_placed_draw(iso_placed *placed, iso_method method, const iso_scene_surface *surface,
                           const iso_target *target, iso_draw_instances_fn *by, void *context,
                           iso_error *error) {
    const iso_placements *placements = placed->placements;
    const iso_point_view points = iso_scene_surface_points(surface);
    const iso_lod plain = {.points = points, .count = 1};
    const bool leveled = iso_scene_surface_uses_levels(surface);
    const iso_instanced set = {leveled ? &surface->lod : &plain, iso_point_view_bounds(&points),
                               largest_radius(&points)};
    iso_instance *instances = placed->instances.data;
    for (size_t i = 0; i < placements->count; i++)
        instances[i] = (iso_instance){0, iso_placement_transform(&placements->items[i], &points.transform)};
    iso_instances all = {.sets = &set,
                         .instances = instances,
                         .set_count = 1,
                         .count = placements->count,
                         .lod_pixels = leveled ? surface->lod_pixels : 0,
                         .draw_hidden = surface->selection == ISO_SELECTION_ALL,
                         .selection = surface->selection,
                         .reconstruction = iso_renderer_get(method)->discs,
                         .colors = placements->colors,
                         .states = placed->states.data};
    iso_instance_counts counts;
    ISO_TRY(by ? by(context, &placed->drawing, target, &all, &counts, error)
               : iso_draw_instances(&placed->drawing, target, &all, &counts, error));
    placed->points += counts.points;
    return ISO_OK;
}

iso_instance_counts iso_placed_counts(const iso_placed *placed) {
    iso_instance_counts counts = {.points = placed->points};
    const uint8_t *states = placed->states.data;
    for (size_t i = 0; placed->placements && i < placed->placements->count; i++) {
        counts.drawn += states[i] == ISO_INSTANCE_DRAWN;
        counts.hidden += states[i] == ISO_INSTANCE_HIDDEN;
        counts.outside += states[i] == ISO_INSTANCE_OUTSIDE;
    }
    return counts;
}

void iso_placed_free(iso_placed *placed) {
    iso_instance_drawing_free(&placed->drawing);
    iso_buffer_free(&placed->instances);
    iso_buffer_free(&placed->states);
    *placed = (iso_placed){.placements = NULL};
}

/* ---- bounds */

/* Coordinates of a world position along three vectors. */
static iso_vec3 along_vectors(const iso_vec3 *vectors, iso_vec3 p) {
    if (!vectors) return p;
    return iso_vec3_make(iso_vec3_dot(vectors[0], p), iso_vec3_dot(vectors[1], p),
                         iso_vec3_dot(vectors[2], p));
}

iso_box iso_placed_bounds(const iso_placements *placements, const iso_transform *own, const iso_box *index,
                          const iso_box *along, const iso_vec3 *vectors) {
    iso_box all = iso_box_empty();
    if (iso_box_is_empty(index)) return all;
    for (size_t i = 0; i < placements->count; i++) {
        const iso_placement *p = &placements->items[i];
        const double scale = p->scale > 0 ? p->scale : 1;
        if (!iso_placement_is_turned(p)) {
            const iso_vec3 shift = along_vectors(vectors, p->position);
            iso_box_add(&all, iso_vec3_add(iso_vec3_scale(along->lo, scale), shift));
            iso_box_add(&all, iso_vec3_add(iso_vec3_scale(along->hi, scale), shift));
            continue;
        }
        const iso_transform transform = iso_placement_transform(p, own);
        const iso_affine affine = iso_transform_affine(&transform);
        for (int corner = 0; corner < 8; corner++)
            iso_box_add(&all,
                        along_vectors(vectors, iso_affine_point(&affine, iso_box_corner(index, corner))));
    }
    return all;
}
