/* mesh_rings: divides a mesh into pieces, and each piece into rings of vertices that are equally many edges away from
 * one of its ends. Internal to extract/lines. */
#ifndef ISO_EXTRACT_LINES_MESH_RINGS_H
#define ISO_EXTRACT_LINES_MESH_RINGS_H

#include "base/geometry.h"
#include "grids/closing/mesh_topology.h"

#define ISO_NO_RING UINT32_MAX

/* A connected component of the mesh. */
typedef struct iso_mesh_piece {
    size_t vertices, triangles, open_edges, outline; /* outline: vertices on open edges */
    uint32_t loops;
    iso_vec3 facing; /* the sum of its triangles' normals, each as long as its area, mm^2 */
    double area;     /* mm^2 */
    bool sheet;      /* flat, or without inner vertices, and with one outline */
} iso_mesh_piece;

/* Vertices, members[first] and following, that are equally many edges away from the piece's end, and joined. */
typedef struct iso_mesh_ring {
    iso_vec3 at;   /* mm: the mean of its vertices at first */
    double radius; /* mm: their mean distance from there at first; of a lid that of its loop's */
    double reach;  /* mm: the greatest distance */
    uint32_t piece;
    uint32_t first, count;
    bool lid; /* not of vertices: the middle of an open loop, as if a lid closed it */
} iso_mesh_ring;

/* Zero-initialise; iso_mesh_rings_free. Rings of a piece follow one another, by their distance from its end. */
typedef struct iso_mesh_rings {
    const iso_mesh_topology *topology; /* borrowed */
    iso_mesh_piece *pieces;
    iso_mesh_ring *rings;
    size_t piece_count, ring_count;
    size_t *first_ring;  /* piece_count + 1 */
    uint32_t *piece;     /* of each vertex */
    uint32_t *ring;      /* of each vertex */
    uint32_t *members;   /* vertices, by ring */
    bool *open;          /* of each vertex: it is on an open edge */
    size_t *around_first; /* vertices + 1: of each vertex the triangles around it, */
    uint32_t *around;     /* in this array */
    size_t *link_first; /* ring_count + 1: of each ring those that edges of the mesh join it to, */
    uint32_t *links;    /* in this array, from low to high */
} iso_mesh_rings;

/* ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^31 vertices or more. O(n log n). */
iso_status iso_mesh_rings_make(const iso_mesh_topology *topology, iso_mesh_rings *rings, iso_error *error);
void iso_mesh_rings_free(iso_mesh_rings *rings);

static inline iso_vec3 iso_mesh_vertex(const iso_triangles *mesh, size_t i) {
    const float *v = mesh->vertices[i];
    return iso_vec3_make((double)v[0], (double)v[1], (double)v[2]);
}

/* The normal of a triangle, as long as its area. */
iso_vec3 iso_mesh_triangle_area(const iso_triangles *mesh, size_t triangle);

#endif
