#include "io/glyphs/atoms.h"

#include "base/file.h"
#include "io/glyphs/elements.h"

iso_status iso_atoms_begin(iso_polydata *data, size_t count, iso_atoms *atoms, iso_error *error) {
    int radius, colors;
    ISO_TRY(iso_polydata_add_column(data, "radius", 1, false, ISO_ROLE_RADIUS, &radius, error));
    ISO_TRY(iso_polydata_add_column(data, "colors", 3, false, ISO_ROLE_COLOR, &colors, error));
    ISO_TRY(iso_polydata_reserve(data, count, error));
    *atoms = (iso_atoms){.data = data,
                         .radii = iso_polydata_column(data, radius)->values.data,
                         .colors = iso_polydata_column(data, colors)->values.data};
    return ISO_OK;
}

void iso_atoms_add(iso_atoms *atoms, int element, const double position[3]) {
    const size_t at = atoms->count++;
    uint8_t color[3];
    atoms->unknown += element == 0;
    atoms->radii[at] = iso_element_radius(element);
    iso_element_color(element, color);
    for (int k = 0; k < 3; k++) atoms->colors[3 * at + (size_t)k] = color[k];
    iso_polydata_add_point(atoms->data, position);
}

void iso_atoms_end(const iso_atoms *atoms) {
    iso_reading *reading = atoms->data->reading;
    if (atoms->unknown)
        iso_reading_note(reading, "%llu atoms are of unknown elements", (unsigned long long)atoms->unknown);
    reading->opts.every = 1;
    reading->report->unit = ISO_WORLD_UNIT_ANGSTROM;
}

iso_status iso_atoms_read(iso_polydata *data,
                          iso_status (*read)(iso_cube_file *file, iso_polydata *data, iso_error *error),
                          iso_error *error) {
    iso_cube_file file = {.path = data->reading->path};
    ISO_TRY(iso_file_open(file.path, &file.stream, NULL, error));
    const iso_status status = read(&file, data, error);
    fclose(file.stream);
    return status;
}
