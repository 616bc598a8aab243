/* progress: reports how far a long operation is, and lets the caller cancel it. A NULL iso_progress is
 * allowed everywhere: nothing is reported then. */
#ifndef ISO_BASE_PROGRESS_H
#define ISO_BASE_PROGRESS_H

#include <stdbool.h>

#include "base/c_linkage.h"
#include "base/status.h"
#include "isopoint.h"

ISO_C_BEGIN

/* The caller's function for progress, and the part of the whole operation that is being done: from `from` to
 * `to`, both between 0 and 1 (both 0: the whole). `tell` must be thread-safe if it is passed to a function
 * that says that it reports from several threads. */
typedef struct iso_progress {
    iso_progress_fn *tell;
    void *context; /* borrowed */
    double from, to;
} iso_progress;

/* The progress of a part of an operation, 0 <= from < to <= 1. Reports nothing when `whole` is NULL. */
iso_progress iso_progress_part(const iso_progress *whole, double from, double to);

/* Reports that `fraction` of this part is done. Returns ISO_ERR_IO with "NAME: cancelled" when the caller
 * cancels. */
iso_status iso_progress_tell(const iso_progress *progress, const char *name, double fraction,
                             iso_error *error);

/* Returns whether the operation is to be cancelled: asks the caller's function, with the fraction -1. */
bool iso_progress_cancelled(const iso_progress *progress);

ISO_C_END
#endif
