/* lines_read: the table of formats of lines. */
#define _GNU_SOURCE /* strcasestr */
#include "io/lines/lines_read.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "io/common/encode.h"
#include "io/lines/lines_format.h"

typedef iso_status read_fn(iso_reading *reading, iso_lines *lines, iso_error *error);

static const iso_format_name names[] = {
    {"tck", ".tck", "mrtrix track"}, {"trk", ".trk", "TRACK"}, {"vtk", ".vtk", "# vtk DataFile"},
    {"ply", ".ply", "ply"},          {"swc", ".swc", NULL},    {"obj", ".obj", NULL},
    {"vtp", ".vtp", "<VTKFile"},     {"vtp", ".vtp", "<?xml"}};
static read_fn *const readers[] = {iso_lines_read_tck, iso_lines_read_trk, iso_lines_read_vtk,
                                   iso_lines_read_ply, iso_lines_read_swc, iso_lines_read_obj,
                                   iso_lines_read_vtp, iso_lines_read_vtp};

iso_status iso_lines_read(const char *path, const iso_read_opts *opts, iso_lines *lines, iso_error *error) {
    iso_read_report unused;
    iso_reading reading = iso_reading_begin(path, opts, &unused);
    int format;
    ISO_TRY(iso_reading_find_format(&reading, names, sizeof names / sizeof *names, "lines", &format, error));
    void *numbers = iso_encode_numbers_begin();
    iso_status status = readers[format](&reading, lines, error);
    iso_encode_numbers_end(numbers);
    return status;
}

bool iso_lines_fill_vtk(const char *path) {
    char head[1024];
    head[iso_file_head(path, head, sizeof head - 1)] = 0;
    return strncmp(head, "# vtk DataFile", 14) == 0 && strcasestr(head, "\nDATASET POLYDATA");
}
