/* label_colors: the colours of a surface that several labels share: each sample of a picture has that of the
 * label at its place. */
#ifndef ISO_SCENE_LABEL_COLORS_H
#define ISO_SCENE_LABEL_COLORS_H

#include "base/parallel.h"
#include "grids/labels/label_fields.h"
#include "image/image.h"
#include "render/view/gbuffer.h"
#include "render/view/surface_colors.h"

/* All pointers are borrowed. */
typedef struct iso_label_colors {
    iso_label_fields *fields; /* pictures have their labels told apart where these are seen */
    const iso_label *labels;  /* of the volume that the fields were made of: iso_labels.label */
    int group;                /* the one whose level set is the surface */
    const iso_rgb *colors;    /* of each label, by its place in `labels` */
} iso_label_colors;

/* Gives the samples of a gbuffer that show a surface its labels' colours, and their values as elements if the
 * gbuffer has elements. The same bytes with every number of threads. One picture at a time. `pool` may be
 * NULL. ISO_ERR_NOMEM. */
iso_status iso_label_colors_paint(const iso_label_colors *colors, int surface, const iso_view *view,
                                  iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error);

/* The colours of the surface's places, for its layers; its fields are made with ISO_LABELS_APART. */
typedef struct iso_label_painter {
    const iso_label_colors *colors; /* borrowed */
    iso_affine affine;              /* of the level set */
} iso_label_painter;
iso_label_painter iso_label_painter_make(const iso_label_colors *colors);
/* Borrows the painter. */
iso_surface_colors iso_label_painter_colors(const iso_label_painter *painter);

#endif
