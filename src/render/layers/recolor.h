/* recolor: gives fragments the colours of surfaces whose colour differs from place to place. */
#ifndef ISO_RENDER_LAYERS_RECOLOR_H
#define ISO_RENDER_LAYERS_RECOLOR_H

#include "render/layers/layers.h"
#include "render/view/surface_colors.h"

/* All pointers are borrowed. */
typedef struct iso_layer_recolor {
    const iso_view *view;                    /* of the strip */
    const iso_surface_colors *const *colors; /* by surface number; NULL: its fragments stay as they are */
    int count;                               /* of surfaces; fragments of others stay as they are */
} iso_layer_recolor;

/* Colours and shades the fragments of a band. Those of surfaces with colours hold normals before
 * (iso_fragment.color). first: the strip's row that is the first of the band. */
void iso_layer_lists_recolor(iso_layer_lists *lists, const iso_layer_recolor *recolor, int first);

#endif
