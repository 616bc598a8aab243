/* polydata: points and their columns while they are read. */
#include "io/polydata/polydata.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { POINT = 3 * sizeof(float) };

void iso_polydata_free(iso_polydata *data) {
    for (int i = 0; i < data->column_count; i++) iso_buffer_free(&iso_polydata_column(data, i)->values);
    iso_buffer_free(&data->column_array);
    iso_buffer_free(&data->points);
    iso_buffer_free(&data->indices);
    iso_buffer_free(&data->starts);
    data->column_count = 0;
}

/* ---- columns */

iso_status iso_polydata_add_column(iso_polydata *data, const char *name, int components, bool per_line,
                                   iso_role role, int *column, iso_error *error) {
    const size_t count = (size_t)data->column_count;
    if (count == ISO_POLYDATA_COLUMNS)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: more than %d columns of numbers", data->reading->path,
                        ISO_POLYDATA_COLUMNS);
    ISO_TRY(
        iso_reading_reserve(data->reading, &data->column_array, count + 1, sizeof(iso_column), count, error));
    iso_column made = {.components = components, .per_line = per_line, .role = role};
    strncpy(made.name, name, sizeof made.name - 1);
    iso_column_set_role(&made);
    *column = data->column_count++;
    *iso_polydata_column(data, *column) = made;
    return ISO_OK;
}

/* Numbers that form one column if all their names are present and belong to no group before. */
static const struct group {
    const char *name;
    iso_role role;
    int count;
    const char *names[4];
} groups[] = {
    {"normals", ISO_ROLE_NORMAL, 3, {"nx", "ny", "nz"}},
    {"normals", ISO_ROLE_NORMAL, 3, {"normal_x", "normal_y", "normal_z"}},
    {"normals", ISO_ROLE_NORMAL, 3, {"normalx", "normaly", "normalz"}},
    {"normals", ISO_ROLE_NORMAL, 3, {"normals:0", "normals:1", "normals:2"}}, /* ParaView's */
    {"normals", ISO_ROLE_NORMAL, 3, {"normals_0", "normals_1", "normals_2"}},
    {"vectors", ISO_ROLE_VECTOR, 3, {"vx", "vy", "vz"}},
    {"colors", ISO_ROLE_COLOR, 3, {"red", "green", "blue"}},
    {"colors", ISO_ROLE_COLOR, 3, {"r", "g", "b"}},
    {"colors", ISO_ROLE_COLOR, 3, {"diffuse_red", "diffuse_green", "diffuse_blue"}},
    {"colors", ISO_ROLE_COLOR, 3, {"rf", "gf", "bf"}}, /* CloudCompare's fractions */
    {"scale", ISO_ROLE_NONE, 3, {"scale_0", "scale_1", "scale_2"}},
    {"scale", ISO_ROLE_NONE, 2, {"scale_0", "scale_1"}},
    {"rot", ISO_ROLE_NONE, 4, {"rot_0", "rot_1", "rot_2", "rot_3"}},
    {"f_dc", ISO_ROLE_NONE, 3, {"f_dc_0", "f_dc_1", "f_dc_2"}},
};

/* Whether a name is the wanted one but for a unit in brackets behind it, as "X [m]", and the mark of a
 * comment before it, as in "//X". */
static bool is_decorated(const char *name, const char *wanted) {
    name += strspn(name, "#/ ");
    size_t length = strcspn(name, "[(");
    while (length && name[length - 1] == ' ') length--;
    return length == strlen(wanted) && strncasecmp(name, wanted, length) == 0;
}

/* Returns the index of the first number with that name, or else with that name and a unit; -1: none has it.
 */
static int find_name(const char *const *names, int count, const char *wanted) {
    for (int i = 0; i < count; i++)
        if (names[i] && strcasecmp(names[i], wanted) == 0) return i;
    for (int i = 0; i < count; i++)
        if (names[i] && is_decorated(names[i], wanted)) return i;
    return -1;
}

static iso_status name_group(iso_polydata *data, const struct group *group, const char *const *names,
                             int count, iso_slot *slots, iso_error *error) {
    int found[4], column;
    for (int k = 0; k < group->count; k++) {
        found[k] = find_name(names, count, group->names[k]);
        if (found[k] < 0 || slots[found[k]].column != ISO_SLOT_SKIP) return ISO_OK;
    }
    ISO_TRY(iso_polydata_add_column(data, group->name, group->count, false, group->role, &column, error));
    for (int k = 0; k < group->count; k++) slots[found[k]] = (iso_slot){column, k};
    return ISO_OK;
}

/* Names of coordinates; those behind x y z are ParaView's and surveyors'. */
static const char *const coordinates[][3] = {{"x", "y", "z"},
                                             {"Points:0", "Points:1", "Points:2"},
                                             {"Points_0", "Points_1", "Points_2"},
                                             {"easting", "northing", "elevation"},
                                             {"easting", "northing", "height"}};

/* Reports which coordinate is missing, and what there is instead. */
static iso_status fail_names(const iso_polydata *data, const char *const *names, int count,
                             iso_error *error) {
    char list[200] = "";
    int axis = 0;
    while (axis < 2 && find_name(names, count, coordinates[0][axis]) >= 0) axis++;
    for (int i = 0; i < count && i < 8; i++) {
        const size_t length = strlen(list);
        snprintf(list + length, sizeof list - length, "%s'%.20s'", i ? ", " : "", names[i] ? names[i] : "-");
    }
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: its points have no %s: their columns are %s%s (--columns names those of a table)",
                    data->reading->path, coordinates[0][axis], list, count > 8 ? " .." : "");
}

static iso_status name_point(const iso_polydata *data, const char *const *names, int count, iso_slot *slots,
                             iso_error *error) {
    int found[3];
    for (size_t set = 0; set < sizeof coordinates / sizeof *coordinates; set++) {
        for (int axis = 0; axis < 3; axis++) found[axis] = find_name(names, count, coordinates[set][axis]);
        if (found[0] < 0 || found[1] < 0 || found[2] < 0) continue;
        for (int axis = 0; axis < 3; axis++) slots[found[axis]] = (iso_slot){ISO_SLOT_POINT, axis};
        return ISO_OK;
    }
    return fail_names(data, names, count, error);
}

iso_status iso_polydata_name_columns(iso_polydata *data, const char *const *names, int count, iso_slot *slots,
                                     iso_error *error) {
    for (int i = 0; i < count; i++) slots[i] = (iso_slot){ISO_SLOT_SKIP, 0};
    ISO_TRY(name_point(data, names, count, slots, error));
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++)
        ISO_TRY(name_group(data, &groups[g], names, count, slots, error));
    const bool gaussians = find_name(names, count, "f_dc_0") >= 0;
    for (int i = 0; i < count; i++) {
        if (!names[i] || slots[i].column != ISO_SLOT_SKIP) continue;
        /* the 9 to 45 further terms of the colours of Gaussians, by direction, are not used */
        if (gaussians && strncasecmp(names[i], "f_rest_", 7) == 0) continue;
        ISO_TRY(iso_polydata_add_column(data, names[i], 1, false, ISO_ROLE_NONE, &slots[i].column, error));
    }
    return ISO_OK;
}

iso_status iso_polydata_join_columns(iso_polydata *data, int first, const char *name, iso_role role,
                                     iso_error *error) {
    const size_t count = data->point_count;
    iso_column *columns = iso_polydata_column(data, first), made = {.components = 3, .role = role};
    strncpy(made.name, name, sizeof made.name - 1);
    ISO_TRY(iso_reading_reserve(data->reading, &made.values, count ? count : 1, POINT, 0, error));
    float *to = made.values.data;
    for (size_t k = 0; k < 3; k++) {
        const float *from = columns[k].values.data;
        for (size_t i = 0; i < count; i++) to[3 * i + k] = from[i];
        iso_reading_free(data->reading, &columns[k].values);
    }
    columns[0] = made;
    memmove(columns + 1, columns + 3, (size_t)(data->column_count - first - 3) * sizeof *columns);
    data->column_count -= 2;
    return ISO_OK;
}

float iso_polydata_color_factor(float most, bool fractions) {
    const float bytes = fractions ? 256 : 255, ones = 2;
    return most > bytes ? 1 / 257.0f : fractions && most <= ones ? 255 : 1;
}

void iso_polydata_scale_colors(iso_polydata *data, bool fractions) {
    iso_column *column = iso_column_find(data->column_array.data, data->column_count, ISO_ROLE_COLOR);
    if (!column) return;
    const float *values = column->values.data;
    float most = 0;
    const size_t count = data->point_count * (size_t)column->components;
    for (size_t i = 0; i < count; i++) most = values[i] > most ? values[i] : most;
    column->factor = iso_polydata_color_factor(most, fractions);
}

/* ---- points */

iso_status iso_polydata_reserve(iso_polydata *data, size_t count, iso_error *error) {
    if (count > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: more than %lu points", data->reading->path,
                        (unsigned long)UINT32_MAX);
    ISO_TRY(iso_reading_reserve(data->reading, &data->points, count, POINT, data->point_count, error));
    for (int i = 0; i < data->column_count; i++) {
        iso_column *column = iso_polydata_column(data, i);
        if (column->per_line) continue;
        ISO_TRY(iso_reading_reserve(data->reading, &column->values, count,
                                    (size_t)column->components * sizeof(float), data->point_count, error));
    }
    return ISO_OK;
}

static bool is_usable(const double p[3]) {
    return fabs(p[0]) <= ISO_FARTHEST && fabs(p[1]) <= ISO_FARTHEST && fabs(p[2]) <= ISO_FARTHEST;
}

void iso_polydata_add_point(iso_polydata *data, const double p[3]) {
    float *to = (float *)data->points.data + 3 * data->point_count++;
    if (!is_usable(p)) {
        to[0] = to[1] = to[2] = (float)NAN;
        return;
    }
    if (!data->has_origin && !data->keep_floats) data->origin = iso_origin_for(p);
    data->has_origin = true;
    to[0] = (float)(p[0] - data->origin.x);
    to[1] = (float)(p[1] - data->origin.y);
    to[2] = (float)(p[2] - data->origin.z);
}

void iso_polydata_add_row(iso_polydata *data, const iso_slot *slots, const double *numbers, int count) {
    double p[3] = {0};
    for (int i = 0; i < count; i++) {
        const iso_slot slot = slots[i];
        if (slot.column == ISO_SLOT_POINT) p[slot.component] = numbers[i];
        if (slot.column < 0) continue;
        const iso_column *column = iso_polydata_column(data, slot.column);
        float *values = (float *)column->values.data + data->point_count * (size_t)column->components;
        values[slot.component] = (float)numbers[i];
    }
    iso_polydata_add_point(data, p);
}

/* ---- polylines */

iso_status iso_polydata_add_index(iso_polydata *data, uint32_t point, iso_error *error) {
    const size_t count = data->index_count;
    ISO_TRY(iso_reading_reserve(data->reading, &data->indices, count + 1, sizeof point, count, error));
    ((uint32_t *)data->indices.data)[data->index_count++] = point;
    return ISO_OK;
}

iso_status iso_polydata_end_line(iso_polydata *data, iso_error *error) {
    const size_t lines = data->line_count;
    ISO_TRY(iso_reading_reserve(data->reading, &data->starts, lines + 2, sizeof(size_t), lines + 1, error));
    size_t *starts = data->starts.data;
    starts[0] = 0;
    starts[++data->line_count] = data->index_count;
    return ISO_OK;
}
