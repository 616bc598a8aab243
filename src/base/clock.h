/* clock: measures durations. */
#ifndef ISO_BASE_CLOCK_H
#define ISO_BASE_CLOCK_H

/* Seconds since an arbitrary time, by a clock that is never adjusted: use differences. Thread-safe. */
double iso_clock_seconds(void);

#endif
