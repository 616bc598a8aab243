/* glyphs: the readers of points with sizes and directions, and of molecules. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "file_support.h"
#include "glyphs_support.h"
#include "index_support.h"
#include "io/glyphs/glyphs_read.h"

#define FILE_XYZ ISO_TEST_TMP "/test_glyphs.xyz"
#define FILE_PDB ISO_TEST_TMP "/test_glyphs.pdb"
#define FILE_CSV ISO_TEST_TMP "/test_glyphs.csv"
#define FILE_PLY ISO_TEST_TMP "/test_glyphs.ply"
#define FILE_VTK ISO_TEST_TMP "/test_glyphs.vtk"

/* ---- .xyz */

static void test_xyz_molecule(void **state) {
    (void)state;
    iso_glyphs glyphs =
        read_text(FILE_XYZ, "6\n a comment 1 2 3\nC 0 0 0\nca 1.5 0 -1e0 0.1 0.2\n8 0 0 3\nC12 1 1 1\n"
                            "Zz 2 2 2\nD 4 0 nan\n\n\n");
    assert_int_equal(glyphs.count, 5);
    assert_int_equal(report.items, 6);
    assert_int_equal(report.dropped, 1);
    assert_int_equal(report.note_count, 1);
    assert_string_equal(report.format, "xyz");
    static const float radii[] = {1.70f, 2.62f, 1.52f, 1.70f, 2.00f};
    for (int i = 0; i < 5; i++) assert_true(glyphs.radii[i] == radii[i]);
    static const uint8_t carbon[] = {0x90, 0x90, 0x90}, oxygen[] = {0xff, 0x0d, 0x0d};
    assert_memory_equal(glyphs.colors[3], carbon, 3);
    assert_memory_equal(glyphs.colors[2], oxygen, 3);
    check_vector(glyphs.positions[1], 1.5, 0, -1);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_XYZ, "1\n\nC 0 0 0\n1\n\nC 1 0 0\n");
    assert_int_equal(glyphs.count, 1);
    assert_non_null(strstr(report.notes[0], "frames"));
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_XYZ, "0\n\n");
    assert_int_equal(glyphs.count, 0);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_XYZ, "2\n\nC 0 0 0\nC 1 1\n", ISO_ERR_FORMAT, "row 4");
    refuse_text(FILE_XYZ, "5\n\nC 0 0 0\nC 1 1 1\n", ISO_ERR_IO, "truncated");
    refuse_text(FILE_XYZ, "3\n\nC 0 0 0 xxxxxxxxxxx\nC 1 1 1\n", ISO_ERR_IO, "truncated");
    refuse_text(FILE_XYZ, "999999999999999999\n\nC 0 0 0\n", ISO_ERR_FORMAT, "row 1");
    refuse_text(FILE_XYZ, "99999999999999\n\nC 0 0 0\n", ISO_ERR_IO, "truncated");
}

static void test_xyz_points(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(FILE_XYZ, "# points\n1 2 3\n4,5,6\n\n7;8 ; 9\n1e13 0 0\n-1\t-2\t-3");
    assert_int_equal(glyphs.count, 4);
    assert_int_equal(report.dropped, 1);
    assert_null(glyphs.directions);
    assert_null(glyphs.radii);
    for (int i = 0; i < 3; i++) check_vector(glyphs.positions[i], 3 * i + 1, 3 * i + 2, 3 * i + 3);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_XYZ, "1 2 3 0 0 7\n4 5 6 nan 0 1\n");
    check_vector(glyphs.directions[0], 0, 0, 7);
    check_vector(glyphs.directions[1], 0, 0, 0);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_XYZ, "1 2 3\n4 5\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_XYZ, "1 2 3\n4 5 6 7\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_XYZ, "C 2 3\n1 2 3\n", ISO_ERR_FORMAT, "no x");
    refuse_text(FILE_XYZ, "", ISO_ERR_FORMAT, "empty");
}

/* ---- .pdb */

typedef struct pdb_text {
    char text[1 << 16];
    size_t length;
} pdb_text;

static void add_text(pdb_text *pdb, const char *text) {
    const size_t length = strlen(text);
    assert_true(pdb->length + length < sizeof pdb->text);
    memcpy(pdb->text + pdb->length, text, length + 1);
    pdb->length += length;
}

/* `label`: columns 13 to 27: name, location, residue, chain and its number. */
static void add_atom(pdb_text *pdb, const char *label, double x, double y, double z, const char *element) {
    char row[128];
    snprintf(row, sizeof row, "ATOM  %5d %-15s   %8.3f%8.3f%8.3f%6.2f%6.2f          %2s\n", 1, label, x, y, z,
             1.0, 20.5, element);
    add_text(pdb, row);
}

static void add_matrix(pdb_text *pdb, int number, const double m[12]) {
    char row[128];
    for (int i = 0; i < 3; i++) {
        snprintf(row, sizeof row, "REMARK 350   BIOMT%d %3d%10.6f%10.6f%10.6f%15.5f            \n", i + 1,
                 number, m[4 * i], m[4 * i + 1], m[4 * i + 2], m[4 * i + 3]);
        add_text(pdb, row);
    }
}

static iso_glyphs read_pdb(const pdb_text *pdb, int assembly) {
    spill(FILE_PDB, pdb->text, pdb->length);
    return read_with(FILE_PDB, (iso_read_opts){.assembly = assembly});
}

/* What the element column says, or else the name by its columns. */
static void test_pdb_elements(void **state) {
    (void)state;
    static const struct {
        const char *label, *element;
        float radius;
    } atoms[] = {
        {" CA  ALA A   1", "", 1.70f},  {"CA    CA A   2", "", 2.62f},   {" CA  ALA A   1", "CA", 2.62f},
        {"HG11 VAL A   3", "", 1.20f},  {"HG    HG A   4", "", 2.45f},   {"1HB  ALA A   1", "", 1.20f},
        {"FE   HEM A   5", "", 2.44f},  {"FE   HEM A   5", "FE", 2.44f}, {" N   ALA A   1", "", 1.55f},
        {"C1   LIG A   6", "", 1.70f},  {"CL1  LIG A   6", "", 1.75f},   {" O1A LIG A   6", "O", 1.52f},
        {" H111BENZ    1", "", 1.20f},  {"QQ   LIG A   6", "", 2.00f},   {" D   HOH A   7", "D", 1.20f},
        {" CA  ALA A   1", "7", 1.70f},
    };
    enum { COUNT = sizeof atoms / sizeof *atoms };
    pdb_text pdb = {.length = 0};
    for (int i = 0; i < COUNT; i++) add_atom(&pdb, atoms[i].label, i, 0, 0, atoms[i].element);
    iso_glyphs glyphs = read_pdb(&pdb, 0);
    assert_int_equal(glyphs.count, COUNT);
    for (int i = 0; i < COUNT; i++)
        if (glyphs.radii[i] != atoms[i].radius) fail_msg("'%s': %g", atoms[i].label, (double)glyphs.radii[i]);
    assert_int_equal(report.note_count, 1);
    assert_true(find_attribute(&glyphs, "temperature")->values[3] == 20.5f);
    iso_glyphs_free(&glyphs);
}

static void test_pdb_locations(void **state) {
    (void)state;
    pdb_text pdb = {.length = 0};
    add_text(&pdb, "MODEL        1\r\n");
    add_atom(&pdb, " N   ALA A   1", 0, 0, 0, "N");
    add_atom(&pdb, " CA AALA A   1", 1, 0, 0, "C");
    add_atom(&pdb, " CA BALA A   1", 2, 0, 0, "C");
    add_atom(&pdb, " CB BALA A   1", 3, 0, 0, "C"); /* the only location of this one */
    add_atom(&pdb, " CA AALA A   2", 4, 0, 0, "C");
    add_atom(&pdb, " CA ASER A   3", 5, 0, 0, "C"); /* alternative residues */
    add_atom(&pdb, " CB BTHR A   3", 6, 0, 0, "C");
    add_atom(&pdb, " CA AALA B   3", 7, 0, 0, "C");
    add_atom(&pdb, " CA BALA C   3", -123.456, -123.456, -123.456, "C"); /* numbers that touch */
    add_text(&pdb, "ENDMDL\nMODEL        2\n");
    add_atom(&pdb, " N   ALA A   1", 9, 0, 0, "N");
    add_text(&pdb, "ENDMDL\n");
    iso_glyphs glyphs = read_pdb(&pdb, 0);
    static const int kept[] = {0, 1, 3, 4, 5, 7};
    assert_int_equal(glyphs.count, 7);
    for (int i = 0; i < 6; i++) check_vector(glyphs.positions[i], kept[i], 0, 0);
    near((double)glyphs.positions[6][1], -123.456, 1e-4);
    const float *chain = find_attribute(&glyphs, "chain")->values;
    assert_true(chain[0] == 0 && chain[5] == 1 && chain[6] == 2);
    assert_int_equal(report.note_count, 2);
    iso_glyphs_free(&glyphs);
}

static void test_pdb_assemblies(void **state) {
    (void)state;
    static const double same[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                        moved[12] = {0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, -100.5};
    pdb_text pdb = {.length = 0};
    add_text(&pdb, "REMARK 350\nREMARK 350 BIOMOLECULE: 1\n");
    add_text(&pdb,
             "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A,\nREMARK 350                    AND CHAINS: B\n");
    add_matrix(&pdb, 1, same);
    add_matrix(&pdb, 1000, moved); /* whose columns are shifted */
    add_text(&pdb, "REMARK 350 APPLY THE FOLLOWING TO CHAINS: C\n");
    add_matrix(&pdb, 3, moved);
    add_text(&pdb, "REMARK 350 BIOMOLECULE: 2\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: NULL\n");
    add_matrix(&pdb, 1, same);
    add_text(&pdb, "REMARK 350 BIOMOLECULE: 3\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: Z\n");
    add_matrix(&pdb, 1, same);
    add_atom(&pdb, " CA  ALA A   1", 1, 2, 3, "C");
    add_atom(&pdb, " CA  ALA B   1", 4, 5, 6, "C");
    add_atom(&pdb, " CA  ALA C   1", 7, 8, 9, "C");
    add_atom(&pdb, " CA  ALA     1", 10, 11, 12, "C");
    iso_glyphs glyphs = read_pdb(&pdb, 0);
    static const double places[5][3] = {{1, 2, 3}, {4, 5, 6}, {8, 21, -97.5}, {5, 24, -94.5}, {2, 27, -91.5}};
    static const float copies[5] = {0, 0, 1, 1, 2};
    assert_int_equal(glyphs.count, 5);
    for (int i = 0; i < 5; i++) {
        check_vector(glyphs.positions[i], places[i][0], places[i][1], places[i][2]);
        assert_true(find_attribute(&glyphs, "copy")->values[i] == copies[i]);
    }
    iso_glyphs_free(&glyphs);
    glyphs = read_pdb(&pdb, -1);
    assert_int_equal(glyphs.count, 4);
    check_vector(glyphs.positions[3], 10, 11, 12);
    iso_glyphs_free(&glyphs);
    glyphs = read_pdb(&pdb, 2);
    assert_int_equal(glyphs.count, 1);
    check_vector(glyphs.positions[0], 10, 11, 12);
    assert_int_equal(report.note_count, 1);
    iso_glyphs_free(&glyphs);
    glyphs = read_pdb(&pdb, 3); /* of a chain that is not there */
    assert_int_equal(glyphs.count, 4);
    iso_glyphs_free(&glyphs);
    refuse(FILE_PDB, (iso_read_opts){.assembly = 4}, ISO_ERR_USAGE, "no assembly 4: there are 3");
    glyphs = read_with(FILE_PDB, (iso_read_opts){.space = ISO_SPACE_RAS});
    check_vector(glyphs.positions[2], -8, -21, -97.5);
    iso_glyphs_free(&glyphs);
}

static void test_pdb_errors(void **state) {
    (void)state;
    refuse_text(FILE_PDB, "hello\n", ISO_ERR_FORMAT, "not a .pdb file");
    refuse_text(FILE_PDB, "ATOM      1  C   MOL     1       0.000   0.000\n", ISO_ERR_FORMAT, "row 1");
    refuse_text(FILE_PDB, "ATOM      1  C   MOL     1       0.000   zero     0.0\n", ISO_ERR_FORMAT, "row 1");
    refuse_text(FILE_PDB, "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000\n", ISO_ERR_FORMAT, "BIOMT");
    refuse_text(FILE_PDB, "REMARK 350   BIOMT2   1  1.000000  0.000000  0.000000        0.00000\n",
                ISO_ERR_FORMAT, "BIOMT");
    refuse_text(FILE_PDB, "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n",
                ISO_ERR_FORMAT, "complete");
    refuse_text(FILE_PDB, "REMARK 350   BIOMT9   1  1.000000  0.000000  0.000000        0.00000\n",
                ISO_ERR_FORMAT, "BIOMT");
    iso_glyphs none = read_text(FILE_PDB, "HEADER\nEND\n");
    assert_int_equal(none.count, 0);
    iso_glyphs_free(&none);
}

/* ---- .csv */

static void test_csv(void **state) {
    (void)state;
    iso_glyphs glyphs =
        read_text(FILE_CSV, "\xef\xbb\xbfid, \"kind\" ,X,y,Z,radius,vx,vy,vz,Red,green,blue,w\r\n"
                            "7,pre,1,2,3,0.5,0,0,2,255,128,0,\r\n"
                            "8,\"po,st\", 4 ,5,6,-1,1,0,0,0,0,0,nan\r\n\r\n"
                            "9,pre,,5,6,1,1,0,0,0,0,0,5\r\n");
    assert_int_equal(glyphs.count, 2);
    assert_int_equal(report.dropped, 1);
    assert_int_equal(report.mended_radii, 1);
    check_vector(glyphs.positions[1], 4, 5, 6);
    check_vector(glyphs.directions[0], 0, 0, 2);
    assert_true(glyphs.radii[0] == 0.5f && glyphs.radii[1] == 0);
    assert_int_equal(glyphs.colors[0][1], 128);
    assert_int_equal(glyphs.attribute_count, 3);
    assert_true(find_attribute(&glyphs, "id")->values[1] == 8);
    assert_true(find_attribute(&glyphs, "kind")->values[1] == 1);
    assert_true(isnan(find_attribute(&glyphs, "w")->values[0]));
    assert_non_null(strstr(report.notes[0], "'pre' is 0, 'po,st' is 1"));
    iso_glyphs_free(&glyphs);
    static const char separators[] = ";\t";
    for (int k = 0; k < 2; k++) {
        char text[64];
        snprintf(text, sizeof text, "x%cy%cz\n1%c2%c3\n", separators[k], separators[k], separators[k],
                 separators[k]);
        glyphs = read_text(FILE_CSV, text);
        check_vector(glyphs.positions[0], 1, 2, 3);
        iso_glyphs_free(&glyphs);
    }
    refuse_text(FILE_CSV, "1,2,3\n4,5,6\n", ISO_ERR_FORMAT, "no x");
    refuse_text(FILE_CSV, "x,y,z\n4,5\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_CSV, "x,y,z\n4,5,6,7\n", ISO_ERR_FORMAT, "row 2");
}

/* ---- .ply and .vtk */

/* The half axes of splats: logarithms of lengths along the columns of the quaternion's rotation. */
static void test_ply_splats(void **state) {
    (void)state;
    static const char head[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                               "property float z\nproperty float scale_0\nproperty float scale_1\n"
                               "property float scale_2\nproperty float rot_0\nproperty float rot_1\n"
                               "property float rot_2\nproperty float rot_3\n";
    static const char body[] = "end_header\n0 0 0 0 1 -2 3 0 0 3 0 1 -1\n1 0 0 nan 999 0.5 0 0 0 0 0 0 0\n"
                               "1 1 0 1 1 1 1 1 1 1 0 0 0\n";
    char text[1024];
    snprintf(text, sizeof text, "%sproperty float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n%s",
             head, body);
    iso_glyphs glyphs = read_text(FILE_PLY, text);
    check_vector(glyphs.axes[0], 0, 1, 0); /* a quarter turn about z */
    check_vector(glyphs.axes[0] + 3, -exp(1), 0, 0);
    check_vector(glyphs.axes[0] + 6, 0, 0, exp(-2));
    check_vector(glyphs.axes[1], 0, 0, 0);
    check_vector(glyphs.axes[1] + 6, 0, 0, exp(0.5));
    check_vector(glyphs.axes[2], 0, exp(1), 0); /* x becomes y, y becomes z */
    check_vector(glyphs.axes[2] + 3, 0, 0, exp(1));
    assert_int_equal(report.mended_radii, 2);
    assert_int_equal(glyphs.colors[0][0], 128);
    assert_int_equal(glyphs.colors[0][1], 199);
    assert_int_equal(glyphs.colors[0][2], 56);
    assert_int_equal(glyphs.attribute_count, 0);
    iso_glyphs_free(&glyphs);
    glyphs = read_with(FILE_PLY, (iso_read_opts){.space = ISO_SPACE_RAS});
    check_vector(glyphs.axes[0], 0, -1, 0);
    check_vector(glyphs.axes[0] + 3, exp(1), 0, 0);
    check_vector(glyphs.axes[0] + 6, 0, 0, exp(-2));
    iso_glyphs_free(&glyphs);
    /* without the colours of splats, scales are lengths */
    snprintf(text, sizeof text, "%sproperty float a\nproperty float b\nproperty float c\n%s", head, body);
    glyphs = read_text(FILE_PLY, text);
    check_vector(glyphs.axes[0], 0, 0, 0);
    check_vector(glyphs.axes[0] + 3, -1, 0, 0);
    assert_int_equal(report.mended_radii, 2);
    assert_int_equal(glyphs.attribute_count, 3);
    iso_glyphs_free(&glyphs);
}

/* Gaussians: opacities are logits; the further terms of the colours are not read; without opacities, or with
 * none of the names, a file is not one of Gaussians. */
static void test_ply_gaussians(void **state) {
    (void)state;
    static const char head[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                               "property float z\nproperty float f_dc_0\nproperty float f_dc_1\n"
                               "property float f_dc_2\nproperty float f_rest_0\nproperty float f_rest_1\n"
                               "property float %s\nproperty float scale_0\nproperty float scale_1\n"
                               "property float scale_2\nproperty float rot_0\nproperty float rot_1\n"
                               "property float rot_2\nproperty float rot_3\nend_header\n"
                               "0 0 0 0 9 -9 5 5 0 0 0 0 1 0 0 0\n1 0 0 0 0 0 5 5 2 0 0 0 1 0 0 0\n"
                               "2 0 0 0 0 0 5 5 nan 0 0 0 1 0 0 0\n";
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text, head, k ? "weight" : "opacity");
        iso_glyphs glyphs = read_text(FILE_PLY, text);
        assert_int_equal(glyphs.gaussians, k == 0);
        assert_int_equal(iso_glyphs_are_gaussians(FILE_PLY), k == 0);
        assert_int_equal(glyphs.attribute_count, 1);
        assert_int_equal(glyphs.colors[0][1], 255);
        const float *values = glyphs.attributes[0].values;
        near((double)values[1], k ? 2 : 1 / (1 + exp(-2)), 1e-6);
        near((double)values[0], k ? 0 : 0.5, 1e-6);
        if (k == 0) near((double)values[2], 0, 1e-6);
        iso_glyphs_free(&glyphs);
    }
    assert_false(iso_glyphs_are_gaussians("/nowhere.ply"));
}

static void test_ply_columns(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(
        FILE_PLY,
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n"
        "property double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\n"
        "property float nz\nproperty ushort red\nproperty ushort green\nproperty ushort blue\n"
        "property float radius\nproperty float heat\nend_header\n3 0 1 2\n"
        "5000000.25 0 0 0 0 2 65535 257 0 1 10\n5000001.5 0 0 0 0 nan 0 0 0 -1 11\n"
        "nan 0 0 0 0 1 0 0 0 1 12\n5000002 0 0 0 1 0 0 0 514 2 13\n");
    assert_int_equal(glyphs.count, 3);
    near(glyphs.origin.x + (double)glyphs.positions[0][0], 5000000.25, 0);
    near(glyphs.origin.x + (double)glyphs.positions[1][0], 5000001.5, 0);
    assert_int_equal(glyphs.colors[0][0], 255);
    assert_int_equal(glyphs.colors[0][1], 1);
    assert_int_equal(glyphs.colors[2][2], 2);
    check_vector(glyphs.directions[0], 0, 0, 2);
    check_vector(glyphs.directions[1], 0, 0, 0);
    assert_true(glyphs.radii[2] == 2 && find_attribute(&glyphs, "heat")->values[2] == 13);
    iso_glyphs_free(&glyphs);
    glyphs = read_with(FILE_PLY, (iso_read_opts){.every = 3, .space = ISO_SPACE_RAS});
    assert_int_equal(glyphs.count, 2);
    assert_int_equal(report.items, 4);
    near(glyphs.origin.x + (double)glyphs.positions[1][0], -5000002, 0);
    check_vector(glyphs.directions[1], 0, -1, 0);
    assert_true(find_attribute(&glyphs, "heat")->values[1] == 13);
    iso_glyphs_free(&glyphs);
}

static void test_vtk_points(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(
        FILE_VTK,
        "# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3 4 5 6\n"
        "LINES 1 3\n2 0 1\nVERTICES 1 3\n2 0 1\nCELL_DATA 2\nSCALARS s int\nLOOKUP_TABLE default\n1 2\n"
        "POINT_DATA 2\nNORMALS n float\n0 0 1 0 0 1\nVECTORS v float\n1 2 3 4 5 6\nTENSORS t float\n"
        "1 2 3 4 5 6 7 8 9\n0 0 0 0 0 0 0 0 0\n");
    assert_int_equal(glyphs.count, 2);
    check_vector(glyphs.positions[1], -4, -5, 6);
    check_vector(glyphs.directions[0], -1, -2, 3);
    assert_int_equal(glyphs.attribute_count, 2);
    const float *tensor = find_attribute(&glyphs, "t")->values;
    static const float turned[9] = {1, 2, -3, 4, 5, -6, -7, -8, 9};
    for (int i = 0; i < 9; i++) assert_true(tensor[i] == turned[i]);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_VTK, "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n", ISO_ERR_FORMAT,
                "UNSTRUCTURED_GRID");
}

/* ---- files of other programs */

static void check_row(const index_row *row) {
    static const char *const units[] = {" vert", " points", " atoms"};
    iso_glyphs glyphs = read_with(row->path, (iso_read_opts){.assembly = -1});
    const iso_box box = iso_glyphs_bounds(&glyphs);
    const bool partly = strstr(row->counts, "models") || strstr(row->counts, "frames");
    for (int i = 0; i < 3; i++) {
        long wanted = number_before(row->counts, units[i]);
        if (wanted < 0) continue;
        if (strstr(row->counts, " with NaN")) wanted -= number_before(row->counts, " with NaN");
        if (partly ? (long)glyphs.count > wanted : (long)glyphs.count != wanted)
            fail_msg("%s: %zu glyphs, wanted %s", row->name, glyphs.count, row->counts);
    }
    if (row->has_box && !partly) check_box(row->name, &box, &row->box);
    iso_glyphs_free(&glyphs);
}

static void test_index(void **state) {
    (void)state;
    static const char *const points[] = {"ply", "xyz", "pdb", "vtp", "pcd", "las", "pwn", "off", NULL},
                             *const tables[] = {"csv", NULL};
    assert_true(check_index("points", points, check_row) >= 32);
    assert_int_equal(check_index("lines", tables, check_row), 1);
}

/* Every file is read, if it is not damaged: as the table below says of those in bad/. */
static void test_all_files(void **state) {
    (void)state;
    index_table *table = load_index("points");
    for (int i = 0; i < table->count; i++) {
        const index_row *row = &table->rows[i];
        iso_glyphs glyphs;
        iso_error error = {0};
        const iso_read_opts opts = {.assembly = -1, .normals_from_faces = true};
        const bool good = strncmp(row->name, "bad/", 4) != 0;
        const iso_status status = iso_glyphs_read(row->path, &opts, &glyphs, &error);
        if (status == ISO_OK)
            iso_glyphs_free(&glyphs);
        else if (good || !strstr(error.text, row->path) || strchr(error.text, '\n'))
            fail_msg("%s", error.text);
    }
    free(table);
}

static const struct {
    const char *name;
    iso_status status;
    const char *reason;
    size_t count;
    int dropped, mended, notes;
} odd[] = {
    {"autzen.pts", ISO_OK, NULL, 10, 0, 0, 1},
    {"bunny_8.pts", ISO_OK, NULL, 8, 0, 0, 1},
    {"all_equal.ply", ISO_OK, NULL, 2000, 0, 0, 0},
    {"altloc.pdb", ISO_OK, NULL, 2, 0, 0, 1},
    {"blobby_zero_normals.xyz", ISO_OK, NULL, 3288, 0, 0, 1},
    {"count_huge.ply", ISO_ERR_IO, "truncated", 0, 0, 0, 0},
    {"count_lies.ply", ISO_ERR_IO, "truncated", 0, 0, 0, 0},
    {"count_lies.xyz", ISO_ERR_IO, "truncated", 0, 0, 0, 0},
    {"crlf_ascii.ply", ISO_OK, NULL, 2, 0, 0, 0},
    {"faces_without_points.ply", ISO_ERR_FORMAT, "no points", 0, 0, 0, 0},
    {"hybrid36.pdb", ISO_OK, NULL, 3, 0, 0, 0},
    {"list_in_vertex.ply", ISO_OK, NULL, 2, 0, 0, 0},
    {"lists_before_vertices.ply", ISO_OK, NULL, 2000, 0, 0, 0},
    {"missingheader.pcd", ISO_ERR_FORMAT, "PCD header", 0, 0, 0, 0},
    {"no_vertex.ply", ISO_ERR_FORMAT, "no points", 0, 0, 0, 0},
    {"plot3d-multi-ascii.xyz", ISO_ERR_FORMAT, "not an atom", 0, 0, 0, 0},
    {"positions_nan_in_part.ply", ISO_OK, NULL, 1818, 182, 0, 0},
    {"radius_zero_negative_huge_nan.ply", ISO_OK, NULL, 2000, 0, 2, 0},
    {"short_lines.pdb", ISO_ERR_FORMAT, "row 2", 0, 0, 0, 0},
    {"unknown_element.xyz", ISO_OK, NULL, 3, 0, 0, 1},
    {"utm17_comma.pcd", ISO_OK, NULL, 10, 0, 0, 0},
    {"utm17_tab.pcd", ISO_OK, NULL, 10, 0, 0, 0},
    {"unsized_dims.ply", ISO_ERR_FORMAT, "no z", 0, 0, 0, 0},
};

static void test_odd_files(void **state) {
    (void)state;
    free(load_index("points")); /* skips when there are none */
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        char name[128];
        snprintf(name, sizeof name, "bad/%s", odd[i].name);
        const char *path = index_path("points", name);
        if (odd[i].status != ISO_OK) {
            refuse(path, (iso_read_opts){0}, odd[i].status, odd[i].reason);
            continue;
        }
        iso_glyphs glyphs = read_with(path, (iso_read_opts){0});
        if (glyphs.count != odd[i].count || (int)report.dropped != odd[i].dropped ||
            (int)report.mended_radii != odd[i].mended || report.note_count != odd[i].notes)
            fail_msg("%s: %zu glyphs, %d dropped, %d mended, %d notes", name, glyphs.count,
                     (int)report.dropped, (int)report.mended_radii, report.note_count);
        iso_glyphs_free(&glyphs);
    }
}

static double distance(const iso_glyphs *glyphs, size_t a, size_t b) {
    const float *p = glyphs->positions[a], *q = glyphs->positions[b];
    return iso_vec3_length(
        iso_vec3_make((double)(p[0] - q[0]), (double)(p[1] - q[1]), (double)(p[2] - q[2])));
}

/* A capsid of 16 million atoms: every copy has the shape of the first; and the limit of memory holds. */
static void test_capsid(void **state) {
    (void)state;
    free(load_index("points")); /* skips when there are none */
    const char *path = index_path("points", "molecules/1M4X.pdb");
    iso_glyphs glyphs = read_with(path, (iso_read_opts){0});
    enum { ATOMS = 9693, COPIES = 1680 };
    assert_int_equal(glyphs.count, ATOMS * COPIES);
    for (size_t copy = 0; copy < COPIES; copy++)
        for (size_t i = 1; i < ATOMS; i += 97)
            near(distance(&glyphs, copy * ATOMS, copy * ATOMS + i), distance(&glyphs, 0, i), 2e-3);
    iso_glyphs_free(&glyphs);
    refuse(path, (iso_read_opts){.max_memory = 200000000}, ISO_ERR_LIMIT, "--max-memory");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_xyz_molecule),
        cmocka_unit_test(test_xyz_points),
        cmocka_unit_test(test_pdb_elements),
        cmocka_unit_test(test_pdb_locations),
        cmocka_unit_test(test_pdb_assemblies),
        cmocka_unit_test(test_pdb_errors),
        cmocka_unit_test(test_csv),
        cmocka_unit_test(test_ply_splats),
        cmocka_unit_test(test_ply_gaussians),
        cmocka_unit_test(test_ply_columns),
        cmocka_unit_test(test_vtk_points),
        cmocka_unit_test(test_index),
        cmocka_unit_test(test_all_files),
        cmocka_unit_test(test_odd_files),
        cmocka_unit_test(test_capsid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
