/* Text and bytes in HTML. */
#include "base/html.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"

void iso_html_text(FILE *stream, const char *text) {
    static const char special[] = "&<>\"'";
    static const char *const names[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    char *clean = iso_text_clean_copy(text);
    for (const char *c = clean ? clean : "?"; *c; c++) {
        const char *found = strchr(special, *c);
        if (found)
            fputs(names[found - special], stream);
        else
            fputc(*c, stream);
    }
    free(clean);
}

void iso_html_base64(FILE *stream, const uint8_t *bytes, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const unsigned value = (unsigned)bytes[i] << 16 | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                               (left > 2 ? bytes[i + 2] : 0);
        char four[4];
        for (int k = 0; k < 4; k++)
            four[k] = k <= (int)(left < 3 ? left : 3) ? digits[value >> (18 - 6 * k) & 63] : '=';
        fwrite(four, 1, 4, stream);
    }
}
