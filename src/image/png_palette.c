/* png_palette: collects colours in a hash table with linear probing, and sorts them by brightness. */
#include "image/png_palette.h"

#include <stdlib.h>
#include <string.h>

static uint32_t key_of(const uint8_t rgba[4]) {
    return 1u << 24 | (uint32_t)rgba[0] << 16 | (uint32_t)rgba[1] << 8 | rgba[2];
}

/* Returns the slot that holds the key, or the free slot where it belongs. A free slot always exists, because
 * there are more slots than colours. */
static uint32_t slot_of(const iso_png_palette *palette, uint32_t key) {
    uint32_t at = key * 0x9E3779B1u >> 22;
    while (palette->slot[at] && palette->slot[at] != key) at = (at + 1) % ISO_PNG_SLOTS;
    return at;
}

static int brightness(uint32_t colour) {
    return (int)(2 * (colour >> 16 & 255) + 5 * (colour >> 8 & 255) + (colour & 255));
}

static int by_brightness(const void *a, const void *b) {
    uint32_t one = *(const uint32_t *)a, other = *(const uint32_t *)b;
    int difference = brightness(one) - brightness(other);
    return difference ? difference : (one > other) - (one < other);
}

bool iso_png_palette_find(const iso_image *image, iso_png_palette *palette) {
    memset(palette, 0, sizeof *palette);
    size_t pixels = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t key = key_of(image->rgba + 4 * i), at = slot_of(palette, key);
        if (palette->slot[at]) continue;
        if (palette->count == ISO_PNG_COLOURS) return false;
        palette->slot[at] = key;
        palette->colour[palette->count++] = key & 0xFFFFFF;
    }
    qsort(palette->colour, (size_t)palette->count, sizeof palette->colour[0], by_brightness);
    for (int i = 0; i < palette->count; i++)
        palette->index[slot_of(palette, 1u << 24 | palette->colour[i])] = (uint8_t)i;
    return true;
}

uint8_t iso_png_palette_index(const iso_png_palette *palette, const uint8_t rgba[4]) {
    return palette->index[slot_of(palette, key_of(rgba))];
}
