/* html: text and bytes as HTML and SVG have them. Write errors are found by who closes the stream. */
#ifndef ISO_BASE_HTML_H
#define ISO_BASE_HTML_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Writes text that may hold any bytes, for an element or within quotes: on one line, as iso_text_clean writes
 * it, with & < > and quotes escaped. */
void iso_html_text(FILE *stream, const char *text);

/* Writes bytes in base64, as in a data: URL. */
void iso_html_base64(FILE *stream, const uint8_t *bytes, size_t size);

#endif
