/* exponential: powers of two and logarithms to base 2 with the same bits on every machine: libm's differ
 * between its versions. exponential_simd.h has the power for vectors. */
#ifndef ISO_BASE_EXPONENTIAL_H
#define ISO_BASE_EXPONENTIAL_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Coefficients of x, x^2, .. x^6 of a polynomial for 2^x - 1 in [-0.5, 0.5]: an interpolation at Chebyshev
 * points, with a relative error of 2^x below 1e-7. */
#define ISO_EXP2_1 0.693147182f
#define ISO_EXP2_2 0.240226507f
#define ISO_EXP2_3 0.0555035695f
#define ISO_EXP2_4 0.00961808302f
#define ISO_EXP2_5 0.00133908633f
#define ISO_EXP2_6 0.000154531634f

/* 2^x for x <= 127, to about 2e-7 of the result; below 2^-126 the result is 2^-126. NaN gives 2^-126. */
static inline float iso_exp2(float x) {
    x = x > -126 ? x : -126;
    const float whole = floorf(x + 0.5f), part = x - whole;
    const int32_t bits = ((int32_t)whole + 127) << 23;
    float power, series = ISO_EXP2_6;
    series = series * part + ISO_EXP2_5;
    series = series * part + ISO_EXP2_4;
    series = series * part + ISO_EXP2_3;
    series = series * part + ISO_EXP2_2;
    series = series * part + ISO_EXP2_1;
    memcpy(&power, &bits, sizeof power);
    return (series * part + 1) * power;
}

#include "base/c_linkage.h"

ISO_C_BEGIN

/* Returns the logarithm to base 2 of a positive normal number. The error is below about 1e-15, absolute for
 * results up to 1 and relative for larger ones. */
double iso_log2(double x);

ISO_C_END
#endif
