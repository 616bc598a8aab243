/* encode: little-endian numbers and comments. */
#include "io/common/encode.h"

#include <string.h>

#include "base/text.h"

unsigned char *iso_encode_uint32(unsigned char *bytes, uint32_t value) {
    for (int i = 0; i < 4; i++) bytes[i] = (unsigned char)(value >> (8 * i));
    return bytes + 4;
}

unsigned char *iso_encode_float(unsigned char *bytes, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return iso_encode_uint32(bytes, bits);
}

unsigned char *iso_encode_double(unsigned char *bytes, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bytes = iso_encode_uint32(bytes, (uint32_t)bits);
    return iso_encode_uint32(bytes, (uint32_t)(bits >> 32));
}

unsigned char *iso_encode_vec3(unsigned char *bytes, iso_vec3 v) {
    bytes = iso_encode_float(bytes, (float)v.x);
    bytes = iso_encode_float(bytes, (float)v.y);
    return iso_encode_float(bytes, (float)v.z);
}

void iso_encode_comment(FILE *stream, const char *prefix, const char *text) {
    if (!text) return;
    fputs(prefix, stream);
    iso_text_put(stream, text);
    fputc('\n', stream);
}
