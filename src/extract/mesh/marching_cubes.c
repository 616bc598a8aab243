/* marching_cubes: the mesh of one brick from its window, cell by cell, for windows that the mesh kernel
 * cannot handle (NaN, infinity, overflow). Marching Cubes (Lorensen and Cline 1987) with shared, indexed
 * vertices (Baerentzen and Christensen 2003, section 5): first the vertices, each once, then each cell's
 * triangles from the case table. */
#include "extract/mesh/marching_cubes.h"

#include "mc_table.h"

/* Offset in the window from a cell's corner 0 to its corner i. */
static const ptrdiff_t corner_offset[8] = {0,
                                           1,
                                           ISO_STEP_Y,
                                           ISO_STEP_Y + 1,
                                           ISO_STEP_Z,
                                           ISO_STEP_Z + 1,
                                           ISO_STEP_Z + ISO_STEP_Y,
                                           ISO_STEP_Z + ISO_STEP_Y + 1};

static unsigned cell_case(const float *corner, const iso_threshold *surface) {
    unsigned inside = 0;
    for (unsigned i = 0; i < 8; i++)
        inside |= (unsigned)iso_threshold_inside(surface, corner[corner_offset[i]]) << i;
    return inside;
}

static bool all_finite(const float *corner) {
    for (int i = 0; i < 8; i++)
        if (!isfinite(corner[corner_offset[i]])) return false;
    return true;
}

static void add_triangles(const mc_case *row, iso_edge_key cell_key, iso_brick_mesh *mesh) {
    for (int i = 0; i < row->triangles; i++) {
        uint16_t *triangle = mesh->triangles[mesh->triangle_count++];
        for (int k = 0; k < 3; k++) triangle[k] = mesh->vertex_of[cell_key + row->key[3 * i + k]];
    }
}

static void add_cells(const iso_brick_window *window, const iso_threshold *surface, iso_brick_mesh *mesh) {
    int cells[3];
    for (int axis = 0; axis < 3; axis++)
        cells[axis] = window->last[axis] < ISO_BRICK ? window->last[axis] : ISO_BRICK;
    for (int z = 0; z < cells[2]; z++)
        for (int y = 0; y < cells[1]; y++)
            for (int x = 0; x < cells[0]; x++) {
                const float *corner = window->values + iso_window_index(x, y, z);
                const mc_case *row = &mc_cases[surface->normal_sign > 0][cell_case(corner, surface)];
                if (!row->triangles || !all_finite(corner)) continue;
                add_triangles(row, iso_edge_key_make(x, y, z, 0), mesh);
            }
}

void iso_marching_cubes(const iso_brick_window *window, const iso_threshold *surface, iso_brick_mesh *mesh) {
    iso_edge_points edges = {.points = mesh->vertices, .keys = mesh->keys};
    iso_edge_points_own(window, surface, &edges);
    mesh->owned_count = edges.count;
    iso_edge_points_far(window, surface, &edges);
    mesh->vertex_count = edges.count;
    mesh->triangle_count = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) mesh->vertex_of[mesh->keys[i]] = (uint16_t)i;
    add_cells(window, surface, mesh);
}
