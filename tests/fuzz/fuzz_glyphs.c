/* fuzz: any bytes as a file of glyphs: the first byte chooses the format (of those that are not found from
 * the content), every how many glyphs are kept, the space, and the assembly. What a reader accepts must be
 * sound; what it refuses must be refused in one line that names the file. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "io/glyphs/glyphs_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static double total; /* so that every value is read */

static void check_floats(const float *values, size_t count) {
    for (size_t i = 0; values && i < count; i++)
        if (!isfinite(values[i])) abort();
}

static void check_glyphs(const iso_glyphs *glyphs) {
    if (!iso_vec3_is_finite(glyphs->origin)) abort();
    check_floats((const float *)glyphs->positions, 3 * glyphs->count);
    check_floats((const float *)glyphs->directions, 3 * glyphs->count);
    check_floats((const float *)glyphs->axes, 9 * glyphs->count);
    for (size_t i = 0; glyphs->radii && i < glyphs->count; i++)
        if (!(glyphs->radii[i] >= 0 && glyphs->radii[i] <= 1e12f)) abort();
    for (size_t i = 0; glyphs->colors && i < glyphs->count; i++) total += glyphs->colors[i][2];
    for (int a = 0; a < glyphs->attribute_count; a++) {
        const iso_attribute *attribute = &glyphs->attributes[a];
        if (attribute->components < 1 || attribute->per_line || !*attribute->name) abort();
        for (size_t i = 0; i < glyphs->count * (size_t)attribute->components; i++)
            total += (double)attribute->values[i];
    }
}

/* Gives the pages of an E57 file the checksums that they need, so that what lies in them is read. */
static void seal_pages(uint8_t *bytes, size_t size) {
    enum { PAGE = 1024 };
    if (size < 8 || memcmp(bytes, "ASTM-E57", 8) != 0) return;
    for (uint8_t *page = bytes; page + PAGE <= bytes + size; page += PAGE) {
        const uint32_t sum = iso_crc32c(0, page, PAGE - 4);
        for (int i = 0; i < 4; i++) page[PAGE - 4 + i] = (uint8_t)(sum >> (24 - 8 * i));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const suffixes[] = {"xyz", "pdb", "csv", "off", "pts", "pwn", "obj", "ptx"};
    if (size < 1) return 0;
    char memory[64], path[64];
    uint8_t *file = malloc(size);
    if (!file) abort();
    memcpy(file, data + 1, size - 1);
    seal_pages(file, size - 1);
    int descriptor = memfd_create("fuzz_glyphs", 0);
    if (descriptor < 0 || write(descriptor, file, size - 1) != (ssize_t)(size - 1)) abort();
    free(file);
    snprintf(memory, sizeof memory, "/proc/self/fd/%d", descriptor);
    snprintf(path, sizeof path, "/tmp/fuzz_glyphs_%d.%s", (int)getpid(),
             data[0] == 0x81 ? "cif" : suffixes[data[0] % 8]);
    unlink(path);
    if (symlink(memory, path)) abort(); /* (the name says what it is) */
    const int choice = data[0] / 8;
    iso_read_report report;
    const iso_read_opts opts = {.max_memory = 1 << 26,
                                .every = choice % 3,
                                .space = choice / 3 % 3,
                                .assembly = choice / 9 % 4 - 1,
                                .normals_from_faces = choice % 2,
                                .report = &report};
    iso_glyphs glyphs;
    iso_error error = {0};
    if (iso_glyphs_read(path, &opts, &glyphs, &error) == ISO_OK) {
        check_glyphs(&glyphs);
        iso_glyphs_free(&glyphs);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort(); /* every error is one line that names the file */
    unlink(path);
    close(descriptor);
    return 0;
}
