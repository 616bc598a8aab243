/* glyphs_read: the table of formats of glyphs. */
#include "io/glyphs/glyphs_read.h"

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
