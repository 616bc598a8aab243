/* mesh_read: reads triangle meshes (.stl, .obj, .ply, .off, .glb, .3mf, .vtk and .vtp with polygonal data
 * ..); the format is found from the content, and from the name if the content does not tell. Reads
 * positions and faces only; polygons become triangles. Positions are taken to be world millimetres, but
 * in formats that state their unit. */
#ifndef ISO_IO_MESH_MESH_READ_H
#define ISO_IO_MESH_MESH_READ_H

#include "base/primitives.h"
#include "base/progress.h"

/* Reads a mesh; iso_triangles_free when done. `progress` may be NULL. Memory grows with what is read: a
 * damaged header cannot make it large. ISO_ERR_IO (missing, truncated, or cancelled by `progress`),
 * ISO_ERR_FORMAT (damaged or of another format, an index without a vertex, a position that is not finite),
 * ISO_ERR_EMPTY (no triangles), ISO_ERR_UNSUPPORTED (another type of file), ISO_ERR_NOMEM. */
iso_status iso_mesh_read(const char *path, const iso_progress *progress, iso_triangles *mesh,
                         iso_error *error);

/* Numbers of the vertices of a mesh, as a file of its own has them. */
typedef struct iso_vertex_values {
    float *values;        /* of labels their numbers; NaN: none */
    uint8_t (*colors)[3]; /* of labels: red, green and blue, display values; NULL: numbers */
    size_t count;
} iso_vertex_values;

/* Reads .curv and the like, .annot, and data of .gii; iso_vertex_values_free when done. array: of several in
 * a .gii: its name, or its number from 0; NULL: the first. Errors as above; ISO_ERR_USAGE: there is no such
 * array. */
iso_status iso_vertex_values_read(const char *path, const char *array, iso_vertex_values *values,
                                  iso_error *error);
void iso_vertex_values_free(iso_vertex_values *values);

/* What a file is as a mesh. */
typedef enum iso_mesh_content {
    ISO_MESH_NO_FACES,
    ISO_MESH_FACES,
    ISO_MESH_COLORED_FACES /* .ply and .off: its vertices have colours, which a mesh does not show */
} iso_mesh_content;

/* Looks for faces in a file of a type that can hold a mesh; in .vtk and .vtp that have lines as well they do
 * not count. A file that cannot be read has none, unless its type holds nothing but meshes. */
iso_mesh_content iso_mesh_find_faces(const char *path);

#endif
