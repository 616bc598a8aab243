/* mesh_build: vertices and triangles of a listed block. */
#include "base/kernel.h"
#include "base/kernel_units.h"
#include "extract/mesh/mesh_kernel.h"

const iso_mesh_kernel *iso_mesh_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_mesh_kernel, level);
}

ISO_STEP static void number_vertices(const iso_edge_key *keys, uint32_t count, uint16_t *vertex_of) {
    for (uint32_t i = 0; i < count; i++) vertex_of[keys[i]] = (uint16_t)i;
}

/* Returns the arrays that the edge kernel is to write the vertices of own or far edges to. A brick that is
 * not wanted gets the arrays of a wanted one: nothing is written for it, but the edge kernel needs a
 * pointer. */
static iso_edge_output edge_output(const iso_mesh_block *block, const iso_mesh_output *output, bool far) {
    iso_edge_output edges = {0};
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        const int from = block->bricks >> brick & 1 ? brick : __builtin_ctz(block->bricks);
        const uint32_t skip = far ? block->own[from] : 0;
        edges.surfels[brick] = output->vertices[from] + skip;
        edges.keys[brick] = output->keys[from] + skip;
    }
    return edges;
}

void iso_mesh_kernel_build(const iso_mesh_kernel *kernel, const iso_edge_kernel *edges,
                           const iso_edge_source *source, iso_mesh_block *block,
                           const iso_mesh_output *output) {
    iso_edge_task tasks[2] = {{.output = edge_output(block, output, false)},
                              {.output = edge_output(block, output, true)}};
    for (int axis = 0; axis < 3; axis++) {
        const iso_edge_list *own = &block->own_list[axis];
        const iso_far_list *far = &block->far_list[axis];
        tasks[0].axes[axis] = (iso_edge_entries){own->mask, own->row, own->count};
        tasks[1].axes[axis] = (iso_edge_entries){far->mask, far->row, far->count};
        tasks[0].origin[axis] = tasks[1].origin[axis] = block->origin[axis];
    }
    edges->compute_points(source, tasks, 2);
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        if (!(block->bricks >> brick & 1)) continue;
        number_vertices(output->keys[brick], block->own[brick] + block->far[brick], block->vertex_of);
        kernel->add_triangles(&block->cells[brick], block->vertex_of, source->level_set,
                              output->triangles[brick]);
    }
}
