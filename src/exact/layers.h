/* layers: translucent exact surfaces. All crossings of the surfaces along a ray are found in order of depth,
 * without sorting: the cells are visited front to back, and a pixel stays free until less than 1/512 of the
 * light passes the layers so far (render/layers). Surfaces of different isovalues are interleaved correctly
 * in every pixel.
 *
 * The layers are those that iso_shade_raycast_layers (truth/raycast_layers.h) finds in double precision:
 * samples for which floats cannot decide are traced again (grids/ray). */
#ifndef ISO_EXACT_LAYERS_H
#define ISO_EXACT_LAYERS_H

#include "exact/exact.h"
#include "render/layers/bands.h"
#include "render/view/surface_colors.h"

/* A translucent surface, with an opacity below 1. Opaque surfaces are drawn into the strip's gbuffer
 * beforehand (iso_draw_exact). */
typedef struct iso_exact_layer {
    const iso_exact *exact; /* up to date; borrowed for the call */
    iso_rgb color;
    iso_translucency translucency;
    const iso_clip *clip; /* what is cut away of it; NULL: nothing; borrowed for the call */
    /* Used instead of `color` but for what its solid absorbs; NULL: `color`; borrowed for the call. Of
     * readers' fragments only those of shaded ones have them. */
    const iso_surface_colors *colors;
} iso_exact_layer;

/* Largest number of bytes that each thread uses for the fragments of a band; a single row of pixels may use
 * more. */
enum { ISO_EXACT_LAYERS_BYTES = 32 << 20 };

enum { ISO_EXACT_LAYERS_MAX = 64 }; /* largest number of surfaces in a picture */

/* Receives the fragments of a band of rows; they are then not composited. */
typedef struct iso_exact_layers_reader {
    /* The fragments have shaded colours, and no rays are set. If false, their colours are the unit normals at
     * the crossings (view space, out of the solid). */
    bool shaded;
    /* Called once for each band, by any worker. first: the band's first row of samples in the strip. */
    void (*read)(void *context, const iso_layer_lists *lists, const iso_layer_rays *rays, int first);
    void *context;
} iso_exact_layers_reader;

/* The surfaces to draw and the picture to draw them into; all pointers are borrowed for the call. */
typedef struct iso_exact_layers {
    const iso_exact_layer *layers; /* the picture's translucent surfaces */
    int count;                     /* 0 .. ISO_EXACT_LAYERS_MAX; with 0 only the source's layers are drawn */
    iso_layer_picture picture;
    const iso_exact_layers_reader *reader; /* NULL: the layers are composited; else they are passed to the
                                              reader, and of the picture only strip and pool are used */
    const iso_layer_source *source; /* lists further translucent objects in the picture; NULL: none. Their
                                       surfaces are numbered from `count` on, and their solids are clear */
    double middle;                  /* if count is 0: a depth in the middle of the picture's objects, mm */
} iso_exact_layers;

typedef struct iso_exact_layers_totals {
    iso_layer_totals layers;
    size_t retraced; /* samples that were traced again in double precision */
} iso_exact_layers_totals;

/* Draws and composites a strip. Adds to *totals. The picture gets the same bytes with every number of threads
 * and instruction set, and when drawn in strips of any height. ISO_ERR_NOMEM. */
iso_status iso_shade_exact_layers(const iso_exact_layers *input, iso_exact_layers_totals *totals,
                                  iso_error *error);

#endif
