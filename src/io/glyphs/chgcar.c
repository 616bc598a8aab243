/* chgcar: the atoms of VASP's densities (grids/volume/format_chgcar.c reads their voxels). */
#include <stdio.h>
#include <string.h>

#include "grids/volume/chgcar_header.h"
#include "io/glyphs/atoms.h"
#include "io/glyphs/elements.h"

static iso_status read_atom(iso_cube_file *f, const iso_chgcar_header *header, int kind, iso_atoms *atoms,
                            iso_error *error) {
    double p[3];
    ISO_TRY(iso_cube_next_line(f, error));
    if (sscanf(f->line, "%lf %lf %lf", &p[0], &p[1], &p[2]) != 3)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: atom %zu is no row of three numbers", f->path,
                        atoms->count + 1);
    iso_vec3 at = iso_vec3_scale(iso_vec3_make(p[0], p[1], p[2]), header->scale);
    if (!header->cartesian) {
        at = iso_vec3_scale(header->cell[0], p[0]);
        for (int i = 1; i < 3; i++) at = iso_vec3_add(at, iso_vec3_scale(header->cell[i], p[i]));
    }
    const double position[3] = {at.x, at.y, at.z};
    const char *name = header->names[kind];
    iso_atoms_add(atoms, iso_element_of(name, (int)strcspn(name, "_/.0123456789")), position);
    return ISO_OK;
}

static iso_status read_atoms(iso_cube_file *f, iso_polydata *data, iso_error *error) {
    iso_chgcar_header header;
    iso_atoms atoms;
    ISO_TRY(iso_chgcar_read_header(f, &header, error));
    ISO_TRY(iso_atoms_begin(data, (size_t)header.atoms, &atoms, error));
    for (int kind = 0; kind < header.kinds; kind++)
        for (long i = 0; i < header.counts[kind]; i++) ISO_TRY(read_atom(f, &header, kind, &atoms, error));
    iso_atoms_end(&atoms);
    return ISO_OK;
}

iso_status iso_polydata_read_chgcar(iso_polydata *data, iso_error *error) {
    return iso_atoms_read(data, read_atoms, error);
}
