/* polydata: points with columns of numbers, and polylines that name points: what most formats of lines and of
 * glyphs hold (the word is VTK's). Readers fill it; then it becomes lines, or its points become glyphs.
 * Internal to src/io. */
#ifndef ISO_IO_POLYDATA_POLYDATA_H
#define ISO_IO_POLYDATA_POLYDATA_H

#include "base/glyphs.h"
#include "io/reading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise, then set `reading`; iso_polydata_free when done. */
typedef struct iso_polydata {
    iso_reading *reading;
    iso_space stated; /* the space that the file states; ISO_SPACE_FILE for none */
    bool keep_floats; /* coordinates are floats in the file: the origin stays 0, and they keep their bits */
    bool points_only; /* no lines are wanted: readers may skip them */
    iso_vec3 origin;
    iso_buffer points; /* three floats each, relative to the origin, in the file's space; NaN: not usable */
    size_t point_count;
    bool has_origin;
    iso_buffer column_array; /* of iso_column: see iso_polydata_column */
    int column_count;
    iso_buffer indices, starts; /* uint32_t, point numbers; size_t, as in iso_lines */
    size_t index_count, line_count;
} iso_polydata;

enum { ISO_POLYDATA_COLUMNS = 512 };

static inline iso_column *iso_polydata_column(const iso_polydata *data, int column) {
    return (iso_column *)data->column_array.data + column;
}

/* Adds a column without values and returns its number in *column. ISO_ERR_FORMAT: too many columns;
 * ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_polydata_add_column(iso_polydata *data, const char *name, int components, bool per_line,
                                   iso_role role, int *column, iso_error *error);

/* Where a number of a row, or of an item of PLY, belongs. */
typedef struct iso_slot {
    int column, component; /* column: ISO_SLOT_SKIP, or ISO_SLOT_POINT for coordinate `component` */
} iso_slot;
enum { ISO_SLOT_POINT = -1, ISO_SLOT_SKIP = -2 };

/* Adds columns for numbers with these names, in the order of a row, and finds the slot of each: x y z are the
 * point; nx ny nz, vx vy vz, red green blue, scale_0 .. 2, rot_0 .. 3 and f_dc_0 .. 2 become one column
 * each, when all of its names are there; every other name one of its own, NULL none. Case does not matter.
 * ISO_ERR_FORMAT: a coordinate is missing. */
iso_status iso_polydata_name_columns(iso_polydata *data, const char *const *names, int count, iso_slot *slots,
                                     iso_error *error);

/* Makes room for `count` points with their columns. */
iso_status iso_polydata_reserve(iso_polydata *data, size_t count, iso_error *error);

/* Adds a point; there must be room. Its columns are not set. */
void iso_polydata_add_point(iso_polydata *data, const double p[3]);

/* Adds a point with columns from the numbers of a row. There must be room. */
void iso_polydata_add_row(iso_polydata *data, const iso_slot *slots, const double *numbers, int count);

/* Adds a polyline by the numbers of its points, which are checked by iso_polydata_to_lines. ISO_ERR_LIMIT,
 * ISO_ERR_NOMEM. */
iso_status iso_polydata_add_index(iso_polydata *data, uint32_t point, iso_error *error);
iso_status iso_polydata_end_line(iso_polydata *data, iso_error *error);

/* Joins edges, pairs of point numbers, to polylines that run through all points with two edges and end at
 * all others; lines run along the edges' directions where these agree. `singles`: points without edges become
 * lines of one vertex. ISO_ERR_FORMAT: no point has that number. */
iso_status iso_polydata_add_edges(iso_polydata *data, const uint32_t (*edges)[2], size_t count, bool singles,
                                  iso_error *error);

/* Makes lines of the polylines. The polydata is used up. ISO_ERR_FORMAT: a line names a point that is not
 * there; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_polydata_to_lines(iso_polydata *data, iso_lines *lines, iso_error *error);

/* Makes glyphs of the points. The polydata is used up. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_polydata_to_glyphs(iso_polydata *data, iso_glyphs *glyphs, iso_error *error);

void iso_polydata_free(iso_polydata *data);

/* Readers of single formats. Errors as iso_lines_read. */
iso_status iso_polydata_read_vtk(iso_polydata *data, iso_error *error);
iso_status iso_polydata_read_vtp(iso_polydata *data, iso_error *error);
iso_status iso_polydata_read_ply(iso_polydata *data, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
