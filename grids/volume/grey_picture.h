/* grey_picture: a PNG file of greys by itself (format_png.c); a volume is a folder of them. */
#ifndef ISO_GRIDS_VOLUME_GREY_PICTURE_H
#define ISO_GRIDS_VOLUME_GREY_PICTURE_H

#include <stdint.h>

#include "base/status.h"

/* The largest width and height. */
enum { ISO_GREY_PICTURE_MOST = 16384 };

/* Reads the greys, the upper row first, as values of 16 bits: those of 8 are multiplied by 257. The caller
 * frees *values (iso_free). ISO_ERR_IO; ISO_ERR_FORMAT: it is no PNG; ISO_ERR_UNSUPPORTED: it has colours or
 * opacities; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_grey_picture_read(const char *path, int *width, int *height, uint16_t **values,
                                 iso_error *error);

#endif
