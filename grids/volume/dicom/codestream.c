/* codestream: compares the size of a compressed frame with the DICOM header (JPEG, JPEG-LS and JPEG 2000:
 * ISO/IEC 10918-1, 14495-1, 15444-1).
 *
 * GDCM allocates memory by the header and fills it by the codestream; where the two differ it asserts or
 * writes beyond the end. */
#include "grids/volume/dicom/dicom.h"

static uint32_t big16(const uint8_t *b) {
    return (uint32_t)b[0] << 8 | b[1];
}

static uint32_t big32(const uint8_t *b) {
    return big16(b) << 16 | big16(b + 2);
}

static bool fits(const iso_dicom_file *file, uint32_t columns, uint32_t rows, uint32_t bits) {
    return columns == (uint32_t)file->columns && rows == (uint32_t)file->rows && bits >= 1 &&
           (bits + 7) / 8 == (uint32_t)file->bits_allocated / 8;
}

/* Checks the SIZ segment, which comes first: tiles begin at the origin, and one component that is not
 * subsampled. */
static bool jpeg2000_fits(const iso_dicom_file *file, const uint8_t *b, size_t length) {
    if (length < 45 || big16(b + 2) != 0xff51 || big16(b + 4) != 41 || big16(b + 40) != 1) return false;
    bool at_origin = !big32(b + 16) && !big32(b + 20) && !big32(b + 32) && !big32(b + 36);
    bool tiled = big32(b + 24) > 0 && big32(b + 28) > 0;
    bool sampled = b[43] == 1 && b[44] == 1;
    return at_origin && tiled && sampled && fits(file, big32(b + 8), big32(b + 12), (b[42] & 0x7fU) + 1);
}

/* The markers of frame headers: for JPEG 0xC0 .. 0xCF except three for other segments, for JPEG-LS 0xF7. */
static bool is_frame_header(uint8_t marker) {
    if (marker == 0xf7) return true;
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/* Checks the segments up to the first scan: exactly one of them must be a frame header, of the right size. */
static bool jpeg_fits(const iso_dicom_file *file, const uint8_t *b, size_t length) {
    bool found = false;
    for (size_t at = 2; at + 10 <= length && b[at] == 0xff;) {
        if (b[at + 1] == 0xff) { /* fill */
            at++;
            continue;
        }
        const uint8_t *segment = b + at + 2;
        if (b[at + 1] == 0xda) return found;
        if (is_frame_header(b[at + 1])) {
            if (found || segment[7] != 1 || !fits(file, big16(segment + 5), big16(segment + 3), segment[2]))
                return false;
            found = true;
        }
        at += 2 + (size_t)big16(segment);
    }
    return false;
}

bool iso_dicom_codestream_fits(const iso_dicom_file *file, const uint8_t *bytes, size_t length) {
    if (length >= 4 && big16(bytes) == 0xff4f) return jpeg2000_fits(file, bytes, length);
    if (length >= 4 && big16(bytes) == 0xffd8) return jpeg_fits(file, bytes, length);
    /* RLE (PS3.5, annex G) begins with the number of its segments, one for each byte of a pixel. */
    return length >= 64 && bytes[0] == file->bits_allocated / 8 * file->samples && !bytes[1] && !bytes[2] &&
           !bytes[3];
}
