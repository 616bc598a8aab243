/* Finds the angles between neighbouring triangles. */
#include "grids/closing/triangle_reach.h"

#include <math.h>

#include "base/memory.h"
#include "grids/closing/mesh_topology.h"

/* An edge is sharp if the angle between its triangles has a larger sine than this. */
static const float SHARP = 0.5f;
/* Added to sines, for the rounding of normals. */
static const float ROUNDING = 1e-5f;

/* Returns twice the area vector of a triangle; *longest: the square of its longest side. */
static iso_vec3 area_vector(const iso_triangles *mesh, size_t triangle, double *longest) {
    iso_vec3 p[3];
    for (int k = 0; k < 3; k++) {
        const float *v = mesh->vertices[mesh->triangles[triangle][k]];
        p[k] = iso_vec3_make(v[0], v[1], v[2]);
    }
    const iso_vec3 ab = iso_vec3_sub(p[1], p[0]), ac = iso_vec3_sub(p[2], p[0]),
                   bc = iso_vec3_sub(p[2], p[1]);
    const double sides[3] = {iso_vec3_dot(ab, ab), iso_vec3_dot(ac, ac), iso_vec3_dot(bc, bc)};
    *longest = sides[0];
    for (int k = 1; k < 3; k++) *longest = sides[k] > *longest ? sides[k] : *longest;
    return iso_vec3_cross(ab, ac);
}

static bool is_area(iso_vec3 vector, double longest) {
    return iso_vec3_dot(vector, vector) > 1e-14 * longest * longest;
}

bool iso_triangle_has_area(const iso_triangles *mesh, size_t triangle) {
    double longest;
    const iso_vec3 vector = area_vector(mesh, triangle, &longest);
    return is_area(vector, longest);
}

/* Sets the unit normal of each triangle; (0, 0, 0) for those without area. */
static void find_normals(const iso_triangles *mesh, float (*normals)[3]) {
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double longest;
        const iso_vec3 vector = area_vector(mesh, t, &longest);
        const double scale = is_area(vector, longest) ? 1 / iso_vec3_length(vector) : 0;
        normals[t][0] = (float)(vector.x * scale);
        normals[t][1] = (float)(vector.y * scale);
        normals[t][2] = (float)(vector.z * scale);
    }
}

/* The sine of the angle between two triangles that share an edge, whose normals point to the same side if
 * `same`; 1 if the edge is sharp. */
static float sine_between(const float a[3], const float b[3], bool same) {
    const float dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const float x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    const float sine = sqrtf(x * x + y * y + z * z) + ROUNDING;
    return (same ? dot : -dot) > 0.5f && sine <= SHARP ? sine : 1;
}

/* The sine at the half-edge of triangle t from its corner k. */
static float sine_at(const iso_triangles *mesh, const float (*normals)[3], const uint32_t *partner,
                     uint32_t t, uint32_t k) {
    const uint32_t other = partner[3 * t + k];
    if (other == ISO_NO_PARTNER) return 1;
    const bool same = mesh->triangles[other / 3][other % 3] != mesh->triangles[t][k];
    return sine_between(normals[t], normals[other / 3], same);
}

bool iso_triangle_reaches(const iso_triangles *mesh, float *reaches) {
    uint32_t *partner = iso_alloc(3 * mesh->triangle_count * sizeof *partner);
    float(*normals)[3] = iso_alloc(mesh->triangle_count * sizeof *normals);
    const bool whole = partner && normals && iso_mesh_partners(mesh, partner);
    if (whole) {
        find_normals(mesh, normals);
        for (uint32_t t = 0; t < mesh->triangle_count; t++) {
            reaches[t] = 0;
            for (uint32_t k = 0; k < 3; k++)
                reaches[t] = fmaxf(reaches[t], sine_at(mesh, (const float(*)[3])normals, partner, t, k));
        }
    }
    iso_free(partner);
    iso_free(normals);
    return whole;
}
