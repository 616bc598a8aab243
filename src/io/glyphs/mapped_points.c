/* mapped_points: finds in the header of a .ply file where the numbers of its points are, and maps them. */
#include "io/glyphs/mapped_points.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "base/primitives.h"
#include "grids/volume/format.h"
#include "io/common/ply.h"
#include "io/polydata/polydata.h"

/* Where the numbers of a point are: bytes from its first one. */
typedef struct layout {
    size_t record; /* bytes of a point */
    size_t position, normal, color;
    bool colored;
} layout;

/* ---- the header */

/* Finds three numbers of one type that lie one after the other: components 0, 1, 2 of a column. */
static bool find_triple(const iso_ply *ply, const iso_ply_element *element, const iso_slot *slots, int column,
                        iso_ply_type type, size_t *offset) {
    size_t at = 0;
    int next = 0;
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_type own = ply->properties[element->first_property + i].type;
        if (slots[i].column == column) {
            if (own != type || slots[i].component != next) return false;
            if (next == 0) *offset = at;
            if (at != *offset + (size_t)next * iso_scalar_size(iso_ply_scalar(type))) return false;
            next++;
        }
        at += iso_scalar_size(iso_ply_scalar(own));
    }
    return next == 3;
}

/* Whether a column beside normals and colours changes nothing of what points look like. */
static bool is_ignored(const iso_column *column) {
    return column->components == 1 && column->role == ISO_ROLE_NONE && strcasecmp(column->name, "alpha") != 0;
}

/* Finds where the numbers of a point are. */
static bool find_numbers(const iso_ply *ply, const iso_ply_element *element, iso_polydata *data,
                         layout *found) {
    iso_slot slots[ISO_PLY_PROPERTIES];
    const char *names[ISO_PLY_PROPERTIES];
    int normals = -1, colors = -1;
    for (int i = 0; i < element->property_count; i++)
        names[i] = ply->properties[element->first_property + i].name;
    if (iso_polydata_name_columns(data, names, element->property_count, slots, NULL) != ISO_OK) return false;
    for (int k = 0; k < data->column_count; k++) {
        const iso_column *column = iso_polydata_column(data, k);
        if (column->role == ISO_ROLE_NORMAL && normals < 0)
            normals = k;
        else if (column->role == ISO_ROLE_COLOR && colors < 0)
            colors = k;
        else if (!is_ignored(column))
            return false;
    }
    found->colored = colors >= 0;
    return normals >= 0 &&
           find_triple(ply, element, slots, ISO_SLOT_POINT, ISO_PLY_FLOAT32, &found->position) &&
           find_triple(ply, element, slots, normals, ISO_PLY_FLOAT32, &found->normal) &&
           (colors < 0 || find_triple(ply, element, slots, colors, ISO_PLY_UINT8, &found->color));
}

/* ---- opening */

/* Finds the layout of the items of `element`, which is read next; false if they must be converted, or are
 * too many. */
static bool find_layout(const iso_ply *ply, const iso_ply_element *element, iso_reading *reading,
                        layout *found) {
    iso_polydata data = {.reading = reading};
    const uint64_t kept = sizeof(iso_surfel) + sizeof(float) + 3; /* bytes of a point in memory */
    found->record = iso_ply_record_bytes(ply, element);
    const bool good = ply->format == ISO_PLY_LITTLE && found->record && element->count > 0 &&
                      element->count < INT32_MAX && element->count <= reading->limit / kept &&
                      iso_ply_check_size(ply, element, NULL) == ISO_OK &&
                      find_numbers(ply, element, &data, found);
    iso_polydata_free(&data);
    return good;
}

static bool map_points(iso_ply *ply, const iso_ply_element *element, iso_reading *reading,
                       iso_mapped_points *points) {
    layout found = {0};
    if (!find_layout(ply, element, reading, &found) || fseeko(ply->in.file, 0, SEEK_END) != 0) return false;
    const off_t start = ftello(ply->in.file) - (off_t)ply->in.remaining;
    if (start < 0 || fseeko(ply->in.file, start, SEEK_SET) != 0 ||
        iso_mapping_of_file(reading->path, ply->in.file, element->count * found.record, &points->mapping,
                            NULL) != ISO_OK)
        return false;
    const unsigned char *records = iso_mapping_data(points->mapping);
    points->source = (iso_point_source){.count = (size_t)element->count,
                                        .positions = {records + found.position, found.record},
                                        .normals = {records + found.normal, found.record}};
    if (found.colored) points->source.colors = (iso_point_column){records + found.color, found.record};
    return true;
}

static bool open_ply(iso_ply *ply, iso_reading *reading, iso_mapped_points *points) {
    if (iso_ply_open(reading->path, ply, NULL) != ISO_OK) return false;
    for (int i = 0; i < ply->element_count; i++) {
        const iso_ply_element *element = &ply->elements[i];
        if (strcmp(element->name, "vertex") == 0) return map_points(ply, element, reading, points);
        if (iso_ply_skip_element(ply, element, NULL) != ISO_OK) return false;
    }
    return false;
}

/* Whether colours, if there are any, are not 0 throughout. */
static bool has_colors(const iso_point_source *source) {
    static const unsigned char black[3];
    if (!source->colors.data) return true;
    for (size_t i = 0; i < source->count; i++)
        if (memcmp(source->colors.data + i * source->colors.stride, black, sizeof black) != 0) return true;
    return false;
}

static bool is_usable(const iso_point_source *source, const iso_point_survey *survey) {
    bool usable = survey->finite && !survey->without_normals &&
                  !iso_zeros_are_unmeasured(survey->zeros, source->count) && has_colors(source);
    for (int axis = 0; axis < 3; axis++)
        usable &= (double)survey->lo[axis] >= -ISO_FARTHEST && (double)survey->hi[axis] <= ISO_FARTHEST;
    return usable;
}

bool iso_mapped_points_open(const char *path, const iso_read_opts *opts, iso_pool *pool,
                            iso_mapped_points *points) {
    iso_read_report unused;
    iso_reading reading = iso_reading_begin(path, opts, &unused);
    iso_ply *ply = iso_alloc_zero(1, sizeof *ply);
    *points = (iso_mapped_points){.mapping = NULL};
    const bool plain = reading.opts.every == 1 && !iso_reading_is_ras(&reading, ISO_SPACE_FILE);
    const bool open = plain && ply && open_ply(ply, &reading, points) &&
                      iso_point_source_survey(&points->source, pool, &points->survey, NULL) == ISO_OK &&
                      is_usable(&points->source, &points->survey);
    if (ply) iso_ply_close(ply);
    iso_free(ply);
    if (!open) {
        iso_mapped_points_close(points);
        return false;
    }
    snprintf(reading.report->format, sizeof reading.report->format, "ply");
    reading.report->items = points->source.count;
    return true;
}

void iso_mapped_points_close(iso_mapped_points *points) {
    if (points->mapping) iso_mapping_destroy(points->mapping);
    *points = (iso_mapped_points){.mapping = NULL};
}
