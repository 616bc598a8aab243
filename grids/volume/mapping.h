/* mapping: voxels that stay in a file and are mapped into memory, so that the system reads and drops pages
 * of them as they are used. Volumes larger than memory are read this way (iso_volume_opts.mapped).
 *
 * The file is the volume's own when its voxels lie there in the type, order and alignment of a grid.
 * Otherwise it is a temporary file without a name in TMPDIR (/tmp), into which the voxels are unpacked or
 * converted once. A file that becomes shorter while it is mapped ends the program (SIGBUS). */
#ifndef ISO_GRIDS_VOLUME_MAPPING_H
#define ISO_GRIDS_VOLUME_MAPPING_H

#include <stdio.h>

#include "grids/chunk_source.h"

typedef struct iso_mapping iso_mapping;

/* Maps `bytes` bytes of a file, for reading, from its current position on; the file may then be closed.
 * ISO_ERR_IO: it cannot be mapped. `path` is for messages. */
iso_status iso_mapping_of_file(const char *path, FILE *file, uint64_t bytes, iso_mapping **mapping,
                               iso_error *error);

/* Makes a temporary file of `bytes` bytes and maps it for reading and writing. ISO_ERR_WRITE: no room in
 * TMPDIR, which the message names. `path`: the file that is unpacked, for messages. */
iso_status iso_mapping_of_new_file(const char *path, uint64_t bytes, iso_mapping **mapping, iso_error *error);

/* The first byte that was asked for. */
void *iso_mapping_data(const iso_mapping *mapping);

/* Unmaps; an iso_rgrid's release function. */
void iso_mapping_destroy(void *mapping);

/* The source of the chunks of a grid. If its voxels are mapped, chunks that lie in holes of the file are
 * known to be zero, and pages are given back when the source rests. */
iso_chunk_source iso_mapping_source(const iso_rgrid *grid);

#endif
