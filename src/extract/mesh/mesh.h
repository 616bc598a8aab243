/* mesh: Marching Cubes with shared, indexed vertices, one span per brick, and only what changed after the
 * first time.
 *
 * Corners at or above the isovalue are inside; ambiguous faces keep corners at or above it apart, as VTK
 * does. The vertices are the edge points of extract/points/points.h, bit for bit and in their order; vertices
 * on the far faces of a brick are copies of the neighbour's. Vertices that no cell uses (in a volume one
 * voxel thick, or next to a voxel that is not finite) are there all the same. Cells that touch a NaN or
 * infinite voxel have no triangles. Triangles are counter-clockwise seen from outside (lower values; higher
 * ones for level sets). The case table is made at build time by tools/make_mc_table.c. Lorensen and Cline
 * 1987; Baerentzen and Christensen 2003, section 5. */
#ifndef ISO_EXTRACT_MESH_MESH_H
#define ISO_EXTRACT_MESH_MESH_H

#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_mesh_opts {
    double isovalue; /* physical (grids/grid.h): of a level set, mm */
    iso_pool *pool;  /* borrowed until destroy; NULL: the calling thread */
} iso_mesh_opts;

/* A consumer of a grid's change log that owns the mesh. Not thread-safe; different sets are independent. */
typedef struct iso_mesh_set iso_mesh_set;

/* The grid is borrowed until destroy. ISO_ERR_USAGE: isovalue not finite. */
iso_status iso_mesh_set_create(const iso_grid *grid, const iso_mesh_opts *opts, iso_mesh_set **set,
                               iso_error *error);
void iso_mesh_set_destroy(iso_mesh_set *set);

/* As iso_point_set_update. */
iso_status iso_mesh_set_update(iso_mesh_set *set, iso_error *error);
void iso_mesh_set_isovalue(iso_mesh_set *set, double isovalue);

/* The mesh, borrowed until the next update or destroy. */
iso_mesh_view iso_mesh_set_view(const iso_mesh_set *set);

/* As iso_point_set_bound: bounds of each span with the normals of its triangles, and whether they are whole
 * surfaces. */
iso_status iso_mesh_set_bound(iso_mesh_set *set, iso_error *error);

/* One flat array of welded vertices and triangles, for export and measuring: vertices in index coordinates
 * (not brick-relative), in span order; duplicates replaced by their owner. Arrays are owned by the caller:
 * iso_weld_free. ISO_ERR_USAGE when a copy has no owner: the last update had failed. */
typedef struct iso_weld {
    iso_surfel *vertices;
    uint32_t (*triangles)[3];
    size_t vertex_count, triangle_count;
} iso_weld;

/* ISO_ERR_LIMIT above 2^32 - 1 vertices, ISO_ERR_NOMEM. */
iso_status iso_mesh_weld(const iso_mesh_view *view, iso_weld *weld, iso_error *error);
/* Moves the vertices of a mesh welded from `view` along their edges, so that each is at least `distance`
 * (voxels, below 1/2) from the edge's ends. Vertices of different edges are then in different places, also
 * when voxels have exactly the isovalue: files that keep no indices, such as .stl, hold the same mesh. */
void iso_weld_separate(const iso_mesh_view *view, double distance, iso_weld *weld);
void iso_weld_free(iso_weld *weld);

#ifdef __cplusplus
}
#endif
#endif
