/* compose_kernel: the kernel that composites rows of samples. Internal to layers. */
#ifndef ISO_RENDER_LAYERS_COMPOSE_KERNEL_H
#define ISO_RENDER_LAYERS_COMPOSE_KERNEL_H

#include "base/cpu.h"
#include "render/layers/compose.h"

/* The opaque surfaces and the background behind the layers of a row. */
typedef struct iso_layer_back {
    const float *normal[3];     /* of the opaque surfaces, by sample */
    const uint8_t *surface;     /* their numbers; NULL: there are no opaque surfaces */
    const uint32_t *own_color;  /* iso_gbuffer.color; NULL: no sample has a colour of its own */
    const float *ambient, *key; /* of the gbuffer; NULL: all light reaches the samples */
    const float *color[3];      /* of surfaces, by number: 256 each */
    const float *u;         /* the rays are (u, v, 1): u by column; ISO_LANES_MAX more items are readable */
    float v, background[3]; /* 0 .. 1 */
    bool transparent;       /* the background is transparent */
} iso_layer_back;

typedef struct iso_layer_kernel {
    /* Composites the fragments of row `row` of the lists, and counts them in *totals. */
    void (*compose)(const iso_layer_lists *lists, int row, const iso_layer_line *line,
                    iso_layer_totals *totals);
    /* Adds the surfaces and the background behind the layers, so that `through` becomes the share of a
     * transparent background. Returns the number of samples that show a surface. */
    size_t (*add_back)(const iso_layer_back *back, int width, const iso_layer_line *line);
    /* Writes RGBA pixels from premultiplied colours and transmittances. */
    void (*write)(const float *const color[3], const float *through, bool transparent, int width,
                  int32_t *words);
} iso_layer_kernel;

ISO_KERNEL_UNITS(const iso_layer_kernel, iso_layer_kernel);

/* Like iso_layer_kernel.compose, but with solids that absorb light, and sample by sample. */
void iso_layers_absorb(const iso_layer_media *media, const iso_layer_lists *lists, int row,
                       const iso_layer_line *line, iso_layer_totals *totals);

#endif
