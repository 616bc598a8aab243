/* nrrd_header: parses the header of an NRRD file.
 *
 * The parser makes one pass over at most ISO_NRRD_HEADER_BYTES and allocates only the text. Values are stored
 * as numbers and enumerators in a fixed struct; key/value pairs and fields that do not affect the positions
 * of voxels are skipped. Like teem 1.12 it rejects a repeated field, a field before the one that it depends
 * on, and an axis that has both a direction and a spacing. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "grids/volume/nrrd.h"

typedef struct parser {
    const char *path;
    iso_nrrd_header *header;
    char *at, *end; /* the text that is not parsed yet */
    bool whole;     /* the text ends with the file */
    int line;       /* number of the current line, from 1 */
    uint64_t seen;  /* bit by number of a field in `fields`: it has occurred */
    bool big_endian, has_byte_order;
    locale_t c_locale;
    iso_error *error;
} parser;

static iso_status bad(const parser *p, const char *field, const char *why) {
    return iso_fail(p->error, ISO_ERR_FORMAT, "%s: line %d of its header, '%s': %s", p->path, p->line, field,
                    why);
}

/* ---- words and numbers ---- */

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

static char *skip_blanks(char *text) {
    while (is_blank(*text)) text++;
    return text;
}

/* Returns the next word of *text, zero-terminated, and moves *text behind it; NULL: there is none. */
static char *next_word(char **text) {
    char *word = skip_blanks(*text), *end = word;
    if (!*word) return NULL;
    while (*end && !is_blank(*end)) end++;
    *text = end + (*end != 0);
    *end = 0;
    return word;
}

static bool parse_unsigned(const char *word, uint64_t *value) {
    if (!word || !isdigit((unsigned char)*word)) return false;
    char *end;
    errno = 0;
    *value = strtoull(word, &end, 10);
    return errno == 0 && !*end;
}

static bool parse_signed(const char *word, int64_t *value) {
    if (!word) return false;
    char *end;
    errno = 0;
    *value = strtoll(word, &end, 10);
    return errno == 0 && end != word && !*end;
}

/* Parses the number at *text and moves *text behind it; NaN is accepted, infinity is not. */
static bool parse_double(const parser *p, char **text, double *value) {
    char *end;
    *value = strtod_l(*text, &end, p->c_locale);
    if (end == *text || isinf(*value)) return false;
    *text = end;
    return true;
}

/* Returns the index of `word` among `count` names that are `stride` bytes apart; -1: it is not among them. */
static int find_name(const char *word, const void *names, size_t count, size_t stride) {
    for (size_t i = 0; i < count; i++)
        if (strcasecmp(word, *(const char *const *)(const void *)((const char *)names + i * stride)) == 0)
            return (int)i;
    return -1;
}

#define FIND_NAME(word, table) find_name(word, table, sizeof(table) / sizeof *(table), sizeof *(table))

/* Returns the length of a unit in mm; 1 for a unit that is not a length. */
static double unit_mm(const char *unit) {
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"m", 1000},       {"cm", 10},           {"um", 0.001},
                 {"micron", 0.001}, {"\xc2\xb5m", 0.001}, {"nm", 1e-6}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].name) == 0) return units[i].mm;
    return 1;
}

/* Returns the next "quoted string" of *text (\" in it is a quote), zero-terminated, and moves *text behind
 * it; NULL: there is none. */
static char *next_quoted(char **text) {
    char *from = skip_blanks(*text), *to = from;
    if (*from != '"') return NULL;
    char *string = to;
    for (from++; *from && *from != '"'; from++) {
        if (from[0] == '\\' && from[1] == '"') from++;
        *to++ = *from;
    }
    if (!*from) return NULL;
    *text = from + 1;
    *to = 0; /* the characters were moved over the opening quote */
    return string;
}

/* ---- the array ---- */

static iso_status parse_type(parser *p, char *value) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"signed char", ISO_SCALAR_INT8},
                 {"int8", ISO_SCALAR_INT8},
                 {"int8_t", ISO_SCALAR_INT8},
                 {"uchar", ISO_SCALAR_UINT8},
                 {"unsigned char", ISO_SCALAR_UINT8},
                 {"uint8", ISO_SCALAR_UINT8},
                 {"uint8_t", ISO_SCALAR_UINT8},
                 {"short", ISO_SCALAR_INT16},
                 {"short int", ISO_SCALAR_INT16},
                 {"signed short", ISO_SCALAR_INT16},
                 {"signed short int", ISO_SCALAR_INT16},
                 {"int16", ISO_SCALAR_INT16},
                 {"int16_t", ISO_SCALAR_INT16},
                 {"ushort", ISO_SCALAR_UINT16},
                 {"unsigned short", ISO_SCALAR_UINT16},
                 {"unsigned short int", ISO_SCALAR_UINT16},
                 {"uint16", ISO_SCALAR_UINT16},
                 {"uint16_t", ISO_SCALAR_UINT16},
                 {"int", ISO_SCALAR_INT32},
                 {"signed int", ISO_SCALAR_INT32},
                 {"int32", ISO_SCALAR_INT32},
                 {"int32_t", ISO_SCALAR_INT32},
                 {"uint", ISO_SCALAR_UINT32},
                 {"unsigned int", ISO_SCALAR_UINT32},
                 {"uint32", ISO_SCALAR_UINT32},
                 {"uint32_t", ISO_SCALAR_UINT32},
                 {"longlong", ISO_SCALAR_INT64},
                 {"long long", ISO_SCALAR_INT64},
                 {"long long int", ISO_SCALAR_INT64},
                 {"signed long long", ISO_SCALAR_INT64},
                 {"signed long long int", ISO_SCALAR_INT64},
                 {"int64", ISO_SCALAR_INT64},
                 {"int64_t", ISO_SCALAR_INT64},
                 {"ulonglong", ISO_SCALAR_UINT64},
                 {"unsigned long long", ISO_SCALAR_UINT64},
                 {"unsigned long long int", ISO_SCALAR_UINT64},
                 {"uint64", ISO_SCALAR_UINT64},
                 {"uint64_t", ISO_SCALAR_UINT64},
                 {"float", ISO_SCALAR_FLOAT},
                 {"double", ISO_SCALAR_DOUBLE}};
    int found = FIND_NAME(value, types);
    if (strcasecmp(value, "block") == 0)
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: holds blocks, not numbers", p->path);
    if (found < 0) return bad(p, "type", "not a type of number");
    p->header->scalar = types[found].scalar;
    return ISO_OK;
}

static iso_status parse_encoding(parser *p, char *value) {
    static const struct {
        const char *name;
        iso_nrrd_encoding encoding;
    } encodings[] = {{"raw", ISO_NRRD_RAW},    {"txt", ISO_NRRD_TEXT},  {"text", ISO_NRRD_TEXT},
                     {"ascii", ISO_NRRD_TEXT}, {"hex", ISO_NRRD_HEX},   {"gz", ISO_NRRD_GZIP},
                     {"gzip", ISO_NRRD_GZIP},  {"bz2", ISO_NRRD_BZIP2}, {"bzip2", ISO_NRRD_BZIP2},
                     {"zrl", ISO_NRRD_ZRL}};
    int found = FIND_NAME(value, encodings);
    if (found < 0) return bad(p, "encoding", "not raw, ascii, hex, gzip, bzip2 or zrl");
    p->header->encoding = encodings[found].encoding;
    return ISO_OK;
}

static iso_status parse_endian(parser *p, char *value) {
    p->big_endian = strcasecmp(value, "big") == 0;
    p->has_byte_order = p->big_endian || strcasecmp(value, "little") == 0;
    return p->has_byte_order ? ISO_OK : bad(p, "endian", "neither little nor big");
}

static iso_status parse_dimension(parser *p, char *value) {
    uint64_t dim = 0;
    if (!parse_unsigned(value, &dim) || dim < 1 || dim > ISO_NRRD_AXES)
        return bad(p, "dimension", "not a number from 1 to 16");
    p->header->dim = (unsigned)dim;
    return ISO_OK;
}

static iso_status parse_sizes(parser *p, char *value) {
    for (unsigned i = 0; i < p->header->dim; i++) {
        uint64_t *size = &p->header->axis[i].size;
        if (!parse_unsigned(next_word(&value), size))
            return bad(p, "sizes", "not a whole number for each axis");
        if (*size == 0) return bad(p, "sizes", "an axis has 0 samples");
    }
    return *skip_blanks(value) ? bad(p, "sizes", "more numbers than axes") : ISO_OK;
}

/* Parses one number for each axis, and stores it in the member of iso_nrrd_axis at `offset`. */
static iso_status parse_axes(parser *p, const char *field, char *value, size_t offset) {
    for (unsigned i = 0; i < p->header->dim; i++) {
        double *number = (double *)(void *)((char *)&p->header->axis[i] + offset);
        char *word = next_word(&value);
        if (!word || !parse_double(p, &word, number) || *word)
            return bad(p, field, "not a finite number for each axis");
    }
    return *skip_blanks(value) ? bad(p, field, "more numbers than axes") : ISO_OK;
}

static iso_status parse_spacings(parser *p, char *value) {
    ISO_TRY(parse_axes(p, "spacings", value, offsetof(iso_nrrd_axis, spacing)));
    for (unsigned i = 0; i < p->header->dim; i++)
        if (p->header->axis[i].spacing == 0) return bad(p, "spacings", "a spacing is 0");
    return ISO_OK;
}

static iso_status parse_thicknesses(parser *p, char *value) {
    ISO_TRY(parse_axes(p, "thicknesses", value, offsetof(iso_nrrd_axis, thickness)));
    for (unsigned i = 0; i < p->header->dim; i++)
        if (p->header->axis[i].thickness < 0) return bad(p, "thicknesses", "a thickness is negative");
    return ISO_OK;
}

static iso_status parse_mins(parser *p, char *value) {
    return parse_axes(p, "axis mins", value, offsetof(iso_nrrd_axis, min));
}

static iso_status parse_maxs(parser *p, char *value) {
    return parse_axes(p, "axis maxs", value, offsetof(iso_nrrd_axis, max));
}

static bool is_unknown(const char *word) {
    return strcmp(word, "???") == 0 || strcmp(word, "none") == 0;
}

static iso_status parse_centers(parser *p, char *value) {
    for (unsigned i = 0; i < p->header->dim; i++) {
        char *word = next_word(&value);
        bool node = word && strcasecmp(word, "node") == 0;
        if (!word || !(node || strcasecmp(word, "cell") == 0 || is_unknown(word)))
            return bad(p, "centers", "not cell, node, none or ??? for each axis");
        p->header->axis[i].node_centered = node;
    }
    return *skip_blanks(value) ? bad(p, "centers", "more words than axes") : ISO_OK;
}

static iso_status parse_kinds(parser *p, char *value) {
    static const struct {
        const char *name;
        unsigned size;
    } kinds[] = {{"domain", 0}, /* the first two kinds are axes of space */
                 {"space", 0},
                 {"time", 0},
                 {"list", 0},
                 {"point", 0},
                 {"vector", 0},
                 {"contravariant-vector", 0},
                 {"covariant-vector", 0},
                 {"normal", 0},
                 {"stub", 1},
                 {"scalar", 1},
                 {"complex", 2},
                 {"2-vector", 2},
                 {"3-color", 3},
                 {"RGB-color", 3},
                 {"RGBcolor", 3},
                 {"RGB", 3},
                 {"HSV-color", 3},
                 {"HSVcolor", 3},
                 {"HSV", 3},
                 {"XYZ-color", 3},
                 {"4-color", 4},
                 {"RGBA-color", 4},
                 {"RGBAcolor", 4},
                 {"RGBA", 4},
                 {"3-vector", 3},
                 {"3-gradient", 3},
                 {"3-normal", 3},
                 {"4-vector", 4},
                 {"quaternion", 4},
                 {"2D-symmetric-matrix", 3},
                 {"2D-sym-matrix", 3},
                 {"2D-symmetric-tensor", 3},
                 {"2D-sym-tensor", 3},
                 {"2D-masked-symmetric-matrix", 4},
                 {"2D-masked-sym-matrix", 4},
                 {"2D-masked-symmetric-tensor", 4},
                 {"2D-masked-sym-tensor", 4},
                 {"2D-matrix", 4},
                 {"2D-tensor", 4},
                 {"2D-masked-matrix", 5},
                 {"2D-masked-tensor", 5},
                 {"3D-symmetric-matrix", 6},
                 {"3D-sym-matrix", 6},
                 {"3D-symmetric-tensor", 6},
                 {"3D-sym-tensor", 6},
                 {"3D-masked-symmetric-matrix", 7},
                 {"3D-masked-sym-matrix", 7},
                 {"3D-masked-symmetric-tensor", 7},
                 {"3D-masked-sym-tensor", 7},
                 {"3D-matrix", 9},
                 {"3D-tensor", 9},
                 {"3D-masked-matrix", 10},
                 {"3D-masked-tensor", 10}};
    for (unsigned i = 0; i < p->header->dim; i++) {
        char *word = next_word(&value);
        if (!word) return bad(p, "kinds", "fewer words than axes");
        if (is_unknown(word)) continue;
        int found = FIND_NAME(word, kinds);
        if (found < 0) return bad(p, "kinds", "not a kind of axis");
        p->header->axis[i].other = found > 1;
        p->header->axis[i].kind_size = kinds[found].size;
    }
    return *skip_blanks(value) ? bad(p, "kinds", "more words than axes") : ISO_OK;
}

static iso_status parse_units(parser *p, char *value) {
    for (unsigned i = 0; i < p->header->dim; i++) {
        char *unit = next_quoted(&value);
        if (!unit) return bad(p, "units", "not a word in quotes for each axis");
        p->header->axis[i].unit_mm = unit_mm(unit);
        p->header->axis[i].has_unit = *unit != 0;
    }
    return *skip_blanks(value) ? bad(p, "units", "more words than axes") : ISO_OK;
}

/* ---- the space around it ---- */

static iso_status parse_space(parser *p, char *value) {
    static const struct {
        const char *name;
        unsigned dim;
        signed char sign[3];
        bool anatomical;
    } spaces[] = {{"right-up", 2, {1, 1, 1}, false},
                  {"right-down", 2, {1, 1, 1}, false},
                  {"right-anterior-superior", 3, {-1, -1, 1}, true},
                  {"RAS", 3, {-1, -1, 1}, true},
                  {"left-anterior-superior", 3, {1, -1, 1}, true},
                  {"LAS", 3, {1, -1, 1}, true},
                  {"left-posterior-superior", 3, {1, 1, 1}, true},
                  {"LPS", 3, {1, 1, 1}, true},
                  {"right-anterior-superior-time", 4, {-1, -1, 1}, true},
                  {"RAST", 4, {-1, -1, 1}, true},
                  {"left-anterior-superior-time", 4, {1, -1, 1}, true},
                  {"LAST", 4, {1, -1, 1}, true},
                  {"left-posterior-superior-time", 4, {1, 1, 1}, true},
                  {"LPST", 4, {1, 1, 1}, true},
                  {"scanner-xyz", 3, {1, 1, 1}, false},
                  {"scanner-xyz-time", 4, {1, 1, 1}, false},
                  {"scanner-xyzt", 4, {1, 1, 1}, false},
                  {"3D-right-handed", 3, {1, 1, 1}, false},
                  {"3D-left-handed", 3, {1, 1, -1}, false},
                  {"3D-right-handed-time", 4, {1, 1, 1}, false},
                  {"3D-left-handed-time", 4, {1, 1, -1}, false}};
    char plain[32] = "";
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++) {
        /* the format also allows "right anterior superior" and "rightanteriorsuperior" */
        size_t length = 0;
        for (const char *c = spaces[i].name; *c; c++)
            if (*c != '-') plain[length++] = *c;
        plain[length] = 0;
        const char *a = plain, *b = value;
        while (*a && *b) {
            if ((*b == ' ' || *b == '-') && b > value) b++;
            if (tolower((unsigned char)*a) != tolower((unsigned char)*b)) break;
            a++, b++;
        }
        if (*a || *b) continue;
        p->header->space_dim = spaces[i].dim;
        for (int k = 0; k < 3; k++) p->header->space_sign[k] = spaces[i].sign[k];
        p->header->anatomical = spaces[i].anatomical;
        return ISO_OK;
    }
    return bad(p, "space", "not a space that the format knows");
}

static iso_status parse_space_dimension(parser *p, char *value) {
    uint64_t dim = 0;
    if (!parse_unsigned(value, &dim) || dim > ISO_NRRD_SPACE)
        return bad(p, "space dimension", "not a number from 1 to 8");
    p->header->space_dim = (unsigned)dim;
    return ISO_OK;
}

/* Parses "(x,y,z)", or "none", which sets all numbers to NaN. Either all of them or none may be NaN. */
static bool parse_vector(const parser *p, char **text, double vector[ISO_NRRD_SPACE]) {
    unsigned dim = p->header->space_dim;
    char *at = skip_blanks(*text);
    if (strncmp(at, "none", 4) == 0 && (!at[4] || is_blank(at[4]))) {
        for (unsigned i = 0; i < dim; i++) vector[i] = NAN;
        *text = at + 4;
        return true;
    }
    if (*at != '(') return false;
    for (unsigned i = 0; i < dim; i++) {
        at++;
        if (!parse_double(p, &at, &vector[i]) || isnan(vector[i]) != isnan(vector[0])) return false;
        at = skip_blanks(at);
        if (*at != (i + 1 < dim ? ',' : ')')) return false;
    }
    *text = at + 1;
    return true;
}

static iso_status parse_origin(parser *p, char *value) {
    if (!parse_vector(p, &value, p->header->space_origin) || *skip_blanks(value))
        return bad(p, "space origin", "not a vector with a number for each axis of the space");
    return ISO_OK;
}

static iso_status parse_directions(parser *p, char *value) {
    for (unsigned i = 0; i < p->header->dim; i++)
        if (!parse_vector(p, &value, p->header->axis[i].direction))
            return bad(p, "space directions", "not a vector or none for each axis");
    return *skip_blanks(value) ? bad(p, "space directions", "more vectors than axes") : ISO_OK;
}

static iso_status parse_space_units(parser *p, char *value) {
    for (unsigned i = 0; i < p->header->space_dim; i++) {
        char *unit = next_quoted(&value);
        if (!unit) return bad(p, "space units", "not a word in quotes for each axis of the space");
        p->header->space_unit_mm[i] = unit_mm(unit);
        p->header->has_space_unit |= *unit != 0;
    }
    return *skip_blanks(value) ? bad(p, "space units", "more words than axes of the space") : ISO_OK;
}

static iso_status parse_frame(parser *p, char *value) {
    for (unsigned i = 0; i < p->header->space_dim; i++)
        if (!parse_vector(p, &value, p->header->frame[i]))
            return bad(p, "measurement frame", "not a vector or none for each axis of the space");
    return *skip_blanks(value) ? bad(p, "measurement frame", "more vectors than axes of the space") : ISO_OK;
}

/* ---- the location of the array ---- */

static iso_status parse_line_skip(parser *p, char *value) {
    if (parse_unsigned(value, &p->header->line_skip)) return ISO_OK;
    return bad(p, "line skip", "not a number of lines");
}

static iso_status parse_byte_skip(parser *p, char *value) {
    if (parse_signed(value, &p->header->byte_skip)) return ISO_OK;
    return bad(p, "byte skip", "not a number of bytes");
}

/* Whether a name is a pattern: its first % that is not doubled begins %d, with or without a width. */
static bool is_pattern(const char *text) {
    const char *at = strchr(text, '%');
    while (at && at[1] == '%') at = strchr(at + 2, '%');
    return at && at[1 + strspn(at + 1, "0123456789")] == 'd';
}

/* Parses the number of axes in each file; without a number, all but the last. */
static iso_status parse_file_dim(parser *p, char **value) {
    char *word = next_word(value);
    uint64_t dim = p->header->dim - 1;
    if ((word && !parse_unsigned(word, &dim)) || dim > p->header->dim || (word && dim < 1) ||
        *skip_blanks(*value))
        return bad(p, "data file", "the number of axes in a file is not from 1 to its dimension");
    p->header->file_dim = (unsigned)dim;
    return ISO_OK;
}

/* Parses a pattern such as "name%03d.raw 1 90 1 [dim]". */
static iso_status parse_pattern(parser *p, char *value) {
    iso_nrrd_header *header = p->header;
    char *name = next_word(&value);
    bool counted = parse_signed(next_word(&value), &header->first) &&
                   parse_signed(next_word(&value), &header->last) &&
                   parse_signed(next_word(&value), &header->step);
    /* limited to int, as in teem, so that sums of two of them do not overflow */
    const int64_t numbers[3] = {header->first, header->last, header->step};
    for (int i = 0; i < 3; i++) counted = counted && numbers[i] >= INT_MIN && numbers[i] <= INT_MAX;
    if (!counted || header->step == 0 || (header->last - header->first) * header->step < 0)
        return bad(p, "data file", "not a first and a last number and the step between them");
    snprintf(header->name, sizeof header->name, "%s", name);
    header->place = ISO_NRRD_PATTERN;
    return parse_file_dim(p, &value);
}

static iso_status parse_list(parser *p, char *value) {
    p->header->place = *value == 'S' ? ISO_NRRD_SKIP_LIST : ISO_NRRD_LIST;
    next_word(&value);
    return parse_file_dim(p, &value);
}

static bool is_word(const char *text, const char *word) {
    size_t length = strlen(word);
    return strncmp(text, word, length) == 0 && (!text[length] || is_blank(text[length]));
}

static iso_status parse_data_file(parser *p, char *value) {
    iso_nrrd_header *header = p->header;
    bool list = is_word(value, "LIST") || is_word(value, "SKIPLIST");
    if (strlen(value) >= sizeof header->name) return bad(p, "data file", "the name is too long");
    if (!*value) return bad(p, "data file", "there is no name");
    if ((list || is_pattern(value)) && header->dim == 0) return bad(p, "data file", "comes before dimension");
    if (list) return parse_list(p, value);
    if (is_pattern(value)) return parse_pattern(p, value);
    header->place = ISO_NRRD_FILE;
    strcpy(header->name, value);
    return ISO_OK;
}

/* ---- lines ---- */

typedef enum need { NEED_NOTHING, NEED_DIMENSION = 1, NEED_SPACE = 2, NEED_BOTH = 3 } need;

/* All fields of the format. Those without a function do not affect the voxels and their positions. */
static const struct {
    const char *name, *other; /* two spellings, mostly with and without a space */
    iso_status (*parse)(parser *p, char *value);
    need need;
} fields[] = {{"type", "type", parse_type, NEED_NOTHING},
              {"dimension", "dimension", parse_dimension, NEED_NOTHING},
              {"sizes", "sizes", parse_sizes, NEED_DIMENSION},
              {"encoding", "encoding", parse_encoding, NEED_NOTHING},
              {"endian", "endian", parse_endian, NEED_NOTHING},
              {"spacings", "spacings", parse_spacings, NEED_DIMENSION},
              {"thicknesses", "thicknesses", parse_thicknesses, NEED_DIMENSION},
              {"axis mins", "axismins", parse_mins, NEED_DIMENSION},
              {"axis maxs", "axismaxs", parse_maxs, NEED_DIMENSION},
              {"centers", "centerings", parse_centers, NEED_DIMENSION},
              {"kinds", "kinds", parse_kinds, NEED_DIMENSION},
              {"units", "units", parse_units, NEED_DIMENSION},
              {"space", "space", parse_space, NEED_NOTHING},
              {"space dimension", "spacedimension", parse_space_dimension, NEED_NOTHING},
              {"space origin", "spaceorigin", parse_origin, NEED_SPACE},
              {"space directions", "spacedirections", parse_directions, NEED_BOTH},
              {"space units", "spaceunits", parse_space_units, NEED_SPACE},
              {"line skip", "lineskip", parse_line_skip, NEED_NOTHING},
              {"byte skip", "byteskip", parse_byte_skip, NEED_NOTHING},
              {"data file", "datafile", parse_data_file, NEED_NOTHING},
              {"content", "content", NULL, NEED_NOTHING},
              {"number", "number", NULL, NEED_NOTHING},
              {"block size", "blocksize", NULL, NEED_NOTHING},
              {"labels", "labels", NULL, NEED_NOTHING},
              {"min", "min", NULL, NEED_NOTHING},
              {"max", "max", NULL, NEED_NOTHING},
              {"old min", "oldmin", NULL, NEED_NOTHING},
              {"old max", "oldmax", NULL, NEED_NOTHING},
              {"sample units", "sampleunits", NULL, NEED_NOTHING},
              {"measurement frame", "measurementframe", parse_frame, NEED_SPACE}};

enum { FIELDS = sizeof fields / sizeof *fields };
_Static_assert(FIELDS <= 64, "parser.seen has a bit for each field");

static bool has_seen(const parser *p, const char *name) {
    return p->seen >> find_name(name, fields, FIELDS, sizeof *fields) & 1;
}

static iso_status parse_field(parser *p, int index, char *value) {
    const char *name = fields[index].name;
    if (p->seen >> index & 1) return bad(p, name, "is there twice");
    p->seen |= UINT64_C(1) << index;
    if (fields[index].need & NEED_DIMENSION && p->header->dim == 0)
        return bad(p, name, "comes before dimension");
    if (fields[index].need & NEED_SPACE && p->header->space_dim == 0)
        return bad(p, name, "comes before space");
    if (has_seen(p, "space") && has_seen(p, "space dimension"))
        return bad(p, name, "there are both a space and a space dimension");
    value = skip_blanks(value);
    if (fields[index].parse == parse_data_file) return parse_data_file(p, value);
    size_t length = strlen(value);
    while (length && is_blank(value[length - 1])) value[--length] = 0;
    return fields[index].parse ? fields[index].parse(p, value) : ISO_OK;
}

static iso_status parse_line(parser *p, char *line) {
    if (*line == '#') return ISO_OK;
    char *colon = strstr(line, ": ");
    if (colon) *colon = 0;
    int field = colon ? find_name(line, fields, FIELDS, sizeof *fields) : -1;
    if (colon && field < 0) field = find_name(line, &fields[0].other, FIELDS, sizeof *fields);
    if (field >= 0) return parse_field(p, field, colon + 2);
    if (strstr(line, ":=")) return ISO_OK; /* a key and its value */
    return iso_fail(p->error, ISO_ERR_FORMAT,
                    "%s: line %d of its header is no field of an NRRD file: '%.40s'", p->path, p->line, line);
}

/* Sets *line to the next line, zero-terminated, without its end (\n, \r\n or \r); false: the text has no
 * complete line. */
static bool next_line(parser *p, char **line) {
    char *end = p->at;
    while (end < p->end && *end != '\n' && *end != '\r') end++;
    if (end == p->end && (!p->whole || end == p->at)) return false;
    if (end + 1 == p->end && *end == '\r' && !p->whole) return false; /* the \n may be cut off */
    *line = p->at;
    p->at = end + (end < p->end);
    if (end + 1 < p->end && end[0] == '\r' && end[1] == '\n') p->at++;
    *end = 0;
    p->line++;
    return true;
}

static bool is_magic(const char *line) {
    bool numbered = strlen(line) == 8 && memcmp(line, "NRRD000", 7) == 0 && line[7] >= '1' && line[7] <= '6';
    return numbered || strcmp(line, "NRRD00.01") == 0;
}

static iso_status parse_lines(parser *p) {
    char *line = NULL;
    ISO_TRY(iso_file_check_text(p->path, p->at, (size_t)(p->end - p->at), p->error));
    p->at += iso_text_mark(p->at, (size_t)(p->end - p->at));
    if (!next_line(p, &line) || !is_magic(line))
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: not an NRRD file", p->path);
    bool ended = false;
    while (!ended && next_line(p, &line)) {
        ended = !*line;
        if (!ended) ISO_TRY(parse_line(p, line));
        bool list = p->header->place == ISO_NRRD_LIST || p->header->place == ISO_NRRD_SKIP_LIST;
        ended = ended || list;
    }
    if (ended) return ISO_OK;
    if (!p->whole)
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: its header is longer than %d bytes", p->path,
                        ISO_NRRD_HEADER_BYTES);
    if (p->header->place != ISO_NRRD_ATTACHED) return ISO_OK;
    return iso_fail(p->error, ISO_ERR_IO, "%s: truncated: its header does not end", p->path);
}

/* ---- the whole header ---- */

static iso_status check_axis(const parser *p, unsigned index) {
    const iso_nrrd_axis *axis = &p->header->axis[index];
    if (axis->kind_size && axis->kind_size != axis->size)
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: axis %u has %llu samples, its kind has %u", p->path,
                        index, (unsigned long long)axis->size, axis->kind_size);
    bool directed = p->header->space_dim && isfinite(axis->direction[0]);
    if (directed && (!isnan(axis->spacing) || !isnan(axis->min) || !isnan(axis->max) || axis->has_unit))
        return iso_fail(p->error, ISO_ERR_FORMAT,
                        "%s: axis %u has a direction and also a spacing, a range or a unit", p->path, index);
    return ISO_OK;
}

static iso_status check_whole(parser *p) {
    iso_nrrd_header *header = p->header;
    static const char *const wanted[] = {"type", "dimension", "sizes", "encoding"};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (!has_seen(p, wanted[i]))
            return iso_fail(p->error, ISO_ERR_FORMAT, "%s: its header has no field '%s'", p->path, wanted[i]);
    bool ordered = header->encoding != ISO_NRRD_TEXT && iso_scalar_size(header->scalar) > 1;
    if (ordered && !p->has_byte_order)
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: its header has no field 'endian'", p->path);
    header->swap = ordered && p->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    for (unsigned i = 0; i < header->dim; i++) ISO_TRY(check_axis(p, i));
    bool packed = header->encoding == ISO_NRRD_GZIP || header->encoding == ISO_NRRD_BZIP2;
    if (header->byte_skip < 0 && header->encoding != ISO_NRRD_RAW && !packed)
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: a byte skip of %lld is not possible in this encoding",
                        p->path, (long long)header->byte_skip);
    if (header->byte_skip != 0 && header->place == ISO_NRRD_SKIP_LIST)
        return iso_fail(p->error, ISO_ERR_FORMAT, "%s: has a byte skip beside those of SKIPLIST", p->path);
    return ISO_OK;
}

static void clear(iso_nrrd_header *header) {
    *header = (iso_nrrd_header){.space_sign = {1, 1, 1}};
    for (int i = 0; i < ISO_NRRD_SPACE; i++) {
        header->space_origin[i] = NAN;
        header->space_unit_mm[i] = 1;
        for (int k = 0; k < ISO_NRRD_SPACE; k++) header->frame[i][k] = NAN;
    }
    for (int k = 0; k < ISO_NRRD_AXES; k++) {
        iso_nrrd_axis *axis = &header->axis[k];
        axis->spacing = axis->thickness = axis->min = axis->max = NAN;
        axis->unit_mm = 1;
        for (int i = 0; i < ISO_NRRD_SPACE; i++) axis->direction[i] = NAN;
    }
}

iso_status iso_nrrd_header_parse(const char *path, char *text, size_t count, bool whole,
                                 iso_nrrd_header *header, iso_error *error) {
    parser p = {
        .path = path, .header = header, .at = text, .end = text + count, .whole = whole, .error = error};
    p.c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!p.c_locale) return iso_fail_memory(error, path);
    clear(header);
    text[count] = 0;
    iso_status status = parse_lines(&p);
    if (status == ISO_OK) status = check_whole(&p);
    freelocale(p.c_locale);
    header->after = (uint64_t)(p.at - text);
    return status;
}

iso_status iso_nrrd_header_read(const char *path, iso_nrrd_header *header, iso_error *error) {
    FILE *file = NULL;
    uint64_t bytes = 0;
    ISO_TRY(iso_file_open(path, &file, &bytes, error));
    bool whole = bytes <= ISO_NRRD_HEADER_BYTES;
    size_t room = whole ? (size_t)bytes : ISO_NRRD_HEADER_BYTES;
    iso_status status = ISO_OK;
    char *text = iso_alloc(room + 1);
    if (!text) status = iso_fail_memory(error, path);
    size_t count = text ? fread(text, 1, room, file) : 0;
    if (text && count < room && ferror(file))
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    if (status == ISO_OK) status = iso_nrrd_header_parse(path, text, count, whole, header, error);
    iso_free(text);
    fclose(file);
    return status;
}

uint64_t iso_nrrd_bytes(const iso_nrrd_header *header) {
    uint64_t bytes = iso_scalar_size(header->scalar);
    for (unsigned i = 0; i < header->dim; i++)
        if (__builtin_mul_overflow(bytes, header->axis[i].size, &bytes) || bytes > INT64_MAX)
            return UINT64_MAX;
    return bytes;
}
