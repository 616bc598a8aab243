/* axis: round numbers for the scale below a histogram. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_AXIS_H
#define ISO_APPS_ISOSCULPT_WINDOW_AXIS_H

#include "base/c_linkage.h"

ISO_C_BEGIN

enum { ISOSCULPT_AXIS_TICKS = 12 };

/* Writes multiples of 1, 2 or 5 times a power of ten between low and high, at most `most` (<=
 * ISOSCULPT_AXIS_TICKS) of them, and returns their number; 0 for an empty or infinite range. */
int isosculpt_axis_ticks(double low, double high, int most, double ticks[ISOSCULPT_AXIS_TICKS]);

ISO_C_END
#endif
