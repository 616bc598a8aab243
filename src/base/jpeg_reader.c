/* libjpeg reports errors by a callback that must not return: a function that calls setjmp keeps everything
 * that is needed after the jump in a struct of its caller, which also frees it. */
#include "base/jpeg_reader.h"

#include <errno.h>
#include <setjmp.h>
#include <stdio.h> /* before jpeglib.h, which needs it */
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

#include <jerror.h>

#include "base/file.h"
#include "base/memory.h"

/* Progressive files may have any number of scans, each of which costs as much as the picture. */
enum { MOST_SCANS = 500 };

struct iso_jpeg {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    FILE *stream;
    char *path;
    iso_jpeg_header header;
    /* The first failure. */
    jmp_buf escape;
    char text[JMSG_LENGTH_MAX];
    bool ended;         /* the file is shorter than the picture */
    bool out_of_memory; /* libjpeg could not allocate */
    bool unsupported;   /* the text names what cannot be read */
};

static void on_error(j_common_ptr jpeg) {
    iso_jpeg *r = jpeg->client_data;
    const int code = jpeg->err->msg_code;
    jpeg->err->format_message(jpeg, r->text);
    r->ended = code == JWRN_JPEG_EOF || code == JERR_INPUT_EMPTY || code == JERR_INPUT_EOF;
    r->out_of_memory = code == JERR_OUT_OF_MEMORY;
    r->unsupported = code == JERR_BAD_PRECISION || code == JERR_SOF_UNSUPPORTED || code == JERR_ARITH_NOTIMPL;
    longjmp(r->escape, 1);
}

/* Warnings (level -1) on pixels that are made up are errors. */
static void on_message(j_common_ptr jpeg, int level) {
    const int code = jpeg->err->msg_code;
    if (level < 0 && code != JWRN_ADOBE_XFORM && code != JWRN_JFIF_MAJOR && code != JWRN_TOO_MUCH_DATA)
        on_error(jpeg);
}

static void refuse(iso_jpeg *r) {
    r->unsupported = true;
    longjmp(r->escape, 1);
}

static void count_scans(j_common_ptr jpeg) {
    iso_jpeg *r = jpeg->client_data;
    if (r->jpeg.input_scan_number <= MOST_SCANS) return;
    snprintf(r->text, sizeof r->text, "has more than %d scans, which no program writes", MOST_SCANS);
    refuse(r);
}

/* A row of pixels, libjpeg's buffers of some 20 rows, and the coefficients of a file with several scans: two
 * bytes for each, in blocks of up to 32 x 32. */
static uint64_t scratch_bytes(struct jpeg_decompress_struct *jpeg) {
    enum { LIBRARY_BYTES = 1 << 18, ROWS = 20 };
    const uint64_t width = jpeg->image_width + 31u, height = jpeg->image_height + 31u,
                   samples = (uint64_t)jpeg->num_components;
    return LIBRARY_BYTES + ROWS * width * samples +
           (jpeg_has_multiple_scans(jpeg) ? 2 * width * height * samples : 0);
}

/* A number of a TIFF block of `size` bytes: 0 where that ends. */
static uint32_t get_number(const uint8_t *tiff, size_t size, size_t at, int bytes) {
    const bool little = size && tiff[0] == 'I';
    uint32_t value = 0;
    if (at + (size_t)bytes > size) return 0;
    for (int i = 0; i < bytes; i++) value = value << 8 | tiff[at + (size_t)(little ? bytes - 1 - i : i)];
    return value;
}

/* The orientation of Exif 2.3, section 4.6: entry 0x112 of the first directory of the TIFF block in the first
 * APP1 marker. */
static int find_orientation(const struct jpeg_decompress_struct *jpeg) {
    enum { MARK = 6, ENTRY = 12, ORIENTATION = 0x112 };
    const jpeg_saved_marker_ptr exif = jpeg->marker_list;
    if (!exif || exif->data_length < MARK || memcmp(exif->data, "Exif\0", MARK) != 0) return 1;
    const uint8_t *tiff = exif->data + MARK;
    const size_t size = exif->data_length - MARK, directory = get_number(tiff, size, 4, 4);
    const uint32_t count = get_number(tiff, size, directory, 2);
    for (uint32_t i = 0; i < count; i++) {
        const size_t entry = directory + 2 + (size_t)ENTRY * i;
        const uint32_t value = get_number(tiff, size, entry + 8, 2);
        if (get_number(tiff, size, entry, 2) == ORIENTATION) return value >= 1 && value <= 8 ? (int)value : 1;
    }
    return 1;
}

static bool read_header(iso_jpeg *r) {
    struct jpeg_decompress_struct *jpeg = &r->jpeg;
    if (setjmp(r->escape)) return false;
    jpeg_create_decompress(jpeg);
    jpeg_stdio_src(jpeg, r->stream);
    jpeg_save_markers(jpeg, JPEG_APP0 + 1, 0xffff);
    jpeg_read_header(jpeg, TRUE);
    const bool grey = jpeg->jpeg_color_space == JCS_GRAYSCALE;
    if (!grey && jpeg->jpeg_color_space != JCS_YCbCr && jpeg->jpeg_color_space != JCS_RGB) {
        snprintf(r->text, sizeof r->text,
                 "its colours are those of inks (CMYK): save it as greys, or as RGB");
        refuse(r);
    }
    jpeg->out_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
    jpeg->dct_method = JDCT_ISLOW;
    r->header = (iso_jpeg_header){.width = jpeg->image_width,
                                  .height = jpeg->image_height,
                                  .samples = grey ? 1 : 3,
                                  .scratch = scratch_bytes(jpeg),
                                  .orientation = find_orientation(jpeg)};
    return true;
}

static iso_status fail_reading(const iso_jpeg *r, iso_error *error) {
    const char *path = r->path;
    if (r->out_of_memory) return iso_fail_memory(error, path);
    if (ferror(r->stream)) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(EIO));
    if (r->ended) return iso_fail(error, ISO_ERR_IO, "%s: truncated: the JPEG file ends too early", path);
    if (r->unsupported) return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, r->text);
    return iso_fail(error, ISO_ERR_IO, "%s: damaged, or no JPEG file: %s", path, r->text);
}

void iso_jpeg_close(iso_jpeg *r) {
    jpeg_destroy_decompress(&r->jpeg);
    if (r->stream) fclose(r->stream);
    free(r->path);
    iso_free(r);
}

iso_status iso_jpeg_open(const char *path, iso_jpeg **opened, iso_jpeg_header *header, iso_error *error) {
    iso_jpeg *r = iso_alloc_zero(1, sizeof *r);
    if (!r) return iso_fail_memory(error, path);
    r->jpeg.err = jpeg_std_error(&r->errors);
    r->errors.error_exit = on_error;
    r->errors.emit_message = on_message;
    r->jpeg.client_data = r;
    r->path = strdup(path);
    iso_status status = r->path ? iso_file_open(path, &r->stream, NULL, error) : iso_fail_memory(error, path);
    if (status == ISO_OK && !read_header(r)) status = fail_reading(r, error);
    if (status == ISO_OK) {
        *header = r->header;
        *opened = r;
    } else
        iso_jpeg_close(r);
    return status;
}

static bool read_rows(iso_jpeg *r, JSAMPROW pixels, iso_jpeg_row *row, void *context) {
    struct jpeg_decompress_struct *jpeg = &r->jpeg;
    if (setjmp(r->escape)) return false;
    jpeg->progress = &r->progress;
    r->progress.progress_monitor = count_scans;
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < r->header.height) {
        const uint32_t y = jpeg->output_scanline;
        jpeg_read_scanlines(jpeg, &pixels, 1);
        row(context, y, pixels);
    }
    jpeg_finish_decompress(jpeg);
    return true;
}

iso_status iso_jpeg_read_rows(iso_jpeg *r, iso_jpeg_row *row, void *context, iso_error *error) {
    JSAMPROW pixels = iso_alloc((size_t)r->header.width * (size_t)r->header.samples);
    if (!pixels) return iso_fail_memory(error, r->path);
    const iso_status status = read_rows(r, pixels, row, context) ? ISO_OK : fail_reading(r, error);
    iso_free(pixels);
    return status;
}
