/* scalar_load: loads numbers of any type in either byte order. */
#ifndef ISO_GRIDS_VOLUME_SCALAR_LOAD_H
#define ISO_GRIDS_VOLUME_SCALAR_LOAD_H

#include <string.h>

#include "grids/volume/format.h"

/* Returns the number at `bytes`; 64-bit integers are rounded to doubles. */
static inline double iso_scalar_load(const void *bytes, iso_scalar scalar, bool big_endian) {
    const unsigned char *at = (const unsigned char *)bytes;
    const size_t size = iso_scalar_size(scalar);
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++) bits = bits << 8 | at[big_endian ? i : size - 1 - i];
    switch (scalar) {
    case ISO_SCALAR_INT8:
        return (int8_t)bits;
    case ISO_SCALAR_INT16:
        return (int16_t)bits;
    case ISO_SCALAR_INT32:
        return (int32_t)bits;
    case ISO_SCALAR_INT64:
        return (double)(int64_t)bits;
    case ISO_SCALAR_FLOAT: {
        const uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, sizeof value);
        return (double)value;
    }
    case ISO_SCALAR_DOUBLE: {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    default:
        return (double)bits;
    }
}

#endif
