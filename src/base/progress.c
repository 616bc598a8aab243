/* progress: maps fractions of a part to the whole operation, and calls the caller's function. */
#include "base/progress.h"

#include <stddef.h>

static double end_of(const iso_progress *progress) {
    return progress->to > 0 ? progress->to : 1;
}

iso_progress iso_progress_part(const iso_progress *whole, double from, double to) {
    if (!whole) return (iso_progress){0};
    const double length = end_of(whole) - whole->from;
    return (iso_progress){whole->tell, whole->context, whole->from + length * from,
                          whole->from + length * to};
}

iso_status iso_progress_tell(const iso_progress *progress, const char *name, double fraction,
                             iso_error *error) {
    if (!progress || !progress->tell) return ISO_OK;
    const double whole = progress->from + (end_of(progress) - progress->from) * fraction;
    if (!progress->tell(progress->context, whole)) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cancelled", name);
}

bool iso_progress_cancelled(const iso_progress *progress) {
    return progress && progress->tell && progress->tell(progress->context, -1) != 0;
}
