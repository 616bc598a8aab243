/* cube: the atoms of Gaussian's cube files (grids/volume/format_cube.c reads their voxels): rows of atomic
 * number, charge and position, in bohr, or in angstrom if the number of voxels is negative. */
#include <stdio.h>
#include <stdlib.h>

#include "grids/volume/cube_header.h"
#include "io/glyphs/atoms.h"
#include "io/glyphs/elements.h"

static iso_status read_atoms(iso_cube_file *f, iso_polydata *data, iso_error *error) {
    iso_cube_header header;
    iso_atoms atoms;
    ISO_TRY(iso_cube_read_header(f, &header, error));
    ISO_TRY(iso_atoms_begin(data, (size_t)header.atoms, &atoms, error));
    for (long i = 0; i < header.atoms; i++) {
        double number, charge, position[3];
        ISO_TRY(iso_cube_next_line(f, error));
        if (sscanf(f->line, "%lf %lf %lf %lf %lf", &number, &charge, &position[0], &position[1],
                   &position[2]) != 5)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: atom %ld is no row of five numbers", f->path, i + 1);
        for (int axis = 0; axis < 3; axis++) position[axis] *= header.unit;
        iso_atoms_add(&atoms, iso_element_of_number(number), position);
    }
    iso_atoms_end(&atoms);
    return ISO_OK;
}

iso_status iso_polydata_read_cube(iso_polydata *data, iso_error *error) {
    return iso_atoms_read(data, read_atoms, error);
}
