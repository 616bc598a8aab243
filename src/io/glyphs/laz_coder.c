/* laz_coder: the value lies in an interval of the coder's length, from 0; each symbol has a part of it, which
 * becomes the next interval. */
#include "io/glyphs/laz_coder.h"

void iso_laz_begin(iso_laz_coder *coder, iso_laz_memory *memory, const unsigned char *bytes, size_t count) {
    *coder = (iso_laz_coder){bytes, bytes + count, 0, UINT32_MAX, 0, memory};
    for (int i = 0; i < 4; i++) iso_laz_take_byte(coder);
    if (coder->value == UINT32_MAX) coder->value--; /* no encoder writes this: it would lie outside */
}

/* ---- models */

void iso_laz_model_start(iso_laz_memory *memory, iso_laz_model *model, uint32_t symbols) {
    model->numbers = memory->numbers + memory->used;
    memory->used +=
        2 * (size_t)symbols + (symbols > 16 ? (1U << (15 - iso_laz_place_shift(symbols))) + 2 : 0);
    for (uint32_t i = 0; i < symbols; i++) model->numbers[symbols + i] = 1;
    model->cycle = symbols;
    iso_laz_model_renew(model, symbols);
    model->left = model->cycle = (symbols + 6) / 2;
}

void iso_laz_model_renew(iso_laz_model *model, uint32_t symbols) {
    const uint32_t most = 1U << 15;
    uint16_t *begins = model->numbers, *counts = begins + symbols, *places = counts + symbols;
    model->total += model->cycle;
    if (model->total > most) {
        model->total = 0;
        for (uint32_t i = 0; i < symbols; i++) {
            counts[i] = (uint16_t)((counts[i] + 1) / 2);
            model->total += counts[i];
        }
    }
    const uint32_t scale = (1U << 31) / model->total;
    for (uint32_t i = 0, sum = 0; i < symbols; i++) {
        begins[i] = (uint16_t)(scale * sum >> 16);
        sum += counts[i];
    }
    if (symbols > 16) {
        const uint32_t shift = iso_laz_place_shift(symbols), last = most >> shift;
        for (uint32_t place = 0, symbol = 0; place <= last; place++) {
            while (symbol + 1 < symbols && begins[symbol + 1] <= place << shift) symbol++;
            places[place] = (uint16_t)symbol;
        }
        places[last + 1] = (uint16_t)(symbols - 1);
    }
    const uint32_t longest = 8 * (symbols + 6), longer = 5 * model->cycle / 4;
    model->left = model->cycle = longer < longest ? longer : longest;
}

void iso_laz_bit_model_renew(iso_laz_bit_model *model) {
    model->total += model->cycle;
    if (model->total > 1U << 13) {
        model->total = (model->total + 1) / 2;
        model->zeros = (model->zeros + 1) / 2;
        if (model->zeros == model->total) model->total++;
    }
    model->zero = model->zeros * ((1U << 31) / model->total) >> 18;
    const uint32_t longer = 5 * model->cycle / 4;
    model->left = model->cycle = longer < 64 ? longer : 64;
}

/* ---- numbers */

uint32_t iso_laz_bit(iso_laz_coder *coder, iso_laz_bit_model *model) {
    if (!model->total) *model = (iso_laz_bit_model){1U << 12, 1, 2, 4, 4};
    const uint32_t part = model->zero * (coder->length >> 13), bit = coder->value >= part;
    coder->value -= bit ? part : 0;
    coder->length = bit ? coder->length - part : part;
    model->zeros += !bit;
    iso_laz_refill(coder);
    if (--model->left == 0) iso_laz_bit_model_renew(model);
    return bit;
}

uint32_t iso_laz_raw(iso_laz_coder *coder, uint32_t bits) {
    if (bits > 19) {
        const uint32_t low = iso_laz_raw(coder, 16);
        return iso_laz_raw(coder, bits - 16) << 16 | low;
    }
    coder->length >>= bits;
    const uint32_t number = coder->value / coder->length;
    coder->value -= number * coder->length;
    coder->faults += number >> bits; /* what lies behind the last number's interval is not used */
    iso_laz_refill(coder);
    return number & ((1U << bits) - 1);
}

uint32_t iso_laz_integer(iso_laz_coder *coder, iso_laz_integers *integers, uint32_t bits, uint32_t predicted,
                         uint32_t context) {
    return iso_laz_integer_by(coder, integers, &integers->sizes[context], bits, predicted);
}

uint32_t iso_laz_integer_by(iso_laz_coder *coder, iso_laz_integers *integers, iso_laz_model *sizes,
                            uint32_t bits, uint32_t predicted) {
    /* differences of k bits are -(2^k - 1) .. -2^(k-1) and 2^(k-1) + 1 .. 2^k; 0 and 1 have none */
    const uint32_t k = iso_laz_symbol(coder, sizes, bits + 1);
    uint32_t difference;
    integers->size = k;
    if (k == 0) return predicted + iso_laz_bit(coder, &integers->bit);
    if (k == 32) return predicted + (1U << 31);
    if (k <= 8) {
        difference = iso_laz_symbol(coder, &integers->high[k], 1U << k);
    } else {
        difference = iso_laz_symbol(coder, &integers->high[k], 256) << (k - 8);
        difference |= iso_laz_raw(coder, k - 8);
    }
    return predicted + (difference >> (k - 1) ? difference + 1 : difference - ((1U << k) - 1));
}

void iso_laz_median_add(iso_laz_median *median, int32_t number) {
    int32_t *sorted = median->sorted;
    const int32_t before = sorted[2];
    int i;
    if (median->drop_smallest) {
        for (i = 0; i < 4 && sorted[i + 1] < number; i++) sorted[i] = sorted[i + 1];
        median->drop_smallest = before < number;
    } else {
        for (i = 4; i > 0 && number < sorted[i - 1]; i--) sorted[i] = sorted[i - 1];
        median->drop_smallest = number >= before;
    }
    sorted[i] = number;
}
