/* masked: shows which voxels no brush changes. For the files of viewport/ only. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_MASKED_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_MASKED_H

#include "apps/isosculpt/viewport/viewport.h"

/* Darkens the pixels of a shaded strip that show masked voxels. The viewport has a mask; `image` has the
 * strip's rows only. */
void isosculpt_darken_masked(const isosculpt_viewport *viewport, const iso_strip *strip, iso_image *image);

#endif
