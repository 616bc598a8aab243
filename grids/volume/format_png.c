/* format_png: reads a folder of PNG files, a slice each (grids/volume/image_stack.h). Grey of 8 and 16 bits
 * is read as it is; fewer bits are scaled to 8, as image programs show them; a palette of greys is replaced
 * by the greys. Distances of pixels come from pHYs, if it states metres. Gamma and transparent colours are
 * ignored.
 *
 * libpng reports errors by longjmp: a function that calls setjmp keeps everything that is needed after the
 * jump in a struct of its caller, which also frees it. */
#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/grey_picture.h"
#include "grids/volume/image_stack.h"

/* A file that is open for reading, after its header. */
typedef struct reader {
    png_structp png;
    png_infop info;
    FILE *stream;
    iso_image_layout layout;
    int scaled_bits;   /* of a grey whose values are scaled to 8 bits, else 0 */
    int channels;      /* of a pixel as libpng returns it: three for one sample from a palette of greys */
    size_t row_bytes;  /* of a row as libpng returns it */
    int passes;        /* of an interlaced image, which is decoded as a whole; else 1 */
    double spacing[2]; /* mm; 0: not stated */
    /* The first failure. */
    jmp_buf escape;
    char text[160];
    int code;           /* errno of a failed read, else 0 */
    bool ended;         /* the file is shorter than its chunks state */
    bool out_of_memory; /* libpng then fails with some message */
    bool unsupported;   /* the text names what cannot be read */
} reader;

static void on_error(png_structp png, png_const_charp text) {
    reader *r = png_get_error_ptr(png);
    snprintf(r->text, sizeof r->text, "%s", text);
    longjmp(r->escape, 1);
}

static void on_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

static png_voidp allocate(png_structp png, png_alloc_size_t bytes) {
    reader *r = png_get_mem_ptr(png);
    void *block = iso_alloc(bytes);
    if (!block) r->out_of_memory = true;
    return block;
}

static void release(png_structp png, png_voidp block) {
    (void)png;
    iso_free(block);
}

static void read_bytes(png_structp png, png_bytep bytes, size_t count) {
    reader *r = png_get_io_ptr(png);
    errno = 0;
    if (fread(bytes, 1, count, r->stream) == count) return;
    if (ferror(r->stream))
        r->code = errno ? errno : EIO;
    else
        r->ended = true;
    png_error(png, "read error");
}

static void refuse(reader *r, const char *what) {
    r->unsupported = true;
    png_error(r->png, what);
}

static bool is_grey(const png_color *palette, int count) {
    for (int i = 0; i < count; i++)
        if (palette[i].red != palette[i].green || palette[i].red != palette[i].blue) return false;
    return true;
}

/* Sets the layout, and the conversions that lead to it. */
static void choose_conversions(reader *r) {
    const int type = png_get_color_type(r->png, r->info), depth = png_get_bit_depth(r->png, r->info);
    r->layout = (iso_image_layout){.width = png_get_image_width(r->png, r->info),
                                   .height = png_get_image_height(r->png, r->info),
                                   .scalar = depth == 16 ? ISO_SCALAR_UINT16 : ISO_SCALAR_UINT8,
                                   .samples = png_get_channels(r->png, r->info)};
    if (type == PNG_COLOR_TYPE_PALETTE) {
        png_colorp palette = NULL;
        int count = 0;
        png_get_PLTE(r->png, r->info, &palette, &count);
        if (!is_grey(palette, count))
            refuse(r, "a palette of colours cannot be read as voxels: save it as greys, or as RGB");
        png_set_palette_to_rgb(r->png);
    } else if (type == PNG_COLOR_TYPE_GRAY && depth < 8) {
        r->scaled_bits = depth;
        png_set_expand_gray_1_2_4_to_8(r->png);
    }
    r->passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    r->channels = png_get_channels(r->png, r->info);
    r->row_bytes = png_get_rowbytes(r->png, r->info);
}

static bool read_header(reader *r) {
    png_uint_32 density[2];
    int unit = PNG_RESOLUTION_UNKNOWN;
    if (setjmp(r->escape)) return false;
    png_set_read_fn(r->png, r, read_bytes);
    /* Texts, profiles and other chunks are not read: their stated lengths could make libpng allocate too much
     * memory. */
    png_set_keep_unknown_chunks(r->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_set_keep_unknown_chunks(r->png, PNG_HANDLE_CHUNK_AS_DEFAULT, (png_const_bytep) "pHYs", 1);
    png_set_crc_action(r->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_read_info(r->png, r->info);
    if (png_get_pHYs(r->png, r->info, &density[0], &density[1], &unit) && unit == PNG_RESOLUTION_METER)
        for (int i = 0; i < 2; i++) r->spacing[i] = density[i] ? 1000.0 / density[i] : 0;
    choose_conversions(r);
    return true;
}

static iso_status fail_reading(const reader *r, const char *path, iso_error *error) {
    if (r->out_of_memory) return iso_fail_memory(error, path);
    if (r->code) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(r->code));
    if (r->ended) return iso_fail(error, ISO_ERR_IO, "%s: truncated: the PNG file ends too early", path);
    if (r->unsupported) return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, r->text);
    return iso_fail(error, ISO_ERR_IO, "%s: damaged, or no PNG file: %s", path, r->text);
}

static void close_png(reader *r) {
    png_destroy_read_struct(&r->png, &r->info, NULL);
    if (r->stream) fclose(r->stream);
}

/* Opens a file and reads its header. close_png when done. */
static iso_status open_png(const char *path, reader *r, iso_error *error) {
    *r = (reader){0};
    ISO_TRY(iso_file_open(path, &r->stream, NULL, error));
    iso_status status = ISO_OK;
    r->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, r, on_error, on_warning, r, allocate, release);
    if (!r->png || !(r->info = png_create_info_struct(r->png)))
        status = iso_fail_memory(error, path);
    else if (!read_header(r))
        status = fail_reading(r, path, error);
    if (status != ISO_OK) close_png(r);
    return status;
}

/* The memory that decoding takes: the rows (row_buffer_bytes), libpng's two rows, zlib and the rest. */
static uint64_t row_buffer_bytes(const reader *r) {
    return r->passes > 1 ? (uint64_t)r->row_bytes * r->layout.height : r->row_bytes;
}

static uint64_t scratch_bytes(const reader *r) {
    enum { LIBRARY_BYTES = 1 << 17 };
    return row_buffer_bytes(r) + 2 * (uint64_t)r->row_bytes + LIBRARY_BYTES;
}

/* Where a slice goes. */
typedef struct target {
    iso_type type;
    int component;
    png_bytep rows; /* row_buffer_bytes(r) bytes of memory */
    char *values;
} target;

static void convert_row(const reader *r, const target *t, const void *row, uint32_t y) {
    const iso_scalar_source source = {.data = row,
                                      .scalar = r->layout.scalar,
                                      .components = r->channels,
                                      .component = t->component,
                                      .swap = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__};
    const size_t width = r->layout.width;
    iso_scalar_convert(&source, width, t->type, t->values + width * y * iso_type_size(t->type));
}

static bool read_rows(reader *r, const target *t) {
    const uint32_t height = r->layout.height;
    const size_t step = r->passes > 1 ? r->row_bytes : 0;
    if (setjmp(r->escape)) return false;
    for (int pass = 1; pass <= r->passes; pass++)
        for (uint32_t y = 0; y < height; y++) {
            png_bytep row = t->rows + step * y;
            png_read_row(r->png, row, NULL);
            if (pass == r->passes) convert_row(r, t, row, y);
        }
    png_read_end(r->png, NULL);
    return true;
}

static iso_image_header header_of(const reader *r) {
    iso_image_header header = {r->layout, {r->spacing[0], r->spacing[1]}, scratch_bytes(r), ""};
    if (r->scaled_bits)
        snprintf(header.note, sizeof header.note, "values of %d bit%s are scaled to 0 .. 255", r->scaled_bits,
                 r->scaled_bits == 1 ? "" : "s");
    return header;
}

static iso_status read_png_header(const char *path, iso_image_header *header, iso_error *error) {
    reader r;
    ISO_TRY(open_png(path, &r, error));
    *header = header_of(&r);
    close_png(&r);
    return ISO_OK;
}

static iso_status decode_rows(const char *path, reader *r, int component, void *values, iso_error *error) {
    const target t = {.type = iso_scalar_stored_type(r->layout.scalar),
                      .component = component,
                      .rows = iso_alloc((size_t)row_buffer_bytes(r)),
                      .values = values};
    if (!t.rows) return iso_fail_memory(error, path);
    const iso_status status = read_rows(r, &t) ? ISO_OK : fail_reading(r, path, error);
    iso_free(t.rows);
    return status;
}

static iso_status decode_png(const char *path, const iso_image_layout *expected, uint64_t scratch,
                             int component, void *values, iso_error *error) {
    reader r;
    ISO_TRY(open_png(path, &r, error));
    const iso_image_header now = header_of(&r);
    iso_status status = iso_image_check_unchanged(path, &now, expected, scratch, error);
    if (status == ISO_OK) status = decode_rows(path, &r, component, values, error);
    close_png(&r);
    return status;
}

static const iso_image_codec codec = {ISO_SLICES_PNG, read_png_header, decode_png};

static iso_status png_info_of(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                              iso_error *error) {
    return iso_image_stack_info(&codec, path, opts, info, error);
}

static iso_status png_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                 iso_tiled *tiled, iso_error *error) {
    return iso_image_stack_open(&codec, path, opts, info, tiled, error);
}

const iso_format iso_format_png = {
    .name = "png", .library = "libpng", .info = png_info_of, .open_tiled = png_open_tiled};

/* ---- one picture by itself */

iso_status iso_grey_picture_read(const char *path, int *width, int *height, uint16_t **values,
                                 iso_error *error) {
    iso_image_header header;
    ISO_TRY(read_png_header(path, &header, error));
    const iso_image_layout *layout = &header.layout;
    if (layout->samples != 1)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: has colours or opacities: a grey picture is wanted",
                        path);
    if (layout->width > ISO_GREY_PICTURE_MOST || layout->height > ISO_GREY_PICTURE_MOST)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %u x %u pixels: at most %d", path, layout->width,
                        layout->height, ISO_GREY_PICTURE_MOST);
    const size_t count = (size_t)layout->width * layout->height;
    uint16_t *made = iso_alloc(count * sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %s", path);
    const iso_status status = decode_png(path, layout, header.scratch, 0, made, error);
    if (status != ISO_OK) {
        iso_free(made);
        return status;
    }
    const uint8_t *bytes = (const uint8_t *)made;
    for (size_t i = count; layout->scalar == ISO_SCALAR_UINT8 && i-- > 0;)
        made[i] = (uint16_t)(257 * bytes[i]); /* from the end, so that no byte is lost */
    *width = (int)layout->width;
    *height = (int)layout->height;
    *values = made;
    return ISO_OK;
}
