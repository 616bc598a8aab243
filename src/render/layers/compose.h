/* compose: composites lists of fragments, front to back, over opaque surfaces and the background. */
#ifndef ISO_RENDER_LAYERS_COMPOSE_H
#define ISO_RENDER_LAYERS_COMPOSE_H

#include "render/layers/layers.h"
#include "render/shading/shading.h"
#include "render/strip.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The part of each ray that lies in the volume, for solids that absorb light: arrays by sample of the band.
 */
typedef struct iso_layer_rays {
    float *begin, *end; /* depths counted from iso_layer_lists.middle, mm; end < begin: outside */
    float *length;      /* mm along the ray per mm of depth */
    uint64_t *inside;   /* bit by surface number, below 64: the ray begins in the surface's solid */
} iso_layer_rays;

/* A solid that absorbs light (iso_translucency.mean_path). */
typedef struct iso_layer_medium {
    float per_mm;   /* 1 / mean_path; 0: clear */
    float color[3]; /* 0 .. 1 */
} iso_layer_medium;

/* What a band of lists is composited into. All pointers are borrowed. */
typedef struct iso_layer_picture {
    const iso_strip *strip;     /* its gbuffer has the opaque surfaces, or but its size: depth is NULL */
    const iso_shading *shading; /* of the opaque surfaces, by number, and the background */
    iso_image *image;
    const iso_layer_medium *media; /* by surface number; NULL: all solids are clear */
    int media_count;               /* at most 64 */
    float *layers;   /* NULL, or a plane of the image's size for the mean number of layers of a pixel */
    float *coverage; /* NULL, or a plane for its alpha */
} iso_layer_picture;

/* Counts of a picture. */
typedef struct iso_layer_totals {
    size_t covered; /* samples that show a surface */
    size_t layers;  /* fragments that were composited, of all samples */
    int most;       /* of one sample */
} iso_layer_totals;

/* The working memory of a worker. Zero-initialise, iso_layer_composer_free when done. */
typedef struct iso_layer_composer {
    float *lines;       /* rows of floats, one for each of several quantities */
    size_t line_floats; /* floats of one row */
} iso_layer_composer;

/* Makes room for a picture of `width` pixels with factor * factor samples each. ISO_ERR_NOMEM. */
iso_status iso_layer_composer_reserve(iso_layer_composer *composer, int width, int factor, iso_error *error);
void iso_layer_composer_free(iso_layer_composer *composer);

/* Composites a band into the image: the lists' rows are the strip's rows of samples from `first` on, a
 * multiple of strip->factor. rays: needed with media. Adds to *totals. The result has the same bytes for
 * every instruction set. */
void iso_layers_compose(const iso_layer_picture *picture, const iso_layer_lists *lists,
                        const iso_layer_rays *rays, int first, iso_layer_composer *composer,
                        iso_layer_totals *totals);

#ifdef __cplusplus
}
#endif
#endif
