/* pen: the pressure of a pen, which GLFW does not report. On X11 by XInput2; elsewhere there is none. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PEN_H
#define ISO_APPS_ISOSCULPT_WINDOW_PEN_H

#include <stdbool.h>

typedef struct isosculpt_pen isosculpt_pen;

/* For the window system that GLFW has opened; NULL: it reports no pressure. The functions below take NULL. */
isosculpt_pen *isosculpt_pen_open(void);
void isosculpt_pen_close(isosculpt_pen *pen);

/* Whether a device with pressure was connected at the last call of isosculpt_pen_pressure. */
bool isosculpt_pen_present(const isosculpt_pen *pen);

/* The pressure now, 0 .. 1; 1 when no pen is pressed, since then a mouse draws. */
double isosculpt_pen_pressure(isosculpt_pen *pen);

#endif
