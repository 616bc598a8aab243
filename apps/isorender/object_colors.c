/* object_colors: colours of lines and glyphs: of one colour, by the direction of lines, or by the numbers of
 * an attribute. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/objects.h"
#include "base/memory.h"

const iso_attribute *isorender_attribute_find(const iso_attribute *attributes, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (strcmp(attributes[i].name, name) == 0) return &attributes[i];
    return NULL;
}

/* An attribute's number: the length of its vector when it has several components. */
static double number_at(const iso_attribute *attribute, size_t index) {
    const float *v = attribute->values + index * (size_t)attribute->components;
    if (attribute->components == 1) return (double)v[0];
    double square = 0;
    for (int k = 0; k < attribute->components; k++) square += (double)v[k] * (double)v[k];
    return sqrt(square);
}

bool isorender_attribute_range(const iso_attribute *attribute, size_t count, double range[2]) {
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double number = number_at(attribute, i);
        if (!isfinite(number)) continue;
        range[0] = fmin(range[0], number);
        range[1] = fmax(range[1], number);
    }
    return range[0] <= range[1];
}

static int compare_numbers(const void *a, const void *b) {
    const double p = *(const double *)a, q = *(const double *)b;
    return p < q ? -1 : p > q;
}

/* The numbers that these shares of an attribute's finite numbers do not exceed; of many, of a million that
 * are spread evenly over them. `range` stays as it is if there is none. ISO_ERR_NOMEM. */
static iso_status find_shares(const iso_attribute *attribute, size_t count, const double shares[2],
                              double range[2], iso_error *error) {
    enum { MOST = 1 << 20 };
    const size_t step = (count + MOST - 1) / MOST;
    size_t found = 0;
    double *numbers = iso_alloc((count / step + 1) * sizeof *numbers);
    if (!numbers) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the range of a column");
    for (size_t i = 0; i < count; i += step)
        if (isfinite(number_at(attribute, i))) numbers[found++] = number_at(attribute, i);
    qsort(numbers, found, sizeof *numbers, compare_numbers);
    for (int k = 0; k < 2 && found; k++) range[k] = numbers[(size_t)(shares[k] * (double)(found - 1) + 0.5)];
    iso_free(numbers);
    return ISO_OK;
}

static void store(uint8_t to[3], iso_rgb color) {
    to[0] = color.r;
    to[1] = color.g;
    to[2] = color.b;
}

/* Colours every vertex of every line by the number of the vertex, or of its line. */
static void color_lines(const isorender_object *object, const iso_attribute *attribute,
                        uint8_t (*colors)[3]) {
    const iso_lines *lines = &object->file.lines;
    for (size_t line = 0; line < lines->line_count; line++)
        for (size_t i = lines->starts[line]; i < lines->starts[line + 1]; i++)
            store(colors[i],
                  iso_color_bar_at(&object->bar, number_at(attribute, attribute->per_line ? line : i)));
}

static void color_glyphs(const isorender_object *object, const iso_attribute *attribute,
                         uint8_t (*colors)[3]) {
    for (size_t i = 0; i < object->file.glyphs.count; i++)
        store(colors[i], iso_color_bar_at(&object->bar, number_at(attribute, i)));
}

/* The axes of the world as red, green and blue, as tractography shows directions (Pajevic and Pierpaoli 1999,
 * "Color schemes to represent the orientation of anisotropic tissues"). */
static iso_rgb color_of_direction(const float a[3], const float b[3]) {
    double d[3], square = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = fabs((double)b[k] - (double)a[k]);
        square += d[k] * d[k];
    }
    const double scale = square > 0 ? 255 / sqrt(square) : 0;
    return (iso_rgb){(uint8_t)(d[0] * scale + 0.5), (uint8_t)(d[1] * scale + 0.5),
                     (uint8_t)(d[2] * scale + 0.5)};
}

/* A vertex has the direction from the one before it to the one after it. */
static void color_by_direction(const iso_lines *lines, uint8_t (*colors)[3]) {
    for (size_t line = 0; line < lines->line_count; line++) {
        const size_t first = lines->starts[line], end = lines->starts[line + 1];
        for (size_t i = first; i < end; i++)
            store(colors[i], color_of_direction(lines->vertices[i > first ? i - 1 : i],
                                                lines->vertices[i + 1 < end ? i + 1 : i]));
    }
}

static void color_glyphs_by_direction(const iso_glyphs *glyphs, uint8_t (*colors)[3]) {
    static const float middle[3] = {0};
    for (size_t i = 0; i < glyphs->count; i++)
        store(colors[i], color_of_direction(middle, glyphs->directions[i]));
}

static iso_status find_range(isorender_object *object, const iso_attribute *attribute, size_t count,
                             iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    double range[2] = {settings->range[0], settings->range[1]};
    if (isnan(range[0]) && !isorender_attribute_range(attribute, count, range))
        return iso_fail(error, ISO_ERR_FORMAT, "%s%scolumn '%s' has no finite number",
                        settings->path ? settings->path : "", settings->path ? ": " : "", object->color_by);
    if (!isnan(settings->range_shares[0]))
        ISO_TRY(find_shares(attribute, count, settings->range_shares, range, error));
    if (settings->map.file && !object->colors.colors)
        ISO_TRY(iso_color_table_read(settings->map.file, &object->colors, error));
    object->has_bar = true;
    object->bar = (iso_color_bar){.map = settings->map.map,
                                  .table = object->colors.colors ? &object->colors : NULL,
                                  .low = range[0],
                                  .high = range[1]};
    snprintf(object->bar.title, sizeof object->bar.title, "%s", object->color_by);
    return ISO_OK;
}

static iso_status allocate(size_t count, uint8_t (**colors)[3], iso_error *error) {
    *colors = iso_alloc(count * sizeof **colors);
    return *colors ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu colours", count);
}

static iso_status color_by_attribute(isorender_object *object, uint8_t (**colors)[3], iso_error *error) {
    const bool of_lines = object->settings->kind == ISO_OBJECT_LINES;
    const iso_attribute *attribute =
        of_lines ? isorender_attribute_find(object->file.lines.attributes, object->file.lines.attribute_count,
                                            object->color_by)
                 : isorender_attribute_find(object->file.glyphs.attributes,
                                            object->file.glyphs.attribute_count, object->color_by);
    const size_t items = of_lines ? object->file.lines.vertex_count : object->file.glyphs.count;
    ISO_TRY(find_range(object, attribute,
                       of_lines && attribute->per_line ? object->file.lines.line_count : items, error));
    ISO_TRY(allocate(items, colors, error));
    (of_lines ? color_lines : color_glyphs)(object, attribute, *colors);
    return ISO_OK;
}

static iso_status color_by_directions(const isorender_object *object, uint8_t (**colors)[3],
                                      iso_error *error) {
    if (object->settings->kind == ISO_OBJECT_LINES) {
        ISO_TRY(allocate(object->file.lines.vertex_count, colors, error));
        color_by_direction(&object->file.lines, *colors);
        return ISO_OK;
    }
    if (!object->file.glyphs.directions)
        return iso_fail(error, ISO_ERR_USAGE, "%s: the glyphs have no directions to be coloured by",
                        object->settings->path);
    ISO_TRY(allocate(object->file.glyphs.count, colors, error));
    color_glyphs_by_direction(&object->file.glyphs, *colors);
    return ISO_OK;
}

iso_status isorender_object_color(isorender_object *object, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    uint8_t(*colors)[3] = NULL;
    if (!object->color_by && !settings->by_direction && !settings->colored) return ISO_OK;
    if (object->color_by)
        ISO_TRY(color_by_attribute(object, &colors, error));
    else if (settings->by_direction)
        ISO_TRY(color_by_directions(object, &colors, error));
    uint8_t(**place)[3] =
        settings->kind == ISO_OBJECT_LINES ? &object->file.lines.colors : &object->file.glyphs.colors;
    iso_free(*place);
    *place = colors;
    return ISO_OK;
}
