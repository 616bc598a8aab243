/* label_names: reads tables of labels row by row, and segments line by line. */
#include "grids/labels/label_names.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/parse.h"
#include "base/srgb.h"
#include "base/text.h"
#include "grids/volume/dicom/dicom.h"

enum {
    LINE = 4096,        /* longest line of a table */
    NRRD_LINES = 200000 /* most lines of a header that are looked at */
};

static iso_status add(iso_label_names *names, const iso_label_name *name, iso_error *error) {
    if (!(names->count & (names->count - 1))) { /* room for 1, 2, 4 .. */
        const size_t room = names->count ? 2 * (size_t)names->count : 1;
        iso_label_name *grown = iso_alloc(room * sizeof *grown);
        if (!grown) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for names of labels");
        if (names->count) memcpy(grown, names->items, (size_t)names->count * sizeof *grown);
        iso_free(names->items);
        names->items = grown;
    }
    names->items[names->count++] = *name;
    return ISO_OK;
}

/* ---- rows */

/* Takes the last word of a line off; NULL: there is none. */
static char *take_last(char *line) {
    size_t length = strlen(line);
    while (length && isspace((unsigned char)line[length - 1])) line[--length] = 0;
    while (length && !isspace((unsigned char)line[length - 1])) length--;
    if (!line[length]) return NULL;
    if (length) line[length - 1] = 0;
    return line + length;
}

/* Takes the first word of a line off. */
static char *take_first(char **line) {
    char *word = *line + strspn(*line, " \t"), *end = word + strcspn(word, " \t");
    *line = *end ? end + 1 : end;
    *end = 0;
    return *word ? word : NULL;
}

static bool parse_byte(const char *word, uint8_t *byte) {
    int value;
    if (!word || !iso_parse_int(word, &value) || value < 0 || value > 255) return false;
    *byte = (uint8_t)value;
    return true;
}

static void set_name(iso_label_name *name, const char *text) {
    const size_t length = strlen(text);
    const bool quoted = length >= 2 && text[0] == '"' && text[length - 1] == '"';
    char plain[LINE];
    snprintf(plain, sizeof plain, "%.*s", (int)(quoted ? length - 2 : length), text + quoted);
    iso_text_clean(plain, name->name, sizeof name->name);
}

/* value red green blue opacity visible mesh "name": the text begins behind the value. */
static bool parse_snap(char *text, iso_label_name *name) {
    uint8_t rgb[3];
    double unused;
    for (int i = 0; i < 3; i++)
        if (!parse_byte(take_first(&text), &rgb[i])) return false;
    for (int i = 0; i < 3; i++) {
        const char *word = take_first(&text);
        if (!word || !iso_parse_real(word, &unused)) return false;
    }
    text += strspn(text, " \t");
    set_name(name, text);
    name->color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    name->colored = true;
    return name->name[0] != 0;
}

/* value name red green blue opacity. */
static bool parse_table(char *text, iso_label_name *name) {
    uint8_t rgb[4];
    for (int i = 3; i >= 0; i--)
        if (!parse_byte(take_last(text), &rgb[i])) return false;
    char *end = text + strlen(text);
    while (end > text && isspace((unsigned char)end[-1])) *--end = 0;
    text += strspn(text, " \t");
    set_name(name, text);
    name->color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    name->colored = true;
    return name->name[0] != 0;
}

static bool parse_row(char *line, iso_label_name *name) {
    char copy[LINE], *rest = line;
    *name = (iso_label_name){.value = 0};
    const char *value = take_first(&rest);
    if (!value || !iso_parse_int(value, &name->value)) return false;
    snprintf(copy, sizeof copy, "%s", rest);
    return parse_snap(copy, name) || parse_table(rest, name);
}

iso_status iso_label_names_read(const char *path, iso_label_names *names, iso_error *error) {
    FILE *stream;
    char line[LINE];
    iso_status status = ISO_OK;
    *names = (iso_label_names){NULL, 0};
    ISO_TRY(iso_file_open(path, &stream, NULL, error));
    for (int number = 1; status == ISO_OK && fgets(line, sizeof line, stream); number++) {
        iso_label_name name;
        line[strcspn(line, "\r\n")] = 0;
        char *const row = line + (number == 1 ? iso_text_mark(line, strlen(line)) : 0);
        const char *text = row + strspn(row, " \t");
        if (!*text || *text == '#') continue;
        if (parse_row(row, &name))
            status = add(names, &name, error);
        else
            status = iso_fail(error, ISO_ERR_FORMAT,
                              "%s: line %d is no label: VALUE NAME RED GREEN BLUE OPACITY (FreeSurfer, 3D "
                              "Slicer), or VALUE RED GREEN BLUE OPACITY VISIBLE MESH \"NAME\" (ITK-SNAP)",
                              path, number);
    }
    fclose(stream);
    if (status == ISO_OK && !names->count)
        status = iso_fail(error, ISO_ERR_FORMAT, "%s: no label is in it", path);
    if (status != ISO_OK) iso_label_names_free(names);
    return status;
}

/* ---- segments */

/* The number of "Segment12_"; *rest: what follows it. -1: the line is of no segment. */
static int segment_of(const char *line, const char **rest) {
    if (strncmp(line, "Segment", 7) != 0 || !isdigit((unsigned char)line[7])) return -1;
    char *end;
    const long number = strtol(line + 7, &end, 10);
    if (*end != '_' || number > 65535) return -1;
    *rest = end + 1;
    return (int)number;
}

/* What follows KEY:= in the text; NULL: it has another key. */
static const char *value_of(const char *text, const char *key) {
    const size_t length = strlen(key);
    return strncmp(text, key, length) == 0 && strncmp(text + length, ":=", 2) == 0 ? text + length + 2 : NULL;
}

static void take_segment_line(const char *text, iso_label_name *name) {
    const char *value;
    double rgb[3];
    if ((value = value_of(text, "Name"))) set_name(name, value);
    if ((value = value_of(text, "LabelValue"))) iso_parse_int(value, &name->value);
    if ((value = value_of(text, "Layer"))) iso_parse_int(value, &name->layer);
    if ((value = value_of(text, "Color")) && iso_parse_reals(value, 3, rgb)) {
        uint8_t bytes[3];
        for (int i = 0; i < 3; i++)
            bytes[i] = (uint8_t)(255 * (rgb[i] < 0 ? 0 : rgb[i] > 1 ? 1 : rgb[i]) + 0.5);
        name->color = (iso_rgb){bytes[0], bytes[1], bytes[2]};
        name->colored = true;
    }
}

/* The segment with a number, which is added if it is not known. NULL: no memory. `value`: holds its place. */
static iso_label_name *find_segment(iso_label_names *names, int *numbers, int number, iso_error *error) {
    for (int i = 0; i < names->count; i++)
        if (numbers[i] == number) return &names->items[i];
    if (names->count == 65536 || add(names, &(iso_label_name){.value = number + 1}, error) != ISO_OK)
        return NULL;
    numbers[names->count - 1] = number;
    return &names->items[names->count - 1];
}

static iso_status read_segments(FILE *stream, iso_label_names *names, int *numbers, iso_error *error) {
    char *line = NULL;
    size_t room = 0;
    iso_status status = ISO_OK;
    for (int i = 0; i < NRRD_LINES && status == ISO_OK && getline(&line, &room, stream) > 0; i++) {
        const char *rest;
        line[strcspn(line, "\r\n")] = 0;
        if (!*line) break;
        if (i == 0 && strncmp(line + iso_text_mark(line, strlen(line)), "NRRD", 4) != 0) break;
        const int number = segment_of(line, &rest);
        if (number < 0) continue;
        iso_label_name *name = find_segment(names, numbers, number, error);
        if (name)
            take_segment_line(rest, name);
        else
            status = ISO_ERR_NOMEM;
    }
    free(line);
    return status;
}

static iso_status read_nrrd(const char *path, iso_label_names *names, iso_error *error) {
    FILE *stream;
    ISO_TRY(iso_file_open(path, &stream, NULL, error));
    int *numbers = iso_alloc(65536 * sizeof *numbers);
    iso_status status =
        numbers ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for names of labels");
    if (status == ISO_OK) status = read_segments(stream, names, numbers, error);
    iso_free(numbers);
    fclose(stream);
    return status;
}

/* The display colour of a CIELab colour of DICOM, relative to white (D65, as 3D Slicer and dcmqi take it). */
static iso_rgb rgb_of_lab(const uint16_t lab[3]) {
    static const double white[3] = {0.950456, 1, 1.088754};
    static const double rows[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                      {-0.9692660, 1.8760108, 0.0415560},
                                      {0.0556434, -0.2040259, 1.0572252}};
    const double y = (lab[0] * 100.0 / 65535 + 16) / 116, a = lab[1] * 255.0 / 65535 - 128,
                 b = lab[2] * 255.0 / 65535 - 128, f[3] = {y + a / 500, y, y - b / 200};
    double xyz[3];
    uint8_t bytes[3];
    for (int i = 0; i < 3; i++)
        xyz[i] = white[i] * (f[i] > 6.0 / 29 ? f[i] * f[i] * f[i] : (f[i] - 4.0 / 29) * 108 / 841);
    for (int i = 0; i < 3; i++) {
        const double light = rows[i][0] * xyz[0] + rows[i][1] * xyz[1] + rows[i][2] * xyz[2];
        bytes[i] = (uint8_t)(255 * iso_srgb_encode(light) + 0.5);
    }
    return (iso_rgb){bytes[0], bytes[1], bytes[2]};
}

static iso_status read_dicom(const char *path, iso_label_names *names, iso_error *error) {
    iso_dicom_file file;
    iso_dicom_kind kind;
    iso_status status = iso_dicom_file_read(path, &file, &kind, error);
    for (size_t i = 0; i < file.segment_count && status == ISO_OK; i++) {
        const iso_dicom_segment *segment = &file.segments[i];
        iso_label_name name = {.value = segment->number, .colored = segment->colored};
        if (segment->colored) name.color = rgb_of_lab(segment->lab);
        set_name(&name, segment->name);
        status = add(names, &name, error);
    }
    iso_dicom_file_free(&file);
    return status;
}

iso_status iso_label_names_of_file(const char *path, iso_label_names *names, iso_error *error) {
    char head[132];
    const size_t length = iso_file_head(path, head, sizeof head);
    const bool nrrd = length >= 4 && memcmp(head, "NRRD", 4) == 0;
    const bool dicom = length == sizeof head && memcmp(head + 128, "DICM", 4) == 0;
    *names = (iso_label_names){NULL, 0};
    const iso_status status = nrrd    ? read_nrrd(path, names, error)
                              : dicom ? read_dicom(path, names, error)
                                      : ISO_OK;
    if (status != ISO_OK) iso_label_names_free(names);
    return status;
}

void iso_label_names_free(iso_label_names *names) {
    iso_free(names->items);
    *names = (iso_label_names){NULL, 0};
}

const iso_label_name *iso_label_names_find(const iso_label_names *names, int layer, int value) {
    for (int i = names->count - 1; i >= 0; i--)
        if (names->items[i].value == value && names->items[i].layer == layer) return &names->items[i];
    return NULL;
}

/* ---- colours */

/* A channel of a colour with this hue, 0 .. 1. */
static double channel(double hue, double shift, double saturation, double brightness) {
    double h = (hue + shift) * 6;
    while (h >= 6) h -= 6;
    const double ramp = h < 1 ? h : h < 3 ? 1 : h < 4 ? 4 - h : 0;
    return brightness * (1 - saturation * (1 - ramp));
}

iso_rgb iso_label_usual_color(int value) {
    static const double saturation[4] = {0.62, 0.45, 0.75, 0.55}, brightness[4] = {0.92, 0.80, 0.72, 0.98};
    const double turned = value * 0.61803398875, hue = turned - (int)turned;
    const double s = saturation[value % 4], b = brightness[value % 4];
    return (iso_rgb){(uint8_t)(255 * channel(hue, 1.0 / 3, s, b) + 0.5),
                     (uint8_t)(255 * channel(hue, 0, s, b) + 0.5),
                     (uint8_t)(255 * channel(hue, 2.0 / 3, s, b) + 0.5)};
}
