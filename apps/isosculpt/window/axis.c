/* Axis ticks: multiples of a step of 1, 2 or 5 times a power of ten. */
#include "apps/isosculpt/window/axis.h"

#include <math.h>

/* The smallest step of 1, 2 or 5 times a power of ten that is at least `least`. */
static double round_step(double least) {
    const double power = pow(10, floor(log10(least)));
    for (int i = 0; i < 3; i++) {
        static const double factors[] = {1, 2, 5};
        if (factors[i] * power >= least) return factors[i] * power;
    }
    return 10 * power;
}

int isosculpt_axis_ticks(double low, double high, int most, double ticks[ISOSCULPT_AXIS_TICKS]) {
    int count = 0;
    if (!(high > low) || !isfinite(high - low) || most < 1) return 0;
    const double step = round_step((high - low) / most), first = ceil(low / step);
    if (!(step > 0)) return 0;
    for (int i = 0; i <= most && count < most && count < ISOSCULPT_AXIS_TICKS; i++)
        if ((first + i) * step <= high) ticks[count++] = (first + i) * step;
    return count;
}
