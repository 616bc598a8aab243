/* reference: the reference that is drawn together with the sculpture: a translucent surface (x-ray), which is
 * the sculpture's surface at the beginning of the session, that of a file or that of other labels, or lines
 * and glyphs of files. It is shown whole, or only where it lies in front of the sculpture. Picking ignores
 * it.
 *
 * Its layers are listed once for each camera and kept (layer_store.h); after a stroke they are blended again
 * only where the picture changed. While the camera moves they are listed for fewer samples or, if this takes
 * too long, only the front layers are. Pictures with four samples for each pixel list them tile by tile and
 * keep none. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_REFERENCE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_REFERENCE_H

#include "apps/isosculpt/viewport/viewport.h"
#include "scene/object_file.h"
#include "scene/segmentation.h"
#include "source/source.h"

/* Largest memory for kept layers, in bytes. */
enum { ISOSCULPT_REFERENCE_BYTES = 512 << 20 };

/* Takes over the grid, also after an error, and extracts its surface with so many threads (0: one for each
 * processor). ISO_ERR_NOMEM. */
iso_status isosculpt_reference_create(iso_hgrid *grid, int threads, isosculpt_reference **reference,
                                      iso_error *error);

/* Labels with one surface, group 1, each in its colour: allocated by calloc, as its parts borrow from it. */
typedef struct isosculpt_reference_labels {
    iso_segmentation segmentation;
    char path[ISO_SOURCE_PATH], reading[ISO_JOURNAL_TEXT];
    iso_pool *pool; /* owned; that of the segmentation */
} isosculpt_reference_labels;
void isosculpt_reference_labels_free(isosculpt_reference_labels *labels); /* NULL is fine */
/* Takes over the labels, also after an error, and extracts their surface. ISO_ERR_NOMEM. */
iso_status isosculpt_reference_create_labels(isosculpt_reference_labels *labels, int threads,
                                             isosculpt_reference **reference, iso_error *error);

/* Lines or glyphs of a file, and the shapes made of them. Zero-initialise. */
typedef struct isosculpt_reference_shapes {
    iso_object_file file;
    iso_shapes *shapes; /* borrows from it */
} isosculpt_reference_shapes;
void isosculpt_reference_shapes_free(isosculpt_reference_shapes *shapes);

/* Takes over `count` (at most ISOSCULPT_REFERENCE_SHAPES) sets, also after an error. ISO_ERR_NOMEM. */
enum { ISOSCULPT_REFERENCE_SHAPES = 32 };
iso_status isosculpt_reference_create_shapes(isosculpt_reference_shapes *sets, int count,
                                             isosculpt_reference **reference, iso_error *error);
void isosculpt_reference_destroy(isosculpt_reference *reference); /* NULL is fine */

/* The functions below are for the files of viewport/. If there is not enough memory for layers, they hide the
 * reference and set viewport->reference_error; the next picture is then drawn without it. */

/* Blends the reference over viewport->image, the whole picture with the samples in viewport->drawn. `moving`:
 * layers listed for fewer samples are good enough. */
void isosculpt_reference_blend_whole(isosculpt_viewport *viewport, bool moving);
/* The same for a part of that picture: viewport->tile_image, with the samples in viewport->tile. The layers
 * are those of the whole picture. */
void isosculpt_reference_blend_tile(isosculpt_viewport *viewport, isosculpt_rectangle part);
/* Blends the reference over an image of that part with factor x factor samples for each pixel,
 * viewport->tile's. The layers are listed for this call only. The reference must be shown. */
void isosculpt_reference_blend_fine(isosculpt_viewport *viewport, isosculpt_rectangle part, int factor,
                                    iso_image *image);

/* Returns whether the reference is shown, but was listed for fewer samples than the picture has pixels. */
bool isosculpt_reference_is_coarse(const isosculpt_viewport *viewport);

#endif
