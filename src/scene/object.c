/* object: draws what stands beside the surfaces of a scene. */
#include "scene/object.h"

#include "base/memory.h"
#include "scene/coloring.h"

typedef struct iso_own_colors {
    iso_vertex_field *field;
    iso_coloring coloring;
} iso_own_colors;

iso_status iso_scene_object_use_vertex_colors(iso_scene_object *object, const iso_triangles *mesh,
                                              iso_error *error) {
    if (!mesh->colors) return ISO_OK;
    iso_own_colors *own = object->own_colors = iso_alloc_zero(1, sizeof *own);
    if (!own) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the colours of vertices");
    ISO_TRY(iso_vertex_field_create(mesh, NULL, (const uint8_t(*)[3])mesh->colors, &own->field, error));
    own->coloring = (iso_coloring){.source = ISO_COLOR_BY_VOLUME, .vertices = own->field};
    object->coloring = &own->coloring;
    return ISO_OK;
}

iso_box iso_scene_object_bounds(const iso_scene_object *object) {
    if (object->shapes) return iso_shapes_bounds(object->shapes);
    const iso_mesh_view mesh = iso_triangle_spans_view(&object->spans);
    return iso_mesh_view_bounds(&mesh);
}

void iso_scene_object_count(iso_scene_object *object, const iso_gbuffer *gbuffer, int surface) {
    for (size_t i = 0; i < (size_t)gbuffer->width * (size_t)gbuffer->height; i++)
        object->drawn.samples += gbuffer->surface[i] == surface;
}

iso_status iso_scene_object_draw(iso_scene_object *object, const iso_target *target, iso_pullpush *pullpush,
                                 iso_error *error) {
    if (object->pyramid_lines) {
        ISO_TRY(iso_draw_pyramid_lines(target, object->pyramid_lines, pullpush, error));
        iso_scene_object_count(object, target->gbuffer, target->surface);
        return ISO_OK;
    }
    iso_target to = *target;
    to.clip = object->clip;
    if (object->shapes) return iso_draw_shapes(&to, object->shapes, &object->drawn, error);
    const iso_mesh_view mesh = iso_triangle_spans_view(&object->spans);
    return iso_draw_mesh(&to, &mesh, error);
}

void iso_scene_object_number(const iso_scene_object *object, uint32_t surface, iso_aov *aov) {
    if (object->pyramid_lines || object->in_pyramid)
        iso_aov_unnumber(aov, surface);
    else if (object->lines)
        iso_aov_number_lines(aov, surface, object->lines);
    if (object->spans.numbers && !object->in_pyramid) iso_aov_renumber(aov, surface, object->spans.numbers);
}

void iso_scene_object_free(iso_scene_object *object) {
    iso_shapes_destroy(object->shapes);
    iso_pyramid_lines_destroy(object->pyramid_lines);
    iso_triangle_spans_free(&object->spans);
    if (object->own_colors) iso_vertex_field_destroy(object->own_colors->field);
    iso_free(object->own_colors);
    *object = (iso_scene_object){.shapes = NULL};
}
