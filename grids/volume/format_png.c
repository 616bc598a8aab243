/* format_png: reads a folder of PNG files, a slice each, in the natural order of their names. Slices follow
 * one another along z; x is to the right and y downwards in an image. Grey of 8 and 16 bits is read as it is;
 * fewer bits are scaled to 8, as image programs show them; a palette of greys is replaced by the greys.
 * Colours and opacities are components. Distances of pixels come from pHYs, if it states metres. Gamma and
 * transparent colours are ignored.
 *
 * libpng reports errors by longjmp: a function that calls setjmp keeps everything that is needed after the
 * jump in a struct of its caller, which also frees it. */
#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/format.h"
#include "grids/volume/slice_files.h"
#include "grids/volume/tiled.h"

/* ---- one file ---- */

/* What all slices have in common. */
typedef struct layout {
    uint32_t width, height;
    iso_scalar scalar;
    int samples; /* values of a pixel */
} layout;

/* A file that is open for reading, after its header. */
typedef struct reader {
    png_structp png;
    png_infop info;
    FILE *stream;
    layout layout;
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
    r->layout = (layout){.width = png_get_image_width(r->png, r->info),
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

/* ---- the stack ---- */

typedef struct png_stack {
    iso_slice_files files;
    layout layout;
    int scaled_bits;   /* of the first slice */
    double spacing[2]; /* of the first slice */
    uint64_t scratch;  /* bytes that decoding a slice takes at most */
    int component;     /* that is read */
} png_stack;

static bool is_same(const layout *a, const layout *b) {
    return a->width == b->width && a->height == b->height && a->scalar == b->scalar &&
           a->samples == b->samples;
}

static iso_status check_slice(const png_stack *stack, uint32_t number, const layout *slice,
                              iso_error *error) {
    const layout *first = &stack->layout;
    if (is_same(slice, first)) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: is %u x %u %s with %d sample(s), but the first slice (%s) is %u x %u %s with %d",
                    stack->files.paths[number], slice->width, slice->height, iso_scalar_name(slice->scalar),
                    slice->samples, stack->files.paths[0], first->width, first->height,
                    iso_scalar_name(first->scalar), first->samples);
}

static iso_status read_headers(png_stack *stack, iso_error *error) {
    for (uint32_t i = 0; i < stack->files.count; i++) {
        reader r;
        ISO_TRY(open_png(stack->files.paths[i], &r, error));
        if (i == 0) {
            stack->layout = r.layout;
            stack->scaled_bits = r.scaled_bits;
            memcpy(stack->spacing, r.spacing, sizeof r.spacing);
        }
        if (scratch_bytes(&r) > stack->scratch) stack->scratch = scratch_bytes(&r);
        close_png(&r);
        ISO_TRY(check_slice(stack, i, &r.layout, error));
    }
    return ISO_OK;
}

/* Lists the slices and reads their headers. iso_slice_files_free when done, also after an error. */
static iso_status open_stack(const char *path, const iso_volume_opts *opts, png_stack *stack,
                             iso_error *error) {
    *stack = (png_stack){0};
    ISO_TRY(iso_slice_files_list(path, ISO_SLICES_PNG, &stack->files, error));
    for (uint32_t i = 0; i < stack->files.count; i++) iso_file_set_read(opts->files, stack->files.paths[i]);
    return read_headers(stack, error);
}

static iso_status describe(const char *path, const iso_volume_opts *opts, png_stack *stack,
                           iso_volume_info *info, iso_error *error) {
    const layout *l = &stack->layout;
    ISO_TRY(iso_format_dims(path, (const uint64_t[3]){l->width, l->height, stack->files.count}, info, error));
    ISO_TRY(iso_format_component(path, opts, l->samples, info, error));
    stack->component = info->component;
    info->type = iso_scalar_stored_type(l->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(l->scalar));
    if (stack->scaled_bits)
        iso_volume_note(info, "values of %d bit%s are scaled to 0 .. 255", stack->scaled_bits,
                        stack->scaled_bits == 1 ? "" : "s");
    const double stated[3] = {stack->spacing[0], stack->spacing[1], 0};
    iso_slice_files_set_spacing(stated, opts, info);
    info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (__builtin_add_overflow(info->bytes, stack->scratch, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

static iso_status png_info_of(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                              iso_error *error) {
    png_stack stack;
    iso_status status = open_stack(path, opts, &stack, error);
    if (status == ISO_OK) status = describe(path, opts, &stack, info, error);
    iso_slice_files_free(&stack.files);
    return status;
}

/* ---- values: a slice is a tile ---- */

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

static iso_status decode(const png_stack *stack, const char *path, reader *r, void *values,
                         iso_error *error) {
    if (!is_same(&r->layout, &stack->layout) || scratch_bytes(r) > stack->scratch)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    const target t = {.type = iso_scalar_stored_type(r->layout.scalar),
                      .component = stack->component,
                      .rows = iso_alloc((size_t)row_buffer_bytes(r)),
                      .values = values};
    if (!t.rows) return iso_fail_memory(error, path);
    const iso_status status = read_rows(r, &t) ? ISO_OK : fail_reading(r, path, error);
    iso_free(t.rows);
    return status;
}

static iso_status read_slice(void *context, const int index[3], void *values, iso_error *error) {
    const png_stack *stack = context;
    const char *path = stack->files.paths[index[2]];
    reader r;
    ISO_TRY(open_png(path, &r, error));
    const iso_status status = decode(stack, path, &r, values, error);
    close_png(&r);
    return status;
}

static void destroy_stack(void *context) {
    png_stack *stack = context;
    iso_slice_files_free(&stack->files);
    free(stack);
}

/* Reads the headers again. A slice is decoded as a whole, also when the volume stays in the files: the limit
 * of memory must allow one. */
static iso_status prepare_tiles(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                png_stack *stack, iso_tiled *tiled, iso_error *error) {
    iso_volume_info now = {.components = 1, .scale = 1, .transform = iso_transform_identity()};
    ISO_TRY(open_stack(path, opts, stack, error));
    ISO_TRY(describe(path, opts, stack, &now, error));
    if (now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    *tiled = (iso_tiled){.dims = {now.dims[0], now.dims[1], now.dims[2]},
                         .tile = {now.dims[0], now.dims[1], 1},
                         .type = now.type,
                         .scratch = stack->scratch,
                         .read = read_slice,
                         .destroy = destroy_stack,
                         .context = stack};
    uint64_t bytes = iso_format_size(tiled->tile, iso_type_size(now.type));
    if (__builtin_add_overflow(bytes, stack->scratch, &bytes)) bytes = UINT64_MAX;
    return iso_format_check_memory(path, opts, bytes, "a slice", error);
}

static iso_status png_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                 iso_tiled *tiled, iso_error *error) {
    png_stack *stack = calloc(1, sizeof *stack);
    if (!stack) return iso_fail_memory(error, path);
    const iso_status status = prepare_tiles(path, opts, info, stack, tiled, error);
    if (status != ISO_OK) destroy_stack(stack);
    return status;
}

const iso_format iso_format_png = {
    .name = "png", .library = "libpng", .info = png_info_of, .open_tiled = png_open_tiled};
