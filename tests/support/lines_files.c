/* lines_files: writers of files of lines. */
#include "lines_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "check_support.h"
#include "file_support.h"
#include "index_support.h"

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

/* ---- .vtk */

typedef struct vtk_writer {
    FILE *file;
    const iso_lines *lines;
    const vtk_layout *layout;
} vtk_writer;

/* A number as text or as `size` big-endian bytes of it. */
static void put_whole(const vtk_writer *w, int64_t value, int size) {
    if (w->layout->binary)
        put_number(w->file, &value, size, true);
    else
        fprintf(w->file, "%lld ", (long long)value);
}

static void put_real(const vtk_writer *w, double value, bool is_double) {
    if (!w->layout->binary)
        fprintf(w->file, "%.17g\n", value);
    else if (is_double)
        put_number(w->file, &value, 8, true);
    else
        put_float(w->file, value, true);
}

static void put_cells(const vtk_writer *w, const char *name, size_t count, const size_t *starts,
                      size_t last) {
    const bool split = w->layout->version >= 5;
    const size_t size = starts[count];
    fprintf(w->file, "%s %zu %zu\n", name, split ? count + 1 : count, split ? size : size + count);
    if (split) {
        fprintf(w->file, "OFFSETS vtktypeint64\n");
        for (size_t i = 0; i <= count; i++) put_whole(w, (int64_t)starts[i], 8);
        fprintf(w->file, "\nCONNECTIVITY vtktypeint64\n");
    }
    for (size_t i = 0; i < count; i++) {
        if (!split) put_whole(w, (int64_t)(starts[i + 1] - starts[i]), 4);
        for (size_t k = starts[i]; k < starts[i + 1]; k++) put_whole(w, (int64_t)(last - k), split ? 8 : 4);
    }
    fputc('\n', w->file);
}

static void put_points(const vtk_writer *w) {
    const size_t count = w->lines->vertex_count;
    fprintf(w->file, "POINTS %zu %s\n", count, w->layout->doubles ? "double" : "float");
    for (size_t i = count; i-- > 0;)
        for (int axis = 0; axis < 3; axis++)
            put_real(w, (double)w->lines->vertices[i][axis], w->layout->doubles);
    fputc('\n', w->file);
}

/* Three numbers of each point. */
static void put_triples(const vtk_writer *w, bool color) {
    for (size_t i = w->lines->vertex_count; i-- > 0;)
        for (int s = 0; s < 3; s++) {
            const int level = s == 0 ? (int)trk_scalar(0, i) % 256 : s == 1 ? 7 : 255;
            if (!color)
                put_real(w, (double)trk_scalar(s, i), false);
            else if (w->layout->binary)
                fputc(level, w->file);
            else
                fprintf(w->file, "%.9g ", level / 255.0);
        }
    fputc('\n', w->file);
}

static void put_arrays(const vtk_writer *w) {
    const size_t points = w->lines->vertex_count, lines = w->lines->line_count;
    fprintf(w->file, "CELL_DATA %zu\nFIELD FieldData 1\np0 1 %zu float\n", lines + 2, lines + 2);
    put_real(w, -1, false);
    for (size_t i = 0; i < lines; i++) put_real(w, (double)trk_property(0, i), false);
    put_real(w, -1, false);
    fprintf(w->file, "\nPOINT_DATA %zu\nSCALARS s0 short\nLOOKUP_TABLE default\n", points);
    for (size_t i = points; i-- > 0;) put_whole(w, (int64_t)trk_scalar(0, i), 2);
    fprintf(w->file, "\nFIELD FieldData 2\ns%%31 1 %zu double\n", points);
    for (size_t i = points; i-- > 0;) put_real(w, (double)trk_scalar(1, i), true);
    fprintf(w->file, "\nMETADATA\nINFORMATION 0\n\nradius 1 %zu float\n", points);
    for (size_t i = points; i-- > 0;) put_real(w, (double)trk_scalar(0, i), false);
    fprintf(w->file, "\nVECTORS v float\n");
    put_triples(w, false);
    fprintf(w->file, "COLOR_SCALARS c 3\n");
    put_triples(w, true);
}

void write_vtk(const char *path, const iso_lines *lines, const vtk_layout *layout) {
    static const size_t vertex[] = {0, 1}, triangle[] = {0, 3};
    const vtk_writer w = {fopen(path, "wb"), lines, layout};
    const size_t last = lines->vertex_count - 1;
    assert_non_null(w.file);
    fprintf(w.file, "# vtk DataFile Version %d.0\nlines\n%s\nDATASET POLYDATA\n", layout->version,
            layout->binary ? "BINARY" : "ASCII");
    put_points(&w);
    if (layout->arrays) put_cells(&w, "VERTICES", 1, vertex, last);
    put_cells(&w, "LINES", lines->line_count, lines->starts, last);
    if (layout->arrays) put_cells(&w, "POLYGONS", 1, triangle, last);
    if (layout->arrays) put_arrays(&w);
    assert_int_equal(fclose(w.file), 0);
}

/* ---- reading */

iso_lines read_lines(const char *path, const iso_read_opts *opts) {
    iso_lines lines;
    iso_error error = {0};
    test_ok(iso_lines_read(path, opts, &lines, &error), &error);
    return lines;
}

void refuse_lines(const char *path, const iso_read_opts *opts, iso_status wanted, const char *reason) {
    iso_lines lines;
    iso_error error = {0};
    const iso_status status = iso_lines_read(path, opts, &lines, &error);
    if (status != wanted || !strstr(error.text, path) || !strstr(error.text, reason))
        fail_msg("%s: status %d, wanted %d with \"%s\": %s", path, status, wanted, reason, error.text);
}

void check_every_cut(const char *path, const char *cut, size_t tail) {
    size_t size;
    char *bytes = slurp(path, &size);
    for (size_t length = 0; length + tail < size; length++) {
        spill(cut, bytes, length);
        iso_lines lines;
        iso_error error = {0};
        const iso_status status = iso_lines_read(cut, NULL, &lines, &error);
        if (status != ISO_ERR_IO && status != ISO_ERR_FORMAT)
            fail_msg("%s: %zu of %zu bytes: status %d", path, length, size, status);
        assert_non_null(strstr(error.text, cut));
    }
    free(bytes);
}

iso_box own_box(const iso_lines *lines, iso_space space) {
    const iso_box box = iso_lines_bounds(lines);
    if (space != ISO_SPACE_RAS) return box;
    return (iso_box){{-box.hi.x, -box.hi.y, box.lo.z}, {-box.lo.x, -box.lo.y, box.hi.z}};
}

static bool is_outcome(const lines_outcome *wanted, const iso_lines *lines, const iso_read_report *report) {
    return (wanted->lines < 0 || lines->line_count == (size_t)wanted->lines) &&
           (wanted->vertices < 0 || lines->vertex_count == (size_t)wanted->vertices) &&
           (wanted->segments < 0 || iso_lines_segment_count(lines) == (size_t)wanted->segments) &&
           (int)report->dropped == wanted->dropped && (int)report->mended_radii == wanted->mended &&
           report->note_count == wanted->notes;
}

void check_lines_outcomes(const lines_outcome *outcomes, size_t count) {
    free(load_index("lines")); /* skips when there are none */
    for (size_t i = 0; i < count; i++) {
        const lines_outcome *wanted = &outcomes[i];
        const char *path = index_path("lines", wanted->name);
        if (wanted->status != ISO_OK) {
            refuse_lines(path, NULL, wanted->status, wanted->reason);
            continue;
        }
        iso_read_report report;
        iso_lines lines = read_lines(path, &(iso_read_opts){.report = &report});
        if (!is_outcome(wanted, &lines, &report))
            fail_msg("%s: %zu lines, %zu vertices, %zu segments, %d dropped, %d mended, %d notes",
                     wanted->name, lines.line_count, lines.vertex_count, iso_lines_segment_count(&lines),
                     (int)report.dropped, (int)report.mended_radii, report.note_count);
        iso_lines_free(&lines);
    }
}
