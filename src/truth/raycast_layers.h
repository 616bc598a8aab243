/* raycast_layers: translucent surfaces by ray casting: the truth for src/exact/layers.h. Every crossing of
 * each ray is found and composited in double precision. */
#ifndef ISO_TRUTH_RAYCAST_LAYERS_H
#define ISO_TRUTH_RAYCAST_LAYERS_H

#include "render/layers/compose.h"
#include "render/view/surface_colors.h"
#include "truth/raycast.h"

/* A translucent surface, with an opacity below 1. */
typedef struct iso_raycast_layer {
    const iso_raycaster *caster; /* borrowed for the call */
    iso_rgb color;
    iso_translucency translucency;
    const iso_clip *clip; /* what is cut away of it; NULL: nothing; borrowed */
    /* Used instead of `color` but for what its solid absorbs; NULL: `color`; borrowed. */
    const iso_surface_colors *colors;
} iso_raycast_layer;

enum { ISO_RAYCAST_LAYERS_MAX = 64 }; /* largest number of surfaces in a picture */

/* The surfaces to draw and the picture to draw them into; all pointers are borrowed for the call. */
typedef struct iso_raycast_layers {
    const iso_raycast_layer *layers;
    int count; /* 1 .. ISO_RAYCAST_LAYERS_MAX */
    iso_layer_picture picture;
} iso_raycast_layers;

/* Draws and composites a strip. Adds to *totals. Cannot fail. */
void iso_shade_raycast_layers(const iso_raycast_layers *input, iso_layer_totals *totals);

/* A crossing of a sample's ray. */
typedef struct iso_raycast_crossing {
    double depth;   /* mm */
    double opacity; /* 0 .. 1 */
    float rgb[3];   /* shaded, 0 .. 1 */
} iso_raycast_crossing;

/* A callback that receives all crossings of a picture. */
typedef struct iso_raycast_reader {
    /* Called for every crossing by any worker, front to back for each sample. x, y: the sample in the strip.
     */
    void (*read)(void *context, int x, int y, const iso_raycast_crossing *crossing);
    void *context;
} iso_raycast_reader;

/* Passes all crossings of a strip to a reader, including those that are completely hidden by nearer layers.
 * Of the picture only the strip and the pool are used. Cannot fail. */
void iso_read_raycast_layers(const iso_raycast_layers *input, const iso_raycast_reader *reader);

#endif
