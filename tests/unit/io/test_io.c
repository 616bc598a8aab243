/* io: points in PLY both ways, hostile PLY, meshes in three formats. */
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "check_support.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/volume/volume.h"
#include "io/mesh/mesh_read.h"
#include "io/mesh/mesh_write.h"
#include "io/points_write.h"
#include "points_support.h"

#define FILE_PLY ISO_TEST_TMP "/test_io.ply"

/* ---- bytes and files */

typedef struct bytes {
    unsigned char data[1 << 16];
    size_t size;
} bytes;

static void put(bytes *out, const void *data, size_t size) {
    assert_true(out->size + size <= sizeof out->data);
    memcpy(out->data + out->size, data, size);
    out->size += size;
}

static void put_text(bytes *out, const char *text) {
    put(out, text, strlen(text));
}

static void put_number(bytes *out, const void *number, size_t size, bool big) {
    const unsigned char *from = number; /* the tests run on little-endian machines */
    for (size_t i = 0; i < size; i++) put(out, from + (big ? size - 1 - i : i), 1);
}

static void put_float(bytes *out, float value, bool big) {
    put_number(out, &value, sizeof value, big);
}

static void save(const char *path, const void *data, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
}

static bytes *load(const char *path) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    bytes *in = malloc(sizeof *in);
    in->size = fread(in->data, 1, sizeof in->data, file);
    fclose(file);
    return in;
}

static iso_status read_text(const char *text, test_points *points, iso_error *error) {
    save(FILE_PLY, text, strlen(text));
    *error = (iso_error){0};
    return test_points_read(FILE_PLY, 0, points, error);
}

/* ---- points */

enum { COUNT = 200 };

typedef struct point_cloud {
    iso_surfel surfels[COUNT];
    float radii[COUNT];
    iso_point packed[COUNT];
} point_cloud;

static void fill_cloud(point_cloud *cloud, uint32_t seed) {
    for (int i = 0; i < COUNT; i++) {
        iso_vec3 n =
            iso_vec3_unit(iso_vec3_make(uniform(&seed) - 0.5, uniform(&seed) - 0.5, uniform(&seed) - 0.5));
        cloud->surfels[i] =
            (iso_surfel){{(float)(20 * uniform(&seed) - 2), (float)(20 * uniform(&seed) - 2), 3.25f},
                         {(float)n.x, (float)n.y, (float)n.z}};
        cloud->radii[i] = (float)(0.1 + uniform(&seed));
        cloud->packed[i] = iso_point_pack(&cloud->surfels[i]);
    }
}

static iso_transform left_handed(void) {
    iso_transform transform = iso_transform_identity();
    const double c = 0.8, s = 0.6; /* a rotation about z, x mirrored, unequal spacing */
    const double direction[9] = {-c, -s, 0, -s, c, 0, 0, 0, 1}, spacing[3] = {0.5, 1.25, 2};
    for (int i = 0; i < 9; i++) transform.direction[i] = direction[i];
    for (int i = 0; i < 3; i++) {
        transform.spacing[i] = spacing[i];
        transform.origin[i] = 10 * i - 7.5;
    }
    return transform;
}

static void same_points(const test_points *points, const iso_surfel *surfels, const float *radii,
                        size_t count) {
    assert_int_equal(points->span.count, count);
    assert_memory_equal(points->surfels, surfels, count * sizeof *surfels);
    assert_memory_equal(points->radii, radii, count * sizeof *radii);
}

static void points_come_back_bit_for_bit(void **state) {
    (void)state;
    point_cloud cloud;
    fill_cloud(&cloud, 5);
    const iso_point_span span = {.count = COUNT};
    const iso_point_view view = {.surfels = cloud.surfels,
                                 .radii = cloud.radii,
                                 .spans = &span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity()};
    iso_error error = {0};
    test_points points;
    test_ok(iso_points_write_ply(FILE_PLY, &view, "one\nline", &error), &error);
    test_ok(test_points_read(FILE_PLY, 0, &points, &error), &error);
    same_points(&points, cloud.surfels, cloud.radii, COUNT);
    bytes *in = load(FILE_PLY);
    assert_non_null(memmem(in->data, in->size, "comment one\\nline\nelement", 25));
    free(in);
    /* a second trip through the reader's own view changes nothing */
    const iso_point_view again = test_points_view(&points);
    test_points second;
    test_ok(iso_points_write_ply(FILE_PLY, &again, NULL, &error), &error);
    test_ok(test_points_read(FILE_PLY, 0, &second, &error), &error);
    same_points(&second, cloud.surfels, cloud.radii, COUNT);
    test_points_free(&points);
    test_points_free(&second);
}

/* Two spans, packed and not, a left-handed transform: each number is the transformed one, rounded once. */
static void points_are_written_in_world_millimetres(void **state) {
    (void)state;
    point_cloud cloud;
    fill_cloud(&cloud, 7);
    const iso_point_span spans[2] = {{.brick = {0, 3, -1}, .count = 50, .first = 0},
                                     {.brick = {2, 0, 5}, .count = COUNT - 60, .first = 60}};
    const iso_transform transform = left_handed();
    const iso_affine affine = iso_transform_affine(&transform);
    for (int packed = 0; packed < 2; packed++) {
        iso_point_view view = {.spans = spans, .span_count = 2, .transform = transform, .radius = 0.75};
        if (packed)
            view.packed = cloud.packed;
        else
            view.surfels = cloud.surfels;
        iso_error error = {0};
        test_points points;
        test_ok(iso_points_write_ply(FILE_PLY, &view, NULL, &error), &error);
        test_ok(test_points_read(FILE_PLY, 0, &points, &error), &error);
        assert_int_equal(points.span.count, COUNT - 10);
        size_t next = 0;
        for (int s = 0; s < 2; s++)
            for (size_t i = 0; i < spans[s].count; i++, next++) {
                iso_surfel from = iso_point_view_get(&view, spans[s].first + i), *to = &points.surfels[next];
                double index[3];
                for (int axis = 0; axis < 3; axis++)
                    index[axis] = 16.0 * spans[s].brick[axis] + from.position[axis];
                iso_vec3 p = iso_affine_point(&affine, iso_vec3_make(index[0], index[1], index[2]));
                iso_vec3 n =
                    iso_affine_normal(&affine, iso_vec3_make(from.normal[0], from.normal[1], from.normal[2]));
                const iso_surfel wanted = {{(float)p.x, (float)p.y, (float)p.z},
                                           {(float)n.x, (float)n.y, (float)n.z}};
                assert_memory_equal(to, &wanted, sizeof wanted);
                assert_true(points.radii[next] == 0.75f);
            }
        test_points_free(&points);
    }
}

/* ---- other people's PLY */

/* The same three points, told in many ways. The properties are out of order and mixed with others. */
static const float three[3][7] = {
    {1, 2, 3, 0, 0, 1, 0.5f}, {-4.5f, 0, 1e-3f, 0, -1, 0, 2}, {7, 8, 9, 1, 0, 0, 1}};

static void put_mixed_vertex(bytes *out, const float p[7], bool big) {
    const double x = p[0];
    const uint8_t flag = 200, count = 2;
    const int16_t short_nz = (int16_t)p[5];
    const int32_t items[2] = {-1, 1 << 30};
    put_number(out, &flag, 1, big);
    put_number(out, &x, 8, big);
    put_float(out, p[1], big);
    put_number(out, &count, 1, big);
    put_number(out, items, 4, big);
    put_number(out, items + 1, 4, big);
    put_float(out, p[2], big);
    put_float(out, p[6], big);
    put_float(out, p[3], big);
    put_float(out, p[4], big);
    put_number(out, &short_nz, 2, big);
}

static void put_mixed_header(bytes *out, const char *format, const char *newline) {
    const char *lines[] = {"ply",
                           format,
                           "comment a comment  with words",
                           "obj_info what Cyberware wrote",
                           "element camera 2",
                           "property uint16 number",
                           "property list uchar double matrix",
                           "element nothing 18446744073709551615",
                           "element vertex 3",
                           "property uchar flag",
                           "property double x",
                           "property float y",
                           "property list uint8 int ids",
                           "property float32 z",
                           "property float radius",
                           "property float nx",
                           "property float ny",
                           "property int16 nz",
                           "element face 1000",
                           "property list uchar int vertex_indices",
                           "end_header"};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        put_text(out, lines[i]);
        put_text(out, newline);
    }
}

static void put_mixed(bytes *out, bool big, const char *newline) {
    out->size = 0;
    put_mixed_header(out, big ? "format binary_big_endian 1.0" : "format binary_little_endian 1.0", newline);
    for (uint16_t camera = 0; camera < 2; camera++) {
        const uint8_t count = (uint8_t)(camera * 3);
        const double item = 1.5;
        put_number(out, &camera, 2, big);
        put_number(out, &count, 1, big);
        for (int i = 0; i < count; i++) put_number(out, &item, 8, big);
    }
    for (int i = 0; i < 3; i++) put_mixed_vertex(out, three[i], big);
}

static void put_mixed_ascii(bytes *out, const char *newline) {
    out->size = 0;
    put_mixed_header(out, "format ascii 1.0", newline);
    put_text(out, "0 0");
    put_text(out, newline);
    put_text(out, "1 3 1.5 -1e3 nan");
    for (int i = 0; i < 3; i++) {
        const float *p = three[i];
        char line[200];
        snprintf(line, sizeof line, "%s200 %.9g\t%.9g 2 -1 1073741824 %.9g %.9g %.9g %.9g %.9g", newline,
                 (double)p[0], (double)p[1], (double)p[2], (double)p[6], (double)p[3], (double)p[4],
                 (double)p[5]);
        put_text(out, line);
    }
}

static void check_three(const bytes *file) {
    save(FILE_PLY, file->data, file->size);
    iso_error error = {0};
    test_points points;
    test_ok(test_points_read(FILE_PLY, 0, &points, &error), &error);
    assert_int_equal(points.span.count, 3);
    for (int i = 0; i < 3; i++) {
        assert_memory_equal(points.surfels[i].position, three[i], 12);
        assert_memory_equal(points.surfels[i].normal, three[i] + 3, 12);
        assert_memory_equal(&points.radii[i], three[i] + 6, 4);
    }
    test_points_free(&points);
}

static void other_dialects_are_read(void **state) {
    (void)state;
    bytes *file = malloc(sizeof *file);
    for (int crlf = 0; crlf < 2; crlf++) {
        const char *newline = crlf ? "\r\n" : "\n";
        put_mixed(file, false, newline);
        check_three(file);
        put_mixed(file, true, newline);
        check_three(file);
        put_mixed_ascii(file, newline);
        check_three(file);
        put_text(file, newline);
        check_three(file);
    }
    free(file);
}

/* A FIFO is refused at once, whether it has a writer or not. */
static void only_regular_files_are_read(void **state) {
    (void)state;
    static const char *const paths[] = {ISO_TEST_TMP "/fifo.ply", ISO_TEST_TMP "/fifo.stl",
                                        ISO_TEST_TMP "/fifo.obj"};
    for (int i = 0; i < 3; i++) {
        iso_error error = {0};
        test_points points;
        iso_triangles mesh;
        unlink(paths[i]);
        assert_int_equal(mkfifo(paths[i], 0600), 0);
        if (i == 0) assert_int_equal(test_points_read(paths[i], 0, &points, &error), ISO_ERR_IO);
        assert_int_equal(iso_mesh_read(paths[i], NULL, &mesh, &error), ISO_ERR_IO);
        assert_non_null(strstr(error.text, ": not a regular file"));
        assert_int_equal(unlink(paths[i]), 0);
    }
}

/* A comma as the decimal point, set by a host program, must not matter. */
static void the_locale_does_not_matter(void **state) {
    (void)state;
    static const char volume[] = "NDims = 3\nDimSize = 2 2 2\nElementSpacing = 0.5 0.25 1.75\n"
                                 "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n12345678";
    if (system("localedef -i de_DE -f UTF-8 " ISO_TEST_TMP "/de_DE.UTF-8 2>/dev/null") != 0) {
        print_message("skipped: no locale with a decimal comma can be made (package locales)\n");
        skip();
    }
    bytes *file = malloc(sizeof *file);
    put_mixed_ascii(file, "\n");
    FILE *header = fopen(ISO_TEST_TMP "/locale.mha", "wb");
    assert_int_equal(fwrite(volume, 1, sizeof volume - 1, header), sizeof volume - 1);
    fclose(header);
    assert_int_equal(setenv("LOCPATH", ISO_TEST_TMP, 1), 0);
    assert_non_null(setlocale(LC_NUMERIC, "de_DE.UTF-8"));
    assert_string_equal(localeconv()->decimal_point, ",");
    check_three(file);
    iso_volume_info info;
    assert_int_equal(iso_volume_read_info(ISO_TEST_TMP "/locale.mha", NULL, &info, NULL), ISO_OK);
    assert_true(info.transform.spacing[0] == 0.5 && info.transform.spacing[2] == 1.75);
    setlocale(LC_NUMERIC, "C");
    unsetenv("LOCPATH");
    assert_int_equal(system("rm -r " ISO_TEST_TMP "/locale.mha " ISO_TEST_TMP "/de_DE.UTF-8"), 0);
    free(file);
}

#define HEAD "ply\nformat ascii 1.0\nelement vertex 4\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define NORMAL "property float nx\nproperty float ny\nproperty float nz\n"
#define RADIUS "property float radius\n"
#define END "end_header\n"

/* Positions that cannot be are left out; radii that cannot be are 0, and so are normals. */
static void unusable_points_are_dropped(void **state) {
    (void)state;
    iso_error error;
    test_points points;
    test_ok(read_text("ply\nformat ascii 1.0\nelement vertex 8\n" XYZ NORMAL RADIUS END "1 2 3 0 0 0 1\n"
                      "nan 2 3 0 0 1 1\n"
                      "1 2 inf 0 0 1 1\n"
                      "1 2 3 0 0 1 -1\n"
                      "1 2 3 nan 0 1 1\n"
                      "1e300 2 3 0 0 1 1\n"
                      "1 2 3 0 0 1 nan\n"
                      "4 5 6 1e30 0 0 2\n",
                      &points, &error),
            &error);
    static const float normals[5][3] = {{0}, {0, 0, 1}, {0}, {0, 0, 1}, {1e30f, 0, 0}},
                       radii[5] = {1, 0, 1, 0, 2};
    assert_int_equal(points.span.count, 5);
    for (int i = 0; i < 5; i++) assert_memory_equal(points.surfels[i].normal, normals[i], sizeof normals[i]);
    assert_memory_equal(points.radii, radii, sizeof radii);
    test_points_free(&points);
}

static void bad_files_are_named_and_explained(void **state) {
    (void)state;
    static const struct {
        const char *text;
        iso_status status;
        const char *words;
    } cases[] = {
        {"", ISO_ERR_FORMAT, "not a PLY"},
        {"plx\n", ISO_ERR_FORMAT, "not a PLY"},
        {"plyformat ascii 1.0\n", ISO_ERR_FORMAT, "not a PLY"},
        {"ply\nformat ascii 1.0\nelement vertex 4\n", ISO_ERR_IO, "truncated"},
        {"ply\nelement vertex 1\n" END, ISO_ERR_FORMAT, "format"},
        {"ply\nformat ascii 2.0\n" END, ISO_ERR_FORMAT, "\"format\""},
        {"ply\nformat ascii 1.0\nelement vertex -1\n" END, ISO_ERR_FORMAT, "\"element\""},
        {"ply\nformat ascii 1.0\nelement vertex 99999999999999999999999\n" END, ISO_ERR_FORMAT,
         "\"element\""},
        {"ply\nformat ascii 1.0\nproperty float x\n" END, ISO_ERR_FORMAT, "\"property\""},
        {HEAD "property real x\n" END, ISO_ERR_FORMAT, "\"property\""},
        {HEAD "property list float int x\n" END, ISO_ERR_FORMAT, "\"property\""},
        {HEAD "surprise\n" END, ISO_ERR_FORMAT, "\"surprise\""},
        {HEAD NORMAL RADIUS "property list uchar float x\nproperty int y\nproperty int z\n" END,
         ISO_ERR_FORMAT, " x"},
        {HEAD XYZ NORMAL RADIUS END, ISO_ERR_IO, "truncated"},
        {HEAD XYZ NORMAL RADIUS END "1 2 3 0 0 1 1 1 2 3 0 0 1 1 1 2 3 0 0 1 1 1 2 3 0 0 1\n", ISO_ERR_IO,
         "truncated"},
        {HEAD XYZ NORMAL RADIUS END "1 2 3 0 0 one 1 1 2 3 0 0 1 1 1 2 3 0 0 1 1 1 2 3 0 0 1 1\n",
         ISO_ERR_FORMAT, "\"one\""},
        {"ply\nformat ascii 1.0\nelement vertex 0\n" XYZ NORMAL RADIUS END, ISO_ERR_EMPTY, "no points"},
        {"ply\nformat ascii 1.0\nelement vertex 9000000000000000000\n" XYZ NORMAL RADIUS END "1 2 3",
         ISO_ERR_IO, "truncated"},
        {"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n" XYZ NORMAL RADIUS END "1 2 3",
         ISO_ERR_IO, "truncated"},
        {"ply\nformat binary_big_endian 1.0\nelement a 18446744073709551615\nproperty list int double l\n" END
         "1 2 3",
         ISO_ERR_IO, "truncated"},
        {"ply\nformat binary_big_endian 1.0\nelement a 1\nproperty list int double l\n" END
         "\xff\xff\xff\xff",
         ISO_ERR_FORMAT, "list \"l\" of -1"},
        {"ply\nformat binary_big_endian 1.0\nelement a 1\nproperty list uint double l\n" END
         "\xff\xff\xff\xff",
         ISO_ERR_IO, "truncated"},
        {"ply\nformat ascii 1.0\nelement a 1\nproperty list int double l\n" END "4000000000 1 2", ISO_ERR_IO,
         "truncated"},
        {"ply\nformat ascii 1.0\nelement a 1\nproperty list int double l\n" END "nan 1 2", ISO_ERR_FORMAT,
         "list \"l\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_error error;
        test_points points = {0};
        iso_status status = read_text(cases[i].text, &points, &error);
        if (status != cases[i].status || !strstr(error.text, cases[i].words) || !strstr(error.text, FILE_PLY))
            fail_msg("case %zu: status %d, \"%s\"", i, status, error.text);
        assert_null(points.surfels);
    }
}

static void what_cannot_be_read_is_an_error(void **state) {
    (void)state;
    iso_error error = {0};
    test_points points;
    assert_int_equal(test_points_read(ISO_TEST_TMP "/no_such.ply", 0, &points, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "no_such.ply: cannot read: No such file"));
    assert_int_equal(test_points_read(ISO_TEST_TMP, 0, &points, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "not a regular file"));
    assert_int_equal(test_points_read("/dev/zero", 0, &points, &error), ISO_ERR_IO);
    bytes *file = malloc(sizeof *file);
    put_mixed(file, false, "\n");
    save(FILE_PLY, file->data, file->size);
    assert_int_equal(test_points_read(FILE_PLY, 3 * 28 - 1, &points, &error), ISO_ERR_LIMIT);
    test_ok(test_points_read(FILE_PLY, 1 << 20, &points, &error), &error);
    test_points_free(&points);
    free(file);
}

/* Every prefix of a file: an error that names it, never a crash and never points that are not there. In
 * ASCII, cutting the last number short can leave a number. */
static void every_truncation_is_noticed(void **state) {
    (void)state;
    bytes *file = malloc(sizeof *file);
    for (int kind = 0; kind < 3; kind++) {
        if (kind == 2)
            put_mixed_ascii(file, "\r\n");
        else
            put_mixed(file, kind == 1, "\n");
        for (size_t size = 0; size < file->size; size++) {
            save(FILE_PLY, file->data, size);
            iso_error error = {0};
            test_points points;
            iso_status status = test_points_read(FILE_PLY, 0, &points, &error);
            if (status == ISO_OK) test_points_free(&points);
            if (status == ISO_OK && kind == 2 && size + 1 >= file->size) continue;
            if (status != ISO_ERR_IO && !(status == ISO_ERR_FORMAT && size < 5))
                fail_msg("kind %d cut to %zu of %zu bytes: status %d %s", kind, size, file->size, status,
                         error.text);
            assert_non_null(strstr(error.text, FILE_PLY));
        }
    }
    free(file);
}

/* ---- meshes */

/* A mesh as a file holds it, in world millimetres. */
typedef struct triangle_soup {
    size_t vertex_count, triangle_count;
    double (*vertices)[3], (*normals)[3]; /* normals: of vertices (ply, obj) or facets (stl) */
    uint32_t (*triangles)[3];
} triangle_soup;

static void soup_make(triangle_soup *soup, size_t vertices, size_t triangles) {
    soup->vertex_count = vertices;
    soup->triangle_count = triangles;
    soup->vertices = calloc(vertices + 1, sizeof *soup->vertices);
    soup->normals = calloc(vertices + triangles + 1, sizeof *soup->normals);
    soup->triangles = calloc(triangles + 1, sizeof *soup->triangles);
}

static void soup_free(triangle_soup *soup) {
    free(soup->vertices);
    free(soup->normals);
    free(soup->triangles);
}

static void get_floats(FILE *file, double values[3]) {
    float three_floats[3];
    assert_int_equal(fread(three_floats, 4, 3, file), 3);
    for (int i = 0; i < 3; i++) values[i] = three_floats[i];
}

static void read_ply(FILE *file, triangle_soup *soup) {
    char line[200];
    size_t vertices = 0, triangles = 0;
    do {
        assert_non_null(fgets(line, sizeof line, file));
        sscanf(line, "element vertex %zu", &vertices);
        sscanf(line, "element face %zu", &triangles);
    } while (strcmp(line, "end_header\n") != 0);
    soup_make(soup, vertices, triangles);
    for (size_t i = 0; i < vertices; i++) {
        get_floats(file, soup->vertices[i]);
        get_floats(file, soup->normals[i]);
    }
    for (size_t i = 0; i < triangles; i++) {
        assert_int_equal(fgetc(file), 3);
        assert_int_equal(fread(soup->triangles[i], 4, 3, file), 3);
    }
}

static void read_stl(FILE *file, triangle_soup *soup) {
    char header[80];
    uint32_t triangles;
    assert_int_equal(fread(header, 1, 80, file), 80);
    assert_memory_not_equal(header, "solid", 5);
    assert_int_equal(fread(&triangles, 4, 1, file), 1);
    soup_make(soup, 3 * (size_t)triangles, triangles);
    for (uint32_t i = 0; i < triangles; i++) {
        get_floats(file, soup->normals[i]);
        for (uint32_t j = 0; j < 3; j++) {
            get_floats(file, soup->vertices[3 * i + j]);
            soup->triangles[i][j] = 3 * i + j;
        }
        assert_int_equal(fgetc(file), 0);
        assert_int_equal(fgetc(file), 0);
    }
}

static void read_obj(FILE *file, triangle_soup *soup) {
    char line[200];
    size_t vertices = 0, normals = 0, triangles = 0;
    while (fgets(line, sizeof line, file)) {
        vertices += line[0] == 'v' && line[1] == ' ';
        normals += line[0] == 'v' && line[1] == 'n';
        triangles += line[0] == 'f';
    }
    assert_int_equal(vertices, normals);
    soup_make(soup, vertices, triangles);
    vertices = normals = triangles = 0;
    rewind(file);
    while (fgets(line, sizeof line, file)) {
        double *p = line[1] == 'n' ? soup->normals[normals] : soup->vertices[vertices];
        uint32_t *t = soup->triangles[triangles], n[3];
        if (line[0] == 'v' && sscanf(line + 2, "%lf %lf %lf", p, p + 1, p + 2) == 3)
            line[1] == 'n' ? normals++ : vertices++;
        else if (sscanf(line, "f %u//%u %u//%u %u//%u", t, n, t + 1, n + 1, t + 2, n + 2) == 6) {
            assert_memory_equal(t, n, sizeof n);
            for (int j = 0; j < 3; j++) t[j]--;
            triangles++;
        } else
            assert_int_equal(line[0], '#');
    }
    assert_int_equal(triangles, soup->triangle_count);
}

static iso_vec3 vec(const double p[3]) {
    return iso_vec3_make(p[0], p[1], p[2]);
}

static iso_vec3 area_vector(const triangle_soup *soup, size_t triangle) {
    const uint32_t *t = soup->triangles[triangle];
    for (int j = 0; j < 3; j++) assert_true(t[j] < soup->vertex_count);
    iso_vec3 a = vec(soup->vertices[t[0]]), b = vec(soup->vertices[t[1]]), c = vec(soup->vertices[t[2]]);
    return iso_vec3_scale(iso_vec3_cross(iso_vec3_sub(b, a), iso_vec3_sub(c, a)), 0.5);
}

/* The divergence theorem: positive when triangles are counter-clockwise from outside. */
static double volume(const triangle_soup *soup) {
    double sum = 0;
    for (size_t i = 0; i < soup->triangle_count; i++)
        sum += iso_vec3_dot(vec(soup->vertices[soup->triangles[i][0]]), area_vector(soup, i)) / 3;
    return sum;
}

typedef void read_fn(FILE *file, triangle_soup *soup);
static const struct {
    const char *path;
    read_fn *read;
} formats[] = {{ISO_TEST_TMP "/test_io_mesh.ply", read_ply},
               {ISO_TEST_TMP "/test_io_mesh.STL", read_stl},
               {ISO_TEST_TMP "/test_io_mesh.oBj", read_obj}};

static const double radius = 9.3;
static const iso_vec3 centre = {14.4, 15.1, 13.7};
enum { SIDE = 30 };

static double ball_distance(int x, int y, int z) {
    return iso_vec3_length(iso_vec3_sub(iso_vec3_make(x, y, z), centre)) - radius;
}

static iso_grid dense_ball(const iso_transform *transform, int level_set) {
    const iso_rgrid_desc desc = {
        .dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32, .transform = transform, .level_set = level_set};
    iso_grid grid = {0};
    iso_error error = {0};
    test_ok(iso_rgrid_create(&desc, &grid.rgrid, &error), &error);
    float *data = grid.rgrid->data;
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++)
                *data++ = (float)(level_set ? ball_distance(x, y, z) : -ball_distance(x, y, z));
    return grid;
}

static iso_grid sparse_ball(const iso_transform *transform) {
    const int dims[3] = {SIDE, SIDE, SIDE};
    iso_grid grid = {0};
    iso_error error = {0};
    test_ok(iso_hgrid_create(dims, 0, transform, &grid.hgrid, &error), &error);
    for (int c = 0; c < 8; c++) {
        const int cell[3] = {c & 1, c >> 1 & 1, c >> 2};
        float *brick;
        test_ok(iso_hgrid_split(grid.hgrid, cell[0], cell[1], cell[2], &brick, &error), &error);
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
            double d =
                ball_distance(16 * cell[0] + i % 16, 16 * cell[1] + i / 16 % 16, 16 * cell[2] + i / 256);
            brick[i] = (float)fmin(fmax(d, -3), 3);
        }
    }
    return grid;
}

static void check_ball(const iso_grid *grid, const iso_mesh_view *view, int format) {
    iso_error error = {0};
    test_ok(iso_mesh_write(formats[format].path, view, "a ball", &error), &error);
    FILE *file = fopen(formats[format].path, "rb");
    assert_non_null(file);
    triangle_soup soup;
    formats[format].read(file, &soup);
    assert_int_equal(fgetc(file), EOF);
    fclose(file);
    bool stl = formats[format].read == read_stl;
    size_t triangles = iso_mesh_view_triangle_count(view);
    assert_true(triangles > 1000);
    assert_int_equal(soup.triangle_count, triangles);
    assert_int_equal(soup.vertex_count, stl ? 3 * triangles : iso_mesh_view_vertex_count(view));
    iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    double wanted = 4.0 / 3 * ISO_PI * radius * radius * radius * fabs(affine.determinant);
    double got = volume(&soup);
    if (!(fabs(got / wanted - 1) < 0.01)) fail_msg("volume %g, wanted %g", got, wanted);
    iso_vec3 middle = iso_affine_point(&affine, centre);
    for (size_t i = 0; i < (stl ? triangles : soup.vertex_count); i++) {
        iso_vec3 normal = vec(soup.normals[i]);
        assert_true(fabs(iso_vec3_length(normal) - 1) < 1e-6 || iso_vec3_length(normal) == 0);
        iso_vec3 out = stl ? area_vector(&soup, i) : iso_vec3_sub(vec(soup.vertices[i]), middle);
        double length = iso_vec3_length(out);
        /* slivers have no direction in floats; an ellipsoid's normal is up to 62 degrees off its radius */
        if (length > 1e-3) assert_true(iso_vec3_dot(normal, out) > 0.4 * length);
    }
    soup_free(&soup);
}

static void meshes_enclose_their_volume(void **state) {
    (void)state;
    for (int handed = 0; handed < 2; handed++)
        for (int kind = 0; kind < 3; kind++) {
            iso_transform transform = handed ? left_handed() : iso_transform_identity();
            iso_grid grid = kind == 2 ? sparse_ball(&transform) : dense_ball(&transform, kind);
            iso_mesh_opts opts = {.isovalue = 0};
            iso_mesh_set *set;
            iso_error error = {0};
            test_ok(iso_mesh_set_create(&grid, &opts, &set, &error), &error);
            test_ok(iso_mesh_set_update(set, &error), &error);
            iso_mesh_view view = iso_mesh_set_view(set);
            for (int format = 0; format < 3; format++) check_ball(&grid, &view, format);
            iso_mesh_set_destroy(set);
            iso_grid_destroy(&grid);
        }
}

/* Two triangles, one of them without area. */
static iso_mesh_view flat_mesh(void) {
    static const iso_surfel vertices[3] = {
        {{0, 0, 0}, {0, 0, 1}}, {{0.1f, 0, 0}, {0, 0, 1}}, {{0, 1.0f / 3, 0}, {0, 0, 1}}};
    static const iso_edge_key keys[3] = {0, 1, 2};
    static const uint16_t triangles[2][3] = {{0, 1, 2}, {1, 1, 2}};
    static const iso_mesh_span span = {.vertex_count = 3, .owned_count = 3, .triangle_count = 2};
    return (iso_mesh_view){.vertices = vertices,
                           .keys = keys,
                           .triangles = triangles,
                           .spans = &span,
                           .span_count = 1,
                           .transform = iso_transform_identity()};
}

static void degenerate_triangles_and_floats_survive(void **state) {
    (void)state;
    const iso_mesh_view view = flat_mesh();
    for (int format = 0; format < 3; format++) {
        iso_error error = {0};
        test_ok(iso_mesh_write(formats[format].path, &view, NULL, &error), &error);
        FILE *file = fopen(formats[format].path, "rb");
        triangle_soup soup;
        formats[format].read(file, &soup);
        fclose(file);
        assert_int_equal(soup.triangle_count, 2);
        const double *third = soup.vertices[soup.triangles[0][2]];
        assert_true((float)third[1] == 1.0f / 3); /* nine digits in .obj are enough */
        if (formats[format].read == read_stl) {
            assert_true(soup.normals[0][2] == 1);
            for (int axis = 0; axis < 3; axis++) assert_true(soup.normals[1][axis] == 0);
        }
        soup_free(&soup);
    }
}

/* ---- writing that fails */

static void nothing_left_behind(const char *name) {
    char command[512];
    snprintf(command, sizeof command, "ls %s | grep -q '^%s'", ISO_TEST_TMP, name);
    assert_int_not_equal(system(command), 0);
}

static void mesh_paths_are_checked(void **state) {
    (void)state;
    const iso_mesh_view view = flat_mesh();
    static const char *const paths[] = {"-", "mesh", "mesh.vtk", "dir.ply/mesh", ".ply/mesh"};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        iso_error error = {0};
        assert_int_equal(iso_mesh_write(paths[i], &view, NULL, &error), ISO_ERR_USAGE);
        assert_non_null(strstr(error.text, paths[i]));
    }
    iso_error error = {0};
    assert_int_equal(iso_mesh_write(ISO_TEST_TMP "/no/such/folder.ply", &view, NULL, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "folder.ply"));
}

/* A disk that fills up: a limit on file sizes makes write fail with EFBIG. */
static void a_full_disk_is_an_error(void **state) {
    (void)state;
    iso_transform transform = iso_transform_identity();
    iso_grid grid = dense_ball(&transform, 0);
    iso_mesh_opts mesh_opts = {.isovalue = 0};
    iso_points_opts points_opts = {.isovalue = 0};
    iso_mesh_set *meshes;
    iso_point_set *points;
    iso_error error = {0};
    test_ok(iso_mesh_set_create(&grid, &mesh_opts, &meshes, &error), &error);
    test_ok(iso_mesh_set_update(meshes, &error), &error);
    test_ok(iso_point_set_create(&grid, &points_opts, &points, &error), &error);
    test_ok(iso_point_set_update(points, &error), &error);
    const iso_mesh_view mesh_view = iso_mesh_set_view(meshes);
    const iso_point_view point_view = iso_point_set_view(points);

    struct rlimit before, tight;
    getrlimit(RLIMIT_FSIZE, &before);
    tight = before;
    tight.rlim_cur = 10000;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &tight);
    static const char *const paths[] = {ISO_TEST_TMP "/full_io.ply", ISO_TEST_TMP "/full_io.stl",
                                        ISO_TEST_TMP "/full_io.obj"};
    iso_status status[4];
    for (int i = 0; i < 3; i++) status[i] = iso_mesh_write(paths[i], &mesh_view, NULL, &error);
    status[3] = iso_points_write_ply(paths[0], &point_view, NULL, &error);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);

    for (int i = 0; i < 4; i++) assert_int_equal(status[i], ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "full_io.ply: cannot write: File too large"));
    nothing_left_behind("full_io");
    iso_point_set_destroy(points);
    iso_mesh_set_destroy(meshes);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_come_back_bit_for_bit),
        cmocka_unit_test(points_are_written_in_world_millimetres),
        cmocka_unit_test(other_dialects_are_read),
        cmocka_unit_test(only_regular_files_are_read),
        cmocka_unit_test(the_locale_does_not_matter),
        cmocka_unit_test(unusable_points_are_dropped),
        cmocka_unit_test(bad_files_are_named_and_explained),
        cmocka_unit_test(what_cannot_be_read_is_an_error),
        cmocka_unit_test(every_truncation_is_noticed),
        cmocka_unit_test(meshes_enclose_their_volume),
        cmocka_unit_test(degenerate_triangles_and_floats_survive),
        cmocka_unit_test(mesh_paths_are_checked),
        cmocka_unit_test(a_full_disk_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
