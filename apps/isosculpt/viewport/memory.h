/* memory: memory for samples and pixels that grows with the picture and is reused. For the files of viewport/
 * only. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_MEMORY_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_MEMORY_H

#include "scene/method.h"

/* Makes a gbuffer width x height samples large; its contents are undefined afterwards if it had to grow.
 * ISO_ERR_NOMEM leaves it as it was. */
iso_status isosculpt_reserve_samples(iso_gbuffer *gbuffer, int width, int height, iso_error *error);

/* The same for an image, for which *room pixels are allocated. */
iso_status isosculpt_reserve_pixels(iso_image *image, size_t *room, int width, int height, iso_error *error);

#endif
