/* hgrid: a two-level sparse grid of signed distances (Baerentzen and Christensen 2003, section 3).
 *
 * The top level is a dense array of cells. A cell is empty (entirely outside or entirely inside) or has a
 * brick of 16^3 floats: the signed distances to the surface in voxels, negative inside, clamped to +-band (at
 * least 3). Voxel (x, y, z) of a brick is at [(z * 16 + y) * 16 + x]: x is fastest, unlike in OpenVDB's
 * leaves. Bricks are 64-byte aligned in a pool and are not moved while they exist. The voxels of an empty
 * cell read as +band or -band. Access takes constant time, and reading never allocates.
 *
 * Reading is thread-safe while nobody writes. Writers call iso_hgrid_mark_changed for what they changed. */
#ifndef ISO_GRIDS_HGRID_H
#define ISO_GRIDS_HGRID_H

#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/primitives.h"
#include "base/status.h"
#include "grids/change_log.h"

ISO_C_BEGIN

/* Entries of cells without a brick. */
enum { ISO_CELL_OUTSIDE = -1, ISO_CELL_INSIDE = -2 };
/* Largest number of voxels along an axis. */
enum { ISO_HGRID_MAX = 2048 };

/* The memory of bricks, in chunks of 4 MiB (ISO_POOL_CHUNK bricks). Free bricks form a list linked through
 * their first four bytes. */
enum { ISO_POOL_CHUNK = 256 };
typedef struct iso_brick_pool {
    float **chunk; /* each has ISO_POOL_CHUNK bricks, 2 MiB aligned; only this table is reallocated */
    size_t chunk_count, chunk_room;
    int32_t first_free; /* number of the first free brick; -1: none */
    int32_t next;       /* bricks from this number on were never allocated */
    int32_t ready;      /* pages of bricks before this number have been written to */
    size_t used;        /* bricks in use */
} iso_brick_pool;

typedef struct iso_hgrid {
    int dims[3];   /* voxels; the last cell along an axis may extend beyond them */
    int cells[3];  /* ceil(dims / 16) */
    int32_t *cell; /* cells, x fastest: a brick's number in the pool, or ISO_CELL_OUTSIDE / ISO_CELL_INSIDE */
    float band;    /* clamp, voxels, >= 3 */
    iso_transform transform;
    iso_brick_pool pool;
    iso_change_log *log;
} iso_hgrid;

/* Creates a grid whose cells are all empty and outside. band 0 means 3; transform NULL means identity.
 * ISO_ERR_LIMIT: more than ISO_HGRID_MAX voxels along an axis; ISO_ERR_USAGE: a band below 3; ISO_ERR_FORMAT:
 * a size below 1 or a singular transform; ISO_ERR_NOMEM. */
iso_status iso_hgrid_create(const int dims[3], float band, const iso_transform *transform, iso_hgrid **grid,
                            iso_error *error);
void iso_hgrid_destroy(iso_hgrid *grid);

static inline size_t iso_hgrid_cell_count(const iso_hgrid *grid) {
    return (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
}

static inline size_t iso_hgrid_cell_index(const iso_hgrid *grid, int cx, int cy, int cz) {
    return ((size_t)cz * (size_t)grid->cells[1] + (size_t)cy) * (size_t)grid->cells[0] + (size_t)cx;
}

/* Computes the position, in cells, of the cell with a number from iso_hgrid_cell_index. */
static inline void iso_hgrid_cell_position(const iso_hgrid *grid, size_t cell, int at[3]) {
    const size_t nx = (size_t)grid->cells[0], ny = (size_t)grid->cells[1];
    at[0] = (int)(cell % nx);
    at[1] = (int)(cell / nx % ny);
    at[2] = (int)(cell / nx / ny);
}

/* Returns the 4096 values of a brick, given its number in the pool. */
static inline float *iso_hgrid_brick(const iso_hgrid *grid, int32_t brick) {
    return grid->pool.chunk[brick / ISO_POOL_CHUNK] + (size_t)(brick % ISO_POOL_CHUNK) * ISO_BRICK_VOXELS;
}

/* Returns the value of all voxels of an empty cell. */
static inline float iso_hgrid_empty_value(const iso_hgrid *grid, int32_t state) {
    return state == ISO_CELL_INSIDE ? -grid->band : grid->band;
}

/* Returns the brick of a cell. If the cell is empty it gets a brick filled with the cell's value. This is not
 * recorded in the change log: the caller records the voxels that it writes. ISO_ERR_NOMEM: the grid is as
 * before. */
iso_status iso_hgrid_split(iso_hgrid *grid, int cx, int cy, int cz, float **brick, iso_error *error);

/* Gives a cell a brick, but does not initialise a new one, for callers that write all of it. */
iso_status iso_hgrid_split_unset(iso_hgrid *grid, int cx, int cy, int cz, iso_error *error);

/* Allocates memory for the next `bricks` bricks and writes to its pages, so that page faults happen now and
 * not during a stroke. Prepares fewer bricks if there is not enough memory. */
void iso_hgrid_reserve(iso_hgrid *grid, int bricks);

/* Makes a cell empty, with the entry ISO_CELL_OUTSIDE or ISO_CELL_INSIDE, and frees its brick. */
void iso_hgrid_coalesce(iso_hgrid *grid, int cx, int cy, int cz, int32_t state);

/* Makes every cell empty whose voxels are all +band or all -band. Voxels of a brick beyond dims are ignored,
 * here and everywhere else, and may have any value. */
void iso_hgrid_prune(iso_hgrid *grid);

/* Return the number of bricks in use, and the size of the whole grid in bytes. */
size_t iso_hgrid_brick_count(const iso_hgrid *grid);
size_t iso_hgrid_bytes(const iso_hgrid *grid);

/* Starts an edit and records voxels lo..hi (inclusive, clipped to the grid) as changed. ISO_ERR_NOMEM. */
iso_status iso_hgrid_mark_changed(iso_hgrid *grid, const int lo[3], const int hi[3], iso_error *error);

/* Creates a grid with voxels lo..hi (inclusive) of `grid`, the origin moved accordingly, and an empty log.
 * ISO_ERR_USAGE: the range is empty or outside; ISO_ERR_NOMEM. */
iso_status iso_hgrid_crop(const iso_hgrid *grid, const int lo[3], const int hi[3], iso_hgrid **cropped,
                          iso_error *error);

/* Copies all cells to `to`, a grid of the same dims and band, and records its whole box as changed.
 * ISO_ERR_USAGE: other dims or band. ISO_ERR_NOMEM: only some cells are copied. */
iso_status iso_hgrid_copy_cells(const iso_hgrid *from, iso_hgrid *to, iso_error *error);

/* Returns the distance at a voxel inside the grid, in voxels. */
static inline float iso_hgrid_at(const iso_hgrid *grid, int x, int y, int z) {
    int32_t brick = grid->cell[iso_hgrid_cell_index(grid, x / ISO_BRICK, y / ISO_BRICK, z / ISO_BRICK)];
    if (brick < 0) return iso_hgrid_empty_value(grid, brick);
    return iso_hgrid_brick(grid,
                           brick)[((z % ISO_BRICK) * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK + x % ISO_BRICK];
}

ISO_C_END
#endif
