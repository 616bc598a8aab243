/* polydata_glyphs: the points of polydata as glyphs. Points that are not usable are left out in place.
 *
 * Files of Gaussian splats (Kerbl et al. 2023, "3D Gaussian Splatting for Real-Time Radiance Field
 * Rendering") are recognised by their columns f_dc: their scales are natural logarithms of standard
 * deviations, opacities are logits, and the colour is .5 + .28209479 f_dc, the constant term of spherical
 * harmonics. Flat ones with two scales (Huang et al. 2024, "2D Gaussian Splatting") get a third that is
 * next to nothing. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/exponential.h"
#include "io/polydata/polydata.h"

/* Moves the numbers of item `from` to item `to`, which is the same or an earlier one. */
static void move_item(iso_buffer *buffer, size_t floats, size_t from, size_t to) {
    float *values = buffer->data;
    if (values && from != to) memcpy(values + to * floats, values + from * floats, floats * sizeof(float));
}

/* ---- points that are left out */

static bool is_zero(const iso_polydata *data, const float p[3]) {
    return p[0] == (float)-data->origin.x && p[1] == (float)-data->origin.y && p[2] == (float)-data->origin.z;
}

/* Depth cameras write 0 0 0 where they measure nothing. A single such point may be real, also all of them:
 * arrows that begin at 0 0 0. */
static bool has_unmeasured(const iso_polydata *data) {
    const float(*points)[3] = data->points.data;
    size_t zeros = 0;
    if (data->reading->opts.keep_zeros) return false;
    if (iso_column_find(data->column_array.data, data->column_count, ISO_ROLE_VECTOR)) return false;
    for (size_t i = 0; i < data->point_count; i++) zeros += is_zero(data, points[i]);
    if (!iso_zeros_are_unmeasured(zeros, data->point_count)) return false;
    iso_reading_note(data->reading,
                     "%zu points lie at exactly 0 0 0, which depth cameras write where they measure nothing: "
                     "they are left out",
                     zeros);
    return true;
}

static void keep_usable(iso_polydata *data) {
    iso_read_report *report = data->reading->report;
    const size_t every = (size_t)data->reading->opts.every, count = data->point_count;
    const float(*points)[3] = data->points.data;
    const bool unmeasured = has_unmeasured(data);
    size_t kept = 0;
    report->items = count;
    /* most files lose no point: nothing moves before the first that is left out */
    while (every == 1 && !unmeasured && kept < count && !isnan(points[kept][0])) kept++;
    for (size_t i = kept; i < count; i++) {
        if (i % every || (unmeasured && is_zero(data, points[i]))) continue;
        if (isnan(points[i][0])) {
            report->dropped++;
            continue;
        }
        move_item(&data->points, 3, i, kept);
        for (int k = 0; k < data->column_count; k++) {
            iso_column *column = iso_polydata_column(data, k);
            if (!column->per_line) move_item(&column->values, (size_t)column->components, i, kept);
        }
        kept++;
    }
    data->point_count = kept;
}

/* ---- axes */

static iso_column *find_column(iso_polydata *data, const char *name, int components) {
    for (int i = 0; i < data->column_count; i++) {
        iso_column *column = iso_polydata_column(data, i);
        if (column->components == components && strcasecmp(column->name, name) == 0 && column->values.data)
            return column;
    }
    return NULL;
}

/* Returns the length of a half axis; if the file's number is not usable, counts it and returns 0. */
static double length_of(iso_reading *reading, float scale, bool logarithmic) {
    const double log2_e = 1.4426950408889634;
    double length = (double)scale;
    if (logarithmic && isfinite(length)) length = (double)iso_exp2((float)fmin(length * log2_e, 127));
    if (length >= 0 && length <= ISO_FARTHEST) return length;
    reading->report->mended_radii++;
    return 0;
}

static void make_axes(iso_reading *reading, const float *scale, const float *quaternion, bool logarithmic,
                      bool ras, float axes[9]) {
    const double wxyz[4] = {(double)quaternion[0], (double)quaternion[1], (double)quaternion[2],
                            (double)quaternion[3]};
    double m[9];
    iso_quaternion_matrix(wxyz, m);
    for (int k = 0; k < 3; k++) {
        const double length = length_of(reading, scale[k], logarithmic);
        for (int row = 0; row < 3; row++)
            axes[3 * k + row] = (float)(m[3 * row + k] * length * (ras && row < 2 ? -1 : 1));
    }
}

static iso_status take_axes(iso_polydata *data, bool ras, iso_glyphs *glyphs, iso_error *error) {
    const float thickness = -13.8155106f; /* of flat Gaussians: the natural logarithm of 1e-6 */
    const bool logarithmic = data->packed_gaussians || find_column(data, "f_dc", 3) != NULL;
    iso_column *scale = find_column(data, "scale", 3), *rot = find_column(data, "rot", 4);
    if (!scale && logarithmic) scale = find_column(data, "scale", 2);
    if (!scale || !rot) return ISO_OK;
    const size_t scales = (size_t)scale->components;
    iso_buffer axes = {0};
    ISO_TRY(iso_reading_reserve(data->reading, &axes, data->point_count, 9 * sizeof(float), 0, error));
    glyphs->axes = axes.data;
    for (size_t i = 0; i < data->point_count; i++) {
        float own[3] = {0, 0, thickness};
        memcpy(own, (const float *)scale->values.data + scales * i, scales * sizeof *own);
        make_axes(data->reading, own, (const float *)rot->values.data + 4 * i, logarithmic, ras,
                  glyphs->axes[i]);
    }
    iso_reading_free(data->reading, &scale->values);
    iso_reading_free(data->reading, &rot->values);
    return ISO_OK;
}

/* ---- Gaussians */

/* Converts opacities from logits to 0 .. 1. */
static void convert_opacities(iso_column *opacity, size_t count) {
    float *values = opacity->values.data;
    const float log2_e = 1.44269504f;
    for (size_t i = 0; i < count; i++)
        values[i] = 1 / (1 + iso_exp2(fminf(-values[i] * log2_e, 127))); /* (0 of a NaN) */
}

/* Whether the points, whose axes have been made, are Gaussians with opacities. */
static bool take_gaussians(iso_polydata *data) {
    iso_column *opacity = find_column(data, "opacity", 1);
    if (data->packed_gaussians) return true;
    if (!opacity || !find_column(data, "f_dc", 3)) return false;
    convert_opacities(opacity, data->point_count);
    return true;
}

/* ---- roles */

/* Converts the constant terms of the colours of Gaussian splats to display colours. */
static void color_splats(iso_polydata *data) {
    iso_column *column = find_column(data, "f_dc", 3);
    if (!column) return;
    float *values = column->values.data;
    for (size_t i = 0; i < 3 * data->point_count; i++) values[i] = 255 * (0.5f + 0.28209479f * values[i]);
    column->role = ISO_ROLE_COLOR;
}

/* Whether colours are 0 throughout, which programs write that know none: all points would be black. */
static bool are_unknown(iso_polydata *data, const iso_column *colors) {
    const float *values = colors->values.data;
    const size_t numbers = data->point_count * (size_t)colors->components;
    for (size_t i = 0; i < numbers; i++)
        if (values[i] > 0 || values[i] < 0) return false;
    if (data->point_count) iso_reading_note(data->reading, "its colours are 0 throughout and are not used");
    return true;
}

static iso_status take_colors(iso_polydata *data, iso_glyphs *glyphs, iso_error *error) {
    iso_column *colors = iso_column_find(data->column_array.data, data->column_count, ISO_ROLE_COLOR);
    if (!colors) return ISO_OK;
    if (glyphs->gaussians || !are_unknown(data, colors))
        return iso_column_take_colors(data->reading, colors, data->point_count, &glyphs->colors, error);
    iso_reading_free(data->reading, &colors->values);
    return ISO_OK;
}

/* ---- opacities */

/* Returns what an opacity column's numbers are multiplied by to lie in 0 .. 255: integers of 8 or 16 bits and
 * fractions are told apart by the largest number, which is returned, too. */
static float opacity_factor(const float *values, size_t count, float *most) {
    *most = 0;
    for (size_t i = 0; i < count; i++) *most = values[i] > *most ? values[i] : *most;
    return *most > 255 ? 1 / 257.0f : *most > 1 ? 1 : 255;
}

/* Converts the column "alpha" to opacities; the column remains an attribute. Without an effect are columns
 * that make all points opaque, and those that are 0 throughout, which some programs write for "unknown". */
static iso_status take_opacities(iso_polydata *data, iso_glyphs *glyphs, iso_error *error) {
    iso_column *alpha = find_column(data, "alpha", 1);
    if (!alpha || glyphs->gaussians) return ISO_OK;
    const float *values = alpha->values.data;
    float most;
    const float factor = opacity_factor(values, data->point_count, &most);
    iso_buffer bytes = {0};
    if (!(most > 0)) {
        if (data->point_count)
            iso_reading_note(data->reading, "its column alpha is 0 throughout and is not used");
        return ISO_OK;
    }
    ISO_TRY(iso_reading_reserve(data->reading, &bytes, data->point_count, 1, 0, error));
    uint8_t *to = bytes.data;
    bool opaque = true;
    for (size_t i = 0; i < data->point_count; i++) {
        const float value = values[i] * factor;
        to[i] = (uint8_t)(value > 0 ? value < 255 ? value + 0.5f : 255 : 0);
        opaque &= to[i] == 255;
    }
    if (opaque)
        iso_reading_free(data->reading, &bytes);
    else
        glyphs->opacities = to;
    return ISO_OK;
}

static iso_status take_roles(iso_polydata *data, bool ras, iso_glyphs *glyphs, iso_error *error) {
    iso_column *columns = data->column_array.data;
    const int count = data->column_count;
    const size_t points = data->point_count;
    ISO_TRY(take_axes(data, ras, glyphs, error));
    glyphs->gaussians = glyphs->axes && take_gaussians(data);
    color_splats(data);
    ISO_TRY(take_colors(data, glyphs, error));
    for (int i = 0; i < count && ras; i++) iso_column_turn(&columns[i], points);
    iso_column *radii = iso_column_find(columns, count, ISO_ROLE_RADIUS),
               *vectors = iso_column_find(columns, count, ISO_ROLE_VECTOR);
    if (!vectors) vectors = iso_column_find(columns, count, ISO_ROLE_NORMAL);
    if (radii) glyphs->radii = iso_column_take_radii(data->reading, radii, points);
    if (vectors) glyphs->directions = iso_column_take_vectors(vectors, points, false);
    return take_opacities(data, glyphs, error);
}

static void turn_points(iso_polydata *data) {
    float(*points)[3] = data->points.data;
    for (size_t i = 0; i < data->point_count; i++)
        for (int axis = 0; axis < 2; axis++) points[i][axis] = -points[i][axis];
    data->origin = iso_vec3_make(-data->origin.x, -data->origin.y, data->origin.z);
}

static void free_line_columns(iso_polydata *data) {
    for (int i = 0; i < data->column_count; i++)
        if (iso_polydata_column(data, i)->per_line)
            iso_reading_free(data->reading, &iso_polydata_column(data, i)->values);
}

iso_status iso_polydata_to_glyphs(iso_polydata *data, iso_glyphs *glyphs, iso_error *error) {
    const bool ras = iso_reading_is_ras(data->reading, data->stated);
    free_line_columns(data);
    ISO_TRY(iso_polydata_reserve(data, data->point_count ? data->point_count : 1, error));
    keep_usable(data);
    if (ras) turn_points(data);
    iso_glyphs made = {.origin = data->origin, .count = data->point_count};
    iso_status status = take_roles(data, ras, &made, error);
    if (status == ISO_OK)
        status = iso_columns_take(data->column_array.data, data->column_count, &made.attributes,
                                  &made.attribute_count, error);
    if (status != ISO_OK) {
        iso_glyphs_free(&made);
        return status;
    }
    made.closed = made.count && made.count == data->closed_points;
    made.positions = data->points.data;
    data->points = (iso_buffer){0};
    *glyphs = made;
    return ISO_OK;
}
