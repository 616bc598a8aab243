/* png_palette: the colours of a picture that has few, for PNG's indexed form. Internal to image. */
#ifndef ISO_IMAGE_PNG_PALETTE_H
#define ISO_IMAGE_PNG_PALETTE_H

#include <stdbool.h>
#include <stdint.h>

#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_PNG_COLOURS = 256, ISO_PNG_SLOTS = 1024 };

typedef struct iso_png_palette {
    int count;                        /* of colours */
    uint32_t colour[ISO_PNG_COLOURS]; /* 0xRRGGBB, dark to bright: a ramp's neighbours stay neighbours */
    uint32_t slot[ISO_PNG_SLOTS];     /* hash table: 1 << 24 | colour; 0 is free */
    uint8_t index[ISO_PNG_SLOTS];     /* of the slot's colour */
} iso_png_palette;

/* False, and the palette undefined, when the picture has more colours; alpha is not looked at. */
bool iso_png_palette_find(const iso_image *image, iso_png_palette *palette);
/* Index of a pixel of that picture. */
uint8_t iso_png_palette_index(const iso_png_palette *palette, const uint8_t rgba[4]);

#ifdef __cplusplus
}
#endif
#endif
