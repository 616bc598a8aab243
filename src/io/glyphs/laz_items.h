/* laz_items: the parts of points that both ways of LAZ, pointwise and layered, code alike: times and colours;
 * and the decoders of chunks, which hold nothing but one chunk's state. Internal to src/io/glyphs; one thread
 * at a time. */
#ifndef ISO_IO_GLYPHS_LAZ_ITEMS_H
#define ISO_IO_GLYPHS_LAZ_ITEMS_H

#include <string.h>

#include "base/status.h"
#include "io/glyphs/laz_coder.h"

/* ISO_LAZ_RECORD: the longest records that are decoded, in bytes. */
enum { ISO_LAZ_ITEMS = 8, ISO_LAZ_RECORD = 4096 };

/* The numbers of items are those of LASzip; POINT10 to BYTES are coded pointwise, and POINT14 to BYTES14 in
 * layers. */
enum {
    ISO_LAZ_BYTES = 0,
    ISO_LAZ_POINT10 = 6,
    ISO_LAZ_GPSTIME11 = 7,
    ISO_LAZ_RGB12 = 8,
    ISO_LAZ_WAVEPACKET13 = 9,
    ISO_LAZ_POINT14 = 10,
    ISO_LAZ_RGB14 = 11,
    ISO_LAZ_RGBNIR14 = 12,
    ISO_LAZ_WAVEPACKET14 = 13,
    ISO_LAZ_BYTES14 = 14
};

typedef struct iso_laz_item {
    int type, version;
    size_t bytes;
} iso_laz_item;

/* What the records of a file consist of, in order. */
typedef struct iso_laz_layout {
    iso_laz_item items[ISO_LAZ_ITEMS];
    int count;
    size_t record; /* bytes of all items */
} iso_laz_layout;

/* ---- numbers of records, in the byte order of the machines that this runs on, little-endian */

static inline uint32_t iso_laz_load32(const unsigned char *from) {
    uint32_t number;
    memcpy(&number, from, sizeof number);
    return number;
}

static inline void iso_laz_store32(unsigned char *to, uint32_t number) {
    memcpy(to, &number, sizeof number);
}

static inline uint16_t iso_laz_load16(const unsigned char *from) {
    uint16_t number;
    memcpy(&number, from, sizeof number);
    return number;
}

static inline void iso_laz_store16(unsigned char *to, uint32_t number) {
    const uint16_t half = (uint16_t)number;
    memcpy(to, &half, sizeof half);
}

/* ---- times */

/* The last times of four sequences of points, and how far each went. Zero-initialise. */
typedef struct iso_laz_time {
    uint64_t times[4]; /* bits of doubles */
    int32_t steps[4];
    int extremes[4];
    unsigned last, newest;
    iso_laz_model multiple, after_zero;
    iso_laz_integers integers;
} iso_laz_time;

/* Decodes the next time. `layered`: it differs from the last one. */
uint64_t iso_laz_time_next(iso_laz_time *time, iso_laz_coder *coder, bool layered);

/* ---- colours */

typedef struct iso_laz_color {
    iso_laz_model used, parts[6];
} iso_laz_color;

/* Decodes a colour from the last one, which it replaces. */
void iso_laz_color_next(iso_laz_color *models, iso_laz_coder *coder, uint16_t rgb[3]);

/* A byte from the last one: what is added has a model of its own. */
static inline uint8_t iso_laz_byte_next(iso_laz_model *model, iso_laz_coder *coder, unsigned last) {
    return (uint8_t)(last + iso_laz_symbol(coder, model, 256));
}

/* ---- chunks */

/* Decodes the points of a chunk, some at a time, into records that are those of the uncompressed file. */
typedef struct iso_laz_decoder {
    /* A decoder for one thread; NULL: no memory. iso_free when done. `layout` is borrowed. */
    void *(*make)(const iso_laz_layout *layout);
    /* Begins a chunk, whose bytes are borrowed; false: it is too short for what it begins with. */
    bool (*begin)(void *decoder, const unsigned char *bytes, size_t count);
    /* Decodes the next `points` points; false: the chunk is damaged. */
    bool (*next)(void *decoder, unsigned char *records, size_t points);
    /* Whether all bytes of the chunk were used, as they are when all of its points have been decoded. */
    bool (*ends)(const void *decoder);
} iso_laz_decoder;

extern const iso_laz_decoder iso_laz_pointwise, iso_laz_layered;

#endif
