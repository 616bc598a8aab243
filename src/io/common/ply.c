/* ply: buffered bytes, values, elements and the header of PLY files. */
#include "io/common/ply.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "grids/volume/scalar_load.h"

static const int type_size[] = {1, 1, 2, 2, 4, 4, 4, 8};

/* ---- values */

static bool is_space(int byte) {
    return byte == ' ' || byte == '\t' || byte == '\r' || byte == '\n' || byte == '\v' || byte == '\f';
}

static iso_status read_text_value(iso_ply *ply, double *value, iso_error *error) {
    char token[64];
    size_t length = 0;
    int byte = iso_stream_byte(&ply->in);
    while (is_space(byte)) byte = iso_stream_byte(&ply->in);
    if (byte < 0) return iso_stream_fail(&ply->in, error);
    for (; byte >= 0 && !is_space(byte); byte = iso_stream_byte(&ply->in)) {
        if (byte == 0 || length + 1 == sizeof token)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: not a number in its ASCII data",
                            ply->in.path);
        token[length++] = (char)byte;
    }
    if (byte == '\n') iso_stream_step_back(&ply->in); /* the row's end is iso_ply_end_item's */
    token[length] = 0;
    char *end;
    *value = strtod(token, &end);
    if (!*end) return ISO_OK;
    if (byte < 0) return iso_stream_fail(&ply->in, error); /* the file ends within the number */
    return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: \"%s\" is not a number", ply->in.path, token);
}

/* By iso_ply_type. */
static const iso_scalar scalars[] = {ISO_SCALAR_INT8,   ISO_SCALAR_UINT8, ISO_SCALAR_INT16,
                                     ISO_SCALAR_UINT16, ISO_SCALAR_INT32, ISO_SCALAR_UINT32,
                                     ISO_SCALAR_FLOAT,  ISO_SCALAR_DOUBLE};

iso_scalar iso_ply_scalar(iso_ply_type type) {
    return scalars[type];
}

iso_status iso_ply_read_value(iso_ply *ply, iso_ply_type type, double *value, iso_error *error) {
    if (ply->format == ISO_PLY_ASCII) return read_text_value(ply, value, error);
    const size_t size = (size_t)type_size[type];
    if (!iso_stream_fill(&ply->in, size)) return iso_stream_fail(&ply->in, error);
    *value = iso_scalar_load(ply->in.buffer + ply->in.place, scalars[type], ply->format == ISO_PLY_BIG);
    iso_stream_advance(&ply->in, size);
    return ISO_OK;
}

/* ---- elements */

/* Returns the smallest size of an item in bytes: in ASCII a digit and a separator for each value. Lists may
 * be empty. */
static uint64_t least_bytes(const iso_ply *ply, const iso_ply_element *element) {
    uint64_t bytes = 0;
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_property *property = &ply->properties[element->first_property + i];
        iso_ply_type type = property->is_list ? property->count_type : property->type;
        bytes += ply->format == ISO_PLY_ASCII ? 2 : (uint64_t)type_size[type];
    }
    return bytes;
}

size_t iso_ply_record_bytes(const iso_ply *ply, const iso_ply_element *element) {
    for (int i = 0; i < element->property_count; i++)
        if (ply->properties[element->first_property + i].is_list) return 0;
    return ply->format == ISO_PLY_ASCII ? 0 : (size_t)least_bytes(ply, element);
}

iso_status iso_ply_check_size(const iso_ply *ply, const iso_ply_element *element, iso_error *error) {
    uint64_t least = least_bytes(ply, element);
    /* the last separator may be missing */
    uint64_t spare = ply->format == ISO_PLY_ASCII ? 1 : 0;
    if (least == 0 || element->count <= (ply->in.remaining + spare) / least) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: its header promises %llu of element \"%s\"",
                    ply->in.path, (unsigned long long)element->count, element->name);
}

iso_status iso_ply_read_list_count(iso_ply *ply, const iso_ply_property *list, uint64_t *count,
                                   iso_error *error) {
    double number;
    ISO_TRY(iso_ply_read_value(ply, list->count_type, &number, error));
    if (!(number >= 0 && number <= UINT32_MAX))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a list \"%s\" of %g items", ply->in.path,
                        list->name, number);
    *count = (uint64_t)number;
    const uint64_t each = ply->format == ISO_PLY_ASCII ? 2 : (uint64_t)type_size[list->type];
    return *count <= ply->in.remaining / each + 1 ? ISO_OK : iso_stream_fail(&ply->in, error);
}

iso_status iso_ply_skip_list(iso_ply *ply, const iso_ply_property *list, iso_error *error) {
    uint64_t count;
    double ignored;
    ISO_TRY(iso_ply_read_list_count(ply, list, &count, error));
    if (ply->format != ISO_PLY_ASCII)
        return iso_stream_skip(&ply->in, count * (uint64_t)type_size[list->type], error);
    for (uint64_t i = 0; i < count; i++) ISO_TRY(read_text_value(ply, &ignored, error));
    return ISO_OK;
}

/* Whether the file has as many rows with text behind this one as it has items that are left. */
static bool has_rows_left(const iso_ply *ply, off_t at) {
    uint64_t rows = 0;
    bool text = false, this_one = true;
    FILE *file = ply->in.file;
    char bytes[4096];
    if (fseeko(file, at, SEEK_SET) != 0) return false;
    for (size_t count; rows < ply->items_left && (count = fread(bytes, 1, sizeof bytes, file)) > 0;)
        for (size_t i = 0; i < count; i++) {
            text = text || (!this_one && !is_space(bytes[i]));
            if (bytes[i] != '\n') continue;
            rows += text;
            text = this_one = false;
        }
    return rows + text >= ply->items_left;
}

/* Decides how items follow each other, when numbers are left in a row behind an item. */
static iso_status decide_items(iso_ply *ply, iso_error *error) {
    const off_t file_at = ftello(ply->in.file), at = file_at - (off_t)(ply->in.end - ply->in.place);
    ply->items = has_rows_left(ply, at) ? ISO_PLY_BY_ROW : ISO_PLY_IN_ROW;
    clearerr(ply->in.file);
    return fseeko(ply->in.file, file_at, SEEK_SET) == 0 ? ISO_OK : iso_stream_fail(&ply->in, error);
}

/* Refuses numbers behind the last item where items follow each other in a row: some item before lacked as
 * many, and those behind it have got its neighbours'. */
static iso_status check_end(iso_ply *ply, iso_error *error) {
    while (iso_stream_fill(&ply->in, 1) && is_space(ply->in.buffer[ply->in.place]))
        iso_stream_advance(&ply->in, 1);
    if (!iso_stream_fill(&ply->in, 1)) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: damaged: a row has fewer numbers than its header promises, or the last one more",
                    ply->in.path);
}

iso_status iso_ply_end_item(iso_ply *ply, iso_error *error) {
    if (ply->format != ISO_PLY_ASCII) return ISO_OK;
    ply->items_left--;
    while (iso_stream_fill(&ply->in, 1)) {
        const int byte = ply->in.buffer[ply->in.place];
        if (!is_space(byte) && ply->items == ISO_PLY_NOT_KNOWN) ISO_TRY(decide_items(ply, error));
        if (!is_space(byte) && ply->items == ISO_PLY_IN_ROW) break;
        iso_stream_advance(&ply->in, 1);
        if (byte == '\n') break;
    }
    return ply->items_left == 0 && ply->items == ISO_PLY_IN_ROW ? check_end(ply, error) : ISO_OK;
}

iso_status iso_ply_read_item(iso_ply *ply, const iso_ply_element *element, double value[ISO_PLY_PROPERTIES],
                             iso_error *error) {
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_property *property = &ply->properties[element->first_property + i];
        if (property->is_list)
            ISO_TRY(iso_ply_skip_list(ply, property, error));
        else
            ISO_TRY(iso_ply_read_value(ply, property->type, &value[i], error));
    }
    return iso_ply_end_item(ply, error);
}

iso_status iso_ply_skip_element(iso_ply *ply, const iso_ply_element *element, iso_error *error) {
    if (element->property_count == 0) return ISO_OK; /* its items have no bytes */
    double ignored[ISO_PLY_PROPERTIES];
    ISO_TRY(iso_ply_check_size(ply, element, error));
    for (uint64_t i = 0; i < element->count; i++) ISO_TRY(iso_ply_read_item(ply, element, ignored, error));
    return ISO_OK;
}

/* ---- the header */

enum { LINE = 1024, WORDS = 6, HEADER_LIMIT = 1 << 20 };

/* A header line, split into words. It is cut at LINE bytes: only comments are that long. */
typedef struct header_line {
    char text[LINE];
    char *words[WORDS];
    int count; /* WORDS when there are that many or more */
} header_line;

static iso_status read_line(iso_ply *ply, header_line *line, size_t *header_bytes, iso_error *error) {
    size_t length = 0;
    int byte;
    while ((byte = iso_stream_byte(&ply->in)) != '\n') {
        if (byte < 0) return iso_fail(error, ISO_ERR_IO, "%s: truncated in its PLY header", ply->in.path);
        if (++*header_bytes > HEADER_LIMIT)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: its PLY header does not end", ply->in.path);
        if (length + 1 < LINE) line->text[length++] = (char)byte;
    }
    line->text[length] = 0;
    line->count = 0;
    char *rest = NULL;
    for (char *word = strtok_r(line->text, " \t\r", &rest); word && line->count < WORDS;
         word = strtok_r(NULL, " \t\r", &rest))
        line->words[line->count++] = word;
    return ISO_OK;
}

static bool is_word(const header_line *line, int index, const char *word) {
    return index < line->count && strcmp(line->words[index], word) == 0;
}

static iso_status fail_line(const iso_ply *ply, const header_line *line, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: bad \"%.40s\" line in its PLY header", ply->in.path,
                    line->words[0]);
}

static bool parse_type(const char *name, iso_ply_type *type) {
    static const char *const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                           {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                           {"float", "float32"}, {"double", "float64"}};
    for (int i = 0; i < 8; i++)
        if (strcmp(name, names[i][0]) == 0 || strcmp(name, names[i][1]) == 0) {
            *type = (iso_ply_type)i;
            return true;
        }
    return false;
}

static bool copy_name(char name[ISO_PLY_NAME], const char *word) {
    size_t length = strlen(word);
    if (length >= ISO_PLY_NAME) return false;
    memcpy(name, word, length + 1);
    return true;
}

static bool parse_format(iso_ply *ply, const header_line *line) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (int i = 0; i < 3; i++)
        if (line->count == 3 && is_word(line, 1, names[i]) && is_word(line, 2, "1.0")) {
            ply->format = (iso_ply_format)i;
            return true;
        }
    return false;
}

static bool parse_element(iso_ply *ply, const header_line *line) {
    if (line->count != 3 || ply->element_count == ISO_PLY_ELEMENTS) return false;
    iso_ply_element *element = &ply->elements[ply->element_count];
    const char *digits = line->words[2];
    if (digits[strspn(digits, "0123456789")] || !copy_name(element->name, line->words[1])) return false;
    errno = 0;
    element->count = strtoull(digits, NULL, 10);
    if (errno) return false;
    element->first_property = ply->property_count;
    element->property_count = 0;
    ply->element_count++;
    return true;
}

static bool parse_property(iso_ply *ply, const header_line *line) {
    if (ply->element_count == 0 || ply->property_count == ISO_PLY_PROPERTIES) return false;
    iso_ply_property *property = &ply->properties[ply->property_count];
    property->is_list = is_word(line, 1, "list");
    int last = property->is_list ? 4 : 2;
    if (line->count != last + 1 || !parse_type(line->words[last - 1], &property->type) ||
        !copy_name(property->name, line->words[last]))
        return false;
    if (property->is_list &&
        (!parse_type(line->words[2], &property->count_type) || property->count_type >= ISO_PLY_FLOAT32))
        return false;
    ply->property_count++;
    ply->elements[ply->element_count - 1].property_count++;
    return true;
}

/* Takes the number from the comment that says that the points are those of a closed surface. */
static void parse_comment(iso_ply *ply, const header_line *line) {
    if (!is_word(line, 1, "closed") || !is_word(line, 2, "surface") || !is_word(line, 3, "of") ||
        !is_word(line, 5, "points"))
        return;
    ply->closed_points = strtoull(line->words[4], NULL, 10);
}

static iso_status read_header(iso_ply *ply, iso_error *error) {
    header_line line;
    size_t bytes = 0;
    bool has_format = false;
    for (;;) {
        ISO_TRY(read_line(ply, &line, &bytes, error));
        if (is_word(&line, 0, "comment")) parse_comment(ply, &line);
        if (line.count == 0 || is_word(&line, 0, "comment") || is_word(&line, 0, "obj_info")) continue;
        if (is_word(&line, 0, "end_header")) break;
        bool good = false;
        if (is_word(&line, 0, "format"))
            good = has_format = parse_format(ply, &line);
        else if (is_word(&line, 0, "element"))
            good = parse_element(ply, &line);
        else if (is_word(&line, 0, "property"))
            good = parse_property(ply, &line);
        if (!good) return fail_line(ply, &line, error);
    }
    if (!has_format)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its PLY header names no format", ply->in.path);
    return ISO_OK;
}

/* Skips a byte order mark, which some programs write at the beginning of a file's text, or of its data. */
static void skip_mark(iso_ply *ply) {
    if (iso_stream_fill(&ply->in, 3))
        iso_stream_advance(&ply->in, iso_text_mark(ply->in.buffer + ply->in.place, 3));
}

static bool read_magic(iso_ply *ply) {
    if (!iso_stream_fill(&ply->in, 4) || memcmp(ply->in.buffer + ply->in.place, "ply", 3) != 0) return false;
    iso_stream_advance(&ply->in, 3);
    int byte = iso_stream_byte(&ply->in);
    while (byte == '\r' || byte == ' ') byte = iso_stream_byte(&ply->in);
    return byte == '\n';
}

iso_status iso_ply_open(const char *path, iso_ply *ply, iso_error *error) {
    ply->element_count = ply->property_count = 0;
    ply->closed_points = 0;
    ply->items = ISO_PLY_NOT_KNOWN;
    ISO_TRY(iso_stream_open(path, &ply->in, error));
    skip_mark(ply);
    if (!read_magic(ply)) {
        if (ferror(ply->in.file)) return iso_stream_fail(&ply->in, error);
        ISO_TRY(
            iso_file_check_text(path, ply->in.buffer + ply->in.place, ply->in.end - ply->in.place, error));
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a PLY file", path);
    }
    ISO_TRY(read_header(ply, error));
    if (ply->format == ISO_PLY_ASCII) skip_mark(ply);
    ply->items_left = 0;
    for (int i = 0; i < ply->element_count; i++)
        if (ply->elements[i].property_count) ply->items_left += ply->elements[i].count;
    return ISO_OK;
}

void iso_ply_close(iso_ply *ply) {
    iso_stream_close(&ply->in);
}
