/* mesh_kernel: limits of blocks and far edges, and building of a listed block; includes the kernel body
 * (mesh_kernel_body.inc) once per instruction set. */
#include "extract/mesh/mesh_kernel.h"

#include <string.h>

#include "base/simd.h"
#include "mc_table.h"

/* ---- lists */

/* The classified voxels of a block by row (z * 17 + y), as words of bits by x. */
enum { ROWS = ISO_EDGE_SIDE * ISO_EDGE_SIDE, CELL_ROWS = ROWS - ISO_EDGE_SIDE - 1 };
typedef struct block_rows {
    uint64_t at[ROWS];                /* bit x: voxel x is inside */
    uint64_t after[ROWS];             /* bit x: voxel x + 1 is inside */
    uint64_t any[ROWS], all[ROWS];    /* bit x: voxel x or voxel x + 1 is inside; both are */
    uint64_t active[CELL_ROWS];       /* bit x: cell x has corners inside and outside */
    uint16_t list[ISO_EDGE_ROWS + 1]; /* numbers (z << 5 | y) of the rows with active cells */
    int count;                        /* length of the list */
} block_rows;

/* The part of a block that lies in the grid and in wanted bricks: bits by x, and limits on y and z. */
typedef struct block_limits {
    uint64_t own;   /* bit x: a wanted brick owns the edges that begin at voxel x */
    uint64_t far;   /* bit x: a wanted brick has far edges that begin at voxel x on its far y or z face */
    uint64_t faces; /* bit x: voxel x is the last of a wanted brick, whose far x face is at x + 1 */
    uint64_t cells; /* bit x: cell x is in the grid and in a wanted brick */
    iso_edge_active active;
    int rows[3]; /* by axis: own edges begin at the voxels 0 .. rows - 1 */
    int last[3]; /* by axis: the last voxel, 0 .. 16, which is also the number of cells */
} block_limits;

/* The current lengths of the lists of own and far edges. */
typedef struct list_ends {
    int own[3], far[3];
} list_ends;

static uint64_t bits_below(int count) {
    return count <= 0 ? 0 : count < 64 ? ((uint64_t)1 << count) - 1 : ~(uint64_t)0;
}

static block_limits limits_of(const iso_edge_source *source, iso_edge_active active,
                              const iso_mesh_block *block) {
    block_limits limits = {.active = active};
    int left[3];
    for (int axis = 0; axis < 3; axis++) {
        left[axis] = source->dims[axis] - block->origin[axis];
        limits.rows[axis] = left[axis] < ISO_BRICK ? left[axis] : ISO_BRICK;
        limits.last[axis] = left[axis] - 1 < ISO_BRICK ? left[axis] - 1 : ISO_BRICK;
    }
    uint64_t lanes = 0;
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++)
        lanes |= (uint64_t)(block->bricks >> brick & 1) * 0xffff << (16 * brick);
    limits.own = bits_below(left[0]) & lanes;
    if (limits.last[1] == 0 || limits.last[2] == 0) return limits; /* a layer of one voxel has no cells */
    limits.cells = bits_below(left[0] - 1) & lanes;
    limits.faces = limits.cells & 0x8000800080008000u;
    limits.far = limits.own;
    if (left[0] % ISO_BRICK == 1 && left[0] < 64) limits.far &= bits_below(left[0] - 1);
    return limits;
}

static inline void append_far(iso_far_list *list, int *end, uint64_t mask, int row) {
    list->mask[*end] = mask;
    list->row[*end] = (uint16_t)row;
    *end += mask != 0;
}

/* Lists the edges that begin in a row with y = 16 or z = 16. All of them are far edges: those along the row's
 * bricks, and those on the bricks' far x faces. */
static void list_far_row(const block_rows *rows, const block_limits *limits, int row, list_ends *ends,
                         iso_mesh_block *block) {
    const int y = row & 31, z = row >> 5, i = z * ISO_EDGE_SIDE + y;
    const int group = (z < ISO_BRICK ? z : ISO_BRICK - 1) / 4 * 4 + (y < ISO_BRICK ? y : ISO_BRICK - 1) / 4;
    if (!(limits->active.groups >> group & 1)) return;
    for (int axis = 0; axis < 3; axis++) {
        if ((axis == 1 && y == ISO_BRICK) || (axis == 2 && z == ISO_BRICK)) continue;
        const int step = axis == 1 ? 1 : ISO_EDGE_SIDE;
        const uint64_t edges = rows->at[i] ^ (axis ? rows->at[i + step] : rows->after[i]);
        append_far(&block->far_list[axis], &ends->far[axis], edges & limits->far, row);
        if (axis == 0) continue;
        const uint64_t faces = rows->after[i] ^ rows->after[i + step];
        append_far(&block->far_list[axis], &ends->far[axis], faces & limits->faces, row | ISO_EDGE_FACE);
    }
}

#include "extract/mesh/mesh_kernel_cells.inc"

#define ISO_KERNEL_BODY "extract/mesh/mesh_kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_mesh_kernel *iso_mesh_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}

/* ---- vertices and triangles */

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
