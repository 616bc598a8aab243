/* metadata: the image descriptions of ImageJ ("ImageJ=1.53t", a key and a value a line) and of OME-TIFF
 * (XML, whose element Pixels has what is needed). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/tiff/tiff.h"

/* ---- numbers ---- */

enum { VALUE = 64, MOST_SIZE = 1 << 30, MOST_RUNS = 1 << 20 };

static uint32_t size_of(const char *text) {
    char *end;
    const double value = strtod(text, &end);
    return end != text && value >= 1 && value <= MOST_SIZE ? (uint32_t)value : 0;
}

static double length_of(const char *text) {
    char *end;
    const double value = strtod(text, &end);
    return end != text && value > 0 && isfinite(value) ? value : 0;
}

/* ---- axes ---- */

/* Parses "CZT", or "zct", to the order of the axes, which is unchanged if the text is anything else. */
static void parse_order(const char *text, iso_tiff_axis axes[ISO_TIFF_AXES]) {
    static const char letters[] = "CZTczt";
    iso_tiff_axis order[ISO_TIFF_AXES];
    unsigned met = 0;
    if (strlen(text) != ISO_TIFF_AXES) return;
    for (int i = 0; i < ISO_TIFF_AXES; i++) {
        const char *letter = strchr(letters, text[i]);
        if (!letter) return;
        order[i] = (iso_tiff_axis)((letter - letters) % ISO_TIFF_AXES);
        met |= 1u << order[i];
    }
    if (met == (1u << ISO_TIFF_AXES) - 1) memcpy(axes, order, sizeof order);
}

/* ---- ImageJ ---- */

/* Copies the value of a line "key=value"; false: there is no such line. */
static bool line_value(const char *text, const char *key, char value[VALUE]) {
    const size_t length = strlen(key);
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, key, length) != 0 || line[length] != '=') continue;
        snprintf(value, VALUE, "%.*s", (int)strcspn(line + length + 1, "\r\n"), line + length + 1);
        return true;
    }
    return false;
}

static void parse_imagej(const char *text, iso_tiff_metadata *m) {
    static const char *const sizes[ISO_TIFF_AXES] = {"channels", "slices", "frames"};
    char value[VALUE];
    m->writer = "ImageJ";
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++)
        if (line_value(text, sizes[axis], value)) m->sizes[axis] = size_of(value);
    if (line_value(text, "order", value)) parse_order(value, m->order);
    if (line_value(text, "images", value)) m->images = size_of(value);
    if (line_value(text, "unit", value)) m->unit = iso_format_unit(value);
    if (line_value(text, "spacing", value) && m->unit > 0) m->spacing[2] = length_of(value) * m->unit;
}

/* ---- OME ---- */

/* A part of the XML text. */
typedef struct part {
    const char *at, *end;
} part;

/* Where `word` is in the part; NULL: nowhere. */
static const char *find(part text, const char *word) {
    return memmem(text.at, (size_t)(text.end - text.at), word, strlen(word));
}

/* The tag at `at`, up to its '>'. */
static part tag_at(const char *at, const char *end) {
    const char *close = memchr(at, '>', (size_t)(end - at));
    return (part){at, close ? close : end};
}

/* Finds the value of an attribute of a tag. */
static bool attribute(part tag, const char *name, part *value) {
    const size_t length = strlen(name);
    for (part rest = tag; (rest.at = find(rest, name)); rest.at += length) {
        const char *from = rest.at + length + 2;
        if (strchr(" \t\r\n", rest.at[-1]) == NULL || from > tag.end || from[-2] != '=') continue;
        if (from[-1] != '"' && from[-1] != '\'') return false;
        const char *to = memchr(from, from[-1], (size_t)(tag.end - from));
        *value = (part){from, to};
        return to != NULL;
    }
    return false;
}

/* Copies a value, of which so many characters are enough; false: there is no such attribute. */
static bool attribute_text(part tag, const char *name, char text[VALUE]) {
    part value;
    if (!attribute(tag, name, &value)) return false;
    snprintf(text, VALUE, "%.*s", (int)(value.end - value.at < VALUE ? value.end - value.at : VALUE - 1),
             value.at);
    return true;
}

static uint32_t attribute_size(part tag, const char *name) {
    char value[VALUE];
    return attribute_text(tag, name, value) ? size_of(value) : 0;
}

/* What is equal in all positions of a volume. */
typedef struct shape {
    uint32_t width, height;
    uint32_t sizes[ISO_TIFF_AXES];
    iso_tiff_axis order[ISO_TIFF_AXES];
} shape;

/* Parses the tag Pixels of a position; without an order it has that of the first one. */
static shape parse_shape(part tag, const iso_tiff_metadata *m) {
    static const char *const sizes[ISO_TIFF_AXES] = {"SizeC", "SizeZ", "SizeT"};
    char value[VALUE];
    shape s = {.width = attribute_size(tag, "SizeX"), .height = attribute_size(tag, "SizeY")};
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++) s.sizes[axis] = attribute_size(tag, sizes[axis]);
    memcpy(s.order, m->order, sizeof s.order);
    if (attribute_text(tag, "DimensionOrder", value) && strncmp(value, "XY", 2) == 0)
        parse_order(value + 2, s.order);
    return s;
}

static void parse_spacing(part tag, iso_tiff_metadata *m) {
    char name[32], value[VALUE];
    for (int i = 0; i < 3; i++) {
        double unit = 1e-3; /* the schema's default is the micrometre */
        snprintf(name, sizeof name, "PhysicalSize%cUnit", "XYZ"[i]);
        if (attribute_text(tag, name, value)) unit = iso_format_unit(value);
        snprintf(name, sizeof name, "PhysicalSize%c", "XYZ"[i]);
        if (attribute_text(tag, name, value)) m->spacing[i] = length_of(value) * unit;
    }
}

/* ---- channels */

/* Copies text of XML with the characters that its entities stand for. */
static void copy_name(part text, char name[ISO_CHANNEL_NAME]) {
    static const struct {
        const char *entity;
        char character;
    } entities[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
    size_t used = 0;
    while (text.at < text.end && used < ISO_CHANNEL_NAME - 1) {
        size_t length = 1;
        name[used] = *text.at;
        for (size_t i = 0; i < sizeof entities / sizeof *entities; i++) {
            const size_t entity = strlen(entities[i].entity);
            if ((size_t)(text.end - text.at) < entity || memcmp(text.at, entities[i].entity, entity) != 0)
                continue;
            name[used] = entities[i].character;
            length = entity;
        }
        text.at += length;
        used++;
    }
    name[used] = 0;
}

/* The attribute Color is a 32-bit integer RGBA, whose sign is that of its highest bit. */
static void parse_color(part tag, iso_channel *channel) {
    char value[VALUE], *end;
    if (!attribute_text(tag, "Color", value)) return;
    const long long rgba = strtoll(value, &end, 10);
    if (end == value || *end || rgba < INT32_MIN || rgba > UINT32_MAX) return;
    channel->colored = true;
    channel->color = (iso_rgb){(uint8_t)(rgba >> 24), (uint8_t)(rgba >> 16), (uint8_t)(rgba >> 8)};
}

/* Lists the elements Channel of a position. */
static void parse_channels(part body, iso_tiff_metadata *m) {
    static const char word[] = "<Channel";
    const char *at = find(body, word);
    for (; at && m->channels.count < ISO_CHANNELS; at = find((part){at + 1, body.end}, word)) {
        const part tag = tag_at(at, body.end);
        part name;
        if (!strchr(" \t\r\n/>", at[strlen(word)])) continue; /* an element with a longer name */
        iso_channel *channel = &m->channels.items[m->channels.count++];
        if (attribute(tag, "Name", &name)) copy_name(name, channel->name);
        parse_color(tag, channel);
    }
}

/* The parser of the elements TiffData. */
typedef struct run_parser {
    const iso_slice_files *files;
    uint32_t last; /* the file that was found last */
    part uuid;     /* of the file with the description; empty: not stated */
    iso_tiff_metadata *metadata;
} run_parser;

static bool are_equal(part a, part b) {
    return a.end - a.at == b.end - b.at && memcmp(a.at, b.at, (size_t)(a.end - a.at)) == 0;
}

/* The number of the file with this name; files->count: it is not in the stack. */
static uint32_t file_called(run_parser *p, part name) {
    for (uint32_t i = 0; i < p->files->count; i++) {
        const uint32_t number = (p->last + i) % p->files->count;
        const char *path = p->files->paths[number], *slash = strrchr(path, '/');
        if (slash) path = slash + 1;
        if (are_equal(name, (part){path, path + strlen(path)})) return p->last = number;
    }
    return p->files->count;
}

/* The file of an element TiffData, which names it in an element UUID unless it is the one with the
 * description. */
static uint32_t file_of(run_parser *p, part element) {
    part name;
    const char *uuid = find(element, "<UUID");
    if (!uuid) return 0;
    const part tag = tag_at(uuid, element.end);
    if (tag.end == element.end) return p->files->count;
    part text = {tag.end + 1, element.end};
    const char *close = find(text, "</UUID");
    if (close) text.end = close;
    if (p->uuid.at && are_equal(text, p->uuid)) return 0;
    return attribute(tag, "FileName", &name) ? file_called(p, name) : p->files->count;
}

static iso_status add_run(run_parser *p, const iso_tiff_run *run, iso_error *error) {
    iso_tiff_metadata *m = p->metadata;
    if (m->run_count == MOST_RUNS)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its metadata have more than %d elements TiffData",
                        p->files->paths[0], MOST_RUNS);
    if (m->run_count == m->run_room) {
        const size_t room = m->run_room ? 2 * m->run_room : 64;
        iso_tiff_run *runs = realloc(m->runs, room * sizeof *runs);
        if (!runs) return iso_fail_memory(error, p->files->paths[0]);
        m->runs = runs;
        m->run_room = room;
    }
    m->runs[m->run_count++] = *run;
    return ISO_OK;
}

/* Lists the elements TiffData of a position, which `body` contains. */
static iso_status parse_runs(run_parser *p, part body, uint32_t position, iso_error *error) {
    static const char *const first[ISO_TIFF_AXES] = {"FirstC", "FirstZ", "FirstT"};
    const char *next = find(body, "<TiffData");
    while (next) {
        const char *at = next;
        next = find((part){at + 1, body.end}, "<TiffData");
        const part element = {at, next ? next : body.end}, tag = tag_at(at, element.end);
        part ifd;
        iso_tiff_run run = {.position = position, .file = file_of(p, element)};
        for (int axis = 0; axis < ISO_TIFF_AXES; axis++) run.first[axis] = attribute_size(tag, first[axis]);
        run.page = attribute_size(tag, "IFD");
        run.count = attribute_size(tag, "PlaneCount");
        if (!run.count) run.count = attribute(tag, "IFD", &ifd) ? 1 : UINT32_MAX;
        if (run.file < p->files->count) ISO_TRY(add_run(p, &run, error));
    }
    return ISO_OK;
}

static iso_status parse_ome(const char *text, const iso_slice_files *files, iso_tiff_metadata *m,
                            iso_error *error) {
    const part all = {text, text + strlen(text)};
    run_parser parser = {.files = files, .metadata = m};
    shape first = {0};
    const char *next = find(all, "<Pixels");
    if (!attribute(tag_at(find(all, "<OME"), all.end), "UUID", &parser.uuid)) parser.uuid = (part){0};
    m->writer = "OME";
    m->positions = 0;
    while (next) {
        const char *at = next;
        next = find((part){at + 1, all.end}, "<Pixels");
        const part body = {at, next ? next : all.end}, tag = tag_at(at, body.end);
        const shape s = parse_shape(tag, m);
        if (m->positions == 0) {
            first = s;
            memcpy(m->order, s.order, sizeof m->order);
            memcpy(m->sizes, s.sizes, sizeof m->sizes);
            parse_spacing(tag, m);
            parse_channels(body, m);
        } else if (memcmp(&s, &first, sizeof s) != 0) {
            continue;
        }
        ISO_TRY(parse_runs(&parser, body, m->positions++, error));
    }
    return ISO_OK;
}

iso_status iso_tiff_metadata_parse(const char *description, const iso_slice_files *files,
                                   iso_tiff_metadata *metadata, iso_error *error) {
    *metadata =
        (iso_tiff_metadata){.order = {ISO_TIFF_CHANNEL, ISO_TIFF_SLICE, ISO_TIFF_TIME}, .positions = 1};
    if (!description) return ISO_OK;
    if (strncmp(description, "ImageJ=", 7) == 0) {
        parse_imagej(description, metadata);
        return ISO_OK;
    }
    return strstr(description, "<OME") && strstr(description, "<Pixels")
               ? parse_ome(description, files, metadata, error)
               : ISO_OK;
}

void iso_tiff_metadata_free(iso_tiff_metadata *metadata) {
    free(metadata->runs);
    metadata->runs = NULL;
}
