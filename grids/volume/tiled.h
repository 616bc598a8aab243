/* tiled: volumes whose voxels are stored in tiles that can be read singly and in any order: the "chunks" of
 * Zarr and HDF5; tiles, strips and slices of TIFF. ("Tile" is the word for these pieces of a file, "chunk"
 * for the pieces of a volume that are visited one after the other, grids/grid_chunk.h.)
 *
 * A format offers its tiles by `open_tiled` (grids/volume/format.h) and needs no other function for voxels:
 * volume.c reads a volume that fits into memory with all threads, and makes a grid of one that does not
 * fit, whose voxels stay in the file (iso_volume_opts.mapped). */
#ifndef ISO_GRIDS_VOLUME_TILED_H
#define ISO_GRIDS_VOLUME_TILED_H

#include "grids/chunk_source.h"
#include "grids/volume/volume.h"

/* An open tiled volume. Its scale, offset and transform are those of its iso_volume_info. */
typedef struct iso_tiled {
    int dims[3];      /* voxels of the volume, x fastest */
    int tile[3];      /* voxels of a tile; the last ones may reach beyond the volume */
    iso_type type;    /* of the grid: wider types of the file are converted by `read` */
    uint64_t scratch; /* bytes of memory that a call of `read` takes beside its target */
    /* Reads and decodes tile `index` (0 .. ceil(dims / tile) - 1 on each axis) into `target`: tile[0] *
     * tile[1] * tile[2] values, x fastest; those outside the volume may be anything. Called by several
     * threads at once: a library that is not thread-safe is locked inside, decoding is not. Errors name the
     * file and the tile. */
    iso_status (*read)(void *context, const int index[3], void *target, iso_error *error);
    /* Optional, for files that need not have all tiles: the first tile from tile `from` on that is in the
     * file, or `end` or more if none of those before tile `end` is. Tiles are numbered along x, y and z. It
     * must not take a step for each absent tile: a small file may lack any number of them. Called by several
     * threads at once. */
    uint64_t (*next_stored)(void *context, uint64_t from, uint64_t end);
    float fill; /* the value (a stored value) of all voxels of tiles that are not in the file */
    bool
        waits; /* `read` mostly waits for a server: more tiles are read at a time than there are processors */
    void (*destroy)(void *context);
    void *context;
} iso_tiled;

/* Destroys the context. */
void iso_tiled_close(iso_tiled *tiled);

/* Reads the whole volume into the grid that `info` describes, with all threads of opts->pool (eight of
 * its own if reading waits) if there is memory for a tile for each, else with one. Adds a note to `info`
 * if tiles are absent. With opts->mapped the voxels lie in a temporary file (grids/volume/mapping.h).
 * When several tiles cannot be read, the error is that of the first one. Errors of reading; ISO_ERR_IO:
 * opts->progress cancels; ISO_ERR_NOMEM. */
iso_status iso_tiled_read_grid(const char *path, const iso_volume_opts *opts, const iso_tiled *tiled,
                               iso_volume_info *info, iso_grid *grid, iso_error *error);

/* Whether the volume is to be read chunk by chunk: the tiles that a chunk of the usual size needs fit into
 * the cache of iso_tiled_make_grid, or they have at most eight times the chunk's voxels. Other volumes
 * (large slices, and little memory) are unpacked into a temporary file, because each tile would be decoded
 * many times. */
bool iso_tiled_suits_chunks(const iso_tiled *tiled, const iso_volume_opts *opts);

/* Makes the grid that `info` describes, whose voxels stay in the file: `data` is a range of addresses
 * without memory, which nobody may read or write. It can be cropped; its voxels are read by its chunk
 * source. The grid takes *tiled over, also when it fails. ISO_ERR_NOMEM. */
iso_status iso_tiled_make_grid(const char *path, const iso_volume_opts *opts, iso_tiled *tiled,
                               const iso_volume_info *info, iso_grid *grid, iso_error *error);

/* Whether a grid was made by iso_tiled_make_grid. */
bool iso_tiled_is(const iso_rgrid *grid);

/* The source of the chunks of such a grid, which is borrowed. A cache of a third of the memory limit keeps
 * decoded tiles, or of tiles that do not all fit the last layers, which chunks that are visited later need
 * again. Chunks whose tiles are all absent are known to be constant. For one thread
 * at a time, which `read` may be given a pool. */
iso_chunk_source iso_tiled_source(const iso_rgrid *grid);

#endif
