/* dicom_files: writes DICOM files element by element. */
#include "dicom_files.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define UNDEFINED UINT32_MAX

/* A data set that is being written into memory. */
typedef struct out {
    uint8_t *bytes;
    size_t count, room;
    bool explicit_vr, big;
} out;

static void put(out *o, const void *bytes, size_t count) {
    if (o->count + count > o->room) {
        o->room = 2 * (o->count + count);
        o->bytes = realloc(o->bytes, o->room);
        if (!o->bytes) abort();
    }
    if (count) memcpy(o->bytes + o->count, bytes, count);
    o->count += count;
}

static void put_number(out *o, uint32_t value, int bytes) {
    for (int i = 0; i < bytes; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * (o->big ? bytes - 1 - i : i));
        put(o, &byte, 1);
    }
}

static void put_head(out *o, uint32_t tag, const char *vr, uint32_t length) {
    put_number(o, tag >> 16, 2);
    put_number(o, tag & 0xffff, 2);
    if (!o->explicit_vr || tag >> 16 == 0xfffe) {
        put_number(o, length, 4);
        return;
    }
    put(o, vr, 2);
    if (strstr("OB OW SQ UN UT", vr)) {
        put_number(o, 0, 2);
        put_number(o, length, 4);
    } else {
        put_number(o, length, 2);
    }
}

static void put_text(out *o, uint32_t tag, const char *vr, const char *text) {
    if (!text || !*text) return;
    size_t length = strlen(text);
    put_head(o, tag, vr, (uint32_t)(length + length % 2));
    put(o, text, length);
    if (length % 2) put(o, strcmp(vr, "UI") == 0 ? "" : " ", 1);
}

static void put_short(out *o, uint32_t tag, int value) {
    put_head(o, tag, "US", 2);
    put_number(o, (uint32_t)value, 2);
}

/* Writes a sequence of one item, or an item, with the contents of `inside`, which is freed. */
static void put_nested(out *o, uint32_t tag, const char *vr, out *inside, bool delimited) {
    put_head(o, tag, vr, delimited ? UNDEFINED : (uint32_t)inside->count);
    put(o, inside->bytes, inside->count);
    if (delimited) put_head(o, tag == 0xfffee000 ? 0xfffee00d : 0xfffee0dd, "", 0);
    free(inside->bytes);
    *inside = (out){.explicit_vr = o->explicit_vr, .big = o->big};
}

static void put_sequence(out *o, uint32_t tag, out *item, bool delimited) {
    out sequence = {.explicit_vr = o->explicit_vr, .big = o->big};
    put_nested(&sequence, 0xfffee000, "", item, delimited);
    put_nested(o, tag, "SQ", &sequence, delimited);
}

static void put_groups(out *o, const dicom_spec *spec) {
    out item = {.explicit_vr = o->explicit_vr, .big = o->big}, shared = item, frames = item, frame = item;
    put_text(&item, 0x00200037, "DS", spec->orientation);
    put_sequence(&shared, 0x00209116, &item, spec->delimited);
    put_text(&item, 0x00180050, "DS", spec->thickness);
    put_text(&item, 0x00280030, "DS", spec->spacing);
    put_sequence(&shared, 0x00289110, &item, spec->delimited);
    put_text(&item, 0x00281052, "DS", spec->intercept);
    put_text(&item, 0x00281053, "DS", spec->slope);
    put_sequence(&shared, 0x00289145, &item, spec->delimited);
    put_sequence(o, 0x52009229, &shared, spec->delimited);
    for (int i = 0; i < spec->frames; i++) {
        put_text(&item, 0x00200032, "DS", spec->frame_positions[i]);
        put_sequence(&frame, 0x00209113, &item, spec->delimited);
        put_nested(&frames, 0xfffee000, "", &frame, spec->delimited);
    }
    put_nested(o, 0x52009230, "SQ", &frames, spec->delimited);
}

static void put_pixels(out *o, const dicom_spec *spec) {
    size_t each = (size_t)spec->allocated / 8;
    size_t count = (size_t)spec->columns * (size_t)spec->rows * (size_t)(spec->samples ? spec->samples : 1) *
                   (size_t)(spec->frames ? spec->frames : 1);
    bool pad = count * each % 2;
    put_head(o, 0x7fe00010, each == 1 && !o->big ? "OB" : "OW", (uint32_t)(count * each + pad));
    for (size_t i = 0; i < count; i++) {
        uint32_t value = 0;
        memcpy(&value, (const uint8_t *)spec->pixels + i * each, each); /* for little-endian machines */
        put_number(o, value, (int)each);
    }
    if (pad) put(o, "", 1);
}

static void put_image(out *o, const dicom_spec *spec) {
    char frames[16];
    int samples = spec->samples ? spec->samples : 1;
    snprintf(frames, sizeof frames, "%d", spec->frames);
    put_short(o, 0x00280002, samples);
    put_text(o, 0x00280004, "CS", spec->photometric ? spec->photometric : "MONOCHROME2");
    if (samples > 1) put_short(o, 0x00280006, 0);
    if (spec->frames) put_text(o, 0x00280008, "IS", frames);
    put_short(o, 0x00280010, spec->rows);
    put_short(o, 0x00280011, spec->columns);
    if (!spec->frame_positions) put_text(o, 0x00280030, "DS", spec->spacing);
    put_short(o, 0x00280100, spec->allocated);
    put_short(o, 0x00280101, spec->stored);
    put_short(o, 0x00280102, spec->high);
    put_short(o, 0x00280103, spec->is_signed);
    if (spec->frame_positions) {
        put_groups(o, spec);
    } else {
        put_text(o, 0x00281052, "DS", spec->intercept);
        put_text(o, 0x00281053, "DS", spec->slope);
    }
    put_pixels(o, spec);
}

static void put_set(out *o, const dicom_spec *spec) {
    const bool plain = !spec->frame_positions;
    put_text(o, 0x00080016, "UI", spec->frames ? "1.2.840.10008.5.1.4.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.2");
    put_text(o, 0x00080018, "UI", "1.2.3.4.5.6.7");
    put_text(o, 0x00080060, "CS", "CT");
    put_text(o, 0x0008103e, "LO", spec->description);
    if (plain) put_text(o, 0x00180050, "DS", spec->thickness);
    put_text(o, 0x00180088, "DS", spec->between);
    /* a private sequence with delimiters, and an empty one: readers must skip both */
    out item = {.explicit_vr = o->explicit_vr, .big = o->big};
    put_text(&item, 0x00191001, "LO", "nothing");
    put_text(&item, 0x00200032, "DS", "9\\9\\9");
    put_sequence(o, 0x00191000, &item, true);
    put_head(o, 0x00191010, "SQ", 0);
    put_text(o, 0x0020000d, "UI", "1.2.3.4");
    put_text(o, 0x0020000e, "UI", spec->series);
    put_text(o, 0x00200011, "IS", spec->series_number);
    put_text(o, 0x00200012, "IS", spec->acquisition);
    put_text(o, 0x00200013, "IS", spec->instance);
    if (plain) put_text(o, 0x00200032, "DS", spec->position);
    if (plain) put_text(o, 0x00200037, "DS", spec->orientation);
    put_text(o, 0x00200100, "IS", spec->temporal);
    if (spec->pixels) put_image(o, spec);
}

void dicom_write(const char *path, const dicom_spec *spec) {
    static const char *const syntaxes[] = {"1.2.840.10008.1.2.1", "1.2.840.10008.1.2", "1.2.840.10008.1.2.2"};
    out meta = {.explicit_vr = true}, file = {.explicit_vr = true}, set = {0};
    put_text(&meta, 0x00020002, "UI",
             !spec->pixels  ? "1.2.840.10008.5.1.4.1.1.88.11"
             : spec->frames ? "1.2.840.10008.5.1.4.1.1.2.1"
                            : "1.2.840.10008.5.1.4.1.1.2");
    put_text(&meta, 0x00020003, "UI", "1.2.3.4.5.6.7");
    put_text(&meta, 0x00020010, "UI", syntaxes[spec->syntax]);
    const char preamble[128] = {0};
    put(&file, preamble, sizeof preamble);
    put(&file, "DICM", 4);
    put_head(&file, 0x00020000, "UL", 4);
    put_number(&file, (uint32_t)meta.count, 4);
    put(&file, meta.bytes, meta.count);
    set.explicit_vr = spec->syntax != DICOM_IMPLICIT;
    set.big = spec->syntax == DICOM_BIG;
    put_set(&set, spec);
    put(&file, set.bytes, set.count);
    FILE *stream = fopen(path, "wb");
    if (!stream || fwrite(file.bytes, 1, file.count, stream) != file.count || fclose(stream) != 0) abort();
    free(meta.bytes);
    free(set.bytes);
    free(file.bytes);
}
