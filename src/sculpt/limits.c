/* The table of limits.h, looked up. */
#include "sculpt/limits.h"

#include <string.h>

typedef struct range {
    const char *name;
    double low, high;
    const char *unit;
} range;

static const range RANGES[] = {
#define ISO_LIMIT_RANGE(name, text, low, high, unit) {text, low, high, unit},
    ISO_STROKE_LIMITS(ISO_LIMIT_RANGE)
#undef ISO_LIMIT_RANGE
};

iso_status iso_limit_check(iso_limit limit, double value, double voxel, iso_error *error) {
    const range *r = &RANGES[limit];
    const bool length = strcmp(r->unit, "voxels") == 0;
    const double compared = length ? value / voxel : value;
    if (compared >= r->low && compared <= r->high) return ISO_OK;
    if (length)
        return iso_fail(error, ISO_ERR_FORMAT, "%s %g mm: must be %g .. %g voxels of %g mm", r->name, value,
                        r->low, r->high, voxel);
    return iso_fail(error, ISO_ERR_FORMAT, "%s %g%s%s: must be %g .. %g", r->name, value, *r->unit ? " " : "",
                    r->unit, r->low, r->high);
}
