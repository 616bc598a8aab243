/* drawing_write: drawings as files of SVG 1.1 and PDF 1.4, with text as text and pictures embedded. No
 * time, no name of a machine: the same drawing is the same file everywhere. */
#ifndef ISO_IMAGE_DRAWING_WRITE_H
#define ISO_IMAGE_DRAWING_WRITE_H

#include "image/drawing.h"

/* What a sheet is. */
typedef struct iso_sheet {
    int width, height;            /* pixels */
    double pixels_per_metre;      /* 0: 72 pixels an inch, so that a pixel is a point */
    const char *title, *software; /* UTF-8; NULL: none */
} iso_sheet;

/* Letters are those of Arial, Helvetica or Liberation Sans, which have the same widths, or another sans-serif
 * font where there are none of these. ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_svg_write(const char *path, const iso_drawing *drawing, const iso_sheet *sheet, iso_pool *pool,
                         iso_error *error);
/* The font is embedded. ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_pdf_write(const char *path, const iso_drawing *drawing, const iso_sheet *sheet, iso_pool *pool,
                         iso_error *error);

/* The size of a sheet in points (1/72 inch) for each pixel. */
double iso_sheet_points(const iso_sheet *sheet);

#endif
