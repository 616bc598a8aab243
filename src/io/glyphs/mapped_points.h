/* mapped_points: the points of a binary .ply file, read from where the file is mapped into memory, as often
 * as they are needed. For files that need no conversion: reading them with iso_glyphs_read takes a copy of
 * all points, and most of its time goes into new memory for it. */
#ifndef ISO_IO_GLYPHS_MAPPED_POINTS_H
#define ISO_IO_GLYPHS_MAPPED_POINTS_H

#include "clouds/point_source.h"
#include "grids/volume/mapping.h"
#include "io/common/read_opts.h"

/* iso_mapped_points_close when done. */
typedef struct iso_mapped_points {
    iso_point_source source;
    iso_point_survey survey; /* of all points */
    iso_mapping *mapping;
} iso_mapped_points;

/* Opens a file if its points are stored as isopoint keeps them: little-endian floats x y z and nx ny nz, in
 * this order, and uchar red green blue if there are colours; if all positions are finite and at most 1e12 mm,
 * no normal is 0, and iso_glyphs_read would leave out neither points at 0 0 0 nor the colours. Further
 * numbers are ignored, but not a radius, alpha, vx vy vz, or those of Gaussians. `opts`: as for
 * iso_glyphs_read; the report is set. `pool`: for looking at the points, or NULL.
 *
 * False: anything else, also a damaged file or one over the limit of memory, for which iso_glyphs_read has a
 * message. A file that becomes shorter while it is open ends the program (SIGBUS). */
bool iso_mapped_points_open(const char *path, const iso_read_opts *opts, iso_pool *pool,
                            iso_mapped_points *points);
void iso_mapped_points_close(iso_mapped_points *points);

#endif
