/* placements_read: reads where instances stand from any file of points that iso_glyphs_read reads, .csv
 * and .ply above all. Of each point:
 *
 *   x y z           where the model's origin (0 0 0 of the world) comes to lie, mm
 *   qx qy qz qw     rotation: a quaternion of any length but 0, qw last
 *   rx ry rz        rotation instead, degrees: about the world's x axis, then y, then z; those that are not
 *                   there are 0
 *   scale           above 0; without the column 1
 *   red green blue  colour, instead of the model's
 *
 * A note tells of other columns, which say nothing. */
#ifndef ISO_IO_GLYPHS_PLACEMENTS_READ_H
#define ISO_IO_GLYPHS_PLACEMENTS_READ_H

#include "io/common/read_opts.h"
#include "isopoint.h"

/* Reads placements; iso_placements_free when done. `opts` may be NULL. Errors as iso_glyphs_read, and
 * ISO_ERR_EMPTY: there is none; ISO_ERR_FORMAT: a rotation or scale that cannot be used, or a rotation
 * given in two ways. Thread-safe for different reports and file sets. */
iso_status iso_placements_read_file(const char *path, const iso_read_opts *opts, iso_placements *placements,
                                    iso_error *error);

#endif
