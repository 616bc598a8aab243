/* encode: shared by the writers and readers of this folder: numbers as little-endian bytes, one-line
 * comments. Internal to src/io. */
#ifndef ISO_IO_COMMON_ENCODE_H
#define ISO_IO_COMMON_ENCODE_H

#include <stdint.h>
#include <stdio.h>

#include "base/geometry.h"

/* Store a value at `bytes`, and return the address after it. */
unsigned char *iso_encode_uint32(unsigned char *bytes, uint32_t value);
unsigned char *iso_encode_float(unsigned char *bytes, float value);
unsigned char *iso_encode_double(unsigned char *bytes, double value);
unsigned char *iso_encode_vec3(unsigned char *bytes, iso_vec3 v); /* as three floats */

/* Writes `prefix`, the text made one line of printable UTF-8 (base/text.h), and a line end; nothing when text
 * is NULL. */
void iso_encode_comment(FILE *stream, const char *prefix, const char *text);

#endif
