/* bands: deals the rows of a strip to threads, in bands whose fragments fit into memory. Internal to the
 * renderers that list layers. */
#ifndef ISO_RENDER_LAYERS_BANDS_H
#define ISO_RENDER_LAYERS_BANDS_H

#include "render/layers/compose.h"
#include "render/project.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How the bands of a strip are drawn. */
typedef struct iso_layer_bands {
    const iso_strip *strip;
    int rows;       /* of samples in a band: a multiple of strip->factor */
    iso_pool *pool; /* NULL: the calling thread */
    /* Lists the fragments of the rows `rows`, which lie in band number `band`. least: they are a single row
     * of pixels, which cannot be cut. Returns false when memory has no room for them. */
    bool (*list)(void *context, int worker, size_t band, iso_rows rows, bool least);
    /* Composites, or otherwise uses, what was listed. */
    void (*use)(void *context, int worker, iso_rows rows);
    void *context; /* of both; they are called by any worker */
} iso_layer_bands;

/* Lists fragments of what is in the same picture as the surfaces of a renderer: the functions are called by
 * any worker of its pool. */
typedef struct iso_layer_source {
    /* Adds the fragments of the rows `rows` of the strip to the lists of their band. The lists' limit and
     * middle are set. Returns false when memory has no room for them. */
    bool (*list)(void *context, int worker, iso_layer_lists *lists, iso_rows rows);
    /* Counts what the worker has listed last: the lists will be composited. */
    void (*count)(void *context, int worker);
    void *context;
} iso_layer_source;

/* The rows of a band: about `wanted`, and a multiple of the strip's factor. */
int iso_layer_band_rows(const iso_strip *strip, int wanted);

/* Lists and uses every band; those that have no room, in two halves, and these if need be. ISO_ERR_NOMEM:
 * there is no room for a single row of pixels. */
iso_status iso_layer_bands_draw(const iso_layer_bands *bands, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
