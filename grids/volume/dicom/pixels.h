/* pixels: the pixels of a file, read frame by frame. Internal to grids/volume/dicom. */
#ifndef ISO_GRIDS_VOLUME_DICOM_PIXELS_H
#define ISO_GRIDS_VOLUME_DICOM_PIXELS_H

#include <stdio.h>
#include <string.h>

#include "grids/volume/dicom/dicom.h"

/* The file that frames are being read from. Zero-initialised it is closed. */
typedef struct iso_dicom_pixels {
    const iso_dicom_file *file;
    FILE *stream;
    uint8_t *bytes; /* encapsulated pixels; items as iso_dicom_items has them */
    size_t *offset, *length;
    size_t items;
} iso_dicom_pixels;

/* Closes what is open, and opens the pixels of a file, which is borrowed. ISO_ERR_IO, ISO_ERR_NOMEM. */
iso_status iso_dicom_pixels_open(const iso_dicom_file *file, iso_dicom_pixels *f, iso_error *error);
void iso_dicom_pixels_close(iso_dicom_pixels *f);

/* Reads a frame into `pixels`, which has iso_dicom_frame_bytes. `warning` becomes what a codec complains of,
 * or empty. ISO_ERR_IO: it cannot be read or decoded. */
iso_status iso_dicom_pixels_read(const iso_dicom_pixels *f, int frame, void *pixels,
                                 char warning[ISO_DICOM_WARNING], iso_error *error);

/* Whether pixels in memory have the other byte order. Decoders return the machine's. */
static inline bool iso_dicom_is_swapped(const iso_dicom_file *file) {
    return !file->encapsulated && file->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
}

/* The stored value of pixel i of a frame. Bits outside the stored ones may hold overlays or anything (PS3.5,
 * 8.1.1). Decoders return the value in the low bits, without sign extension. */
static inline double iso_dicom_value(const iso_dicom_file *file, const void *pixels, size_t i) {
    const bool swap = iso_dicom_is_swapped(file);
    uint16_t half;
    uint32_t bits;
    if (file->bits_allocated <= 8) {
        bits = ((const uint8_t *)pixels)[i];
    } else if (file->bits_allocated == 16) {
        memcpy(&half, (const uint8_t *)pixels + 2 * i, 2);
        bits = swap ? __builtin_bswap16(half) : half;
    } else {
        memcpy(&bits, (const uint8_t *)pixels + 4 * i, 4);
        if (swap) bits = __builtin_bswap32(bits);
    }
    const uint32_t mask = file->bits_stored == 32 ? UINT32_MAX : (UINT32_C(1) << file->bits_stored) - 1;
    if (!file->encapsulated) bits >>= file->high_bit + 1 - file->bits_stored;
    if (!file->encapsulated || file->is_signed) bits &= mask;
    const bool negative = file->is_signed && (bits >> (file->bits_stored - 1) & 1);
    return negative ? (double)bits - (double)mask - 1 : (double)bits;
}

#endif
