/* key_style: the camera of a picture that is drawn in parts. */
#include "render/key_style.h"

#include "render/picture.h"

iso_camera iso_key_style_camera(const iso_key_style *style) {
    return (iso_camera){.position = style->position,
                        .focal_point = style->focal_point,
                        .view_up = style->view_up,
                        .view_angle = style->view_angle,
                        .orthographic = style->orthographic != 0,
                        .parallel_scale = style->parallel_scale};
}

iso_view iso_key_style_view(const iso_key_style *style) {
    const iso_camera camera = iso_key_style_camera(style);
    const iso_view pixels = iso_view_make(&camera, style->width, style->height);
    return iso_view_scaled(&pixels, iso_picture_factor(style->samples));
}
