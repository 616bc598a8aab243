/* laz_coder: what the points of LAZ files are coded with: an arithmetic decoder whose models adapt to the
 * symbols that came (A. Said, "Introduction to Arithmetic Coding", HPL-2004-76), and integers that are
 * predicted (M. Isenburg, "LASzip: lossless compression of LiDAR data", PE&RS 79(2), 2013). Any bytes can be
 * decoded: damaged ones give wrong symbols, never ones that a model does not have. Internal to src/io/glyphs;
 * one thread at a time. */
#ifndef ISO_IO_GLYPHS_LAZ_CODER_H
#define ISO_IO_GLYPHS_LAZ_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ISO_LAZ_ROOM: numbers that a model of up to 256 symbols needs; ISO_LAZ_MOST_ROOM: of up to 516. */
enum { ISO_LAZ_ROOM = 2 * 256 + 66, ISO_LAZ_MOST_ROOM = 2 * 516 + 66 };

/* Where the numbers of models lie, one after the other in the order in which they are first used. */
typedef struct iso_laz_memory {
    uint16_t *numbers;
    size_t used;
} iso_laz_memory;

/* The frequencies of symbols. Zero-initialise: all are equally frequent. */
typedef struct iso_laz_model {
    uint16_t *numbers; /* of each symbol: where its interval begins, of 2^15; then how often it came; then the
                          symbols at places of equal distance. NULL: the model was not used yet */
    uint32_t total, cycle, left; /* left: symbols until the intervals are renewed, every `cycle` */
} iso_laz_model;

/* The same for bits. Zero-initialise. */
typedef struct iso_laz_bit_model {
    uint32_t zero, zeros, total, cycle, left; /* zero: the interval of 0, of 2^13 */
} iso_laz_bit_model;

/* Integers that are coded as the difference to a prediction. Zero-initialise. */
typedef struct iso_laz_integers {
    iso_laz_model sizes[22]; /* of each context: how many bits the difference has */
    iso_laz_bit_model bit;
    iso_laz_model high[33]; /* of each size: its upper 8 bits */
    uint32_t size;          /* of the last difference, in bits */
} iso_laz_integers;

typedef struct iso_laz_coder {
    const unsigned char *at, *end;
    uint32_t value, length;
    uint32_t faults; /* bytes that were wanted behind the end, and numbers that no encoder writes */
    iso_laz_memory *memory;
} iso_laz_coder;

/* Begins to decode these bytes. */
void iso_laz_begin(iso_laz_coder *coder, iso_laz_memory *memory, const unsigned char *bytes, size_t count);

/* The steps of iso_laz_symbol and iso_laz_bit that are seldom taken. */
void iso_laz_model_start(iso_laz_memory *memory, iso_laz_model *model, uint32_t symbols);
void iso_laz_model_renew(iso_laz_model *model, uint32_t symbols);
void iso_laz_bit_model_renew(iso_laz_bit_model *model);

/* Of 2^6 places, or 2^4, of the whole interval the symbol is known in models with more than 16 symbols. */
static inline uint32_t iso_laz_place_shift(uint32_t symbols) {
    return symbols > 128 ? 15 - 6 : 15 - 4;
}

static inline void iso_laz_take_byte(iso_laz_coder *coder) {
    coder->value <<= 8;
    if (coder->at < coder->end)
        coder->value |= *coder->at++;
    else
        coder->faults++;
}

static inline void iso_laz_refill(iso_laz_coder *coder) {
    for (; coder->length < 1U << 24; coder->length <<= 8) iso_laz_take_byte(coder);
}

/* Decodes a symbol of a model with `symbols` of them, 2 .. 516, always as many. */
static inline uint32_t iso_laz_symbol(iso_laz_coder *coder, iso_laz_model *model, uint32_t symbols) {
    if (!model->numbers) iso_laz_model_start(coder->memory, model, symbols);
    uint16_t *begins = model->numbers, *counts = begins + symbols;
    const uint32_t unit = coder->length >> 15;
    uint32_t low = 0, high = symbols;
    if (symbols > 16) {
        const uint32_t place = coder->value / unit;
        const uint16_t *found = counts + symbols + (place >> iso_laz_place_shift(symbols));
        low = found[0];
        high = found[1] + 1U;
        while (high - low > 1) {
            const uint32_t middle = (low + high) / 2;
            const bool above = begins[middle] > place;
            high = above ? middle : high;
            low = above ? low : middle;
        }
    }
    while (high - low > 1) {
        const uint32_t middle = (low + high) / 2;
        const bool above = begins[middle] * unit > coder->value;
        high = above ? middle : high;
        low = above ? low : middle;
    }
    const uint32_t begin = begins[low] * unit;
    coder->length = (low + 1 < symbols ? begins[low + 1] * unit : coder->length) - begin;
    coder->value -= begin;
    iso_laz_refill(coder);
    counts[low]++;
    if (--model->left == 0) iso_laz_model_renew(model, symbols);
    return low;
}

uint32_t iso_laz_bit(iso_laz_coder *coder, iso_laz_bit_model *model);
/* Decodes `bits` bits, 1 .. 32, all of whose values are equally frequent. */
uint32_t iso_laz_raw(iso_laz_coder *coder, uint32_t bits);

/* Decodes an integer of `bits` bits, 8, 16 or 32 (only so many of the result count), from its prediction. */
uint32_t iso_laz_integer(iso_laz_coder *coder, iso_laz_integers *integers, uint32_t bits, uint32_t predicted,
                         uint32_t context);
/* The same for a context whose sizes are elsewhere. */
uint32_t iso_laz_integer_by(iso_laz_coder *coder, iso_laz_integers *integers, iso_laz_model *sizes,
                            uint32_t bits, uint32_t predicted);

/* A running median of five numbers, at first 0: of the sorted five, the largest and the smallest are replaced
 * in turn. Zero-initialise. */
typedef struct iso_laz_median {
    int32_t sorted[5];
    bool drop_smallest;
} iso_laz_median;

static inline uint32_t iso_laz_median_get(const iso_laz_median *median) {
    return (uint32_t)median->sorted[2];
}
void iso_laz_median_add(iso_laz_median *median, int32_t number);

#endif
