/* image_stack: see the header. */
#include "grids/volume/image_stack.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct image_stack {
    const iso_image_codec *codec;
    iso_slice_files files;
    iso_image_header first; /* its `scratch`: the largest of any slice */
    int component;          /* that is read */
} image_stack;

static bool is_same(const iso_image_layout *a, const iso_image_layout *b) {
    return a->width == b->width && a->height == b->height && a->scalar == b->scalar &&
           a->samples == b->samples;
}

iso_status iso_image_check_unchanged(const char *path, const iso_image_header *now,
                                     const iso_image_layout *expected, uint64_t scratch, iso_error *error) {
    if (is_same(&now->layout, expected) && now->scratch <= scratch) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
}

static iso_status check_slice(const image_stack *stack, uint32_t number, const iso_image_layout *slice,
                              iso_error *error) {
    const iso_image_layout *first = &stack->first.layout;
    if (is_same(slice, first)) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: is %u x %u %s with %d sample(s), but the first slice (%s) is %u x %u %s with %d",
                    stack->files.paths[number], slice->width, slice->height, iso_scalar_name(slice->scalar),
                    slice->samples, stack->files.paths[0], first->width, first->height,
                    iso_scalar_name(first->scalar), first->samples);
}

/* Lists the slices and reads their headers. iso_slice_files_free when done, also after an error. */
static iso_status open_stack(const iso_image_codec *codec, const char *path, const iso_volume_opts *opts,
                             image_stack *stack, iso_error *error) {
    *stack = (image_stack){.codec = codec};
    ISO_TRY(iso_slice_files_list(path, codec->kind, &stack->files, error));
    for (uint32_t i = 0; i < stack->files.count; i++) iso_file_set_read(opts->files, stack->files.paths[i]);
    for (uint32_t i = 0; i < stack->files.count; i++) {
        iso_image_header slice = {0};
        ISO_TRY(codec->header(stack->files.paths[i], &slice, error));
        if (i == 0) stack->first = slice;
        if (slice.scratch > stack->first.scratch) stack->first.scratch = slice.scratch;
        ISO_TRY(check_slice(stack, i, &slice.layout, error));
    }
    return ISO_OK;
}

static iso_status describe(const char *path, const iso_volume_opts *opts, image_stack *stack,
                           iso_volume_info *info, iso_error *error) {
    const iso_image_header *first = &stack->first;
    const iso_image_layout *l = &first->layout;
    ISO_TRY(iso_format_dims(path, (const uint64_t[3]){l->width, l->height, stack->files.count}, info, error));
    ISO_TRY(iso_format_component(path, opts, l->samples, info, error));
    stack->component = info->component;
    info->type = iso_scalar_stored_type(l->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(l->scalar));
    if (first->note[0]) iso_volume_note(info, "%s", first->note);
    iso_slice_files_set_spacing((const double[3]){first->spacing[0], first->spacing[1], 0}, opts, info);
    info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (__builtin_add_overflow(info->bytes, first->scratch, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

iso_status iso_image_stack_info(const iso_image_codec *codec, const char *path, const iso_volume_opts *opts,
                                iso_volume_info *info, iso_error *error) {
    image_stack stack;
    iso_status status = open_stack(codec, path, opts, &stack, error);
    if (status == ISO_OK) status = describe(path, opts, &stack, info, error);
    iso_slice_files_free(&stack.files);
    return status;
}

static iso_status read_slice(void *context, const int index[3], void *values, iso_error *error) {
    const image_stack *stack = context;
    return stack->codec->decode(stack->files.paths[index[2]], &stack->first.layout, stack->first.scratch,
                                stack->component, values, error);
}

static void destroy_stack(void *context) {
    image_stack *stack = context;
    iso_slice_files_free(&stack->files);
    free(stack);
}

/* Reads the headers again. */
static iso_status prepare_tiles(const iso_image_codec *codec, const char *path, const iso_volume_opts *opts,
                                const iso_volume_info *info, image_stack *stack, iso_tiled *tiled,
                                iso_error *error) {
    iso_volume_info now = {.components = 1, .scale = 1, .transform = iso_transform_identity()};
    ISO_TRY(open_stack(codec, path, opts, stack, error));
    ISO_TRY(describe(path, opts, stack, &now, error));
    if (now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    const uint64_t scratch = stack->first.scratch;
    *tiled = (iso_tiled){.dims = {now.dims[0], now.dims[1], now.dims[2]},
                         .tile = {now.dims[0], now.dims[1], 1},
                         .type = now.type,
                         .scratch = scratch,
                         .read = read_slice,
                         .destroy = destroy_stack,
                         .context = stack};
    uint64_t bytes = iso_format_size(tiled->tile, iso_type_size(now.type));
    if (__builtin_add_overflow(bytes, scratch, &bytes)) bytes = UINT64_MAX;
    return iso_format_check_memory(path, opts, bytes, "a slice", error);
}

iso_status iso_image_stack_open(const iso_image_codec *codec, const char *path, const iso_volume_opts *opts,
                                const iso_volume_info *info, iso_tiled *tiled, iso_error *error) {
    image_stack *stack = calloc(1, sizeof *stack);
    if (!stack) return iso_fail_memory(error, path);
    const iso_status status = prepare_tiles(codec, path, opts, info, stack, tiled, error);
    if (status != ISO_OK) destroy_stack(stack);
    return status;
}
