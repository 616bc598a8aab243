/* points_read: reads points from PLY. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/encode.h"
#include "io/ply.h"
#include "io/points_io.h"

enum { NEEDED = 7, RED = NEEDED, VALUES = NEEDED + 3 };
static const char *const value_names[VALUES] = {"x",  "y",      "z",   "nx",    "ny",
                                                "nz", "radius", "red", "green", "blue"};

/* The points that are being read. */
typedef struct collector {
    iso_buffer surfels, radii, colors;
    bool colored;
    size_t count;
    uint64_t max_memory; /* 0: no limit */
} collector;

enum { BYTES_PER_POINT = sizeof(iso_surfel) + sizeof(float), BYTES_PER_COLOR = 3 };

static size_t bytes_per_point(const collector *points) {
    return BYTES_PER_POINT + (points->colored ? BYTES_PER_COLOR : 0);
}

/* Sets slot[i] to the number of the value in the element's property i; -1: not used. The error message names
 * the required values that are missing. */
static iso_status assign_values(const iso_ply *ply, const iso_ply_element *element,
                                int slot[ISO_PLY_PROPERTIES], bool *colored, iso_error *error) {
    bool found[VALUES] = {false};
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_property *property = &ply->properties[element->first_property + i];
        slot[i] = -1;
        for (int value = 0; value < VALUES; value++)
            if (!property->is_list && !found[value] && strcmp(property->name, value_names[value]) == 0) {
                slot[i] = value;
                found[value] = true;
            }
    }
    char missing[64] = "";
    *colored = found[RED] && found[RED + 1] && found[RED + 2];
    for (int value = 0; value < NEEDED; value++)
        if (!found[value]) {
            strcat(missing, " ");
            strcat(missing, value_names[value]);
        }
    if (!*missing) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its points have no%s (needed: x y z nx ny nz radius)",
                    ply->in.path, missing);
}

static iso_status read_values(iso_ply *ply, const iso_ply_element *element, const int *slot,
                              double values[VALUES], iso_error *error) {
    const iso_ply_property *property = &ply->properties[element->first_property];
    double value[ISO_PLY_PROPERTIES];
    ISO_TRY(iso_ply_read_item(ply, element, value, error));
    for (int i = 0; i < element->property_count; i++) {
        if (slot[i] < 0) continue;
        const bool fraction = property[i].type == ISO_PLY_FLOAT32 || property[i].type == ISO_PLY_FLOAT64;
        values[slot[i]] = slot[i] >= RED && fraction ? value[i] * 255 : value[i];
    }
    return ISO_OK;
}

/* Normalizes a normal. If its length is already 1 to float precision it is not changed, so that points that
 * were written are read back with the same bits. Returns false for the zero normal. */
static bool make_normal(const double n[3], float normal[3]) {
    double square = 0, largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        normal[axis] = (float)n[axis];
        square += (double)normal[axis] * (double)normal[axis];
        largest = fmax(largest, fabs(n[axis]));
    }
    if (!(largest > 0)) return false;
    if (fabs(square - 1) < 1e-6) return true;
    /* scaled first: the squares of tiny components would underflow */
    iso_vec3 unit = iso_vec3_unit(iso_vec3_make(n[0] / largest, n[1] / largest, n[2] / largest));
    normal[0] = (float)unit.x;
    normal[1] = (float)unit.y;
    normal[2] = (float)unit.z;
    return true;
}

/* The largest allowed coordinate and radius, mm, as for volumes (grids/volume/volume.c). With larger ones no
 * camera could be placed. */
static const double farthest = 1e12;

/* Sets a point; false when it must be dropped. */
static bool make_point(const double values[VALUES], iso_surfel *surfel, float *radius) {
    for (int i = 0; i < NEEDED; i++)
        if (!(fabs(values[i]) <= (i < 3 || i == 6 ? farthest : (double)FLT_MAX))) return false;
    for (int axis = 0; axis < 3; axis++) surfel->position[axis] = (float)values[axis];
    *radius = (float)values[6];
    return *radius > 0 && make_normal(values + 3, surfel->normal);
}

static void make_color(const double values[VALUES], uint8_t color[3]) {
    for (int k = 0; k < 3; k++) {
        double value = values[RED + k];
        color[k] = (uint8_t)(value > 0 ? value < 255 ? value + 0.5 : 255 : 0);
    }
}

/* Makes room for `count` points; keeps those read so far. */
static iso_status reserve_points(collector *points, size_t count, const char *path, iso_error *error) {
    if (points->max_memory && count > points->max_memory / bytes_per_point(points))
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %zu points take more than the limit of %llu bytes", path,
                        count, (unsigned long long)points->max_memory);
    iso_error inner = {0};
    iso_status status = iso_buffer_reserve(&points->surfels, count * sizeof(iso_surfel),
                                           points->count * sizeof(iso_surfel), &inner);
    if (status == ISO_OK)
        status =
            iso_buffer_reserve(&points->radii, count * sizeof(float), points->count * sizeof(float), &inner);
    if (status == ISO_OK && points->colored)
        status = iso_buffer_reserve(&points->colors, count * BYTES_PER_COLOR, points->count * BYTES_PER_COLOR,
                                    &inner);
    if (status == ISO_OK) return ISO_OK;
    return iso_fail(error, status, "%s: out of memory for %zu points", path, count);
}

/* Reads the vertices. The header's count is checked against the file's size before memory is allocated. */
static iso_status read_points(iso_ply *ply, const iso_ply_element *element, collector *points,
                              iso_error *error) {
    int slot[ISO_PLY_PROPERTIES];
    ISO_TRY(assign_values(ply, element, slot, &points->colored, error));
    ISO_TRY(iso_ply_check_size(ply, element, error));
    if (element->count > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: more than %lu points", ply->in.path,
                        (unsigned long)UINT32_MAX);
    ISO_TRY(reserve_points(points, (size_t)element->count, ply->in.path, error));
    for (uint64_t i = 0; i < element->count; i++) {
        double values[VALUES] = {0};
        ISO_TRY(read_values(ply, element, slot, values, error));
        iso_surfel *surfel = (iso_surfel *)points->surfels.data + points->count;
        if (!make_point(values, surfel, (float *)points->radii.data + points->count)) continue;
        if (points->colored)
            make_color(values, (uint8_t *)points->colors.data + points->count * BYTES_PER_COLOR);
        points->count++;
    }
    if (points->count == 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: none of its %llu points is usable", ply->in.path,
                        (unsigned long long)element->count);
    return ISO_OK;
}

static iso_status read_file(iso_ply *ply, const char *path, collector *points, iso_error *error) {
    ISO_TRY(iso_ply_open(path, ply, error));
    for (int i = 0; i < ply->element_count; i++) {
        const iso_ply_element *element = &ply->elements[i];
        if (strcmp(element->name, "vertex") == 0 && element->count > 0)
            return read_points(ply, element, points, error);
        ISO_TRY(iso_ply_skip_element(ply, element, error));
    }
    return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no points", path);
}

iso_status iso_points_read_ply(const char *path, uint64_t max_memory, iso_points *out, iso_error *error) {
    iso_ply *ply = malloc(sizeof *ply);
    if (!ply) return iso_fail_memory(error, path);
    ply->in.file = NULL;
    collector points = {.max_memory = max_memory};
    void *numbers = iso_encode_numbers_begin();
    iso_status status = read_file(ply, path, &points, error);
    iso_encode_numbers_end(numbers);
    iso_ply_close(ply);
    free(ply);
    if (status != ISO_OK) {
        iso_buffer_free(&points.surfels);
        iso_buffer_free(&points.radii);
        iso_buffer_free(&points.colors);
        return status;
    }
    *out = (iso_points){.surfels = points.surfels.data,
                        .radii = points.radii.data,
                        .colors = points.colors.data,
                        .span = {.count = (uint32_t)points.count}};
    return ISO_OK;
}

void iso_points_free(iso_points *points) {
    iso_free(points->surfels);
    iso_free(points->radii);
    iso_free(points->colors);
    *points = (iso_points){0};
}

iso_point_view iso_points_view(const iso_points *points) {
    return (iso_point_view){.surfels = points->surfels,
                            .radii = points->radii,
                            .colors = (const uint8_t(*)[3])points->colors,
                            .spans = &points->span,
                            .span_count = 1,
                            .transform = iso_transform_identity(),
                            .radius = points->span.count ? (double)points->radii[0] : 0};
}
