/* reading: memory, notes and attributes of a set that is being read. */
#include "io/common/reading.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/text.h"
#include "grids/volume/format.h"

iso_reading iso_reading_begin(const char *path, const iso_read_opts *opts, iso_read_report *report) {
    iso_reading reading = {.path = path, .opts = opts ? *opts : (iso_read_opts){0}};
    reading.report = reading.opts.report ? reading.opts.report : report;
    *reading.report = (iso_read_report){.unit = ISO_WORLD_UNIT_NONE};
    reading.limit = iso_memory_limit(reading.opts.max_memory);
    if (reading.opts.every < 1) reading.opts.every = 1;
    iso_file_set_read(reading.opts.files, path);
    return reading;
}

iso_status iso_reading_find_type(iso_reading *reading, unsigned holds, const char *what, iso_file_type *type,
                                 iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(reading->path, &file, NULL, error));
    fclose(file);
    *type = iso_file_type_find(reading->path, holds);
    if (*type == ISO_FILE_UNKNOWN) {
        char known[256];
        iso_file_type_extensions(holds, 0, "and", known, sizeof known);
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a file of %s that can be read: they are %s",
                        reading->path, what, known);
    }
    snprintf(reading->report->format, sizeof reading->report->format, "%s", iso_file_type_name(*type));
    return ISO_OK;
}

/* ---- memory */

static iso_status check_limit(const iso_reading *reading, uint64_t bytes, iso_error *error) {
    const iso_volume_opts opts = {.max_memory = reading->limit};
    return iso_format_check_memory(reading->path, &opts, bytes, "in memory", error);
}

iso_status iso_reading_reserve(iso_reading *reading, iso_buffer *buffer, size_t count, size_t each,
                               size_t keep, iso_error *error) {
    size_t bytes;
    if (!iso_size_multiply(count, each, &bytes) || bytes > SIZE_MAX / 4)
        return check_limit(reading, UINT64_MAX, error);
    if (bytes <= buffer->bytes) return ISO_OK;
    const size_t before = buffer->bytes, grown = before + before / 2;
    ISO_TRY(check_limit(reading, reading->used + (bytes > grown ? bytes : grown), error));
    iso_status status = iso_buffer_reserve(buffer, bytes, before ? keep * each : 0, NULL);
    if (status != ISO_OK) return iso_fail_memory(error, reading->path);
    reading->used += buffer->bytes - before;
    return ISO_OK;
}

void iso_reading_free(iso_reading *reading, iso_buffer *buffer) {
    reading->used -= buffer->bytes;
    iso_buffer_free(buffer);
}

iso_status iso_reading_load(iso_reading *reading, iso_buffer *text, size_t *bytes, iso_error *error) {
    FILE *file;
    uint64_t size;
    ISO_TRY(iso_file_open(reading->path, &file, &size, error));
    iso_status status = iso_reading_reserve(reading, text, (size_t)size + 1, 1, 0, error);
    if (status == ISO_OK && fread(text->data, 1, (size_t)size, file) != size)
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", reading->path,
                          ferror(file) ? strerror(errno) : "changed while it was read");
    fclose(file);
    ISO_TRY(status);
    ((char *)text->data)[size] = 0;
    *bytes = (size_t)size;
    return ISO_OK;
}

iso_status iso_reading_unzip(iso_reading *reading, const iso_zip_entry *entry, iso_buffer *buffer,
                             const unsigned char **bytes, iso_error *error) {
    *bytes = entry->data;
    if (!entry->deflated) return iso_zip_check(reading->path, entry, entry->data, error);
    ISO_TRY(iso_reading_reserve(reading, buffer, (size_t)entry->size + 1, 1, 0, error));
    *bytes = buffer->data;
    return iso_zip_unpack(reading->path, entry, buffer->data, error);
}

/* ---- the report */

void iso_reading_note(iso_reading *reading, const char *format, ...) {
    iso_read_report *report = reading->report;
    if (report->note_count == ISO_READ_NOTES) return;
    va_list arguments;
    va_start(arguments, format);
    iso_text_format(report->notes[report->note_count++], ISO_READ_TEXT, format, arguments);
    va_end(arguments);
}

bool iso_reading_is_ras(iso_reading *reading, iso_space stated) {
    const iso_space asked = reading->opts.space, space = asked == ISO_SPACE_FILE ? stated : asked;
    reading->report->space = space == ISO_SPACE_RAS ? ISO_SPACE_RAS : ISO_SPACE_LPS;
    reading->report->space_stated = asked == ISO_SPACE_FILE && stated != ISO_SPACE_FILE;
    return space == ISO_SPACE_RAS;
}

/* ---- columns */

static bool is_taken(const iso_attribute *attributes, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (strcmp(attributes[i].name, name) == 0) return true;
    return false;
}

/* Returns a printable name that no previous attribute has; NULL: no memory. */
static char *unique_name(const iso_attribute *attributes, int count, const char *name) {
    enum { ROOM = 4 * ISO_COLUMN_NAME + 16 };
    char clean[4 * ISO_COLUMN_NAME], *unique = iso_alloc(ROOM);
    if (!unique) return NULL;
    iso_text_clean(*name ? name : "unnamed", clean, sizeof clean);
    snprintf(unique, ROOM, "%s", clean);
    for (int i = 2; is_taken(attributes, count, unique); i++) snprintf(unique, ROOM, "%s %d", clean, i);
    return unique;
}

iso_status iso_columns_take(iso_column *columns, int count, iso_attribute **attributes, int *attribute_count,
                            iso_error *error) {
    iso_attribute *made = iso_alloc_zero(count ? (size_t)count : 1, sizeof *made);
    int used = 0;
    bool complete = made != NULL;
    for (int i = 0; i < count && complete; i++) {
        if (!columns[i].values.data) continue;
        made[used] = (iso_attribute){.name = unique_name(made, used, columns[i].name),
                                     .components = columns[i].components,
                                     .per_line = columns[i].per_line};
        complete = made[used++].name != NULL;
    }
    if (!complete) {
        if (made) iso_attributes_free(made, used);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the names of attributes");
    }
    used = 0;
    for (int i = 0; i < count; i++) {
        if (!columns[i].values.data) continue;
        made[used++].values = columns[i].values.data;
        columns[i].values = (iso_buffer){0};
    }
    *attributes = made;
    *attribute_count = used;
    return ISO_OK;
}

/* ---- roles */

static bool is_called(const iso_column *column, const char *name) {
    return strcasecmp(column->name, name) == 0;
}

void iso_column_set_role(iso_column *column) {
    if (column->role != ISO_ROLE_NONE) return;
    /* the second name is the Vascular Modeling Toolkit's */
    if (column->components == 1 &&
        (is_called(column, "radius") || is_called(column, "MaximumInscribedSphereRadius")))
        column->role = ISO_ROLE_RADIUS;
    if (column->components == 9) column->role = ISO_ROLE_TENSOR;
}

iso_column *iso_column_find(iso_column *columns, int count, iso_role role) {
    for (int i = 0; i < count; i++)
        if (columns[i].role == role && !columns[i].per_line && columns[i].values.data) return &columns[i];
    return NULL;
}

/* From RAS to LPS is a rotation by 180 degrees about z. It negates x and y, and so those entries of a tensor
 * that combine x or y with z. */
void iso_column_turn(iso_column *column, size_t items) {
    static const int vector[] = {0, 1}, tensor[] = {2, 5, 6, 7};
    const bool is_tensor = column->role == ISO_ROLE_TENSOR;
    if (!is_tensor && column->role != ISO_ROLE_VECTOR && column->role != ISO_ROLE_NORMAL) return;
    const int *turned = is_tensor ? tensor : vector, count = is_tensor ? 4 : 2;
    float *values = column->values.data;
    for (size_t i = 0; i < items && values; i++)
        for (int k = 0; k < count; k++) {
            float *value = &values[i * (size_t)column->components + (size_t)turned[k]];
            *value = -*value;
        }
}

/* Moves the values out of a column. */
static float *take_values(iso_column *column) {
    float *values = column->values.data;
    column->values = (iso_buffer){0};
    return values;
}

float *iso_column_take_radii(iso_reading *reading, iso_column *column, size_t items) {
    float *radii = take_values(column);
    for (size_t i = 0; i < items; i++) {
        if (radii[i] >= 0 && (double)radii[i] <= ISO_FARTHEST) continue;
        radii[i] = 0;
        reading->report->mended_radii++;
    }
    return radii;
}

iso_status iso_column_take_colors(iso_reading *reading, iso_column *column, size_t items,
                                  uint8_t (**colors)[3], iso_error *error) {
    iso_buffer bytes = {0};
    ISO_TRY(iso_reading_reserve(reading, &bytes, items, 3, 0, error));
    const float *values = column->values.data;
    uint8_t(*to)[3] = bytes.data;
    const float factor = column->factor > 0 ? column->factor : 1;
    for (size_t i = 0; i < items; i++, values += column->components)
        for (int k = 0; k < 3; k++) {
            const float value = values[k] * factor;
            to[i][k] = (uint8_t)(value > 0 ? value < 255 ? value + 0.5f : 255 : 0);
        }
    iso_reading_free(reading, &column->values);
    *colors = to;
    return ISO_OK;
}

/* Normalises a vector, scaled first: the squares of tiny components would underflow. */
static void make_unit(float v[3]) {
    const double x = (double)v[0], y = (double)v[1], z = (double)v[2],
                 largest = fmax(fabs(x), fmax(fabs(y), fabs(z)));
    if (!(largest > 0)) return;
    const iso_vec3 unit = iso_vec3_unit(iso_vec3_make(x / largest, y / largest, z / largest));
    v[0] = (float)unit.x;
    v[1] = (float)unit.y;
    v[2] = (float)unit.z;
}

float (*iso_column_take_vectors(iso_column *column, size_t items, bool unit))[3] {
    float(*vectors)[3] = (float(*)[3])(void *)take_values(column);
    for (size_t i = 0; i < items; i++) {
        float *v = vectors[i];
        if (!isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2])) v[0] = v[1] = v[2] = 0;
        if (unit) make_unit(v);
    }
    return vectors;
}
