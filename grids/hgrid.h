/* hgrid: a two-level grid of signed distances (2003, section 3).
 *
 * A dense top-level array of cells; each is empty (wholly outside or wholly inside) or holds a brick of 16^3
 * floats: the signed distance to the surface in voxels, negative inside, clamped at +-band (band >= 3). Brick
 * voxel (x, y, z) is at [(z * 16 + y) * 16 + x]: x fastest (OpenVDB's leaves have z fastest). Bricks lie
 * 64-byte aligned in a pool and never move while they exist. An empty cell reads as +band outside and -band
 * inside; voxel coordinates outside the grid are clamped to it. Access takes constant time; reading never
 * allocates.
 *
 * Reading is thread-safe while nobody writes. Writers call iso_hgrid_mark_changed for what they changed. */
#ifndef ISO_GRIDS_HGRID_H
#define ISO_GRIDS_HGRID_H

#include <stddef.h>
#include <stdint.h>

#include "base/geometry.h"
#include "base/primitives.h"
#include "base/status.h"
#include "grids/change_log.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values of a top-level cell that has no brick. */
enum { ISO_CELL_OUTSIDE = -1, ISO_CELL_INSIDE = -2 };
/* Largest number of voxels along an axis. */
enum { ISO_HGRID_MAX = 2048 };

/* Bricks lie in chunks of 4 MiB; free ones are chained through their first four bytes. */
enum { ISO_POOL_CHUNK = 256 };
typedef struct iso_brick_pool {
    float **chunk; /* each ISO_POOL_CHUNK bricks, 2 MiB aligned; only this table ever moves */
    size_t chunk_count, chunk_room;
    int32_t first_free; /* -1: none */
    int32_t next;       /* bricks from here on were never used */
    int32_t ready;      /* bricks up to here have been written to */
    size_t used;
} iso_brick_pool;

typedef struct iso_hgrid {
    int dims[3];   /* voxels; the last cell of an axis may stick out beyond them */
    int cells[3];  /* ceil(dims / 16) */
    int32_t *cell; /* cells, x fastest: a brick's number in the pool, or ISO_CELL_OUTSIDE / ISO_CELL_INSIDE */
    float band;    /* clamp, voxels, >= 3 */
    iso_transform transform;
    iso_brick_pool pool;
    iso_change_log *log;
} iso_hgrid;

/* A grid of empty cells, all outside. dims 1 .. 2048 each (ISO_ERR_LIMIT above); band 0 means 3, below 3 is
 * ISO_ERR_USAGE; transform NULL means identity, singular is ISO_ERR_FORMAT. Destroy with iso_hgrid_destroy.
 */
iso_status iso_hgrid_create(const int dims[3], float band, const iso_transform *transform, iso_hgrid **grid,
                            iso_error *error);
void iso_hgrid_destroy(iso_hgrid *grid);

static inline size_t iso_hgrid_cell_count(const iso_hgrid *grid) {
    return (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
}

static inline size_t iso_hgrid_cell_index(const iso_hgrid *grid, int cx, int cy, int cz) {
    return ((size_t)cz * (size_t)grid->cells[1] + (size_t)cy) * (size_t)grid->cells[0] + (size_t)cx;
}

/* The inverse of iso_hgrid_cell_index: where the cell of this number lies, counted in cells. */
static inline void iso_hgrid_cell_position(const iso_hgrid *grid, size_t cell, int at[3]) {
    const size_t nx = (size_t)grid->cells[0], ny = (size_t)grid->cells[1];
    at[0] = (int)(cell % nx);
    at[1] = (int)(cell / nx % ny);
    at[2] = (int)(cell / nx / ny);
}

/* The 4096 floats of a brick by its number in the pool. */
static inline float *iso_hgrid_brick(const iso_hgrid *grid, int32_t brick) {
    return grid->pool.chunk[brick / ISO_POOL_CHUNK] + (size_t)(brick % ISO_POOL_CHUNK) * ISO_BRICK_VOXELS;
}

/* What every voxel of an empty cell reads as. */
static inline float iso_hgrid_empty_value(const iso_hgrid *grid, int32_t state) {
    return state == ISO_CELL_INSIDE ? -grid->band : grid->band;
}

/* The brick of a cell, made (filled with the empty cell's value) when there is none. Not a change by itself:
 * touch what you write. ISO_ERR_NOMEM leaves the grid as it was. */
iso_status iso_hgrid_split(iso_hgrid *grid, int cx, int cy, int cz, float **brick, iso_error *error);

/* The same when all of the brick is to be written anyway: a brick that is made holds anything. */
iso_status iso_hgrid_split_unset(iso_hgrid *grid, int cx, int cy, int cz, iso_error *error);

/* Touches the memory of the next `bricks` bricks, so that making them costs no page faults: for who has time
 * now and not then. What cannot be had is left for later. */
void iso_hgrid_reserve(iso_hgrid *grid, int bricks);

/* Makes a cell empty (state ISO_CELL_OUTSIDE or ISO_CELL_INSIDE); its brick goes back to the pool. */
void iso_hgrid_coalesce(iso_hgrid *grid, int cx, int cy, int cz, int32_t state);

/* Coalesces every cell whose voxels are all +band or all -band. Here as everywhere, the part of a brick that
 * sticks out beyond dims counts for nothing: writers may leave anything there. */
void iso_hgrid_prune(iso_hgrid *grid);

/* Bricks in use, and bytes of the whole grid. */
size_t iso_hgrid_brick_count(const iso_hgrid *grid);
size_t iso_hgrid_bytes(const iso_hgrid *grid);

/* Starts an edit and records voxels lo..hi (clipped to the grid) as changed. */
iso_status iso_hgrid_mark_changed(iso_hgrid *grid, const int lo[3], const int hi[3], iso_error *error);

/* A new grid holding voxels lo..hi (inclusive) of this one, with its origin moved accordingly and an empty
 * log. ISO_ERR_USAGE when the range is empty or outside. The original is untouched. */
iso_status iso_hgrid_crop(const iso_hgrid *grid, const int lo[3], const int hi[3], iso_hgrid **cropped,
                          iso_error *error);

/* Makes `to`, a grid of the same dims and band, hold the same cells; all of it counts as changed.
 * ISO_ERR_USAGE: not the same shape. ISO_ERR_NOMEM: some cells are copied. */
iso_status iso_hgrid_copy_cells(const iso_hgrid *from, iso_hgrid *to, iso_error *error);

/* Distance at a voxel, which must be inside the grid. */
static inline float iso_hgrid_at(const iso_hgrid *grid, int x, int y, int z) {
    int32_t brick = grid->cell[iso_hgrid_cell_index(grid, x / ISO_BRICK, y / ISO_BRICK, z / ISO_BRICK)];
    if (brick < 0) return iso_hgrid_empty_value(grid, brick);
    return iso_hgrid_brick(grid,
                           brick)[((z % ISO_BRICK) * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK + x % ISO_BRICK];
}

#ifdef __cplusplus
}
#endif
#endif
