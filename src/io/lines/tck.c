/* tck: streamlines as MRtrix3 writes them (documentation of MRtrix3, "Tracks file format (.tck)"): a text
 * header, then triples of floats, RAS mm. A triple of NaN ends a line, one of infinities the file.
 *
 * The header's count is not used: it is written before the lines and often wrong. Bytes after the triple of
 * infinities are ignored. A file without it was cut off: ISO_ERR_IO. */
#include "io/lines/lines_format.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/common/line_sink.h"
#include "io/common/stream.h"

enum { LINE_ROOM = 512, HEADER_MOST = 1 << 24 };

typedef struct tck {
    iso_stream in;
    iso_line_sink lines;
    size_t value; /* bytes of a number: 4 or 8 */
    bool swap;    /* the file's byte order is not the machine's */
    bool ended;   /* the triple of infinities, which ends the file, has been read */
    uint64_t offset, header_bytes;
    uint64_t triples,
        line_begin; /* number of triples before the buffer; number of the open line's first triple */
} tck;

/* ---- header */

static iso_status fail_header(const tck *t, const char *problem, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged .tck header: %s", t->in.path, problem);
}

/* Reads a line of the header, cut at LINE_ROOM - 1 bytes and without blanks at its end. */
static iso_status read_line(tck *t, char line[LINE_ROOM], iso_error *error) {
    size_t length = 0;
    int byte;
    while ((byte = iso_stream_byte(&t->in)) != '\n') {
        if (byte < 0) return fail_header(t, "no line END", error);
        if (++t->header_bytes > HEADER_MOST) return fail_header(t, "it does not end", error);
        if (length + 1 < LINE_ROOM) line[length++] = (char)byte;
    }
    t->header_bytes++;
    while (length && strchr(" \t\r", line[length - 1])) length--;
    line[length] = 0;
    return ISO_OK;
}

static iso_status take_type(tck *t, const char *name, iso_error *error) {
    static const struct {
        const char *name;
        size_t value;
        bool big;
    } types[] = {{"Float32LE", 4, false}, {"Float32BE", 4, true}, {"Float64LE", 8, false},
                 {"Float64BE", 8, true},  {"Float32", 4, false},  {"Float64", 8, false}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(name, types[i].name) == 0) {
            t->value = types[i].value;
            t->swap = types[i].big == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
            return ISO_OK;
        }
    return iso_fail(error, ISO_ERR_FORMAT, "%s: tracks of type '%.40s', not Float32 or Float64", t->in.path,
                    name);
}

/* Reads a value such as ". 67" of the key "file": the tracks begin at byte 67 of this file. */
static iso_status take_offset(tck *t, const char *text, iso_error *error) {
    char *end;
    errno = 0;
    if (text[0] != '.' || (text[1] != ' ' && text[1] != '\t'))
        return fail_header(t, "its tracks are in another file", error);
    const unsigned long long offset = strtoull(text + 1, &end, 10);
    if (errno || *end || end == text + 1 || strchr(text, '-'))
        return fail_header(t, "the position of its tracks is no number", error);
    t->offset = offset;
    return ISO_OK;
}

/* Returns the value of a line "key: value", or NULL if the line has another key. */
static const char *value_of(const char *line, const char *key) {
    const size_t length = strlen(key);
    if (strncmp(line, key, length) != 0 || line[length] != ':') return NULL;
    line += length + 1;
    return line + strspn(line, " \t");
}

static iso_status read_header(tck *t, iso_error *error) {
    char line[LINE_ROOM];
    if (!iso_stream_fill(&t->in, 12) || memcmp(t->in.buffer, "mrtrix track", 12) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a .tck file", t->in.path);
    ISO_TRY(read_line(t, line, error));
    for (;;) {
        ISO_TRY(read_line(t, line, error));
        const char *type = value_of(line, "datatype"), *file = value_of(line, "file");
        if (strcmp(line, "END") == 0) break;
        if (type) ISO_TRY(take_type(t, type, error));
        if (file) ISO_TRY(take_offset(t, file, error));
    }
    if (!t->value) return fail_header(t, "no datatype", error);
    if (!t->offset) return fail_header(t, "no position of the tracks", error);
    if (t->offset < t->header_bytes) return fail_header(t, "its tracks begin within the header", error);
    return iso_stream_skip(&t->in, t->offset - t->header_bytes, error);
}

/* ---- tracks */

/* Handles triple `number`, which is not a vertex: ends the line or the file, or splits the line. */
static iso_status take_special(tck *t, uint64_t number, const double p[3], iso_error *error) {
    iso_read_report *report = t->lines.reading->report;
    const bool delimits = isnan(p[0]) && isnan(p[1]) && isnan(p[2]);
    t->ended = isinf(p[0]) && isinf(p[1]) && isinf(p[2]);
    if (!delimits && !t->ended) report->dropped += !t->lines.skips;
    ISO_TRY(iso_line_sink_split(&t->lines, error));
    if (t->ended && number == t->line_begin) report->items--; /* the last line was already ended by NaN */
    if (!delimits) return ISO_OK;
    t->line_begin = number + 1;
    iso_line_sink_begin(&t->lines);
    return ISO_OK;
}

static uint32_t load_bits(const unsigned char *bytes, bool swap) {
    uint32_t bits;
    memcpy(&bits, bytes, sizeof bits);
    return swap ? __builtin_bswap32(bits) : bits;
}

static float to_float(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double load_double(const unsigned char *bytes, bool swap) {
    uint64_t bits;
    double value;
    memcpy(&bits, bytes, sizeof bits);
    if (swap) bits = __builtin_bswap64(bits);
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Reads triples of floats without converting them to doubles, because large files consist of them. 0x5368d4a5
 * are the bits of 1e12; infinities and NaN have larger ones. */
static iso_status take_floats(tck *t, const unsigned char *bytes, size_t triples, iso_error *error) {
    const uint32_t sign = t->lines.ras ? 0x80000000u : 0, farthest = 0x5368d4a5u, size = 0x7fffffffu;
    for (size_t i = 0; i < triples && !t->ended; i++, bytes += 12) {
        const uint32_t x = load_bits(bytes, t->swap), y = load_bits(bytes + 4, t->swap),
                       z = load_bits(bytes + 8, t->swap);
        if ((x & size) > farthest || (y & size) > farthest || (z & size) > farthest) {
            const double p[3] = {(double)to_float(x), (double)to_float(y), (double)to_float(z)};
            ISO_TRY(take_special(t, t->triples + i, p, error));
            continue;
        }
        if (t->lines.skips) continue;
        const uint32_t vertex[3] = {x ^ sign, y ^ sign, z};
        memcpy((float *)t->lines.vertices.data + 3 * t->lines.vertex_count++, vertex, sizeof vertex);
    }
    return ISO_OK;
}

static iso_status take_doubles(tck *t, const unsigned char *bytes, size_t triples, iso_error *error) {
    for (size_t i = 0; i < triples && !t->ended; i++, bytes += 24) {
        double p[3];
        for (size_t axis = 0; axis < 3; axis++) p[axis] = load_double(bytes + 8 * axis, t->swap);
        const bool finite = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
        if (finite && (t->lines.skips || iso_line_sink_vertex(&t->lines, p))) continue;
        ISO_TRY(take_special(t, t->triples + i, p, error));
    }
    return ISO_OK;
}

static iso_status read_tracks(tck *t, iso_error *error) {
    const size_t each = 3 * t->value;
    if (t->lines.reading->opts.every == 1)
        ISO_TRY(iso_line_sink_reserve(&t->lines, (size_t)(t->in.remaining / each), error));
    iso_line_sink_begin(&t->lines);
    while (!t->ended) {
        if (!iso_stream_fill(&t->in, each)) return iso_stream_fail(&t->in, error);
        const unsigned char *bytes = t->in.buffer + t->in.place;
        const size_t triples = (t->in.end - t->in.place) / each;
        ISO_TRY(iso_line_sink_reserve(&t->lines, triples, error));
        ISO_TRY(t->value == 4 ? take_floats(t, bytes, triples, error)
                              : take_doubles(t, bytes, triples, error));
        iso_stream_advance(&t->in, triples * each);
        t->triples += triples;
    }
    return ISO_OK;
}

static iso_status read_tck(tck *t, iso_reading *reading, iso_lines *lines, iso_error *error) {
    reading->report->unit = ISO_WORLD_UNIT_MILLIMETRE;
    t->lines = (iso_line_sink){.reading = reading, .ras = iso_reading_is_ras(reading, ISO_SPACE_RAS)};
    ISO_TRY(iso_stream_open(reading->path, &t->in, error));
    ISO_TRY(read_header(t, error));
    ISO_TRY(read_tracks(t, error));
    return iso_line_sink_finish(&t->lines, lines, error);
}

iso_status iso_lines_read_tck(iso_reading *reading, iso_lines *lines, iso_error *error) {
    tck *t = iso_alloc_zero(1, sizeof *t);
    if (!t) return iso_fail_memory(error, reading->path);
    iso_status status = read_tck(t, reading, lines, error);
    iso_stream_close(&t->in);
    iso_line_sink_free(&t->lines);
    iso_free(t);
    return status;
}
