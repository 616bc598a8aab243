/* layer_lists: how the layers of one surface of points get into the lists of a band. Internal to splats. */
#ifndef ISO_RENDER_SPLATS_LAYER_LISTS_H
#define ISO_RENDER_SPLATS_LAYER_LISTS_H

#include "render/layers/opacity.h"
#include "render/splats/layers.h"
#include "render/splats/slots.h"

/* A surface while a strip is drawn. */
typedef struct iso_splat_surface {
    const iso_splat_layer *input;
    int number;
    iso_discs discs; /* sorted: front to back */
    iso_discs wide;  /* groups and nearest: discs that cover the surface with each group; back to front */
    iso_layer_opacity opacity;
    float bin; /* mm: width of the bins of depth */
} iso_splat_surface;

/* The rows of a band, and a worker's memory. */
typedef struct iso_splat_band {
    size_t number; /* of the band */
    iso_rows rows; /* of the band or a part of it */
    int width;     /* samples */
    iso_layer_lists *lists;
    iso_buffer *memory, *starts; /* of the worker; contents are left over from the last call */
    bool last;                   /* the rows cannot be divided any more */
} iso_splat_band;

/* Lists the layers of a surface; its pass has begun. False: out of memory, or lists->full. */
bool iso_splats_list_sorted(const iso_splat_surface *surface, const iso_splat_band *band);
/* Lists one layer for algorithm 2, or two for algorithm 3. False as above. */
bool iso_splats_list_images(const iso_splat_surface *surface, const iso_splat_band *band, bool nearest);

/* A fragment with the normal, depth and colour (NULL: the surface's) of a layer. x, y: the sample's centre
 * in pixels from the optical axis. */
iso_fragment iso_splat_fragment(const iso_splat_surface *surface, const float normal[3], float depth,
                                const uint8_t *rgb, float x, float y);
/* The same for a layer of averaged discs. */
iso_fragment iso_splat_mean_fragment(const iso_splat_surface *surface, const iso_splat_sums *sums, float x,
                                     float y);

#endif
