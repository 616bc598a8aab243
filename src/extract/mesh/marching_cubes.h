/* marching_cubes: the part of a mesh that lies in the cells of one brick. Internal to extract. */
#ifndef ISO_EXTRACT_MESH_MARCHING_CUBES_H
#define ISO_EXTRACT_MESH_MARCHING_CUBES_H

#include "extract/points/edge_points.h"

/* Room for the largest possible number of triangles of a brick, and for those that the kernel writes past the
 * end (ISO_TRIANGLE_SLACK). */
enum { ISO_BRICK_TRIANGLES = 5 * ISO_BRICK_VOXELS + 6 };

/* One brick's mesh, with room for the largest possible one. owned_count: number of vertices on the brick's
 * own edges, which come first. */
typedef struct iso_brick_mesh {
    iso_surfel vertices[ISO_EDGES_ALL];
    iso_edge_key keys[ISO_EDGES_ALL];
    uint16_t triangles[ISO_BRICK_TRIANGLES][3];
    uint16_t vertex_of[ISO_LATTICE * ISO_LATTICE * ISO_LATTICE * 3]; /* by key: number of the edge's vertex */
    uint32_t vertex_count, owned_count, triangle_count;
} iso_brick_mesh;

/* Computes a brick's mesh: first the vertices on its own edges, then those on far edges, then the
 * triangles. */
void iso_marching_cubes(const iso_brick_window *window, const iso_threshold *surface, iso_brick_mesh *mesh);

#endif
