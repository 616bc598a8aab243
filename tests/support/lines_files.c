/* lines_files: writers of files of lines. */
#include "lines_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "check_support.h"

iso_lines random_lines(int count, uint32_t seed) {
    iso_lines lines = {.line_count = (size_t)count};
    lines.starts = iso_alloc((size_t)(count + 1) * sizeof *lines.starts);
    lines.vertices = iso_alloc((size_t)count * 9 * sizeof *lines.vertices);
    lines.starts[0] = 0;
    for (int i = 0; i < count; i++) {
        const size_t vertices = 1 + random_bits(&seed) % 9;
        for (size_t v = 0; v < vertices; v++, lines.vertex_count++)
            for (int axis = 0; axis < 3; axis++)
                lines.vertices[lines.vertex_count][axis] =
                    (float)((int)(random_bits(&seed) % 204800) - 102400) / 1024;
        lines.starts[i + 1] = lines.vertex_count;
    }
    return lines;
}

void check_same_lines(const iso_lines *got, const iso_lines *wanted, double tolerance) {
    assert_int_equal(got->line_count, wanted->line_count);
    assert_int_equal(got->vertex_count, wanted->vertex_count);
    for (size_t i = 0; i <= wanted->line_count; i++) assert_int_equal(got->starts[i], wanted->starts[i]);
    const double shift[3] = {got->origin.x - wanted->origin.x, got->origin.y - wanted->origin.y,
                             got->origin.z - wanted->origin.z};
    for (size_t i = 0; i < wanted->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            near((double)got->vertices[i][axis] + shift[axis], (double)wanted->vertices[i][axis], tolerance);
}

static void put_number(FILE *file, const void *number, int size, bool big) {
    const unsigned char *bytes = number; /* the tests run on little-endian machines */
    for (int i = 0; i < size; i++) fputc(bytes[big ? size - 1 - i : i], file);
}

static void put_float(FILE *file, double value, bool big) {
    const float number = (float)value;
    put_number(file, &number, 4, big);
}

static void put_int(FILE *file, int32_t value, bool big) {
    put_number(file, &value, 4, big);
}

/* ---- .tck */

static void put_triple(FILE *file, double x, double y, double z, int value, bool big) {
    const double p[3] = {x, y, z};
    for (int i = 0; i < 3; i++) {
        if (value == 4)
            put_float(file, p[i], big);
        else
            put_number(file, &p[i], 8, big);
    }
}

void write_tck(const char *path, const iso_lines *lines, int value, bool big) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file, "mrtrix tracks    \ncount: %010zu\ntimestamp: 1.5\ndatatype: Float%d%s\nfile: . 100\nEND\n",
            lines->line_count, 8 * value, big ? "BE" : "LE");
    assert_true(ftell(file) <= 100);
    while (ftell(file) < 100) fputc('\n', file);
    for (size_t i = 0; i < lines->line_count; i++) {
        for (size_t v = lines->starts[i]; v < lines->starts[i + 1]; v++) {
            const float *p = lines->vertices[v];
            put_triple(file, (double)-p[0], (double)-p[1], (double)p[2], value, big);
        }
        put_triple(file, (double)NAN, (double)NAN, (double)NAN, value, big);
    }
    put_triple(file, (double)INFINITY, (double)INFINITY, (double)INFINITY, value, big);
    assert_int_equal(fclose(file), 0);
}

/* ---- .trk */

float trk_scalar(int s, size_t i) {
    return (float)(s + 1) * (float)(i % 1000);
}

float trk_property(int p, size_t i) {
    return (float)(p + 1) * 0.5f - (float)(i % 1000);
}

/* Solves matrix * index = ras by Cramer's rule. */
static void to_index(const double m[12], const double ras[3], double index[3]) {
    iso_vec3 c[3];
    for (int i = 0; i < 3; i++) c[i] = iso_vec3_make(m[i], m[4 + i], m[8 + i]);
    const iso_vec3 b = iso_vec3_make(ras[0] - m[3], ras[1] - m[7], ras[2] - m[11]);
    const double determinant = iso_vec3_dot(c[0], iso_vec3_cross(c[1], c[2]));
    index[0] = iso_vec3_dot(b, iso_vec3_cross(c[1], c[2])) / determinant;
    index[1] = iso_vec3_dot(c[0], iso_vec3_cross(b, c[2])) / determinant;
    index[2] = iso_vec3_dot(c[0], iso_vec3_cross(c[1], b)) / determinant;
}

static double column_length(const double m[12], int i) {
    return iso_vec3_length(iso_vec3_make(m[i], m[4 + i], m[8 + i]));
}

/* The matrix's column that lies nearest to the axis of a letter; *turned: it points to the other end. */
static int column_of(const double m[12], char letter, bool *turned) {
    const int row = strchr("RL", letter) ? 0 : strchr("AP", letter) ? 1 : 2;
    int best = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(m[4 * row + i]) > fabs(m[4 * row + best])) best = i;
    *turned = (m[4 * row + best] > 0) != (strchr("RAS", letter) != NULL);
    return best;
}

/* The stored point: along each axis of `order`, mm from the corner of its first voxel. */
static void to_stored(const trk_layout *layout, const float lps[3], double point[3]) {
    const double ras[3] = {(double)-lps[0], (double)-lps[1], (double)lps[2]};
    double index[3];
    to_index(layout->matrix, ras, index);
    for (int i = 0; i < 3; i++) {
        bool turned;
        const int column = column_of(layout->matrix, layout->order[i], &turned);
        const double from_corner = turned ? layout->dims[i] - 1 - index[column] : index[column];
        point[i] = (from_corner + 0.5) * column_length(layout->matrix, column);
    }
}

static void put_names(FILE *file, const char *prefix, int count) {
    char names[10][20] = {{0}};
    for (int i = 0; i < count; i++) snprintf(names[i], sizeof names[i], "%s%d", prefix, i);
    fwrite(names, sizeof names, 1, file);
}

static void put_zeros(FILE *file, int count) {
    for (int i = 0; i < count; i++) fputc(0, file);
}

static void put_header(FILE *file, const iso_lines *lines, const trk_layout *layout) {
    fwrite("TRACK", 6, 1, file);
    for (int i = 0; i < 3; i++) {
        const int16_t dim = (int16_t)layout->dims[i];
        put_number(file, &dim, 2, layout->big);
    }
    for (int i = 0; i < 3; i++) {
        bool turned;
        const int column = column_of(layout->matrix, layout->order[i], &turned);
        put_float(file, column_length(layout->matrix, column), layout->big);
    }
    put_zeros(file, 12); /* the origin, which nobody uses */
    const int16_t counts[2] = {(int16_t)layout->scalars, (int16_t)layout->properties};
    put_number(file, &counts[0], 2, layout->big);
    put_names(file, "s", layout->scalars);
    put_number(file, &counts[1], 2, layout->big);
    put_names(file, "p", layout->properties);
    for (int i = 0; i < 16; i++)
        put_float(file, layout->version < 2 ? 0 : i < 12 ? layout->matrix[i] : i == 15, layout->big);
    put_zeros(file, 444);
    fwrite(layout->order, 3, 1, file);
    put_zeros(file, 37);
    put_int(file, (int32_t)lines->line_count, layout->big);
    put_int(file, layout->version, layout->big);
    put_int(file, 1000, layout->big);
    assert_int_equal(ftell(file), 1000);
}

void write_trk(const char *path, const iso_lines *lines, const trk_layout *layout) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    put_header(file, lines, layout);
    for (size_t i = 0; i < lines->line_count; i++) {
        put_int(file, (int32_t)(lines->starts[i + 1] - lines->starts[i]), layout->big);
        for (size_t v = lines->starts[i]; v < lines->starts[i + 1]; v++) {
            double point[3];
            to_stored(layout, lines->vertices[v], point);
            for (int axis = 0; axis < 3; axis++) put_float(file, point[axis], layout->big);
            for (int s = 0; s < layout->scalars; s++) put_float(file, (double)trk_scalar(s, v), layout->big);
        }
        for (int p = 0; p < layout->properties; p++) put_float(file, (double)trk_property(p, i), layout->big);
    }
    assert_int_equal(fclose(file), 0);
}
