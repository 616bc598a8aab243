/* line_sink: collects lines while a file is read: vertices one after the other, in world coordinates, with
 * columns of numbers. Internal to src/io.
 *
 * A line of the file becomes one line, or several: a vertex with a coordinate that is not finite or beyond
 * ISO_FARTHEST is left out and ends a line, so that no segment bridges a gap. Lines of one vertex are kept,
 * lines without any are not. */
#ifndef ISO_IO_LINES_LINE_SINK_H
#define ISO_IO_LINES_LINE_SINK_H

#include "io/reading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise, then set reading and ras. */
typedef struct iso_line_sink {
    iso_reading *reading;
    bool ras;         /* x and y of vertices change sign */
    bool keep_floats; /* the file's numbers are floats: the origin stays 0, and they keep their bits */
    iso_vec3 origin;  /* set by the first vertex */
    iso_buffer vertices, starts;
    size_t vertex_count, line_count; /* so far; the open line is not counted */
    size_t first;                    /* first vertex of the open line */
    size_t first_made;               /* the first line of the file's line that is being read */
    bool skips;                      /* the open line is one that opts.every leaves out */
    iso_column *columns;             /* owned by the caller */
    int column_count;
} iso_line_sink;

/* Begins a line of the file: decides whether it is kept. */
void iso_line_sink_begin(iso_line_sink *sink);

/* Makes room for `count` more vertices, with their columns. */
iso_status iso_line_sink_reserve(iso_line_sink *sink, size_t count, iso_error *error);

/* Adds a vertex, for which there must be room, to the open line; splits the line if it is not usable. Columns
 * are the caller's, at index vertex_count - 1. False: the vertex was left out. */
bool iso_line_sink_vertex(iso_line_sink *sink, const double p[3]);

/* Ends the open line if it has vertices. Makes room for it in columns per line. */
iso_status iso_line_sink_split(iso_line_sink *sink, iso_error *error);

/* Moves everything into `lines`. */
iso_status iso_line_sink_finish(iso_line_sink *sink, iso_lines *lines, iso_error *error);

/* Frees what is left; also after iso_line_sink_finish. Columns too. */
void iso_line_sink_free(iso_line_sink *sink);

#ifdef __cplusplus
}
#endif
#endif
