/* mesh_write: writes meshes; the format is chosen by the extension: .ply and .stl (binary), .obj, .vtp, .glb
 * (glTF 2.0) and .3mf; all but .stl and .3mf with normals, all but .stl with the colours of vertices, if
 * there are some. .obj, .glb and .3mf hold several objects, the last two with their colours and opacities.
 * Positions are in world millimetres; triangles are counter-clockwise seen from outside, also with
 * left-handed transforms. */
#ifndef ISO_IO_MESH_MESH_WRITE_H
#define ISO_IO_MESH_MESH_WRITE_H

#include <stdbool.h>
#include <sys/types.h>

#include "base/file.h"
#include "base/primitives.h"
#include "base/status.h"

/* Welds a mesh and writes it through base/file.h. `comment` (one line) may be NULL. ISO_ERR_USAGE for
 * another extension, ISO_ERR_WRITE, ISO_ERR_LIMIT (.stl above 2^32 - 1 triangles), ISO_ERR_NOMEM. */
iso_status iso_mesh_write(const char *path, const iso_mesh_view *view, const char *comment, iso_error *error);

/* ISO_ERR_USAGE, with the extensions of meshes that are written, unless `path` has one of them. */
iso_status iso_mesh_write_check(const char *path, iso_error *error);

/* Writes a mesh that is already welded; its vertices are in the index coordinates of `transform`. */
struct iso_weld;
iso_status iso_mesh_write_weld(const char *path, const struct iso_weld *weld, const iso_transform *transform,
                               const char *comment, iso_error *error);

/* The same to a stream of the caller, in the format that `path` names; errors of the stream are the caller's
 * to find (iso_sink_commit). */
iso_status iso_mesh_put_weld(FILE *stream, const char *path, const struct iso_weld *weld,
                             const iso_transform *transform, const char *comment, iso_error *error);

/* A mesh with a name in a file of several. All borrowed. */
typedef struct iso_mesh_object {
    const struct iso_weld *weld; /* in the index coordinates of `transform` */
    const iso_transform *transform;
    const char *name;     /* or NULL */
    const iso_rgb *color; /* without colours of vertices; or NULL */
    double opacity;       /* 0: not given, 1 */
} iso_mesh_object;

/* How many objects a file of this name can hold: 1, or any number. */
int iso_mesh_file_objects(const char *path);
/* Whether the file keeps opacities. */
bool iso_mesh_file_has_opacities(const char *path);

/* Write several meshes. Errors as iso_mesh_write, and ISO_ERR_USAGE: the format holds one only;
 * ISO_ERR_LIMIT: it does not hold so many bytes. The errors of a stream are the caller's to find. */
iso_status iso_mesh_write_objects(const char *path, const iso_mesh_object *objects, int count,
                                  const char *comment, iso_error *error);
iso_status iso_mesh_put_objects(FILE *stream, const char *path, const iso_mesh_object *objects, int count,
                                const char *comment, iso_error *error);

/* A .ply whose vertices and triangles are written in pieces, in any order. */
typedef struct iso_mesh_file_opts {
    uint64_t vertices, triangles; /* their numbers in the whole mesh */
    const iso_transform *transform;
    const char *comment; /* or NULL */
} iso_mesh_file_opts;

typedef struct iso_mesh_file {
    iso_sink sink; /* end with iso_sink_commit or iso_sink_abort */
    iso_transform transform;
    uint64_t vertices;
    off_t start; /* of the vertices; below 0: the file can only be written from its beginning to its end */
} iso_mesh_file;

/* Whether a file of this name can be written in pieces: whether it is a .ply. */
bool iso_mesh_file_takes(const char *path);
/* Opens the file and writes its header. ISO_ERR_WRITE. */
iso_status iso_mesh_file_begin(const char *path, const iso_mesh_file_opts *opts, iso_mesh_file *file,
                               iso_error *error);
/* Write vertices or triangles first .. end - 1 of `part` as those from `number` on of the whole mesh.
 * Errors are found by iso_sink_commit. */
void iso_mesh_file_put_vertices(iso_mesh_file *file, uint64_t number, const struct iso_weld *part,
                                size_t first, size_t end);
void iso_mesh_file_put_triangles(iso_mesh_file *file, uint64_t number, const struct iso_weld *part,
                                 size_t first, size_t end);

#endif
