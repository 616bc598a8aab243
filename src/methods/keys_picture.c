/* keys_picture: paints the keys of exact; pulls and pushes those of points; annotates. */
#include "methods/keys_picture.h"

#include <string.h>

#include "extract/points/points.h"
#include "image/annotate.h"
#include "image/camera.h"

/* ---- points */

typedef struct points_draw {
    iso_reconstruction reconstruction;
    iso_pullpush_keys keys;
    iso_point_view view;
} points_draw;

static iso_status draw_merged(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const points_draw *draw = context;
    const iso_target target = {view, gbuffer, draw->keys.pool, 0};
    return iso_pullpush_draw_merged(&target, &draw->keys, &draw->view, draw->reconstruction, error);
}

static iso_status render_points(const iso_merged_keys *keys, const iso_picture_opts *opts, iso_image *image,
                                size_t *covered, iso_error *error) {
    const iso_view view = iso_view_make(opts->camera, opts->width, opts->height);
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

iso_status iso_render_merged_keys(const iso_merged_keys *keys, const iso_picture_opts *opts, iso_image *image,
                                  size_t *covered, iso_error *error) {
    if (keys->method != ISO_METHOD_EXACT) return render_points(keys, opts, image, covered, error);
    *covered = iso_key_image_paint(keys->image, &opts->shading, image, opts->pool);
    return ISO_OK;
}

/* ---- styles */

static iso_rgb rgb_of(const uint8_t bytes[4]) {
    return (iso_rgb){bytes[0], bytes[1], bytes[2]};
}

iso_camera iso_key_style_camera(const iso_key_style *style) {
    return (iso_camera){.position = style->position,
                        .focal_point = style->focal_point,
                        .view_up = style->view_up,
                        .view_angle = style->view_angle,
                        .orthographic = style->orthographic != 0,
                        .parallel_scale = style->parallel_scale};
}

iso_status iso_render_key_style(const iso_key_style *style, const iso_transform *transform,
                                const int32_t dims[3], iso_key_image *image, iso_pool *pool,
                                iso_image *picture, iso_error *error) {
    const iso_rgb color = rgb_of(style->color), background = rgb_of(style->background);
    const iso_camera camera = iso_key_style_camera(style);
    const iso_picture_opts opts = {.camera = &camera,
                                   .width = style->width,
                                   .height = style->height,
                                   .samples = 1,
                                   .shading = {&color, 1, background, style->transparent},
                                   .pool = pool};
    const iso_merged_keys keys = {
        (iso_method)style->method, style->base, *transform, {dims[0], dims[1], dims[2]}, image};
    const iso_annotation annotation = {
        .camera = &camera,
        .lengths = {(iso_length_unit)style->unit, (iso_world_unit)style->world_unit},
        .scale_bar = style->scale_bar != 0,
        .orientation_marker = style->orientation_marker != 0,
        .anatomical = style->anatomical != 0,
        .dark = iso_is_dark(background, style->transparent != 0)};
    size_t covered = 0;
    ISO_TRY(iso_camera_check(&camera, error));
    ISO_TRY(iso_render_merged_keys(&keys, &opts, picture, &covered, error));
    if (!covered) return iso_fail(error, ISO_ERR_EMPTY, "nothing of the surface is in view");
    return iso_annotate(picture, &annotation, error);
}
