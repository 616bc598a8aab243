/* stack: lists the images of a TIFF file, or of a folder of TIFF files, and checks that they fit together. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#include "grids/volume/tiff/tiff.h"

/* More images in one file than any program writes: a chain of headers may be endless. */
enum { MOST_PAGES = 1 << 20 };

/* ---- a header ---- */

/* The header that is being read. */
typedef struct header {
    iso_tiff_file *file;
    TIFF *tiff;
    const char *path;
    uint32_t page;
} header;

static iso_status unsupported(const header *h, iso_error *error, const char *what, unsigned value) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s, image %u: %s (%u) cannot be read as voxels", h->path,
                    h->page + 1, what, value);
}

static iso_status read_scalar(const header *h, iso_scalar *scalar, iso_error *error) {
    static const struct {
        uint16_t format, bits;
        iso_scalar scalar;
    } scalars[] = {
        {SAMPLEFORMAT_UINT, 8, ISO_SCALAR_UINT8},     {SAMPLEFORMAT_INT, 8, ISO_SCALAR_INT8},
        {SAMPLEFORMAT_UINT, 16, ISO_SCALAR_UINT16},   {SAMPLEFORMAT_INT, 16, ISO_SCALAR_INT16},
        {SAMPLEFORMAT_UINT, 32, ISO_SCALAR_UINT32},   {SAMPLEFORMAT_INT, 32, ISO_SCALAR_INT32},
        {SAMPLEFORMAT_UINT, 64, ISO_SCALAR_UINT64},   {SAMPLEFORMAT_INT, 64, ISO_SCALAR_INT64},
        {SAMPLEFORMAT_IEEEFP, 16, ISO_SCALAR_HALF},   {SAMPLEFORMAT_IEEEFP, 32, ISO_SCALAR_FLOAT},
        {SAMPLEFORMAT_IEEEFP, 64, ISO_SCALAR_DOUBLE},
    };
    uint16_t bits = 1, format = SAMPLEFORMAT_UINT;
    TIFFGetFieldDefaulted(h->tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(h->tiff, TIFFTAG_SAMPLEFORMAT, &format);
    if (format == SAMPLEFORMAT_VOID) format = SAMPLEFORMAT_UINT;
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++)
        if (scalars[i].format == format && scalars[i].bits == bits) {
            *scalar = scalars[i].scalar;
            return ISO_OK;
        }
    return format <= SAMPLEFORMAT_IEEEFP ? unsupported(h, error, "its bits a sample", bits)
                                         : unsupported(h, error, "its kind of numbers", format);
}

static iso_status read_layout(const header *h, iso_tiff_layout *layout, iso_error *error) {
    uint16_t planes = PLANARCONFIG_CONTIG, photometric = PHOTOMETRIC_MINISBLACK;
    layout->samples = 1;
    if (!TIFFGetField(h->tiff, TIFFTAG_IMAGEWIDTH, &layout->width) ||
        !TIFFGetField(h->tiff, TIFFTAG_IMAGELENGTH, &layout->height) || !layout->width || !layout->height)
        return iso_tiff_fail(h->file, h->page, "has no size", error);
    TIFFGetFieldDefaulted(h->tiff, TIFFTAG_SAMPLESPERPIXEL, &layout->samples);
    TIFFGetFieldDefaulted(h->tiff, TIFFTAG_PLANARCONFIG, &planes);
    TIFFGetField(h->tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    if (layout->samples == 0) return iso_tiff_fail(h->file, h->page, "has no samples", error);
    if (photometric == PHOTOMETRIC_YCBCR) return unsupported(h, error, "colours of video", photometric);
    layout->separate = planes == PLANARCONFIG_SEPARATE && layout->samples > 1;
    return read_scalar(h, &layout->scalar, error);
}

/* The bytes of a strip or tile of the current image. */
static iso_status measure_blocks(const header *h, const iso_tiff_layout *layout, uint64_t *bytes,
                                 iso_error *error) {
    uint32_t width = layout->width, height = layout->height, rows = 0;
    if (TIFFIsTiled(h->tiff)) {
        if (!TIFFGetField(h->tiff, TIFFTAG_TILEWIDTH, &width) ||
            !TIFFGetField(h->tiff, TIFFTAG_TILELENGTH, &height) || !width || !height)
            return iso_tiff_fail(h->file, h->page, "has tiles without a size", error);
    } else if (TIFFGetFieldDefaulted(h->tiff, TIFFTAG_ROWSPERSTRIP, &rows) && rows && rows < height) {
        height = rows;
    }
    const uint64_t pixel = iso_scalar_size(layout->scalar) * (layout->separate ? 1u : layout->samples);
    if (__builtin_mul_overflow((uint64_t)width * height, pixel, bytes) || *bytes > INT64_MAX)
        return iso_tiff_fail(h->file, h->page, "has blocks larger than any memory", error);
    return ISO_OK;
}

static bool is_same(const iso_tiff_layout *a, const iso_tiff_layout *b) {
    return a->width == b->width && a->height == b->height && a->scalar == b->scalar &&
           a->samples == b->samples && a->separate == b->separate;
}

/* Keeps why an image whose layout differs from the first one's cannot be a slice: it may be no slice. */
static void keep_difference(const header *h, const iso_tiff_layout *layout, iso_tiff_stack *stack) {
    const iso_tiff_layout *first = &stack->layout;
    if (stack->different.text[0]) return;
    iso_fail(&stack->different, ISO_ERR_FORMAT,
             "%s, image %u: is %u x %u %s with %u sample(s), but the first slice (%s) is %u x %u %s with %u",
             h->path, h->page + 1, layout->width, layout->height, iso_scalar_name(layout->scalar),
             layout->samples, stack->files.paths[stack->images[0].file], first->width, first->height,
             iso_scalar_name(first->scalar), first->samples);
}

/* ---- what only the first image tells ---- */

/* The distance of pixels by the resolution tags, whose unit is the inch, the centimetre, or ImageJ's. */
static double pixel_distance(const header *h, uint32_t tag, double imagej_unit) {
    float resolution = 0;
    uint16_t unit = RESUNIT_INCH;
    TIFFGetFieldDefaulted(h->tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
    const double mm = imagej_unit > 0              ? imagej_unit
                      : unit == RESUNIT_INCH       ? 25.4
                      : unit == RESUNIT_CENTIMETER ? 10
                                                   : 0;
    if (!TIFFGetField(h->tiff, tag, &resolution) || !(resolution > 0) || !isfinite(resolution)) return 0;
    return mm / (double)resolution;
}

static iso_status read_geometry(const header *h, iso_tiff_stack *stack, iso_error *error) {
    const char *description = NULL;
    TIFFGetField(h->tiff, TIFFTAG_IMAGEDESCRIPTION, &description);
    ISO_TRY(iso_tiff_metadata_parse(description, &stack->files, &stack->metadata, error));
    stack->resolution[0] = pixel_distance(h, TIFFTAG_XRESOLUTION, stack->metadata.unit);
    stack->resolution[1] = pixel_distance(h, TIFFTAG_YRESOLUTION, stack->metadata.unit);
    return ISO_OK;
}

/* ImageJ writes stacks of more than 4 GB with a header for the first image only; the values of all follow
 * one another. */
static void find_contiguous(const header *h, iso_tiff_stack *stack) {
    uint16_t compression = COMPRESSION_NONE;
    const uint64_t *offsets = NULL;
    TIFFGetFieldDefaulted(h->tiff, TIFFTAG_COMPRESSION, &compression);
    if (stack->metadata.images <= stack->count || compression != COMPRESSION_NONE || TIFFIsTiled(h->tiff) ||
        TIFFNumberOfStrips(h->tiff) != 1 || stack->layout.separate ||
        !TIFFGetField(h->tiff, TIFFTAG_STRIPOFFSETS, &offsets) || !offsets)
        return;
    stack->contiguous = offsets[0];
    stack->big_endian = TIFFIsBigEndian(h->tiff) != 0;
}

/* ---- all images ---- */

static iso_status add_image(iso_tiff_stack *stack, const header *h, uint32_t file, bool differs,
                            iso_error *error) {
    if (stack->count == stack->room) {
        const size_t room = stack->room ? 2 * stack->room : 256;
        iso_tiff_image *images = realloc(stack->images, room * sizeof *images);
        if (!images) return iso_fail_memory(error, h->path);
        stack->images = images;
        stack->room = room;
    }
    stack->images[stack->count++] = (iso_tiff_image){
        .file = file, .page = h->page, .header = TIFFCurrentDirOffset(h->tiff), .differs = differs};
    return ISO_OK;
}

static bool keeps_values(TIFF *tiff) {
    static const uint16_t exact[] = {COMPRESSION_NONE,    COMPRESSION_LZW,  COMPRESSION_PACKBITS,
                                     COMPRESSION_DEFLATE, COMPRESSION_LZMA, COMPRESSION_ADOBE_DEFLATE,
                                     COMPRESSION_ZSTD};
    uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++)
        if (compression == exact[i]) return true;
    return false;
}

/* Reads the header of the current image; reduced copies of other images are left out. */
static iso_status read_image(const header *h, uint32_t file, iso_tiff_stack *stack, iso_error *error) {
    uint32_t subtype = 0;
    iso_tiff_layout layout = {0};
    uint64_t bytes = 0;
    TIFFGetField(h->tiff, TIFFTAG_SUBFILETYPE, &subtype);
    if (subtype & FILETYPE_REDUCEDIMAGE) {
        stack->overviews++;
        return ISO_OK;
    }
    ISO_TRY(read_layout(h, &layout, error));
    if (stack->count == 0) {
        stack->layout = layout;
        ISO_TRY(read_geometry(h, stack, error));
    }
    stack->lossy |= !keeps_values(h->tiff);
    const bool differs = !is_same(&layout, &stack->layout);
    if (differs) keep_difference(h, &layout, stack);
    ISO_TRY(measure_blocks(h, &layout, &bytes, error));
    if (!differs && bytes > stack->block_bytes) stack->block_bytes = bytes;
    return add_image(stack, h, file, differs, error);
}

static iso_status check_damage(const header *h, iso_error *error) {
    const char *damage = iso_tiff_damage(h->file);
    if (!damage) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s, image %u: truncated or damaged: %s", h->path, h->page + 1,
                    damage);
}

/* Whether the file reaches to the end of the current header, where the position of the next header is.
 * libtiff takes a header that is cut there for the last one. */
static bool is_complete(TIFF *tiff) {
    const bool big = TIFFIsBigTIFF(tiff);
    const uint64_t at = TIFFCurrentDirOffset(tiff), first = big ? 8 : 2;
    struct stat file;
    uint64_t entries = 0;
    uint16_t short_entries = 0;
    void *count = big ? (void *)&entries : (void *)&short_entries;
    if (fstat(TIFFFileno(tiff), &file) != 0 ||
        pread(TIFFFileno(tiff), count, first, (off_t)at) != (ssize_t)first)
        return false;
    if (TIFFIsByteSwapped(tiff)) TIFFSwabShort(&short_entries), TIFFSwabLong8(&entries);
    entries += short_entries;
    const uint64_t size = (uint64_t)file.st_size, end = at + first + (big ? 8 : 4);
    return end <= size && entries <= (size - end) / (big ? 20 : 12);
}

/* Every header but the last names the position of the next one, which must be there. */
static iso_status read_pages(header *h, uint32_t file, iso_tiff_stack *stack, iso_error *error) {
    for (;; h->page++) {
        if (h->page == MOST_PAGES) return iso_tiff_fail(h->file, h->page, "there are too many images", error);
        ISO_TRY(check_damage(h, error));
        ISO_TRY(read_image(h, file, stack, error));
        const bool last = TIFFLastDirectory(h->tiff);
        if (last && is_complete(h->tiff)) break;
        if (last || !TIFFReadDirectory(h->tiff))
            return iso_fail(error, ISO_ERR_IO,
                            "%s: truncated or damaged: the header of image %u cannot be read", h->path,
                            h->page + 2);
    }
    if (stack->files.count > 1 || stack->count != 1) return ISO_OK;
    ISO_TRY(iso_tiff_set_image(h->file, &stack->images[0], error));
    find_contiguous(h, stack);
    return ISO_OK;
}

static iso_status read_file(uint32_t number, iso_tiff_stack *stack, iso_error *error) {
    header h = {.path = stack->files.paths[number]};
    enum { HEADER_MOST = 64 << 20 }; /* bytes of one tag */
    ISO_TRY(iso_tiff_open(h.path, HEADER_MOST, &h.file, error));
    h.tiff = iso_tiff_handle(h.file);
    iso_status status = read_pages(&h, number, stack, error);
    iso_tiff_close(h.file);
    return status;
}

iso_status iso_tiff_stack_open(const char *path, const iso_volume_opts *opts, iso_tiff_stack *stack,
                               iso_error *error) {
    *stack = (iso_tiff_stack){0};
    ISO_TRY(iso_slice_files_list(path, ISO_SLICES_TIFF, &stack->files, error));
    const uint32_t count = stack->files.count;
    for (uint32_t i = 0; i < count; i++) iso_file_set_read(opts->files, stack->files.paths[i]);
    for (uint32_t i = 0; i < count; i++) ISO_TRY(read_file(i, stack, error));
    if (stack->count == 0) return iso_fail(error, ISO_ERR_FORMAT, "%s: has no image", path);
    return ISO_OK;
}

void iso_tiff_stack_free(iso_tiff_stack *stack) {
    iso_slice_files_free(&stack->files);
    iso_tiff_metadata_free(&stack->metadata);
    free(stack->images);
    *stack = (iso_tiff_stack){0};
}
