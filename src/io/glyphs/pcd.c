/* pcd: files of the Point Cloud Library (format .7 and its predecessors): a header in text, then points as
 * text, as records, or compressed with LZF, where each field's numbers of all points are together.
 *
 * rgb and rgba are colours in the bits of one number, 0xAARRGGBB, whichever type it has. Fields called _ are
 * padding. The viewpoint is where the sensor was; points are in the sensor's frame, and stay there. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/text.h"
#include "io/common/rows.h"
#include "io/glyphs/lzf.h"
#include "io/polydata/records.h"

enum { NUMBERS = ISO_POLYDATA_COLUMNS, LINE = 1 << 14, HEADER_LIMIT = 1 << 20 };

/* A field of the header: `count` numbers for each point. */
typedef struct pcd_field {
    char name[ISO_COLUMN_NAME];
    int size, count;
    char type; /* I, U or F */
    iso_scalar scalar;
    bool packed; /* a colour in the bits of one number */
    size_t offset;
    iso_slot slot; /* of the first number */
} pcd_field;

typedef enum pcd_encoding { PCD_ASCII, PCD_BINARY, PCD_COMPRESSED } pcd_encoding;

typedef struct pcd {
    iso_polydata *data;
    iso_stream in;
    iso_text_rows rows; /* ASCII */
    char line[LINE];
    size_t header_bytes, header_rows;
    pcd_field fields[NUMBERS];
    int field_count, number_count; /* numbers of a point */
    size_t record;                 /* bytes of a point */
    uint64_t width, height, points;
    bool has_points;
    double viewpoint[7];
    pcd_encoding encoding;
    iso_record_field numbers[3 * NUMBERS]; /* a colour is three */
    int used;
} pcd;

static const char *path_of(const pcd *p) {
    return p->data->reading->path;
}

/* ---- the header */

static iso_status fail_header(const pcd *p, const char *word, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: bad \"%.40s\" line in its PCD header", path_of(p), word);
}

static iso_status skip_mark(pcd *p, iso_error *error) {
    if (!iso_stream_fill(&p->in, 4)) return ISO_OK;
    const void *head = p->in.buffer + p->in.place;
    ISO_TRY(iso_file_check_text(path_of(p), head, 4, error));
    iso_stream_advance(&p->in, iso_text_mark(head, 4));
    return ISO_OK;
}

/* Reads a line of the header, which is cut at LINE bytes: only comments are that long. */
static iso_status read_line(pcd *p, iso_error *error) {
    size_t length = 0;
    int byte;
    while ((byte = iso_stream_byte(&p->in)) != '\n') {
        if (byte < 0 && length == 0)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: not a PCD file: its header has no line DATA",
                            path_of(p));
        if (byte < 0) break;
        if (++p->header_bytes > HEADER_LIMIT)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: its PCD header does not end", path_of(p));
        if (length + 1 < LINE) p->line[length++] = (char)byte;
    }
    p->header_bytes++;
    p->header_rows++;
    if (length && p->line[length - 1] == '\r') length--;
    p->line[length] = 0;
    return ISO_OK;
}

static bool parse_names(pcd *p, char *rest) {
    p->field_count = 0;
    for (char *word = iso_row_word(&rest); word; word = iso_row_word(&rest)) {
        if (p->field_count == NUMBERS || strlen(word) >= ISO_COLUMN_NAME) return false;
        pcd_field *field = &p->fields[p->field_count++];
        *field = (pcd_field){.size = 4, .count = 1, .type = 'F'};
        strcpy(field->name, word);
    }
    return p->field_count > 0;
}

/* Parses a whole number from 0 to `most`. */
static bool parse_count(const char *word, uint64_t most, uint64_t *count) {
    errno = 0;
    if (!word || !*word || word[strspn(word, "0123456789")]) return false;
    *count = strtoull(word, NULL, 10);
    return errno == 0 && *count <= most;
}

/* Parses the words of a line SIZE, TYPE or COUNT: one for each field. */
static bool parse_fields(pcd *p, char kind, char *rest) {
    for (int i = 0; i < p->field_count; i++) {
        const char *word = iso_row_word(&rest);
        pcd_field *field = &p->fields[i];
        uint64_t number = 0;
        if (!word) return false;
        if (kind == 'T') {
            if (strlen(word) != 1 || !strchr("IUF", *word)) return false;
            field->type = *word;
            continue;
        }
        if (!parse_count(word, kind == 'S' ? 8 : NUMBERS, &number) || number == 0) return false;
        if (kind == 'S')
            field->size = (int)number;
        else
            field->count = (int)number;
    }
    return !iso_row_word(&rest);
}

static bool parse_viewpoint(pcd *p, char *rest) {
    for (int k = 0; k < 7; k++)
        if (!iso_row_number(&rest, "", &p->viewpoint[k])) return false;
    return true;
}

static bool parse_encoding(pcd *p, char *rest) {
    static const char *const names[] = {"ascii", "binary", "binary_compressed"};
    const char *word = iso_row_word(&rest);
    for (int i = 0; i < 3 && word; i++)
        if (strcasecmp(word, names[i]) == 0) {
            p->encoding = (pcd_encoding)i;
            return true;
        }
    return false;
}

/* Parses a line; *last: it is the header's last one. */
static bool parse_line(pcd *p, const char *word, char *rest, bool *last) {
    if (strcmp(word, "VERSION") == 0) return true;
    if (strcmp(word, "FIELDS") == 0 || strcmp(word, "COLUMNS") == 0) return parse_names(p, rest);
    if (strcmp(word, "SIZE") == 0 || strcmp(word, "TYPE") == 0 || strcmp(word, "COUNT") == 0)
        return parse_fields(p, *word, rest);
    if (strcmp(word, "WIDTH") == 0) return parse_count(iso_row_word(&rest), UINT32_MAX, &p->width);
    if (strcmp(word, "HEIGHT") == 0) return parse_count(iso_row_word(&rest), UINT32_MAX, &p->height);
    if (strcmp(word, "VIEWPOINT") == 0) return parse_viewpoint(p, rest);
    if (strcmp(word, "POINTS") == 0)
        return p->has_points = parse_count(iso_row_word(&rest), UINT64_MAX, &p->points);
    *last = strcmp(word, "DATA") == 0;
    return *last && parse_encoding(p, rest);
}

static iso_status read_header(pcd *p, iso_error *error) {
    p->height = p->viewpoint[3] = 1;
    for (bool last = false; !last;) {
        ISO_TRY(read_line(p, error));
        char *rest = p->line, *word = iso_row_word(&rest);
        if (!word || *word == '#') continue;
        if (!parse_line(p, word, rest, &last)) return fail_header(p, word, error);
    }
    if (p->field_count == 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its PCD header names no fields", path_of(p));
    if (!p->has_points) p->points = p->width * p->height; /* (either is below 2^32) */
    return ISO_OK;
}

/* ---- fields */

/* Returns whether there is such a type of number. */
static bool find_scalar(pcd_field *field) {
    static const struct {
        char type;
        int size;
        iso_scalar scalar;
    } scalars[] = {{'I', 1, ISO_SCALAR_INT8},   {'U', 1, ISO_SCALAR_UINT8},  {'I', 2, ISO_SCALAR_INT16},
                   {'U', 2, ISO_SCALAR_UINT16}, {'I', 4, ISO_SCALAR_INT32},  {'U', 4, ISO_SCALAR_UINT32},
                   {'I', 8, ISO_SCALAR_INT64},  {'U', 8, ISO_SCALAR_UINT64}, {'F', 4, ISO_SCALAR_FLOAT},
                   {'F', 8, ISO_SCALAR_DOUBLE}};
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++)
        if (field->type == scalars[i].type && field->size == scalars[i].size) {
            field->scalar = scalars[i].scalar;
            return true;
        }
    return false;
}

static bool is_padding(const pcd_field *field) {
    return strcmp(field->name, "_") == 0;
}

/* Finds types and offsets. */
static iso_status place_fields(pcd *p, iso_error *error) {
    for (int i = 0; i < p->field_count; i++) {
        pcd_field *field = &p->fields[i];
        if (!find_scalar(field) && !is_padding(field))
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: field %s has an unknown type of number: %c of %d bytes", path_of(p),
                            field->name, field->type, field->size);
        field->packed = (strcasecmp(field->name, "rgb") == 0 || strcasecmp(field->name, "rgba") == 0) &&
                        field->size == 4 && field->count == 1;
        field->offset = p->record;
        p->record += (size_t)field->size * (size_t)field->count;
        p->number_count += field->count;
    }
    if (p->number_count <= NUMBERS) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: more than %d numbers for each point", path_of(p), NUMBERS);
}

/* Finds the columns of the fields. Several numbers of one name form a column of their own. */
static iso_status name_fields(pcd *p, iso_error *error) {
    const char *names[NUMBERS];
    iso_slot slots[NUMBERS];
    for (int i = 0; i < p->field_count; i++) {
        const pcd_field *field = &p->fields[i];
        names[i] = field->count > 1 || field->packed || is_padding(field) ? NULL : field->name;
    }
    ISO_TRY(iso_polydata_name_columns(p->data, names, p->field_count, slots, error));
    for (int i = 0; i < p->field_count; i++) {
        pcd_field *field = &p->fields[i];
        field->slot = slots[i];
        if (names[i] || is_padding(field)) continue;
        ISO_TRY(iso_polydata_add_column(
            p->data, field->packed ? "colors" : field->name, field->packed ? 3 : field->count, false,
            field->packed ? ISO_ROLE_COLOR : ISO_ROLE_NONE, &field->slot.column, error));
        field->slot.component = 0;
    }
    return ISO_OK;
}

/* ---- numbers */

/* Adds the bytes of a colour, blue first. */
static void add_packed(pcd *p, iso_slot slot, size_t offset, size_t stride) {
    for (int k = 0; k < 3; k++)
        p->numbers[p->used++] = iso_record_field_make((iso_slot){slot.column, k}, ISO_SCALAR_UINT8,
                                                      offset + 2 - (size_t)k, stride);
}

/* Describes the numbers of a field that begin at `offset`, `each` bytes apart in a point; the next point's
 * are `stride` bytes farther. */
static void add_numbers(pcd *p, const pcd_field *field, iso_scalar scalar, size_t offset, size_t each,
                        size_t stride) {
    if (field->slot.column == ISO_SLOT_SKIP) return;
    if (field->packed) {
        add_packed(p, field->slot, offset, stride);
        return;
    }
    for (int k = 0; k < field->count; k++)
        p->numbers[p->used++] =
            iso_record_field_make((iso_slot){field->slot.column, field->slot.component + k}, scalar,
                                  offset + (size_t)k * each, stride);
}

/* In compressed data each field's numbers of all points are together, in binary data those of a point. */
static void add_binary_numbers(pcd *p, bool together) {
    for (int i = 0; i < p->field_count; i++) {
        const pcd_field *field = &p->fields[i];
        const size_t size = (size_t)field->size;
        add_numbers(p, field, field->scalar, field->offset * (together ? (size_t)p->points : 1), size,
                    together ? size * (size_t)field->count : p->record);
        if (field->slot.column == ISO_SLOT_POINT && field->scalar != ISO_SCALAR_FLOAT)
            p->data->keep_floats = false;
    }
}

static iso_status read_binary(pcd *p, iso_error *error) {
    p->data->keep_floats = true;
    add_binary_numbers(p, false);
    return iso_polydata_stream_records(p->data, p->numbers, p->used, &p->in, p->record, p->points, error);
}

/* Reads two sizes in bytes: of the compressed data, and of what it is decompressed to. */
static iso_status read_sizes(pcd *p, size_t sizes[2], iso_error *error) {
    uint32_t stored[2];
    if (!iso_stream_fill(&p->in, sizeof stored)) return iso_stream_fail(&p->in, error);
    memcpy(stored, p->in.buffer + p->in.place, sizeof stored);
    iso_stream_advance(&p->in, sizeof stored);
    if (stored[0] > p->in.remaining) return iso_stream_fail(&p->in, error);
    if (stored[1] / ISO_LZF_MOST_RATIO > stored[0] || p->points > stored[1] / p->record ||
        p->points * p->record != stored[1])
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: %lu bytes of compressed data for %llu points",
                        path_of(p), (unsigned long)stored[1], (unsigned long long)p->points);
    sizes[0] = stored[0];
    sizes[1] = stored[1];
    return ISO_OK;
}

static iso_status decompress(pcd *p, iso_buffer *compressed, iso_buffer *bytes, iso_error *error) {
    size_t sizes[2] = {0};
    ISO_TRY(read_sizes(p, sizes, error));
    ISO_TRY(iso_reading_reserve(p->data->reading, compressed, sizes[0] + 1, 1, 0, error));
    ISO_TRY(iso_reading_reserve(p->data->reading, bytes, sizes[1] + 1, 1, 0, error));
    ISO_TRY(iso_stream_read(&p->in, compressed->data, sizes[0], error));
    if (!iso_lzf_decompress(compressed->data, sizes[0], bytes->data, sizes[1]))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: its data cannot be decompressed", path_of(p));
    return ISO_OK;
}

static iso_status read_compressed(pcd *p, iso_error *error) {
    iso_buffer compressed = {0}, bytes = {0};
    p->data->keep_floats = true;
    iso_status status = p->points ? decompress(p, &compressed, &bytes, error) : ISO_OK;
    iso_reading_free(p->data->reading, &compressed);
    if (status == ISO_OK) status = iso_polydata_reserve(p->data, (size_t)p->points, error);
    if (status == ISO_OK && p->points) {
        add_binary_numbers(p, true);
        iso_polydata_add_records(p->data, p->numbers, p->used, bytes.data, (size_t)p->points);
    }
    iso_reading_free(p->data->reading, &bytes);
    return status;
}

/* ---- text */

/* Stores the bits of a colour that is written as a number of the field's type. */
static double bits_of(const pcd_field *field, double number) {
    const float value = (float)number;
    uint32_t bits = 0;
    if (field->type == 'F')
        memcpy(&bits, &value, sizeof bits);
    else if (number >= INT32_MIN && number <= UINT32_MAX)
        bits = (uint32_t)(int64_t)number;
    double place = 0;
    memcpy(&place, &bits, sizeof bits);
    return place;
}

static iso_status parse_row(pcd *p, char *row, double *numbers, iso_error *error) {
    for (int i = 0; i < p->field_count; i++)
        for (int k = 0; k < p->fields[i].count; k++, numbers++) {
            if (!iso_row_number(&row, ",;", numbers))
                return iso_text_rows_fail(&p->rows, "not as many numbers as the fields have", error);
            if (p->fields[i].packed) *numbers = bits_of(&p->fields[i], *numbers);
        }
    return ISO_OK;
}

/* Reads the next row with numbers. */
static iso_status read_row(pcd *p, double *numbers, iso_error *error) {
    char *row = iso_text_rows_next(&p->rows);
    while (row && row[strspn(row, " \t")] == 0) row = iso_text_rows_next(&p->rows);
    if (!row) return iso_fail(error, ISO_ERR_IO, "%s: truncated: points are missing", path_of(p));
    return parse_row(p, row, numbers, error);
}

/* Rows become records of doubles: text can be more precise than the type that the header states. */
static iso_status read_ascii(pcd *p, iso_error *error) {
    double numbers[NUMBERS];
    ISO_TRY(iso_text_rows_load(p->data->reading, &p->rows, error));
    const size_t left = p->header_bytes < (size_t)(p->rows.end - p->rows.at)
                            ? (size_t)(p->rows.end - p->rows.at) - p->header_bytes
                            : 0;
    p->rows.at = p->rows.end - left;
    p->rows.number = p->header_rows;
    for (size_t at = 0, i = 0; i < (size_t)p->field_count; at += (size_t)p->fields[i++].count)
        add_numbers(p, &p->fields[i], ISO_SCALAR_DOUBLE, at * sizeof *numbers, sizeof *numbers, 0);
    /* a number takes at least two bytes with the separator, which the last one may lack */
    if (p->points > (left + 1) / 2 / (size_t)p->number_count)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: its header promises %llu points", path_of(p),
                        (unsigned long long)p->points);
    ISO_TRY(iso_polydata_reserve(p->data, (size_t)p->points, error));
    for (uint64_t i = 0; i < p->points; i++) {
        ISO_TRY(read_row(p, numbers, error));
        iso_polydata_add_records(p->data, p->numbers, p->used, (const unsigned char *)numbers, 1);
    }
    return ISO_OK;
}

/* ---- the file */

static void note_viewpoint(pcd *p) {
    static const double identity[7] = {0, 0, 0, 1, 0, 0, 0};
    bool same = true;
    for (int k = 0; k < 7; k++) same = same && p->viewpoint[k] == identity[k];
    if (!same)
        iso_reading_note(p->data->reading, "its VIEWPOINT is not applied: points are in the sensor's frame");
}

static iso_status read_pcd(pcd *p, iso_error *error) {
    static iso_status (*const readers[])(pcd * p, iso_error * error) = {read_ascii, read_binary,
                                                                        read_compressed};
    ISO_TRY(iso_stream_open(path_of(p), &p->in, error));
    ISO_TRY(skip_mark(p, error));
    ISO_TRY(read_header(p, error));
    ISO_TRY(place_fields(p, error));
    ISO_TRY(name_fields(p, error));
    if (p->record > ISO_STREAM_BUFFER) return fail_header(p, "SIZE", error);
    ISO_TRY(readers[p->encoding](p, error));
    note_viewpoint(p);
    for (int i = 0; i < p->field_count; i++)
        if (p->fields[i].packed) return ISO_OK;
    iso_polydata_scale_colors(p->data, true);
    return ISO_OK;
}

iso_status iso_polydata_read_pcd(iso_polydata *data, iso_error *error) {
    pcd *p = iso_alloc_zero(1, sizeof *p);
    if (!p) return iso_fail_memory(error, data->reading->path);
    p->data = data;
    const iso_status status = read_pcd(p, error);
    iso_stream_close(&p->in);
    iso_text_rows_free(&p->rows);
    iso_free(p);
    return status;
}
