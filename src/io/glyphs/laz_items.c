/* laz_items: times are multiples of the last difference, most often once, and colours differences of bytes
 * (M. Isenburg, "LASzip: lossless compression of LiDAR data", PE&RS 79(2), 2013). */
#include "io/glyphs/laz_items.h"

/* ---- times */

/* What comes behind a difference: 0 .. 500 and, up to 510, 501 - 1 .. times it (0: another one), the same
 * time, all bits of a time in a new sequence, and up to three more, another sequence. Without the code for
 * the same time in layers, where those behind it are less by one. */
enum { MOST = 500, LEAST = MOST + 10, SAME, FULL, CODES = FULL + 4, ZERO_CODES = 6 };

static void begin_sequence(iso_laz_time *t, iso_laz_coder *coder) {
    const uint32_t before = (uint32_t)(t->times[t->last] >> 32);
    t->newest = (t->newest + 1) & 3;
    const uint64_t high = iso_laz_integer(coder, &t->integers, 32, before, 8);
    t->times[t->newest] = high << 32 | iso_laz_raw(coder, 32);
    t->last = t->newest;
    t->steps[t->last] = t->extremes[t->last] = 0;
}

static uint32_t predict_step(int32_t step, uint32_t code, uint32_t *context) {
    const uint32_t one = (uint32_t)step;
    *context = code == 0 ? 7 : code == 1 ? 1 : code < 10 ? 2 : code < MOST ? 3 : code == MOST ? 4 : 5;
    if (code == LEAST) *context = 6;
    return code <= MOST ? code * one : (MOST - code) * one;
}

static void step_on(iso_laz_time *t, iso_laz_coder *coder, uint32_t code) {
    uint32_t context;
    const uint32_t predicted = predict_step(t->steps[t->last], code, &context);
    const int32_t step = (int32_t)iso_laz_integer(coder, &t->integers, 32, predicted, context);
    t->times[t->last] += (uint64_t)(int64_t)step;
    if (code == 1) t->extremes[t->last] = 0;
    if (code != 0 && code != MOST && code != LEAST) return;
    if (++t->extremes[t->last] <= 3) return;
    t->steps[t->last] = step; /* the difference has been far from its multiples four times */
    t->extremes[t->last] = 0;
}

/* Reads a code, and does what it says unless that is to go to another sequence: false. */
static bool take_code(iso_laz_time *t, iso_laz_coder *coder, bool layered) {
    const unsigned i = t->last;
    if (t->steps[i] == 0) {
        const uint32_t code = layered ? iso_laz_symbol(coder, &t->after_zero, ZERO_CODES - 1) + 1
                                      : iso_laz_symbol(coder, &t->after_zero, ZERO_CODES);
        if (code == 1) {
            t->steps[i] = (int32_t)iso_laz_integer(coder, &t->integers, 32, 0, 0);
            t->times[i] += (uint64_t)(int64_t)t->steps[i];
            t->extremes[i] = 0;
        }
        if (code == 2) begin_sequence(t, coder);
        if (code > 2) t->last = (i + code - 2) & 3;
        return code <= 2;
    }
    uint32_t code =
        layered ? iso_laz_symbol(coder, &t->multiple, CODES - 1) : iso_laz_symbol(coder, &t->multiple, CODES);
    if (layered && code >= SAME) code++;
    if (code < SAME) step_on(t, coder, code);
    if (code == FULL) begin_sequence(t, coder);
    if (code > FULL) t->last = (i + code - FULL) & 3;
    return code <= FULL;
}

uint64_t iso_laz_time_next(iso_laz_time *time, iso_laz_coder *coder, bool layered) {
    while (!take_code(time, coder, layered) && coder->faults == 0) continue;
    return time->times[time->last];
}

/* ---- colours */

static int clamp(int number) {
    return number < 0 ? 0 : number > 255 ? 255 : number;
}

void iso_laz_color_next(iso_laz_color *models, iso_laz_coder *coder, uint16_t rgb[3]) {
    /* bits of `used`: the lower and the upper bytes of red, green and blue; then whether those of green and
     * blue differ from red */
    const uint32_t used = iso_laz_symbol(coder, &models->used, 128);
    int last[6], now[6];
    for (int i = 0; i < 6; i++) now[i] = last[i] = rgb[i / 2] >> (i & 1) * 8 & 255;
    for (int i = 0; i < 2; i++)
        if (used >> i & 1) now[i] = iso_laz_byte_next(&models->parts[i], coder, (unsigned)last[i]);
    for (int i = 0; i < 2; i++) {
        if (!(used >> 6)) {
            now[2 + i] = now[4 + i] = now[i];
            continue;
        }
        const int red = now[i] - last[i];
        if (used >> (2 + i) & 1)
            now[2 + i] = iso_laz_byte_next(&models->parts[2 + i], coder, (unsigned)clamp(red + last[2 + i]));
        if (used >> (4 + i) & 1) {
            const int both = (red + now[2 + i] - last[2 + i]) / 2;
            now[4 + i] = iso_laz_byte_next(&models->parts[4 + i], coder, (unsigned)clamp(both + last[4 + i]));
        }
    }
    for (int i = 0; i < 3; i++) rgb[i] = (uint16_t)(now[2 * i] | now[2 * i + 1] << 8);
}
