/* mesh_topology: a triangle mesh whose corners are shared, and where it is open. */
#ifndef ISO_GRIDS_CLOSING_MESH_TOPOLOGY_H
#define ISO_GRIDS_CLOSING_MESH_TOPOLOGY_H

#include "base/primitives.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise; iso_mesh_topology_free when done. */
typedef struct iso_mesh_topology {
    iso_triangles mesh;       /* owned: equal positions are one vertex; no triangle twice */
    uint32_t (*open)[2];      /* owned: edges without a partner, directed as their triangle has them */
    size_t open_count, loops; /* loops that the open edges form */
    uint32_t *loop_vertices;  /* owned: the loops' vertices, one loop after the other */
    size_t *loop_first;       /* owned: loops + 1 entries into loop_vertices */
    size_t turned;            /* triangles that were turned over, as their neighbours face the other way */
} iso_mesh_topology;

/* Corners of equal position are joined. Triangles with two equal corners are left out, of equal triangles one
 * stays, and two equal ones that face opposite ways are both left out: they enclose nothing between them.
 * Within a connected part triangles are turned to face as most of its area does. What is then left open forms
 * closed loops in which no vertex occurs twice. O(n). ISO_ERR_NOMEM, ISO_ERR_LIMIT (over 2^30 triangles),
 * ISO_ERR_EMPTY (no triangle is left). `path` is for messages. */
iso_status iso_mesh_topology_make(const char *path, const iso_triangles *mesh, iso_mesh_topology *topology,
                                  iso_error *error);
void iso_mesh_topology_free(iso_mesh_topology *topology);

#ifdef __cplusplus
}
#endif
#endif
