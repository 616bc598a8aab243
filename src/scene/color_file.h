/* color_file: the file that surfaces are coloured by: the values of a volume, distances from its isosurface
 * or from a mesh, or numbers of a mesh's vertices. */
#ifndef ISO_SCENE_COLOR_FILE_H
#define ISO_SCENE_COLOR_FILE_H

#include "grids/distance/distance.h"
#include "io/mesh/mesh_read.h"
#include "scene/coloring.h"
#include "scene/loader.h"

/* Zero-initialise, set the members up to `isovalue`, iso_color_file_close when done. */
typedef struct iso_color_file {
    const char *path;
    iso_color_source source; /* BY_VOLUME or BY_DISTANCE */
    const char *array;       /* of a volume with several, or of a file of vertices; NULL: the first */
    double isovalue;         /* of a volume that distances are from; NAN: iso_color_file_read chooses it, */
    bool chosen;             /* and says so here */
    bool has_volume;
    iso_input input;
    iso_loader loader;          /* of the volume, if has_volume */
    iso_distance *distance;     /* BY_DISTANCE */
    iso_vertex_values vertices; /* without values: the file is not one of a mesh's vertices */
} iso_color_file;

/* Whether distances are from a mesh; else they are from a volume's isosurface. */
bool iso_color_file_is_mesh(const iso_color_file *file);
/* Whether the file has numbers of a mesh's vertices. */
bool iso_color_file_is_vertices(const iso_color_file *file);

/* Reads the header of a volume, and adds the file to `files`, which may be NULL. Errors of iso_loader_open;
 * ISO_ERR_USAGE: the file holds points, or is a mesh, which has no isovalue. */
iso_status iso_color_file_open(iso_color_file *file, uint64_t max_memory, iso_file_set *files, iso_pool *pool,
                               iso_error *error);
/* Reads what it holds; may be called again. Errors of iso_loader_read, iso_loader_isovalue, iso_mesh_read,
 * iso_vertex_values_read and iso_distance_of_isosurface. */
iso_status iso_color_file_read(iso_color_file *file, iso_error *error);
void iso_color_file_close(iso_color_file *file);

#endif
