/* format_jpeg: reads a folder of JPEG files, a slice each (grids/volume/image_stack.h): greys, and colours as
 * components. Their density is ignored, because cameras and programs state 72 dots an inch of anything. A
 * file from which libjpeg would make up pixels, because it is cut or damaged, is refused.
 *
 * libjpeg reports errors by a callback that must not return: a function that calls setjmp keeps everything
 * that is needed after the jump in a struct of its caller, which also frees it. */
#include <errno.h>
#include <setjmp.h>
#include <stdio.h> /* before jpeglib.h, which needs it */
#include <string.h>

#include <jpeglib.h>

#include <jerror.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/image_stack.h"

/* Progressive files may have any number of scans, each of which costs as much as the picture. */
enum { MOST_SCANS = 500 };

/* A file that is open for reading, after its header. */
typedef struct reader {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    FILE *stream;
    iso_image_header header;
    /* The first failure. */
    jmp_buf escape;
    char text[JMSG_LENGTH_MAX];
    bool ended;         /* the file is shorter than the picture */
    bool out_of_memory; /* libjpeg could not allocate */
    bool unsupported;   /* the text names what cannot be read */
} reader;

static void on_error(j_common_ptr jpeg) {
    reader *r = jpeg->client_data;
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

static void refuse(reader *r) {
    r->unsupported = true;
    longjmp(r->escape, 1);
}

static void count_scans(j_common_ptr jpeg) {
    reader *r = jpeg->client_data;
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

static bool read_header(reader *r) {
    struct jpeg_decompress_struct *jpeg = &r->jpeg;
    if (setjmp(r->escape)) return false;
    jpeg_create_decompress(jpeg);
    jpeg_stdio_src(jpeg, r->stream);
    jpeg_read_header(jpeg, TRUE);
    const bool grey = jpeg->jpeg_color_space == JCS_GRAYSCALE;
    if (!grey && jpeg->jpeg_color_space != JCS_YCbCr && jpeg->jpeg_color_space != JCS_RGB) {
        snprintf(r->text, sizeof r->text,
                 "its colours are those of inks (CMYK): save it as greys, or as RGB");
        refuse(r);
    }
    jpeg->out_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
    jpeg->dct_method = JDCT_ISLOW;
    r->header = (iso_image_header){
        .layout = {jpeg->image_width, jpeg->image_height, ISO_SCALAR_UINT8, grey ? 1 : 3},
        .scratch = scratch_bytes(jpeg),
        .note = "JPEG does not keep values: they are as far off as its compression was strong"};
    return true;
}

static iso_status fail_reading(const reader *r, const char *path, iso_error *error) {
    if (r->out_of_memory) return iso_fail_memory(error, path);
    if (ferror(r->stream)) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(EIO));
    if (r->ended) return iso_fail(error, ISO_ERR_IO, "%s: truncated: the JPEG file ends too early", path);
    if (r->unsupported) return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, r->text);
    return iso_fail(error, ISO_ERR_IO, "%s: damaged, or no JPEG file: %s", path, r->text);
}

static void close_jpeg(reader *r) {
    jpeg_destroy_decompress(&r->jpeg);
    if (r->stream) fclose(r->stream);
    iso_free(r);
}

/* Opens a file and reads its header. close_jpeg when done. */
static iso_status open_jpeg(const char *path, reader **opened, iso_error *error) {
    reader *r = iso_alloc_zero(1, sizeof *r);
    if (!r) return iso_fail_memory(error, path);
    r->jpeg.err = jpeg_std_error(&r->errors);
    r->errors.error_exit = on_error;
    r->errors.emit_message = on_message;
    r->jpeg.client_data = r;
    iso_status status = iso_file_open(path, &r->stream, NULL, error);
    if (status == ISO_OK && !read_header(r)) status = fail_reading(r, path, error);
    if (status == ISO_OK)
        *opened = r;
    else
        close_jpeg(r);
    return status;
}

static iso_status read_jpeg_header(const char *path, iso_image_header *header, iso_error *error) {
    reader *r;
    ISO_TRY(open_jpeg(path, &r, error));
    *header = r->header;
    close_jpeg(r);
    return ISO_OK;
}

static bool read_rows(reader *r, JSAMPROW row, int component, uint8_t *values) {
    const iso_image_layout *l = &r->header.layout;
    struct jpeg_decompress_struct *jpeg = &r->jpeg;
    if (setjmp(r->escape)) return false;
    jpeg->progress = &r->progress;
    r->progress.progress_monitor = count_scans;
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < l->height) {
        uint8_t *target = values + (size_t)l->width * jpeg->output_scanline;
        jpeg_read_scanlines(jpeg, &row, 1);
        for (size_t x = 0; x < l->width; x++) target[x] = row[x * (size_t)l->samples + (size_t)component];
    }
    jpeg_finish_decompress(jpeg);
    return true;
}

static iso_status decode_jpeg(const char *path, const iso_image_layout *expected, uint64_t scratch,
                              int component, void *values, iso_error *error) {
    reader *r;
    ISO_TRY(open_jpeg(path, &r, error));
    iso_status status = iso_image_check_unchanged(path, &r->header, expected, scratch, error);
    if (status == ISO_OK) {
        JSAMPROW row = iso_alloc((size_t)expected->width * (size_t)expected->samples);
        if (!row)
            status = iso_fail_memory(error, path);
        else if (!read_rows(r, row, component, values))
            status = fail_reading(r, path, error);
        iso_free(row);
    }
    close_jpeg(r);
    return status;
}

static const iso_image_codec codec = {ISO_SLICES_JPEG, read_jpeg_header, decode_jpeg};

static iso_status jpeg_info_of(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                               iso_error *error) {
    return iso_image_stack_info(&codec, path, opts, info, error);
}

static iso_status jpeg_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  iso_tiled *tiled, iso_error *error) {
    return iso_image_stack_open(&codec, path, opts, info, tiled, error);
}

const iso_format iso_format_jpeg = {
    .name = "jpeg", .library = "libjpeg", .info = jpeg_info_of, .open_tiled = jpeg_open_tiled};
