/* edge_points: the points where the surface crosses edges between voxels. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_EDGE_POINTS_H
#define ISO_EXTRACT_POINTS_EDGE_POINTS_H

#include "extract/brick.h"

enum {
    ISO_EDGES_OWN = 3 * ISO_BRICK_VOXELS,                             /* edges that a brick owns */
    ISO_EDGES_ALL = 3 * ISO_BRICK * (ISO_BRICK + 1) * (ISO_BRICK + 1) /* edges of a brick's cells */
};

/* The caller's arrays for points, with room for ISO_EDGES_OWN (own edges only) or ISO_EDGES_ALL. */
typedef struct iso_edge_points {
    iso_surfel *points;
    iso_edge_key *keys; /* one per point; NULL: not wanted */
    uint32_t count;
    bool scaled; /* normals get |x| + |y| + |z| = 1, for iso_point_pack_scaled; else they are unit vectors */
} iso_edge_points;

/* Appends the points on edges that the brick owns, ascending in key. */
void iso_edge_points_own(const iso_brick_window *window, const iso_threshold *surface, iso_edge_points *out);

/* Appends the points on the brick's far edges, ascending in key. They are the neighbours' points, with the
 * same bits except that positions are relative to this brick. */
void iso_edge_points_far(const iso_brick_window *window, const iso_threshold *surface, iso_edge_points *out);

#endif
