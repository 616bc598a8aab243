/* format_tiff: reads a TIFF file with an image for each slice, or a folder with a file for each slice: TIFF
 * and BigTIFF in both byte orders, strips and tiles, every compression that libtiff has, integers of 8 to
 * 64 bits and floats. Slices follow one another along z; x is to the right and y downwards in an image.
 * Distances come from ImageJ's or OME's metadata, else from the resolution tags; several samples or
 * channels are components. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/module.h"
#include "grids/volume/tiff/tiff.h"
#include "grids/volume/tiled.h"

/* Strips of fewer bytes are read several at a time. */
enum { TILE_BYTES = 1 << 18 };

/* ---- header ---- */

static void set_spacing(const iso_tiff_stack *stack, const iso_volume_opts *opts, iso_volume_info *info) {
    double stated[3];
    for (int i = 0; i < 3; i++) {
        stated[i] = stack->metadata.spacing[i];
        if (!(stated[i] > 0) && i < 2) stated[i] = stack->resolution[i];
    }
    iso_slice_files_set_spacing(stated, opts, info);
}

static void describe(const iso_tiff_stack *stack, const iso_volume_opts *opts, iso_volume_info *info) {
    const iso_tiff_layout *layout = &stack->layout;
    info->type = iso_scalar_stored_type(layout->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(layout->scalar));
    if (stack->metadata.writer) iso_volume_note(info, "written by %s", stack->metadata.writer);
    if (stack->overviews) iso_volume_note(info, "%zu reduced images are left out", stack->overviews);
    set_spacing(stack, opts, info);
}

/* What reading takes beside the voxels: a strip or tile, twice while it is unpacked, and the rows of a small
 * one that are read together. */
static uint64_t scratch_bytes(const iso_tiff_stack *stack) {
    const uint64_t block = stack->block_bytes;
    return block < UINT64_MAX / 4 ? 3 * block + TILE_BYTES : UINT64_MAX;
}

static iso_status describe_stack(const char *path, const iso_volume_opts *opts, iso_tiff_stack *stack,
                                 iso_tiff_planes *planes, iso_volume_info *info, iso_error *error) {
    ISO_TRY(iso_tiff_planes_find(path, opts, stack, planes, info, error));
    describe(stack, opts, info);
    info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    info->read_bytes = info->bytes;
    if (__builtin_add_overflow(info->read_bytes, scratch_bytes(stack), &info->read_bytes))
        info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

static iso_status tiff_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    iso_tiff_stack stack;
    iso_tiff_planes planes;
    iso_status status = iso_tiff_stack_open(path, opts, &stack, error);
    if (status == ISO_OK) status = describe_stack(path, opts, &stack, &planes, info, error);
    if (status == ISO_OK)
        *opts->place =
            (iso_format_place){.by_module = iso_tiff_can_rewrite(&stack), .scalar = stack.layout.scalar};
    iso_tiff_stack_free(&stack);
    return status;
}

/* ---- values ---- */

enum { IDLE_FILES = 64 };

/* A file that is open for reading, and memory for one of its strips or tiles. */
typedef struct open_file {
    iso_tiff_file *file;
    void *block;
    uint32_t number; /* in the stack's list of files */
} open_file;

/* The open stack. Threads that read at the same time have different files open, which wait in `idle` between
 * two tiles. */
typedef struct tiff_tiles {
    iso_tiff_stack stack;
    iso_tiff_planes planes;
    iso_type type;
    int dims[3], tile[3];
    uint64_t limit;       /* of memory */
    pthread_mutex_t lock; /* of the following */
    open_file idle[IDLE_FILES];
    int idle_count;
} tiff_tiles;

static void close_file(open_file *file) {
    iso_tiff_close(file->file);
    iso_free(file->block);
    *file = (open_file){0};
}

/* Takes an idle file of this number, else opens it. */
static iso_status take_file(tiff_tiles *tiles, uint32_t number, open_file *file, iso_error *error) {
    *file = (open_file){.number = number};
    pthread_mutex_lock(&tiles->lock);
    for (int i = tiles->idle_count - 1; i >= 0 && !file->file; i--) {
        if (tiles->idle[i].number != number) continue;
        *file = tiles->idle[i];
        tiles->idle[i] = tiles->idle[--tiles->idle_count];
    }
    pthread_mutex_unlock(&tiles->lock);
    if (file->file) return ISO_OK;
    const char *path = tiles->stack.files.paths[number];
    file->block = iso_alloc((size_t)tiles->stack.block_bytes);
    if (!file->block) return iso_fail_memory(error, path);
    const iso_status status = iso_tiff_open(path, tiles->limit, &file->file, error);
    if (status != ISO_OK) close_file(file);
    return status;
}

/* Keeps as many files open as there may be threads: in a folder each file is read for one slice. */
static void return_file(tiff_tiles *tiles, open_file *file) {
    open_file old = {0};
    pthread_mutex_lock(&tiles->lock);
    const int most = tiles->stack.files.count > 1 ? 1 : IDLE_FILES;
    if (tiles->idle_count == most) old = tiles->idle[--tiles->idle_count];
    tiles->idle[tiles->idle_count++] = *file;
    pthread_mutex_unlock(&tiles->lock);
    close_file(&old);
}

/* The number of the image that has a slice of the component that is read. */
static uint64_t image_of(const tiff_tiles *tiles, int slice) {
    return tiles->planes.first + (uint64_t)slice * tiles->planes.step;
}

static iso_tiff_target target_of(const tiff_tiles *tiles, const int index[3], void *data) {
    const iso_tiff_box box = {(uint32_t)(index[0] * tiles->tile[0]), (uint32_t)(index[1] * tiles->tile[1]),
                              (uint32_t)tiles->tile[0], (uint32_t)tiles->tile[1]};
    return (iso_tiff_target){.box = box, .sample = tiles->planes.sample, .type = tiles->type, .data = data};
}

static iso_status read_tile(void *context, const int index[3], void *data, iso_error *error) {
    tiff_tiles *tiles = context;
    const iso_tiff_target target = target_of(tiles, index, data);
    const iso_tiff_image *image = &tiles->stack.images[image_of(tiles, index[2])];
    open_file file;
    ISO_TRY(take_file(tiles, image->file, &file, error));
    iso_status status = iso_tiff_set_image(file.file, image, error);
    if (status == ISO_OK)
        status = iso_tiff_read_box(file.file, &tiles->stack, image->page, file.block, &target, error);
    return_file(tiles, &file);
    return status;
}

static iso_status read_rows(FILE *file, uint64_t at, uint64_t size, void *rows, size_t bytes,
                            const char *path, iso_error *error) {
    if (fseeko(file, (off_t)at, SEEK_SET) == 0 && fread(rows, 1, bytes, file) == bytes) return ISO_OK;
    return iso_format_truncated(path, size, at + bytes, error);
}

/* Rows of ImageJ's images without headers; tiles are as wide as an image. */
static iso_status read_contiguous(void *context, const int index[3], void *data, iso_error *error) {
    const tiff_tiles *tiles = context;
    const iso_tiff_layout *layout = &tiles->stack.layout;
    const char *path = tiles->stack.files.paths[0];
    const iso_tiff_target target = target_of(tiles, index, data);
    const uint64_t image = image_of(tiles, index[2]);
    const uint32_t left = layout->height - target.box.y,
                   rows = target.box.height < left ? target.box.height : left;
    const size_t row_bytes = (size_t)layout->width * layout->samples * iso_scalar_size(layout->scalar);
    const uint64_t at = tiles->stack.contiguous + (image * layout->height + target.box.y) * row_bytes;
    FILE *file;
    uint64_t size;
    void *values = iso_alloc(row_bytes * rows);
    if (!values) return iso_fail_memory(error, path);
    iso_status status = iso_file_open(path, &file, &size, error);
    if (status == ISO_OK) {
        status = read_rows(file, at, size, values, row_bytes * rows, path, error);
        fclose(file);
    }
    const iso_scalar_source source = {values, layout->scalar, layout->samples, target.sample,
                                      tiles->stack.big_endian};
    if (status == ISO_OK) iso_scalar_convert(&source, (size_t)layout->width * rows, tiles->type, data);
    iso_free(values);
    return status;
}

/* Tiles are the file's tiles, or so many strips that they have about TILE_BYTES bytes. */
static iso_status choose_tile(tiff_tiles *tiles, iso_error *error) {
    const iso_tiff_layout *layout = &tiles->stack.layout;
    uint32_t width = layout->width, height = 1;
    if (!tiles->stack.contiguous) {
        const iso_tiff_image *first = &tiles->stack.images[0];
        iso_tiff_file *file;
        ISO_TRY(iso_tiff_open(tiles->stack.files.paths[first->file], tiles->limit, &file, error));
        const iso_status status = iso_tiff_set_image(file, first, error);
        if (status == ISO_OK) iso_tiff_block_size(file, layout, &width, &height);
        iso_tiff_close(file);
        ISO_TRY(status);
    }
    const uint64_t bytes = (uint64_t)width * height * layout->samples * iso_scalar_size(layout->scalar);
    if (width >= layout->width && bytes < TILE_BYTES) height *= (uint32_t)(TILE_BYTES / bytes);
    tiles->tile[0] = (int)(width < layout->width ? width : layout->width);
    tiles->tile[1] = (int)(height < layout->height ? height : layout->height);
    tiles->tile[2] = 1;
    return ISO_OK;
}

/* Checks that the limit of memory allows a strip or tile, which is unpacked as a whole, also when the volume
 * stays in the file. */
static iso_status check_tile(const char *path, const iso_volume_opts *opts, const tiff_tiles *tiles,
                             iso_error *error) {
    uint64_t bytes = iso_format_size(tiles->tile, iso_type_size(tiles->type));
    if (__builtin_add_overflow(bytes, scratch_bytes(&tiles->stack), &bytes)) bytes = UINT64_MAX;
    return iso_format_check_memory(path, opts, bytes, "a strip or tile", error);
}

static void destroy_tiles(void *context) {
    tiff_tiles *tiles = context;
    for (int i = 0; i < tiles->idle_count; i++) close_file(&tiles->idle[i]);
    pthread_mutex_destroy(&tiles->lock);
    iso_tiff_stack_free(&tiles->stack);
    free(tiles);
}

static iso_status open_stack(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                             tiff_tiles *tiles, iso_error *error) {
    iso_volume_info now = {.components = 1, .scale = 1, .transform = iso_transform_identity()};
    ISO_TRY(iso_tiff_stack_open(path, opts, &tiles->stack, error));
    ISO_TRY(describe_stack(path, opts, &tiles->stack, &tiles->planes, &now, error));
    if (now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    memcpy(tiles->dims, now.dims, sizeof now.dims);
    tiles->type = now.type;
    ISO_TRY(choose_tile(tiles, error));
    return check_tile(path, opts, tiles, error);
}

static iso_status tiff_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  iso_tiled *tiled, iso_error *error) {
    tiff_tiles *tiles = calloc(1, sizeof *tiles);
    if (!tiles) return iso_fail_memory(error, path);
    tiles->limit = iso_format_memory_limit(opts);
    pthread_mutex_init(&tiles->lock, NULL);
    const iso_status status = open_stack(path, opts, info, tiles, error);
    if (status != ISO_OK) {
        destroy_tiles(tiles);
        return status;
    }
    *tiled = (iso_tiled){.type = tiles->type,
                         .scratch = scratch_bytes(&tiles->stack),
                         .read = tiles->stack.contiguous ? read_contiguous : read_tile,
                         .destroy = destroy_tiles,
                         .context = tiles};
    memcpy(tiled->dims, tiles->dims, sizeof tiled->dims);
    memcpy(tiled->tile, tiles->tile, sizeof tiled->tile);
    return ISO_OK;
}

static const iso_format format = {
    .name = "tiff", .library = "libtiff", .info = tiff_info, .open_tiled = tiff_open_tiled};

ISO_MODULE_EXTERN const iso_module iso_module_table;
const iso_module iso_module_table = {
    .abi = ISO_MODULE_ABI, .version = ISO_VERSION, .format = &format, .rewrite = iso_tiff_rewrite};
