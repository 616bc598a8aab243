/* exponential_simd: iso_exp2 (base/exponential.h) for vectors, with the same bits. For kernels. */
#ifndef ISO_BASE_EXPONENTIAL_SIMD_H
#define ISO_BASE_EXPONENTIAL_SIMD_H

#include "base/exponential.h"
#include "base/simd.h"

ISO_INLINE vf v_exp2(vf x) {
    x = v_max(x, v_set(-126));
    const vi whole = v_floor(x + 0.5f);
    const vf part = x - v_to_float(whole);
    vf series = v_set(ISO_EXP2_6);
    series = series * part + ISO_EXP2_5;
    series = series * part + ISO_EXP2_4;
    series = series * part + ISO_EXP2_3;
    series = series * part + ISO_EXP2_2;
    series = series * part + ISO_EXP2_1;
    return (series * part + 1) * v_floats((whole + 127) << 23);
}

#endif
