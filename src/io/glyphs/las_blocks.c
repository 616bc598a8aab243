/* las_blocks: units are stated in two ways: by the numbered keys of GeoTIFF (block 34735), or as text (block
 * 2112, "well-known text", OGC 01-009 and 18-010). */
#include "io/glyphs/las_blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/scalar_load.h"

enum { HEADER = 54 };

static uint64_t number_at(const unsigned char *bytes, iso_scalar scalar) {
    return (uint64_t)iso_scalar_load(bytes, scalar, false);
}

/* ---- units */

static iso_world_unit unit_of_metres(double metres) {
    if (fabs(metres - 1) < 1e-9) return ISO_WORLD_UNIT_METRE;
    if (fabs(metres - 0.3048) < 1e-9) return ISO_WORLD_UNIT_FOOT;
    return fabs(metres - 1200.0 / 3937) < 1e-9 ? ISO_WORLD_UNIT_SURVEY_FOOT : ISO_WORLD_UNIT_NONE;
}

/* The keys are four numbers of 16 bits each: key, place of the value, count, value. Place 0: the value
 * itself. */
static iso_world_unit unit_of_keys(const unsigned char *block, size_t bytes) {
    enum { MODEL = 1024, PROJECTED = 3072, LINEAR_UNIT = 3076, GEOGRAPHIC_MODEL = 2 };
    iso_world_unit unit = ISO_WORLD_UNIT_NONE;
    for (size_t at = 8; at + 8 <= bytes; at += 8) {
        uint64_t key[4];
        for (size_t k = 0; k < 4; k++) key[k] = number_at(block + at + 2 * k, ISO_SCALAR_UINT16);
        if (key[1] != 0) continue;
        if (key[0] == MODEL && key[3] == GEOGRAPHIC_MODEL) return ISO_WORLD_UNIT_DEGREE;
        /* zones of UTM (WGS 84, NAD83) are in metres; a key of its own, which follows, states others */
        if (key[0] == PROJECTED &&
            ((key[3] >= 32601 && key[3] <= 32760) || (key[3] >= 26901 && key[3] <= 26923)))
            unit = ISO_WORLD_UNIT_METRE;
        if (key[0] == LINEAR_UNIT)
            unit = key[3] == 9001   ? ISO_WORLD_UNIT_METRE
                   : key[3] == 9002 ? ISO_WORLD_UNIT_FOOT
                   : key[3] == 9003 ? ISO_WORLD_UNIT_SURVEY_FOOT
                                    : ISO_WORLD_UNIT_NONE;
    }
    return unit;
}

/* The end of the element that begins at `text`: behind the bracket that closes its first one. */
static const char *end_of_element(const char *text) {
    int depth = 0;
    for (; *text; text++) {
        depth += *text == '[' || *text == '(';
        if ((*text == ']' || *text == ')') && --depth == 0) return text;
    }
    return text;
}

/* The number behind the name in the last element UNIT["name",metres] or LENGTHUNIT of a text; 0: none. */
static double last_unit(const char *text, const char *end) {
    double metres = 0;
    for (const char *at = strstr(text, "UNIT["); at && at < end; at = strstr(at + 1, "UNIT[")) {
        const char *comma = strchr(at, ',');
        if (comma && comma < end) metres = strtod(comma + 1, NULL);
    }
    return metres;
}

/* A projected system contains a geographic one, and its own unit stands behind that; heights, whose unit may
 * be another one, have a system beside it. */
static iso_world_unit unit_of_text(const char *text) {
    static const char *const linear[] = {"PROJCS[", "PROJCRS[", "PROJECTEDCRS[", "GEOCCS["};
    static const char *const angular[] = {"GEOGCS[", "GEOGCRS[", "GEOGRAPHICCRS["};
    for (size_t i = 0; i < sizeof linear / sizeof *linear; i++) {
        const char *begin = strstr(text, linear[i]);
        if (begin) return unit_of_metres(last_unit(begin, end_of_element(begin)));
    }
    for (size_t i = 0; i < sizeof angular / sizeof *angular; i++)
        if (strstr(text, angular[i])) return ISO_WORLD_UNIT_DEGREE;
    return ISO_WORLD_UNIT_NONE;
}

/* ---- extra bytes */

/* Sets the type of the numbers; types 11 to 30 are two and three of types 1 to 10. */
static void set_type(iso_las_extra *extra, int type, int options) {
    static const iso_scalar scalars[] = {
        ISO_SCALAR_UINT8, ISO_SCALAR_INT8,   ISO_SCALAR_UINT16, ISO_SCALAR_INT16, ISO_SCALAR_UINT32,
        ISO_SCALAR_INT32, ISO_SCALAR_UINT64, ISO_SCALAR_INT64,  ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE};
    if (type < 1 || type > 30) {
        extra->bytes = type == 0 ? (size_t)options : 0;
        return;
    }
    extra->count = (type - 1) / 10 + 1;
    extra->scalar = scalars[(type - 1) % 10];
    extra->bytes = (size_t)extra->count * iso_scalar_size(extra->scalar);
}

/* "No data" values are widened to 64 bits: unsigned, signed or double. */
static iso_scalar widened(iso_scalar scalar) {
    if (scalar == ISO_SCALAR_FLOAT || scalar == ISO_SCALAR_DOUBLE) return ISO_SCALAR_DOUBLE;
    const bool is_signed = scalar == ISO_SCALAR_INT8 || scalar == ISO_SCALAR_INT16 ||
                           scalar == ISO_SCALAR_INT32 || scalar == ISO_SCALAR_INT64;
    return is_signed ? ISO_SCALAR_INT64 : ISO_SCALAR_UINT64;
}

static void take_extra(iso_las_extra *extra, const unsigned char *b) {
    enum { NO_DATA = 1, SCALE = 8, SHIFT = 16 };
    const int options = b[3];
    set_type(extra, b[2], options);
    memcpy(extra->name, b + 4, sizeof extra->name - 1);
    extra->has_no_data = extra->count && options & NO_DATA;
    for (int k = 0; k < extra->count; k++) {
        const size_t at = 8 * (size_t)k;
        extra->no_data[k] = iso_scalar_load(b + 40 + at, widened(extra->scalar), false);
        extra->scale[k] = options & SCALE ? iso_scalar_load(b + 112 + at, ISO_SCALAR_DOUBLE, false) : 1;
        extra->shift[k] = options & SHIFT ? iso_scalar_load(b + 136 + at, ISO_SCALAR_DOUBLE, false) : 0;
    }
}

static void take_extras(iso_las_blocks *blocks, size_t bytes) {
    blocks->extra_count = (int)(bytes / ISO_LAS_EXTRA);
    for (int i = 0; i < blocks->extra_count; i++) {
        blocks->extras[i] = (iso_las_extra){.bytes = 0};
        take_extra(&blocks->extras[i], blocks->block + (size_t)i * ISO_LAS_EXTRA);
    }
}

/* ---- blocks */

/* Takes what the block with this header says; its contents have been read. */
static void take_block(iso_las_blocks *blocks, const unsigned char header[HEADER], size_t bytes) {
    char user[17] = "";
    memcpy(user, header + 2, 16);
    const uint64_t number = number_at(header + 18, ISO_SCALAR_UINT16);
    blocks->block[bytes] = 0;
    if (strcmp(user, "laszip encoded") == 0 && number == 22204) {
        blocks->compressed = true;
        blocks->laszip_bytes = bytes < ISO_LAS_LASZIP ? bytes : ISO_LAS_LASZIP;
        memcpy(blocks->laszip, blocks->block, blocks->laszip_bytes);
    }
    if (strcmp(user, "LASF_Spec") == 0 && number == 4) take_extras(blocks, bytes);
    if (strcmp(user, "LASF_Projection") == 0 && number == 34735 && blocks->unit == ISO_WORLD_UNIT_NONE)
        blocks->unit = unit_of_keys(blocks->block, bytes);
    const bool text = strcmp(user, "LASF_Projection") == 0 || strcmp(user, "liblas") == 0;
    if (text && number == 2112 && blocks->unit == ISO_WORLD_UNIT_NONE)
        blocks->unit = unit_of_text((const char *)blocks->block);
}

iso_status iso_las_blocks_read(iso_las_blocks *blocks, iso_stream *stream, uint64_t count, uint64_t left,
                               iso_error *error) {
    unsigned char header[HEADER];
    blocks->unit = ISO_WORLD_UNIT_NONE;
    for (uint64_t i = 0; i < count && left >= HEADER; i++) {
        ISO_TRY(iso_stream_read(stream, header, sizeof header, error));
        const uint64_t bytes = number_at(header + 20, ISO_SCALAR_UINT16), rest = left - HEADER;
        const size_t some = (size_t)(bytes < rest ? bytes : rest);
        ISO_TRY(iso_stream_read(stream, blocks->block, some, error));
        take_block(blocks, header, some);
        left = rest - some;
    }
    return iso_stream_skip(stream, left, error);
}
