/* mesh_kernel: Marching Cubes of a block of four bricks (64 x 16 x 16 cells), in two steps.
 *
 * `list_block` finds, by bit operations on the classified voxels (iso_edge_words), the crossed edges that
 * each brick owns, those of its cells that neighbours own (far edges), and its active cells with their cases;
 * all sizes are then known. iso_mesh_kernel_build computes the vertices with the edge kernel and the
 * triangles from the case table. Every instruction set gives the same bytes as extract/mesh/marching_cubes.h.
 * Sources: Lorensen and Cline 1987; Flying Edges (Schroeder, Maynard and Geveci 2015), which also computes
 * vertices before triangles, here with bit masks. Internal to extract. */
#ifndef ISO_EXTRACT_MESH_MESH_KERNEL_H
#define ISO_EXTRACT_MESH_MESH_KERNEL_H

#include "extract/points/edge_kernel.h"

/* Sizes of lists. ISO_FAR_ENTRIES: words of the far edges along one axis; a row has at most two words, one
 * for its edges on a far y or z face and one for those on far x faces. */
enum {
    ISO_FAR_ENTRIES = ISO_EDGE_ROWS + 2 * (2 * ISO_EDGE_SIDE - 1),
    ISO_CELL_SLACK = 64,    /* cells that may be written past the end of a list */
    ISO_TRIANGLE_SLACK = 6, /* triangles that may be written past the end of an array */
    ISO_VERTEX_SLOTS = 3 * ISO_LATTICE_VOXELS
};

/* The crossed far edges along one axis, as in iso_edge_list. */
typedef struct iso_far_list {
    int count;
    uint64_t mask[ISO_FAR_ENTRIES + 1];
    uint16_t row[ISO_FAR_ENTRIES + 1];
} iso_far_list;

/* The active cells of a brick, which have corners inside and outside. key: of the cell's first edge; inside:
 * bit i is set if corner i is inside. */
typedef struct iso_cell_list {
    uint32_t count;
    uint16_t key[ISO_BRICK_VOXELS + ISO_CELL_SLACK];
    uint8_t inside[ISO_BRICK_VOXELS + ISO_CELL_SLACK];
} iso_cell_list;

/* The crossed edges and active cells of a block, with the number of own edges, far edges and triangles of
 * each brick: set by list_block, read by iso_mesh_kernel_build. Large: one for each worker. */
typedef struct iso_mesh_block {
    int origin[3];   /* voxels; set by the caller */
    unsigned bricks; /* bit k: brick k is wanted; set by the caller */
    uint32_t own[ISO_EDGE_BRICKS], far[ISO_EDGE_BRICKS], triangles[ISO_EDGE_BRICKS];
    iso_edge_list own_list[3];
    iso_far_list far_list[3];
    iso_cell_list cells[ISO_EDGE_BRICKS];
    uint16_t vertex_of[ISO_VERTEX_SLOTS]; /* by key: number of the edge's vertex, in one brick at a time */
} iso_mesh_block;

/* The caller's arrays for the wanted bricks of an iso_mesh_block, with room for own + far vertices and keys,
 * and for triangles + ISO_TRIANGLE_SLACK triangles. */
typedef struct iso_mesh_output {
    iso_surfel *vertices[ISO_EDGE_BRICKS];
    iso_edge_key *keys[ISO_EDGE_BRICKS];
    uint16_t (*triangles[ISO_EDGE_BRICKS])[3];
} iso_mesh_output;

typedef struct iso_mesh_kernel {
    /* Sets `block` (except what the caller sets): the edges and cells of the wanted bricks of block number
     * `number` of the words. */
    void (*list_block)(const iso_edge_source *source, const iso_edge_words *words, int number,
                       iso_mesh_block *block);
    /* Writes the triangles of a brick's active cells. vertex_of: numbers of vertices by the key of their
     * edge; flip: triangles are oriented as for level sets. */
    void (*add_triangles)(const iso_cell_list *cells, const uint16_t *vertex_of, bool flip,
                          uint16_t (*triangles)[3]);
} iso_mesh_kernel;
ISO_KERNEL_UNITS(const iso_mesh_kernel, iso_mesh_kernel);

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_mesh_kernel *iso_mesh_kernel_get(iso_cpu_level level);

/* Computes the vertices and triangles of a listed block's wanted bricks. edges: the edge kernel for the voxel
 * type of the source. */
void iso_mesh_kernel_build(const iso_mesh_kernel *kernel, const iso_edge_kernel *edges,
                           const iso_edge_source *source, iso_mesh_block *block,
                           const iso_mesh_output *output);

#endif
