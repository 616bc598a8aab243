/* png: writes and reads PNG with libpng; pixels are compressed by png_pack.h. libpng reports errors by
 * longjmp: a function that calls setjmp keeps everything that is needed after the jump in a struct of its
 * caller, which also frees it. */
#include "image/image.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "image/png_pack.h"

/* Where libpng's error handler jumps to, and the error that it found. */
typedef struct png_failure {
    jmp_buf escape;
    char text[160];
    int code; /* errno of a failed read or write, else 0 */
    bool out_of_memory;
} png_failure;

/* What libpng says of memory that it does not get depends on what it was for. */
static png_voidp allocate(png_structp png, png_alloc_size_t bytes) {
    png_failure *failure = png_get_mem_ptr(png);
    void *block = malloc(bytes);
    if (!block) failure->out_of_memory = true;
    return block;
}

static void release(png_structp png, png_voidp block) {
    (void)png;
    free(block);
}

static void on_error(png_structp png, png_const_charp text) {
    png_failure *failure = png_get_error_ptr(png);
    snprintf(failure->text, sizeof failure->text, "%s", text);
    longjmp(failure->escape, 1);
}

static void on_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

typedef struct writer {
    png_structp png;
    png_infop info;
    FILE *stream;
    iso_png_packer packer;
    iso_png_palette *palette; /* NULL: the picture's colours are not indexed */
    png_text *texts;
    int text_count;
    png_uint_32 pixels_per_metre; /* 0: not written */
    png_failure failure;
} writer;

static void write_bytes(png_structp png, png_bytep bytes, size_t count) {
    writer *w = png_get_io_ptr(png);
    errno = 0;
    if (fwrite(bytes, 1, count, w->stream) == count) return;
    w->failure.code = errno ? errno : EIO;
    png_error(png, "write error");
}

static void flush_nothing(png_structp png) {
    (void)png; /* the sink flushes on commit */
}

static void set_palette(writer *w) {
    png_color colours[ISO_PNG_COLOURS];
    for (int i = 0; i < w->palette->count; i++) {
        uint32_t colour = w->palette->colour[i];
        colours[i] = (png_color){(png_byte)(colour >> 16), (png_byte)(colour >> 8), (png_byte)colour};
    }
    png_set_PLTE(w->png, w->info, colours, w->palette->count);
}

/* Writes all chunks. libpng writes those before the pixels. The chunks of the pixels and the end are written
 * here, because png_write_end would report that no pixels were written. */
static bool write_picture(writer *w) {
    if (setjmp(w->failure.escape)) return false;
    png_set_write_fn(w->png, w, write_bytes, flush_nothing);
    int channels = w->packer.channels;
    int type = channels == 1   ? PNG_COLOR_TYPE_PALETTE
               : channels == 3 ? PNG_COLOR_TYPE_RGB
                               : PNG_COLOR_TYPE_RGBA;
    png_set_IHDR(w->png, w->info, (png_uint_32)w->packer.image->width, (png_uint_32)w->packer.image->height,
                 8, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (w->palette) set_palette(w);
    if (w->pixels_per_metre)
        png_set_pHYs(w->png, w->info, w->pixels_per_metre, w->pixels_per_metre, PNG_RESOLUTION_METER);
    if (w->text_count) png_set_text(w->png, w->info, w->texts, w->text_count);
    png_write_info(w->png, w->info);
    for (;;) {
        if (iso_png_pack(&w->packer) != ISO_OK) {
            w->failure.out_of_memory = true;
            png_error(w->png, "out of memory");
        }
        if (w->packer.part_count == 0) break;
        for (int i = 0; i < w->packer.part_count; i++)
            png_write_chunk(w->png, (png_const_bytep) "IDAT", w->packer.parts[i].bytes,
                            w->packer.parts[i].size);
    }
    png_write_chunk(w->png, (png_const_bytep) "IEND", NULL, 0);
    return true;
}

static bool is_ascii(const char *text) {
    for (; *text; text++)
        if ((unsigned char)*text >= 128) return false;
    return true;
}

/* Prepares a text for libpng, which copies its strings (the members of its struct are not const). The value
 * is a sanitised copy, which the caller frees; NULL when there is no memory. */
static png_text text_chunk(const iso_png_text *text) {
    char *value = iso_text_clean_copy(text->value);
    bool ascii = value && is_ascii(value);
    png_text chunk = {.compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE,
                      .key = (char *)text->key,
                      .text = value};
    return chunk;
}

static iso_status choose_color_type(writer *w, const iso_image *image, const iso_png_opts *opts) {
    w->packer = (iso_png_packer){.image = image,
                                 .channels = iso_image_is_opaque(image) ? 3 : 4,
                                 .small = opts->small,
                                 .pool = opts->pool};
    if (!opts->small || w->packer.channels == 4) return ISO_OK;
    if (!(w->palette = iso_alloc(sizeof *w->palette))) return ISO_ERR_NOMEM;
    if (iso_png_palette_find(image, w->palette)) {
        w->packer.palette = w->palette;
        w->packer.channels = 1;
    } else {
        iso_free(w->palette);
        w->palette = NULL;
    }
    return ISO_OK;
}

static iso_status prepare_writer(writer *w, const iso_image *image, const iso_png_opts *opts) {
    ISO_TRY(choose_color_type(w, image, opts));
    w->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &w->failure, on_error, on_warning, &w->failure,
                                       allocate, release);
    if (!w->png || !(w->info = png_create_info_struct(w->png))) return ISO_ERR_NOMEM;
    int count = opts->text_count;
    if (count && !(w->texts = iso_alloc_zero((size_t)count, sizeof *w->texts))) return ISO_ERR_NOMEM;
    w->text_count = count;
    const double density = opts->pixels_per_metre + 0.5;
    if (density >= 1 && density <= PNG_UINT_31_MAX) w->pixels_per_metre = (png_uint_32)density;
    for (int i = 0; i < count; i++) {
        w->texts[i] = text_chunk(&opts->texts[i]);
        if (!w->texts[i].text) return ISO_ERR_NOMEM;
    }
    return ISO_OK;
}

static iso_status write_to_sink(writer *w, const char *path, iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    w->stream = sink.stream;
    if (write_picture(w)) return iso_sink_commit(&sink, error);
    const char *name = sink.target ? path : "standard output";
    const char *reason = w->failure.code ? strerror(w->failure.code) : w->failure.text;
    const iso_status status = w->failure.out_of_memory
                                  ? iso_fail_memory(error, name)
                                  : iso_fail(error, ISO_ERR_WRITE, "%s: cannot write: %s", name, reason);
    iso_sink_abort(&sink);
    return status;
}

static void free_writer(writer *w) {
    png_destroy_write_struct(&w->png, &w->info);
    iso_png_packer_free(&w->packer);
    iso_free(w->palette);
    for (int i = 0; i < w->text_count; i++) free(w->texts[i].text);
    iso_free(w->texts);
}

iso_status iso_png_write_with(const char *path, const iso_image *image, const iso_png_opts *opts,
                              iso_error *error) {
    writer w = {0};
    iso_status status = prepare_writer(&w, image, opts);
    if (status != ISO_OK)
        iso_fail(error, status, "%s: out of memory", path);
    else
        status = write_to_sink(&w, path, error);
    free_writer(&w);
    return status;
}

iso_status iso_png_encode(const iso_image *image, const iso_png_opts *opts, uint8_t **bytes, size_t *size,
                          iso_error *error) {
    writer w = {0};
    char *block = NULL;
    size_t length = 0;
    bool good = prepare_writer(&w, image, opts) == ISO_OK;
    good = good && (w.stream = open_memstream(&block, &length)) != NULL && write_picture(&w);
    if (w.stream) good = iso_memory_stream_close(w.stream, &block) && good;
    free_writer(&w);
    if (!good) {
        free(block);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a %dx%d PNG", image->width, image->height);
    }
    *bytes = (uint8_t *)block;
    *size = length;
    return ISO_OK;
}

iso_status iso_png_write(const char *path, const iso_image *image, const iso_png_text *texts, int text_count,
                         iso_error *error) {
    return iso_png_write_with(path, image, &(iso_png_opts){.texts = texts, .text_count = text_count}, error);
}

typedef struct reader {
    png_structp png;
    png_infop info;
    FILE *stream;
    bool ended; /* the file is shorter than its chunks state */
    int width, height;
    int passes;
    png_failure failure;
} reader;

static void read_bytes(png_structp png, png_bytep bytes, size_t count) {
    reader *r = png_get_io_ptr(png);
    errno = 0;
    if (fread(bytes, 1, count, r->stream) == count) return;
    if (ferror(r->stream))
        r->failure.code = errno ? errno : EIO;
    else
        r->ended = true;
    png_error(png, "read error");
}

static bool read_header(reader *r) {
    if (setjmp(r->failure.escape)) return false;
    png_set_read_fn(r->png, r, read_bytes);
    /* Texts, profiles and other chunks are not read: their stated lengths could make libpng allocate too much
     * memory. */
    png_set_keep_unknown_chunks(r->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_read_info(r->png, r->info);
    png_uint_32 width = png_get_image_width(r->png, r->info);
    png_uint_32 height = png_get_image_height(r->png, r->info);
    r->width = (int)width;
    r->height = (int)height;
    png_set_expand(r->png); /* converts palettes, fewer than 8 bits, and transparent colours */
    png_set_scale_16(r->png);
    png_set_gray_to_rgb(r->png);
    png_set_add_alpha(r->png, 255, PNG_FILLER_AFTER);
    r->passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    return true;
}

static bool read_rows(reader *r, const iso_image *image) {
    if (setjmp(r->failure.escape)) return false;
    size_t stride = (size_t)image->width * 4;
    if (png_get_rowbytes(r->png, r->info) != stride) png_error(r->png, "unexpected row size");
    for (int pass = 0; pass < r->passes; pass++)
        for (int y = 0; y < image->height; y++) png_read_row(r->png, image->rgba + stride * (size_t)y, NULL);
    png_read_end(r->png, NULL);
    return true;
}

static iso_status fail_reading(const reader *r, const char *path, iso_error *error) {
    if (r->failure.out_of_memory) return iso_fail_memory(error, path);
    if (r->failure.code)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(r->failure.code));
    if (r->ended) return iso_fail(error, ISO_ERR_FORMAT, "%s: PNG file ends too early", path);
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable PNG: %s", path, r->failure.text);
}

static iso_status read_stream(reader *r, const char *path, iso_image *image, iso_error *error) {
    r->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &r->failure, on_error, on_warning, &r->failure,
                                      allocate, release);
    if (!r->png || !(r->info = png_create_info_struct(r->png))) return iso_fail_memory(error, path);
    if (!read_header(r)) return fail_reading(r, path, error);
    if (r->width > ISO_IMAGE_MAX || r->height > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %dx%d pixels, sides may have %d at most", path, r->width,
                        r->height, ISO_IMAGE_MAX);
    iso_image picture;
    ISO_TRY(iso_image_create(r->width, r->height, &picture, error));
    if (!read_rows(r, &picture)) {
        iso_image_free(&picture);
        return fail_reading(r, path, error);
    }
    *image = picture;
    return ISO_OK;
}

bool iso_png_size(const char *path, uint32_t size[2]) {
    static const unsigned char head[16] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    unsigned char bytes[24];
    FILE *file;
    if (iso_file_open(path, &file, NULL, NULL) != ISO_OK) return false;
    bool found = fread(bytes, sizeof bytes, 1, file) == 1 && memcmp(bytes, head, sizeof head) == 0;
    fclose(file);
    for (int side = 0; found && side < 2; side++) {
        const unsigned char *b = bytes + sizeof head + 4 * side;
        size[side] = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
    }
    return found;
}

iso_status iso_png_read(const char *path, iso_image *image, iso_error *error) {
    reader r = {0};
    ISO_TRY(iso_file_open(path, &r.stream, NULL, error));
    iso_status status = read_stream(&r, path, image, error);
    png_destroy_read_struct(&r.png, &r.info, NULL);
    fclose(r.stream);
    return status;
}
