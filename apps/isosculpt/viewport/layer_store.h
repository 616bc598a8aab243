/* layer_store: the layers of a surface behind every sample of a picture, or what the sample shows of lines
 * and glyphs, kept so that they can be blended over pictures of another surface again and again, at any
 * opacity, in full or only in front of that surface. Listing the layers takes as long as drawing a
 * translucent picture; blending them a few nanoseconds each. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_LAYER_STORE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_LAYER_STORE_H

#include "scene/label_colors.h"
#include "scene/layered_picture.h"

/* A layer behind a sample, in 12 bytes. */
typedef struct isosculpt_stored_layer {
    float depth;       /* view z, mm */
    uint16_t color[3]; /* shaded, in 65535ths */
    uint16_t slant;    /* index into isosculpt_slant_opacities, for the angle at which the layer is seen; or
                       ISOSCULPT_SOLID */
} isosculpt_stored_layer;
enum { ISOSCULPT_SOLID = UINT16_MAX }; /* the slant of lines and glyphs, which are opaque */

/* The layers of a row of samples, in one block. */
typedef struct isosculpt_layer_row {
    uint32_t *ends; /* for each sample: number of the first layer of the next sample */
    isosculpt_stored_layer *layers;
} isosculpt_layer_row;

/* Zero-initialise; isosculpt_layer_store_free when done. */
typedef struct isosculpt_layer_store {
    int width, height;         /* samples; 0: nothing is stored */
    isosculpt_layer_row *rows; /* room for row_room of them */
    int row_room;
    size_t bytes;      /* of all rows */
    size_t most_bytes; /* limit of `bytes`, set by the owner */
    bool full;         /* layers were left out: there was no memory, or most_bytes was reached */
} isosculpt_layer_store;

/* A surface; all is borrowed. */
typedef struct isosculpt_layer_surface {
    const iso_exact *exact; /* up to date */
    iso_rgb color;
    const iso_label_painter *labels; /* which have colours of their own; NULL: it has `color` */
} isosculpt_layer_surface;

/* Lists the layers of the surface in a view, except those behind 60 or more others. Old layers are freed
 * first. ISO_ERR_NOMEM: out of memory, or more than most_bytes; nothing is stored then. */
iso_status isosculpt_layer_store_list(isosculpt_layer_store *store, const isosculpt_layer_surface *surface,
                                      const iso_view *view, iso_pool *pool, iso_error *error);
/* Lists only the front layer of the surface. This takes a fraction of the time, because cells behind others
 * are skipped. */
iso_status isosculpt_layer_store_list_front(isosculpt_layer_store *store,
                                            const isosculpt_layer_surface *surface, const iso_view *view,
                                            iso_pool *pool, iso_error *error);
/* Lists the front-most shapes of `count` (at most 255) sets of lines and glyphs. `color`: for shapes without
 * colours of their own. */
iso_status isosculpt_layer_store_list_shapes(isosculpt_layer_store *store, const iso_shapes *const *sets,
                                             int count, iso_rgb color, const iso_view *view, iso_pool *pool,
                                             iso_error *error);
void isosculpt_layer_store_free(isosculpt_layer_store *store);

/* The opacity for each slant, for a surface whose opacity is face_on where it is seen face on; it depends on
 * the angle as iso_translucency.opacity does. */
enum { ISOSCULPT_SLANTS = 4096 };
typedef struct isosculpt_slant_opacities {
    float face_on; /* the opacity that the table is made for; 0: none yet */
    float opacity[ISOSCULPT_SLANTS];
} isosculpt_slant_opacities;
void isosculpt_slant_opacities_set(isosculpt_slant_opacities *opacities, double face_on);

/* How stored layers are blended over a picture, or over a part of it. All pointers are borrowed for the
 * call. */
typedef struct isosculpt_layer_blend {
    const isosculpt_layer_store *store;
    const isosculpt_slant_opacities *opacities;
    int width, height; /* of the whole picture; the store may have fewer samples */
    int x0, y0;        /* position of the image's first pixel in the picture */
    /* The samples of the surface in the image. A layer counts as behind the surface if it is behind it after
     * the surface was moved `behind` mm towards the eye. Layers behind the surface are hidden; with `through`
     * they are blended, too, and solids are then blended like a surface that is seen face on. */
    const iso_gbuffer *surface;
    float behind;
    bool through;
    iso_image *image; /* of the size of `surface` */
    iso_pool *pool;
} isosculpt_layer_blend;
void isosculpt_layer_store_blend(const isosculpt_layer_blend *blend);

#endif
