/* placed_parts: meshes of several parts, each of which has its place in the file's scene and may be there
 * more than once. Internal to src/io/mesh. */
#ifndef ISO_IO_MESH_PLACED_PARTS_H
#define ISO_IO_MESH_PLACED_PARTS_H

#include "base/geometry.h"
#include "io/mesh/mesh_format.h"

/* Where a part lies: a point p of it is at m p + origin. Row-major. */
typedef struct iso_mesh_place {
    double m[9];
    iso_vec3 origin;
} iso_mesh_place;

iso_vec3 iso_mesh_place_point(const iso_mesh_place *place, iso_vec3 p);
/* The place of something with the place `inner` in a thing with the place `outer`. */
iso_mesh_place iso_mesh_place_within(const iso_mesh_place *outer, const iso_mesh_place *inner);

/* A part that is being added: its vertices, then its triangles, whose corners count from its first vertex. A
 * mirrored one has its triangles turned, so that their fronts stay outside. */
typedef struct iso_mesh_part {
    iso_mesh_place place;
    size_t first;
    bool mirrored;
} iso_mesh_part;

iso_mesh_part iso_mesh_part_begin(const iso_mesh_reading *r, const iso_mesh_place *place);
/* Adds to the mesh. Errors of iso_mesh_add_vertex and iso_mesh_add_triangle; ISO_ERR_LIMIT: the parts are
 * repeated beyond measure, by r->bytes; ISO_ERR_FORMAT: a corner is no vertex of the part. */
iso_status iso_mesh_part_vertex(iso_mesh_reading *r, const iso_mesh_part *part, iso_vec3 p, iso_error *error);
iso_status iso_mesh_part_triangle(iso_mesh_reading *r, const iso_mesh_part *part, const uint64_t corners[3],
                                  iso_error *error);

#endif
