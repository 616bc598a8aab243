/* png_text: reads the texts of a PNG file, without decoding the picture. */
#ifndef ISO_IMAGE_PNG_TEXT_H
#define ISO_IMAGE_PNG_TEXT_H

#include "base/status.h"

/* Reads the first text that is not compressed and has this key (a tEXt or iTXt chunk, as iso_png_write writes
 * them); *text is the caller's: free(). ISO_ERR_IO; ISO_ERR_FORMAT: the file is no PNG, is damaged before the
 * text, or has no text of that key; ISO_ERR_NOMEM. */
iso_status iso_png_read_text(const char *path, const char *key, char **text, iso_error *error);

#endif
