/* reference: what is drawn beside the sculpture: the surface as it was when the session began or that of a
 * file, translucent (its x-ray), or lines and glyphs of files; all of it, or what lies in front of the
 * sculpture. Picks never find it.
 *
 * Its layers are listed once for each camera and kept (layer_store.h); a stroke blends them anew only where
 * it changed the picture. While the camera moves they are listed for fewer samples, or, where even that takes
 * too long, only the front ones. Pictures with four samples a pixel list them tile by tile and keep none. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_REFERENCE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_REFERENCE_H

#include "apps/isosculpt/viewport/viewport.h"
#include "render/shapes/shapes.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The most memory for kept layers, in bytes. */
enum { ISOSCULPT_REFERENCE_BYTES = 512 << 20 };

/* Takes over the grid, also after an error, and extracts its surface with so many threads (0: one for each
 * processor). ISO_ERR_NOMEM. */
iso_status isosculpt_reference_create(iso_hgrid *grid, int threads, isosculpt_reference **reference,
                                      iso_error *error);

/* Lines or glyphs with what is drawn of them. Zero-initialise. */
typedef struct isosculpt_reference_shapes {
    iso_lines lines;
    iso_glyphs glyphs;
    iso_shapes *shapes; /* borrows from one of them */
} isosculpt_reference_shapes;
void isosculpt_reference_shapes_free(isosculpt_reference_shapes *shapes);

/* Takes over `count` (at most ISOSCULPT_REFERENCE_SHAPES) sets, also after an error. ISO_ERR_NOMEM. */
enum { ISOSCULPT_REFERENCE_SHAPES = 32 };
iso_status isosculpt_reference_create_shapes(isosculpt_reference_shapes *sets, int count,
                                             isosculpt_reference **reference, iso_error *error);
void isosculpt_reference_destroy(isosculpt_reference *reference); /* NULL is fine */

/* The functions below are for the files of viewport/. When memory for layers is short they hide the reference
 * and set viewport->reference_error; the next drawing then shows the picture without it. */

/* Blends the reference over viewport->image, the whole picture with the samples in viewport->drawn. `moving`:
 * layers that were listed for fewer samples will do. */
void isosculpt_reference_blend_whole(isosculpt_viewport *viewport, bool moving);
/* The same for a part of that picture: viewport->tile_image, with the samples in viewport->tile. The layers
 * are those of the whole picture. */
void isosculpt_reference_blend_tile(isosculpt_viewport *viewport, isosculpt_rectangle part);
/* The same for an image of that part with factor x factor samples a pixel, viewport->tile's; lists layers for
 * this alone. The reference is shown. */
void isosculpt_reference_blend_fine(isosculpt_viewport *viewport, isosculpt_rectangle part, int factor,
                                    iso_image *image);

/* Whether the reference is shown, but was not listed for every pixel of the picture. */
bool isosculpt_reference_is_coarse(const isosculpt_viewport *viewport);

#ifdef __cplusplus
}
#endif
#endif
