/* prepare: what the preparation of glyphs and of lines shares. Internal to shapes. */
#ifndef ISO_RENDER_SHAPES_PREPARE_H
#define ISO_RENDER_SHAPES_PREPARE_H

#include "render/shapes/set.h"
#include "render/shapes/sort.h"

/* An empty set with the options and the origin of a file; NULL without memory. */
iso_shapes *iso_shapes_make(const iso_shapes_opts *opts, iso_vec3 origin);

/* ISO_ERR_USAGE when a number of the options is out of range. */
iso_status iso_shapes_check(const iso_shapes_opts *opts, iso_error *error);

/* The errors of iso_shapes_from_lines that do not depend on memory; opts->radius is not NAN. */
iso_status iso_shapes_check_lines(const iso_lines *lines, const iso_shapes_opts *opts, iso_error *error);

/* Sets up a sort of `count` points with its order 0 .. count - 1 and its other memory; the caller frees it
 * with iso_shapes_sort_free. ISO_ERR_NOMEM. */
iso_status iso_shapes_sort_make(const float (*points)[3], size_t count, iso_shapes_sort *sort,
                                iso_error *error);
void iso_shapes_sort_free(iso_shapes_sort *sort);

/* Makes the blocks of a sorted order, without boxes. ISO_ERR_NOMEM. */
iso_status iso_shapes_make_blocks(iso_shapes *shapes, const iso_shapes_sort *sort, uint32_t count,
                                  iso_error *error);

/* Sets origin and half of a block from the box of its positions, which are relative to the set's origin. */
void iso_shapes_set_box(iso_shapes_block *block, const iso_box *box);
/* Adds what a shape at a position may reach to the set's bounds. */
void iso_shapes_add_bounds(iso_shapes *shapes, const float position[3], float reach);

#endif
