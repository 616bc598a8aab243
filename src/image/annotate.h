/* annotate: scale bar, orientation marker, colour bars, legend, notes and insets over a finished picture, as
 * marks of a drawing.
 *
 * Each of the first four has a usual place. Where that would cover what the picture shows, it stands at
 * another corner or side, where it covers the least; where all are covered alike it stays.
 *
 * Lines and letters are outlined in the contrasting colour, so that they are legible on any background. Their
 * size is relative to the picture's unless a size of the font is given. */
#ifndef ISO_IMAGE_ANNOTATE_H
#define ISO_IMAGE_ANNOTATE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/unit.h"
#include "image/camera.h"
#include "image/colormap.h"
#include "image/drawing.h"

/* In which unit a length is shown. */
typedef enum iso_length_unit {
    ISO_UNIT_AUTO, /* km, m, cm, mm, um, nm or Angstrom, as it is short; none when the world has no unit */
    ISO_UNIT_NONE,
    ISO_UNIT_NM,
    ISO_UNIT_UM,
    ISO_UNIT_MM,
    ISO_UNIT_CM,
    ISO_UNIT_M,
    ISO_UNIT_KM,
    ISO_UNIT_ANGSTROM,
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

typedef enum iso_corner {
    ISO_CORNER_TOP_RIGHT,
    ISO_CORNER_TOP_LEFT,
    ISO_CORNER_BOTTOM_RIGHT,
    ISO_CORNER_BOTTOM_LEFT
} iso_corner;

/* A part of the picture, drawn larger in a corner: left, top, right, bottom. */
typedef struct iso_inset {
    double box[4]; /* the part, of the picture's width and height, and the corner: set by the caller */
    iso_corner corner;
    int part[4], place[4]; /* the part and where it lies when it is larger, pixels, */
    int factor;            /* and how many times: iso_inset_place sets them */
    iso_image *picture;    /* fills the place; taken by the drawing and zeroed */
} iso_inset;
enum { ISO_INSET_MOST = 8 }; /* times larger */

/* Makes an inset 2 times as large as its part, and more while it fills less than .45 of the picture's
 * sides. */
void iso_inset_place(iso_inset *inset, int width, int height);

/* What can stand at another place, and as what messages know it. */
typedef enum iso_annotation_kind {
    ISO_ANNOTATION_MARKER,
    ISO_ANNOTATION_LEGEND,
    ISO_ANNOTATION_COLOR_BARS,
    ISO_ANNOTATION_SCALE_BAR,
    ISO_ANNOTATION_KINDS
} iso_annotation_kind;

/* Where annotations stand in pictures that follow each other: chosen for the first, kept for the others. */
typedef struct iso_annotation_places {
    bool chosen;
    int place[ISO_ANNOTATION_KINDS]; /* 0: the usual one */
    double
        covered[ISO_ANNOTATION_KINDS]; /* the share of its box in which the first picture shows something */
    int legend_more;                   /* entries that are not shown; set by each picture */
} iso_annotation_places;

typedef struct iso_annotation {
    const iso_camera *camera; /* of the picture; borrowed */
    double font_size;         /* pixels; 0: by the picture's size */
    iso_length_style lengths; /* of scale bar and rulers */
    bool scale_bar;           /* usually bottom right, with its length; for orthographic cameras only */
    bool orientation_marker;  /* usually bottom left: the world's axes as the camera sees them */
    bool anatomical;          /* the axes are L R, A P and H F (the world is LPS); else x y z */
    const iso_color_bar *color_bars; /* usually at the right, beside each other; borrowed */
    int color_bar_count;
    const iso_legend_entry
        *legend; /* usually at the top left, in columns that are as high as the picture; borrowed */
    int legend_count, legend_more; /* entries, and how many more are left out of the list */
    const iso_note *notes;         /* borrowed */
    int note_count;
    iso_inset *inset;       /* borrowed; NULL: none */
    bool dark;              /* the background is dark, so lines are drawn light */
    const iso_image *under; /* the picture, with its background where it shows nothing; borrowed; NULL: all */
    iso_rgb background;     /* stand at their usual places. With alpha, alpha 0 is background, too */
    iso_annotation_places *places; /* read if they are chosen, else set; borrowed; NULL: chosen anew */
} iso_annotation;

/* Whether annotations on this background are to be drawn light. */
bool iso_is_dark(iso_rgb background, bool transparent);

/* The size of the font in a picture: the given one, or, if it is 0, one by the picture's size. Pixels. */
double iso_annotation_font_size(double given, int width, int height);

/* Adds the marks of the annotations of a picture of width x height. ISO_ERR_NOMEM. */
iso_status iso_annotation_draw(iso_drawing *drawing, const iso_annotation *annotation, int width, int height,
                               iso_error *error);
/* Paints them onto the picture; what lies outside of it is cut off. ISO_ERR_NOMEM. */
iso_status iso_annotate(iso_image *image, const iso_annotation *annotation, iso_error *error);

/* The length of the scale bar in the world: 1, 2 or 5 times a power of ten, nearest to a fifth of the
 * picture's width. 0 for a perspective camera, whose pictures have no single scale. */
double iso_scale_bar_length(const iso_camera *camera, int width, int height);

/* A length of the world as a text: "10 mm", "50 \u00b5m" or, without a unit, "20", with so many digits. */
void iso_length_label(double length, int digits, const iso_length_style *style, char label[32]);

/* The pixel in which a place is seen, in pixels of a picture of width x height; it may lie outside. False: it
 * is behind the camera. */
bool iso_place_project(const iso_place *place, const iso_camera *camera, int width, int height,
                       double pixel[2]);

#endif
