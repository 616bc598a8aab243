/* image_file: pictures in files of the kind that the name's ending says, in either case: PNG (.png, and
 * "-" for standard output), TIFF (.tif, .tiff: deflate, 8 bits, with alpha if there is any), JPEG (.jpg,
 * .jpeg: full resolution of colours, quality 95; needs libjpeg), and the sheets SVG (.svg) and PDF (.pdf), in
 * which a picture is embedded. The bytes are the same for every number of threads. */
#ifndef ISO_IMAGE_IMAGE_FILE_H
#define ISO_IMAGE_IMAGE_FILE_H

#include "image/drawing.h"
#include "image/image.h"

typedef enum iso_image_kind {
    ISO_IMAGE_UNKNOWN,
    ISO_IMAGE_PNG,
    ISO_IMAGE_TIFF,
    ISO_IMAGE_JPEG,
    ISO_IMAGE_SVG,
    ISO_IMAGE_PDF
} iso_image_kind;

iso_image_kind iso_image_kind_of(const char *path);

/* Whether this build can write a picture of this name: else ISO_ERR_BACKEND names the library that is
 * missing. */
iso_status iso_image_file_check(const char *path, iso_error *error);

/* Writes a picture as iso_png_write_with does, with its texts and its resolution. ISO_ERR_USAGE for other
 * endings, and for a JPEG of a picture that is not opaque; ISO_ERR_BACKEND, ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_image_file_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                                iso_error *error);

/* Whether such a file is a sheet: its annotations are not pixels. */
bool iso_image_is_sheet(const char *path);

/* Writes a picture with a drawing over it: painted onto the picture, which is changed, or as the marks of a
 * sheet. Errors as above. */
iso_status iso_image_file_write_drawing(const char *path, iso_image *image, const iso_drawing *drawing,
                                        const iso_png_opts *opts, iso_error *error);

/* Reads a PNG or a JPEG, whichever its first bytes say, as 8-bit RGBA: a JPEG as the camera was held (Exif).
 * Gamma and colour profiles are ignored. ISO_ERR_IO, ISO_ERR_FORMAT (also for sides beyond ISO_IMAGE_MAX),
 * ISO_ERR_BACKEND, ISO_ERR_NOMEM. */
iso_status iso_image_file_read(const char *path, iso_image *image, iso_error *error);

/* Reads the first text that is not compressed and has this key (a tEXt or iTXt chunk, as iso_png_write writes
 * them); *text is the caller's: free(). ISO_ERR_IO; ISO_ERR_FORMAT: the file is no PNG, is damaged before the
 * text, or has no text of that key; ISO_ERR_NOMEM. */
iso_status iso_png_read_text(const char *path, const char *key, char **text, iso_error *error);

/* ---- the readers and writers that these call; ISO_ERR_USAGE: a side beyond ISO_IMAGE_MAX */

iso_status iso_jpeg_read(const char *path, iso_image *image, iso_error *error);

iso_status iso_tiff_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                          iso_error *error);
bool iso_jpeg_available(void);
iso_status iso_jpeg_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                          iso_error *error);

#endif
