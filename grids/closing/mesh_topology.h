/* mesh_topology: joins the vertices of a triangle mesh, orients its triangles consistently, and finds its
 * open loops. */
#ifndef ISO_GRIDS_CLOSING_MESH_TOPOLOGY_H
#define ISO_GRIDS_CLOSING_MESH_TOPOLOGY_H

#include "base/primitives.h"
#include "base/status.h"

/* Zero-initialise; iso_mesh_topology_free when done. */
typedef struct iso_mesh_topology {
    iso_triangles mesh; /* owned: equal positions are one vertex; no triangle twice */
    uint32_t (
        *open)[2]; /* owned: edges with a triangle on one side only, in the direction that they have there */
    size_t open_count, loops; /* numbers of open edges, and of the loops that they form */
    uint32_t *loop_vertices;  /* owned: the vertices of all loops, one loop after the other */
    size_t *loop_first;       /* owned: loops + 1 indices into loop_vertices */
    size_t turned;            /* triangles that were turned to face as their neighbours do */
} iso_mesh_topology;

/* Joins corners with equal positions. Drops triangles with two equal corners; keeps one of several equal
 * triangles, and none of two that face opposite ways, as they enclose nothing. Turns the triangles of each
 * connected part to face as most of its area does. The remaining open edges form closed loops in which no
 * vertex occurs twice. O(n). `path` is used in messages. ISO_ERR_NOMEM; ISO_ERR_LIMIT: over 2^30 triangles;
 * ISO_ERR_EMPTY: no triangle is left. */
iso_status iso_mesh_topology_make(const char *path, const iso_triangles *mesh, iso_mesh_topology *topology,
                                  iso_error *error);
void iso_mesh_topology_free(iso_mesh_topology *topology);

/* partner[3 t + k]: the number of the half-edge that shares its edge with that of triangle t from its corner
 * k to the next one; ISO_NO_PARTNER: the edge has one triangle, or more than two. Half-edges in the same
 * direction can be partners, too: then the triangles face opposite ways. Returns false if there is no
 * memory. */
#define ISO_NO_PARTNER UINT32_MAX
bool iso_mesh_partners(const iso_triangles *mesh, uint32_t *partner);

#endif
