/* picture: draws the picture and the panel, and writes screenshots. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PICTURE_H
#define ISO_APPS_ISOSCULPT_WINDOW_PICTURE_H

#include "apps/isosculpt/window/state.h"

/* Draws the picture, if it has changed or can be refined, and the panel over it. Errors end the program. */
iso_status isosculpt_window_draw(window *w, iso_error *error);

/* Seconds until the picture is to be drawn in a better quality; <= 0: now. */
double isosculpt_window_seconds_until_refine(const window *w);

#endif
