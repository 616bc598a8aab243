/* mesh_rings: divides a mesh into pieces, and each piece into rings of vertices that are equally many
 * edges away from one of its ends. Internal to extract/lines. */
#ifndef ISO_EXTRACT_LINES_MESH_RINGS_H
#define ISO_EXTRACT_LINES_MESH_RINGS_H

#include "base/geometry.h"
#include "grids/closing/mesh_topology.h"

#define ISO_NO_RING UINT32_MAX

/* A connected component of the mesh. */
typedef struct iso_mesh_piece {
    size_t vertices, triangles, open_edges, outline; /* outline: vertices on open edges */
    uint32_t loops;
    iso_vec3 facing;  /* the sum of its triangles' normals, each as long as its area, mm^2 */
    double area;      /* mm^2 */
    bool sheet;       /* flat, or without inner vertices, and with one outline */
    bool by_distance; /* its rings are by distance along the surface, not by numbers of edges */
} iso_mesh_piece;

/* Vertices, members[first] and following, that are equally many edges away from the piece's end, and
 * joined. */
typedef struct iso_mesh_ring {
    iso_vec3 at;   /* mm: the mean of its vertices at first */
    double radius; /* mm: their mean distance from there at first; of a lid that of its loop's */
    double reach;  /* mm: the greatest distance */
    uint32_t piece;
    uint32_t first, count;
    bool lid; /* not of vertices: the middle of an open loop, as if a lid closed it */
} iso_mesh_ring;

/* Zero-initialise; iso_mesh_rings_free. Rings of a piece follow one another, by their distance from its
 * end. */
typedef struct iso_mesh_rings {
    const iso_mesh_topology *topology; /* borrowed */
    iso_mesh_piece *pieces;
    iso_mesh_ring *rings;
    size_t piece_count, ring_count;
    size_t *first_ring;   /* piece_count + 1 */
    uint32_t *piece;      /* of each vertex */
    uint32_t *ring;       /* of each vertex */
    uint32_t *members;    /* vertices, by ring */
    bool *open;           /* of each vertex: it is on an open edge */
    size_t *around_first; /* vertices + 1: of each vertex the triangles around it, */
    uint32_t *around;     /* in this array */
    size_t *link_first;   /* ring_count + 1: of each ring those that edges of the mesh join it to, */
    uint32_t *links;      /* in this array, from low to high */
} iso_mesh_rings;

/* by_distance[i]: the rings of piece i are vertices that are equally far from its end, measured along
 * the surface, not equally many edges; NULL: of none. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^31 vertices or
 * more. O(n log n). */
iso_status iso_mesh_rings_make(const iso_mesh_topology *topology, const bool *by_distance,
                               iso_mesh_rings *rings, iso_error *error);
void iso_mesh_rings_free(iso_mesh_rings *rings);

/* Whether the rings of a piece cross each other: a ring reaches farther along the branch than to its
 * neighbours. Edges of a mesh that was not made of rings count paths of different lengths. */
bool iso_mesh_rings_cross(const iso_mesh_rings *rings, size_t piece);

static inline iso_vec3 iso_mesh_vertex(const iso_triangles *mesh, size_t i) {
    const float *v = mesh->vertices[i];
    return iso_vec3_make((double)v[0], (double)v[1], (double)v[2]);
}

/* Everything that surface distances need of a mesh, and their results. Arrays of `places`, of which
 * those from mesh->vertex_count on are lids of loops. */
typedef struct iso_mesh_distances {
    const iso_mesh_topology *topology;
    const size_t *around_first;
    const uint32_t *around, *lid; /* lid: of each vertex, or ISO_NO_RING */
    double *distance;             /* mm; INFINITY: not reached */
    bool *done;
    uint32_t *heap, *heap_at; /* heap_at: of each place */
    size_t heaped;
} iso_mesh_distances;

/* Finds the distances along the surface from one place to all that it is connected to, which are written to
 * `order`, near ones first; returns how many these are. Distances have to be INFINITY before, and done false.
 * Fast marching (Kimmel and Sethian 1998, "Computing geodesic paths on manifolds"), with virtual sources. */
size_t iso_mesh_distances_from(iso_mesh_distances *d, uint32_t from, uint32_t *order);

/* The normal of a triangle, as long as its area. */
iso_vec3 iso_mesh_triangle_area(const iso_triangles *mesh, size_t triangle);

#endif
