/* clock: how long something takes. */
#ifndef ISO_BASE_CLOCK_H
#define ISO_BASE_CLOCK_H

#ifdef __cplusplus
extern "C" {
#endif

/* Seconds of a clock that is never set: only differences mean anything. Thread-safe. */
double iso_clock_seconds(void);

#ifdef __cplusplus
}
#endif
#endif
