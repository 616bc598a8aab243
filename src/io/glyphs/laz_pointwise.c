/* laz_pointwise: chunks of point formats 0 to 5, whose points are coded one after the other, each item of
 * them from the last point's: here items of version 2. The first point is not coded. */
#include <string.h>

#include "base/memory.h"
#include "io/glyphs/laz_items.h"
#include "io/glyphs/laz_version1.h"

/* The records' first 20 bytes. */
typedef struct point10 {
    iso_laz_model changed, flags[256], classes[256], users[256], angles[2];
    iso_laz_integers intensity, source, dx, dy, z;
    iso_laz_median x_steps[16], y_steps[16];
    uint16_t intensities[16];
    uint32_t heights[8];
} point10;

/* What is zero when a chunk begins. */
typedef struct state {
    bool begun; /* the first point has been given */
    point10 point;
    iso_laz_time time;
    iso_laz_color color;
    iso_laz_point1 point1;
    iso_laz_time1 time1;
    iso_laz_color1 color1;
    iso_laz_integers bytes1;
    iso_laz_wave wave;
} state;

typedef struct pointwise {
    const iso_laz_layout *layout;
    iso_laz_coder coder;
    iso_laz_memory memory;
    state now;
    unsigned char last[ISO_LAZ_RECORD];
    iso_laz_model *bytes; /* of each extra byte */
    size_t byte_count;
} pointwise;

/* Contexts for the numbers `return of returns`: points of a beam that are alike. */
static const uint8_t return_contexts[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},   {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},  {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};

enum { INTENSITY = 12, FLAGS = 14, CLASS, ANGLE, USER, SOURCE };

/* Everything but the coordinates. */
static void next_attributes(point10 *p, iso_laz_coder *coder, unsigned char *last) {
    const uint32_t changed = iso_laz_symbol(coder, &p->changed, 64);
    if (changed & 32) last[FLAGS] = (uint8_t)iso_laz_symbol(coder, &p->flags[last[FLAGS]], 256);
    const unsigned context = return_contexts[last[FLAGS] >> 3 & 7][last[FLAGS] & 7];
    if (changed & 16)
        p->intensities[context] = (uint16_t)iso_laz_integer(coder, &p->intensity, 16, p->intensities[context],
                                                            context < 3 ? context : 3);
    iso_laz_store16(last + INTENSITY, p->intensities[context]);
    if (changed & 8) last[CLASS] = (uint8_t)iso_laz_symbol(coder, &p->classes[last[CLASS]], 256);
    if (changed & 4) last[ANGLE] = iso_laz_byte_next(&p->angles[last[FLAGS] >> 6 & 1], coder, last[ANGLE]);
    if (changed & 2) last[USER] = (uint8_t)iso_laz_symbol(coder, &p->users[last[USER]], 256);
    if (changed & 1)
        iso_laz_store16(last + SOURCE,
                        iso_laz_integer(coder, &p->source, 16, iso_laz_load16(last + SOURCE), 0));
}

static void next_point(point10 *p, iso_laz_coder *coder, unsigned char *last) {
    next_attributes(p, coder, last);
    const int number = last[FLAGS] & 7, returns = last[FLAGS] >> 3 & 7;
    const unsigned steps = return_contexts[returns][number];
    const unsigned level = (unsigned)(returns > number ? returns - number : number - returns);
    const uint32_t single = returns == 1;

    const uint32_t dx = iso_laz_integer(coder, &p->dx, 32, iso_laz_median_get(&p->x_steps[steps]), single);
    iso_laz_median_add(&p->x_steps[steps], (int32_t)dx);
    iso_laz_store32(last, iso_laz_load32(last) + dx);

    uint32_t size = p->dx.size;
    const uint32_t dy = iso_laz_integer(coder, &p->dy, 32, iso_laz_median_get(&p->y_steps[steps]),
                                        single + (size < 20 ? size & ~1U : 20));
    iso_laz_median_add(&p->y_steps[steps], (int32_t)dy);
    iso_laz_store32(last + 4, iso_laz_load32(last + 4) + dy);

    size = (p->dx.size + p->dy.size) / 2;
    p->heights[level] =
        iso_laz_integer(coder, &p->z, 32, p->heights[level], single + (size < 18 ? size & ~1U : 18));
    iso_laz_store32(last + 8, p->heights[level]);
}

static void next_time(pointwise *p, unsigned char *last) {
    const uint64_t time = iso_laz_time_next(&p->now.time, &p->coder, false);
    memcpy(last, &time, sizeof time);
}

static void next_color(pointwise *p, unsigned char *last) {
    uint16_t rgb[3];
    memcpy(rgb, last, sizeof rgb);
    iso_laz_color_next(&p->now.color, &p->coder, rgb);
    memcpy(last, rgb, sizeof rgb);
}

static void next_bytes(pointwise *p, const iso_laz_item *item, unsigned char *last) {
    for (size_t k = 0; k < item->bytes; k++)
        last[k] = item->version == 1
                      ? (uint8_t)iso_laz_integer_by(&p->coder, &p->now.bytes1, &p->bytes[k], 8, last[k])
                      : iso_laz_byte_next(&p->bytes[k], &p->coder, last[k]);
}

static void next_item(pointwise *p, const iso_laz_item *item, unsigned char *last) {
    const bool first_version = item->version == 1;
    switch (item->type) {
    case ISO_LAZ_POINT10:
        if (first_version)
            iso_laz_point1_next(&p->now.point1, &p->coder, last);
        else
            next_point(&p->now.point, &p->coder, last);
        break;
    case ISO_LAZ_GPSTIME11:
        if (first_version)
            iso_laz_time1_next(&p->now.time1, &p->coder, last);
        else
            next_time(p, last);
        break;
    case ISO_LAZ_RGB12:
        if (first_version)
            iso_laz_color1_next(&p->now.color1, &p->coder, last);
        else
            next_color(p, last);
        break;
    case ISO_LAZ_WAVEPACKET13:
        iso_laz_wave_next(&p->now.wave, &p->coder, last);
        break;
    default:
        next_bytes(p, item, last);
    }
}

static void next_record(pointwise *p) {
    unsigned char *last = p->last;
    for (int i = 0; i < p->layout->count; last += p->layout->items[i++].bytes)
        next_item(p, &p->layout->items[i], last);
}

/* ---- chunks */

static void *make(const iso_laz_layout *layout) {
    size_t bytes = 0;
    for (int i = 0; i < layout->count; i++)
        if (layout->items[i].type == ISO_LAZ_BYTES) bytes = layout->items[i].bytes;
    const size_t models = sizeof(state) / sizeof(iso_laz_model) + bytes;
    const size_t room = models * ISO_LAZ_ROOM + 2 * ISO_LAZ_MOST_ROOM;
    pointwise *p = iso_alloc(sizeof *p + bytes * sizeof(iso_laz_model) + room * sizeof(uint16_t));
    if (!p) return NULL;
    p->layout = layout;
    p->bytes = (iso_laz_model *)(p + 1);
    p->byte_count = bytes;
    p->memory.numbers = (uint16_t *)(p->bytes + bytes);
    return p;
}

static bool begin(void *decoder, const unsigned char *bytes, size_t count) {
    pointwise *p = decoder;
    const size_t record = p->layout->record;
    if (count < record) return false;
    memset(&p->now, 0, sizeof p->now);
    memset(p->bytes, 0, p->byte_count * sizeof *p->bytes);
    p->memory.used = 0;
    memcpy(p->last, bytes, record);
    for (size_t i = 0, at = 0; i < (size_t)p->layout->count; at += p->layout->items[i++].bytes)
        if (p->layout->items[i].type == ISO_LAZ_GPSTIME11) memcpy(p->now.time.times, bytes + at, 8);
    iso_laz_begin(&p->coder, &p->memory, bytes + record, count - record);
    if (count == record) p->coder.faults = 0; /* one point may be all */
    return true;
}

static bool next(void *decoder, unsigned char *records, size_t points) {
    pointwise *p = decoder;
    const size_t record = p->layout->record;
    for (size_t i = 0; i < points; i++, records += record) {
        if (p->now.begun) next_record(p);
        p->now.begun = true;
        memcpy(records, p->last, record);
    }
    return p->coder.faults == 0;
}

static bool ends(const void *decoder) {
    const pointwise *p = decoder;
    return p->coder.at == p->coder.end;
}

const iso_laz_decoder iso_laz_pointwise = {make, begin, next, ends};
