/* block_ranges: the ranges of values of a volume's blocks of 64^3 voxels, so that blocks that an isovalue
 * does not cross need not be read. 9 bytes a block: 2.4 MB for 4096^3 voxels. */
#ifndef ISO_GRIDS_BLOCK_RANGES_H
#define ISO_GRIDS_BLOCK_RANGES_H

#include "grids/brick_range.h"
#include "grids/grid_chunk.h"

enum { ISO_BLOCK_BRICKS = 4 }; /* bricks along the side of a block */

/* Ranges are those of a block's bricks together (iso_brick_range): they include the first voxels of the next
 * blocks. Stored values. */
typedef struct iso_block_ranges {
    int bricks[3], blocks[3]; /* of the volume, along each axis */
    int before[3];            /* bricks that the first blocks are short of */
    size_t count;             /* of blocks */
    float *lo, *hi;           /* by block, x fastest; lo > hi: no voxel is finite */
    uint8_t *states;          /* by block: ISO_BLOCK_ .. */
    size_t unknown;           /* number of blocks whose range is not known */
} iso_block_ranges;

/* The state of a block: two flags, and while it is not known the number of bricks entered. */
enum { ISO_BLOCK_KNOWN = 128, ISO_BLOCK_NONFINITE = 64, ISO_BLOCK_BRICKS_SEEN = 63 };

/* Creates a table of unknown ranges for a volume of dims voxels. `before`: by how many bricks (0 .. 3) the
 * first blocks are smaller, so that blocks begin where chunks do; NULL: they are not. ISO_ERR_NOMEM. */
iso_status iso_block_ranges_create(const int dims[3], const int before[3], iso_block_ranges *ranges,
                                   iso_error *error);
void iso_block_ranges_free(iso_block_ranges *ranges);

/* Enters the ranges of the bricks of a box (as iso_grid_chunk_ranges orders them), each brick once. */
void iso_block_ranges_add(iso_block_ranges *ranges, const iso_brick_box *box, const iso_brick_range *bricks);

/* Sets `range` to a range that includes those of all bricks of a box. False: a block is not known. */
bool iso_block_ranges_of(const iso_block_ranges *ranges, const iso_brick_box *box, iso_brick_range *range);

/* The number of blocks that overlap a box and that a stored isovalue crosses. All must be known. */
uint32_t iso_block_ranges_crossed(const iso_block_ranges *ranges, const iso_brick_box *box, float isovalue);

/* What tables of parts of a volume know of blocks first .. first + count - 1, for adding them up: the
 * number of bricks entered, and 1 for blocks with voxels that are not finite. */
void iso_block_ranges_counts(const iso_block_ranges *ranges, size_t first, size_t count, uint64_t *bricks,
                             uint64_t *nonfinite);
/* Replaces these by the sums. lo and hi must hold the least and the greatest of all tables by then. */
void iso_block_ranges_set_counts(iso_block_ranges *ranges, size_t first, size_t count, const uint64_t *bricks,
                                 const uint64_t *nonfinite);

#endif
