/* marching_cubes: the part of a mesh that lies in the cells of one brick. Internal to extract. */
#ifndef ISO_EXTRACT_MESH_MARCHING_CUBES_H
#define ISO_EXTRACT_MESH_MARCHING_CUBES_H

#include "extract/points/edge_points.h"

/* The kernel writes a few triangles past the end, see mesh_kernel.h. */
enum { ISO_BRICK_TRIANGLES = 5 * ISO_BRICK_VOXELS + 6 };

/* One brick's mesh and what is needed to make it. */
typedef struct iso_brick_mesh {
    iso_surfel vertices[ISO_EDGES_ALL];
    iso_edge_key keys[ISO_EDGES_ALL];
    uint16_t triangles[ISO_BRICK_TRIANGLES][3];
    uint16_t vertex_of[ISO_LATTICE * ISO_LATTICE * ISO_LATTICE * 3]; /* by key, where there is a vertex */
    uint32_t vertex_count, owned_count, triangle_count;
} iso_brick_mesh;

void iso_marching_cubes(const iso_brick_window *window, const iso_threshold *surface, iso_brick_mesh *mesh);

#endif
