/* picture_grid: pictures of one size in rows and columns, with titles: the layout of sheets of panels and of
 * contact sheets. */
#ifndef ISO_SCENE_PICTURE_GRID_H
#define ISO_SCENE_PICTURE_GRID_H

#include "image/drawing.h"

typedef struct iso_picture_grid {
    int count, columns; /* columns 0: up to 3, or about as many as rows */
    int panel[2];       /* width and height of a picture, pixels */
    double font;        /* size of the font, pixels; 0: by the size of a picture */
    bool below;         /* titles stand below their pictures, not above */
    iso_rgb background;
    bool transparent;
    /* Set by iso_picture_grid_lay_out: */
    double text, margin, band; /* height of capitals, space around pictures, and between rows; pixels */
    int rows, width, height;   /* of the sheet, pixels */
} iso_picture_grid;

/* Chooses the columns, and computes the sheet's size. ISO_ERR_LIMIT names `option` (--panels) when the sheet
 * is too large, or takes more than `limit` bytes with all its pictures. */
iso_status iso_picture_grid_lay_out(iso_picture_grid *grid, const char *option, uint64_t limit,
                                    iso_error *error);

/* Fills the sheet with the background. */
void iso_picture_grid_fill(const iso_picture_grid *grid, iso_image *sheet);
/* Where the picture of this number begins, pixels: x and y. */
void iso_picture_grid_corner(const iso_picture_grid *grid, int number, int corner[2]);
/* Copies a picture into the sheet; it may be smaller than the others. */
void iso_picture_grid_place(const iso_picture_grid *grid, int number, const iso_image *picture,
                            iso_image *sheet);
/* Draws a title, cut to the picture's width, behind a bold `letter` (0: none), and `right` at the other end
 * of the line (NULL: nothing). */
void iso_picture_grid_title(const iso_picture_grid *grid, int number, char letter, const char *title,
                            const char *right, iso_drawing *over);
/* Writes text into `cut`, of `room` bytes: as much of it as is at most `pixels` wide, with an ellipsis where
 * some is left out. Returns how many bytes of it were taken. */
size_t iso_picture_grid_cut(const iso_picture_grid *grid, const char *text, double pixels, char *cut,
                            size_t room);

#endif
