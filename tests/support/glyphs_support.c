/* glyphs_support: reading and checking glyphs. */
#include "glyphs_support.h"

#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "file_support.h"

iso_read_report report;

iso_glyphs read_with(const char *path, iso_read_opts opts) {
    iso_glyphs glyphs;
    iso_error error = {0};
    opts.report = &report;
    test_ok(iso_glyphs_read(path, &opts, &glyphs, &error), &error);
    return glyphs;
}

iso_glyphs read_text(const char *path, const char *text) {
    spill(path, text, strlen(text));
    return read_with(path, (iso_read_opts){0});
}

void refuse(const char *path, iso_read_opts opts, iso_status wanted, const char *reason) {
    iso_glyphs glyphs;
    iso_error error = {0};
    const iso_status status = iso_glyphs_read(path, &opts, &glyphs, &error);
    if (status != wanted || !strstr(error.text, path) || !strstr(error.text, reason))
        fail_msg("%s: status %d, wanted %d with \"%s\": %s", path, status, wanted, reason, error.text);
}

void refuse_text(const char *path, const char *text, iso_status status, const char *reason) {
    spill(path, text, strlen(text));
    refuse(path, (iso_read_opts){0}, status, reason);
}

const iso_attribute *find_attribute(const iso_glyphs *glyphs, const char *name) {
    for (int i = 0; i < glyphs->attribute_count; i++)
        if (strcmp(glyphs->attributes[i].name, name) == 0) return &glyphs->attributes[i];
    fail_msg("no attribute %s", name);
    return NULL;
}

void check_vector(const float got[3], double x, double y, double z) {
    near((double)got[0], x, 1e-6);
    near((double)got[1], y, 1e-6);
    near((double)got[2], z, 1e-6);
}

void check_place(const iso_glyphs *glyphs, size_t glyph, double x, double y, double z, double tolerance) {
    const float *p = glyphs->positions[glyph];
    near(glyphs->origin.x + (double)p[0], x, tolerance);
    near(glyphs->origin.y + (double)p[1], y, tolerance);
    near(glyphs->origin.z + (double)p[2], z, tolerance);
}

void read_truncated(const char *path, const void *bytes, size_t count, iso_read_opts opts) {
    for (size_t length = 0; length < count; length++) {
        iso_glyphs glyphs;
        iso_error error = {0};
        spill(path, bytes, length);
        if (iso_glyphs_read(path, &opts, &glyphs, &error) == ISO_OK)
            iso_glyphs_free(&glyphs);
        else if (!strstr(error.text, path) || strchr(error.text, '\n'))
            fail_msg("%zu of %zu bytes: %s", length, count, error.text);
    }
}
