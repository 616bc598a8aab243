/* mesh_read: triangle meshes in, chosen by extension: .stl (binary and ASCII), .obj, .ply. Positions and
 * faces only; polygons become fans of triangles. World millimetres, as the file has them. */
#ifndef ISO_IO_MESH_READ_H
#define ISO_IO_MESH_READ_H

#include "base/primitives.h"
#include "base/progress.h"

#ifdef __cplusplus
extern "C" {
#endif

/* iso_triangles_free when done. ISO_ERR_IO (missing, truncated), ISO_ERR_FORMAT (not such a file, an index
 * that names no vertex, a position that is not finite), ISO_ERR_EMPTY (no triangles), ISO_ERR_UNSUPPORTED
 * (another extension), ISO_ERR_NOMEM. Nothing is allocated on a header's word. Cancelled: ISO_ERR_IO. */
iso_status iso_mesh_read(const char *path, const iso_progress *progress, iso_triangles *mesh,
                         iso_error *error);
void iso_triangles_free(iso_triangles *mesh);

#ifdef __cplusplus
}
#endif
#endif
