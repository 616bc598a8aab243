/* face_normals: meshes read as points, .ply, .off and .obj: normals of the file, or made from its faces. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/geometry.h"
#include "check_support.h"
#include "file_support.h"
#include "glyphs_support.h"
#include "index_support.h"

#define FILE_OFF ISO_TEST_TMP "/test_face_normals.off"
#define FILE_OBJ ISO_TEST_TMP "/test_face_normals.obj"
#define FILE_PLY ISO_TEST_TMP "/test_face_normals.ply"

static const iso_read_opts from_faces = {.normals_from_faces = true};

/* ---- a cube: at its corners the normals point along the diagonals, however its faces are divided */

enum { CORNERS = 8 };
static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

typedef struct made_text {
    char text[4096];
    size_t length;
} made_text;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
add(made_text *made, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    made->length +=
        (size_t)vsnprintf(made->text + made->length, sizeof made->text - made->length, format, arguments);
    va_end(arguments);
    assert_true(made->length < sizeof made->text);
}

/* Adds the corners of the cube 1 .. 3 and a vertex without a face, each behind `prefix`. */
static void add_vertices(made_text *made, const char *prefix) {
    for (int i = 0; i < CORNERS; i++)
        add(made, "%s%d %d %d\n", prefix, 1 + 2 * (i & 1), 1 + (i & 2), 1 + (i & 4) / 2);
    add(made, "%s9 9 9\n", prefix);
}

/* Adds the faces, the last three divided into triangles, each behind `prefix` and, if `counted`, its number
 * of corners; vertices are numbered from `base` on. */
static void add_faces(made_text *made, const char *prefix, bool counted, int base) {
    for (int i = 0; i < 6; i++) {
        const int *f = faces[i];
        const char *const count[2] = {counted ? "3 " : "", counted ? "4 " : ""};
        if (i < 3)
            add(made, "%s%s%d %d %d %d\n", prefix, count[1], f[0] + base, f[1] + base, f[2] + base,
                f[3] + base);
        else
            add(made, "%s%s%d %d %d\n%s%s%d %d %d\n", prefix, count[0], f[0] + base, f[1] + base, f[2] + base,
                prefix, count[0], f[2] + base, f[3] + base, f[0] + base);
    }
}

static iso_glyphs read_made(const char *path, const made_text *made, bool ask) {
    spill(path, made->text, made->length);
    return read_with(path, (iso_read_opts){.normals_from_faces = ask});
}

/* Checks the normals, and that there are none if they are not asked for. */
static void check_cube(const char *path, const made_text *made) {
    iso_glyphs glyphs = read_made(path, made, true);
    assert_int_equal(glyphs.count, CORNERS + 1);
    assert_non_null(glyphs.directions);
    const double part = 1 / sqrt(3);
    for (size_t i = 0; i < CORNERS; i++)
        check_vector(glyphs.directions[i], i & 1 ? part : -part, i & 2 ? part : -part, i & 4 ? part : -part);
    check_vector(glyphs.directions[CORNERS], 0, 0, 0);
    iso_glyphs_free(&glyphs);
    glyphs = read_made(path, made, false);
    assert_null(glyphs.directions);
    iso_glyphs_free(&glyphs);
    read_truncated(path, made->text, made->length, from_faces);
}

static void test_cubes(void **state) {
    (void)state;
    made_text made = {.length = 0};
    add(&made, "OFF # a cube\n# vertices, faces, edges\n9 9 0\n\n");
    add_vertices(&made, "");
    add_faces(&made, "", true, 0);
    check_cube(FILE_OFF, &made);
    made.length = 0;
    add_vertices(&made, "v ");
    add_faces(&made, "f ", false, 1);
    check_cube(FILE_OBJ, &made);
    made.length = 0; /* counted from the end */
    add_vertices(&made, "v ");
    add_faces(&made, "f\t", false, -9);
    check_cube(FILE_OBJ, &made);
    static const char *const vertex =
                                 "element vertex 9\nproperty float x\nproperty float y\nproperty float z\n",
                             *const face = "element face 9\nproperty list uchar int vertex_indices\n";
    for (int first = 0; first < 2; first++) { /* the faces behind the vertices, and before them */
        made.length = 0;
        add(&made, "ply\nformat ascii 1.0\n%s%send_header\n", first ? face : vertex, first ? vertex : face);
        if (first) add_faces(&made, "", true, 0);
        add_vertices(&made, "");
        if (!first) add_faces(&made, "", true, 0);
        check_cube(FILE_PLY, &made);
    }
}

/* ---- strips */

static void test_strips(void **state) {
    (void)state;
    made_text made = {.length = 0};
    add(&made,
        "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n");
    add_vertices(&made, "");
    add(&made, "29");
    for (int i = 0; i < 6; i++) /* a face is the strip 0 1 3 2; strips of one or two corners are nothing */
        add(&made, " %d %d %d %d%s", faces[i][0], faces[i][1], faces[i][3], faces[i][2],
            i < 5 ? " -1" : "\n");
    check_cube(FILE_PLY, &made);
    /* longer strips turn every other triangle */
    iso_glyphs glyphs;
    static const char text[] =
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
        "element tristrips 1\nproperty list int int vertex_index\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n9 0 1 2 3 4 5 -1 0 1\n";
    spill(FILE_PLY, text, strlen(text));
    glyphs = read_with(FILE_PLY, from_faces);
    for (size_t i = 0; i < 6; i++) check_vector(glyphs.directions[i], 0, 0, 1);
    iso_glyphs_free(&glyphs);
}

/* ---- normals and colours of the file */

static void test_off_kinds(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool normals;
        int red; /* -1: no colours */
    } kinds[] = {
        {"OFF 1 0 0\n1 2 3\n", false, -1},
        {"COFF\n1 0\n1 2 3 192 0 0 255\n", false, 192},
        {"COFF\n2 0 0\n1 2 3 .5 0 0\n4 5 6 1 1 1\n", false, 128},
        {"NOFF\n1 0 0\n1 2 3 0 1 0\n", true, -1},
        {"CNOFF\n1 0 0\n1 2 3 0 1 0 9 8 7\n", true, 9},
        {"STCNOFF\n1 0 0\n1 2 3 0 1 0 9 8 7 255 .5 .5 # a vertex\n", true, 9},
        {"STOFF\n1 0 0\n1 2 3 .5 .5\n", false, -1},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        iso_glyphs glyphs = read_text(FILE_OFF, kinds[i].text);
        check_vector(glyphs.positions[0], 1, 2, 3);
        if ((glyphs.colors ? glyphs.colors[0][0] : -1) != kinds[i].red) fail_msg("%s", kinds[i].text);
        assert_int_equal(glyphs.directions != NULL, kinds[i].normals);
        if (kinds[i].normals) check_vector(glyphs.directions[0], 0, 1, 0);
        iso_glyphs_free(&glyphs);
        read_truncated(FILE_OFF, kinds[i].text, strlen(kinds[i].text), from_faces);
    }
}

static void test_off_errors(void **state) {
    (void)state;
    static const struct {
        const char *text;
        iso_status status;
        const char *reason;
    } bad[] = {
        {"", ISO_ERR_FORMAT, "empty"},
        {"1 2 3\n", ISO_ERR_FORMAT, "not an OFF file"},
        {"4OFF\n1 0 0\n", ISO_ERR_UNSUPPORTED, "three dimensions"},
        {"OFF BINARY\n1 0 0\n", ISO_ERR_UNSUPPORTED, "binary"},
        {"OFF\n", ISO_ERR_IO, "truncated"},
        {"OFF\n-1 0 0\n", ISO_ERR_FORMAT, "row 2"},
        {"OFF\n2 0 0\n1 2 3\n", ISO_ERR_IO, "truncated"},
        {"OFF\n99999999 0 0\n1 2 3\n", ISO_ERR_IO, "truncated"},
        {"OFF\n1 0 0\n1 2\n      ", ISO_ERR_FORMAT, "row 3"},
        {"COFF\n1 0 0\n1 2 3\n", ISO_ERR_FORMAT, "row 3"},
        {"OFF\n1 1 0\n1 2 3\n", ISO_ERR_IO, "faces are missing"},
        {"OFF\n1 1 0\n1 2 3\n3 0 0\n", ISO_ERR_FORMAT, "row 4"},
        {"OFF\n1 1 0\n1 2 3\n3 0 0 1\n", ISO_ERR_FORMAT, "names point 1 of 1"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        spill(FILE_OFF, bad[i].text, strlen(bad[i].text));
        refuse(FILE_OFF, from_faces, bad[i].status, bad[i].reason);
    }
}

static void test_obj(void **state) {
    (void)state;
    static const char text[] =
        "# made\nv 1 2 3 1 0.5 0\nv 4 5 6\nvt 0 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//2 1//1\nl 1 2\n";
    spill(FILE_OBJ, text, strlen(text));
    iso_glyphs glyphs = read_with(FILE_OBJ, from_faces);
    assert_int_equal(glyphs.count, 2);
    assert_string_equal(report.format, "obj");
    check_vector(glyphs.directions[1], 0, 1, 0);
    assert_int_equal(glyphs.colors[0][1], 128);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_OBJ, "v 1 2 3\nvn 0 0 1\nvn 0 1 0\n"); /* not one for each vertex */
    assert_null(glyphs.directions);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_OBJ, "v 1 2\n", ISO_ERR_FORMAT, "row 1");
    refuse_text(FILE_OBJ, "v 1 2 3\nvn 1 2\n", ISO_ERR_FORMAT, "row 2");
    static const char damaged[] = "v 1 2 3\nf 1 1 2\n";
    spill(FILE_OBJ, damaged, strlen(damaged));
    refuse(FILE_OBJ, from_faces, ISO_ERR_FORMAT, "names point 1 of 1");
}

/* ---- files of other programs */

/* On a closed surface normals point away from the middle, more often and farther than towards it; `sign` -1:
 * the file's faces are clockwise. */
static void check_outward(const char *name, const iso_glyphs *glyphs, int sign) {
    const iso_box box = iso_glyphs_bounds(glyphs);
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    double sum = 0, most = 0;
    for (size_t i = 0; i < glyphs->count; i++) {
        const float *p = glyphs->positions[i], *n = glyphs->directions[i];
        const iso_vec3 away = iso_vec3_sub(
            iso_vec3_add(glyphs->origin, iso_vec3_make((double)p[0], (double)p[1], (double)p[2])), middle);
        sum += iso_vec3_dot(away, iso_vec3_make((double)n[0], (double)n[1], (double)n[2]));
        most += iso_vec3_length(away);
    }
    if (!(sign * sum > 0.3 * most)) fail_msg("%s: %g of %g", name, sum, most);
}

static void test_meshes(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int sign;
    } meshes[] = {
        {"bunny.ply", -1}, {"horse.ply", -1}, {"igea.ply", 1}, {"elephant.off", 1}, {"cactus.off", 1}};
    free(load_index("points")); /* skips when there are none */
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        char name[64];
        snprintf(name, sizeof name, "scans/%s", meshes[i].name);
        iso_glyphs glyphs = read_with(index_path("points", name), from_faces);
        assert_non_null(glyphs.directions);
        check_outward(name, &glyphs, meshes[i].sign);
        iso_glyphs_free(&glyphs);
    }
    refuse(index_path("points", "bad/face_index_out_of_range.ply"), from_faces, ISO_ERR_FORMAT,
           "a face names");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cubes),      cmocka_unit_test(test_strips), cmocka_unit_test(test_off_kinds),
        cmocka_unit_test(test_off_errors), cmocka_unit_test(test_obj),    cmocka_unit_test(test_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
