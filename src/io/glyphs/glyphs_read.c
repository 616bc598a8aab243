/* glyphs_read: the table of formats of glyphs. */
#define _POSIX_C_SOURCE 200809L
#include "io/glyphs/glyphs_read.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/text.h"
#include "io/encode.h"
#include "io/glyphs/glyphs_format.h"

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
    struct stat status;
    FILE *file = stat(path, &status) == 0 && S_ISREG(status.st_mode) ? fopen(path, "rb") : NULL;
    if (!file) return false;
    head[fread(head, 1, sizeof head - 1, file)] = 0;
    fclose(file);
    if (iso_text_has_extension(path, ".xyz")) return !begins_with_count(head);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (iso_text_has_extension(path, endings[i])) return true;
    return strncmp(head, "ply", 3) == 0 && (head[3] == '\n' || head[3] == '\r');
}
