#include "sculpt/event.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sculpt/crc32c.h"

static const char FORMAT[] = "isopoint strokes";
static const char *const KINDS[] = {"begin", "sample", "end", "cancel", "undo", "redo", "snapshot", "stamp"};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

/* What follows the line's own members: `,"crc":"xxxxxxxx"}`. */
enum { CRC_TEXT = 18 };

/* ---- writing */

/* Takes over `object`. */
static char *finish(json_t *object) {
    char *text = object ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL;
    json_decref(object);
    if (!text) return NULL;
    size_t size = strlen(text) - 1; /* without the closing brace */
    char *line = malloc(size + CRC_TEXT + 2);
    if (line) {
        memcpy(line, text, size);
        snprintf(line + size, CRC_TEXT + 2, ",\"crc\":\"%08x\"}\n", (unsigned)iso_crc32c(0, line, size));
    }
    free(text);
    return line;
}

static json_t *vector_json(iso_vec3 v) {
    return json_pack("[fff]", v.x, v.y, v.z);
}

char *iso_event_header_text(const iso_journal_start *start) {
    const bool plain = !start->reading[0] && (start->isovalue == 0 || start->voxel_isovalue);
    json_t *header = json_pack(
        "{ss si ss si sf s[iii] so sf sf}", "format", FORMAT, "version", plain ? 1 : ISO_JOURNAL_VERSION,
        "source", start->source, "source_crc", (int)start->source_crc, "voxel_size", start->voxel_size,
        "dims", start->dims[0], start->dims[1], start->dims[2], "origin", vector_json(start->origin),
        "radius", start->radius, "isovalue", start->isovalue);
    if (header && start->reading[0] &&
        json_object_set_new(header, "reading", json_string_nocheck(start->reading))) {
        json_decref(header);
        return NULL;
    }
    return finish(header);
}

static json_t *brush_json(const iso_brush *brush) {
    return json_pack("{ss ss ss sf sf sf sf sf si so sb sb}", "tool", iso_tool_name(brush->tool), "shape",
                     iso_solid_name(brush->shape), "falloff", iso_falloff_name(brush->falloff), "radius",
                     brush->radius, "strength", brush->strength, "aspect", brush->aspect, "blend",
                     brush->blend, "spacing", brush->spacing, "symmetry", (int)brush->symmetry, "mirror",
                     vector_json(brush->mirror), "pressure_radius", brush->pressure_radius,
                     "pressure_strength", brush->pressure_strength);
}

/* Nonzero when there is no memory for it. */
static int put_stamp(json_t *object, const iso_stamp *stamp) {
    char *text = iso_stamp_text(stamp);
    int failed = !text || json_object_set_new(object, "name", json_string_nocheck(stamp->name)) ||
                 json_object_set_new(object, "levels", json_string_nocheck(text));
    free(text);
    return failed;
}

char *iso_event_text(const iso_event *event, unsigned long long number) {
    json_t *object = json_pack("{sI ss}", "n", (json_int_t)number, "event", KINDS[event->kind]);
    int failed = !object;
    if (!failed && event->kind == ISO_EVENT_BEGIN)
        failed |= json_object_set_new(object, "brush", brush_json(&event->brush));
    if (!failed && event->kind <= ISO_EVENT_SAMPLE) {
        const iso_sample *s = &event->sample;
        failed |= json_object_set_new(object, "at", vector_json(s->position));
        failed |= json_object_set_new(object, "normal", vector_json(s->normal));
        failed |= json_object_set_new(object, "pressure", json_real(s->pressure));
        failed |= json_object_set_new(object, "t", json_real(s->seconds));
    }
    if (!failed && event->kind == ISO_EVENT_SNAPSHOT) {
        failed |= json_object_set_new(object, "file", json_string(event->text));
        failed |= json_object_set_new(object, "after", json_integer((json_int_t)event->after));
    }
    if (!failed && event->kind == ISO_EVENT_STAMP) failed |= put_stamp(object, event->stamp);
    if (!failed) return finish(object);
    json_decref(object);
    return NULL;
}

/* ---- reading */

/* The line as JSON when its checksum is right. */
static json_t *parse(const char *line, size_t size, const char **why) {
    unsigned crc;
    *why = "it is not whole";
    if (size < CRC_TEXT || memcmp(line + size - CRC_TEXT, ",\"crc\":\"", 8) ||
        memcmp(line + size - 2, "\"}", 2))
        return NULL;
    char digits[9] = {0};
    memcpy(digits, line + size - 10, 8);
    *why = "its checksum is wrong";
    if (sscanf(digits, "%8x", &crc) != 1 || crc != iso_crc32c(0, line, size - CRC_TEXT)) return NULL;
    *why = "it is not JSON";
    return json_loadb(line, size, JSON_REJECT_DUPLICATES, NULL);
}

static bool get_number(const json_t *object, const char *key, double *value) {
    const json_t *member = json_object_get(object, key);
    if (!json_is_number(member)) return false;
    *value = json_number_value(member);
    return isfinite(*value);
}

static bool get_vector(const json_t *object, const char *key, iso_vec3 *v) {
    const json_t *member = json_object_get(object, key);
    double *out[3] = {&v->x, &v->y, &v->z};
    if (json_array_size(member) != 3) return false;
    for (size_t i = 0; i < 3; i++) {
        if (!json_is_number(json_array_get(member, i))) return false;
        *out[i] = json_number_value(json_array_get(member, i));
    }
    return true;
}

static bool get_text(const json_t *object, const char *key, char out[ISO_JOURNAL_TEXT]) {
    const char *text = json_string_value(json_object_get(object, key));
    if (!text || strlen(text) >= ISO_JOURNAL_TEXT) return false;
    strcpy(out, text);
    return true;
}

static bool get_flag(const json_t *object, const char *key, bool *flag) {
    const json_t *member = json_object_get(object, key);
    *flag = json_is_true(member);
    return json_is_boolean(member);
}

static bool read_header(const json_t *object, iso_journal_start *start, const char **why) {
    const char *format = json_string_value(json_object_get(object, "format"));
    const json_t *dims = json_object_get(object, "dims");
    *why = "it does not begin a stroke file";
    if (!format || strcmp(format, FORMAT)) return false;
    *why = "it was written by a newer version";
    const json_int_t version = json_integer_value(json_object_get(object, "version"));
    if (version > ISO_JOURNAL_VERSION) return false;
    start->voxel_isovalue = version < 2;
    start->reading[0] = 0;
    *why = "a member is missing or has another type";
    for (size_t i = 0; i < 3; i++) {
        json_int_t n = json_integer_value(json_array_get(dims, i));
        if (n < 1 || n > 1 << 20) return false;
        start->dims[i] = (int)n;
    }
    start->source_crc = (uint32_t)json_integer_value(json_object_get(object, "source_crc"));
    if (json_object_get(object, "reading") && !get_text(object, "reading", start->reading)) return false;
    return get_text(object, "source", start->source) &&
           get_number(object, "voxel_size", &start->voxel_size) &&
           get_vector(object, "origin", &start->origin) && get_number(object, "radius", &start->radius) &&
           get_number(object, "isovalue", &start->isovalue);
}

bool iso_event_header_read(const char *line, size_t size, iso_journal_start *start, const char **why) {
    json_t *object = parse(line, size, why);
    if (!object) return false;
    bool good = read_header(object, start, why);
    json_decref(object);
    return good;
}

static bool get_name(const json_t *object, const char *key, const char **name) {
    *name = json_string_value(json_object_get(object, key));
    return *name != NULL;
}

static bool read_brush(const json_t *object, iso_brush *brush) {
    const char *tool, *shape, *falloff;
    json_int_t symmetry = json_integer_value(json_object_get(object, "symmetry"));
    brush->symmetry = symmetry >= 0 && symmetry < 8 ? (unsigned)symmetry : 8;
    return get_name(object, "tool", &tool) && iso_tool_find(tool, &brush->tool, NULL) == ISO_OK &&
           get_name(object, "shape", &shape) && iso_solid_find(shape, &brush->shape, NULL) == ISO_OK &&
           get_name(object, "falloff", &falloff) &&
           iso_falloff_find(falloff, &brush->falloff, NULL) == ISO_OK &&
           get_number(object, "radius", &brush->radius) && get_number(object, "strength", &brush->strength) &&
           get_number(object, "aspect", &brush->aspect) && get_number(object, "blend", &brush->blend) &&
           get_number(object, "spacing", &brush->spacing) && get_vector(object, "mirror", &brush->mirror) &&
           get_flag(object, "pressure_radius", &brush->pressure_radius) &&
           get_flag(object, "pressure_strength", &brush->pressure_strength) &&
           iso_brush_check(brush, NULL) == ISO_OK;
}

static bool read_sample(const json_t *object, iso_sample *sample) {
    return get_vector(object, "at", &sample->position) && get_vector(object, "normal", &sample->normal) &&
           get_number(object, "pressure", &sample->pressure) && get_number(object, "t", &sample->seconds);
}

/* Lines of older versions stand where they were taken. */
static bool read_snapshot(const json_t *object, unsigned long long number, iso_event *event) {
    const json_t *after = json_object_get(object, "after");
    const json_int_t events = after ? json_integer_value(after) : (json_int_t)number;
    event->after = (unsigned long long)events;
    return events >= 0 && event->after <= number && get_text(object, "file", event->text);
}

static bool read_stamp(const json_t *object, iso_event *event) {
    const char *name = json_string_value(json_object_get(object, "name")),
               *text = json_string_value(json_object_get(object, "levels"));
    return name && text && iso_stamp_parse(name, text, &event->stamp, NULL) == ISO_OK;
}

static bool read_event(const json_t *object, unsigned long long number, iso_event *event, const char **why) {
    const char *name = json_string_value(json_object_get(object, "event"));
    int kind = 0;
    *why = "a line is missing before it";
    if ((unsigned long long)json_integer_value(json_object_get(object, "n")) != number) return false;
    *why = "no such event";
    while (name && kind < KIND_COUNT && strcmp(name, KINDS[kind])) kind++;
    if (!name || kind == KIND_COUNT) return false;
    event->kind = (iso_event_kind)kind;
    *why = "a member is missing or out of range";
    if (kind == ISO_EVENT_BEGIN && !read_brush(json_object_get(object, "brush"), &event->brush)) return false;
    if (kind <= ISO_EVENT_SAMPLE && !read_sample(object, &event->sample)) return false;
    if (kind == ISO_EVENT_STAMP) return read_stamp(object, event);
    return kind != ISO_EVENT_SNAPSHOT || read_snapshot(object, number, event);
}

bool iso_event_read(const char *line, size_t size, unsigned long long number, iso_event *event,
                    const char **why) {
    json_t *object = parse(line, size, why);
    if (!object) return false;
    memset(event, 0, sizeof *event);
    bool good = read_event(object, number, event, why);
    json_decref(object);
    return good;
}
