/* lines_read: the table of formats of lines, and how a file's format is found. */
#include "io/lines/lines_read.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "io/encode.h"
#include "io/lines/lines_format.h"

typedef iso_status read_fn(iso_reading *reading, iso_lines *lines, iso_error *error);

/* `magic`: what files of the format begin with, whatever their name; NULL: only the name tells. */
typedef struct lines_format {
    const char *name, *suffix, *magic;
    read_fn *read;
} lines_format;

static const lines_format formats[] = {
    {"tck", ".tck", "mrtrix track", iso_lines_read_tck},
    {"trk", ".trk", "TRACK", iso_lines_read_trk},
    {"vtk", ".vtk", "# vtk DataFile", iso_lines_read_vtk},
    {"ply", ".ply", "ply", iso_lines_read_ply},
    {"swc", ".swc", NULL, iso_lines_read_swc},
    {"obj", ".obj", NULL, iso_lines_read_obj},
};
enum { FORMATS = sizeof formats / sizeof *formats };

static const lines_format *format_of_content(const char *path) {
    char head[32] = "";
    FILE *file;
    if (iso_file_open(path, &file, NULL, NULL) != ISO_OK) return NULL;
    const size_t count = fread(head, 1, sizeof head, file);
    fclose(file);
    for (int i = 0; i < FORMATS; i++) {
        const size_t length = formats[i].magic ? strlen(formats[i].magic) : 0;
        if (length && count >= length && memcmp(head, formats[i].magic, length) == 0) return &formats[i];
    }
    return NULL;
}

static const lines_format *format_of(const char *path) {
    const lines_format *format = format_of_content(path);
    for (int i = 0; i < FORMATS && !format; i++)
        if (iso_text_has_extension(path, formats[i].suffix)) format = &formats[i];
    return format;
}

iso_status iso_lines_read(const char *path, const iso_read_opts *opts, iso_lines *lines, iso_error *error) {
    iso_read_report unused;
    iso_reading reading = iso_reading_begin(path, opts, &unused);
    const lines_format *format = format_of(path);
    if (!format) {
        FILE *file;
        ISO_TRY(iso_file_open(path, &file, NULL, error)); /* a missing file is not of a wrong format */
        fclose(file);
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a file of lines that isopoint can read", path);
    }
    snprintf(reading.report->format, sizeof reading.report->format, "%s", format->name);
    void *numbers = iso_encode_numbers_begin();
    iso_status status = format->read(&reading, lines, error);
    iso_encode_numbers_end(numbers);
    return status;
}
