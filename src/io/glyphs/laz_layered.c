/* laz_layered: chunks of point formats 6 to 10, in which each number of the points is coded by itself: a
 * layer (items of versions 3 and 4). A layer without bytes says that the number does not change. Each of the
 * scanner's four channels has models of its own. The first point is not coded. Waveforms are skipped. */
#include <string.h>

#include "base/memory.h"
#include "io/glyphs/laz_items.h"

/* Layers of POINT14, in their order. */
enum { RETURNS_XY, HEIGHT, CLASS, FLAGS, INTENSITY, ANGLE, USER, SOURCE, TIME, LAYERS, CHANNELS = 4 };

/* The numbers of a point that are in the records' first 30 bytes. */
typedef struct point14 {
    uint32_t x, y, z;
    uint16_t intensity, angle, source;
    uint8_t number, returns, flags, class, user; /* flags: those of the class, then direction and edge */
    uint64_t time;
} point14;

/* A channel. All zero but what begin_channel sets. */
typedef struct channel {
    bool begun, time_changed;
    point14 last;
    iso_laz_model changed[8], other_channel, returns[16], number[16], number_of_same_time;
    iso_laz_model classes[64], flags[64], users[64];
    iso_laz_integers dx, dy, z, intensity, angle, source;
    iso_laz_median x_steps[12], y_steps[12];
    uint32_t heights[8];
    uint16_t intensities[8];
    iso_laz_time time;
} channel;

/* The same of colours. */
typedef struct color_channel {
    bool begun;
    uint16_t last[4];
    iso_laz_color color;
    iso_laz_model infrared_used, infrared[2];
} color_channel;

typedef struct state {
    bool begun; /* the first point has been given */
    unsigned current, current_color, current_bytes;
    channel channels[CHANNELS];
    color_channel colors[CHANNELS];
    bool bytes_begun[CHANNELS];
} state;

typedef struct layered {
    const iso_laz_layout *layout;
    iso_laz_memory memory;
    state now;
    iso_laz_coder layers[LAYERS], color, infrared;
    bool has[LAYERS], has_color, has_infrared;
    size_t byte_count; /* extra bytes of a record, each of which has a layer */
    iso_laz_coder *byte_layers;
    iso_laz_model *byte_models; /* byte_count of each channel */
    unsigned char first[ISO_LAZ_RECORD], byte_last[CHANNELS][ISO_LAZ_RECORD];
    bool byte_has[ISO_LAZ_RECORD];
} layered;

/* Contexts for the numbers `return of returns`: points of a beam that are alike. */
static const uint8_t return_contexts[16][16] = {
    {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5}, {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
    {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3}, {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5}};

/* ---- records */

static void unpack_point(point14 *p, const unsigned char *record) {
    memcpy(&p->x, record, 4);
    memcpy(&p->y, record + 4, 4);
    memcpy(&p->z, record + 8, 4);
    memcpy(&p->intensity, record + 12, 2);
    p->number = record[14] & 15;
    p->returns = record[14] >> 4;
    p->flags = (uint8_t)((record[15] & 15) | (record[15] >> 2 & 48));
    p->class = record[16];
    p->user = record[17];
    memcpy(&p->angle, record + 18, 2);
    memcpy(&p->source, record + 20, 2);
    memcpy(&p->time, record + 22, 8);
}

static void pack_point(const point14 *p, unsigned scanner, unsigned char *record) {
    memcpy(record, &p->x, 4);
    memcpy(record + 4, &p->y, 4);
    memcpy(record + 8, &p->z, 4);
    memcpy(record + 12, &p->intensity, 2);
    record[14] = (uint8_t)(p->number | p->returns << 4);
    record[15] = (uint8_t)((p->flags & 15) | scanner << 4 | (p->flags & 48) << 2);
    record[16] = p->class;
    record[17] = p->user;
    memcpy(record + 18, &p->angle, 2);
    memcpy(record + 20, &p->source, 2);
    memcpy(record + 22, &p->time, 8);
}

/* ---- POINT14 */

/* Begins a channel with a point. */
static void begin_channel(channel *c, const point14 *last) {
    c->begun = true;
    c->last = *last;
    for (int i = 0; i < 8; i++) c->heights[i] = last->z;
    for (int i = 0; i < 8; i++) c->intensities[i] = last->intensity;
    c->time.times[0] = last->time;
}

/* Reads what changes, and goes to the channel of the point. */
static channel *next_channel(layered *l, uint32_t *changed) {
    iso_laz_coder *coder = &l->layers[RETURNS_XY];
    channel *c = &l->now.channels[l->now.current];
    const unsigned context = (c->last.number == 1) | (unsigned)(c->last.number >= c->last.returns) << 1 |
                             (unsigned)c->time_changed << 2;
    *changed = iso_laz_symbol(coder, &c->changed[context], 128);
    if (!(*changed & 64)) return c;
    l->now.current = (l->now.current + iso_laz_symbol(coder, &c->other_channel, 3) + 1) % CHANNELS;
    channel *other = &l->now.channels[l->now.current];
    if (!other->begun) begin_channel(other, &c->last);
    return other;
}

static void next_returns(channel *c, iso_laz_coder *coder, uint32_t changed) {
    point14 *p = &c->last;
    const bool time_changed = changed & 16;
    if (changed & 4) p->returns = (uint8_t)iso_laz_symbol(coder, &c->returns[p->returns], 16);
    const uint32_t how = changed & 3;
    if (how == 1) p->number = (p->number + 1) % 16;
    if (how == 2) p->number = (p->number + 15) % 16;
    if (how == 3 && time_changed) p->number = (uint8_t)iso_laz_symbol(coder, &c->number[p->number], 16);
    if (how == 3 && !time_changed)
        p->number = (uint8_t)((p->number + iso_laz_symbol(coder, &c->number_of_same_time, 13) + 2) % 16);
}

static void next_place(layered *l, channel *c, bool time_changed) {
    point14 *p = &c->last;
    iso_laz_coder *coder = &l->layers[RETURNS_XY];
    const unsigned steps = 2U * return_contexts[p->returns][p->number] + time_changed;
    const uint32_t single = p->returns == 1;

    const uint32_t dx = iso_laz_integer(coder, &c->dx, 32, iso_laz_median_get(&c->x_steps[steps]), single);
    iso_laz_median_add(&c->x_steps[steps], (int32_t)dx);
    p->x += dx;

    uint32_t size = c->dx.size;
    const uint32_t dy = iso_laz_integer(coder, &c->dy, 32, iso_laz_median_get(&c->y_steps[steps]),
                                        single + (size < 20 ? size & ~1U : 20));
    iso_laz_median_add(&c->y_steps[steps], (int32_t)dy);
    p->y += dy;

    if (!l->has[HEIGHT]) return;
    int level = p->returns > p->number ? p->returns - p->number : p->number - p->returns;
    if (level > 7) level = 7;
    size = (c->dx.size + c->dy.size) / 2;
    p->z = c->heights[level] = iso_laz_integer(&l->layers[HEIGHT], &c->z, 32, c->heights[level],
                                               single + (size < 18 ? size & ~1U : 18));
}

static void next_attributes(layered *l, channel *c, uint32_t changed) {
    point14 *p = &c->last;
    const bool time_changed = changed & 16;
    const unsigned of_beam = (unsigned)(p->number == 1) << 1 | (p->number >= p->returns);
    if (l->has[CLASS]) {
        const unsigned context = (p->class & 31U) << 1 | (of_beam == 3);
        p->class = (uint8_t)iso_laz_symbol(&l->layers[CLASS], &c->classes[context], 256);
    }
    if (l->has[FLAGS]) p->flags = (uint8_t)iso_laz_symbol(&l->layers[FLAGS], &c->flags[p->flags], 64);
    if (l->has[INTENSITY]) {
        uint16_t *last = &c->intensities[of_beam << 1 | time_changed];
        *last = (uint16_t)iso_laz_integer(&l->layers[INTENSITY], &c->intensity, 16, *last, of_beam);
        p->intensity = *last;
    }
    if (l->has[ANGLE] && changed & 8)
        p->angle = (uint16_t)iso_laz_integer(&l->layers[ANGLE], &c->angle, 16, p->angle, time_changed);
    if (l->has[USER]) p->user = (uint8_t)iso_laz_symbol(&l->layers[USER], &c->users[p->user / 4], 256);
    if (l->has[SOURCE] && changed & 32)
        p->source = (uint16_t)iso_laz_integer(&l->layers[SOURCE], &c->source, 16, p->source, 0);
    if (l->has[TIME] && time_changed) p->time = iso_laz_time_next(&c->time, &l->layers[TIME], true);
}

/* Decodes a point; returns whether it is of another channel than the last one. */
static bool next_point(layered *l, unsigned char *record) {
    uint32_t changed;
    channel *c = next_channel(l, &changed);
    next_returns(c, &l->layers[RETURNS_XY], changed);
    next_place(l, c, changed & 16);
    next_attributes(l, c, changed);
    c->time_changed = changed & 16;
    pack_point(&c->last, l->now.current, record);
    return changed & 64;
}

/* ---- the other items */

/* Items of version 3 keep the last values of the channel that they leave, unless they begin the other one
 * with these: a fault of the first encoder, which version 4 has not. */
static unsigned last_of(int version, unsigned before, unsigned now, bool begins) {
    return version < 4 && !begins ? before : now;
}

static void next_color(layered *l, const iso_laz_item *item, unsigned scanner, unsigned char *record) {
    const unsigned before = l->now.current_color;
    color_channel *c = &l->now.colors[scanner];
    const bool begins = !c->begun;
    if (begins) memcpy(c->last, l->now.colors[before].last, sizeof c->last);
    c->begun = true;
    l->now.current_color = scanner;
    uint16_t *last = l->now.colors[last_of(item->version, before, scanner, begins)].last;
    if (l->has_color) iso_laz_color_next(&c->color, &l->color, last);
    if (l->has_infrared) {
        const uint32_t used = iso_laz_symbol(&l->infrared, &c->infrared_used, 4);
        unsigned low = last[3] & 255, high = last[3] >> 8;
        if (used & 1) low = iso_laz_byte_next(&c->infrared[0], &l->infrared, low);
        if (used & 2) high = iso_laz_byte_next(&c->infrared[1], &l->infrared, high);
        last[3] = (uint16_t)(low | high << 8);
    }
    memcpy(record, last, item->bytes);
}

static void next_bytes(layered *l, const iso_laz_item *item, unsigned scanner, unsigned char *record) {
    const unsigned before = l->now.current_bytes;
    const bool begins = !l->now.bytes_begun[scanner];
    if (begins) memcpy(l->byte_last[scanner], l->byte_last[before], item->bytes);
    l->now.bytes_begun[scanner] = true;
    l->now.current_bytes = scanner;
    uint8_t *last = l->byte_last[last_of(item->version, before, scanner, begins)];
    iso_laz_model *models = l->byte_models + scanner * l->byte_count;
    for (size_t k = 0; k < item->bytes; k++)
        if (l->byte_has[k]) last[k] = iso_laz_byte_next(&models[k], &l->byte_layers[k], last[k]);
    memcpy(record, last, item->bytes);
}

static void next_record(layered *l, unsigned char *record) {
    const bool other = next_point(l, record);
    /* items beside those of version 3 take points that stay in their channel for ones of channel 0 */
    const bool known = other || l->layout->items[0].version >= 4;
    const unsigned scanner = known ? l->now.current : 0;
    for (int i = 1; i < l->layout->count; i++) {
        const iso_laz_item *item = &l->layout->items[i];
        record += l->layout->items[i - 1].bytes;
        if (item->type == ISO_LAZ_RGB14 || item->type == ISO_LAZ_RGBNIR14)
            next_color(l, item, scanner, record);
        if (item->type == ISO_LAZ_BYTES14) next_bytes(l, item, scanner, record);
        if (item->type == ISO_LAZ_WAVEPACKET14) memset(record, 0, item->bytes);
    }
}

/* ---- chunks */

static void *make(const iso_laz_layout *layout) {
    size_t bytes = 0;
    for (int i = 0; i < layout->count; i++)
        if (layout->items[i].type == ISO_LAZ_BYTES14) bytes = layout->items[i].bytes;
    const size_t models = sizeof(state) / sizeof(iso_laz_model) + CHANNELS * bytes;
    const size_t room = models * ISO_LAZ_ROOM + 2 * CHANNELS * ISO_LAZ_MOST_ROOM;
    layered *l = iso_alloc(sizeof *l + bytes * sizeof(iso_laz_coder) +
                           CHANNELS * bytes * sizeof(iso_laz_model) + room * sizeof(uint16_t));
    if (!l) return NULL;
    l->layout = layout;
    l->byte_count = bytes;
    l->byte_layers = (iso_laz_coder *)(l + 1);
    l->byte_models = (iso_laz_model *)(l->byte_layers + bytes);
    l->memory.numbers = (uint16_t *)(l->byte_models + CHANNELS * bytes);
    return l;
}

/* The sizes of layers that are read next, and their bytes. */
typedef struct reader {
    const unsigned char *sizes, *layers, *end;
} reader;

/* Begins the next layer; *has: it has bytes. */
static bool begin_layer(layered *l, reader *r, iso_laz_coder *coder, bool *has) {
    const size_t bytes = iso_laz_load32(r->sizes);
    r->sizes += 4;
    *has = bytes > 0;
    if (bytes > (size_t)(r->end - r->layers)) return false;
    iso_laz_begin(coder, &l->memory, r->layers, bytes);
    if (!*has) coder->faults = 0;
    r->layers += bytes;
    return true;
}

static int count_layers(const iso_laz_item *item) {
    switch (item->type) {
    case ISO_LAZ_POINT14:
        return LAYERS;
    case ISO_LAZ_RGBNIR14:
        return 2;
    case ISO_LAZ_BYTES14:
        return (int)item->bytes;
    default:
        return 1;
    }
}

static bool begin_layers(layered *l, reader *r, const iso_laz_item *item) {
    iso_laz_coder skipped;
    bool good = true, has;
    switch (item->type) {
    case ISO_LAZ_POINT14:
        for (int i = 0; i < LAYERS; i++) good = good && begin_layer(l, r, &l->layers[i], &l->has[i]);
        return good;
    case ISO_LAZ_RGB14:
        return begin_layer(l, r, &l->color, &l->has_color);
    case ISO_LAZ_RGBNIR14:
        return begin_layer(l, r, &l->color, &l->has_color) &&
               begin_layer(l, r, &l->infrared, &l->has_infrared);
    case ISO_LAZ_BYTES14:
        for (size_t i = 0; i < item->bytes; i++)
            good = good && begin_layer(l, r, &l->byte_layers[i], &l->byte_has[i]);
        return good;
    default:
        return begin_layer(l, r, &skipped, &has);
    }
}

/* Begins the channel of the first point. */
static void begin_items(layered *l, const unsigned char *record) {
    const unsigned scanner = record[15] >> 4 & 3;
    point14 first;
    unpack_point(&first, record);
    begin_channel(&l->now.channels[scanner], &first);
    l->now.current = l->now.current_color = l->now.current_bytes = scanner;
    l->now.colors[scanner].begun = l->now.bytes_begun[scanner] = true;
    for (int i = 0; i < l->layout->count; record += l->layout->items[i++].bytes) {
        const iso_laz_item *item = &l->layout->items[i];
        if (item->type == ISO_LAZ_RGB14 || item->type == ISO_LAZ_RGBNIR14)
            memcpy(l->now.colors[scanner].last, record, item->bytes);
        if (item->type == ISO_LAZ_BYTES14) memcpy(l->byte_last[scanner], record, item->bytes);
    }
}

static bool begin(void *decoder, const unsigned char *bytes, size_t count) {
    enum { COUNT = 4 }; /* bytes of the number of points, which the chunk table says */
    layered *l = decoder;
    const size_t record = l->layout->record;
    size_t sizes = 0;
    for (int i = 0; i < l->layout->count; i++) sizes += 4 * (size_t)count_layers(&l->layout->items[i]);
    memset(&l->now, 0, sizeof l->now);
    memset(l->byte_models, 0, CHANNELS * l->byte_count * sizeof *l->byte_models);
    l->memory.used = 0;
    l->has_color = l->has_infrared = false;
    if (count < record + COUNT + sizes) return false;
    memcpy(l->first, bytes, record);
    begin_items(l, bytes);
    bytes += record + COUNT;
    reader r = {bytes, bytes + sizes, bytes - record - COUNT + count};
    for (int i = 0; i < l->layout->count; i++)
        if (!begin_layers(l, &r, &l->layout->items[i])) return false;
    return r.layers == r.end;
}

static bool is_sound(const layered *l) {
    uint32_t faults = 0;
    for (int i = 0; i < LAYERS; i++) faults |= l->layers[i].faults;
    if (l->has_color) faults |= l->color.faults;
    if (l->has_infrared) faults |= l->infrared.faults;
    for (size_t i = 0; i < l->byte_count; i++) faults |= l->byte_layers[i].faults;
    return faults == 0;
}

static bool next(void *decoder, unsigned char *records, size_t points) {
    layered *l = decoder;
    const size_t record = l->layout->record;
    for (size_t i = 0; i < points; i++, records += record) {
        if (l->now.begun)
            next_record(l, records);
        else
            memcpy(records, l->first, record);
        l->now.begun = true;
    }
    return is_sound(l);
}

static bool ends(const void *decoder) {
    const layered *l = decoder;
    bool all = true;
    for (int i = 0; i < LAYERS; i++) all = all && l->layers[i].at == l->layers[i].end;
    if (l->has_color) all = all && l->color.at == l->color.end;
    if (l->has_infrared) all = all && l->infrared.at == l->infrared.end;
    for (size_t i = 0; i < l->byte_count; i++) all = all && l->byte_layers[i].at == l->byte_layers[i].end;
    return all;
}

const iso_laz_decoder iso_laz_layered = {make, begin, next, ends};
