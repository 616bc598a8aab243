/* lines: freeing, bounds, tangents, and the usual radius. */
#include "base/lines.h"

#include "base/memory.h"

void iso_attributes_free(iso_attribute *attributes, int count) {
    for (int i = 0; i < count; i++) {
        iso_free(attributes[i].name);
        iso_free(attributes[i].values);
    }
    iso_free(attributes);
}

iso_vec3 iso_origin_for(const double first[3]) {
    double origin[3];
    for (int axis = 0; axis < 3; axis++)
        origin[axis] = fabs(first[axis]) > 4096 ? floor(first[axis] + 0.5) : 0;
    return iso_vec3_make(origin[0], origin[1], origin[2]);
}

iso_box iso_positions_bounds(iso_vec3 origin, const float (*positions)[3], size_t count) {
    iso_box box = iso_box_empty();
    for (size_t i = 0; i < count; i++) {
        const float *p = positions[i];
        iso_box_add(&box, iso_vec3_add(origin, iso_vec3_make((double)p[0], (double)p[1], (double)p[2])));
    }
    return box;
}

void iso_lines_free(iso_lines *lines) {
    iso_free(lines->vertices);
    iso_free(lines->starts);
    iso_free(lines->radii);
    iso_free(lines->normals);
    iso_free(lines->colors);
    iso_attributes_free(lines->attributes, lines->attribute_count);
    *lines = (iso_lines){.line_count = 0};
}

iso_box iso_lines_bounds(const iso_lines *lines) {
    return iso_positions_bounds(lines->origin, (const float(*)[3])lines->vertices, lines->vertex_count);
}

size_t iso_lines_segment_count(const iso_lines *lines) {
    size_t segments = 0;
    for (size_t i = 0; i < lines->line_count; i++) {
        const size_t vertices = lines->starts[i + 1] - lines->starts[i];
        segments += vertices ? vertices - 1 : 0;
    }
    return segments;
}

double iso_lines_usual_radius(const iso_lines *lines) {
    double length = 0;
    for (size_t line = 0; line < lines->line_count; line++)
        for (size_t i = lines->starts[line] + 1; i < lines->starts[line + 1]; i++) {
            const float *a = lines->vertices[i - 1], *b = lines->vertices[i];
            length += iso_vec3_length(iso_vec3_make((double)b[0] - (double)a[0], (double)b[1] - (double)a[1],
                                                    (double)b[2] - (double)a[2]));
        }
    const iso_box box = iso_lines_bounds(lines);
    const size_t segments = iso_lines_segment_count(lines);
    const double half = segments ? length / (double)segments / 2 : 0,
                 most = iso_vec3_length(iso_vec3_sub(box.hi, box.lo)) / 300, radius = fmin(half, most);
    return radius > 0 ? radius : 1; /* a single point, of no size */
}
