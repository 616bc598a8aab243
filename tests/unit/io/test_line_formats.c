/* line_formats: lines of legacy .vtk, .swc, .obj and .ply. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "file_support.h"
#include "index_support.h"
#include "lines_files.h"
#include "vtp_files.h"

#define FILE_VTK ISO_TEST_TMP "/test_line_formats.vtk"
#define FILE_VTP ISO_TEST_TMP "/test_line_formats.vtp"
#define FILE_SWC ISO_TEST_TMP "/test_line_formats.swc"
#define FILE_OBJ ISO_TEST_TMP "/test_line_formats.obj"
#define FILE_PLY ISO_TEST_TMP "/test_line_formats.ply"

static iso_lines read_text(const char *path, const char *text, iso_read_report *report) {
    spill(path, text, strlen(text));
    return read_lines(path, &(iso_read_opts){.report = report});
}

static void refuse_text(const char *path, const char *text, iso_status status, const char *reason) {
    spill(path, text, strlen(text));
    refuse_lines(path, NULL, status, reason);
}

static const iso_attribute *find_attribute(const iso_lines *lines, const char *name) {
    for (int i = 0; i < lines->attribute_count; i++)
        if (strcmp(lines->attributes[i].name, name) == 0) return &lines->attributes[i];
    fail_msg("no attribute %s", name);
    return NULL;
}

/* ---- .vtk */

static void check_vtk_arrays(const iso_lines *lines) {
    const float *s0 = find_attribute(lines, "s0")->values, *s1 = find_attribute(lines, "s1")->values,
                *v = find_attribute(lines, "v")->values;
    const iso_attribute *p0 = find_attribute(lines, "p0");
    assert_true(p0->per_line);
    assert_int_equal(lines->attribute_count, 4);
    assert_non_null(lines->radii);
    assert_non_null(lines->colors);
    assert_null(lines->normals);
    for (size_t i = 0; i < lines->line_count; i++) assert_true(p0->values[i] == trk_property(0, i));
    for (size_t i = 0; i < lines->vertex_count; i++) {
        assert_true(s0[i] == trk_scalar(0, i) && s1[i] == trk_scalar(1, i));
        assert_true(lines->radii[i] == trk_scalar(0, i));
        for (int k = 0; k < 3; k++) assert_true(v[3 * i + (size_t)k] == trk_scalar(k, i));
        assert_int_equal(lines->colors[i][0], (int)trk_scalar(0, i) % 256);
        assert_int_equal(lines->colors[i][1], 7);
        assert_int_equal(lines->colors[i][2], 255);
    }
}

static void test_vtk_round_trip(void **state) {
    (void)state;
    for (int i = 0; i < 40; i++) {
        const vtk_layout layout = {
            .version = 1 + i / 8, .binary = i & 1, .doubles = i & 2, .arrays = (i & 4) != 0};
        iso_lines wanted = random_lines(300, (uint32_t)i);
        write_vtk(FILE_VTK, &wanted, &layout);
        iso_read_report report;
        iso_lines got = read_lines(FILE_VTK, &(iso_read_opts){.report = &report});
        check_same_lines(&got, &wanted, 0);
        assert_string_equal(report.format, "vtk");
        assert_false(report.space_stated);
        assert_int_equal(report.items, 300);
        assert_int_equal(report.note_count, 0);
        if (layout.arrays) check_vtk_arrays(&got);
        iso_lines_free(&got);
        iso_lines_free(&wanted);
    }
}

/* Vectors turn with the space; every n-th line has its own numbers. */
static void test_vtk_as_ras(void **state) {
    (void)state;
    iso_lines wanted = random_lines(301, 5);
    write_vtk(FILE_VTK, &wanted, &(vtk_layout){.version = 4, .binary = true, .arrays = true});
    iso_lines got = read_lines(FILE_VTK, &(iso_read_opts){.space = ISO_SPACE_RAS, .every = 3});
    const float *v = find_attribute(&got, "v")->values, *p0 = find_attribute(&got, "p0")->values;
    assert_int_equal(got.line_count, 101);
    for (size_t i = 0; i < got.line_count; i++) {
        size_t from = wanted.starts[3 * i];
        assert_true(p0[i] == trk_property(0, 3 * i));
        for (size_t at = got.starts[i]; at < got.starts[i + 1]; at++, from++)
            for (size_t k = 0; k < 3; k++) {
                const float sign = k < 2 ? -1 : 1;
                assert_true(got.vertices[at][k] == sign * wanted.vertices[from][k]);
                assert_true(v[3 * at + k] == sign * trk_scalar((int)k, from));
            }
    }
    iso_lines_free(&got);
    iso_lines_free(&wanted);
}

#define VTK_HEAD "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\n"

static void test_vtk_text(void **state) {
    (void)state;
    iso_read_report report;
    iso_lines lines = read_text(FILE_VTK,
                                "# vtk DataFile Version 3.0\r\n3D Slicer output. SPACE=RAS\r\nASCII\r\n"
                                "DATASET POLYDATA\r\nPOINTS 3 float\r\n1 2 3 4 5 6\r\n7 8 nan\r\n"
                                "lines 2 6\r\n3 0 2 1\r\n1 1",
                                &report);
    assert_true(report.space_stated);
    assert_int_equal(report.space, ISO_SPACE_RAS);
    assert_int_equal(report.dropped, 1);
    assert_int_equal(lines.line_count, 3); /* the first one without its middle, twice one vertex */
    assert_true(lines.vertices[0][0] == -1 && lines.vertices[1][1] == -5 && lines.vertices[2][2] == 6);
    iso_lines_free(&lines);
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 2 float\n1 2 3 4 5 six\nLINES 1 3\n2 0 1\n", ISO_ERR_FORMAT,
                "'six' is not a number");
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 1 float\n1 2 3\nLINES 1 3\n2 0 1\n", ISO_ERR_FORMAT,
                "point 1 of 1");
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 1 float\n1 2 3\nLINES 1 2\n1 -1\n", ISO_ERR_FORMAT, "cannot be");
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 1 float\n1 2 3\nLINES 1 2\n2 0\n", ISO_ERR_FORMAT, "longer");
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 1 float\n1 2 3\nLINES 1 3\n1 0 0\n", ISO_ERR_FORMAT, "shorter");
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 99999999999999999999 float\n", ISO_ERR_FORMAT, "count");
    refuse_text(FILE_VTK, VTK_HEAD "POINTS 9999999999 float\n1 2 3", ISO_ERR_IO, "truncated");
    refuse_text(FILE_VTK, VTK_HEAD "LINES 1 9999999999\n2 0 1", ISO_ERR_IO, "truncated");
    refuse_text(FILE_VTK, "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n", ISO_ERR_FORMAT,
                "STRUCTURED_POINTS");
}

/* Cut off anywhere but in the last number, or behind the arrays, the file is refused. */
static void test_vtk_cut_off(void **state) {
    (void)state;
    iso_lines lines = random_lines(3, 3);
    for (int i = 0; i < 4; i++) {
        const vtk_layout layout = {.version = i & 2 ? 5 : 3, .binary = i & 1};
        write_vtk(FILE_VTK, &lines, &layout);
        size_t size;
        char *text = slurp(FILE_VTK, &size), *at = memmem(text, size, "\nLINES", 6);
        assert_non_null(at);
        const size_t before_lines = (size_t)(at - text), tail = layout.binary ? 1 : 3;
        free(text);
        for (size_t length = 0; length + tail < size; length++) {
            text = slurp(FILE_VTK, &size);
            spill(ISO_TEST_TMP "/test_line_formats_cut.vtk", text, length);
            free(text);
            iso_lines got;
            iso_error error = {0};
            const iso_status status =
                iso_lines_read(ISO_TEST_TMP "/test_line_formats_cut.vtk", NULL, &got, &error);
            if (status == ISO_OK) {
                /* without the lines, there is still a set of points */
                assert_true(length >= before_lines - (layout.binary ? 1 : 24) && length <= before_lines + 1);
                assert_int_equal(got.line_count, 0);
                iso_lines_free(&got);
            } else
                assert_true(status == ISO_ERR_IO || status == ISO_ERR_FORMAT);
        }
    }
    iso_lines_free(&lines);
}

/* ---- .vtp */

static void check_vtp_arrays(const iso_lines *lines) {
    const float *s0 = find_attribute(lines, "s0")->values, *v = find_attribute(lines, "v")->values,
                *p0 = find_attribute(lines, "p0")->values;
    assert_int_equal(lines->attribute_count, 3);
    for (size_t i = 0; i < lines->line_count; i++) assert_true(p0[i] == trk_property(0, i));
    for (size_t i = 0; i < lines->vertex_count; i++) {
        assert_true(s0[i] == trk_scalar(0, i) && lines->radii[i] == trk_scalar(0, i));
        for (size_t k = 0; k < 3; k++) assert_true(v[3 * i + k] == trk_scalar((int)k, i));
        assert_int_equal(lines->colors[i][0], (int)trk_scalar(0, i) % 256);
    }
}

static void test_vtp_round_trip(void **state) {
    (void)state;
    for (int i = 0; i < 5 * 16; i++) {
        vtp_layout layout = {
            .format = i / 32, .raw = i >= 64, .compressed = i & 1, .big = i & 2, .wide = i & 4};
        layout.doubles = i & 8;
        layout.pieces = 1 + i % 3;
        if (i / 16 == 3)
            layout = (vtp_layout){.format = VTP_APPENDED, .compressed = i & 1, .wide = i & 4, .pieces = 2};
        iso_lines wanted = random_lines(50, (uint32_t)i);
        write_vtp(FILE_VTP, &wanted, &layout);
        iso_read_report report;
        iso_lines got = read_lines(FILE_VTP, &(iso_read_opts){.report = &report});
        check_same_lines(&got, &wanted, 0);
        assert_string_equal(report.format, "vtp");
        check_vtp_arrays(&got);
        iso_lines_free(&got);
        iso_lines_free(&wanted);
    }
}

static void test_vtp_cut_off(void **state) {
    (void)state;
    iso_lines lines = random_lines(2, 3);
    for (int i = 0; i < 5; i++) {
        const vtp_layout layout = {
            .format = (i + 1) / 2, .raw = i == 4, .compressed = i == 2 || i == 4, .pieces = 1};
        write_vtp(FILE_VTP, &lines, &layout);
        size_t size;
        char *text = slurp(FILE_VTP, &size);
        char *end = memmem(text, size, layout.format == VTP_APPENDED ? "\n</AppendedData" : "</PolyData", 10);
        const size_t tail = (size_t)(text + size - end);
        free(text);
        check_every_cut(FILE_VTP, ISO_TEST_TMP "/test_line_formats_cut.vtp", tail);
    }
    iso_lines_free(&lines);
}

#define VTP_HEAD "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"%s\" NumberOfLines=\"%s\">"
#define VTP_POINTS                                                                                           \
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">1 2 3 4 5 6</DataArray></Points>"
#define VTP_LINES                                                                                            \
    "<Lines><DataArray type=\"Int32\" Name=\"connectivity\">%s</DataArray>"                                  \
    "<DataArray type=\"Int32\" Name=\"offsets\">%s</DataArray></Lines></Piece></PolyData></VTKFile>"

static void test_vtp_errors(void **state) {
    (void)state;
    static const struct {
        const char *points, *lines, *connectivity, *offsets;
        iso_status status;
        const char *reason;
    } cases[] = {
        {"2", "1", "0 2", "2", ISO_ERR_FORMAT, "not there"},
        {"2", "1", "0 -1", "2", ISO_ERR_FORMAT, "not there"},
        {"2", "1", "0", "2", ISO_ERR_FORMAT, "fewer numbers"},
        {"2", "2", "0 1", "2 1", ISO_ERR_FORMAT, "do not rise"},
        {"2", "2", "0 1", "2", ISO_ERR_FORMAT, "fewer numbers"},
        {"3", "1", "0 1", "2", ISO_ERR_FORMAT, "fewer numbers"},
        {"2", "1", "0 1", "1e14", ISO_ERR_IO, "truncated"},
        {"999999999999", "1", "0 1", "2", ISO_ERR_LIMIT, "too many points"},
        {"999999999", "1", "0 1", "2", ISO_ERR_IO, "truncated"},
        {"-1", "1", "0 1", "2", ISO_ERR_FORMAT, "count"},
        {"1e9", "1", "0 1", "2", ISO_ERR_FORMAT, "count"},
    };
    char text[1024];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text, VTP_HEAD VTP_POINTS VTP_LINES, cases[i].points, cases[i].lines,
                 cases[i].connectivity, cases[i].offsets);
        refuse_text(FILE_VTP, text, cases[i].status, cases[i].reason);
    }
    snprintf(text, sizeof text, VTP_HEAD VTP_POINTS VTP_LINES, "2", "1", "0 1", "2");
    iso_lines lines = read_text(FILE_VTP, text, NULL);
    assert_int_equal(lines.vertex_count, 2);
    iso_lines_free(&lines);
    refuse_text(FILE_VTP, "<VTKFile type=\"ImageData\">", ISO_ERR_FORMAT, "ImageData");
    refuse_text(FILE_VTP, "<VTKFile type=\"PolyData\" compressor=\"vtkOwnDataCompressor\">",
                ISO_ERR_UNSUPPORTED, "vtkOwnDataCompressor");
    refuse_text(FILE_VTP, "<?xml version=\"1.0\"?><html>", ISO_ERR_FORMAT, "VTKFile");
    refuse_text(FILE_VTP, "<VTKFile type=\"PolyData\"><PolyData>", ISO_ERR_IO, "truncated");
}

/* ---- graphs: .swc and .ply */

enum { NODES = 400 };

/* The numbers of the nodes are their x coordinates: checks that every edge is a segment once, and that lines
 * end only at nodes that have not two edges. */
static void check_graph(const iso_lines *lines, const int (*edges)[2], int count, bool directed) {
    int degrees[NODES] = {0}, *left = calloc((size_t)NODES * NODES, sizeof *left);
    for (int i = 0; i < count; i++) {
        const int a = edges[i][0], b = edges[i][1];
        left[a * NODES + b]++;
        degrees[a]++;
        degrees[b]++;
    }
    assert_int_equal(iso_lines_segment_count(lines), count);
    for (size_t i = 0; i < lines->line_count; i++) {
        const size_t first = lines->starts[i], last = lines->starts[i + 1] - 1;
        const int from = (int)lines->vertices[first][0], to = (int)lines->vertices[last][0];
        bool turned = false;
        for (size_t at = first; at < last; at++) {
            const int a = (int)lines->vertices[at][0], b = (int)lines->vertices[at + 1][0];
            int *edge = left[a * NODES + b] > 0 ? &left[a * NODES + b] : &left[b * NODES + a];
            assert_true(--*edge >= 0);
            /* towards the root, then away from it */
            const bool away = edge == &left[a * NODES + b];
            assert_true(!directed || away || !turned);
            turned = turned || away;
            if (at > first) assert_int_equal(degrees[a], 2);
        }
        if (first < last && from != to) assert_true(degrees[from] != 2 && degrees[to] != 2);
    }
    free(left);
}

static void test_swc_trees(void **state) {
    (void)state;
    uint32_t seed = 9;
    for (int round = 0; round < 50; round++) {
        int edges[NODES][2], count = 0, order[NODES];
        FILE *file = fopen(FILE_SWC, "w");
        assert_non_null(file);
        fprintf(file, "# a tree\n\n");
        for (int i = 0; i < NODES; i++) order[i] = i;
        for (int i = NODES - 1; i > 0; i--) {
            const int k = (int)(random_bits(&seed) % (uint32_t)(i + 1)), kept = order[i];
            order[i] = order[k];
            order[k] = kept;
        }
        int parents[NODES];
        for (int i = 0; i < NODES; i++) {
            const int span = 1 + (int)(random_bits(&seed) % 5);
            parents[i] = i < span ? -1 : random_bits(&seed) % 50 == 0 ? -1 : i - span;
            if (parents[i] < 0) continue;
            edges[count][0] = parents[i];
            edges[count++][1] = i;
        }
        for (int k = 0; k < NODES; k++) {
            const int i = order[k], parent = parents[i];
            fprintf(file, "%d 3 %d 0 0 %d %d\n", 7 * i + 1, i, i % 10, parent < 0 ? -1 : 7 * parent + 1);
        }
        fclose(file);
        iso_lines lines = read_lines(FILE_SWC, NULL);
        check_graph(&lines, (const int(*)[2])edges, count, true);
        for (size_t i = 0; i < lines.vertex_count; i++)
            assert_true(lines.radii[i] == (float)((int)lines.vertices[i][0] % 10));
        assert_string_equal(lines.attributes[0].name, "type");
        iso_lines_free(&lines);
    }
}

static void test_ply_edges(void **state) {
    (void)state;
    uint32_t seed = 5;
    for (int round = 0; round < 50; round++) {
        int edges[NODES][2];
        const int count = (int)(random_bits(&seed) % NODES);
        FILE *file = fopen(FILE_PLY, "w");
        assert_non_null(file);
        fprintf(file,
                "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty double y\nproperty "
                "uchar z\n"
                "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float Radius\n"
                "property float quality\nelement face 1\nproperty list uchar int vertex_indices\n"
                "element edge %d\nproperty int vertex1\nproperty int vertex2\nend_header\n",
                NODES, count);
        for (int i = 0; i < NODES; i++) fprintf(file, "%d 0 0 1 2 3 %d %d\n", i, i % 7, -i);
        fprintf(file, "3 0 1 2\n");
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < 2; k++) edges[i][k] = (int)(random_bits(&seed) % NODES);
            fprintf(file, "%d %d\n", edges[i][0], edges[i][1]);
        }
        fclose(file);
        iso_lines lines = read_lines(FILE_PLY, NULL);
        check_graph(&lines, (const int(*)[2])edges, count, false);
        const float *quality = find_attribute(&lines, "quality")->values;
        for (size_t i = 0; i < lines.vertex_count; i++) {
            assert_true(lines.radii[i] == (float)((int)lines.vertices[i][0] % 7));
            assert_true(quality[i] == -lines.vertices[i][0]);
            assert_int_equal(lines.colors[i][2], 3);
        }
        iso_lines_free(&lines);
    }
    refuse_text(
        FILE_PLY,
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n0 1\n",
        ISO_ERR_FORMAT, "point 1 of 1");
}

static void test_swc_errors(void **state) {
    (void)state;
    iso_read_report report;
    refuse_text(FILE_SWC, "1 1 0 0 0 1 -1\n2 1 0 0 0 1\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_SWC, "1.5 1 0 0 0 1 -1\n", ISO_ERR_FORMAT, "number of a node");
    refuse_text(FILE_SWC, "1 1 0 0 0 1 1e300\n", ISO_ERR_FORMAT, "parent of a node");
    refuse_text(FILE_SWC, "1 1 0 0 0 1 2\n2 1 0 0 0 1 1\n", ISO_ERR_FORMAT, "ancestor");
    refuse_text(FILE_SWC, "1 1 0 0 0 1 -1\n1 1 0 0 0 1 -1\n", ISO_ERR_FORMAT, "two nodes");
    iso_lines lines =
        read_text(FILE_SWC, "1 1 1e7 0 0 -2 -1\n2 1 10000000.5 nan 0 1 1\n3 1 0 0 0 nan 9\n", &report);
    assert_int_equal(lines.line_count, 2); /* both without segments */
    assert_int_equal(report.dropped, 1);
    assert_int_equal(report.mended_radii, 2);
    assert_int_equal(report.note_count, 1);
    assert_true(lines.origin.x == 1e7);
    assert_true(lines.radii[0] == 0 && lines.radii[1] == 0);
    iso_lines_free(&lines);
}

/* ---- .obj */

static void test_obj(void **state) {
    (void)state;
    iso_lines lines =
        read_text(FILE_OBJ,
                  "# lines\nv 0 1 2 1 0.5 0\nv 3 4 5 0 0 0\nvt 0 0\nv 6 7 8 0 0 1\nf 1 2 3\nl 1 2/1 3\n"
                  "v 9 9 9 1 1 1\nl -1 -4\r\nl 1\nlx\n",
                  NULL);
    assert_int_equal(lines.line_count, 3);
    assert_int_equal(lines.vertex_count, 6);
    assert_true(lines.vertices[2][0] == 6 && lines.vertices[3][0] == 9 && lines.vertices[4][0] == 0);
    assert_int_equal(lines.colors[0][0], 255);
    assert_int_equal(lines.colors[0][1], 128);
    assert_int_equal(lines.colors[2][2], 255);
    iso_lines_free(&lines);
    lines = read_text(FILE_OBJ, "v 0 0 0\nl \n", NULL);
    assert_int_equal(lines.line_count, 0);
    iso_lines_free(&lines);
    refuse_text(FILE_OBJ, "v 0 0 0\nl 1 2\n", ISO_ERR_FORMAT, "point 1 of 1");
    refuse_text(FILE_OBJ, "v 0 0 0\nl 0 1\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_OBJ, "v 0 0 0\nl -2\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_OBJ, "v 0 zero 0\n", ISO_ERR_FORMAT, "row 1");
}

/* ---- files of other programs */

static void check_row(const index_row *row) {
    iso_read_report report;
    iso_lines lines = read_lines(row->path, &(iso_read_opts){.report = &report});
    const iso_box box = own_box(&lines, report.space);
    const long wanted = number_before(row->counts, " lines"),
               segments = number_before(row->counts, " segments"),
               points = number_before(row->counts, " points");
    if (wanted >= 0 && (long)lines.line_count != wanted)
        fail_msg("%s: %zu lines", row->name, lines.line_count);
    /* lines may share points, or skip them; those of this set share many */
    if (wanted > 0 && points >= 0 && (long)lines.vertex_count != points && !strstr(row->name, "Coastlines"))
        fail_msg("%s: %zu vertices", row->name, lines.vertex_count);
    if (segments >= 0 && (long)iso_lines_segment_count(&lines) != segments)
        fail_msg("%s: %zu segments", row->name, iso_lines_segment_count(&lines));
    if (row->has_box && lines.line_count) check_box(row->name, &box, &row->box);
    iso_lines_free(&lines);
}

static void test_index(void **state) {
    (void)state;
    static const char *const formats[] = {"vtk legacy", "vtp", "swc", "ply", "obj", NULL};
    assert_true(check_index("lines", formats, check_row) >= 24);
}

/* The same tracks in three files. */
static void test_same_tracks(void **state) {
    (void)state;
    free(load_index("lines")); /* skips when there are none */
    const iso_read_opts ras = {.space = ISO_SPACE_RAS};
    iso_lines tck = read_lines(index_path("lines", "mrtrix/tracks.tck"), NULL),
              text = read_lines(index_path("lines", "mrtrix/tracks_ascii.vtk"), &ras),
              binary = read_lines(index_path("lines", "mrtrix/tracks_binary.vtk"), &ras);
    check_same_lines(&binary, &tck, 0);
    check_same_lines(&text, &tck, 1e-4);
    iso_lines legacy = read_lines(index_path("lines", "fibres/tractography.vtk"), NULL),
              xml = read_lines(index_path("lines", "fibres/tractography.vtp"), NULL);
    check_same_lines(&xml, &legacy, 0);
    assert_int_equal(xml.attribute_count, legacy.attribute_count);
    for (int i = 0; i < xml.attribute_count; i++) {
        const iso_attribute *a = &xml.attributes[i], *b = find_attribute(&legacy, a->name);
        assert_int_equal(a->components, b->components);
        assert_memory_equal(a->values, b->values, xml.vertex_count * (size_t)a->components * sizeof(float));
    }
    iso_lines_free(&legacy);
    iso_lines_free(&xml);
    iso_lines_free(&tck);
    iso_lines_free(&text);
    iso_lines_free(&binary);
}

/* What becomes of files that are damaged or odd. Files that are not named have nothing odd for a reader. */
static const lines_outcome odd[] = {
    {"bad/vtk/cell_negative.vtk", ISO_ERR_FORMAT, "cannot be", 0, 0, 0, 0, 0, 0},
    {"bad/vtk/cell_out_of_range.vtk", ISO_ERR_FORMAT, "a line names point", 0, 0, 0, 0, 0, 0},
    {"bad/vtk/empty.vtk", ISO_ERR_FORMAT, "neither ASCII nor BINARY", 0, 0, 0, 0, 0, 0},
    {"bad/vtk/good_v3.vtk", ISO_OK, NULL, 3, -1, 15, 0, 0, 0},
    {"bad/vtk/good_v5_1_int64.vtk", ISO_OK, NULL, 3, -1, 15, 0, 0, 0},
    {"bad/vtk/no_lines.vtk", ISO_OK, NULL, 0, -1, 0, 0, 0, 0},
    {"bad/vtk/offsets_decrease.vtk", ISO_ERR_FORMAT, "offsets", 0, 0, 0, 0, 0, 0},
    {"bad/vtk/one_vertex_line.vtk", ISO_OK, NULL, 4, -1, 15, 0, 0, 0},
    {"bad/vtk/points_lie.vtk", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/vtk/polygons_v5_1.vtk", ISO_OK, NULL, 0, -1, 0, 0, 0, 0},
    {"bad/vtk/size_lies.vtk", ISO_ERR_FORMAT, "longer", 0, 0, 0, 0, 0, 0},
    {"bad/vtk/truncated.vtk", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/swc/Neuron_missing_ids.swc", ISO_OK, NULL, -1, -1, 5, 0, 0, 1},
    {"bad/swc/Neuron_missing_parents.swc", ISO_OK, NULL, -1, -1, 838, 0, 0, 1},
    {"bad/swc/Neuron_disconnected_components.swc", ISO_OK, NULL, -1, -1, 838, 0, 0, 0},
    {"bad/swc/comments_only.swc", ISO_OK, NULL, 0, -1, 0, 0, 0, 0},
    {"bad/swc/cycle.swc", ISO_ERR_FORMAT, "ancestor", 0, 0, 0, 0, 0, 0},
    {"bad/swc/self_parent.swc", ISO_ERR_FORMAT, "ancestor", 0, 0, 0, 0, 0, 0},
    {"bad/swc/repeated_id.swc", ISO_ERR_FORMAT, "two nodes", 0, 0, 0, 0, 0, 0},
    {"bad/swc/six_columns.swc", ISO_ERR_FORMAT, "row 1", 0, 0, 0, 0, 0, 0},
    {"bad/swc/eight_columns.swc", ISO_OK, NULL, 1, -1, 1, 0, 0, 0},
    {"bad/swc/nan_coordinate.swc", ISO_OK, NULL, 2, -1, 0, 1, 0, 0},
    {"bad/swc/negative_radius.swc", ISO_OK, NULL, 1, -1, 2, 0, 1, 0},
    {"bad/swc/point_soma.swc", ISO_OK, NULL, 1, -1, 0, 0, 0, 0},
    {"bad/swc/sample.swc", ISO_OK, NULL, -1, -1, 52, 0, 0, 0},
    {"bad/swc/sample_disordered.swc", ISO_OK, NULL, -1, -1, 52, 0, 0, 0},
    {"bad/swc/sample_mixed_tree_sections.swc", ISO_OK, NULL, -1, -1, 52, 0, 0, 0},
    {"bad/swc/non_increasing_trunk_off_1_16pt.swc", ISO_OK, NULL, 1, -1, 15, 0, 0, 0},
};

static void test_odd_files(void **state) {
    (void)state;
    check_lines_outcomes(odd, sizeof odd / sizeof *odd);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vtk_round_trip),
        cmocka_unit_test(test_vtk_as_ras),
        cmocka_unit_test(test_vtk_text),
        cmocka_unit_test(test_vtk_cut_off),
        cmocka_unit_test(test_vtp_round_trip),
        cmocka_unit_test(test_vtp_cut_off),
        cmocka_unit_test(test_vtp_errors),
        cmocka_unit_test(test_swc_trees),
        cmocka_unit_test(test_ply_edges),
        cmocka_unit_test(test_swc_errors),
        cmocka_unit_test(test_obj),
        cmocka_unit_test(test_index),
        cmocka_unit_test(test_same_tracks),
        cmocka_unit_test(test_odd_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
