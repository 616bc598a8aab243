/* mesh_io: writes meshes; the format is chosen by the extension: .ply (binary, with normals), .stl (binary),
 * .obj (with normals). Positions are in world millimetres; triangles are counter-clockwise seen from outside,
 * also with left-handed transforms. */
#ifndef ISO_IO_MESH_IO_H
#define ISO_IO_MESH_IO_H

#include "base/primitives.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Welds a mesh and writes it through base/file.h. `comment` (one line) may be NULL. ISO_ERR_USAGE for another
 * extension, ISO_ERR_WRITE, ISO_ERR_LIMIT (.stl above 2^32 - 1 triangles), ISO_ERR_NOMEM. */
iso_status iso_mesh_write(const char *path, const iso_mesh_view *view, const char *comment, iso_error *error);

/* Writes a mesh that is already welded; its vertices are in the index coordinates of `transform`. */
struct iso_weld;
iso_status iso_mesh_write_weld(const char *path, const struct iso_weld *weld, const iso_transform *transform,
                               const char *comment, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
