/* cube_header: the beginning of Gaussian's cube files, which hold voxels and atoms. */
#ifndef ISO_GRIDS_VOLUME_CUBE_HEADER_H
#define ISO_GRIDS_VOLUME_CUBE_HEADER_H

#include <stdint.h>
#include <stdio.h>

#include "base/geometry.h"

typedef struct iso_cube_file {
    const char *path;
    FILE *stream; /* borrowed */
    char line[512];
} iso_cube_file;

typedef struct iso_cube_header {
    long atoms;
    bool has_orbitals; /* their number and names follow the atoms */
    long values;       /* of each voxel, if they do not */
    uint64_t dims[3];  /* as a grid has them: its first axis is the file's last one */
    iso_vec3 origin, steps[3];
    double unit; /* of all lengths, in angstrom */
} iso_cube_header;

/* Reads up to the rows of the atoms. ISO_ERR_FORMAT, ISO_ERR_IO. */
iso_status iso_cube_read_header(iso_cube_file *file, iso_cube_header *header, iso_error *error);
/* Reads the next line to file->line, cut. ISO_ERR_IO at the end of the file. */
iso_status iso_cube_next_line(iso_cube_file *file, iso_error *error);

#endif
