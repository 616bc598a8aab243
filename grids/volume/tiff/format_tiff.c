/* format_tiff: reads a TIFF file with an image for each slice, or a folder with a file for each slice: TIFF
 * and BigTIFF in both byte orders, strips and tiles, every compression that libtiff has, integers of 8 to
 * 64 bits and floats. Slices follow one another along z; x is to the right and y downwards in an image.
 * Distances come from ImageJ's or OME's metadata, else from the resolution tags; several samples or
 * channels are components. */
#define _GNU_SOURCE
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/module.h"
#include "grids/volume/tiff/tiff.h"

/* ---- which image is which slice ---- */

/* How the images of a stack are arranged. */
typedef struct arrangement {
    uint64_t slices, channels;
    uint64_t step[ISO_TIFF_AXES]; /* images from one channel, slice or time to the next */
} arrangement;

static uint64_t image_count(const iso_tiff_stack *stack) {
    return stack->contiguous ? stack->metadata.images : stack->count;
}

/* The arrangement that the metadata states, if as many images are there; else every image is a slice. */
static arrangement arrange(const iso_tiff_stack *stack, iso_volume_info *info) {
    const iso_tiff_metadata *m = &stack->metadata;
    const uint64_t images = image_count(stack);
    uint64_t size[ISO_TIFF_AXES], product = 1;
    arrangement a = {.slices = images, .channels = 1, .step = {0, 1, 0}};
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++) size[axis] = m->sizes[axis] ? m->sizes[axis] : 1;
    if (stack->layout.samples > 1)
        size[ISO_TIFF_CHANNEL] = 1; /* OME counts the samples of a pixel as channels */
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++)
        if (__builtin_mul_overflow(product, size[axis], &product)) return a;
    if (!m->writer || product != images) return a;
    for (int i = 0; i < ISO_TIFF_AXES; i++) {
        a.step[m->order[i]] = i == 0 ? 1 : a.step[m->order[i - 1]] * size[m->order[i - 1]];
    }
    a.slices = size[ISO_TIFF_SLICE];
    a.channels = size[ISO_TIFF_CHANNEL];
    if (size[ISO_TIFF_TIME] > 1 && a.slices > 1)
        iso_volume_note(info, "the first of %llu times is read", (unsigned long long)size[ISO_TIFF_TIME]);
    if (a.slices == 1 && size[ISO_TIFF_TIME] > 1) { /* a series of planes: ImageJ calls slices frames */
        a.slices = size[ISO_TIFF_TIME];
        a.step[ISO_TIFF_SLICE] = a.step[ISO_TIFF_TIME];
    }
    return a;
}

/* ---- header ---- */

static void set_spacing(const iso_tiff_stack *stack, const iso_volume_opts *opts, iso_volume_info *info) {
    double *spacing = info->transform.spacing;
    for (int i = 0; i < 3; i++) {
        spacing[i] = stack->metadata.spacing[i];
        if (!(spacing[i] > 0) && i < 2) spacing[i] = stack->resolution[i];
    }
    if (!(spacing[0] > 0 && spacing[1] > 0)) {
        spacing[0] = spacing[1] = 1;
        if (!(opts->spacing[0] > 0 && opts->spacing[1] > 0))
            iso_volume_note(info, "the distance of pixels is not stated: 1 mm (--spacing)");
    }
    if (!(spacing[2] > 0)) {
        spacing[2] = spacing[0];
        if (!(opts->spacing[2] > 0))
            iso_volume_note(info, "the distance of slices is not stated: that of pixels, %g mm (--spacing)",
                            spacing[0]);
    }
}

static void describe(const iso_tiff_stack *stack, const iso_volume_opts *opts, const arrangement *a,
                     iso_volume_info *info) {
    const iso_tiff_layout *layout = &stack->layout;
    info->type = iso_scalar_stored_type(layout->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(layout->scalar));
    if (stack->metadata.writer) iso_volume_note(info, "written by %s", stack->metadata.writer);
    if (stack->overviews) iso_volume_note(info, "%zu reduced images are left out", stack->overviews);
    if (a->step[ISO_TIFF_SLICE] == 1 && a->channels == 1 && stack->metadata.sizes[ISO_TIFF_SLICE] > 1 &&
        a->slices != stack->metadata.sizes[ISO_TIFF_SLICE])
        iso_volume_note(info,
                        "its metadata state %u slices, but there are %llu images: each is taken as a slice",
                        stack->metadata.sizes[ISO_TIFF_SLICE], (unsigned long long)a->slices);
    set_spacing(stack, opts, info);
}

static iso_status describe_stack(const char *path, const iso_volume_opts *opts, const iso_tiff_stack *stack,
                                 arrangement *a, iso_volume_info *info, iso_error *error) {
    *a = arrange(stack, info);
    const uint64_t components = a->channels * stack->layout.samples;
    const uint64_t dims[3] = {stack->layout.width, stack->layout.height, a->slices};
    if (components > INT_MAX) return iso_fail(error, ISO_ERR_FORMAT, "%s: has too many channels", path);
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(iso_format_component(path, opts, (int)components, info, error));
    describe(stack, opts, a, info);
    info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    /* Beside the grid: a strip or tile, twice while it is unpacked. */
    info->read_bytes = info->bytes;
    if (__builtin_add_overflow(info->read_bytes, 2 * stack->block_bytes, &info->read_bytes))
        info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

static iso_status tiff_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    iso_tiff_stack stack;
    arrangement a;
    iso_status status = iso_tiff_stack_open(path, opts, &stack, error);
    if (status == ISO_OK) status = describe_stack(path, opts, &stack, &a, info, error);
    iso_tiff_stack_free(&stack);
    return status;
}

/* ---- values ---- */

typedef struct reading {
    const char *path;
    const iso_volume_opts *opts;
    const iso_volume_info *info;
    const iso_tiff_stack *stack;
    arrangement arrangement;
    void *block;
    iso_tiff_file *file; /* the open one */
    uint32_t number;     /* of the open file */
} reading;

/* The number of the image that has a slice of the component that is read, and the component's sample in it.
 */
static uint64_t image_of(const reading *r, uint64_t slice, int *sample) {
    const uint64_t samples = r->stack->layout.samples, component = (uint64_t)r->info->component;
    *sample = (int)(component % samples);
    return slice * r->arrangement.step[ISO_TIFF_SLICE] +
           component / samples * r->arrangement.step[ISO_TIFF_CHANNEL];
}

static iso_status read_slice(reading *r, uint64_t slice, void *target, iso_error *error) {
    int sample;
    const iso_tiff_image *image = &r->stack->images[image_of(r, slice, &sample)];
    if (!r->file || r->number != image->file) {
        iso_tiff_close(r->file);
        r->file = NULL;
        r->number = image->file;
        const uint64_t limit = iso_format_memory_limit(r->opts);
        ISO_TRY(iso_tiff_open(r->stack->paths[image->file], limit, &r->file, error));
    }
    ISO_TRY(iso_tiff_set_page(r->file, image->page, error));
    return iso_tiff_read_pixels(r->file, r->stack, image->page, sample, r->block, r->info->type, target,
                                error);
}

static iso_status read_slices(reading *r, iso_grid *grid, iso_error *error) {
    const uint64_t slices = (uint64_t)r->info->dims[2];
    const size_t slice_bytes = (size_t)(r->info->bytes / slices);
    for (uint64_t z = 0; z < slices; z++) {
        ISO_TRY(read_slice(r, z, (char *)grid->rgrid->data + z * slice_bytes, error));
        ISO_TRY(iso_format_progress(r->path, r->opts, (double)(z + 1) / (double)slices, error));
    }
    return ISO_OK;
}

/* ImageJ's images without headers. */
static iso_status read_contiguous(reading *r, iso_grid *grid, iso_error *error) {
    const iso_tiff_stack *stack = r->stack;
    const iso_tiff_layout *layout = &stack->layout;
    const size_t pixels = (size_t)layout->width * layout->height;
    const size_t image_bytes = pixels * layout->samples * iso_scalar_size(layout->scalar);
    FILE *file;
    uint64_t size;
    ISO_TRY(iso_file_open(stack->paths[0], &file, &size, error));
    iso_status status = ISO_OK;
    for (int z = 0; z < r->info->dims[2] && status == ISO_OK; z++) {
        int sample;
        const uint64_t at = stack->contiguous + image_of(r, (uint64_t)z, &sample) * image_bytes;
        if (fseeko(file, (off_t)at, SEEK_SET) != 0 || fread(r->block, 1, image_bytes, file) != image_bytes) {
            status = iso_format_truncated(stack->paths[0], size, at + image_bytes, error);
            break;
        }
        const iso_scalar_source source = {r->block, layout->scalar, layout->samples, sample,
                                          stack->big_endian};
        iso_scalar_convert(&source, pixels, r->info->type,
                           (char *)grid->rgrid->data + (size_t)z * pixels * iso_type_size(r->info->type));
        status = iso_format_progress(r->path, r->opts, (z + 1.0) / r->info->dims[2], error);
    }
    fclose(file);
    return status;
}

static iso_status read_grid(reading *r, iso_grid *grid, iso_error *error) {
    r->block = iso_alloc((size_t)r->stack->block_bytes);
    if (!r->block) return iso_fail_memory(error, r->path);
    iso_status status = r->stack->contiguous ? read_contiguous(r, grid, error) : read_slices(r, grid, error);
    iso_tiff_close(r->file);
    iso_free(r->block);
    return status;
}

static iso_status read_stack(const char *path, const iso_volume_opts *opts, iso_tiff_stack *stack,
                             iso_volume_info *info, iso_grid *grid, iso_error *error) {
    iso_volume_info now = {.components = 1, .scale = 1, .transform = iso_transform_identity()};
    reading r = {.path = path, .opts = opts, .info = info, .stack = stack};
    ISO_TRY(describe_stack(path, opts, stack, &r.arrangement, &now, error));
    if (memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type ||
        now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    ISO_TRY(iso_format_create(path, info, NULL, grid, error));
    return read_grid(&r, grid, error);
}

static iso_status tiff_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    iso_tiff_stack stack;
    iso_status status = iso_tiff_stack_open(path, opts, &stack, error);
    if (status == ISO_OK) status = read_stack(path, opts, &stack, info, grid, error);
    iso_tiff_stack_free(&stack);
    if (status != ISO_OK) iso_grid_destroy(grid);
    return status;
}

static const iso_format format = {"tiff", "libtiff", NULL, tiff_info, tiff_read};

ISO_MODULE(&format, NULL, NULL);
