/* near: shapes that are drawn one ray at a time in double precision: those that the near plane or the eye's
 * plane cuts, and those so large in the picture that floats are too coarse. Internal to shapes. */
#ifndef ISO_RENDER_SHAPES_NEAR_H
#define ISO_RENDER_SHAPES_NEAR_H

#include "render/shapes/frame.h"

typedef struct iso_near_shape {
    double centre[3], radius; /* view space */
    uint32_t id;
    double nearest; /* no visible sample is nearer */
} iso_near_shape;

struct iso_shapes_bin;

/* The shape of a sphere, with its `nearest`. */
iso_near_shape iso_near_sphere(const iso_shapes_frame *frame, const double centre[3], double radius,
                               uint32_t id);
/* Draws a shape that has just been added to bin->near into the bin. */
void iso_near_draw(struct iso_shapes_bin *bin, size_t index);
/* Writes the pixels that show one of the near shapes into the target's gbuffer. */
void iso_near_resolve(const struct iso_shapes_bin *bin);

#endif
