/* progress: how far long work is, told to whoever waits for it and may cancel it. NULL is allowed everywhere:
 * nobody waits. */
#ifndef ISO_BASE_PROGRESS_H
#define ISO_BASE_PROGRESS_H

#include <stdbool.h>

#include "base/status.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A function that is told how far the work is, and what share of the whole work this is: from `from` to `to`,
 * both between 0 and 1 (both 0: all of it). A function that reports from several threads says so; `tell` must
 * then be thread-safe. */
typedef struct iso_progress {
    iso_progress_fn *tell;
    void *context; /* borrowed */
    double from, to;
} iso_progress;

/* A part of the work, 0 <= from < to <= 1. Tells nobody when `whole` is NULL. */
iso_progress iso_progress_part(const iso_progress *whole, double from, double to);

/* Tells; ISO_ERR_IO "NAME: cancelled" when it is. */
iso_status iso_progress_tell(const iso_progress *progress, const char *name, double fraction,
                             iso_error *error);

/* Whether it is cancelled. */
bool iso_progress_cancelled(const iso_progress *progress);

#ifdef __cplusplus
}
#endif
#endif
