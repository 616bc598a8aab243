/* splats_reference: points as flat discs drawn plainly, in double precision: what render/groups must agree
 * with. */
#ifndef ISO_TESTS_SPLATS_REFERENCE_H
#define ISO_TESTS_SPLATS_REFERENCE_H

#include "image/image.h"
#include "render/groups/disc_layers.h"
#include "render/groups/groups.h"
#include "render/view/gbuffer.h"

/* Draws the points of a view into a cleared gbuffer in two passes: the first finds the nearest disc of each
 * pixel, the second averages the discs of its layer, as iso_draw_groups defines both. */
void test_draw_two_passes(const iso_view *view, const iso_point_view *points, iso_gbuffer *gbuffer);

/* Draws the points of a view as one translucent surface over a background: in each pixel the discs are
 * sorted and merged into layers as render/groups/disc_layers.h defines them, and all layers are composited.
 * Points with colours are not supported. */
void test_draw_sorted_layers(const iso_view *view, const iso_splat_layer *layer, iso_rgb background,
                             iso_image *image);

#endif
