/* drawing: what lies over a picture as one list of marks: lines, polygons, text, further pictures. The list
 * is painted onto pixels (iso_drawing_paint), or written with text as text to SVG and PDF (drawing_write.h),
 * so that nothing is drawn twice.
 *
 * Positions and sizes are pixels; (0, 0) is the top left corner of the picture, y grows downwards. Marks
 * are drawn in their order. Painting samples every pixel at 8 x 8 points and blends in integers: the bytes
 * are the same on every machine. Functions that add a mark return it, or NULL without memory, which
 * `failed` keeps: ask iso_drawing_check once at the end. */
#ifndef ISO_IMAGE_DRAWING_H
#define ISO_IMAGE_DRAWING_H

#include <stdbool.h>

#include "image/image.h"

typedef enum iso_mark_kind {
    ISO_MARK_LINES,
    ISO_MARK_POLYGON,
    ISO_MARK_TEXT,
    ISO_MARK_PICTURE
} iso_mark_kind;

typedef struct iso_mark {
    iso_mark_kind kind;
    iso_rgb color, halo_color;
    double halo;         /* width of an outline in halo_color around it; 0: none */
    double width;        /* of LINES */
    double (*points)[2]; /* LINES: two for each; POLYGON: its corners. Owned */
    int point_count;
    char *text;        /* UTF-8, of characters that the font has (iso_drawing_check_text). Owned */
    double x, y, size; /* TEXT: left end of its baseline, size of the font */
    bool bold;
    iso_image picture; /* PICTURE: owned; its pixels fill the rectangle */
    double left, top, right, bottom;
} iso_mark;

typedef struct iso_drawing {
    iso_mark *marks;
    int count, room;
    bool failed; /* there was no memory */
} iso_drawing;

/* Lines that are blended only once where they cross; iso_drawing_line adds one to the mark. */
iso_mark *iso_drawing_lines(iso_drawing *drawing, iso_rgb color, double width);
void iso_drawing_line(iso_drawing *drawing, iso_mark *lines, double x0, double y0, double x1, double y1);
/* A closed polygon, filled, of `count` corners, copied. */
iso_mark *iso_drawing_polygon(iso_drawing *drawing, iso_rgb color, const double (*corners)[2], int count);
/* A text, copied, whose baseline begins at (x, y). */
iso_mark *iso_drawing_text(iso_drawing *drawing, const char *text, double x, double y, double size,
                           iso_rgb color);
/* Refuses a text that has no picture: ISO_ERR_USAGE; too long, not UTF-8, written from right to left, or a
 * character that the font lacks. */
iso_status iso_drawing_check_text(const char *text, iso_error *error);
/* A picture that fills a rectangle; it is moved into the drawing, which frees it, and is zeroed. */
iso_mark *iso_drawing_picture(iso_drawing *drawing, iso_image *picture, double left, double top, double right,
                              double bottom);

/* Appends the marks of `from`, moved by (x, y); `from` is empty then. */
void iso_drawing_append(iso_drawing *drawing, iso_drawing *from, double x, double y);
/* The box around all marks, without halos: left, top, right, bottom. An empty drawing has none:
 * left > right. */
void iso_drawing_box(const iso_drawing *drawing, double box[4]);
/* ISO_ERR_NOMEM: a mark could not be added. */
iso_status iso_drawing_check(const iso_drawing *drawing, iso_error *error);
void iso_drawing_free(iso_drawing *drawing);

/* A straight piece of the outline of a mark, or one of its lines. */
typedef struct iso_edge {
    double x0, y0, x1, y1;
} iso_edge;
/* Sets *edges to those of a mark that is no PICTURE, in their order around each outline; to be freed: free().
 * Returns their number; below 0: no memory. */
int iso_mark_edges(const iso_mark *mark, iso_edge **edges);

/* Paints all marks; what lies outside of the picture is cut off. ISO_ERR_NOMEM. */
iso_status iso_drawing_paint(const iso_drawing *drawing, iso_image *image, iso_error *error);

#endif
