/* polydata: points with columns of numbers, and polylines that refer to points by number, as most formats of
 * lines and of glyphs have them (the word is VTK's). A reader fills the polydata, which is then converted to
 * lines or to glyphs. Internal to src/io. */
#ifndef ISO_IO_POLYDATA_POLYDATA_H
#define ISO_IO_POLYDATA_POLYDATA_H

#include "base/glyphs.h"
#include "io/common/reading.h"

/* Zero-initialise, then set `reading`; iso_polydata_free when done. */
typedef struct iso_polydata {
    iso_reading *reading;
    iso_space stated; /* the space that the file states; ISO_SPACE_FILE for none */
    bool keep_floats; /* coordinates are floats in the file: the origin stays 0, so that points keep their
                         exact values */
    bool points_only; /* lines are not wanted, so readers may skip them */
    /* Of .ply: how many points make a closed surface; 0: it is not known whether they do. */
    uint64_t closed_points;
    bool packed_gaussians; /* Gaussians whose "opacity" is 0 .. 1 and whose "scale" is logarithmic */
    struct iso_faces
        *surface; /* of .vtk, .vtp and .off: polygons and strips are added to it, and columns are skipped;
                                  NULL: polygons are not wanted (io/polydata/faces.h) */
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

/* The place of a number of a row, or of a property of PLY. */
typedef struct iso_slot {
    int column, component; /* column: ISO_SLOT_SKIP, or ISO_SLOT_POINT for coordinate `component` */
} iso_slot;
enum { ISO_SLOT_POINT = -1, ISO_SLOT_SKIP = -2 };

/* Adds columns for the numbers with these names, in the order of a row, and finds the slot of each number. x
 * y z (or Points:0 .., Points_0 .. of ParaView, easting northing elevation or height) are the point. nx ny nz
 * (normal_x .., NormalX .., Normals:0 ..), vx vy vz, red green blue (r g b, diffuse_red .., rf gf bf),
 * scale_0 .. 2 (or only 0 and 1), rot_0 .. 3 and f_dc_0 .. 2 form one column each if all their names are
 * present. Every other name becomes a column of its own; NULL is skipped. Case is ignored, and so are a unit
 * in brackets behind a name and the mark of a comment before it. ISO_ERR_FORMAT: a coordinate is missing. */
iso_status iso_polydata_name_columns(iso_polydata *data, const char *const *names, int count, iso_slot *slots,
                                     iso_error *error);

/* Joins three columns of one number each, `first` and the two behind it, to one of three numbers, which takes
 * their place. The points must have been read. ISO_ERR_LIMIT, ISO_ERR_NOMEM: nothing has changed. */
iso_status iso_polydata_join_columns(iso_polydata *data, int first, const char *name, iso_role role,
                                     iso_error *error);

/* The factor that brings colours to 0 .. 255 whose largest number is `most`: they have 16 bits if it is
 * above 255. `fractions`: they may be floats of 0 .. 1, which they are unless it is above 2. (Computed ones
 * can be a little above 1 or 255.) */
float iso_polydata_color_factor(float most, bool fractions);
/* Sets this factor of the column of colours, if there is one. */
void iso_polydata_scale_colors(iso_polydata *data, bool fractions);

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

/* Joins edges (pairs of point numbers) to polylines, which continue through points with two edges and end at
 * all others. Lines run in the edges' directions where these agree. `singles`: points without edges become
 * lines of one vertex. ISO_ERR_FORMAT: a point number is out of range. */
iso_status iso_polydata_add_edges(iso_polydata *data, const uint32_t (*edges)[2], size_t count, bool singles,
                                  iso_error *error);

/* Converts the polylines to lines. The polydata cannot be used afterwards. ISO_ERR_FORMAT: a line refers to a
 * point that does not exist; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_polydata_to_lines(iso_polydata *data, iso_lines *lines, iso_error *error);

/* Whether so many of `count` points at exactly 0 0 0 mean that nothing was measured there. A few such points
 * may be real, also all of them. */
static inline bool iso_zeros_are_unmeasured(size_t zeros, size_t count) {
    return zeros >= 10 && zeros >= count / 100 && zeros < count;
}

/* Converts the points to glyphs. The polydata cannot be used afterwards. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_polydata_to_glyphs(iso_polydata *data, iso_glyphs *glyphs, iso_error *error);

void iso_polydata_free(iso_polydata *data);

/* The readers of single formats, of all those of glyphs (base/file_types.inc): fill the polydata, whose
 * `reading` is set. Errors as for iso_lines_read. */
#define GLYPHS(reader) iso_status iso_polydata_read_##reader(iso_polydata *data, iso_error *error);
#define FILE_TYPE(name, extensions, magic, handlers) handlers
#include "base/file_types.inc"

/* What a .vtp file has, judged by its first 64 KiB. */
typedef enum iso_vtp_cells {
    ISO_VTP_UNKNOWN, /* it cannot be read, is of another kind, or has nothing */
    ISO_VTP_POINTS,  /* points alone */
    ISO_VTP_FACES,   /* polygons or strips, and no lines */
    ISO_VTP_LINES
} iso_vtp_cells;
iso_vtp_cells iso_vtp_find_cells(const char *path);

#endif
