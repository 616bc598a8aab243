/* tiff_write: pictures as TIFF 6.0, little-endian, without a library: one directory of tags, and strips of
 * rows compressed by deflate (compression 8 of Adobe's supplement) with horizontal differences. */
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "image/image_file.h"

enum { STRIP_BYTES = 1 << 18 };

/* Types of TIFF values. */
typedef enum tag_type { TYPE_ASCII = 2, TYPE_SHORT = 3, TYPE_LONG = 4, TYPE_RATIONAL = 5 } tag_type;

typedef struct bytes {
    uint8_t *data;
    size_t size, room;
} bytes;

typedef struct tiff_writer {
    const iso_image *image;
    int channels, rows; /* rows: of a strip */
    size_t strips;
    uint32_t *offsets, *sizes; /* of the strips */
    uint8_t *raw, *packed;     /* a strip */
    uLong packed_room;
    bytes pixels, tags, values; /* all strips; entries of the directory, and what they point to */
    int tag_count;
} tiff_writer;

static bool add(bytes *b, const void *data, size_t size) {
    if (b->size + size > b->room) {
        const size_t room = 2 * (b->size + size) + 256;
        uint8_t *more = iso_alloc(room);
        if (!more) return false;
        if (b->size) memcpy(more, b->data, b->size);
        iso_free(b->data);
        b->data = more;
        b->room = room;
    }
    memcpy(b->data + b->size, data, size);
    b->size += size;
    return true;
}

static void put16(uint8_t *to, unsigned value) {
    to[0] = (uint8_t)value;
    to[1] = (uint8_t)(value >> 8);
}

static void put32(uint8_t *to, uint32_t value) {
    put16(to, value & 0xffff);
    put16(to + 2, value >> 16);
}

static uint32_t get32(const uint8_t *from) {
    return from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static size_t type_size(tag_type type) {
    return type == TYPE_ASCII ? 1 : type == TYPE_SHORT ? 2 : type == TYPE_LONG ? 4 : 8;
}

/* Adds a tag whose `count` values are encoded already. Tags are added in the order of their numbers.
 * Values of more than four bytes lie behind the directory, at offsets from `values`: added to its place
 * when it is known. */
static bool add_encoded(tiff_writer *w, unsigned number, tag_type type, uint32_t count, const void *values) {
    const size_t size = type_size(type) * count;
    uint8_t entry[12] = {0};
    put16(entry, number);
    put16(entry + 2, type);
    put32(entry + 4, count);
    if (size <= 4)
        memcpy(entry + 8, values, size);
    else {
        put32(entry + 8, (uint32_t)w->values.size);
        if (!add(&w->values, values, size) || (size % 2 && !add(&w->values, "", 1))) return false;
    }
    w->tag_count++;
    return add(&w->tags, entry, sizeof entry);
}

static bool add_number(tiff_writer *w, unsigned number, tag_type type, uint32_t value) {
    uint8_t encoded[8] = {0};
    put32(encoded, value); /* of a short the first two bytes */
    return add_encoded(w, number, type, 1, encoded);
}

static bool add_numbers(tiff_writer *w, unsigned number, const uint32_t *values, size_t count) {
    uint8_t *encoded = iso_alloc(4 * count);
    if (!encoded) return false;
    for (size_t i = 0; i < count; i++) put32(encoded + 4 * i, values[i]);
    const bool good = add_encoded(w, number, TYPE_LONG, (uint32_t)count, encoded);
    iso_free(encoded);
    return good;
}

/* A text of the options, by the key that PNG has for it; none: no tag. */
static bool add_text(tiff_writer *w, unsigned number, const iso_png_opts *opts, const char *key) {
    for (int i = 0; i < opts->text_count; i++) {
        if (strcmp(opts->texts[i].key, key) != 0) continue;
        char *clean = iso_text_clean_copy(opts->texts[i].value);
        const bool good = clean && add_encoded(w, number, TYPE_ASCII, (uint32_t)strlen(clean) + 1, clean);
        free(clean);
        return good;
    }
    return true;
}

/* Pixels per centimetre, as a fraction of 1000. */
static bool add_resolution(tiff_writer *w, unsigned number, double pixels_per_metre) {
    uint8_t fraction[8];
    put32(fraction, (uint32_t)(pixels_per_metre * 10 + 0.5));
    put32(fraction + 4, 1000);
    return add_encoded(w, number, TYPE_RATIONAL, 1, fraction);
}

static bool has_resolution(const iso_png_opts *opts) {
    return opts->pixels_per_metre >= 0.1 && opts->pixels_per_metre < 4e8;
}

static bool make_tags(tiff_writer *w, const iso_png_opts *opts) {
    const uint8_t bits[8] = {8, 0, 8, 0, 8, 0, 8, 0}; /* of each channel */
    bool good = add_number(w, 256, TYPE_LONG, (uint32_t)w->image->width) &&
                add_number(w, 257, TYPE_LONG, (uint32_t)w->image->height) &&
                add_encoded(w, 258, TYPE_SHORT, (uint32_t)w->channels, bits) && /* BitsPerSample */
                add_number(w, 259, TYPE_SHORT, 8) &&                            /* Compression: deflate */
                add_number(w, 262, TYPE_SHORT, 2) &&                            /* Photometric: RGB */
                add_text(w, 269, opts, "Title") &&                              /* DocumentName */
                add_text(w, 270, opts, "Comment") &&                            /* ImageDescription */
                add_numbers(w, 273, w->offsets, w->strips) && add_number(w, 274, TYPE_SHORT, 1) &&
                add_number(w, 277, TYPE_SHORT, (uint32_t)w->channels) &&
                add_number(w, 278, TYPE_LONG, (uint32_t)w->rows) && add_numbers(w, 279, w->sizes, w->strips);
    if (good && has_resolution(opts))
        good =
            add_resolution(w, 282, opts->pixels_per_metre) && add_resolution(w, 283, opts->pixels_per_metre);
    good = good && add_number(w, 284, TYPE_SHORT, 1); /* PlanarConfiguration: pixel by pixel */
    if (good && has_resolution(opts)) good = add_number(w, 296, TYPE_SHORT, 3); /* in centimetres */
    good = good && add_text(w, 305, opts, "Software") && add_number(w, 317, TYPE_SHORT, 2); /* Predictor */
    return good && (w->channels == 3 || add_number(w, 338, TYPE_SHORT, 2)); /* ExtraSamples: straight alpha */
}

/* The rows of a strip as they are compressed: each pixel less the one to its left. */
static size_t difference_rows(tiff_writer *w, int first, int count) {
    const size_t width = (size_t)w->image->width, channels = (size_t)w->channels;
    uint8_t *to = w->raw;
    for (int y = first; y < first + count; y++) {
        const uint8_t *row = w->image->rgba + 4 * width * (size_t)y;
        for (size_t x = 0; x < width; x++)
            for (size_t c = 0; c < channels; c++)
                *to++ = (uint8_t)(row[4 * x + c] - (x ? row[4 * (x - 1) + c] : 0));
    }
    return (size_t)(to - w->raw);
}

enum { HEADER = 8 };

/* Compresses all strips; they will lie behind the header. */
static iso_status pack_strips(tiff_writer *w, const char *path, iso_error *error) {
    for (size_t i = 0; i < w->strips; i++) {
        const int first = (int)i * w->rows, left = w->image->height - first;
        const size_t size = difference_rows(w, first, left < w->rows ? left : w->rows);
        uLong packed = w->packed_room;
        if (compress2(w->packed, &packed, w->raw, (uLong)size, 6) != Z_OK)
            return iso_fail_memory(error, path);
        if (w->pixels.size + packed > UINT32_MAX - (1u << 24))
            return iso_fail(error, ISO_ERR_LIMIT, "%s: more than a TIFF of 4 GB holds: name a .png", path);
        w->offsets[i] = HEADER + (uint32_t)w->pixels.size;
        w->sizes[i] = (uint32_t)packed;
        if (!add(&w->pixels, w->packed, packed)) return iso_fail_memory(error, path);
    }
    return w->pixels.size % 2 && !add(&w->pixels, "", 1) ? iso_fail_memory(error, path) : ISO_OK;
}

/* Adds the place of `values` to the offsets of the directory's entries. */
static void place_values(tiff_writer *w, uint32_t place) {
    for (size_t i = 0; i < w->tags.size; i += 12) {
        uint8_t *entry = w->tags.data + i;
        if (type_size((tag_type)entry[2]) * get32(entry + 4) > 4) put32(entry + 8, place + get32(entry + 8));
    }
}

static void write_file(tiff_writer *w, FILE *stream) {
    const uint32_t directory = HEADER + (uint32_t)w->pixels.size;
    uint8_t header[HEADER] = {'I', 'I', 42, 0}, count[2], end[4] = {0};
    put32(header + 4, directory);
    put16(count, (unsigned)w->tag_count);
    place_values(w, directory + 2 + (uint32_t)w->tags.size + 4);
    fwrite(header, 1, sizeof header, stream);
    fwrite(w->pixels.data, 1, w->pixels.size, stream);
    fwrite(count, 1, sizeof count, stream);
    fwrite(w->tags.data, 1, w->tags.size, stream);
    fwrite(end, 1, sizeof end, stream);
    fwrite(w->values.data, 1, w->values.size, stream);
}

static iso_status create_writer(tiff_writer *w, const char *path, iso_error *error) {
    w->channels = iso_image_is_opaque(w->image) ? 3 : 4;
    const size_t row = (size_t)w->image->width * (size_t)w->channels;
    w->rows = row < STRIP_BYTES ? (int)(STRIP_BYTES / row) : 1;
    if (w->rows > w->image->height) w->rows = w->image->height;
    w->strips = ((size_t)w->image->height + (size_t)w->rows - 1) / (size_t)w->rows;
    w->packed_room = compressBound((uLong)(row * (size_t)w->rows));
    w->raw = iso_alloc(row * (size_t)w->rows);
    w->packed = iso_alloc(w->packed_room);
    w->offsets = iso_alloc_zero(w->strips, sizeof *w->offsets);
    w->sizes = iso_alloc_zero(w->strips, sizeof *w->sizes);
    return w->raw && w->packed && w->offsets && w->sizes ? ISO_OK : iso_fail_memory(error, path);
}

static void free_writer(tiff_writer *w) {
    iso_free(w->raw);
    iso_free(w->packed);
    iso_free(w->offsets);
    iso_free(w->sizes);
    iso_free(w->pixels.data);
    iso_free(w->tags.data);
    iso_free(w->values.data);
}

iso_status iso_tiff_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                          iso_error *error) {
    tiff_writer w = {.image = image};
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_status status = create_writer(&w, path, error);
    if (status == ISO_OK) status = pack_strips(&w, path, error);
    if (status == ISO_OK && !make_tags(&w, opts)) status = iso_fail_memory(error, path);
    if (status == ISO_OK) write_file(&w, sink.stream);
    free_writer(&w);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}
