/* vector_font: the characters of scale bar and orientation marker as line segments, which are sharp at every
 * size and the same on every machine. Internal to image. */
#ifndef ISO_IMAGE_VECTOR_FONT_H
#define ISO_IMAGE_VECTOR_FONT_H

/* Capitals are this many units tall; y grows downwards from their top. */
enum { ISO_FONT_HEIGHT = 6 };

enum { ISO_FONT_U = 1 };

/* One line of a character. The origin is the left end of the text, the unit that of ISO_FONT_HEIGHT. */
typedef struct iso_font_line {
    int x0, y0, x1, y1;
} iso_font_line;

/* The width of a text in units. The font has digits, letters and the signs . , : - + = ^ * / % _ ( ) [ ].
 * u is drawn as a Greek mu, as in um; the letter u is ISO_FONT_U. Other characters are blank. */
int iso_font_width(const char *text);

/* Writes the lines of a text to `lines`, at most `room` of them. Returns how many lines the text has. */
int iso_font_lines(const char *text, iso_font_line *lines, int room);

#endif
