/* clock: measures durations. */
#ifndef ISO_BASE_CLOCK_H
#define ISO_BASE_CLOCK_H

#ifdef __cplusplus
extern "C" {
#endif

/* Seconds since an arbitrary time, by a clock that is never adjusted: use differences. Thread-safe. */
double iso_clock_seconds(void);

#ifdef __cplusplus
}
#endif
#endif
