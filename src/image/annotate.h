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

/* A line of a legend: a swatch of a colour, and what has it. */
typedef struct iso_legend_entry {
    const char *name; /* characters that the vector font lacks are blank */
    iso_rgb color;
} iso_legend_entry;

/* In which unit a length is shown. */
typedef enum iso_length_unit {
    ISO_UNIT_AUTO, /* m, mm, um or nm, as it is short; none when the world has no unit */
    ISO_UNIT_NONE,
    ISO_UNIT_NM,
    ISO_UNIT_UM,
    ISO_UNIT_MM,
    ISO_UNIT_CM,
    ISO_UNIT_M,
    ISO_UNIT_KM,
    ISO_UNITS
} iso_length_unit;

/* How lengths in the world are shown. */
typedef struct iso_length_style {
    iso_length_unit unit;
    iso_world_unit world; /* of the coordinates; where it is no metric length, `unit` is a label alone */
} iso_length_style;

/* "mm"; "" for ISO_UNIT_NONE and, in a world without a unit, ISO_UNIT_AUTO. Static. */
const char *iso_length_unit_name(const iso_length_style *style);
/* What a length in the world is multiplied by to be shown with that name. */
double iso_length_factor(const iso_length_style *style);

typedef struct iso_annotation {
    const iso_camera *camera;        /* of the picture; borrowed */
    iso_length_style lengths;        /* of the scale bar */
    bool scale_bar;                  /* bottom right, with its length; for orthographic cameras only */
    bool orientation_marker;         /* bottom left: the world's axes as the camera sees them */
    bool anatomical;                 /* the axes are L R, A P and H F (the world is LPS); else x y z */
    const iso_color_bar *color_bars; /* at the right, beside each other; borrowed */
    int color_bar_count;
    const iso_legend_entry
        *legend; /* at the top left, in columns that are as high as the picture; borrowed */
    int legend_count;
    bool dark; /* the background is dark, so lines are drawn light */
} iso_annotation;

/* Whether annotations on this background are to be drawn light. */
bool iso_is_dark(iso_rgb background, bool transparent);

/* Draws the annotations that are set; what lies outside the picture is clipped. ISO_ERR_NOMEM. */
iso_status iso_annotate(iso_image *image, const iso_annotation *annotation, iso_error *error);

/* The length of the scale bar in the world: 1, 2 or 5 times a power of ten, nearest to a fifth of the
 * picture's width. 0 for a perspective camera, whose pictures have no single scale. */
double iso_scale_bar_length(const iso_camera *camera, int width, int height);

/* The label of a scale bar of `length` (from iso_scale_bar_length), such as "10 mm", "50 um" or, without a
 * unit, "20". */
void iso_scale_bar_label(double length, const iso_length_style *style, char label[32]);

#endif
