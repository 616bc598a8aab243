/* line_sink: collects lines while a file is read: their vertices in world coordinates, one after the other,
 * with columns of numbers. Internal to src/io.
 *
 * A line of the file can become several lines: a vertex with a coordinate that is not finite or beyond
 * ISO_FARTHEST is left out and ends the line, so that no segment bridges the gap. Lines of one vertex are
 * kept, lines without vertices are not. */
#ifndef ISO_IO_COMMON_LINE_SINK_H
#define ISO_IO_COMMON_LINE_SINK_H

#include "io/common/reading.h"

/* Zero-initialise, then set reading and ras. */
typedef struct iso_line_sink {
    iso_reading *reading;
    bool ras;         /* the signs of x and y are changed, from RAS to LPS */
    bool keep_floats; /* the file's coordinates are floats: the origin stays 0, so that vertices keep their
                         exact values */
    iso_vec3 origin;  /* set by the first vertex */
    iso_buffer vertices, starts;
    size_t vertex_count, line_count; /* so far; the open line is not counted */
    size_t first;                    /* first vertex of the open line */
    size_t first_made;               /* the first line made of the current line of the file */
    bool skips;                      /* the current line is left out because of opts.every */
    iso_column *columns;             /* owned by the caller */
    int column_count;
} iso_line_sink;

/* Begins a line of the file, and decides by opts.every whether it is kept. */
void iso_line_sink_begin(iso_line_sink *sink);

/* Makes room for `count` more vertices, with their columns. */
iso_status iso_line_sink_reserve(iso_line_sink *sink, size_t count, iso_error *error);

/* Adds a vertex to the open line; there must be room. If the vertex is not usable it is left out, the line is
 * split there, and false is returned. The caller sets the vertex's columns, at index vertex_count - 1. */
bool iso_line_sink_vertex(iso_line_sink *sink, const double p[3]);

/* Ends the open line if it has vertices, and makes room for it in the columns per line. */
iso_status iso_line_sink_split(iso_line_sink *sink, iso_error *error);

/* Moves everything into `lines`. */
iso_status iso_line_sink_finish(iso_line_sink *sink, iso_lines *lines, iso_error *error);

/* Frees everything that is left, including columns; also after iso_line_sink_finish. */
void iso_line_sink_free(iso_line_sink *sink);

#endif
