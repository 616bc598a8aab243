/* bands: distributes the rows of a strip over threads, in bands whose fragments fit into memory. Internal to
 * the renderers that list layers. */
#ifndef ISO_RENDER_LAYERS_BANDS_H
#define ISO_RENDER_LAYERS_BANDS_H

#include "render/layers/compose.h"
#include "render/view/project.h"

/* How the bands of a strip are drawn. */
typedef struct iso_layer_bands {
    const iso_strip *strip;
    int rows;       /* of samples in a band: a multiple of strip->factor */
    iso_pool *pool; /* NULL: the calling thread */
    /* Lists the fragments of the rows `rows`, which lie in band number `band`. least: they are a single row
     * of pixels, which cannot be divided. Returns false if there is not enough memory for them. */
    bool (*list)(void *context, int worker, size_t band, iso_rows rows, bool least);
    /* Uses the listed fragments, for example composites them. */
    void (*use)(void *context, int worker, iso_rows rows);
    void *context; /* passed to both functions, which any worker may call */
} iso_layer_bands;

/* Lists fragments of other objects in the same picture as the surfaces of a renderer. Any worker of the pool
 * may call the functions. */
typedef struct iso_layer_source {
    /* Adds the fragments of the rows `rows` of the strip to the lists of their band, whose limit and middle
     * are set. Returns false if there is not enough memory. */
    bool (*list)(void *context, int worker, iso_layer_lists *lists, iso_rows rows);
    /* Counts the fragments that the worker listed last, because they will be composited. */
    void (*count)(void *context, int worker);
    void *context;
} iso_layer_source;

/* Returns the number of rows of a band: about `wanted`, and a multiple of the strip's factor. */
int iso_layer_band_rows(const iso_strip *strip, int wanted);

/* Lists and uses every band. Bands that do not fit into memory are halved, repeatedly if necessary.
 * ISO_ERR_NOMEM: a single row of pixels does not fit. */
iso_status iso_layer_bands_draw(const iso_layer_bands *bands, iso_error *error);

#endif
