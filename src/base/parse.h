/* parse: numbers in the values of options and in the headers of stroke files. */
#ifndef ISO_BASE_PARSE_H
#define ISO_BASE_PARSE_H

#include <stdbool.h>

/* Parses the real number that `text` begins with; *end: what follows it. The rules are those of
 * iso_parse_real. */
bool iso_parse_real_prefix(const char *text, double *out, const char **end);

/* Parse a text that consists of one decimal number: a finite real number, or a whole one. Blanks, hexadecimal
 * numbers, inf and nan are refused. False, and *out untouched, when `text` is anything else. */
bool iso_parse_real(const char *text, double *out);
bool iso_parse_int(const char *text, int *out);

/* Parses exactly `count` (at most 16) real numbers, separated by commas or blanks. False: `out` is untouched.
 */
bool iso_parse_reals(const char *text, int count, double *out);

#endif
