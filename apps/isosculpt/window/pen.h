/* pen: the pressure of a pen, which GLFW does not report. It is read by XInput2 on X11; other window systems
 * report none. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PEN_H
#define ISO_APPS_ISOSCULPT_WINDOW_PEN_H

#include <stdbool.h>

typedef struct isosculpt_pen isosculpt_pen;

/* Opens the pen for the window system that GLFW uses; NULL: it reports no pressure. The functions below
 * accept NULL. */
isosculpt_pen *isosculpt_pen_open(void);
void isosculpt_pen_close(isosculpt_pen *pen);

/* Whether a device with pressure was connected at the last call of isosculpt_pen_pressure. */
bool isosculpt_pen_present(const isosculpt_pen *pen);

/* Returns the current pressure, 0 .. 1; 1 when no pen is pressed, because a mouse draws then. */
double isosculpt_pen_pressure(isosculpt_pen *pen);

#endif
