/* aov: "arbitrary output variables" of a picture: depth, normal and coverage of every pixel as floats, for
 * comparisons and for compositing, and numbers (ids) of what a pixel shows, for picking and masks.
 *
 * Planes of width * height floats, row 0 at the top. Where a pixel has several samples, depth and normal are
 * the means over the covered samples, and coverage is their share of all samples. A picture of translucent
 * surfaces has depth and normal of the first one, alpha as coverage, and the number of layers. Ids cannot be
 * averaged: a pixel has those of its nearest sample. */
#ifndef ISO_IMAGE_AOV_H
#define ISO_IMAGE_AOV_H

#include "base/lines.h"
#include "base/status.h"
#include "isopoint.h"

enum { ISO_AOV_PLANES = 5 }; /* planes that every picture has: depth, normal x y z, coverage */

/* The planes of iso_aov.ids. */
enum { ISO_ID_SURFACE, ISO_ID_ELEMENT, ISO_ID_SEGMENT, ISO_ID_PLANES };

/* Allocates the planes, uninitialised; iso_aov_free when done. ISO_ERR_USAGE when a side is not in 1 ..
 * ISO_IMAGE_MAX, ISO_ERR_NOMEM. */
iso_status iso_aov_create(int width, int height, iso_aov *aov, iso_error *error);

/* Allocates the plane of the numbers of layers, uninitialised, unless it exists. ISO_ERR_NOMEM. */
iso_status iso_aov_add_layers(iso_aov *aov, iso_error *error);
/* Frees the plane of the numbers of layers, if it exists. */
void iso_aov_remove_layers(iso_aov *aov);

/* Allocates the planes of ids, uninitialised, unless they exist. ISO_ERR_NOMEM. */
iso_status iso_aov_add_ids(iso_aov *aov, iso_error *error);
/* Frees the planes of ids, if they exist. */
void iso_aov_remove_ids(iso_aov *aov);

/* Renderers write internal numbers of elements; the following functions convert them to the numbers that
 * files and users have. Each call converts the pixels of one surface (`surface` counts from 1), and does
 * nothing if the aov has no ids. */

/* For lines: replaces the number of a segment's first vertex by the numbers of its line and of the segment in
 * the line. */
void iso_aov_number_lines(iso_aov *aov, uint32_t surface, const iso_lines *lines);
/* For sets from which elements were left out: the i-th element that is drawn becomes numbers[i]; both count
 * from 0. */
void iso_aov_renumber(iso_aov *aov, uint32_t surface, const uint32_t *numbers);
/* For surfaces whose elements have no meaning for users: sets them to 0. */
void iso_aov_unnumber(iso_aov *aov, uint32_t surface);

#endif
