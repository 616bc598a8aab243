/* mesh_format: the readers of single formats of meshes (base/file_types.inc), behind iso_mesh_read, and what
 * they share. Internal to src/io/mesh. Each returns the errors of iso_mesh_read, whose messages begin with
 * the path; the buffers are the caller's. */
#ifndef ISO_IO_MESH_MESH_FORMAT_H
#define ISO_IO_MESH_MESH_FORMAT_H

#include "base/memory.h"
#include "base/progress.h"
#include "io/common/fans.h"
#include "io/common/ply.h"
#include "io/common/rows.h"
#include "io/mesh/mesh_read.h"

/* The mesh that is being read. */
typedef struct iso_mesh_reading {
    const char *path;
    iso_buffer vertices, triangles; /* three floats, and three uint32_t each */
    size_t vertex_count, triangle_count;
    iso_buffer colors; /* of vertices, three floats each, as they are stored */
    size_t color_count;
    bool real_colors; /* stored as real numbers */
    iso_buffer fans;  /* of iso_fan */
    size_t fan_count;
    const iso_progress *progress; /* measured by the position in rows, ply or file */
    FILE *file;
    const iso_ply *ply;
    iso_reading text; /* of a text file, as are the rows */
    iso_text_rows rows;
    iso_read_report report;
    double bytes; /* of the file */
} iso_mesh_reading;

/* A polygon that is read corner by corner; begin each with zeros. */
typedef struct iso_mesh_polygon {
    uint32_t first, last;
    size_t count;
} iso_mesh_polygon;

/* Adds a vertex. ISO_ERR_FORMAT: it is not finite; ISO_ERR_LIMIT, ISO_ERR_NOMEM; ISO_ERR_IO: cancelled. */
iso_status iso_mesh_add_vertex(iso_mesh_reading *r, const double p[3], iso_error *error);
/* Gives a colour to the vertex that was added last, as it is stored: iso_polydata_color_factor finds its
 * scale. Meshes have colours if all vertices have one. ISO_ERR_NOMEM. */
iso_status iso_mesh_add_color(iso_mesh_reading *r, const double rgb[3], iso_error *error);
/* Adds a triangle; vertices are numbered from 0. The numbers are checked at the end, because faces may
 * precede their vertices. ISO_ERR_NOMEM; ISO_ERR_IO: cancelled. */
iso_status iso_mesh_add_triangle(iso_mesh_reading *r, uint32_t a, uint32_t b, uint32_t c, iso_error *error);
/* Adds a corner of a polygon, and ends it. ISO_ERR_NOMEM; ISO_ERR_IO: cancelled. */
iso_status iso_mesh_add_corner(iso_mesh_reading *r, iso_mesh_polygon *p, uint32_t corner, iso_error *error);
iso_status iso_mesh_end_polygon(iso_mesh_reading *r, const iso_mesh_polygon *p, iso_error *error);

/* Loads a text file, whose rows are then read from r->rows. ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_NOMEM. */
iso_status iso_mesh_load_rows(iso_mesh_reading *r, iso_error *error);

/* Takes memory for `count` vertices, and for colours of all of them, which are 0. ISO_ERR_NOMEM. */
iso_status iso_vertex_values_reserve(iso_vertex_values *values, size_t count, bool colors, iso_error *error);

#define MESH(reader) iso_status iso_mesh_read_##reader(iso_mesh_reading *r, iso_error *error);
#define VALUES(reader)                                                                                       \
    iso_status iso_vertex_values_read_##reader(iso_mesh_reading *r, const char *array,                       \
                                               iso_vertex_values *values, iso_error *error);
#define FILE_TYPE(name, extensions, magic, handlers) handlers
#include "base/file_types.inc"

#endif
