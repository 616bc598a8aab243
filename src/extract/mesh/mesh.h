/* mesh: Marching Cubes with shared, indexed vertices, one span per brick; after the first time only the
 * bricks that changed are extracted.
 *
 * Corners at or above the isovalue are inside; on ambiguous faces these corners are separated, as VTK does.
 * The vertices are the edge points of extract/points/points.h, with the same bits and order; a span also
 * has copies of the neighbours' vertices on its brick's far faces. Vertices that no triangle uses (in a
 * volume one voxel thick, or next to a voxel that is not finite) are included. Cells with a NaN or infinite
 * corner have no triangles. Triangles are counter-clockwise seen from outside (lower values; higher ones
 * for level sets). The case table is made at build time by tools/make_mc_table.c. Sources: Lorensen and
 * Cline 1987; Baerentzen and Christensen 2003, section 5. */
#ifndef ISO_EXTRACT_MESH_MESH_H
#define ISO_EXTRACT_MESH_MESH_H

#include "base/c_linkage.h"
#include "base/parallel.h"
#include "base/primitives.h"
#include "grids/grid.h"
#include "grids/grid_chunk.h"

ISO_C_BEGIN

typedef struct iso_mesh_opts {
    double isovalue; /* physical (grids/grid.h): of a level set, mm */
    iso_pool *pool;  /* borrowed until destroy; NULL: the calling thread */
    /* The grid is that of this chunk: the spans are those of the chunk's bricks, numbered as in the whole.
     * Copied. Edits are not followed. NULL: the grid is the whole. */
    const iso_grid_chunk *chunk;
} iso_mesh_opts;

/* Owns the mesh of a surface, and follows the grid's change log. Not thread-safe; different sets are
 * independent. */
typedef struct iso_mesh_set iso_mesh_set;

/* Creates an empty set; iso_mesh_set_update extracts the mesh. The grid is borrowed until
 * iso_mesh_set_destroy. ISO_ERR_USAGE: isovalue not finite. */
iso_status iso_mesh_set_create(const iso_grid *grid, const iso_mesh_opts *opts, iso_mesh_set **set,
                               iso_error *error);
void iso_mesh_set_destroy(iso_mesh_set *set);

/* Like iso_point_set_update and iso_point_set_isovalue (extract/points/points.h). */
iso_status iso_mesh_set_update(iso_mesh_set *set, iso_error *error);
void iso_mesh_set_isovalue(iso_mesh_set *set, double isovalue);

/* The mesh, borrowed until the next update or destroy. */
iso_mesh_view iso_mesh_set_view(const iso_mesh_set *set);

/* Like iso_point_set_bound: computes the bounds of each span, with the normals of its triangles, and
 * whether the surface is closed. */
iso_status iso_mesh_set_bound(iso_mesh_set *set, iso_error *error);

/* A whole mesh as one array of vertices and one of triangles, for export and measuring. Vertices are in
 * index coordinates (not relative to bricks), in span order, each once: copies are replaced by the vertex
 * of the brick that owns the edge. The caller frees the arrays with iso_weld_free. */
typedef struct iso_weld {
    iso_surfel *vertices;
    uint32_t (*triangles)[3];
    size_t vertex_count, triangle_count;
    uint8_t (*colors)[3]; /* red, green and blue of each vertex, display values; NULL: none */
} iso_weld;

/* Welds the spans of a mesh, and asks the watch of `pool` (NULL is fine) whether to go on. ISO_ERR_LIMIT:
 * more than 2^32 - 1 vertices; ISO_ERR_USAGE: a copy of a vertex has no owner, because the last update of
 * the set failed; ISO_ERR_IO: cancelled; ISO_ERR_NOMEM. */
iso_status iso_mesh_weld(const iso_mesh_view *view, iso_pool *pool, iso_weld *weld, iso_error *error);
/* Welds a part of a mesh: the spans of the bricks in `box` (NULL: all), whose vertices and triangles are in
 * span order. first[span]: the number of each span's first own vertex in the whole mesh, which the
 * triangles refer to. The view also has the spans of the bricks next to the box (+1 on each axis) that
 * belong to the whole. Errors as iso_mesh_weld, but ISO_ERR_LIMIT. */
iso_status iso_mesh_weld_box(const iso_mesh_view *view, const iso_brick_box *box, const uint32_t *first,
                             iso_weld *weld, iso_error *error);
/* Moves the vertices of a mesh welded from `view` along their edges, so that each is at least `distance`
 * (voxels, below 1/2) from the edge's ends. Vertices of different edges are then in different places, also
 * where voxels have exactly the isovalue, so that a file without indices, such as .stl, describes the same
 * mesh. */
void iso_weld_separate(const iso_mesh_view *view, double distance, iso_weld *weld);
void iso_weld_free(iso_weld *weld);

ISO_C_END
#endif
