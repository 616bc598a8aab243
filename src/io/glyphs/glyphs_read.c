/* glyphs_read: the table of formats of glyphs. */
#define _POSIX_C_SOURCE 200809L
#include "io/glyphs/glyphs_read.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "grids/volume/npy_header.h"
#include "io/common/encode.h"
#include "io/common/ply.h"
#include "io/glyphs/glyphs_format.h"
#include "io/polydata/ply_gaussians.h"
#include "io/polydata/polydata.h"

/* The rows of both tables are the same formats. */
static const iso_format_name names[] = {
    {"ply", ".ply", "ply"},      {"vtk", ".vtk", "# vtk DataFile"},
    {"xyz", ".xyz", NULL},       {"pdb", ".pdb", NULL},
    {"pdb", ".ent", NULL},       {"csv", ".csv", NULL},
    {"vtp", ".vtp", "<VTKFile"}, {"vtp", ".vtp", "<?xml"},
    {"pcd", ".pcd", "# .PCD"},   {"las", ".las", "LASF"},
    {"las", ".laz", NULL},       {"npy", ".npy", "\x93NUMPY"},
    {"pts", ".pts", NULL},       {"pwn", ".pwn", NULL},
    {"asc", ".asc", NULL},       {"txt", ".txt", NULL},
    {"off", ".off", NULL},       {"obj", ".obj", NULL},
};
static iso_status (*const readers[])(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) = {
    iso_glyphs_read_ply,  iso_glyphs_read_vtk,  iso_glyphs_read_xyz,  iso_glyphs_read_pdb,
    iso_glyphs_read_pdb,  iso_glyphs_read_csv,  iso_glyphs_read_vtp,  iso_glyphs_read_vtp,
    iso_glyphs_read_pcd,  iso_glyphs_read_las,  iso_glyphs_read_las,  iso_glyphs_read_npy,
    iso_glyphs_read_rows, iso_glyphs_read_rows, iso_glyphs_read_rows, iso_glyphs_read_rows,
    iso_glyphs_read_off,  iso_glyphs_read_obj,
};

iso_status iso_glyphs_read(const char *path, const iso_read_opts *opts, iso_glyphs *glyphs,
                           iso_error *error) {
    iso_read_report unused;
    iso_reading reading = iso_reading_begin(path, opts, &unused);
    int format;
    ISO_TRY(iso_reading_find_format(&reading, names, sizeof names / sizeof *names, "glyphs", &format, error));
    void *numbers = iso_encode_numbers_begin();
    iso_status status = readers[format](&reading, glyphs, error);
    iso_encode_numbers_end(numbers);
    return status;
}

bool iso_glyphs_have_rows(const char *path) {
    static const char *const endings[] = {".xyz", ".pts", ".pwn", ".asc", ".txt", ".csv", ".npy"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (iso_text_has_extension(path, endings[i])) return true;
    return false;
}

static bool has_property(const iso_ply *ply, const iso_ply_element *element, const char *name) {
    for (int i = 0; i < element->property_count; i++)
        if (strcmp(ply->properties[element->first_property + i].name, name) == 0) return true;
    return false;
}

static bool has_gaussians(const iso_ply *ply) {
    static const char *const wanted[] = {"f_dc_0", "f_dc_1", "f_dc_2", "scale_0", "scale_1",
                                         "rot_0",  "rot_1",  "rot_2",  "rot_3",   "opacity"};
    if (iso_ply_packs_gaussians(ply)) return true;
    for (int i = 0; i < ply->element_count; i++) {
        if (strcmp(ply->elements[i].name, "vertex") != 0) continue;
        for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++)
            if (!has_property(ply, &ply->elements[i], wanted[k])) return false;
        return true;
    }
    return false;
}

bool iso_glyphs_are_gaussians(const char *path) {
    iso_ply *ply = iso_alloc_zero(1, sizeof *ply);
    const bool are = ply && iso_ply_open(path, ply, NULL) == ISO_OK && has_gaussians(ply);
    if (ply) iso_ply_close(ply);
    iso_free(ply);
    return are;
}

bool iso_glyphs_fill_vtp(const char *path) {
    return iso_vtp_find_cells(path) == ISO_VTP_POINTS;
}

/* Whether the text of a .xyz file begins as molecules do: with a row of one whole number. */
static bool begins_with_count(const char *text) {
    while (isspace((unsigned char)*text)) text++;
    const size_t digits = strspn(text, "0123456789");
    text += digits;
    return digits && text[strspn(text, " \t\r")] == '\n';
}

bool iso_glyphs_are_points(const char *path) {
    static const char *const endings[] = {".ply", ".pcd", ".las", ".laz", ".npy", ".pts",
                                          ".pwn", ".asc", ".txt", ".off", ".obj"};
    char head[256] = "";
    const size_t bytes = iso_file_head(path, head, sizeof head - 1);
    if (!bytes) return false;
    if (iso_text_has_extension(path, ".xyz")) return !begins_with_count(head + iso_text_mark(head, bytes));
    if (iso_text_has_extension(path, ".npy") && iso_npy_axes(path) > 2) return false; /* a volume */
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (iso_text_has_extension(path, endings[i])) return true;
    return strncmp(head, "ply", 3) == 0 && (head[3] == '\n' || head[3] == '\r');
}
