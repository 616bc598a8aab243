/* compose: composites lists of fragments, front to back, over opaque surfaces and the background. */
#ifndef ISO_RENDER_LAYERS_COMPOSE_H
#define ISO_RENDER_LAYERS_COMPOSE_H

#include "render/layers/layers.h"
#include "render/shading/shading.h"
#include "render/view/strip.h"

/* The part of each ray that lies in the volume, for solids that absorb light: arrays indexed by the sample in
 * the band. */
typedef struct iso_layer_rays {
    float *begin, *end; /* depths counted from iso_layer_lists.middle, mm; end < begin: outside */
    float *length;      /* mm along the ray for 1 mm of depth */
    uint64_t *inside;   /* bit by surface number, below 64: the ray begins in the surface's solid */
} iso_layer_rays;

/* A solid that absorbs light (iso_translucency.absorption_length). */
typedef struct iso_layer_medium {
    float per_mm;   /* 1 / absorption_length; 0: clear */
    float color[3]; /* 0 .. 1 */
} iso_layer_medium;

/* The solids of a picture that absorb light. All pointers are borrowed. */
typedef struct iso_layer_media {
    const iso_layer_medium *solids; /* by surface number */
    int count;                      /* at most 64 */
    const iso_layer_rays *rays;     /* of the band */
} iso_layer_media;

/* The picture that layers are composited into, for every renderer. All pointers are borrowed. */
typedef struct iso_layer_picture {
    const iso_strip *strip;     /* its gbuffer has the opaque surfaces, or only the size (depth is NULL) */
    const iso_shading *shading; /* of the opaque surfaces, by number, and the background */
    iso_image *image;           /* receives the strip's rows */
    float *layer_counts; /* NULL, or a plane of the image's size for the mean number of layers of a pixel */
    float *coverage;     /* NULL, or a plane of the image's size for the alpha of each pixel */
    iso_pool *pool;      /* NULL: the calling thread */
} iso_layer_picture;

/* Statistics of a picture. */
typedef struct iso_layer_totals {
    size_t covered; /* samples that show a surface */
    size_t layers;  /* fragments that were composited, in all samples */
    int most;       /* largest number of fragments in a sample */
} iso_layer_totals;

void iso_layer_totals_add(iso_layer_totals *totals, const iso_layer_totals *more);

/* The working memory of a worker. Zero-initialise, iso_layer_composer_free when done. */
typedef struct iso_layer_composer {
    float *lines;       /* rows of floats, one for each of several quantities */
    size_t line_floats; /* floats of one row */
} iso_layer_composer;

/* Makes room for a picture of `width` pixels with factor * factor samples each. ISO_ERR_NOMEM. */
iso_status iso_layer_composer_reserve(iso_layer_composer *composer, int width, int factor, iso_error *error);
void iso_layer_composer_free(iso_layer_composer *composer);

/* A row of composited samples, as planes of the picture's width in samples with room for ISO_LANES_MAX (16)
 * more. */
typedef struct iso_layer_line {
    float *color[3]; /* sum of the layers' contributions, 0 .. 1 */
    float *through;  /* share of the light that passes all layers */
    float *layers;   /* number of layers composited */
} iso_layer_line;

/* Composites the layers of row `row` of a band into a line, and counts them in *totals. */
typedef void iso_layer_row_fn(const void *context, int row, const iso_layer_line *line,
                              iso_layer_totals *totals);

/* Writes a band of `rows` rows of samples into the image, whose layers `compose` composites: adds what is
 * behind them, and averages samples into pixels. The first row is the strip's row `first`; both numbers are
 * multiples of strip->factor. Adds to *totals. The bytes are the same for every instruction set. */
void iso_layers_finish(const iso_layer_picture *picture, int first, int rows, iso_layer_row_fn *compose,
                       const void *context, iso_layer_composer *composer, iso_layer_totals *totals);

/* Composites a band into the image. The lists' rows are the strip's rows of samples from `first` on, which is
 * a multiple of strip->factor. media: the absorbing solids; NULL: all solids are clear. Adds to *totals. The
 * bytes are the same for every instruction set. */
void iso_layers_compose(const iso_layer_picture *picture, const iso_layer_lists *lists,
                        const iso_layer_media *media, int first, iso_layer_composer *composer,
                        iso_layer_totals *totals);

#endif
