/* srgb: the transfer function between display values, as in PNG files, and linear light (IEC 61966-2-1), with
 * the same bits on every machine. */
#ifndef ISO_BASE_SRGB_H
#define ISO_BASE_SRGB_H

#include "base/exponential.h"

/* base^exponent for a base above 0 and a result below 2^127, with a relative error of at most 2e-7. */
static inline double iso_srgb_power(double base, double exponent) {
    return (double)iso_exp2((float)(iso_log2(base) * exponent));
}

/* Converts a display value 0 .. 1 to linear light 0 .. 1. */
static inline double iso_srgb_decode(double value) {
    return value <= 0.04045 ? value / 12.92 : iso_srgb_power((value + 0.055) / 1.055, 2.4);
}

/* Converts linear light 0 .. 1 to a display value 0 .. 1; values outside are clamped. */
static inline double iso_srgb_encode(double light) {
    if (!(light > 0)) return 0;
    if (light >= 1) return 1;
    return light <= 0.0031308 ? light * 12.92 : 1.055 * iso_srgb_power(light, 1 / 2.4) - 0.055;
}

#endif
