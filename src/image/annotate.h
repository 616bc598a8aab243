/* annotate: draws a scale bar, an orientation marker and colour bars over a finished picture.
 *
 * Lines are outlined in the contrasting colour, so that they are legible on any background. Their size is
 * relative to the picture's. Lines are sampled at 8 x 8 points a pixel and blended in integers, so that the
 * bytes are the same on every machine. */
#ifndef ISO_IMAGE_ANNOTATE_H
#define ISO_IMAGE_ANNOTATE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/unit.h"
#include "image/camera.h"
#include "image/colormap.h"
#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A colour bar: shows which colours of a map stand for which numbers. */
typedef struct iso_color_bar {
    iso_colormap map;
    double low, high; /* the numbers at the ends of the bar */
} iso_color_bar;

typedef struct iso_annotation {
    const iso_camera *camera;        /* of the picture; borrowed */
    iso_world_unit unit;             /* of the world, for the scale bar */
    bool scale_bar;                  /* bottom right, with its length; for orthographic cameras only */
    bool orientation_marker;         /* bottom left: the world's axes as the camera sees them */
    bool anatomical;                 /* the axes are L R, A P and H F (the world is LPS); else x y z */
    const iso_color_bar *color_bars; /* at the right, beside each other; borrowed */
    int color_bar_count;
    bool dark; /* the background is dark, so lines are drawn light */
} iso_annotation;

/* Whether annotations on this background are to be drawn light. */
bool iso_is_dark(iso_rgb background, bool transparent);

/* Draws the annotations that are set; what lies outside the picture is clipped. ISO_ERR_NOMEM. */
iso_status iso_annotate(iso_image *image, const iso_annotation *annotation, iso_error *error);

/* The length of the scale bar in the world: 1, 2 or 5 times a power of ten, nearest to a fifth of the
 * picture's width. 0 for a perspective camera, whose pictures have no single scale. */
double iso_scale_bar_length(const iso_camera *camera, int width, int height);

/* The label of a scale bar of `length` units (from iso_scale_bar_length), such as "10 mm", "50 um" or,
 * without a unit, "20". */
void iso_scale_bar_label(double length, iso_world_unit unit, char label[32]);

#ifdef __cplusplus
}
#endif
#endif
