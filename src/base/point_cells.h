/* point_cells: points sorted into cubic cells, so that the neighbours of a point are found without looking
 * at all others; for points of volumes and for points from files alike.
 *
 * A point has a reach: two points are neighbours when their distance is below the sum of their reaches.
 * Cells come in levels, each with half the cell size of the level before it (a hierarchical spatial hash
 * grid; Eitz and Lixu 2007): a point lies in a level whose cells are at least twice as large as its reach,
 * and in the finest such level. So points with a smaller or equal reach find it in the 3 x 3 x 3 cells
 * around their own position, and one point with a huge reach does not make the cells of all others large.
 * Only the cells that hold points exist; their blocks are found through a hash table.
 *
 * Blocks are 8 x 8 x 8 cells of a level. Blocks of one parity (odd or even coordinates, 8 combinations) do
 * not touch, so that threads may work on all of them at once: results that are made in 8 passes, one for
 * each parity, do not depend on the number of threads.
 *
 * Internal. Building is done by one thread; afterwards any number of threads may read. */
#ifndef ISO_BASE_POINT_CELLS_H
#define ISO_BASE_POINT_CELLS_H

#include "base/memory.h"
#include "base/primitives.h"

enum {
    ISO_CELL_LEVELS = 20,
    ISO_CELL_PARITIES = 8,
    ISO_CELL_ROWS = 18,
    ISO_CELL_BLOCKS_AROUND = 27,
    ISO_CELL_RANGES = ISO_CELL_ROWS * ISO_CELL_LEVELS
};

typedef struct iso_cell_point {
    float position[3]; /* mm, relative to the cells' anchor */
    float reach;       /* mm */
    uint32_t index;    /* in the view's arrays */
} iso_cell_point;

/* A cell of one level; its points are those from `first` up to the next cell's. */
typedef struct iso_point_cell {
    uint64_t key; /* the level and the coordinates; ascending */
    uint32_t first;
} iso_point_cell;

/* Cells first .. end - 1, and which of the block's 512 cells they are: bit 8 y + x of occupied[z]. */
typedef struct iso_cell_block {
    uint64_t key; /* the level and the block's coordinates */
    uint64_t occupied[8];
    uint16_t before[8]; /* number of cells before those of occupied[z] */
    uint32_t first, end;
} iso_cell_block;

/* Points first .. end - 1. */
typedef struct iso_cell_range {
    uint32_t first, end;
} iso_cell_range;

/* Zero-initialise; free with iso_point_cells_free. */
typedef struct iso_point_cells {
    iso_buffer points;  /* iso_cell_point, by level, block and cell; in a cell in the order of the spans */
    iso_buffer cells;   /* iso_point_cell, and one more behind the last */
    iso_buffer blocks;  /* iso_cell_block, by level and parity */
    iso_buffer table;   /* uint32_t: hash table of numbers of blocks + 1 */
    size_t point_count; /* of those with a finite position and a radius above 0 */
    size_t cell_count, table_mask;
    unsigned levels; /* bit i: level i has points */
    /* The blocks of a level l and a parity p are start[8 l + p] .. start[8 l + p + 1] - 1. */
    size_t start[ISO_CELL_LEVELS * ISO_CELL_PARITIES + 1];
} iso_point_cells;

/* Sorts the points of a view, with reaches of `factor` > 0 times their radii. Points whose position is not
 * finite, or whose radius is not above 0, are left out. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or
 * more. */
iso_status iso_point_cells_make(iso_point_cells *cells, const iso_point_view *view, double factor,
                                iso_error *error);
void iso_point_cells_free(iso_point_cells *cells);

/* Sets `ranges` to the points in the cells of `level` that can hold neighbours of points in cell number
 * `cell`, which is of the same or of a finer level; returns how many ranges there are. */
int iso_point_cells_around(const iso_point_cells *cells, uint32_t cell, int level,
                           iso_cell_range ranges[ISO_CELL_ROWS]);
/* Sets `ranges` as iso_point_cells_around does for all levels up to the cell's own, one after the other;
 * `coarser`: receives how many of the ranges are of coarser levels than the cell; may be NULL. */
int iso_point_cells_all_around(const iso_point_cells *cells, uint32_t cell,
                               iso_cell_range ranges[ISO_CELL_RANGES], int *coarser);
/* The level of cell number `cell`. */
int iso_point_cells_level(const iso_point_cells *cells, uint32_t cell);

/* The block with this key; NULL: it has no points. */
const iso_cell_block *iso_point_cells_block(const iso_point_cells *cells, uint64_t key);
/* Sets `keys` to those blocks of `level`, with points or not, whose cells iso_point_cells_around can return
 * for a cell of block `key`, which is of the same or of a finer level; returns how many keys there are. */
int iso_point_cells_blocks_around(uint64_t key, int level, uint64_t keys[ISO_CELL_BLOCKS_AROUND]);
/* The level of the block with this key. */
int iso_point_cells_block_level(uint64_t key);

#endif
