/* refined_setup: what the refined reconstruction needs to know of a view, the same for every engine. Internal
 * to render. */
#ifndef ISO_RENDER_REFINED_SETUP_H
#define ISO_RENDER_REFINED_SETUP_H

#include "render/point_blocks.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Seen aslant, balls are longer than wide: by how much at most in the picture and `beyond` pixels around it,
 * and a little for rounding. */
float iso_refined_slant(const iso_view *view, double beyond);

/* The largest radius of a block's discs in pixels. */
float iso_refined_reach(const iso_point_block *block);

/* Voxels in a mm, at most, of an iso_projector's normal. */
float iso_refined_per_mm(const float normal[9]);

#ifdef __cplusplus
}
#endif
#endif
