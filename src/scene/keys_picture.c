/* keys_picture: paints the keys of exact, or averages them; pulls and pushes those of points; annotates. */
#include "scene/keys_picture.h"

#include <string.h>

#include "extract/points/points.h"
#include "image/camera.h"
#include "io/key_file.h"
#include "scene/picture_file.h"

/* ---- points */

typedef struct points_draw {
    iso_reconstruction reconstruction;
    iso_pullpush_keys keys;
    iso_point_view view;
} points_draw;

static iso_status draw_merged(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const points_draw *draw = context;
    const iso_target target = {view, gbuffer, draw->keys.pool, 0, NULL};
    return iso_pullpush_draw_merged(&target, &draw->keys, &draw->view, draw->reconstruction, error);
}

static iso_status render_points(const iso_merged_keys *keys, const iso_picture_opts *opts, iso_image *image,
                                size_t *covered, iso_error *error) {
    const iso_view pixels = iso_view_make(opts->camera, opts->width, opts->height),
                   view = iso_view_scaled(&pixels, iso_picture_factor(opts->samples));
    points_draw draw = {
        .reconstruction =
            keys->method == ISO_METHOD_PULLPUSH_BOX ? ISO_RECONSTRUCTION_BOX : ISO_RECONSTRUCTION_GAUSSIAN,
        .keys = {&view, keys->base, keys->image, opts->pool},
        .view = {.transform = keys->transform, .radius = iso_edge_point_radius(&keys->transform)},
    };
    iso_picture_opts merged = *opts;
    memcpy(draw.view.dims, keys->dims, sizeof draw.view.dims);
    merged.draw = draw_merged;
    merged.draw_context = &draw;
    merged.begin_strip = NULL; /* it would get the context of `draw` */
    return iso_picture_render(&merged, image, covered, error);
}

/* ---- cells */

typedef struct cells_draw {
    const iso_key_image *keys;
    iso_pool *pool;
} cells_draw;

typedef struct cell_rows {
    const uint64_t *keys; /* from the first row on */
    iso_gbuffer *gbuffer;
} cell_rows;

/* Writes a row of keys as samples that have colours of their own, and all the light. */
static void write_row(void *context, size_t row, int worker) {
    (void)worker;
    const cell_rows *rows = context;
    const iso_gbuffer *gbuffer = rows->gbuffer;
    const size_t width = (size_t)gbuffer->width, end = (row + 1) * width;
    for (size_t i = row * width; i < end; i++) {
        if (rows->keys[i] == ISO_KEY_EMPTY) continue;
        gbuffer->surface[i] = 0;
        gbuffer->color[i] = ((uint32_t)rows->keys[i] & 0xffffff) | 1u << 24;
        gbuffer->light[i] = 1;
    }
}

static iso_status draw_cells(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const cells_draw *draw = context;
    ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    ISO_TRY(iso_gbuffer_add_plane(gbuffer, &gbuffer->light, error));
    cell_rows rows = {draw->keys->keys + (size_t)view->above * (size_t)view->width, gbuffer};
    iso_parallel_for(draw->pool, (size_t)view->height, write_row, &rows);
    return ISO_OK;
}

static iso_status render_cells(const iso_merged_keys *keys, const iso_picture_opts *opts, iso_image *image,
                               size_t *covered, iso_error *error) {
    if (iso_picture_factor(opts->samples) == 1) {
        *covered = iso_key_image_paint(keys->image, iso_shading_empty(&opts->shading), image, opts->pool);
        return ISO_OK;
    }
    cells_draw draw = {keys->image, opts->pool};
    iso_picture_opts merged = *opts;
    merged.draw = draw_cells;
    merged.draw_context = &draw;
    merged.begin_strip = NULL;
    return iso_picture_render(&merged, image, covered, error);
}

iso_status iso_render_merged_keys(const iso_merged_keys *keys, const iso_picture_opts *opts, iso_image *image,
                                  size_t *covered, iso_error *error) {
    return keys->method == ISO_METHOD_EXACT ? render_cells(keys, opts, image, covered, error)
                                            : render_points(keys, opts, image, covered, error);
}

/* ---- styles */

static iso_rgb rgb_of(const uint8_t bytes[4]) {
    return (iso_rgb){bytes[0], bytes[1], bytes[2]};
}

iso_status iso_render_key_style(const iso_key_style *style, const iso_transform *transform,
                                const int32_t dims[3], iso_key_image *image, iso_pool *pool,
                                iso_image *picture, iso_error *error) {
    const iso_rgb color = rgb_of(style->color), background = rgb_of(style->background);
    const iso_camera camera = iso_key_style_camera(style);
    const iso_picture_opts opts = {.camera = &camera,
                                   .width = style->width,
                                   .height = style->height,
                                   .samples = style->samples,
                                   .shading = {&color, 1, background, style->transparent, {0, 0, 0}},
                                   .pool = pool};
    const iso_merged_keys keys = {
        (iso_method)style->method, style->base, *transform, {dims[0], dims[1], dims[2]}, image};
    iso_color_bar bar = {
        .map = (iso_colormap)style->colormap, .low = style->bar_low, .high = style->bar_high};
    memcpy(bar.title, style->bar_title, sizeof bar.title);
    const iso_annotation annotation = {
        .camera = &camera,
        .font_size = style->font_size,
        .lengths = {(iso_length_unit)style->unit, (iso_world_unit)style->world_unit},
        .scale_bar = style->scale_bar != 0,
        .orientation_marker = style->orientation_marker != 0,
        .anatomical = style->anatomical != 0,
        .color_bars = &bar,
        .color_bar_count = style->color_bar,
        .dark = iso_is_dark(background, style->transparent != 0),
        .under = picture,
        .background = background};
    size_t covered = 0;
    ISO_TRY(iso_camera_check(&camera, error));
    ISO_TRY(iso_render_merged_keys(&keys, &opts, picture, &covered, error));
    if (!covered) return iso_fail(error, ISO_ERR_EMPTY, "nothing of the surface is in view");
    return iso_annotate(picture, &annotation, error);
}

iso_status iso_keys_picture_write(const char *path, const char *const *parts, int count, uint64_t max_memory,
                                  iso_pool *pool, iso_error *error) {
    iso_key_file file;
    iso_image image = {0};
    ISO_TRY(iso_key_files_merge(parts, count, max_memory, pool, &file, error));
    const iso_key_style *style = &file.style;
    const iso_picture_facts facts = {.software = file.texts[ISO_KEY_SOFTWARE],
                                     .title = file.texts[ISO_KEY_TITLE],
                                     .command = file.texts[ISO_KEY_COMMENT],
                                     .description = file.texts[ISO_KEY_DESCRIPTION],
                                     .scene = file.texts[ISO_KEY_SCENE],
                                     .pixels_per_metre = style->pixels_per_metre,
                                     .pool = pool};
    iso_status status = iso_image_create(style->width, style->height, &image, error);
    if (status == ISO_OK)
        status = iso_render_key_style(style, &file.surface.transform, file.surface.dims, &file.keys, pool,
                                      &image, error);
    if (status == ISO_OK) status = iso_picture_file_write(path, &image, NULL, &facts, error);
    iso_image_free(&image);
    iso_key_file_free(&file);
    return status;
}
