/* line_normals: directions of lines at their vertices, and normals that turn with them as little as possible.
 */
#include <math.h>
#include <string.h>

#include "base/lines.h"
#include "base/memory.h"

static iso_vec3 load(const float v[3]) {
    return iso_vec3_make((double)v[0], (double)v[1], (double)v[2]);
}

static void store(iso_vec3 v, float to[3]) {
    to[0] = (float)v.x, to[1] = (float)v.y, to[2] = (float)v.z;
}

/* Returns v with unit length, or 0 if its length is 0 or not finite. */
static iso_vec3 unit_or_zero(iso_vec3 v) {
    const double length = iso_vec3_length(v);
    return length > 0 && isfinite(length) ? iso_vec3_scale(v, 1 / length) : iso_vec3_make(0, 0, 0);
}

static bool is_zero(iso_vec3 v) {
    return v.x == 0 && v.y == 0 && v.z == 0;
}

/* ---- tangents */

/* Goes backwards along a line and stores at each vertex the direction of the first segment after it that has
 * a length. */
static void store_directions_after(const iso_lines *lines, size_t line, float *tangents, size_t stride) {
    iso_vec3 after = iso_vec3_make(0, 0, 0);
    for (size_t i = lines->starts[line + 1]; i-- > lines->starts[line];) {
        if (i + 1 < lines->starts[line + 1]) {
            const iso_vec3 path = iso_vec3_sub(load(lines->vertices[i + 1]), load(lines->vertices[i])),
                           direction = unit_or_zero(path);
            if (!is_zero(direction)) after = direction;
        }
        store(after, tangents + i * stride);
    }
}

/* Goes forwards along a line and stores at each vertex the bisector of this direction and the one before.
 * Where the line turns back by 180 degrees, the direction before is kept. */
static void store_bisectors(const iso_lines *lines, size_t line, float *tangents, size_t stride) {
    iso_vec3 before = iso_vec3_make(0, 0, 0);
    for (size_t i = lines->starts[line]; i < lines->starts[line + 1]; i++) {
        const iso_vec3 after = load(tangents + i * stride), both = iso_vec3_add(before, after);
        const bool turns_back = !(iso_vec3_dot(both, both) > 1e-12);
        store(turns_back ? before : unit_or_zero(both), tangents + i * stride);
        if (i + 1 == lines->starts[line + 1]) break;
        if (memcmp(lines->vertices[i], lines->vertices[i + 1], sizeof lines->vertices[i]) != 0)
            before = after;
    }
}

void iso_lines_tangents(const iso_lines *lines, float *tangents, size_t stride) {
    for (size_t line = 0; line < lines->line_count; line++) {
        store_directions_after(lines, line, tangents, stride);
        store_bisectors(lines, line, tangents, stride);
    }
}

/* ---- normals */

/* Returns a unit vector perpendicular to a tangent. */
static iso_vec3 across(iso_vec3 tangent) {
    const double x = fabs(tangent.x), y = fabs(tangent.y), z = fabs(tangent.z);
    const iso_vec3 least =
        iso_vec3_make(x <= y && x <= z, !(x <= y && x <= z) && y <= z, !(x <= y && x <= z) && !(y <= z));
    return unit_or_zero(iso_vec3_cross(tangent, least));
}

/* Mirrors a vector at the plane perpendicular to `axis`; returns it unchanged if `axis` is 0. */
static iso_vec3 mirror(iso_vec3 v, iso_vec3 axis) {
    const double square = iso_vec3_dot(axis, axis);
    if (!(square > 0)) return v;
    return iso_vec3_sub(v, iso_vec3_scale(axis, 2 * iso_vec3_dot(axis, v) / square));
}

/* Returns the normal at the next vertex: applies the two reflections that map the tangent at this vertex to
 * the next one. */
static iso_vec3 next_normal(iso_vec3 normal, iso_vec3 tangent, iso_vec3 path, iso_vec3 next_tangent) {
    const iso_vec3 turned = mirror(normal, path), tangent_turned = mirror(tangent, path);
    const iso_vec3 next = mirror(turned, iso_vec3_sub(next_tangent, tangent_turned));
    /* removes the rounding errors that add up along a line of many vertices */
    return unit_or_zero(iso_vec3_sub(next, iso_vec3_scale(next_tangent, iso_vec3_dot(next, next_tangent))));
}

static void add_normals_of(iso_lines *lines, size_t line, const float (*tangents)[3]) {
    iso_vec3 normal = iso_vec3_make(0, 0, 0);
    for (size_t i = lines->starts[line]; i < lines->starts[line + 1]; i++) {
        const iso_vec3 tangent = load(tangents[i]);
        if (i > lines->starts[line]) {
            const iso_vec3 path = iso_vec3_sub(load(lines->vertices[i]), load(lines->vertices[i - 1]));
            normal = next_normal(normal, load(tangents[i - 1]), path, tangent);
        }
        if (is_zero(normal)) normal = across(tangent);
        store(normal, lines->normals[i]);
    }
}

iso_status iso_lines_add_normals(iso_lines *lines, iso_error *error) {
    if (lines->normals) return ISO_OK;
    float(*normals)[3] = iso_alloc(lines->vertex_count * sizeof *normals),
    (*tangents)[3] = iso_alloc(lines->vertex_count * sizeof *tangents);
    if (!normals || !tangents) {
        iso_free(normals);
        iso_free(tangents);
        return iso_fail_memory(error, "normals of lines");
    }
    iso_lines_tangents(lines, tangents[0], 3);
    lines->normals = normals;
    for (size_t line = 0; line < lines->line_count; line++)
        add_normals_of(lines, line, (const float(*)[3])tangents);
    iso_free(tangents);
    return ISO_OK;
}
