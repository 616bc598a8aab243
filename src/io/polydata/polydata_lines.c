/* polydata_lines: copies the points that polylines name, with their columns, so that every line has vertices
 * of its own. */
#include <string.h>

#include "io/common/line_sink.h"
#include "io/polydata/polydata.h"

static iso_status check_indices(const iso_polydata *data, iso_error *error) {
    const uint32_t *indices = data->indices.data;
    for (size_t i = 0; i < data->index_count; i++)
        if (indices[i] >= data->point_count)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a line names point %u of %zu",
                            data->reading->path, indices[i], data->point_count);
    return ISO_OK;
}

/* Makes columns for the sink with the same names as those of the polydata, but without values. */
static iso_status copy_columns(iso_polydata *data, iso_buffer *columns, iso_error *error) {
    const size_t count = (size_t)data->column_count;
    ISO_TRY(iso_reading_reserve(data->reading, columns, count + 1, sizeof(iso_column), 0, error));
    iso_column *copies = columns->data;
    for (size_t i = 0; i < count; i++) {
        copies[i] = *iso_polydata_column(data, (int)i);
        copies[i].values = (iso_buffer){0};
    }
    return ISO_OK;
}

/* Copies the columns' numbers of item `from` of the polydata to item `to` of the sink. */
static void copy_values(const iso_polydata *data, iso_line_sink *sink, bool per_line, size_t from,
                        size_t to) {
    for (int i = 0; i < sink->column_count; i++) {
        const iso_column *source = iso_polydata_column(data, i);
        const size_t components = (size_t)source->components;
        if (source->per_line != per_line || !source->values.data) continue;
        memcpy((float *)sink->columns[i].values.data + to * components,
               (const float *)source->values.data + from * components, components * sizeof(float));
    }
}

static iso_status gather_line(const iso_polydata *data, size_t line, iso_line_sink *sink, iso_error *error) {
    const size_t *starts = data->starts.data, first = starts[line], count = starts[line + 1] - first;
    const float(*points)[3] = data->points.data;
    const uint32_t *indices = data->indices.data;
    iso_line_sink_begin(sink);
    if (sink->skips) return ISO_OK;
    ISO_TRY(iso_line_sink_reserve(sink, count, error));
    for (size_t i = 0; i < count; i++) {
        const uint32_t index = indices[first + i];
        const float *point = points[index];
        const double p[3] = {(double)point[0], (double)point[1], (double)point[2]};
        if (iso_line_sink_vertex(sink, p))
            copy_values(data, sink, false, index, sink->vertex_count - 1);
        else {
            data->reading->report->dropped++;
            ISO_TRY(iso_line_sink_split(sink, error));
        }
    }
    ISO_TRY(iso_line_sink_split(sink, error));
    for (size_t made = sink->first_made; made < sink->line_count; made++)
        copy_values(data, sink, true, line, made);
    return ISO_OK;
}

/* Moves the columns that have a role into the arrays of the lines. */
static iso_status take_roles(iso_line_sink *sink, iso_lines *lines, iso_error *error) {
    iso_column *columns = sink->columns;
    const int count = sink->column_count;
    iso_column *colors = iso_column_find(columns, count, ISO_ROLE_COLOR);
    if (colors)
        ISO_TRY(iso_column_take_colors(sink->reading, colors, sink->vertex_count, &lines->colors, error));
    for (int i = 0; i < count && sink->ras; i++)
        iso_column_turn(&columns[i], columns[i].per_line ? sink->line_count : sink->vertex_count);
    iso_column *radii = iso_column_find(columns, count, ISO_ROLE_RADIUS),
               *normals = iso_column_find(columns, count, ISO_ROLE_NORMAL);
    if (radii) lines->radii = iso_column_take_radii(sink->reading, radii, sink->vertex_count);
    if (normals) lines->normals = iso_column_take_vectors(normals, sink->vertex_count, true);
    return ISO_OK;
}

static iso_status gather(iso_polydata *data, iso_line_sink *sink, iso_lines *lines, iso_error *error) {
    size_t wanted = data->reading->opts.every == 1 ? data->index_count : 0;
    ISO_TRY(iso_line_sink_reserve(sink, wanted, error));
    for (size_t i = 0; i < data->line_count; i++) ISO_TRY(gather_line(data, i, sink, error));
    iso_lines arrays = {0}, made;
    iso_status status = take_roles(sink, &arrays, error);
    if (status == ISO_OK) status = iso_line_sink_finish(sink, &made, error);
    if (status != ISO_OK) {
        iso_lines_free(&arrays);
        return status;
    }
    made.origin = sink->ras ? iso_vec3_make(-data->origin.x, -data->origin.y, data->origin.z) : data->origin;
    made.radii = arrays.radii;
    made.normals = arrays.normals;
    made.colors = arrays.colors;
    *lines = made;
    return ISO_OK;
}

iso_status iso_polydata_to_lines(iso_polydata *data, iso_lines *lines, iso_error *error) {
    /* vertices stay relative to the polydata's origin, so the sink must not change them */
    iso_line_sink sink = {.reading = data->reading, .keep_floats = true};
    iso_buffer columns = {0};
    sink.ras = iso_reading_is_ras(data->reading, data->stated);
    ISO_TRY(check_indices(data, error));
    ISO_TRY(copy_columns(data, &columns, error));
    sink.columns = columns.data;
    sink.column_count = data->column_count;
    iso_status status = gather(data, &sink, lines, error);
    iso_line_sink_free(&sink);
    iso_reading_free(data->reading, &columns);
    return status;
}
