#include "image/image_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/decimal_point.h"
#include "base/file.h"
#include "base/file_types.h"
#include "image/drawing_write.h"

iso_image_kind iso_image_kind_of(const char *path) {
    if (strcmp(path, "-") == 0) return ISO_IMAGE_PNG;
    switch (iso_file_type_of_name(path, ISO_WRITES_IMAGE)) {
#define WRITE_IMAGE(kind) return ISO_IMAGE_##kind;
#include "base/file_types.inc"
    default:
        break;
    }
    return ISO_IMAGE_UNKNOWN;
}

iso_status iso_image_file_read(const char *path, iso_image *image, iso_error *error) {
    uint8_t first[3] = {0};
    FILE *stream;
    ISO_TRY(iso_file_open(path, &stream, NULL, error));
    const bool whole = fread(first, 1, sizeof first, stream) == sizeof first;
    fclose(stream);
    return whole && memcmp(first, "\xff\xd8\xff", sizeof first) == 0 ? iso_jpeg_read(path, image, error)
                                                                     : iso_png_read(path, image, error);
}

iso_status iso_image_file_check(const char *path, iso_error *error) {
    if (iso_image_kind_of(path) != ISO_IMAGE_JPEG || iso_jpeg_available()) return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: built without libjpeg: .png and .tif need no library", path);
}

bool iso_image_is_sheet(const char *path) {
    const iso_image_kind kind = iso_image_kind_of(path);
    return kind == ISO_IMAGE_SVG || kind == ISO_IMAGE_PDF;
}

static const char *text_of(const iso_png_opts *opts, const char *key) {
    for (int i = 0; opts && i < opts->text_count; i++)
        if (strcmp(opts->texts[i].key, key) == 0) return opts->texts[i].value;
    return NULL;
}

/* Writes a sheet: the picture and, over it, the marks of `over`, which are not changed. */
static iso_status write_sheet(const char *path, const iso_image *image, const iso_drawing *over,
                              const iso_png_opts *opts, iso_error *error) {
    const iso_sheet sheet = {.width = image->width,
                             .height = image->height,
                             .pixels_per_metre = opts ? opts->pixels_per_metre : 0,
                             .title = text_of(opts, "Title"),
                             .software = text_of(opts, "Software")};
    iso_mark *marks = calloc((size_t)(over ? over->count : 0) + 1, sizeof *marks);
    if (!marks) return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", path);
    marks[0] = (iso_mark){
        .kind = ISO_MARK_PICTURE, .picture = *image, .right = image->width, .bottom = image->height};
    if (over && over->count) memcpy(marks + 1, over->marks, (size_t)over->count * sizeof *marks);
    const iso_drawing all = {.marks = marks, .count = 1 + (over ? over->count : 0)};
    iso_status (*write)(const char *, const iso_drawing *, const iso_sheet *, iso_pool *, iso_error *) =
        iso_image_kind_of(path) == ISO_IMAGE_PDF ? iso_pdf_write : iso_svg_write;
    void *locale = iso_decimal_point_begin();
    const iso_status status = write(path, &all, &sheet, opts ? opts->pool : NULL, error);
    iso_decimal_point_end(locale);
    free(marks);
    return status;
}

iso_status iso_image_file_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                                iso_error *error) {
    switch (iso_image_kind_of(path)) {
    case ISO_IMAGE_PNG:
        return iso_png_write_with(path, image, opts, error);
    case ISO_IMAGE_TIFF:
        return iso_tiff_write(path, image, opts, error);
    case ISO_IMAGE_JPEG:
        if (!iso_image_is_opaque(image))
            return iso_fail(error, ISO_ERR_USAGE, "%s: a JPEG has no transparency: .png and .tif have", path);
        return iso_jpeg_write(path, image, opts, error);
    case ISO_IMAGE_SVG:
    case ISO_IMAGE_PDF:
        return write_sheet(path, image, NULL, opts, error);
    case ISO_IMAGE_UNKNOWN:
        break;
    }
    return iso_fail(error, ISO_ERR_USAGE, "%s: a picture's name ends in .png, .tif, .jpg, .svg or .pdf",
                    path);
}

iso_status iso_image_file_write_drawing(const char *path, iso_image *image, const iso_drawing *drawing,
                                        const iso_png_opts *opts, iso_error *error) {
    ISO_TRY(iso_drawing_check(drawing, error));
    if (iso_image_is_sheet(path)) return write_sheet(path, image, drawing, opts, error);
    ISO_TRY(iso_drawing_paint(drawing, image, error));
    return iso_image_file_write(path, image, opts, error);
}
