/* line_sink: the arrays of lines while they grow. */
#include "io/common/line_sink.h"

#include <math.h>

enum { VERTEX = 3 * sizeof(float) };

void iso_line_sink_begin(iso_line_sink *sink) {
    const uint64_t number = sink->reading->report->items++;
    sink->skips = number % (uint64_t)sink->reading->opts.every != 0;
    sink->first_made = sink->line_count;
}

/* Makes room for the items of all columns of vertices, or of lines. */
static iso_status reserve_columns(iso_line_sink *sink, bool per_line, size_t count, size_t keep,
                                  iso_error *error) {
    for (int i = 0; i < sink->column_count; i++) {
        iso_column *column = &sink->columns[i];
        if (column->per_line != per_line) continue;
        ISO_TRY(iso_reading_reserve(sink->reading, &column->values, count,
                                    (size_t)column->components * sizeof(float), keep, error));
    }
    return ISO_OK;
}

iso_status iso_line_sink_reserve(iso_line_sink *sink, size_t count, iso_error *error) {
    const size_t wanted = sink->vertex_count + count;
    ISO_TRY(iso_reading_reserve(sink->reading, &sink->vertices, wanted, VERTEX, sink->vertex_count, error));
    return reserve_columns(sink, false, wanted, sink->vertex_count, error);
}

static bool is_usable(const double p[3]) {
    return fabs(p[0]) <= ISO_FARTHEST && fabs(p[1]) <= ISO_FARTHEST && fabs(p[2]) <= ISO_FARTHEST;
}

static void set_origin(iso_line_sink *sink, const double p[3]) {
    if (sink->keep_floats) return;
    sink->origin = iso_origin_for(p);
}

bool iso_line_sink_vertex(iso_line_sink *sink, const double p[3]) {
    if (!is_usable(p)) return false;
    const double world[3] = {sink->ras ? -p[0] : p[0], sink->ras ? -p[1] : p[1], p[2]};
    if (sink->vertex_count == 0) set_origin(sink, world);
    float *to = (float *)sink->vertices.data + 3 * sink->vertex_count++;
    to[0] = (float)(world[0] - sink->origin.x);
    to[1] = (float)(world[1] - sink->origin.y);
    to[2] = (float)(world[2] - sink->origin.z);
    return true;
}

iso_status iso_line_sink_split(iso_line_sink *sink, iso_error *error) {
    const size_t lines = sink->line_count;
    if (sink->vertex_count == sink->first && lines) return ISO_OK;
    ISO_TRY(iso_reading_reserve(sink->reading, &sink->starts, lines + 2, sizeof(size_t), lines + 1, error));
    size_t *starts = sink->starts.data;
    starts[0] = 0;
    if (sink->vertex_count == sink->first) return ISO_OK;
    ISO_TRY(reserve_columns(sink, true, lines + 1, lines, error));
    starts[++sink->line_count] = sink->first = sink->vertex_count;
    return ISO_OK;
}

iso_status iso_line_sink_finish(iso_line_sink *sink, iso_lines *lines, iso_error *error) {
    ISO_TRY(iso_line_sink_split(sink, error)); /* this also writes the only start of a set without lines */
    iso_lines made = {.origin = sink->origin,
                      .starts = sink->starts.data,
                      .vertices = sink->vertices.data,
                      .vertex_count = sink->vertex_count,
                      .line_count = sink->line_count};
    ISO_TRY(
        iso_columns_take(sink->columns, sink->column_count, &made.attributes, &made.attribute_count, error));
    sink->vertices = sink->starts = (iso_buffer){0};
    *lines = made;
    return ISO_OK;
}

void iso_line_sink_free(iso_line_sink *sink) {
    iso_buffer_free(&sink->vertices);
    iso_buffer_free(&sink->starts);
    for (int i = 0; i < sink->column_count; i++) iso_buffer_free(&sink->columns[i].values);
}
