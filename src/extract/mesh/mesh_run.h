/* mesh_run: extracts meshes with the mesh kernel: lists of an rgrid's bricks in runs of neighbouring blocks,
 * and single bricks from their windows. Internal to extract. */
#ifndef ISO_EXTRACT_MESH_MESH_RUN_H
#define ISO_EXTRACT_MESH_MESH_RUN_H

#include "extract/mesh/marching_cubes.h"
#include "extract/mesh/mesh_kernel.h"
#include "grids/brick_set.h"

/* The surface and the kernels; prepared once per surface. */
typedef struct iso_mesh_context {
    const iso_rgrid *grid; /* NULL: windows only */
    iso_threshold surface;
    const iso_mesh_kernel *kernel;
    const iso_edge_kernel *edges, *window_edges; /* for the grid's voxels and for windows */
    iso_edge_source source, window_source;
} iso_mesh_context;

void iso_mesh_context_init(iso_mesh_context *context, const iso_grid *grid, const iso_threshold *surface);

size_t iso_mesh_run_scratch_bytes(void);

/* Extracts `count` bricks of the context's grid, an ascending list. Bricks whose stencils include a NaN or
 * infinite voxel are passed to iso_brick_sink_extract. `scratch` holds iso_mesh_run_scratch_bytes() bytes,
 * 8-byte aligned. */
void iso_mesh_run(const iso_mesh_context *context, const iso_brick_set *set, const uint32_t *bricks,
                  size_t count, void *scratch, iso_brick_sink *sink);

/* Computes the mesh of a brick from its window: with the kernel or, if the window has NaN, infinite or very
 * large values, with iso_marching_cubes. */
void iso_mesh_run_window(const iso_mesh_context *context, const iso_brick_window *window, void *scratch,
                         iso_brick_mesh *mesh);

#endif
