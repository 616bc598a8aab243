/* edge_points: the points where the surface crosses edges between voxels. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_EDGE_POINTS_H
#define ISO_EXTRACT_POINTS_EDGE_POINTS_H

#include "extract/brick.h"

enum {
    ISO_EDGES_OWN = 3 * ISO_BRICK_VOXELS,                             /* that a brick owns */
    ISO_EDGES_ALL = 3 * ISO_BRICK * (ISO_BRICK + 1) * (ISO_BRICK + 1) /* that its cells have */
};

/* Where points go: room for ISO_EDGES_OWN (own edges only) or ISO_EDGES_ALL. */
typedef struct iso_edge_points {
    iso_surfel *points;
    iso_edge_key *keys; /* one per point; NULL: not wanted */
    uint32_t count;
    bool scaled; /* normals with |x| + |y| + |z| = 1, for iso_point_pack_scaled, instead of unit ones */
} iso_edge_points;

/* Appends the points on edges that the brick owns, ascending in key. */
void iso_edge_points_own(const iso_brick_window *window, const iso_threshold *surface, iso_edge_points *out);

/* Appends the points on edges of the brick's cells that neighbours own: bit-identical to the neighbours'
 * points, up to the 16 voxels between the bricks; ascending in key. */
void iso_edge_points_far(const iso_brick_window *window, const iso_threshold *surface, iso_edge_points *out);

#endif
