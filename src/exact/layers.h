/* layers: translucent exact surfaces. Every crossing of the surfaces along a ray is found, in order of depth,
 * without sorting: the cells are visited front to back, and a pixel stays open until less than 1/512 of the
 * light is left (render/layers). Surfaces of different isovalues interleave rightly in every pixel.
 *
 * The layers are those that iso_shade_raycast_layers (truth/raycast_layers.h) finds in double precision:
 * pixels for which floats cannot decide are traced again (grids/ray). */
#ifndef ISO_EXACT_LAYERS_H
#define ISO_EXACT_LAYERS_H

#include "exact/exact.h"
#include "render/layers/bands.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A translucent surface. Its opacity is below 1: opaque surfaces are drawn into the strip's gbuffer before
 * (iso_draw_exact). */
typedef struct iso_exact_layer {
    const iso_exact *exact; /* up to date; borrowed for the call */
    iso_rgb color;
    iso_translucency translucency;
} iso_exact_layer;

/* Bytes that each thread takes for the fragments of a band, at most; a single row of pixels may take more. */
enum { ISO_EXACT_LAYERS_BYTES = 32 << 20 };

enum { ISO_EXACT_LAYERS_MAX = 64 }; /* surfaces in a picture */

/* Takes the fragments of a band of rows instead of having them composited. */
typedef struct iso_exact_layers_reader {
    /* Their colours are shaded ones, and no rays are set. Else their colours are the unit normals at the
     * crossings (view space, out of the solid). */
    bool shaded;
    /* Called once for each band by any worker. first: the band's first row of samples in the strip. */
    void (*read)(void *context, const iso_layer_lists *lists, const iso_layer_rays *rays, int first);
    void *context;
} iso_exact_layers_reader;

/* What is drawn, and into what; all pointers are borrowed for the call. */
typedef struct iso_exact_layers {
    const iso_exact_layer *layers; /* the picture's translucent surfaces */
    int count;                     /* 0 .. ISO_EXACT_LAYERS_MAX; 0: what the source lists is drawn alone */
    iso_layer_picture picture;
    const iso_exact_layers_reader *reader; /* NULL: the layers are composited; else of the picture only
                                              strip and pool are used */
    const iso_layer_source *source; /* lists what else is translucent in the picture; NULL: nothing. Its
                                       surfaces are numbered from `count` on, and their solids are clear */
    double middle;                  /* with no layers: a depth in the middle of what is drawn, mm */
} iso_exact_layers;

typedef struct iso_exact_layers_totals {
    iso_layer_totals layers;
    size_t retraced; /* samples that were traced again in double precision */
} iso_exact_layers_totals;

/* Draws and composites a strip. Adds to *totals. The picture gets the same bytes with every number of threads
 * and instruction set, and when drawn in strips of any height. ISO_ERR_NOMEM. */
iso_status iso_shade_exact_layers(const iso_exact_layers *input, iso_exact_layers_totals *totals,
                                  iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
