/* layer_store: the layers of a surface behind every sample of a picture, or what the sample shows of lines
 * and glyphs, kept so that they can be blended over pictures of another surface again and again, at any
 * opacity, in full or only in front of that surface. Listing the layers takes as long as drawing a
 * translucent picture; blending them a few nanoseconds each. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_LAYER_STORE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_LAYER_STORE_H

#include "exact/exact.h"
#include "render/gbuffer.h"
#include "render/shapes/shapes.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A layer behind a sample: 12 bytes. */
typedef struct isosculpt_stored_layer {
    float depth;       /* view z, mm */
    uint16_t color[3]; /* shaded, in 65535ths */
    uint16_t slant; /* at which angle it is seen: index into isosculpt_slant_opacities; or ISOSCULPT_SOLID */
} isosculpt_stored_layer;
enum { ISOSCULPT_SOLID = UINT16_MAX }; /* the slant of lines and glyphs, which are opaque */

/* The layers of a row of samples, in one block. */
typedef struct isosculpt_layer_row {
    uint32_t *ends; /* by sample: number of the first layer that is not its own */
    isosculpt_stored_layer *layers;
} isosculpt_layer_row;

/* Zero-initialise; isosculpt_layer_store_free when done. */
typedef struct isosculpt_layer_store {
    int width, height;         /* samples; 0: nothing is stored */
    isosculpt_layer_row *rows; /* room for row_room of them */
    int row_room;
    size_t bytes;      /* of all rows */
    size_t most_bytes; /* more are not stored; set by the owner */
    bool full;         /* memory, or most_bytes, did not suffice */
} isosculpt_layer_store;

/* Lists the layers of the surface in a view. Those behind 60 or more others are left out. Other layers are
 * freed before. `exact` is up to date. ISO_ERR_NOMEM: out of memory, or more than most_bytes; then nothing is
 * stored. */
iso_status isosculpt_layer_store_list(isosculpt_layer_store *store, const iso_exact *exact, iso_rgb color,
                                      const iso_view *view, iso_pool *pool, iso_error *error);
/* The same for the layer in front only, which takes a fraction of the time: cells behind others are skipped.
 */
iso_status isosculpt_layer_store_list_front(isosculpt_layer_store *store, const iso_exact *exact,
                                            iso_rgb color, const iso_view *view, iso_pool *pool,
                                            iso_error *error);
/* The same for what samples show of `count` (at most 255) sets of lines and glyphs. `color`: of those that
 * have none of their own. */
iso_status isosculpt_layer_store_list_shapes(isosculpt_layer_store *store, const iso_shapes *const *sets,
                                             int count, iso_rgb color, const iso_view *view, iso_pool *pool,
                                             iso_error *error);
void isosculpt_layer_store_free(isosculpt_layer_store *store);

/* The opacity of a layer by its slant, for a surface with an opacity of 0 .. 1 where it is seen face on; by
 * angle, as iso_translucency.opacity. */
enum { ISOSCULPT_SLANTS = 4096 };
typedef struct isosculpt_slant_opacities {
    float face_on; /* the opacity that the table is made for; 0: none yet */
    float opacity[ISOSCULPT_SLANTS];
} isosculpt_slant_opacities;
void isosculpt_slant_opacities_set(isosculpt_slant_opacities *opacities, double face_on);

/* How layers are blended over a picture, or over a part of it. All pointers are borrowed for the call. */
typedef struct isosculpt_layer_blend {
    const isosculpt_layer_store *store;
    const isosculpt_slant_opacities *opacities;
    int width, height; /* of the whole picture; the store may have fewer samples */
    int x0, y0;        /* where the image's first pixel lies in it */
    /* The samples of the surface in the image, which is `behind` mm nearer for this: layers behind it are
     * hidden or, with `through`, blended as well: solids as if they were a surface that is seen face on. */
    const iso_gbuffer *surface;
    float behind;
    bool through;
    iso_image *image; /* of the size of `surface` */
    iso_pool *pool;
} isosculpt_layer_blend;
void isosculpt_layer_store_blend(const isosculpt_layer_blend *blend);

#ifdef __cplusplus
}
#endif

#endif
