/* key_image: pictures that are drawn in parts, in
 * any order, by any number of threads, processes or machines, and put together to the same bytes.
 *
 * A pixel is a key of 64 bits, or ISO_KEY_EMPTY. Drawing keeps the smallest key, so the result does not
 * depend on the order of drawing, and the key image of a whole is the minimum of those of its parts, pixel
 * by pixel. What the keys mean is the drawing method's: those of `exact` (exact/exact.h) have the pixel's
 * colour in the low 32 bits.
 *
 * The key image of a surface with caps has three planes of the picture's size, one below the other: the keys
 * of `exact`; the depths of the same crossings (the brick's place << 32 | the bits of a float); and the caps
 * (iso_key_of_cap). Each is merged by the minimum; when all are, the nearer of surface and cap remains. */
#ifndef ISO_RENDER_VIEW_KEY_IMAGE_H
#define ISO_RENDER_VIEW_KEY_IMAGE_H

#include <stdint.h>

#include "base/parallel.h"
#include "image/image.h"

#define ISO_KEY_EMPTY UINT64_MAX

enum { ISO_KEY_PLANES = 3 }; /* of a surface with caps */

typedef struct iso_key_image {
    int width, height;
    uint64_t *keys; /* rows from top to bottom; owned */
} iso_key_image;

/* Creates an empty key image, whose sides may be larger than those of pictures. ISO_ERR_NOMEM. */
iso_status iso_key_image_allocate(int width, int height, iso_key_image *image, iso_error *error);

void iso_key_image_free(iso_key_image *image);

/* The key of a cap: of two, the smaller one is of the nearer cap, or of that of the lower `order` (0 .. 255)
 * where the depths, rounded down to floats, are equal. depth: mm along the view; -INFINITY: it hides what is
 * left of its surface wherever that lies. rgba: the red in the low byte; opaque. */
uint64_t iso_key_of_cap(double depth, int order, uint32_t rgba);

/* Makes the three planes of a surface with caps one, when all parts have been merged: a cap stays where it
 * is nearer than the surface. */
void iso_key_image_join_caps(iso_key_image *image, iso_pool *pool);

/* Empties all pixels. `pool` may be NULL, also below. */
void iso_key_image_clear(iso_key_image *image, iso_pool *pool);

/* Replaces each key of `image` by the smaller one of the two images, which have the same size. */
void iso_key_image_minimum(iso_key_image *image, const iso_key_image *other, iso_pool *pool);

/* Sets the pixels of `picture`, which has the key image's size, to the colours in the keys, and those without
 * a key to `empty` (iso_shading_empty). Returns the number of pixels with a key. */
size_t iso_key_image_paint(const iso_key_image *image, int32_t empty, iso_image *picture, iso_pool *pool);

#endif
