/* mesh_kernel: Marching Cubes of a block of four bricks (64 x 16 x 16 cells), in two steps.
 *
 * From the mask words of extract/points/edge_kernel.h, `list` finds by bit operations the edges that a brick
 * owns, those of its cells that neighbours own, and its active cells with their cases: every count is then
 * known. `fill` makes the vertices by the edge kernel's arithmetic and the triangles by table. The same bytes
 * as extract/mesh/marching_cubes.h from every instruction set. Lorensen and Cline 1987; vertices before
 * triangles as in Flying Edges (Schroeder, Maynard and Geveci 2015), rows taken to bit masks. Internal to
 * extract. */
#ifndef ISO_EXTRACT_MESH_MESH_KERNEL_H
#define ISO_EXTRACT_MESH_MESH_KERNEL_H

#include "extract/points/edge_kernel.h"

/* Edges of a block's cells that neighbours own: of an axis, a row has at most two entries (edges on a y or z
 * face, and those on an x face). */
enum {
    ISO_FAR_ENTRIES = ISO_EDGE_ROWS + 2 * (2 * ISO_EDGE_SIDE - 1),
    ISO_CELL_SLACK = 64,    /* items written past the end of a list of cells */
    ISO_TRIANGLE_SLACK = 6, /* triangles written past the end */
    ISO_VERTEX_SLOTS = 3 * ISO_LATTICE_VOXELS
};

typedef struct iso_far_list {
    int count;
    uint64_t mask[ISO_FAR_ENTRIES + 1];
    uint16_t row[ISO_FAR_ENTRIES + 1];
} iso_far_list;

/* Active cells in order: the key of the cell's first edge, and which corners are inside. */
typedef struct iso_cell_list {
    uint32_t count;
    uint16_t key[ISO_BRICK_VOXELS + ISO_CELL_SLACK];
    uint8_t inside[ISO_BRICK_VOXELS + ISO_CELL_SLACK];
} iso_cell_list;

/* The output of the kernel's `list` step, which its `fill` step reads. One for each worker. */
typedef struct iso_mesh_block {
    int origin[3];   /* voxels; set by the caller */
    unsigned bricks; /* bit k: brick k is wanted; set by the caller */
    uint32_t own[ISO_EDGE_BRICKS], far[ISO_EDGE_BRICKS], triangles[ISO_EDGE_BRICKS];
    iso_edge_list own_list[3];
    iso_far_list far_list[3];
    iso_cell_list cells[ISO_EDGE_BRICKS];
    uint16_t vertex_of[ISO_VERTEX_SLOTS]; /* of the brick at hand, by key */
} iso_mesh_block;

/* Where the parts of the wanted bricks go: own + far vertices and keys, triangles + ISO_TRIANGLE_SLACK. */
typedef struct iso_mesh_output {
    iso_surfel *vertices[ISO_EDGE_BRICKS];
    iso_edge_key *keys[ISO_EDGE_BRICKS];
    uint16_t (*triangles[ISO_EDGE_BRICKS])[3];
} iso_mesh_output;

typedef struct iso_mesh_kernel {
    /* Lists and counts the wanted bricks of block `number` of the words. */
    void (*list)(const iso_edge_source *source, const iso_edge_words *words, int number,
                 iso_mesh_block *block);
    /* The triangles of a brick's active cells. */
    void (*add_triangles)(const iso_cell_list *cells, const uint16_t *vertex_of, bool flip,
                          uint16_t (*triangles)[3]);
} iso_mesh_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_mesh_kernel *iso_mesh_kernel_get(iso_cpu_level level);

/* Makes the parts of the block's wanted bricks; `edges` is for the source's voxels. */
void iso_mesh_kernel_fill(const iso_mesh_kernel *kernel, const iso_edge_kernel *edges,
                          const iso_edge_source *source, iso_mesh_block *block,
                          const iso_mesh_output *output);

#endif
