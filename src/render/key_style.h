/* key_style: what a picture that is drawn in parts (render/view/key_image.h) is to look like: equal in all
 * parts. */
#ifndef ISO_RENDER_KEY_STYLE_H
#define ISO_RENDER_KEY_STYLE_H

#include "image/camera.h"
#include "image/colormap.h"
#include "isopoint.h"
#include "render/pullpush/keys.h"

/* Zero-initialised: it is compared byte by byte. */
typedef struct iso_key_style {
    int32_t width, height;                   /* of the picture */
    int32_t samples;                         /* per pixel: 1, 4, 9 .. 64 */
    iso_pullpush_base base;                  /* of pull-push; zero for exact */
    iso_vec3 position, focal_point, view_up; /* iso_camera */
    double view_angle, parallel_scale;
    double pixels_per_metre;                                                      /* iso_png_opts */
    int32_t method;                                                               /* iso_method */
    int32_t orthographic, transparent, scale_bar, orientation_marker, anatomical; /* 0 or 1 */
    int32_t unit, world_unit;            /* of lengths: iso_length_style */
    int32_t caps;                        /* 1: the keys have the planes of a surface with caps; 0 */
    int32_t color_bar, colormap;         /* 1: there is one, of what slices show, and its iso_colormap; 0 */
    int32_t unused;                      /* 0: in place of padding, which would be compared */
    double bar_low, bar_high;            /* the numbers at its ends */
    char bar_title[ISO_COLOR_BAR_TITLE]; /* zeros behind its end */
    double font_size;                    /* pixels; 0: by the picture's size */
    uint8_t background[4], color[4];     /* RGB and 0 */
} iso_key_style;

iso_camera iso_key_style_camera(const iso_key_style *style);
/* The view of all samples of the picture. */
iso_view iso_key_style_view(const iso_key_style *style);

#endif
