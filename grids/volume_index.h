/* volume_index: what was found out about a large volume, in a file beside it (NAME.isoindex), so that later
 * pictures of it read only the chunks that they show: the ranges of its blocks, its histogram, and the size
 * and bounds of its surfaces.
 *
 * An index belongs to certain files (iso_file_set_identity), and to the voxels that were read from them. What
 * it says is checked when it is read, as far as that is possible without the voxels: an index that
 * contradicts itself is not used. The file is little-endian: "ISOINDEX", the version (uint32: 2), the fields
 * of iso_volume_identity, the histogram and the surfaces, the ranges, and the CRC-32C of everything before.
 */
#ifndef ISO_GRIDS_VOLUME_INDEX_H
#define ISO_GRIDS_VOLUME_INDEX_H

#include "grids/block_ranges.h"

/* Which voxels an index describes. Zero-initialise: identities are compared byte by byte. */
typedef struct iso_volume_identity {
    uint64_t files;    /* iso_file_set_identity of the volume's files */
    int32_t dims[3];   /* voxels that are used, */
    int32_t first[3];  /* from this voxel of the file on */
    int32_t type;      /* iso_type */
    int32_t component; /* of several */
    int32_t before[3]; /* iso_block_ranges.before */
    int32_t zero;
    double scale, offset;
    iso_transform transform;
} iso_volume_identity;

/* A surface that was extracted as a whole. */
typedef struct iso_indexed_surface {
    double isovalue;
    uint64_t kind;       /* the caller's number for the kind of primitives */
    uint64_t primitives; /* how many there are; 0: the surface is empty */
    double index[6],
        world[6]; /* its boxes in index coordinates and in the world, lo x y z, hi x y z; empty: lo > hi */
} iso_indexed_surface;

enum { ISO_INDEXED_SURFACES = 32 };

typedef struct iso_volume_index {
    iso_volume_identity identity;
    iso_block_ranges ranges;
    int has_histogram;
    iso_histogram histogram;
    int surface_count;
    iso_indexed_surface surfaces[ISO_INDEXED_SURFACES]; /* the last ones added come first */
    int changed; /* since it was read or written: the caller sets it when it adds to ranges or histogram */
} iso_volume_index;

/* Creates an index in which nothing is known. ISO_ERR_NOMEM. */
iso_status iso_volume_index_create(const iso_volume_identity *identity, iso_volume_index *index,
                                   iso_error *error);
void iso_volume_index_free(iso_volume_index *index);

/* Reads what a file knows into a new index. False: there is no such file, it is damaged, contradicts itself,
 * or describes other voxels; the index then knows nothing. */
bool iso_volume_index_read(const char *path, iso_volume_index *index);

/* Writes a file that appears whole or not at all. ISO_ERR_WRITE: also if a file that is no index, or a
 * symbolic link, has this name. */
iso_status iso_volume_index_write(const char *path, iso_volume_index *index, iso_error *error);

/* Finds a surface; NULL: it is not known. */
const iso_indexed_surface *iso_volume_index_find(const iso_volume_index *index, double isovalue,
                                                 uint64_t kind);
/* Adds a surface; the oldest one gives way. */
void iso_volume_index_add(iso_volume_index *index, const iso_indexed_surface *surface);

#endif
