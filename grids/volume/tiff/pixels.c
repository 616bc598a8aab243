/* pixels: libtiff's files with messages of their own, and the values of an image in strips or tiles. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

#include "base/file.h"
#include "grids/volume/tiff/tiff.h"

/* ---- files ---- */

enum { MESSAGE = 200 };

struct iso_tiff_file {
    TIFF *tiff;
    char *path;
    char message[MESSAGE]; /* libtiff's last error */
    char damage[MESSAGE];  /* iso_tiff_damage */
};

static int keep_error(TIFF *tiff, void *context, const char *module, const char *format, va_list arguments) {
    iso_tiff_file *file = context;
    (void)tiff, (void)module;
    vsnprintf(file->message, sizeof file->message, format, arguments);
    return 1; /* handled: nothing is printed */
}

/* Keeps the warnings that the volume would be another one, and drops all others. Tags that libtiff does not
 * know are called "Tag N": nothing here reads them. */
static int keep_warning(TIFF *tiff, void *context, const char *module, const char *format,
                        va_list arguments) {
    iso_tiff_file *file = context;
    char text[MESSAGE];
    (void)tiff, (void)module;
    vsnprintf(text, sizeof text, format, arguments);
    text[strcspn(text, ";")] = 0; /* "; tag ignored" */
    if ((strstr(text, "IO error") && !strstr(text, "\"Tag ")) || strstr(text, "IFD loop"))
        memcpy(file->damage, text, sizeof text);
    return 1;
}

/* The descriptor is the library's when it has opened the file, else closed. */
static iso_status open_descriptor(const char *path, int descriptor, const char *mode, uint64_t most,
                                  iso_tiff_file **file, iso_error *error) {
    iso_tiff_file *opened = calloc(1, sizeof *opened);
    TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
    *file = NULL;
    if (opened) opened->path = strdup(path);
    if (!opened || !opened->path || !options) {
        TIFFOpenOptionsFree(options);
        iso_tiff_close(opened);
        close(descriptor);
        return iso_fail_memory(error, path);
    }
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, opened);
    TIFFOpenOptionsSetWarningHandlerExtR(options, keep_warning, opened);
    if (most) TIFFOpenOptionsSetMaxSingleMemAlloc(options, most < INT64_MAX ? (tmsize_t)most : INT64_MAX);
    /* m: no memory map, whose pages count as memory */
    opened->tiff = TIFFFdOpenExt(descriptor, path, mode, options);
    TIFFOpenOptionsFree(options);
    if (!opened->tiff) {
        close(descriptor);
        const char *text = opened->message[0] ? opened->message : "cannot be read";
        iso_fail(error, ISO_ERR_IO, "%s: not a TIFF file, or damaged: %s", path, text);
        iso_tiff_close(opened);
        return ISO_ERR_IO;
    }
    *file = opened;
    return ISO_OK;
}

iso_status iso_tiff_open(const char *path, uint64_t most, iso_tiff_file **file, iso_error *error) {
    int descriptor;
    *file = NULL;
    ISO_TRY(iso_file_descriptor(path, &descriptor, NULL, error));
    return open_descriptor(path, descriptor, "rm", most, file, error);
}

iso_status iso_tiff_open_to_change(const char *path, int descriptor, iso_tiff_file **file, iso_error *error) {
    return open_descriptor(path, descriptor, "r+m", 0, file, error);
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

/* TIFFSetDirectory would read all headers from the first one on. */
iso_status iso_tiff_set_image(iso_tiff_file *file, const iso_tiff_image *image, iso_error *error) {
    if (TIFFCurrentDirOffset(file->tiff) == image->header || TIFFSetSubDirectory(file->tiff, image->header))
        return ISO_OK;
    return iso_tiff_fail(file, image->page, "its header cannot be read", error);
}

const char *iso_tiff_damage(const iso_tiff_file *file) {
    return file->damage[0] ? file->damage : NULL;
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

void iso_tiff_block_size(iso_tiff_file *file, const iso_tiff_layout *layout, uint32_t *width,
                         uint32_t *height) {
    const blocks b = blocks_of(file->tiff, layout);
    *width = b.width;
    *height = b.height < layout->height ? b.height : layout->height;
}

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Converts the pixels of the block at (x, y) that lie in the image and in the box. Values are in the
 * machine's byte order: libtiff swaps them. */
static void convert_block(const iso_tiff_layout *layout, const blocks *b, const uint32_t at[2],
                          const void *block, const iso_tiff_target *target) {
    const iso_tiff_box *box = &target->box;
    const uint32_t x0 = at[0] > box->x ? at[0] : box->x, y0 = at[1] > box->y ? at[1] : box->y;
    const uint32_t x1 = least(least(layout->width - at[0], b->width) + at[0], box->x + box->width);
    const uint32_t y1 = least(least(layout->height - at[1], b->height) + at[1], box->y + box->height);
    for (uint32_t y = y0; y < y1; y++) {
        const iso_scalar_source source = {.data = (const char *)block + (y - at[1]) * b->row_bytes +
                                                  (x0 - at[0]) * b->pixel_bytes,
                                          .scalar = layout->scalar,
                                          .components = layout->separate ? 1 : layout->samples,
                                          .component = layout->separate ? 0 : target->sample};
        const size_t first = (size_t)(y - box->y) * box->width + (x0 - box->x);
        iso_scalar_convert(&source, x1 - x0, target->type,
                           (char *)target->data + first * iso_type_size(target->type));
    }
}

static iso_status read_block(iso_tiff_file *file, const iso_tiff_stack *stack, uint32_t page, const blocks *b,
                             const uint32_t at[2], void *block, const iso_tiff_target *target,
                             iso_error *error) {
    const iso_tiff_layout *layout = &stack->layout;
    const bool tiled = TIFFIsTiled(file->tiff) != 0;
    const uint32_t down = (layout->height - 1) / b->height + 1;
    const uint32_t first = layout->separate ? b->across * down * (uint32_t)target->sample : 0;
    const uint32_t number = first + at[1] / b->height * b->across + at[0] / b->width;
    const uint32_t rows = tiled ? b->height : least(layout->height - at[1], b->height);
    const tmsize_t bytes = (tmsize_t)(b->row_bytes * rows);
    if ((uint64_t)bytes > stack->block_bytes)
        return iso_tiff_fail(file, page, "changed while it was read", error);
    const tmsize_t got = tiled ? TIFFReadEncodedTile(file->tiff, number, block, bytes)
                               : TIFFReadEncodedStrip(file->tiff, number, block, bytes);
    if (got != bytes) return iso_tiff_fail(file, page, "truncated or damaged", error);
    convert_block(layout, b, at, block, target);
    return ISO_OK;
}

iso_status iso_tiff_read_box(iso_tiff_file *file, const iso_tiff_stack *stack, uint32_t page, void *block,
                             const iso_tiff_target *target, iso_error *error) {
    const iso_tiff_layout *layout = &stack->layout;
    const iso_tiff_box *box = &target->box;
    const blocks b = blocks_of(file->tiff, layout);
    const uint32_t width = least(layout->width - box->x, box->width),
                   height = least(layout->height - box->y, box->height);
    for (uint32_t y = box->y / b.height; y <= (box->y + height - 1) / b.height; y++)
        for (uint32_t x = box->x / b.width; x <= (box->x + width - 1) / b.width; x++) {
            const uint32_t at[2] = {x * b.width, y * b.height};
            ISO_TRY(read_block(file, stack, page, &b, at, block, target, error));
        }
    return ISO_OK;
}
