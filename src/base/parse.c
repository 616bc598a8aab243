/* Parses numbers with strtod, after checking that the text has the form of a decimal number. */
#include "base/parse.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* strtod accepts more than is accepted here. In the C locale, which the programs never leave. */
bool iso_parse_real_prefix(const char *text, double *out, const char **end) {
    size_t length = strspn(text, "0123456789+-.eE");
    if (length == 0) return false;
    char *stop = NULL;
    double value = strtod(text, &stop);
    if (stop == text || !isfinite(value)) return false;
    *out = value;
    *end = stop;
    return stop <= text + length;
}

bool iso_parse_real(const char *text, double *out) {
    double value;
    const char *end;
    if (!iso_parse_real_prefix(text, &value, &end) || *end) return false;
    *out = value;
    return true;
}

bool iso_parse_int(const char *text, int *out) {
    const char *digits = text + (*text == '-' || *text == '+');
    if (!*digits || digits[strspn(digits, "0123456789")]) return false;
    double value;
    if (!iso_parse_real(text, &value) || value < INT_MIN || value > INT_MAX) return false;
    *out = (int)value;
    return true;
}

/* Skips a comma with the blanks around it, or blanks. */
static const char *skip_separator(const char *text) {
    text += strspn(text, " ");
    if (*text == ',') text++;
    return text + strspn(text, " ");
}

bool iso_parse_reals(const char *text, int count, double *out) {
    enum { MOST = 16 };
    double values[MOST];
    if (count > MOST) return false;
    text += strspn(text, " ");
    for (int i = 0; i < count; i++) {
        const char *end;
        if (!iso_parse_real_prefix(text, &values[i], &end)) return false;
        text = i + 1 < count ? skip_separator(end) : end + strspn(end, " ");
        if (i + 1 < count && text == end) return false;
    }
    if (*text) return false;
    memcpy(out, values, (size_t)count * sizeof *out);
    return true;
}
