/* fuzz: any bytes as a file of lines: the first byte chooses the format, every how many lines are kept, and
 * the space. What a reader accepts must be sound; what it refuses must be refused in one line that names the
 * file. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/lines/lines_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static double total; /* so that every value is read */

static void check_vectors(const float (*vectors)[3], size_t count) {
    for (size_t i = 0; vectors && i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (!isfinite(vectors[i][axis])) abort();
}

static void check_lines(const iso_lines *lines) {
    if (lines->starts[0] != 0 || lines->starts[lines->line_count] != lines->vertex_count) abort();
    for (size_t i = 0; i < lines->line_count; i++)
        if (lines->starts[i] >= lines->starts[i + 1]) abort();
    if (!iso_vec3_is_finite(lines->origin)) abort();
    check_vectors((const float(*)[3])lines->vertices, lines->vertex_count);
    check_vectors((const float(*)[3])lines->normals, lines->vertex_count);
    for (size_t i = 0; lines->radii && i < lines->vertex_count; i++)
        if (!(lines->radii[i] >= 0 && lines->radii[i] <= 1e12f)) abort();
    for (size_t i = 0; lines->colors && i < lines->vertex_count; i++) total += lines->colors[i][2];
    for (int a = 0; a < lines->attribute_count; a++) {
        const iso_attribute *attribute = &lines->attributes[a];
        const size_t items = attribute->per_line ? lines->line_count : lines->vertex_count;
        if (attribute->components < 1 || !*attribute->name) abort();
        for (size_t i = 0; i < items * (size_t)attribute->components; i++)
            total += (double)attribute->values[i];
        for (int b = 0; b < a; b++)
            if (strcmp(lines->attributes[b].name, attribute->name) == 0) abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const suffixes[] = {"tck", "trk", "vtk", "ply", "swc", "obj", "trx"};
    if (size < 1) return 0;
    char memory[64], path[64];
    int descriptor = memfd_create("fuzz_lines", 0);
    if (descriptor < 0 || write(descriptor, data + 1, size - 1) != (ssize_t)(size - 1)) abort();
    snprintf(memory, sizeof memory, "/proc/self/fd/%d", descriptor);
    snprintf(path, sizeof path, "/tmp/fuzz_lines_%d.%s", (int)getpid(), suffixes[data[0] % 7]);
    unlink(path);
    if (symlink(memory, path)) abort(); /* (the name says what it is) */
    const int choice = data[0] / 7;
    iso_read_report report;
    const iso_read_opts opts = {
        .max_memory = 1 << 26, .every = choice % 4, .space = choice / 4 % 3, .report = &report};
    iso_lines lines;
    iso_error error = {0};
    if (iso_lines_read(path, &opts, &lines, &error) == ISO_OK) {
        check_lines(&lines);
        iso_lines_free(&lines);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort(); /* every error is one line that names the file */
    unlink(path);
    close(descriptor);
    return 0;
}
