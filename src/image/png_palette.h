/* png_palette: the palette of a picture with at most 256 colours, for PNG's indexed colour type. Internal to
 * image. */
#ifndef ISO_IMAGE_PNG_PALETTE_H
#define ISO_IMAGE_PNG_PALETTE_H

#include <stdbool.h>
#include <stdint.h>

#include "image/image.h"

enum { ISO_PNG_COLOURS = 256, ISO_PNG_SLOTS = 1024 };

typedef struct iso_png_palette {
    int count; /* number of colours */
    uint32_t
        colour[ISO_PNG_COLOURS];  /* 0xRRGGBB, sorted from dark to bright, so that gradients compress well */
    uint32_t slot[ISO_PNG_SLOTS]; /* hash table: 1 << 24 | colour; 0 is free */
    uint8_t index[ISO_PNG_SLOTS]; /* by slot: number of the colour */
} iso_png_palette;

/* Collects the colours of a picture; alpha is ignored. False when there are more than 256; the palette is
 * undefined then. */
bool iso_png_palette_find(const iso_image *image, iso_png_palette *palette);
/* The number of a pixel's colour; the pixel must be of the picture from which the palette was made. */
uint8_t iso_png_palette_index(const iso_png_palette *palette, const uint8_t rgba[4]);

#endif
