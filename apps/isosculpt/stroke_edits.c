/* Parses edits of strokes: RANGE, or RANGE:REST, where a group's name can stand for RANGE. */
#include "apps/isosculpt/stroke_edits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/options.h"

static iso_status parse_number(const char *text, char **end, unsigned *number, iso_error *error) {
    const unsigned long value = text[0] >= '0' && text[0] <= '9' ? strtoul(text, end, 10) : 0;
    if (value < 1 || value > 1000000000)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' does not begin with a stroke's number", text);
    *number = (unsigned)value;
    return ISO_OK;
}

static iso_status parse_real(const char *key, const char *text, double *value, iso_error *error) {
    char *end;
    *value = strtod(text, &end);
    return end != text && !*end && isfinite(*value)
               ? ISO_OK
               : iso_fail(error, ISO_ERR_USAGE, "%s: '%s' is no number", key, text);
}

static iso_status parse_switch(const char *key, const char *text, bool *on, iso_error *error) {
    *on = strcmp(text, "on") == 0;
    return *on || strcmp(text, "off") == 0
               ? ISO_OK
               : iso_fail(error, ISO_ERR_USAGE, "%s: '%s' is neither on nor off", key, text);
}

static iso_status parse_symmetry(const char *text, unsigned *symmetry, iso_error *error) {
    *symmetry = 0;
    for (const char *at = strcmp(text, "none") == 0 ? "" : text; *at; at++) {
        if (*at < 'x' || *at > 'z')
            return iso_fail(error, ISO_ERR_USAGE, "symmetry: '%s' is none of x, y, z, xy, ... xyz, none",
                            text);
        *symmetry |= 1u << (*at - 'x');
    }
    return ISO_OK;
}

/* N, which may be followed by the axis; none. */
static iso_status parse_radial(const char *text, iso_brush *brush, iso_error *error) {
    char *end = (char *)text;
    brush->radial = 0;
    if (strcmp(text, "none") == 0) return ISO_OK;
    const unsigned long count = text[0] >= '0' && text[0] <= '9' ? strtoul(text, &end, 10) : 0;
    const bool axis = *end >= 'x' && *end <= 'z';
    if (count < 1 || count > ISO_RADIAL_MOST || end[axis])
        return iso_fail(
            error, ISO_ERR_USAGE,
            "radial: '%s' is neither a number of images, 1 to %d (6, or 6z with its axis), nor none", text,
            ISO_RADIAL_MOST);
    brush->radial = (unsigned)count;
    if (axis) brush->radial_axis = *end;
    return ISO_OK;
}

/* NxX/Y/Z, which +MxX/Y/Z may follow for rows; none. */
static iso_status parse_repeat(const char *text, iso_brush *brush, iso_error *error) {
    const char *at = text;
    brush->repeat[0] = brush->repeat[1] = 0;
    if (strcmp(text, "none") == 0) return ISO_OK;
    for (int i = 0; i < 2; i++) {
        iso_vec3 *by = &brush->repeat_by[i];
        int used = 0;
        const bool digit = *at >= '0' && *at <= '9';
        const int found =
            digit ? sscanf(at, "%3ux%lf/%lf/%lf%n", &brush->repeat[i], &by->x, &by->y, &by->z, &used) : 0;
        if (found != 4 || (at[used] && (at[used] != '+' || i)))
            return iso_fail(
                error, ISO_ERR_USAGE,
                "repeat: '%s' is neither NxX/Y/Z, a number of images and how far each is moved in "
                "mm (8x5/0/0; with rows 8x5/0/0+3x0/5/0), nor none",
                text);
        if (!at[used]) return ISO_OK;
        at += used + 1;
    }
    return ISO_OK;
}

/* Three coordinates, mm. (Commas separate the changes of a brush.) */
static iso_status parse_mirror(const char *text, iso_vec3 *mirror, iso_error *error) {
    int used = 0;
    const int found = sscanf(text, "%lf/%lf/%lf%n", &mirror->x, &mirror->y, &mirror->z, &used);
    return found == 3 && !text[used] && isfinite(mirror->x + mirror->y + mirror->z)
               ? ISO_OK
               : iso_fail(error, ISO_ERR_USAGE, "mirror: '%s' is not X/Y/Z, in mm", text);
}

static iso_status parse_brush_color(const char *text, iso_brush *brush, iso_error *error) {
    uint8_t rgb[3];
    brush->has_color = strcmp(text, "none") != 0;
    if (!brush->has_color) return ISO_OK;
    if (!iso_parse_color(text[0] == '#' ? text + 1 : text, rgb))
        return iso_fail(error, ISO_ERR_USAGE, "color: '%s' is neither #RRGGBB nor none", text);
    brush->color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return ISO_OK;
}

/* Sets a member of the brush. */
static iso_status change_brush(const char *key, const char *value, iso_brush *brush, iso_error *error) {
    const struct {
        const char *key;
        double *value;
    } reals[] = {{"radius", &brush->radius},
                 {"strength", &brush->strength},
                 {"aspect", &brush->aspect},
                 {"blend", &brush->blend},
                 {"spacing", &brush->spacing}};
    for (size_t i = 0; i < sizeof reals / sizeof *reals; i++)
        if (strcmp(key, reals[i].key) == 0) return parse_real(key, value, reals[i].value, error);
    if (strcmp(key, "tool") == 0) return iso_tool_find(value, &brush->tool, error);
    if (strcmp(key, "shape") == 0) return iso_solid_find(value, &brush->shape, error);
    if (strcmp(key, "falloff") == 0) return iso_falloff_find(value, &brush->falloff, error);
    if (strcmp(key, "color") == 0) return parse_brush_color(value, brush, error);
    if (strcmp(key, "symmetry") == 0) return parse_symmetry(value, &brush->symmetry, error);
    if (strcmp(key, "alpha") == 0) return iso_alpha_find(value, &brush->alpha, error);
    if (strcmp(key, "mirror") == 0) return parse_mirror(value, &brush->mirror, error);
    if (strcmp(key, "radial") == 0) return parse_radial(value, brush, error);
    if (strcmp(key, "repeat") == 0) return parse_repeat(value, brush, error);
    if (strcmp(key, "pressure-radius") == 0) return parse_switch(key, value, &brush->pressure_radius, error);
    if (strcmp(key, "pressure-strength") == 0)
        return parse_switch(key, value, &brush->pressure_strength, error);
    return iso_fail(
        error, ISO_ERR_USAGE,
        "'%s' is none of tool, shape, falloff, radius, strength, aspect, blend, spacing, color, symmetry, "
        "mirror, radial, repeat, alpha, pressure-radius, pressure-strength",
        key);
}

/* Applies KEY=VALUE,KEY=VALUE to a brush. */
static iso_status change_all(const char *changes, iso_brush *brush, iso_error *error) {
    char item[256];
    for (const char *at = changes;; at++) {
        const size_t length = strcspn(at, ",");
        if (length >= sizeof item) return iso_fail(error, ISO_ERR_USAGE, "'%s' is too long", at);
        memcpy(item, at, length);
        item[length] = 0;
        char *value = strchr(item, '=');
        if (!value) return iso_fail(error, ISO_ERR_USAGE, "'%s' is not KEY=VALUE", item);
        *value++ = 0;
        ISO_TRY(change_brush(item, value, brush, error));
        at += length;
        if (!*at) return ISO_OK;
    }
}

/* Parses a range of strokes, or the name of a group up to the last colon, if something follows that; *end:
 * behind it. */
static iso_status parse_strokes(isosculpt_edit *edit, bool has_rest, char **end, iso_error *error) {
    const char *text = edit->text, *colon = has_rest ? strrchr(text, ':') : NULL;
    const bool group = text[0] && (text[0] < '0' || text[0] > '9') && edit->kind != ISO_EVENT_GROUP &&
                       edit->kind != ISO_EVENT_RESEAT && (colon || !has_rest) && colon != text;
    if (group) {
        const size_t length = colon ? (size_t)(colon - text) : strlen(text);
        if (length >= sizeof edit->group)
            return iso_fail(error, ISO_ERR_USAGE, "the name of a group has at most %zu bytes here",
                            sizeof edit->group - 1);
        memcpy(edit->group, text, length);
        *end = (char *)text + length;
        return ISO_OK;
    }
    ISO_TRY(parse_number(text, end, &edit->first, error));
    edit->last = edit->first;
    if (**end == '-') ISO_TRY(parse_number(*end + 1, end, &edit->last, error));
    return edit->last < edit->first ? iso_fail(error, ISO_ERR_USAGE, "'%s' runs backwards", text) : ISO_OK;
}

iso_status isosculpt_edits_add(isosculpt_edits *edits, iso_event_kind kind, const char *text,
                               iso_error *error) {
    const bool has_rest = kind == ISO_EVENT_EDIT || kind == ISO_EVENT_MOVE || kind == ISO_EVENT_GROUP;
    isosculpt_edit edit = {.kind = kind, .text = text};
    char *end;
    if (edits->count == ISOSCULPT_EDITS)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d edits of strokes", ISOSCULPT_EDITS);
    ISO_TRY(parse_strokes(&edit, has_rest, &end, error));
    if (*end != (has_rest ? ':' : 0))
        return iso_fail(error, ISO_ERR_USAGE, has_rest ? "'%s' is not STROKES:..." : "'%s' is not N or N-M",
                        text);
    edit.rest = has_rest ? end + 1 : end;
    if (kind == ISO_EVENT_EDIT) ISO_TRY(change_all(edit.rest, &(iso_brush){.radius = 1}, error));
    if (kind == ISO_EVENT_GROUP && strlen(edit.rest) >= ISO_JOURNAL_TEXT)
        return iso_fail(error, ISO_ERR_USAGE, "the name of a group has at most %d bytes",
                        ISO_JOURNAL_TEXT - 1);
    unsigned before;
    if (kind == ISO_EVENT_MOVE && strcmp(edit.rest, "end") != 0) {
        ISO_TRY(parse_number(edit.rest, &end, &before, error));
        if (*end)
            return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither a stroke's number nor end", edit.rest);
    }
    edits->edit[edits->count++] = edit;
    return ISO_OK;
}

bool isosculpt_edit_names(const isosculpt_edit *edit, const iso_stroke *stroke) {
    return edit->first ? stroke->number >= edit->first && stroke->number <= edit->last
                       : strcmp(stroke->group, edit->group) == 0;
}

iso_status isosculpt_edit_event(const isosculpt_edit *edit, const iso_stroke *stroke, iso_event *event,
                                iso_error *error) {
    char *end;
    *event = (iso_event){.kind = edit->kind, .first = edit->first, .last = edit->last};
    if (edit->kind == ISO_EVENT_MOVE && strcmp(edit->rest, "end") != 0)
        ISO_TRY(parse_number(edit->rest, &end, &event->before, error));
    if (edit->kind == ISO_EVENT_GROUP) memcpy(event->text, edit->rest, strlen(edit->rest) + 1);
    if (!edit->first) memcpy(event->text, edit->group, sizeof edit->group);
    if (edit->kind != ISO_EVENT_EDIT) return ISO_OK;
    if (!stroke->number)
        return iso_fail(error, ISO_ERR_USAGE, "there is no stroke in the group '%s'", edit->group);
    event->first = event->last = stroke->number;
    event->brush = stroke->brush;
    return change_all(edit->rest, &event->brush, error);
}
