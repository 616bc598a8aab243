/* jpeg_write: pictures as JPEG by libjpeg, which reports errors by a callback that must not return:
 * everything that is needed after its longjmp is in a struct of the caller. */
#include <setjmp.h>
#include <stdio.h> /* before jpeglib.h, which needs it */

#include <jpeglib.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "image/image_file.h"

enum { QUALITY = 95, MOST_SIDE = 65500, INCH_LIMIT = 65535 };

typedef struct jpeg_writer {
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    jmp_buf escape;
    const iso_image *image;
    uint8_t *row;
    char *comment; /* or NULL */
    unsigned per_inch;
} jpeg_writer;

static void on_error(j_common_ptr jpeg) {
    jpeg_writer *w = jpeg->client_data;
    longjmp(w->escape, 1);
}

static void say_nothing(j_common_ptr jpeg) {
    (void)jpeg;
}

/* Errors of the stream are found when it is committed. */
static bool write_picture(jpeg_writer *w, FILE *stream) {
    struct jpeg_compress_struct *jpeg = &w->jpeg;
    if (setjmp(w->escape)) return false;
    jpeg_create_compress(jpeg);
    jpeg_stdio_dest(jpeg, stream);
    jpeg->image_width = (JDIMENSION)w->image->width;
    jpeg->image_height = (JDIMENSION)w->image->height;
    jpeg->input_components = 3;
    jpeg->in_color_space = JCS_RGB;
    jpeg_set_defaults(jpeg);
    jpeg_set_quality(jpeg, QUALITY, TRUE);
    jpeg->comp_info[0].h_samp_factor = jpeg->comp_info[0].v_samp_factor = 1; /* colours at full resolution */
    jpeg->dct_method = JDCT_ISLOW; /* whose result does not depend on the processor */
    if (w->per_inch) {
        jpeg->density_unit = 1;
        jpeg->X_density = jpeg->Y_density = (UINT16)w->per_inch;
    }
    jpeg_start_compress(jpeg, TRUE);
    if (w->comment)
        jpeg_write_marker(jpeg, JPEG_COM, (const JOCTET *)w->comment, (unsigned)strlen(w->comment));
    for (int y = 0; y < w->image->height; y++) {
        const uint8_t *from = w->image->rgba + 4 * (size_t)w->image->width * (size_t)y;
        for (int x = 0; x < w->image->width; x++) memcpy(w->row + 3 * x, from + 4 * x, 3);
        JSAMPROW rows[1] = {w->row};
        jpeg_write_scanlines(jpeg, rows, 1);
    }
    jpeg_finish_compress(jpeg);
    return true;
}

/* The texts, a line each: JPEG has one comment. NULL without memory. */
static char *join_texts(const iso_png_opts *opts) {
    char *joined = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&joined, &size);
    if (!stream) return NULL;
    for (int i = 0; i < opts->text_count && size < 60000; i++) {
        fprintf(stream, "%s%s: ", i ? "\n" : "", opts->texts[i].key);
        iso_text_put(stream, opts->texts[i].value);
        fflush(stream);
    }
    if (fclose(stream) == 0) return joined;
    free(joined);
    return NULL;
}

bool iso_jpeg_available(void) {
    return true;
}

iso_status iso_jpeg_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                          iso_error *error) {
    const double per_inch = opts->pixels_per_metre * 0.0254;
    if (image->width > MOST_SIDE || image->height > MOST_SIDE)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: a JPEG has at most %d pixels a side: name a .png", path,
                        MOST_SIDE);
    jpeg_writer *w = iso_alloc_zero(1, sizeof *w);
    if (!w) return iso_fail_memory(error, path);
    w->image = image;
    w->per_inch = per_inch >= 0.5 && per_inch < INCH_LIMIT ? (unsigned)(per_inch + 0.5) : 0;
    w->jpeg.err = jpeg_std_error(&w->errors);
    w->errors.error_exit = on_error;
    w->errors.output_message = say_nothing;
    w->jpeg.client_data = w;
    w->comment = join_texts(opts);
    w->row = iso_alloc(3 * (size_t)image->width);
    iso_sink sink = {0};
    iso_status status = w->row ? iso_sink_open(path, &sink, error) : iso_fail_memory(error, path);
    const bool encoded = status == ISO_OK && write_picture(w, sink.stream);
    jpeg_destroy_compress(&w->jpeg);
    free(w->comment);
    iso_free(w->row);
    iso_free(w);
    /* libjpeg fails without memory, or when the stream fails: committing says why */
    if (status == ISO_OK && !encoded && !ferror(sink.stream)) status = iso_fail_memory(error, path);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}
