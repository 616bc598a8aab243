/* atoms: the atoms of files that state elements and positions in angstrom, as points with radii and colours.
 * Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_ATOMS_H
#define ISO_IO_GLYPHS_ATOMS_H

#include "grids/volume/cube_header.h"
#include "io/polydata/polydata.h"

typedef struct iso_atoms {
    iso_polydata *data; /* borrowed */
    float *radii, *colors;
    size_t count;
    uint64_t unknown; /* elements */
} iso_atoms;

/* Makes room for `count` atoms in `data`, which has no points yet. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_atoms_begin(iso_polydata *data, size_t count, iso_atoms *atoms, iso_error *error);
/* Adds one of an element (io/glyphs/elements.h; 0: unknown). */
void iso_atoms_add(iso_atoms *atoms, int element, const double position[3]);
/* Notes what is unknown, and states the unit. */
void iso_atoms_end(const iso_atoms *atoms);

/* Reads a file of a volume whose header has atoms: `read` takes them from its lines. */
iso_status iso_atoms_read(iso_polydata *data,
                          iso_status (*read)(iso_cube_file *file, iso_polydata *data, iso_error *error),
                          iso_error *error);

#endif
