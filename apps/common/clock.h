/* clock: the time, for measuring how long something takes. */
#ifndef ISO_APPS_COMMON_CLOCK_H
#define ISO_APPS_COMMON_CLOCK_H

#ifdef __cplusplus
extern "C" {
#endif

/* Seconds of a monotonic clock, since an arbitrary moment. Any thread. */
double iso_clock_seconds(void);

#ifdef __cplusplus
}
#endif
#endif
