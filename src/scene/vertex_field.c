/* vertex_field: the tree of triangles finds the nearest one; its corners' numbers are kept in its order. */
#include "scene/vertex_field.h"

#include <math.h>

#include "base/memory.h"
#include "grids/closing/triangle_tree.h"

typedef struct corner_value {
    float value;
    uint8_t color[3];
} corner_value;

struct iso_vertex_field {
    iso_triangle_tree *tree;
    corner_value (*corners)[3]; /* by triangle of the tree */
    bool colored, labels;
};

static iso_status fill(const iso_triangles *mesh, const float *values, const uint8_t (*colors)[3],
                       iso_vertex_field *field, iso_error *error) {
    if (!mesh->triangle_count) return iso_fail(error, ISO_ERR_EMPTY, "the mesh has no triangle");
    ISO_TRY(iso_triangle_tree_create(mesh, &field->tree, error));
    const size_t count = iso_triangle_tree_count(field->tree);
    field->corners = iso_alloc(count * sizeof *field->corners);
    if (!field->corners) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the numbers of vertices");
    for (size_t i = 0; i < count; i++) {
        const uint32_t *triangle = mesh->triangles[iso_triangle_tree_get(field->tree, i)->number];
        for (int k = 0; k < 3; k++) {
            corner_value *c = &field->corners[i][k];
            const float value = values ? values[triangle[k]] : 0;
            *c = (corner_value){isfinite(value) ? value : NAN, {0, 0, 0}};
            for (int j = 0; j < 3 && colors; j++) c->color[j] = colors[triangle[k]][j];
        }
    }
    field->colored = colors != NULL;
    field->labels = colors && values;
    return ISO_OK;
}

iso_status iso_vertex_field_create(const iso_triangles *mesh, const float *values, const uint8_t (*colors)[3],
                                   iso_vertex_field **field, iso_error *error) {
    iso_vertex_field *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the numbers of vertices");
    const iso_status status = fill(mesh, values, colors, made, error);
    if (status == ISO_OK)
        *field = made;
    else
        iso_vertex_field_destroy(made);
    return status;
}

void iso_vertex_field_destroy(iso_vertex_field *field) {
    if (!field) return;
    iso_triangle_tree_destroy(field->tree);
    iso_free(field->corners);
    iso_free(field);
}

bool iso_vertex_field_has_colors(const iso_vertex_field *field) {
    return field->colored;
}

/* The shares of a triangle's corners at its point q: the parts of its area. */
static void find_shares(const float corners[3][3], iso_vec3 q, double shares[3]) {
    iso_vec3 c[3];
    for (int k = 0; k < 3; k++)
        c[k] = iso_vec3_make((double)corners[k][0], (double)corners[k][1], (double)corners[k][2]);
    const iso_vec3 normal = iso_vec3_cross(iso_vec3_sub(c[1], c[0]), iso_vec3_sub(c[2], c[0]));
    const double area = iso_vec3_dot(normal, normal);
    for (int k = 0; k < 3; k++) {
        const iso_vec3 a = iso_vec3_sub(c[(k + 1) % 3], q), b = iso_vec3_sub(c[(k + 2) % 3], q);
        const double share = area > 0 ? iso_vec3_dot(iso_vec3_cross(a, b), normal) / area : 1 / 3.0;
        shares[k] = share > 0 ? share : 0;
    }
}

/* The mean of the corners' colours, by their shares. */
static iso_rgb mix_colors(const corner_value corners[3], const double shares[3]) {
    double sum[3] = {0.5, 0.5, 0.5}, weight = shares[0] + shares[1] + shares[2];
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++) sum[j] += shares[k] / weight * corners[k].color[j];
    return (iso_rgb){(uint8_t)sum[0], (uint8_t)sum[1], (uint8_t)sum[2]};
}

double iso_vertex_field_at(const iso_vertex_field *field, iso_vec3 point, iso_nearby *nearby,
                           iso_rgb *color) {
    iso_nearest nearest = {.squared = INFINITY, .triangle = nearby->last};
    iso_triangle_tree_nearest(field->tree, point, &nearest);
    nearby->last = nearest.triangle;
    const corner_value *corners = field->corners[nearest.triangle];
    double shares[3], sum = 0, weight = 0;
    find_shares(iso_triangle_tree_get(field->tree, nearest.triangle)->corners, nearest.point, shares);
    int most = 0;
    for (int k = 0; k < 3; k++) {
        if (shares[k] > shares[most]) most = k;
        if (isnan(corners[k].value) || !(shares[k] > 0)) continue;
        sum += shares[k] * (double)corners[k].value;
        weight += shares[k];
    }
    const corner_value *c = &corners[most];
    *color = (iso_rgb){c->color[0], c->color[1], c->color[2]};
    if (field->colored && !field->labels) *color = mix_colors(corners, shares);
    if (field->colored || isnan(c->value)) return (double)c->value;
    return sum / weight;
}
