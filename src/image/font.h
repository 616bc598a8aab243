/* font: the letters of annotations: outlines of a TrueType font that is part of the library (font/sans.ttf:
 * Latin, Greek and Cyrillic, arrows, operators; its widths are those of Arial and Helvetica). One unit is
 * 1/2048 of the font's size. Thread-safe. */
#ifndef ISO_IMAGE_FONT_H
#define ISO_IMAGE_FONT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum {
    ISO_FONT_SIZE = 2048,     /* units of the font's size */
    ISO_FONT_CAPITALS = 1409, /* height of capital letters */
    ISO_FONT_ASCENT = 1854,
    ISO_FONT_DESCENT = 434,
    ISO_FONT_GLYPHS = 579
};
/* Bold letters are drawn with their outlines this wide, as a part of the font size. */
#define ISO_FONT_BOLD 0.05
enum { ISO_FONT_LONGEST = 400 }; /* characters of a text */

/* The font's file, as PDF files embed it. */
extern const uint8_t iso_font_file[];
extern const size_t iso_font_file_bytes;

/* Takes the next character of a text in UTF-8 and moves *text behind it; bytes that are no UTF-8 are taken
 * one by one as U+FFFD. 0: the text ends. */
uint32_t iso_font_next(const char **text);
/* The glyph of a character; 0: the font lacks it, and a box is drawn. */
int iso_font_glyph(uint32_t character);
int iso_font_advance(int glyph);         /* its width with the space around it, units */
double iso_font_width(const char *text); /* of a text in UTF-8, units */

/* A straight piece of an outline, in units; y grows upwards from the baseline. What is inside has a winding
 * number other than 0. */
typedef struct iso_font_edge {
    double x0, y0, x1, y1;
} iso_font_edge;
enum { ISO_FONT_EDGES = 1024 }; /* most edges of a glyph with 8 steps a curve */

/* Writes the outline of a glyph, whose curves are cut into `steps` pieces, 8 at most. Returns its edges. */
int iso_font_outline(int glyph, int steps, iso_font_edge edges[ISO_FONT_EDGES]);

#endif
