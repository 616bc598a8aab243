/* placing: where something that stands over a picture covers the least of what the picture shows. */
#ifndef ISO_IMAGE_PLACING_H
#define ISO_IMAGE_PLACING_H

#include "image/drawing.h"

/* A picture, and the drawings over it. */
typedef struct iso_placing {
    const iso_image
        *under; /* its pixels of the background colour, and those of alpha 0, are free; borrowed */
    iso_rgb background;
    int width, height;       /* of the picture */
    double margin;           /* at the picture's edges, pixels */
    const iso_drawing *over; /* borrowed */
    int count, movable;      /* of the drawings behind `movable` lines do not count, as of rulers */
    double (*moved)[2];      /* by how many pixels each movable one is moved so far, to the right and down */
} iso_placing;

/* Sets by[2] to how far a drawing is to be moved, in whole pixels, to a place: 0, where it is, or a corner or
 * the middle of the left or right side. */
void iso_placing_move(const iso_placing *placing, const iso_drawing *drawing, int place, double by[2]);

/* Returns the place where the marks of a movable drawing cover the least of the picture and of the other
 * drawings, and sets its `moved`; of equal ones where it is, else a corner, if it is at one, or a side, if it
 * is there, and of these the nearest. Sets *covered to the share of the marks' boxes in which the picture
 * shows something. An empty drawing stays. */
int iso_placing_choose(const iso_placing *placing, int which, double *covered);

#endif
