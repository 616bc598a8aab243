/* glyphs_read: finds the reader of a file of glyphs. */
#include "io/glyphs/glyphs_read.h"

#include <string.h>

#include "base/decimal_point.h"
#include "base/memory.h"
#include "io/common/ply.h"
#include "io/polydata/ply_gaussians.h"
#include "io/polydata/polydata.h"

typedef iso_status read_fn(iso_polydata *data, iso_error *error);

static read_fn *reader_of(iso_file_type type) {
    switch (type) {
#define GLYPHS(reader) return iso_polydata_read_##reader;
#include "base/file_types.inc"
    default:
        break;
    }
    return NULL;
}

iso_status iso_glyphs_read(const char *path, const iso_read_opts *opts, iso_glyphs *glyphs,
                           iso_error *error) {
    iso_read_report unused;
    iso_reading reading = iso_reading_begin(path, opts, &unused);
    iso_polydata data = {.reading = &reading, .points_only = true};
    iso_file_type type;
    ISO_TRY(iso_reading_find_type(&reading, ISO_HOLDS_GLYPHS, "glyphs", &type, error));
    void *numbers = iso_decimal_point_begin();
    iso_status status = reader_of(type)(&data, error);
    if (status == ISO_OK) status = iso_polydata_to_glyphs(&data, glyphs, error);
    iso_polydata_free(&data);
    iso_decimal_point_end(numbers);
    return status;
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
