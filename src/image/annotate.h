/* annotate: a scale bar and an orientation marker, drawn over a finished picture.
 *
 * Both have an outline in the contrasting colour, so that they are legible on whatever is beneath. Their size
 * follows the picture's. Lines are sampled at 8 x 8 places a pixel and blended in integers: the same bytes on
 * every machine. */
#ifndef ISO_IMAGE_ANNOTATE_H
#define ISO_IMAGE_ANNOTATE_H

#include <stdbool.h>
#include <stdint.h>

#include "image/camera.h"
#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_annotation {
    const iso_camera *camera; /* that the picture was taken with; borrowed */
    bool scale_bar;           /* bottom right, with its length; of an orthographic camera only */
    bool orientation_marker;  /* bottom left: the world's axes as the camera sees them */
    bool anatomical;          /* the axes are L R, A P and H F (the world is LPS); else x y z */
    bool dark;                /* the background is dark: light lines */
} iso_annotation;

/* ISO_ERR_NOMEM. What does not fit into the picture is cut off. */
iso_status iso_annotate(iso_image *image, const iso_annotation *annotation, iso_error *error);

/* Length of the scale bar in mm: 1, 2 or 5 times a power of ten, nearest to a fifth of the picture's width. 0
 * for a perspective camera, whose pictures have no one scale. */
double iso_scale_bar_length(const iso_camera *camera, int width, int height);

/* Its label, such as "10 mm" or "50 um"; lengths as iso_scale_bar_length gives them. */
void iso_scale_bar_label(double length, char label[32]);

#ifdef __cplusplus
}
#endif
#endif
