/* triangles: computes normals with a crease angle. Corners are sorted by position, so that all corners at one
 * position are adjacent. */
#include "render/raster/triangles.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { SPAN_TRIANGLES = 256 }; /* triangles of a span, adjacent in the file: culled and clipped together */

/* The largest number of corners at one position whose normals are compared with each other. */
enum { MOST_COMPARED = 256 };

static const double CREASE_COSINE = 0.5; /* the cosine of 60 degrees */

/* A corner of a triangle: its position as sortable numbers, and its number, 3 * triangle + corner. */
typedef struct corner {
    uint32_t position[3];
    uint32_t number;
} corner;

static int compare_corners(const void *a, const void *b) {
    const corner *p = a, *q = b;
    const int order = memcmp(p->position, q->position, sizeof p->position);
    return order ? order : p->number < q->number ? -1 : p->number > q->number;
}

static iso_vec3 vertex_of(const iso_triangles *mesh, size_t triangle, int k) {
    const float *p = mesh->vertices[mesh->triangles[triangle][k]];
    return iso_vec3_make((double)p[0], (double)p[1], (double)p[2]);
}

/* Returns the normal of a triangle, with twice the triangle's area as its length. */
static iso_vec3 area_normal(const iso_triangles *mesh, size_t triangle) {
    const iso_vec3 a = vertex_of(mesh, triangle, 0);
    return iso_vec3_cross(iso_vec3_sub(vertex_of(mesh, triangle, 1), a),
                          iso_vec3_sub(vertex_of(mesh, triangle, 2), a));
}

/* ---- corners */

/* Lists the corners of the triangles that have an area; returns their number. */
static size_t list_corners(const iso_triangles *mesh, corner *corners) {
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (!(iso_vec3_length(area_normal(mesh, t)) > 0)) continue;
        for (int k = 0; k < 3; k++, count++) {
            const float *p = mesh->vertices[mesh->triangles[t][k]];
            for (int axis = 0; axis < 3; axis++) {
                const float value = p[axis] + 0.0f; /* -0 becomes 0 */
                memcpy(&corners[count].position[axis], &value, sizeof value);
            }
            corners[count].number = (uint32_t)(3 * t + (size_t)k);
        }
    }
    return count;
}

/* Returns the normal of a corner, given all corners at its position. */
static iso_vec3 corner_normal(const iso_triangles *mesh, const corner *around, size_t count,
                              size_t triangle) {
    const iso_vec3 own = area_normal(mesh, triangle), direction = iso_vec3_unit(own);
    iso_vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < count; i++) {
        const iso_vec3 other = area_normal(mesh, around[i].number / 3);
        if (iso_vec3_dot(other, direction) >= CREASE_COSINE * iso_vec3_length(other))
            sum = iso_vec3_add(sum, other);
    }
    return iso_vec3_unit(sum);
}

/* Writes the normals of the corners at one position, by corner number. */
static void set_normals(const iso_triangles *mesh, const corner *around, size_t count, iso_surfel *vertices) {
    const size_t compared = count <= MOST_COMPARED ? count : 0;
    for (size_t i = 0; i < count; i++) {
        const size_t triangle = around[i].number / 3;
        const iso_vec3 n = compared ? corner_normal(mesh, around, compared, triangle)
                                    : iso_vec3_unit(area_normal(mesh, triangle));
        float *normal = vertices[around[i].number].normal;
        normal[0] = (float)n.x;
        normal[1] = (float)n.y;
        normal[2] = (float)n.z;
    }
}

/* Moves the vertices of the triangles that have an area to the front and sets their positions; returns the
 * number of these triangles. */
static size_t pack_vertices(const iso_triangles *mesh, iso_surfel *vertices) {
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (!(iso_vec3_length(area_normal(mesh, t)) > 0)) continue;
        for (int k = 0; k < 3; k++) {
            iso_surfel *to = &vertices[3 * count + (size_t)k];
            memcpy(to->normal, vertices[3 * t + (size_t)k].normal, sizeof to->normal);
            memcpy(to->position, mesh->vertices[mesh->triangles[t][k]], sizeof to->position);
        }
        count++;
    }
    return count;
}

/* Sets spans->numbers if triangles were left out. Returns false if there is no memory. */
static bool number_triangles(const iso_triangles *mesh, size_t drawn, iso_triangle_spans *spans) {
    if (drawn == mesh->triangle_count) return true;
    spans->numbers = iso_alloc(drawn * sizeof *spans->numbers);
    if (!spans->numbers) return false;
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (iso_vec3_length(area_normal(mesh, t)) > 0) spans->numbers[count++] = (uint32_t)t;
    return true;
}

static void make_spans(iso_triangle_spans *spans, size_t triangles) {
    for (size_t first = 0; first < triangles; first += SPAN_TRIANGLES) {
        const size_t left = triangles - first, count = left < SPAN_TRIANGLES ? left : SPAN_TRIANGLES;
        spans->spans[spans->span_count++] = (iso_mesh_span){.vertex_count = (uint32_t)(3 * count),
                                                            .owned_count = (uint32_t)(3 * count),
                                                            .triangle_count = (uint32_t)count,
                                                            .first_vertex = 3 * first,
                                                            .first_triangle = first};
    }
    for (size_t t = 0; t < triangles; t++)
        for (int k = 0; k < 3; k++) spans->triangles[t][k] = (uint16_t)(3 * (t % SPAN_TRIANGLES) + (size_t)k);
}

iso_status iso_triangle_spans_make(const iso_triangles *mesh, iso_triangle_spans *spans, iso_error *error) {
    const size_t count = mesh->triangle_count;
    if (count >= UINT32_MAX / 3) return iso_fail(error, ISO_ERR_LIMIT, "%zu triangles are too many", count);
    iso_triangle_spans made = {.vertices = iso_alloc(3 * count * sizeof *made.vertices),
                               .triangles = iso_alloc(count * sizeof *made.triangles),
                               .spans = iso_alloc((count / SPAN_TRIANGLES + 1) * sizeof *made.spans)};
    corner *corners = iso_alloc(3 * count * sizeof *corners);
    if (!made.vertices || !made.triangles || !made.spans || !corners) {
        iso_free(corners);
        iso_triangle_spans_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu triangles", count);
    }
    const size_t corner_count = list_corners(mesh, corners);
    qsort(corners, corner_count, sizeof *corners, compare_corners);
    for (size_t first = 0, end; first < corner_count; first = end) {
        for (end = first + 1; end < corner_count; end++)
            if (memcmp(corners[first].position, corners[end].position, sizeof corners->position) != 0) break;
        set_normals(mesh, corners + first, end - first, made.vertices);
    }
    iso_free(corners);
    const size_t drawn = pack_vertices(mesh, made.vertices);
    if (!number_triangles(mesh, drawn, &made)) {
        iso_triangle_spans_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu triangles", count);
    }
    make_spans(&made, drawn);
    *spans = made;
    return ISO_OK;
}

void iso_triangle_spans_free(iso_triangle_spans *spans) {
    iso_free(spans->vertices);
    iso_free(spans->triangles);
    iso_free(spans->spans);
    iso_free(spans->numbers);
    *spans = (iso_triangle_spans){.span_count = 0};
}

iso_mesh_view iso_triangle_spans_view(const iso_triangle_spans *spans) {
    return (iso_mesh_view){.vertices = spans->vertices,
                           .triangles = (const uint16_t(*)[3])spans->triangles,
                           .spans = spans->spans,
                           .span_count = spans->span_count,
                           .transform = iso_transform_identity()};
}
