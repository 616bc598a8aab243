/* Meshes of several parts, each with its place: what .glb and .3mf share. */
#include "io/mesh/placed_parts.h"

/* More vertices than the file has bytes come from parts that are used again; this many of them are
 * allowed. */
enum { MOST_REPEATED = 1 << 24 };

static iso_status check_count(const iso_mesh_reading *r, size_t count, iso_error *error) {
    if (count < MOST_REPEATED || (double)count < r->bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT,
                    "%s: its parts are used so often that it has more than %d million vertices or triangles",
                    r->path, MOST_REPEATED >> 20);
}

iso_vec3 iso_mesh_place_point(const iso_mesh_place *place, iso_vec3 p) {
    const double *m = place->m;
    return iso_vec3_make(m[0] * p.x + m[1] * p.y + m[2] * p.z + place->origin.x,
                         m[3] * p.x + m[4] * p.y + m[5] * p.z + place->origin.y,
                         m[6] * p.x + m[7] * p.y + m[8] * p.z + place->origin.z);
}

iso_mesh_place iso_mesh_place_within(const iso_mesh_place *outer, const iso_mesh_place *inner) {
    iso_mesh_place place = {.origin = iso_mesh_place_point(outer, inner->origin)};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            for (int k = 0; k < 3; k++)
                place.m[3 * row + column] += outer->m[3 * row + k] * inner->m[3 * k + column];
    return place;
}

iso_mesh_part iso_mesh_part_begin(const iso_mesh_reading *r, const iso_mesh_place *place) {
    const double *m = place->m;
    const iso_vec3 x = {m[0], m[3], m[6]}, y = {m[1], m[4], m[7]}, z = {m[2], m[5], m[8]};
    return (iso_mesh_part){*place, r->vertex_count, iso_vec3_dot(iso_vec3_cross(x, y), z) < 0};
}

iso_status iso_mesh_part_vertex(iso_mesh_reading *r, const iso_mesh_part *part, iso_vec3 p,
                                iso_error *error) {
    double placed[3];
    ISO_TRY(check_count(r, r->vertex_count, error));
    iso_vec3_store(iso_mesh_place_point(&part->place, p), placed);
    return iso_mesh_add_vertex(r, placed, error);
}

iso_status iso_mesh_part_triangle(iso_mesh_reading *r, const iso_mesh_part *part, const uint64_t corners[3],
                                  iso_error *error) {
    uint32_t all[3];
    ISO_TRY(check_count(r, r->triangle_count, error));
    for (int i = 0; i < 3; i++) {
        if (corners[i] >= r->vertex_count - part->first)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a triangle names vertex %llu of %zu", r->path,
                            (unsigned long long)corners[i], r->vertex_count - part->first);
        all[i] = (uint32_t)(part->first + corners[i]);
    }
    return part->mirrored ? iso_mesh_add_triangle(r, all[0], all[2], all[1], error)
                          : iso_mesh_add_triangle(r, all[0], all[1], all[2], error);
}
