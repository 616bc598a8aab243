/* pixels: libtiff's files with messages of their own, and the values of an image in strips or tiles. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>

#include "base/memory.h"
#include "grids/volume/tiff/tiff.h"

/* ---- files ---- */

enum { MESSAGE = 200 };

struct iso_tiff_file {
    TIFF *tiff;
    char *path;
    char message[MESSAGE]; /* libtiff's last error */
};

static int keep_error(TIFF *tiff, void *context, const char *module, const char *format, va_list arguments) {
    iso_tiff_file *file = context;
    (void)tiff, (void)module;
    vsnprintf(file->message, sizeof file->message, format, arguments);
    return 1; /* handled: nothing is printed */
}

static int drop_warning(TIFF *tiff, void *context, const char *module, const char *format,
                        va_list arguments) {
    (void)tiff, (void)context, (void)module, (void)format, (void)arguments;
    return 1;
}

iso_status iso_tiff_open(const char *path, uint64_t most, iso_tiff_file **file, iso_error *error) {
    iso_tiff_file *opened = calloc(1, sizeof *opened);
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    *file = NULL;
    if (opened) opened->path = strdup(path);
    if (!opened || !opened->path || !options) {
        TIFFOpenOptionsFree(options);
        iso_tiff_close(opened);
        return iso_fail_memory(error, path);
    }
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, opened);
    TIFFOpenOptionsSetWarningHandlerExtR(options, drop_warning, opened);
    if (most) TIFFOpenOptionsSetMaxSingleMemAlloc(options, most < INT64_MAX ? (tmsize_t)most : INT64_MAX);
    opened->tiff = TIFFOpenExt(path, "rm", options); /* m: no memory map, whose pages count as memory */
    TIFFOpenOptionsFree(options);
    if (!opened->tiff) {
        const char *text = opened->message[0] ? opened->message : "cannot be read";
        iso_fail(error, ISO_ERR_IO, "%s: not a TIFF file, or damaged: %s", path, text);
        iso_tiff_close(opened);
        return ISO_ERR_IO;
    }
    *file = opened;
    return ISO_OK;
}

void iso_tiff_close(iso_tiff_file *file) {
    if (!file) return;
    if (file->tiff) TIFFClose(file->tiff);
    free(file->path);
    free(file);
}

struct tiff *iso_tiff_handle(iso_tiff_file *file) {
    return file->tiff;
}

iso_status iso_tiff_set_page(iso_tiff_file *file, uint32_t page, iso_error *error) {
    if (TIFFCurrentDirectory(file->tiff) == page || TIFFSetDirectory(file->tiff, page)) return ISO_OK;
    return iso_tiff_fail(file, page, "its header cannot be read", error);
}

iso_status iso_tiff_fail(const iso_tiff_file *file, uint32_t page, const char *text, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s, image %u: %s", file->path, page + 1,
                    file->message[0] ? file->message : text);
}

/* ---- values ---- */

/* Part of an image that is stored together: a strip, which is as wide as the image, or a tile. */
typedef struct blocks {
    uint32_t width, height;        /* pixels of a block */
    uint32_t across;               /* number of blocks side by side */
    size_t pixel_bytes, row_bytes; /* of a pixel and a row of pixels in a block */
} blocks;

static blocks blocks_of(TIFF *tiff, const iso_tiff_layout *layout) {
    blocks b = {.width = layout->width, .height = layout->height, .across = 1};
    if (TIFFIsTiled(tiff)) {
        TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &b.width);
        TIFFGetField(tiff, TIFFTAG_TILELENGTH, &b.height);
        b.across = (layout->width - 1) / b.width + 1;
    } else {
        uint32_t rows = 0;
        TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &rows);
        if (rows && rows < b.height) b.height = rows;
    }
    b.pixel_bytes = iso_scalar_size(layout->scalar) * (layout->separate ? 1 : layout->samples);
    b.row_bytes = b.pixel_bytes * b.width;
    return b;
}

/* Converts the rows of a block that lie in the image. Values are in the machine's byte order: libtiff swaps
 * them. */
static void convert_block(const iso_tiff_layout *layout, const blocks *b, uint32_t number, int sample,
                          const void *block, iso_type type, void *target) {
    const uint32_t x = number % b->across * b->width, y = number / b->across * b->height;
    const uint32_t columns = layout->width - x < b->width ? layout->width - x : b->width;
    const uint32_t rows = layout->height - y < b->height ? layout->height - y : b->height;
    for (uint32_t row = 0; row < rows; row++) {
        const iso_scalar_source source = {.data = (const char *)block + row * b->row_bytes,
                                          .scalar = layout->scalar,
                                          .components = layout->separate ? 1 : layout->samples,
                                          .component = layout->separate ? 0 : sample};
        const size_t first = (size_t)(y + row) * layout->width + x;
        iso_scalar_convert(&source, columns, type, (char *)target + first * iso_type_size(type));
    }
}

iso_status iso_tiff_read_pixels(iso_tiff_file *file, const iso_tiff_stack *stack, uint32_t page, int sample,
                                void *block, iso_type type, void *target, iso_error *error) {
    const iso_tiff_layout *layout = &stack->layout;
    const bool tiled = TIFFIsTiled(file->tiff) != 0;
    const blocks b = blocks_of(file->tiff, layout);
    const uint32_t count = b.across * ((layout->height - 1) / b.height + 1);
    const uint32_t first = layout->separate ? count * (uint32_t)sample : 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t y = i / b.across * b.height;
        const uint32_t rows = tiled || layout->height - y > b.height ? b.height : layout->height - y;
        const tmsize_t bytes = (tmsize_t)(b.row_bytes * rows);
        if ((uint64_t)bytes > stack->block_bytes)
            return iso_tiff_fail(file, page, "changed while it was read", error);
        const tmsize_t got = tiled ? TIFFReadEncodedTile(file->tiff, first + i, block, bytes)
                                   : TIFFReadEncodedStrip(file->tiff, first + i, block, bytes);
        if (got != bytes) return iso_tiff_fail(file, page, "truncated or damaged", error);
        convert_block(layout, &b, i, sample, block, type, target);
    }
    return ISO_OK;
}
