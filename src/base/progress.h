/* progress: reports how far a long operation is, and lets the caller cancel it. A progress of NULL is allowed
 * everywhere; nothing is reported then. */
#ifndef ISO_BASE_PROGRESS_H
#define ISO_BASE_PROGRESS_H

#include <stdbool.h>

#include "base/status.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A callback that is told how much of an operation is done, and the range of the whole operation, `from` ..
 * `to`, that a part of it covers; both between 0 and 1, both 0: all of it. Functions that report from several
 * threads say so; `tell` must then be thread-safe. */
typedef struct iso_progress {
    iso_progress_fn *tell;
    void *context; /* borrowed */
    double from, to;
} iso_progress;

/* Returns the progress for the part of an operation between the fractions `from` and `to`, 0 <= from < to
 * <= 1. It reports nothing if `whole` is NULL. */
iso_progress iso_progress_part(const iso_progress *whole, double from, double to);

/* Reports that `fraction` of the operation, or part, is done. ISO_ERR_IO with the message "NAME: cancelled":
 * the caller has cancelled. */
iso_status iso_progress_tell(const iso_progress *progress, const char *name, double fraction,
                             iso_error *error);

/* Whether the caller wants to cancel; asks by calling `tell` with a fraction of -1. */
bool iso_progress_cancelled(const iso_progress *progress);

#ifdef __cplusplus
}
#endif
#endif
