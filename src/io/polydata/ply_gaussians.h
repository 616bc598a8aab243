/* ply_gaussians: 3-D Gaussians in the packed form of .ply that PlayCanvas and SuperSplat write
 * (".compressed.ply"). Internal to src/io. */
#ifndef ISO_IO_POLYDATA_PLY_GAUSSIANS_H
#define ISO_IO_POLYDATA_PLY_GAUSSIANS_H

#include "io/common/ply.h"
#include "io/polydata/polydata.h"

/* Whether the header names elements "chunk" and "vertex" whose vertices are packed. */
bool iso_ply_packs_gaussians(const iso_ply *ply);

/* Reads the Gaussians of such a file, whose first element is read next, as columns "scale", "rot", "colors"
 * and "opacity". ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_ply_read_packed_gaussians(iso_ply *ply, iso_polydata *data, iso_error *error);

#endif
