/* chunk_export: writes the points and the mesh of a volume that is visited chunk by chunk
 * (grids/chunk_walk.h), so that neither the volume nor its surface need be in memory. The files have the
 * bytes of those of the whole volume, whatever the size of the chunks.
 *
 * A first visit counts the points and triangles of each brick row of each chunk, which tells where in the
 * file they belong; a second one writes them. */
#ifndef ISO_IO_CHUNK_EXPORT_H
#define ISO_IO_CHUNK_EXPORT_H

#include "grids/chunk_walk.h"

/* Numbers of what was written. */
typedef struct iso_chunk_exported {
    uint64_t points, triangles; /* points: edge points, or the mesh's vertices */
} iso_chunk_exported;

/* Write the edge points, as iso_points_write_ply does; the welded mesh, as iso_mesh_write does, as .ply
 * only (iso_mesh_file_takes). ISO_ERR_WRITE: also if the file is one that is written in order only, such as
 * a pipe; ISO_ERR_LIMIT: more than 2^32 - 1 vertices of a mesh; ISO_ERR_NOMEM; errors of reading. */
iso_status iso_chunk_export_points(iso_chunk_walk *walk, const char *path, const char *comment,
                                   iso_chunk_exported *exported, iso_error *error);
iso_status iso_chunk_export_mesh(iso_chunk_walk *walk, const char *path, const char *comment,
                                 iso_chunk_exported *exported, iso_error *error);

#endif
