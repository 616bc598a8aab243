/* laz_version1: the coder of LASzip 1; the paper on LASzip (laz_coder.h) is about the next one. */
#include "io/glyphs/laz_version1.h"

#include "io/glyphs/laz_items.h"

enum { INTENSITY = 12, FLAGS = 14, CLASS, ANGLE, USER, SOURCE };

static uint32_t median(const int32_t n[3]) {
    const int32_t low = n[0] < n[1] ? n[0] : n[1], high = n[0] < n[1] ? n[1] : n[0];
    return (uint32_t)(n[2] < low ? low : n[2] > high ? high : n[2]);
}

static void next_xyz(iso_laz_point1 *p, iso_laz_coder *coder, unsigned char last[20]) {
    const uint32_t dx = iso_laz_integer(coder, &p->dx, 32, median(p->x_steps), 0);
    const uint32_t of_x = p->dx.size < 19 ? p->dx.size : 19;
    const uint32_t dy = iso_laz_integer(coder, &p->dy, 32, median(p->y_steps), of_x);
    const uint32_t size = (p->dx.size + p->dy.size) / 2;
    iso_laz_store32(last, iso_laz_load32(last) + dx);
    iso_laz_store32(last + 4, iso_laz_load32(last + 4) + dy);
    iso_laz_store32(last + 8,
                    iso_laz_integer(coder, &p->z, 32, iso_laz_load32(last + 8), size < 19 ? size : 19));
    p->x_steps[p->newest] = (int32_t)dx;
    p->y_steps[p->newest] = (int32_t)dy;
    p->newest = (p->newest + 1) % 3;
}

void iso_laz_point1_next(iso_laz_point1 *p, iso_laz_coder *coder, unsigned char last[20]) {
    next_xyz(p, coder, last);
    const uint32_t changed = iso_laz_symbol(coder, &p->changed, 64);
    const bool near = (p->dx.size + p->dy.size) / 2 < 3;
    unsigned char *intensity = last + INTENSITY, *source = last + SOURCE;
    if (changed & 32)
        iso_laz_store16(intensity, iso_laz_integer(coder, &p->intensity, 16, iso_laz_load16(intensity), 0));
    if (changed & 16) last[FLAGS] = (uint8_t)iso_laz_symbol(coder, &p->flags[last[FLAGS]], 256);
    if (changed & 8) last[CLASS] = (uint8_t)iso_laz_symbol(coder, &p->classes[last[CLASS]], 256);
    if (changed & 4) last[ANGLE] = (uint8_t)iso_laz_integer(coder, &p->angle, 8, last[ANGLE], near);
    if (changed & 2) last[USER] = (uint8_t)iso_laz_symbol(coder, &p->users[last[USER]], 256);
    if (changed & 1)
        iso_laz_store16(source, iso_laz_integer(coder, &p->source, 16, iso_laz_load16(source), 0));
}

/* The difference to the last time for a code: 1 .. 509 times the last difference, 0: another one. */
static int32_t next_step(iso_laz_time1 *t, iso_laz_coder *coder, uint32_t code) {
    enum { MOST = 509 };
    const uint32_t context = code == 0 ? 2 : code == 1 ? 1 : code < 10 ? 3 : code < 50 ? 4 : 5;
    const uint32_t predicted = code == 0 ? (uint32_t)(t->step / 4) : code * (uint32_t)t->step;
    const int32_t step = (int32_t)iso_laz_integer(coder, &t->integers, 32, predicted, context);
    if (code == 0 || code == MOST) t->extremes++;
    if (code == 1 || t->extremes > 3) {
        t->step = step;
        t->extremes = 0;
    }
    return step;
}

void iso_laz_time1_next(iso_laz_time1 *t, iso_laz_coder *coder, unsigned char last[8]) {
    enum { SAME = 511, FULL = 510, CODES = 512, ZERO_CODES = 3 };
    uint64_t time = iso_laz_load32(last) | (uint64_t)iso_laz_load32(last + 4) << 32;
    bool full;
    if (t->step == 0) {
        const uint32_t code = iso_laz_symbol(coder, &t->after_zero, ZERO_CODES);
        if (code == 1) t->step = (int32_t)iso_laz_integer(coder, &t->integers, 32, 0, 0);
        time += (uint64_t)(int64_t)t->step;
        full = code == 2;
    } else {
        const uint32_t code = iso_laz_symbol(coder, &t->multiple, CODES);
        if (code < FULL) time += (uint64_t)(int64_t)next_step(t, coder, code);
        full = code == FULL;
    }
    if (full) {
        time = iso_laz_raw(coder, 32);
        time |= (uint64_t)iso_laz_raw(coder, 32) << 32;
    }
    iso_laz_store32(last, (uint32_t)time);
    iso_laz_store32(last + 4, (uint32_t)(time >> 32));
}

void iso_laz_color1_next(iso_laz_color1 *color, iso_laz_coder *coder, unsigned char last[6]) {
    const uint32_t used = iso_laz_symbol(coder, &color->used, 64);
    for (uint32_t k = 0; k < 6; k++)
        if (used >> k & 1) last[k] = (uint8_t)iso_laz_integer(coder, &color->parts, 8, last[k], k);
}

/* An offset is the last one, lies behind the last waveform or as far from it as before, or is stated. */
static uint64_t next_offset(iso_laz_wave *wave, iso_laz_coder *coder, uint64_t last, uint32_t size) {
    wave->how = iso_laz_symbol(coder, &wave->offset[wave->how], 4);
    if (wave->how == 0) return last;
    if (wave->how == 1) return last + size;
    if (wave->how == 2) {
        wave->step = iso_laz_integer(coder, &wave->offset_step, 32, wave->step, 0);
        return last + (uint64_t)(int64_t)(int32_t)wave->step;
    }
    const uint64_t low = iso_laz_raw(coder, 32);
    return low | (uint64_t)iso_laz_raw(coder, 32) << 32;
}

void iso_laz_wave_next(iso_laz_wave *wave, iso_laz_coder *coder, unsigned char last[29]) {
    enum { OFFSET = 1, SIZE = 9, PLACE = 13, DIRECTION = 17 };
    const uint32_t size = iso_laz_load32(last + SIZE);
    const uint64_t before = iso_laz_load32(last + OFFSET) | (uint64_t)iso_laz_load32(last + OFFSET + 4) << 32;
    last[0] = (uint8_t)iso_laz_symbol(coder, &wave->descriptor, 256);
    const uint64_t offset = next_offset(wave, coder, before, size);
    iso_laz_store32(last + OFFSET, (uint32_t)offset);
    iso_laz_store32(last + OFFSET + 4, (uint32_t)(offset >> 32));
    iso_laz_store32(last + SIZE, iso_laz_integer(coder, &wave->size, 32, size, 0));
    iso_laz_store32(last + PLACE, iso_laz_integer(coder, &wave->place, 32, iso_laz_load32(last + PLACE), 0));
    for (uint32_t axis = 0; axis < 3; axis++) {
        unsigned char *at = last + DIRECTION + 4 * axis;
        iso_laz_store32(at, iso_laz_integer(coder, &wave->direction, 32, iso_laz_load32(at), axis));
    }
}
