/* Writes the lines of a stroke file as JSON objects, and reads them (jansson). The last member of each line
 * is the CRC-32C of the text before it. Every number is checked against its bounds when it is read. */
#include "sculpt/session/event.h"

#include <jansson.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/crc32c.h"
#include "base/memory.h"
#include "sculpt/limits.h"
#include "sculpt/session/event_limits.h"

static const char FORMAT[] = "isopoint strokes";
static const char *const KINDS[] = {"begin",    "sample", "end",  "cancel", "undo", "redo",
                                    "snapshot", "stamp",  "edit", "delete", "mute", "unmute",
                                    "move",     "group",  "path", "reseat"};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

/* The number of characters of the end of a line: `,"crc":"xxxxxxxx"}`. */
enum { CRC_TEXT = 18 };

/* ---- writing */

/* Returns the text of a line: the object's members, then its checksum; malloc'ed; NULL: out of memory.
 * Releases `object`, which may be NULL. */
static char *finish_line(json_t *object) {
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
    json_t *header =
        json_pack("{ss si ss si sf s[iii] so sf sf}", "format", FORMAT, "version",
                  start->solid.size.x > 0 ? 5
                  : start->has_colors     ? 4
                  : start->has_edits      ? 3
                  : plain                 ? 1
                                          : 2,
                  "source", start->source, "source_crc", (int)start->source_crc, "voxel_size",
                  start->voxel_size, "dims", start->dims[0], start->dims[1], start->dims[2], "origin",
                  vector_json(start->origin), "radius", start->radius, "isovalue", start->isovalue);
    int failed = header && start->reading[0] &&
                 json_object_set_new(header, "reading", json_string_nocheck(start->reading));
    if (header && start->solid.size.x > 0)
        failed |= json_object_set_new(header, "size", vector_json(start->solid.size)) ||
                  json_object_set_new(header, "round", json_real(start->solid.round));
    if (header && start->has_colors) failed |= json_object_set_new(header, "colors", json_true());
    if (!failed) return finish_line(header);
    json_decref(header);
    return NULL;
}

static json_t *brush_json(const iso_brush *brush) {
    json_t *object = json_pack(
        "{ss ss ss sf sf sf sf sf si so sb sb}", "tool", iso_tool_name(brush->tool), "shape",
        iso_solid_name(brush->shape), "falloff", iso_falloff_name(brush->falloff), "radius", brush->radius,
        "strength", brush->strength, "aspect", brush->aspect, "blend", brush->blend, "spacing",
        brush->spacing, "symmetry", (int)brush->symmetry, "mirror", vector_json(brush->mirror),
        "pressure_radius", brush->pressure_radius, "pressure_strength", brush->pressure_strength);
    char color[8], axis[2] = {(char)('x' + iso_brush_radial_axis(brush)), 0};
    int failed = !object;
    if (!failed && iso_brush_is_radial(brush))
        failed |= json_object_set_new(object, "radial", json_integer(brush->radial)) ||
                  json_object_set_new(object, "radial_axis", json_string(axis));
    if (!failed && iso_brush_is_repeated(brush))
        failed |= json_object_set_new(object, "repeat",
                                      json_pack("[ii]", (int)brush->repeat[0], (int)brush->repeat[1])) ||
                  json_object_set_new(
                      object, "repeat_by",
                      json_pack("[oo]", vector_json(brush->repeat_by[0]), vector_json(brush->repeat_by[1])));
    snprintf(color, sizeof color, "#%02x%02x%02x", brush->color.r, brush->color.g, brush->color.b);
    if (!failed && brush->alpha != ISO_ALPHA_NONE)
        failed |= json_object_set_new(object, "alpha", json_string(iso_alpha_name(brush->alpha)));
    if (!failed && brush->has_color) failed |= json_object_set_new(object, "color", json_string(color));
    if (!failed) return object;
    json_decref(object);
    return NULL;
}

/* Adds the name and the levels of a stamp to an object, or of a picture its size, heights and their CRC-32C.
 * Nonzero: out of memory. */
static int add_stamp_members(json_t *object, const iso_stamp *stamp) {
    const iso_heights *h = &stamp->heights;
    char *text = iso_stamp_text(stamp);
    const iso_voxel_set *voxels = &stamp->voxels;
    const char *key = voxels->word ? "frozen" : h->value ? "heights" : "levels";
    int failed = !text || json_object_set_new(object, "name", json_string_nocheck(stamp->name)) ||
                 json_object_set_new(object, key, json_string_nocheck(text));
    if (!failed && voxels->word)
        failed |=
            json_object_set_new(object, "dims",
                                json_pack("[iii]", voxels->dims[0], voxels->dims[1], voxels->dims[2])) ||
            json_object_set_new(object, "spacing", json_real(voxels->spacing)) ||
            json_object_set_new(object, "origin", vector_json(voxels->origin));
    if (!failed && h->value)
        failed |= json_object_set_new(object, "size", json_pack("[ii]", h->width, h->height)) ||
                  json_object_set_new(object, "checksum", json_integer(iso_crc32c(0, text, strlen(text))));
    free(text);
    return failed;
}

/* The samples of a path, eight numbers each. NULL: out of memory. */
static json_t *path_json(const iso_event *event) {
    json_t *path = json_array();
    int failed = !path;
    for (size_t i = 0; !failed && i < event->path_count; i++) {
        const iso_sample *s = &event->path[i];
        failed |= json_array_append_new(path, json_pack("[ffffffff]", s->position.x, s->position.y,
                                                        s->position.z, s->normal.x, s->normal.y, s->normal.z,
                                                        s->pressure, s->seconds));
    }
    if (!failed) return path;
    json_decref(path);
    return NULL;
}

/* Adds which strokes an edit names: by their numbers, or by their group. Nonzero: out of memory. */
static int add_strokes(json_t *object, const iso_event *event) {
    if (!event->first) return json_object_set_new(object, "group", json_string_nocheck(event->text));
    int failed = json_object_set_new(object, "stroke", json_integer(event->first));
    if (event->last != event->first) failed |= json_object_set_new(object, "last", json_integer(event->last));
    return failed;
}

char *iso_event_text(const iso_event *event, unsigned long long number) {
    json_t *object = json_pack("{sI ss}", "n", (json_int_t)number, "event", KINDS[event->kind]);
    int failed = !object;
    if (!failed && iso_event_is_edit(event->kind)) failed |= add_strokes(object, event);
    if (!failed && event->before)
        failed |= json_object_set_new(object, "before", json_integer(event->before));
    if (!failed && event->kind == ISO_EVENT_GROUP)
        failed |= json_object_set_new(object, "group", json_string(event->text));
    if (!failed && iso_event_has_path(event->kind))
        failed |= json_object_set_new(object, "path", path_json(event));
    if (!failed && (event->kind == ISO_EVENT_BEGIN || event->kind == ISO_EVENT_EDIT))
        failed |= json_object_set_new(object, "brush", brush_json(&event->brush));
    if (!failed && event->kind <= ISO_EVENT_SAMPLE) {
        const iso_sample *s = &event->sample;
        failed |= json_object_set_new(object, "at", vector_json(s->position));
        failed |= json_object_set_new(object, "normal", vector_json(s->normal));
        failed |= json_object_set_new(object, "pressure", json_real(s->pressure));
        failed |= json_object_set_new(object, "t", json_real(s->seconds));
    }
    if (!failed && event->kind == ISO_EVENT_CHECKPOINT) {
        failed |= json_object_set_new(object, "file", json_string(event->text));
        failed |= json_object_set_new(object, "after", json_integer((json_int_t)event->after));
    }
    if (!failed && event->kind == ISO_EVENT_STAMP) failed |= add_stamp_members(object, event->stamp);
    if (!failed) return finish_line(object);
    json_decref(object);
    return NULL;
}

/* ---- reading: failures are ISO_ERR_FORMAT with a message that says what is wrong, or ISO_ERR_NOMEM */

static _Thread_local bool was_refused;

static void *allocate(size_t bytes) {
    void *block = malloc(bytes);
    if (!block) was_refused = true;
    return block;
}

static void watch_memory(void) {
    json_set_alloc_funcs(allocate, free);
}

/* Parses the JSON of a line. NULL: it is none, or there is no memory, which jansson does not always tell:
 * members can be missing then. */
static json_t *parse_json(const char *line, size_t size, iso_error *error) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, watch_memory);
    was_refused = false;
    json_t *object = json_loadb(line, size, JSON_REJECT_DUPLICATES, NULL);
    if (object && !was_refused) return object;
    json_decref(object);
    iso_fail(error, was_refused ? ISO_ERR_NOMEM : ISO_ERR_FORMAT, "%s",
             was_refused ? "out of memory" : "it is not JSON");
    return NULL;
}

/* Verifies the checksum of a line and parses the JSON. If the line is sound, the caller releases *object. */
static iso_line parse_line(const char *line, size_t size, json_t **object, iso_error *error) {
    unsigned crc;
    if (size < CRC_TEXT || memcmp(line + size - CRC_TEXT, ",\"crc\":\"", 8) ||
        memcmp(line + size - 2, "\"}", 2)) {
        iso_fail(error, ISO_ERR_FORMAT, "it is not whole: it does not end with its checksum");
        return ISO_LINE_TORN;
    }
    char digits[9] = {0};
    memcpy(digits, line + size - 10, 8);
    if (strspn(digits, "0123456789abcdef") != 8 || sscanf(digits, "%8x", &crc) != 1 ||
        crc != iso_crc32c(0, line, size - CRC_TEXT)) {
        iso_fail(error, ISO_ERR_FORMAT, "its checksum is wrong");
        return ISO_LINE_TORN;
    }
    *object = parse_json(line, size, error);
    return *object ? ISO_LINE_SOUND : ISO_LINE_WRONG;
}

static iso_status bad_member(const char *key, const char *wanted, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' is missing or is not %s", key, wanted);
}

static iso_status get_number(const json_t *object, const char *key, double *value, iso_error *error) {
    const json_t *found = json_object_get(object, key);
    if (!json_is_number(found)) return bad_member(key, "a number", error);
    *value = json_number_value(found);
    return ISO_OK;
}

/* Reads an integer member, which must be within the bounds of `limit`. */
static iso_status get_integer(const json_t *object, const char *key, iso_limit limit, json_int_t *value,
                              iso_error *error) {
    const json_t *found = json_object_get(object, key);
    if (!json_is_integer(found)) return bad_member(key, "a whole number", error);
    *value = json_integer_value(found);
    return iso_limit_check(limit, (double)*value, 1, error);
}

/* Reads three numbers, which are an array of the name `key`. */
static iso_status read_vector(const json_t *found, const char *key, iso_vec3 *v, iso_error *error) {
    double *out[3] = {&v->x, &v->y, &v->z};
    if (json_array_size(found) != 3) return bad_member(key, "three numbers", error);
    for (size_t i = 0; i < 3; i++) {
        if (!json_is_number(json_array_get(found, i))) return bad_member(key, "three numbers", error);
        *out[i] = json_number_value(json_array_get(found, i));
    }
    return ISO_OK;
}

static iso_status get_vector(const json_t *object, const char *key, iso_vec3 *v, iso_error *error) {
    return read_vector(json_object_get(object, key), key, v, error);
}

static iso_status get_text(const json_t *object, const char *key, char out[ISO_JOURNAL_TEXT],
                           iso_error *error) {
    const char *text = json_string_value(json_object_get(object, key));
    if (!text) return bad_member(key, "a text", error);
    if (strlen(text) >= ISO_JOURNAL_TEXT)
        return iso_fail(error, ISO_ERR_FORMAT, "'%s' has %zu bytes, at most %d", key, strlen(text),
                        ISO_JOURNAL_TEXT - 1);
    strcpy(out, text);
    return ISO_OK;
}

static iso_status get_flag(const json_t *object, const char *key, bool *flag, iso_error *error) {
    const json_t *found = json_object_get(object, key);
    *flag = json_is_true(found);
    return json_is_boolean(found) ? ISO_OK : bad_member(key, "true or false", error);
}

static iso_status get_dims(const json_t *object, int dims[3], iso_error *error) {
    const json_t *found = json_object_get(object, "dims");
    if (json_array_size(found) != 3) return bad_member("dims", "three numbers", error);
    for (size_t i = 0; i < 3; i++) {
        const json_int_t n = json_integer_value(json_array_get(found, i));
        ISO_TRY(iso_limit_check(ISO_LIMIT_DIMS, (double)n, 1, error));
        dims[i] = (int)n;
    }
    return ISO_OK;
}

static iso_status check_kind(const json_t *object, iso_error *error) {
    const char *format = json_string_value(json_object_get(object, "format"));
    if (!format || strcmp(format, FORMAT))
        return iso_fail(error, ISO_ERR_FORMAT, "it does not begin a stroke file");
    const json_int_t version = json_integer_value(json_object_get(object, "version"));
    if (version > ISO_JOURNAL_VERSION)
        return iso_fail(error, ISO_ERR_FORMAT, "it was written by a newer version");
    return version >= 1 ? ISO_OK : bad_member("version", "a version's number", error);
}

/* Reads the solid that the session begins with, which is named as the source. */
static iso_status read_solid(const json_t *object, iso_journal_start *start, iso_error *error) {
    start->solid = (iso_start_solid){.round = 0};
    if (!json_object_get(object, "size")) return ISO_OK;
    if (iso_solid_find(start->source, &start->solid.kind, NULL) != ISO_OK)
        return bad_member("source", "a solid of this version", error);
    ISO_TRY(get_vector(object, "size", &start->solid.size, error));
    ISO_TRY(get_number(object, "round", &start->solid.round, error));
    return start->solid.size.x > 0 ? ISO_OK : bad_member("size", "positive", error);
}

static iso_status read_header(const json_t *object, iso_journal_start *start, iso_error *error) {
    json_int_t crc = 0;
    ISO_TRY(check_kind(object, error));
    start->voxel_isovalue = json_integer_value(json_object_get(object, "version")) < 2;
    start->has_edits = json_integer_value(json_object_get(object, "version")) >= 3;
    start->has_colors = json_is_true(json_object_get(object, "colors"));
    start->reading[0] = 0;
    if (json_object_get(object, "reading")) ISO_TRY(get_text(object, "reading", start->reading, error));
    ISO_TRY(get_text(object, "source", start->source, error));
    ISO_TRY(get_integer(object, "source_crc", ISO_LIMIT_CHECKSUM, &crc, error));
    start->source_crc = (uint32_t)crc;
    ISO_TRY(get_number(object, "voxel_size", &start->voxel_size, error));
    ISO_TRY(get_dims(object, start->dims, error));
    ISO_TRY(get_vector(object, "origin", &start->origin, error));
    ISO_TRY(get_number(object, "radius", &start->radius, error));
    ISO_TRY(get_number(object, "isovalue", &start->isovalue, error));
    ISO_TRY(read_solid(object, start, error));
    return iso_limits_start(start, error);
}

iso_line iso_event_header_read(const char *line, size_t size, iso_journal_start *start, iso_error *why) {
    json_t *object = NULL;
    iso_line state = parse_line(line, size, &object, why);
    if (state != ISO_LINE_SOUND) return state;
    if (read_header(object, start, why) != ISO_OK) state = ISO_LINE_WRONG;
    json_decref(object);
    return state;
}

static const char *text_of(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static iso_status read_names(const json_t *object, iso_brush *brush, iso_error *error) {
    if (iso_tool_find(text_of(object, "tool"), &brush->tool, NULL) != ISO_OK)
        return bad_member("tool", "a brush of this version", error);
    if (iso_solid_find(text_of(object, "shape"), &brush->shape, NULL) != ISO_OK)
        return bad_member("shape", "a shape of this version", error);
    if (iso_falloff_find(text_of(object, "falloff"), &brush->falloff, NULL) != ISO_OK)
        return bad_member("falloff", "a falloff of this version", error);
    return ISO_OK;
}

/* Reads the colour of a brush, "#rrggbb"; many have none. */
static iso_status read_color(const json_t *object, iso_brush *brush, iso_error *error) {
    const json_t *found = json_object_get(object, "color");
    const char *text = json_string_value(found);
    unsigned r, g, b;
    brush->has_color = found != NULL;
    if (!found) return ISO_OK;
    if (!text || strlen(text) != 7 || text[0] != '#' || strspn(text + 1, "0123456789abcdef") != 6 ||
        sscanf(text + 1, "%2x%2x%2x", &r, &g, &b) != 3)
        return bad_member("color", "a colour #rrggbb", error);
    brush->color = (iso_rgb){(uint8_t)r, (uint8_t)g, (uint8_t)b};
    return ISO_OK;
}

/* Reads the radial symmetry of a brush; many have none. */
static iso_status read_radial(const json_t *object, iso_brush *brush, iso_error *error) {
    const char *axis = text_of(object, "radial_axis");
    json_int_t radial = 0;
    if (!json_object_get(object, "radial")) return ISO_OK;
    ISO_TRY(get_integer(object, "radial", ISO_LIMIT_RADIAL, &radial, error));
    if (strlen(axis) != 1 || !strchr("xyz", *axis)) return bad_member("radial_axis", "x, y or z", error);
    brush->radial = (unsigned)radial;
    brush->radial_axis = *axis;
    return ISO_OK;
}

/* Reads how the images of a brush are repeated; many are not. */
static iso_status read_repeat(const json_t *object, iso_brush *brush, iso_error *error) {
    const json_t *counts = json_object_get(object, "repeat"), *by = json_object_get(object, "repeat_by");
    if (!counts && !by) return ISO_OK;
    if (json_array_size(counts) != 2) return bad_member("repeat", "two whole numbers", error);
    if (json_array_size(by) != 2) return bad_member("repeat_by", "two places", error);
    for (size_t i = 0; i < 2; i++) {
        const json_t *count = json_array_get(counts, i);
        if (!json_is_integer(count)) return bad_member("repeat", "two whole numbers", error);
        ISO_TRY(iso_limit_check(ISO_LIMIT_REPEAT, (double)json_integer_value(count), 1, error));
        brush->repeat[i] = (unsigned)json_integer_value(count);
        ISO_TRY(read_vector(json_array_get(by, i), "repeat_by", &brush->repeat_by[i], error));
    }
    return ISO_OK;
}

static iso_status read_brush(const json_t *object, iso_brush *brush, iso_error *error) {
    if (!json_is_object(object)) return bad_member("brush", "an object", error);
    json_int_t symmetry = 0;
    ISO_TRY(read_names(object, brush, error));
    ISO_TRY(get_number(object, "radius", &brush->radius, error));
    ISO_TRY(get_number(object, "strength", &brush->strength, error));
    ISO_TRY(get_number(object, "aspect", &brush->aspect, error));
    ISO_TRY(get_number(object, "blend", &brush->blend, error));
    ISO_TRY(get_number(object, "spacing", &brush->spacing, error));
    ISO_TRY(get_integer(object, "symmetry", ISO_LIMIT_SYMMETRY, &symmetry, error));
    brush->symmetry = (unsigned)symmetry;
    ISO_TRY(get_vector(object, "mirror", &brush->mirror, error));
    ISO_TRY(read_radial(object, brush, error));
    ISO_TRY(read_repeat(object, brush, error));
    if (json_object_get(object, "alpha") &&
        iso_alpha_find(text_of(object, "alpha"), &brush->alpha, NULL) != ISO_OK)
        return bad_member("alpha", "an alpha of this version", error);
    ISO_TRY(get_flag(object, "pressure_radius", &brush->pressure_radius, error));
    ISO_TRY(get_flag(object, "pressure_strength", &brush->pressure_strength, error));
    return read_color(object, brush, error);
}

static iso_status read_sample(const json_t *object, iso_sample *sample, iso_error *error) {
    ISO_TRY(get_vector(object, "at", &sample->position, error));
    ISO_TRY(get_vector(object, "normal", &sample->normal, error));
    ISO_TRY(get_number(object, "pressure", &sample->pressure, error));
    return get_number(object, "t", &sample->seconds, error);
}

/* Reads the members of a checkpoint. Lines of older versions have no `after`: the checkpoint holds the field
 * after all events before the line. */
static iso_status read_checkpoint(const json_t *object, unsigned long long number, iso_event *event,
                                  iso_error *error) {
    const json_t *after = json_object_get(object, "after");
    const json_int_t events = after ? json_integer_value(after) : (json_int_t)number;
    if ((after && !json_is_integer(after)) || events < 0 || (unsigned long long)events > number)
        return iso_fail(error, ISO_ERR_FORMAT, "a snapshot after %lld of %llu events", (long long)events,
                        number);
    event->after = (unsigned long long)events;
    return get_text(object, "file", event->text, error);
}

static iso_status read_picture(const json_t *object, const char *name, const char *text, iso_event *event,
                               iso_error *error) {
    const json_t *size = json_object_get(object, "size");
    json_int_t checksum;
    if (json_array_size(size) != 2) return bad_member("size", "two whole numbers", error);
    const double width = json_number_value(json_array_get(size, 0)),
                 height = json_number_value(json_array_get(size, 1));
    ISO_TRY(iso_limit_check(ISO_LIMIT_PICTURE, width, 1, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_PICTURE, height, 1, error));
    ISO_TRY(get_integer(object, "checksum", ISO_LIMIT_CHECKSUM, &checksum, error));
    if ((uint32_t)checksum != iso_crc32c(0, text, strlen(text)))
        return iso_fail(error, ISO_ERR_FORMAT, "the checksum of the stamp's heights is wrong");
    return iso_stamp_parse_picture(name, (int)width, (int)height, text, &event->stamp, error);
}

/* Reads voxels to freeze, whose grid has the bounds of a session's. */
static iso_status read_voxels(const json_t *object, const char *name, const char *text, iso_event *event,
                              iso_error *error) {
    iso_voxel_set frame = {.word = NULL};
    ISO_TRY(get_dims(object, frame.dims, error));
    ISO_TRY(get_number(object, "spacing", &frame.spacing, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_VOXEL_SIZE, frame.spacing, 1, error));
    ISO_TRY(get_vector(object, "origin", &frame.origin, error));
    const double origin[] = {frame.origin.x, frame.origin.y, frame.origin.z};
    for (int axis = 0; axis < 3; axis++)
        ISO_TRY(iso_limit_check(ISO_LIMIT_ORIGIN, origin[axis], frame.spacing, error));
    const iso_status status = iso_stamp_parse_voxels(name, &frame, text, &event->stamp, error);
    return status == ISO_ERR_LIMIT ? ISO_ERR_FORMAT : status;
}

static iso_status read_stamp(const json_t *object, iso_event *event, iso_error *error) {
    const char *name = json_string_value(json_object_get(object, "name")),
               *text = json_string_value(json_object_get(object, "levels")),
               *heights = json_string_value(json_object_get(object, "heights")),
               *frozen = json_string_value(json_object_get(object, "frozen"));
    if (!name) return bad_member("name", "a text", error);
    if (frozen) return read_voxels(object, name, frozen, event, error);
    if (heights) return read_picture(object, name, heights, event, error);
    if (!text) return bad_member("levels", "a text", error);
    return iso_stamp_parse(name, text, &event->stamp, error);
}

/* Reads the number of a stroke; a member that is missing leaves *number as it is. */
static iso_status read_number(const json_t *object, const char *key, unsigned *number, iso_error *error) {
    json_int_t value = *number;
    if (json_object_get(object, key)) ISO_TRY(get_integer(object, key, ISO_LIMIT_STROKE, &value, error));
    *number = (unsigned)value;
    return ISO_OK;
}

/* Reads what an edit says of strokes: the first and the last (the same if it is missing), or their group. */
static iso_status read_range(const json_t *object, iso_event *event, iso_error *error) {
    const bool one = event->kind == ISO_EVENT_EDIT || event->kind == ISO_EVENT_PATH;
    if (!one && event->kind != ISO_EVENT_GROUP && event->kind != ISO_EVENT_RESEAT &&
        !json_object_get(object, "stroke") && json_object_get(object, "group")) {
        ISO_TRY(get_text(object, "group", event->text, error));
        return event->text[0] ? ISO_OK : bad_member("group", "a group's name", error);
    }
    ISO_TRY(read_number(object, "stroke", &event->first, error));
    if (!event->first) return bad_member("stroke", "a whole number", error);
    event->last = event->first;
    ISO_TRY(read_number(object, "last", &event->last, error));
    if (event->last < event->first || (one && event->last != event->first))
        return iso_fail(error, ISO_ERR_FORMAT, "strokes %u to %u", event->first, event->last);
    if (event->kind == ISO_EVENT_GROUP) return get_text(object, "group", event->text, error);
    return ISO_OK;
}

static iso_status read_path(const json_t *object, iso_event *event, iso_error *error) {
    enum { NUMBERS = 8 };
    const json_t *path = json_object_get(object, "path");
    const size_t count = json_array_size(path);
    if (!count) return bad_member("path", "an array of samples", error);
    iso_sample *samples = iso_alloc(count * sizeof *samples);
    if (!samples) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a path of %zu samples", count);
    event->path = samples;
    event->path_count = count;
    for (size_t i = 0; i < count; i++) {
        const json_t *numbers = json_array_get(path, i);
        double value[NUMBERS];
        bool whole = json_array_size(numbers) == NUMBERS;
        for (size_t k = 0; whole && k < NUMBERS; k++) {
            const json_t *number = json_array_get(numbers, k);
            whole = json_is_number(number);
            value[k] = json_number_value(number);
        }
        if (!whole) return bad_member("path", "an array of samples, of eight numbers each", error);
        samples[i] = (iso_sample){.position = {value[0], value[1], value[2]},
                                  .normal = {value[3], value[4], value[5]},
                                  .pressure = value[6],
                                  .seconds = value[7]};
    }
    return ISO_OK;
}

static iso_status read_event(const json_t *object, const iso_event_context *context, iso_event *event,
                             iso_error *error) {
    const json_t *number = json_object_get(object, "n");
    const char *name = text_of(object, "event");
    int kind = 0;
    if (!json_is_integer(number) || (unsigned long long)json_integer_value(number) != context->number)
        return iso_fail(error, ISO_ERR_FORMAT, "a line is missing before it");
    while (kind < KIND_COUNT && strcmp(name, KINDS[kind])) kind++;
    if (kind == KIND_COUNT) return bad_member("event", "an event of this version", error);
    event->kind = (iso_event_kind)kind;
    if (kind == ISO_EVENT_BEGIN || kind == ISO_EVENT_EDIT)
        ISO_TRY(read_brush(json_object_get(object, "brush"), &event->brush, error));
    if (iso_event_is_edit(event->kind)) ISO_TRY(read_range(object, event, error));
    if (kind == ISO_EVENT_BEGIN || kind == ISO_EVENT_MOVE)
        ISO_TRY(read_number(object, "before", &event->before, error));
    if (kind <= ISO_EVENT_SAMPLE) ISO_TRY(read_sample(object, &event->sample, error));
    if (iso_event_has_path(event->kind)) ISO_TRY(read_path(object, event, error));
    ISO_TRY(iso_limits_event(event, context->start, error));
    if (kind == ISO_EVENT_STAMP) return read_stamp(object, event, error);
    return kind == ISO_EVENT_CHECKPOINT ? read_checkpoint(object, context->number, event, error) : ISO_OK;
}

iso_line iso_event_read(const char *line, size_t size, const iso_event_context *context, iso_event *event,
                        iso_error *why) {
    json_t *object = NULL;
    iso_line state = parse_line(line, size, &object, why);
    if (state != ISO_LINE_SOUND) return state;
    memset(event, 0, sizeof *event);
    if (read_event(object, context, event, why) != ISO_OK) {
        state = ISO_LINE_WRONG;
        iso_free((void *)event->path);
        event->path = NULL;
    }
    json_decref(object);
    return state;
}
