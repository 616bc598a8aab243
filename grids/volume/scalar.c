/* scalar: the types of numbers in files: sizes, names, and conversion to the types of grids. */
#include <assert.h>
#include <string.h>

#include "grids/volume/format.h"

/* X(enumerator, C type, name, stored type, what makes a float of it) */
#define ISO_SCALAR_MAP(X)                                                                                    \
    X(UINT8, uint8_t, "uint8", UINT8, (float))                                                               \
    X(INT8, int8_t, "int8", INT16, (float))                                                                  \
    X(UINT16, uint16_t, "uint16", UINT16, (float))                                                           \
    X(INT16, int16_t, "int16", INT16, (float))                                                               \
    X(UINT32, uint32_t, "uint32", FLOAT32, (float))                                                          \
    X(INT32, int32_t, "int32", FLOAT32, (float))                                                             \
    X(UINT64, uint64_t, "uint64", FLOAT32, (float))                                                          \
    X(INT64, int64_t, "int64", FLOAT32, (float))                                                             \
    X(FLOAT, float, "float", FLOAT32, (float))                                                               \
    X(DOUBLE, double, "double", FLOAT32, (float))                                                            \
    X(HALF, half, "half", FLOAT32, float_of_half)

/* A number of 16 bits: sign, exponent (5), fraction (10). */
typedef struct half {
    uint16_t bits;
} half;

static float float_of_half(half number) {
    const uint32_t sign = (uint32_t)(number.bits & 0x8000) << 16, exponent = number.bits >> 10 & 31,
                   fraction = number.bits & 1023;
    uint32_t bits = sign | (exponent == 31 ? 255 : exponent + 112) << 23 | fraction << 13;
    float value;
    memcpy(&value, &bits, sizeof value);
    if (exponent) return value;
    value = (float)fraction * 0x1p-24f; /* zero, and what is too small for an exponent */
    return sign ? -value : value;
}

size_t iso_scalar_size(iso_scalar scalar) {
    switch (scalar) {
#define ISO_X(id, ctype, name, stored, convert)                                                              \
    case ISO_SCALAR_##id:                                                                                    \
        return sizeof(ctype);
        ISO_SCALAR_MAP(ISO_X)
#undef ISO_X
    }
    return 0;
}

const char *iso_scalar_name(iso_scalar scalar) {
    switch (scalar) {
#define ISO_X(id, ctype, name, stored, convert)                                                              \
    case ISO_SCALAR_##id:                                                                                    \
        return name;
        ISO_SCALAR_MAP(ISO_X)
#undef ISO_X
    }
    return "unknown";
}

iso_type iso_scalar_stored_type(iso_scalar scalar) {
    switch (scalar) {
#define ISO_X(id, ctype, name, stored, convert)                                                              \
    case ISO_SCALAR_##id:                                                                                    \
        return ISO_##stored;
        ISO_SCALAR_MAP(ISO_X)
#undef ISO_X
    }
    return ISO_FLOAT32;
}

bool iso_scalar_is_stored(iso_scalar scalar) {
    return scalar == ISO_SCALAR_UINT8 || scalar == ISO_SCALAR_UINT16 || scalar == ISO_SCALAR_INT16 ||
           scalar == ISO_SCALAR_FLOAT;
}

static inline void reverse(void *value, size_t bytes) {
    unsigned char *p = value;
    for (size_t i = 0; i < bytes / 2; i++) {
        unsigned char t = p[i];
        p[i] = p[bytes - 1 - i];
        p[bytes - 1 - i] = t;
    }
}

/* Converts value by value with memcpy, because the values of a file are not always aligned, and because
 * `data` may be the same memory as `target`, when values are converted in place. */
#define CONVERT(from, to, function)                                                                          \
    for (size_t i = 0; i < count; i++) {                                                                     \
        from value;                                                                                          \
        memcpy(&value, data + i * step, sizeof value);                                                       \
        if (source->swap) reverse(&value, sizeof value);                                                     \
        to result = function(value);                                                                         \
        memcpy((char *)target + i * sizeof result, &result, sizeof result);                                  \
    }

static void to_float(const iso_scalar_source *source, size_t count, void *target) {
    size_t size = iso_scalar_size(source->scalar), step = size * (size_t)source->components;
    const char *data = (const char *)source->data + size * (size_t)source->component;
    switch (source->scalar) {
#define ISO_X(id, ctype, name, stored, convert)                                                              \
    case ISO_SCALAR_##id:                                                                                    \
        CONVERT(ctype, float, convert)                                                                       \
        break;
        ISO_SCALAR_MAP(ISO_X)
#undef ISO_X
    }
}

void iso_scalar_convert(const iso_scalar_source *source, size_t count, iso_type type, void *target) {
    size_t size = iso_scalar_size(source->scalar), step = size * (size_t)source->components;
    const char *data = (const char *)source->data + size * (size_t)source->component;
    assert(type == ISO_FLOAT32 || type == iso_scalar_stored_type(source->scalar));
    if (type == ISO_FLOAT32 && source->scalar != ISO_SCALAR_FLOAT) {
        to_float(source, count, target);
    } else if (source->scalar == ISO_SCALAR_INT8) {
        CONVERT(int8_t, int16_t, (int16_t))
    } else if (source->components == 1 && (!source->swap || size == 1)) {
        if (target != source->data) memcpy(target, data, count * size);
    } else if (size == 1) {
        CONVERT(uint8_t, uint8_t, (uint8_t))
    } else if (size == 2) {
        CONVERT(uint16_t, uint16_t, (uint16_t))
    } else {
        CONVERT(uint32_t, uint32_t, (uint32_t))
    }
}

void iso_scalar_fill(iso_type type, float value, void *target, size_t count) {
    switch (type) {
    case ISO_UINT8:
        memset(target, (uint8_t)value, count);
        break;
    case ISO_INT16:
        for (size_t i = 0; i < count; i++) ((int16_t *)target)[i] = (int16_t)value;
        break;
    case ISO_UINT16:
        for (size_t i = 0; i < count; i++) ((uint16_t *)target)[i] = (uint16_t)value;
        break;
    case ISO_FLOAT32:
        for (size_t i = 0; i < count; i++) ((float *)target)[i] = value;
        break;
    }
}
