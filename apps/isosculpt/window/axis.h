/* axis: round numbers along a range, for the scale under a histogram. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_AXIS_H
#define ISO_APPS_ISOSCULPT_WINDOW_AXIS_H

#ifdef __cplusplus
extern "C" {
#endif

enum { ISOSCULPT_TICKS = 12 };

/* Multiples of 1, 2 or 5 times a power of ten in low .. high, at most `most` (<= ISOSCULPT_TICKS) of them;
 * how many. 0 for a range that is none. */
int isosculpt_axis_ticks(double low, double high, int most, double ticks[ISOSCULPT_TICKS]);

#ifdef __cplusplus
}
#endif
#endif
