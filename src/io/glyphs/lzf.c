/* lzf: a control byte below 32 announces that many literal bytes and one; every other control byte has a
 * length in its upper 3 bits (7: a further byte is added) and, in its lower 5 bits and the next byte, how far
 * back the repeated bytes begin. */
#include "io/glyphs/lzf.h"

#include <string.h>

bool iso_lzf_decompress(const unsigned char *from, size_t from_bytes, unsigned char *to, size_t to_bytes) {
    const unsigned char *const from_end = from + from_bytes;
    unsigned char *const begin = to, *const to_end = to + to_bytes;
    while (from < from_end) {
        const size_t control = *from++;
        if (control < 32) {
            const size_t length = control + 1;
            if (length > (size_t)(from_end - from) || length > (size_t)(to_end - to)) return false;
            memcpy(to, from, length);
            from += length;
            to += length;
            continue;
        }
        size_t length = control >> 5;
        if (length == 7 && from < from_end) length += *from++;
        if (from == from_end) return false;
        const size_t back = ((control & 31) << 8 | *from++) + 1;
        length += 2;
        if (back > (size_t)(to - begin) || length > (size_t)(to_end - to)) return false;
        const unsigned char *repeated = to - back;
        for (size_t i = 0; i < length; i++) to[i] = repeated[i]; /* the ranges may overlap */
        to += length;
    }
    return to == to_end;
}
