/* pen: how hard a pen is pressed, which GLFW does not say: on X11 through XInput2. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PEN_H
#define ISO_APPS_ISOSCULPT_WINDOW_PEN_H

#include <stdbool.h>

typedef struct isosculpt_pen isosculpt_pen;

/* For the window system that GLFW has opened; NULL where there is none that tells. */
isosculpt_pen *isosculpt_pen_open(void);
void isosculpt_pen_close(isosculpt_pen *pen); /* NULL is fine */

/* Whether there was a device with pressure when it was last asked; pens come and go. */
bool isosculpt_pen_present(const isosculpt_pen *pen);

/* 0 .. 1 now; 1 when no pen is pressed: then it is a mouse that draws. */
double isosculpt_pen_pressure(isosculpt_pen *pen);

#endif
