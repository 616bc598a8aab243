/* vector_font: the few characters that are written into pictures, as strokes: the same on every machine, and
 * sharp at every size. Internal to image. */
#ifndef ISO_IMAGE_VECTOR_FONT_H
#define ISO_IMAGE_VECTOR_FONT_H

#ifdef __cplusplus
extern "C" {
#endif

/* Capitals are this many units tall; y grows downwards from their top. */
enum { ISO_FONT_HEIGHT = 6 };

/* A line of a character, from one end to the other, in units from the text's left end. */
typedef struct iso_font_line {
    int x0, y0, x1, y1;
} iso_font_line;

/* Width of a text in units: digits, '.', ' ', the letters of lengths (k m n and u, which is drawn as the
 * Greek mu) and of axes (L R A P H F x y z). Other characters are blanks. */
int iso_font_width(const char *text);

/* Puts the lines of a text into `lines`, of which there are `room`; returns how many there are. */
int iso_font_lines(const char *text, iso_font_line *lines, int room);

#ifdef __cplusplus
}
#endif
#endif
