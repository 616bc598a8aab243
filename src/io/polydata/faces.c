/* faces: triangles, and normals from them. Angles are computed without the C library, so that normals are the
 * same on every machine. */
#include "io/polydata/faces.h"

#include "io/common/fans.h"

/* ---- triangles */

static iso_status add_triangle(iso_reading *reading, iso_faces *faces, uint32_t a, uint32_t b, uint32_t c,
                               iso_error *error) {
    const size_t count = faces->count, each = 3 * sizeof(uint32_t);
    ISO_TRY(iso_reading_reserve(reading, &faces->corners, count + 1, each, count, error));
    uint32_t *to = (uint32_t *)faces->corners.data + 3 * faces->count++;
    to[0] = a;
    to[1] = b;
    to[2] = c;
    return ISO_OK;
}

iso_status iso_faces_add_corner(iso_reading *reading, iso_faces *faces, iso_face *face, uint32_t corner,
                                iso_error *error) {
    const size_t count = face->count++;
    const uint32_t first = face->first, last = face->last;
    if (count == 0 || (face->strip && count > 1)) face->first = count == 0 ? corner : last;
    face->last = corner;
    if (count < 2) return ISO_OK;
    /* every other triangle of a strip turns the other way */
    const bool turned = face->strip && count % 2;
    return add_triangle(reading, faces, turned ? last : first, turned ? first : last, corner, error);
}

iso_status iso_faces_end_face(iso_reading *reading, iso_faces *faces, const iso_face *face,
                              iso_error *error) {
    const size_t count = faces->fan_count;
    if (face->strip || face->count < 4) return ISO_OK;
    ISO_TRY(iso_reading_reserve(reading, &faces->fans, count + 1, sizeof(iso_fan), count, error));
    ((iso_fan *)faces->fans.data)[faces->fan_count++] =
        (iso_fan){faces->count - (face->count - 2), face->count};
    return ISO_OK;
}

void iso_faces_free(iso_reading *reading, iso_faces *faces) {
    iso_reading_free(reading, &faces->corners);
    iso_reading_free(reading, &faces->fans);
    faces->count = faces->fan_count = 0;
}

/* ---- normals */

/* The arc tangent of a number 0 .. 1, to 2e-8 (Abramowitz and Stegun 1964, 4.4.49). */
static double arc_tangent(double x) {
    static const double factors[] = {0.0028662257,  -0.0161657367, 0.0429096138,
                                     -0.0752896400, 0.1065626393,  -0.1420889944,
                                     0.1999355085,  -0.3333314528, 1};
    double sum = 0;
    for (int i = 0; i < 9; i++) sum = sum * x * x + factors[i];
    return sum * x;
}

/* The angle between two vectors of length 1: twice the arc tangent of |a x b| / (1 + a.b). */
static double angle_between(iso_vec3 a, iso_vec3 b) {
    const double pi = 3.14159265358979323846, sine = iso_vec3_length(iso_vec3_cross(a, b)),
                 other = 1 + iso_vec3_dot(a, b);
    if (sine <= other) return sine > 0 ? 2 * arc_tangent(sine / other) : 0;
    return pi - 2 * arc_tangent(other > 0 ? other / sine : 0);
}

/* Adds a triangle's normal to those of its corners. */
static void add_normal(const float (*points)[3], const uint32_t corners[3], float (*normals)[3]) {
    iso_vec3 p[3], edges[3];
    for (int k = 0; k < 3; k++) {
        const float *at = points[corners[k]];
        p[k] = iso_vec3_make((double)at[0], (double)at[1], (double)at[2]);
    }
    for (int k = 0; k < 3; k++) edges[k] = iso_vec3_unit(iso_vec3_sub(p[(k + 1) % 3], p[k]));
    const iso_vec3 normal = iso_vec3_unit(iso_vec3_cross(edges[0], edges[1]));
    const double length = iso_vec3_length(normal);
    if (!(length > 0.5 && length < 2)) return; /* the triangle has no area, or a corner is not usable */
    for (int k = 0; k < 3; k++) {
        const double angle = angle_between(edges[k], iso_vec3_scale(edges[(k + 2) % 3], -1));
        float *to = normals[corners[k]];
        to[0] += (float)(angle * normal.x);
        to[1] += (float)(angle * normal.y);
        to[2] += (float)(angle * normal.z);
    }
}

static void normalize(float n[3]) {
    const iso_vec3 unit = iso_vec3_unit(iso_vec3_make((double)n[0], (double)n[1], (double)n[2]));
    n[0] = (float)unit.x;
    n[1] = (float)unit.y;
    n[2] = (float)unit.z;
}

bool iso_faces_are_wanted(const iso_polydata *data) {
    for (int i = 0; i < data->column_count; i++)
        if (iso_polydata_column(data, i)->role == ISO_ROLE_NORMAL) return false;
    return data->points_only && data->reading->opts.normals_from_faces;
}

static iso_status check_corners(const iso_faces *faces, const iso_polydata *data, iso_error *error) {
    const uint32_t *corners = faces->corners.data;
    for (size_t i = 0; i < 3 * faces->count; i++)
        if (corners[i] >= data->point_count)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a face names point %lu of %zu",
                            data->reading->path, (unsigned long)corners[i], data->point_count);
    return ISO_OK;
}

iso_status iso_faces_make_normals(const iso_faces *faces, iso_polydata *data, iso_error *error) {
    int column;
    if (faces->count == 0 || !iso_faces_are_wanted(data)) return ISO_OK;
    ISO_TRY(check_corners(faces, data, error));
    ISO_TRY(iso_fans_divide(data->reading->path, faces->fans.data, faces->fan_count,
                            (const float(*)[3])data->points.data, faces->corners.data, error));
    ISO_TRY(iso_polydata_add_column(data, "normals", 3, false, ISO_ROLE_NORMAL, &column, error));
    ISO_TRY(iso_polydata_reserve(data, data->point_count, error));
    float(*normals)[3] = iso_polydata_column(data, column)->values.data;
    const uint32_t *corners = faces->corners.data;
    for (size_t i = 0; i < data->point_count; i++) normals[i][0] = normals[i][1] = normals[i][2] = 0;
    for (size_t i = 0; i < faces->count; i++) add_normal(data->points.data, corners + 3 * i, normals);
    for (size_t i = 0; i < data->point_count; i++) normalize(normals[i]);
    return ISO_OK;
}
