/* clock: measures how long something takes. */
#ifndef ISO_BASE_CLOCK_H
#define ISO_BASE_CLOCK_H

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the seconds of a clock that nobody sets, so that differences between two calls are right; the value
 * itself has no meaning. Thread-safe. */
double iso_clock_seconds(void);

#ifdef __cplusplus
}
#endif
#endif
