/* chgcar_header: the beginning of VASP's densities, which hold a cell, its atoms and voxels. */
#ifndef ISO_GRIDS_VOLUME_CHGCAR_HEADER_H
#define ISO_GRIDS_VOLUME_CHGCAR_HEADER_H

#include "grids/volume/cube_header.h"

enum { ISO_CHGCAR_KINDS = 64 };
typedef struct iso_chgcar_header {
    iso_vec3 cell[3]; /* edges, in angstrom */
    double scale;     /* of positions that are cartesian */
    bool cartesian;   /* else in edges of the cell */
    int kinds;        /* of atoms, which follow each other */
    char names[ISO_CHGCAR_KINDS][4];
    long counts[ISO_CHGCAR_KINDS];
    long atoms; /* all of them */
} iso_chgcar_header;

/* Reads up to the rows of the atoms. ISO_ERR_FORMAT, ISO_ERR_IO. */
iso_status iso_chgcar_read_header(iso_cube_file *file, iso_chgcar_header *header, iso_error *error);

#endif
