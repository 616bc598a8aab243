/* level_set_vdb: writes an hgrid as OpenVDB's level set (iso_level_set_writer of grids/volume/module.h). */
#ifndef ISO_GRIDS_VOLUME_LEVEL_SET_VDB_HPP
#define ISO_GRIDS_VOLUME_LEVEL_SET_VDB_HPP

#include <cstdio>

#include "grids/level_set.h"

iso_status iso_vdb_write_level_set(FILE *stream, const char *path, const iso_hgrid *grid, const char *name,
                                   const iso_level_set_colors *colors, const iso_progress *progress,
                                   iso_error *error);

#endif
