/* The functions of isopoint.h for pictures in parts: surveying and drawing parts of a volume into keys
 * (render/view/key_image.h), merging them, and key files. */
#include <string.h>

#include "api/internal.h"
#include "base/memory.h"
#include "exact/chunks.h"
#include "image/camera.h"
#include "io/key_file.h"
#include "scene/keys_picture.h"
#include "scene/point_chunks.h"

enum { DEFAULT_SIDE = 1024 };

struct iso_keys {
    iso_pool *pool;
    iso_key_file file; /* with key surface and style; its keys are allocated when `begun` */
    bool level_set;
    bool described;                    /* a volume was seen, so the file's surface has its numbers */
    bool begun;                        /* the survey is complete, and there are pixels */
    bool of_files;                     /* all parts were read */
    double survey[ISO_SURVEY_NUMBERS]; /* iso_pullpush_survey_put */
};

static bool is_exact(const iso_keys *keys) {
    return keys->file.style.method == ISO_METHOD_EXACT;
}

/* ---- creation */

static iso_status check_opts(const iso_keys_opts *opts, iso_error *error) {
    for (int axis = 0; axis < 3; axis++)
        if (opts->dims[axis] < 1)
            return iso_fail(error, ISO_ERR_USAGE, "a whole of %d voxels on axis %d", opts->dims[axis], axis);
    if (opts->transform && iso_transform_is_singular(opts->transform))
        return iso_fail(error, ISO_ERR_USAGE, "spacing and direction of the whole do not span the space");
    const iso_renderer *renderer = iso_renderer_get(opts->method);
    if (!renderer) return iso_fail(error, ISO_ERR_USAGE, "there is no method %d", (int)opts->method);
    ISO_TRY(iso_renderer_require(renderer, ISO_CAN_CHUNKS, "the method", "parts of a picture", error));
    if (opts->width < 0 || opts->height < 0 || opts->width > ISO_IMAGE_MAX || opts->height > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_USAGE, "a picture of %d x %d pixels: sides are 1 to %d", opts->width,
                        opts->height, ISO_IMAGE_MAX);
    ISO_TRY(iso_picture_check_samples(opts->samples, error));
    if (!opts->camera) return iso_fail(error, ISO_ERR_USAGE, "parts need the camera of the whole");
    return iso_camera_check(opts->camera, error);
}

static void put_color(uint8_t bytes[4], const iso_rgb *color, iso_rgb usual) {
    const iso_rgb c = color ? *color : usual;
    memcpy(bytes, (const uint8_t[4]){c.r, c.g, c.b}, 4);
}

static void describe_picture(const iso_keys_opts *opts, iso_key_file *file) {
    const iso_rgb white = {255, 255, 255};
    iso_key_style *style = &file->style;
    memcpy(file->surface.dims, opts->dims, sizeof file->surface.dims);
    file->surface.transform = opts->transform ? *opts->transform : iso_transform_identity();
    file->surface.isovalue = opts->isovalue;
    style->width = opts->width ? opts->width : DEFAULT_SIDE;
    style->height = opts->height ? opts->height : DEFAULT_SIDE;
    style->samples = opts->samples ? opts->samples : iso_method_samples(opts->method);
    style->position = opts->camera->position;
    style->focal_point = opts->camera->focal_point;
    style->view_up = opts->camera->view_up;
    style->view_angle = opts->camera->view_angle;
    style->parallel_scale = opts->camera->parallel_scale;
    style->orthographic = opts->camera->orthographic;
    style->method = (int32_t)opts->method;
    style->transparent = opts->transparent;
    put_color(style->background, opts->background, white);
    put_color(style->color, opts->color, iso_shading_palette(0));
}

static iso_status create(int threads, iso_keys **keys, iso_error *error) {
    iso_keys *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for keys");
    const iso_status status = iso_api_pool(threads, &made->pool, error);
    if (status == ISO_OK)
        *keys = made;
    else
        iso_free(made);
    return status;
}

iso_status iso_keys_create(const iso_keys_opts *opts, iso_keys **keys, iso_error *error) {
    if (!opts) return iso_fail(error, ISO_ERR_USAGE, "parts need the camera of the whole");
    ISO_TRY(check_opts(opts, error));
    iso_keys *made = NULL;
    ISO_TRY(create(opts->threads, &made, error));
    describe_picture(opts, &made->file);
    const iso_pullpush_survey nothing = iso_pullpush_survey_begin();
    iso_pullpush_survey_put(&nothing, made->survey);
    *keys = made;
    return ISO_OK;
}

void iso_keys_destroy(iso_keys *keys) {
    if (!keys) return;
    iso_key_file_free(&keys->file);
    iso_pool_destroy(keys->pool);
    iso_free(keys);
}

/* ---- the voxels of a part */

/* The last voxel of the part + 1. */
static int end_of(const iso_keys *keys, const iso_keys_part *part, int axis) {
    return part->end[axis] ? part->end[axis] : keys->file.surface.dims[axis];
}

static iso_status check_box(const iso_keys *keys, const iso_keys_part *part, iso_error *error) {
    for (int axis = 0; axis < 3; axis++) {
        const int first = part->first[axis], end = end_of(keys, part, axis),
                  size = keys->file.surface.dims[axis];
        if (first < 0 || first >= end || end > size)
            return iso_fail(error, ISO_ERR_USAGE, "voxels %d .. %d on axis %d are not a part of %d", first,
                            end - 1, axis, size);
        if (first % ISO_BRICK || (end % ISO_BRICK && end != size))
            return iso_fail(error, ISO_ERR_USAGE,
                            "a part begins and ends at multiples of %d voxels, not at %d and %d", ISO_BRICK,
                            first, end);
    }
    return ISO_OK;
}

/* Describes the part as a chunk of the whole, and checks that the volume has its voxels. */
static iso_status make_chunk(const iso_keys *keys, const iso_keys_part *part, iso_grid_chunk *chunk,
                             iso_error *error) {
    const iso_rgrid *voxels = part->volume->grid.rgrid;
    iso_brick_box box;
    int first[3], end[3];
    if (!voxels) return iso_fail(error, ISO_ERR_USAGE, "parts are of dense volumes");
    ISO_TRY(check_box(keys, part, error));
    for (int axis = 0; axis < 3; axis++) {
        box.first[axis] = part->first[axis] / ISO_BRICK;
        box.end[axis] = (end_of(keys, part, axis) - 1) / ISO_BRICK + 1;
    }
    iso_grid_chunk_make(keys->file.surface.dims, &keys->file.surface.transform, &box, chunk);
    iso_grid_chunk_voxels(chunk, first, end);
    for (int axis = 0; axis < 3; axis++)
        if (first[axis] < part->origin[axis] || end[axis] - part->origin[axis] > voxels->dims[axis])
            return iso_fail(error, ISO_ERR_USAGE,
                            "the part needs voxels %d .. %d on axis %d, the volume has %d .. %d", first[axis],
                            end[axis] - 1, axis, part->origin[axis],
                            part->origin[axis] + voxels->dims[axis] - 1);
    return ISO_OK;
}

/* Enters what all volumes have in common; ISO_ERR_MISMATCH: this one differs from earlier ones. */
static iso_status describe_volume(iso_keys *keys, const iso_rgrid *voxels, iso_error *error) {
    iso_key_surface *surface = &keys->file.surface;
    const bool differs = surface->type != (int32_t)voxels->type || surface->scale != voxels->scale ||
                         surface->offset != voxels->offset || keys->level_set != (voxels->level_set != 0);
    if (keys->described && differs)
        return iso_fail(error, ISO_ERR_MISMATCH, "a part whose voxels have another type or scale");
    surface->type = (int32_t)voxels->type;
    surface->scale = voxels->scale;
    surface->offset = voxels->offset;
    keys->level_set = voxels->level_set != 0;
    keys->described = true;
    return ISO_OK;
}

/* Whether the voxels can be used where they are. Exact reads none that the part does not need; points read
 * whole bricks, so the volume must have those of the whole. */
static bool can_view(const iso_keys *keys, const iso_keys_part *part, const iso_grid_chunk *chunk) {
    if (is_exact(keys)) return true;
    for (int axis = 0; axis < 3; axis++)
        if (part->origin[axis] % ISO_BRICK || part->origin[axis] > ISO_BRICK * chunk->origin[axis])
            return false;
    return true;
}

/* Copies the voxels that the chunk needs to its grid. */
static void copy_voxels(const iso_rgrid *from, const int origin[3], const iso_grid_chunk *chunk,
                        iso_rgrid *to) {
    const ptrdiff_t bytes = (ptrdiff_t)iso_type_size(from->type);
    int first[3], end[3];
    iso_grid_chunk_voxels(chunk, first, end);
    for (int z = first[2]; z < end[2]; z++)
        for (int y = first[1]; y < end[1]; y++) {
            const ptrdiff_t source =
                (first[0] - origin[0]) + (y - origin[1]) * from->stride_y + (z - origin[2]) * from->stride_z;
            const ptrdiff_t target = (first[0] - ISO_BRICK * chunk->origin[0]) +
                                     (y - ISO_BRICK * chunk->origin[1]) * to->stride_y +
                                     (z - ISO_BRICK * chunk->origin[2]) * to->stride_z;
            memcpy((char *)to->data + target * bytes, (const char *)from->data + source * bytes,
                   (size_t)((end[0] - first[0]) * bytes));
        }
}

/* Makes the chunk's grid, of the volume's voxels where they are, or of a copy of them. */
static iso_status make_grid(const iso_keys *keys, const iso_keys_part *part, const iso_grid_chunk *chunk,
                            iso_rgrid **grid, iso_error *error) {
    const iso_rgrid *voxels = part->volume->grid.rgrid;
    const size_t bytes = iso_type_size(voxels->type);
    iso_rgrid_desc desc = {.dims = {chunk->size[0], chunk->size[1], chunk->size[2]},
                           .type = voxels->type,
                           .scale = voxels->scale,
                           .offset = voxels->offset,
                           .transform = &chunk->transform,
                           .level_set = voxels->level_set};
    const bool viewed = can_view(keys, part, chunk);
    if (viewed) {
        ptrdiff_t shift = ISO_BRICK * chunk->origin[0] - part->origin[0];
        shift += (ISO_BRICK * chunk->origin[1] - part->origin[1]) * voxels->stride_y;
        shift += (ISO_BRICK * chunk->origin[2] - part->origin[2]) * voxels->stride_z;
        /* The first voxel of the chunk's grid may lie before the array, and is not read then. */
        desc.data = (void *)((uintptr_t)voxels->data + (uintptr_t)(shift * (ptrdiff_t)bytes));
    }
    ISO_TRY(iso_rgrid_create(&desc, grid, error));
    if (viewed) {
        (*grid)->stride_y = voxels->stride_y;
        (*grid)->stride_z = voxels->stride_z;
    } else {
        memset((*grid)->data, 0, (size_t)((*grid)->stride_z * chunk->size[2]) * bytes);
        copy_voxels(voxels, part->origin, chunk, *grid);
    }
    return ISO_OK;
}

/* ---- surveying and drawing */

typedef iso_status use_part(iso_keys *keys, const iso_grid_chunk *chunk, iso_rgrid *grid, iso_error *error);

/* Calls `use` with the part as a chunk of the whole. */
static iso_status with_part(iso_keys *keys, const iso_keys_part *part, use_part *use, iso_error *error) {
    iso_grid_chunk chunk;
    iso_rgrid *grid = NULL;
    if (keys->of_files) return iso_fail(error, ISO_ERR_USAGE, "keys that were read have all parts already");
    ISO_TRY(make_chunk(keys, part, &chunk, error));
    ISO_TRY(describe_volume(keys, part->volume->grid.rgrid, error));
    ISO_TRY(make_grid(keys, part, &chunk, &grid, error));
    const iso_status status = use(keys, &chunk, grid, error);
    iso_rgrid_destroy(grid);
    return status;
}

/* Points near voxels that are not finite depend on more than a part. */
static iso_status extract_points(const iso_keys *keys, const iso_grid_chunk *chunk, iso_rgrid *grid,
                                 iso_point_set **points, iso_error *error) {
    const iso_grid handle = {.rgrid = grid};
    if (iso_grid_count_nonfinite(&handle, keys->pool))
        return iso_fail(error, ISO_ERR_USAGE,
                        "points of a volume with voxels that are NaN or infinite are not drawn in parts: "
                        "exact is");
    return iso_point_chunk_extract(grid, chunk, keys->file.surface.isovalue, keys->pool, points, error);
}

static iso_status survey(iso_keys *keys, const iso_grid_chunk *chunk, iso_rgrid *grid, iso_error *error) {
    const iso_view view = iso_key_style_view(&keys->file.style);
    iso_pullpush_survey all = iso_pullpush_survey_get(keys->survey);
    iso_point_set *points = NULL;
    ISO_TRY(extract_points(keys, chunk, grid, &points, error));
    const iso_point_view own = iso_point_set_view(points);
    iso_status status = ISO_OK;
    if (own.span_count) status = iso_pullpush_survey_add(&all, &view, &own, keys->pool, error);
    if (status == ISO_OK) iso_pullpush_survey_put(&all, keys->survey);
    iso_point_set_destroy(points);
    return status;
}

iso_status iso_keys_survey(iso_keys *keys, const iso_keys_part *part, iso_error *error) {
    if (is_exact(keys)) return ISO_OK; /* it needs none */
    if (keys->begun) return iso_fail(error, ISO_ERR_USAGE, "a part is surveyed after one was drawn");
    return with_part(keys, part, survey, error);
}

double *iso_keys_surveyed(iso_keys *keys) {
    return keys->survey;
}

/* Completes the survey and allocates the pixels, unless that is done. */
static iso_status begin(iso_keys *keys, iso_error *error) {
    iso_key_style *style = &keys->file.style;
    const iso_view view = iso_key_style_view(style);
    int width = view.width, height = view.height;
    if (keys->begun) return ISO_OK;
    if (!is_exact(keys)) {
        const iso_pullpush_survey whole = iso_pullpush_survey_get(keys->survey);
        if (whole.lo[0] > whole.hi[0])
            return iso_fail(error, ISO_ERR_EMPTY, "the survey of the parts has found no surface");
        style->base = iso_pullpush_base_of(&whole, &view);
        width = style->base.width;
        height = style->base.height;
    }
    ISO_TRY(iso_key_image_allocate(width, height, &keys->file.keys, error));
    keys->begun = true;
    return ISO_OK;
}

static iso_status draw_cells(iso_keys *keys, const iso_grid_chunk *chunk, iso_rgrid *grid, iso_error *error) {
    const iso_view view = iso_key_style_view(&keys->file.style);
    const uint8_t *color = keys->file.style.color;
    const iso_exact_key_picture picture = {
        &view, {color[0], color[1], color[2]}, &keys->file.keys, keys->pool, NULL};
    iso_exact *exact = NULL;
    ISO_TRY(iso_exact_chunk_create(grid, chunk, keys->file.surface.isovalue, keys->pool, &exact, error));
    const iso_status status = iso_draw_exact_keys(&picture, exact, error);
    iso_exact_destroy(exact);
    return status;
}

static iso_status draw_points(iso_keys *keys, const iso_grid_chunk *chunk, iso_rgrid *grid,
                              iso_error *error) {
    const iso_view view = iso_key_style_view(&keys->file.style);
    const iso_pullpush_survey whole = iso_pullpush_survey_get(keys->survey);
    const iso_pullpush_keys picture = {&view, keys->file.style.base, &keys->file.keys, keys->pool};
    iso_point_set *points = NULL;
    ISO_TRY(extract_points(keys, chunk, grid, &points, error));
    const iso_point_view own = iso_point_set_view(points);
    iso_status status = ISO_OK;
    if (own.span_count) {
        iso_pullpush_flip_keys(picture.keys, picture.pool);
        status = iso_pullpush_draw_keys(&picture, &whole, &own, error);
        iso_pullpush_flip_keys(picture.keys, picture.pool);
    }
    iso_point_set_destroy(points);
    return status;
}

iso_status iso_keys_draw(iso_keys *keys, const iso_keys_part *part, iso_error *error) {
    ISO_TRY(begin(keys, error));
    return with_part(keys, part, is_exact(keys) ? draw_cells : draw_points, error);
}

/* ---- merging and showing */

iso_status iso_keys_pixels(iso_keys *keys, uint64_t **pixels, size_t *count, iso_error *error) {
    ISO_TRY(begin(keys, error));
    *pixels = keys->file.keys.keys;
    *count = (size_t)keys->file.keys.width * (size_t)keys->file.keys.height;
    return ISO_OK;
}

iso_status iso_keys_merge(iso_keys *keys, const iso_keys *other, iso_error *error) {
    const iso_key_file *to = &keys->file, *from = &other->file;
    if (!other->begun) return ISO_OK;
    ISO_TRY(begin(keys, error));
    const bool known = keys->described && other->described;
    if (memcmp(&to->style, &from->style, sizeof to->style) != 0 ||
        (known && memcmp(&to->surface, &from->surface, sizeof to->surface) != 0))
        return iso_fail(error, ISO_ERR_MISMATCH, "keys of another surface, camera or survey");
    iso_key_image_minimum(&keys->file.keys, &from->keys, keys->pool);
    return ISO_OK;
}

iso_status iso_keys_show(const iso_keys *keys, iso_image *image, iso_error *error) {
    const iso_key_style *style = &keys->file.style;
    iso_key_image merged = keys->file.keys;
    if (!keys->begun) return iso_fail(error, ISO_ERR_EMPTY, "no part was drawn");
    if (image->width != style->width || image->height != style->height || !image->rgba) {
        iso_image_free(image);
        ISO_TRY(iso_image_create(style->width, style->height, image, error));
    }
    return iso_render_key_style(style, &keys->file.surface.transform, keys->file.surface.dims, &merged,
                                keys->pool, image, error);
}

/* ---- files */

iso_status iso_keys_write(const iso_keys *keys, int part, int parts, const char *path, iso_error *error) {
    char software[64] = "isopoint ";
    iso_key_file file = keys->file;
    ISO_TRY(iso_api_check_path(path, error));
    if (part < 1 || part > parts || parts > ISO_KEY_PARTS)
        return iso_fail(error, ISO_ERR_USAGE, "part %d of %d: there can be 1 to %d", part, parts,
                        ISO_KEY_PARTS);
    if (!keys->begun || !keys->described) return iso_fail(error, ISO_ERR_USAGE, "no part was drawn");
    file.part = part;
    file.parts = parts;
    strncat(software, iso_version(), sizeof software - strlen(software) - 1);
    if (!keys->of_files) file.texts[ISO_KEY_SOFTWARE] = software;
    return iso_key_file_write(path, &file, error);
}

iso_status iso_keys_read(const char *const *paths, int count, uint64_t max_memory, int threads,
                         iso_keys **keys, iso_error *error) {
    const uint64_t limit = iso_memory_limit(max_memory);
    iso_keys *made = NULL;
    if (count < 1) return iso_fail(error, ISO_ERR_USAGE, "no file is named");
    ISO_TRY(create(threads, &made, error));
    const iso_status status =
        iso_key_files_merge(paths, count, limit == UINT64_MAX ? 0 : limit, made->pool, &made->file, error);
    if (status != ISO_OK) {
        iso_keys_destroy(made);
        return status;
    }
    made->described = made->begun = made->of_files = true;
    *keys = made;
    return ISO_OK;
}
