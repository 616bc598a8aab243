/* points_io: writes points as PLY; iso_glyphs_read (io/glyphs/glyphs_read.h) reads them.
 *
 * Binary little-endian PLY with per-vertex float properties x y z nx ny nz radius, world millimetres, normals
 * out of the solid, one comment naming the program; and uchar red green blue where points have colours. x y z
 * are doubles when the points lie so far from 0 that floats would round their places: map coordinates. */
#ifndef ISO_IO_POINTS_IO_H
#define ISO_IO_POINTS_IO_H

#include "base/primitives.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes through base/file.h. `comment` (one line) may be NULL. ISO_ERR_WRITE. */
iso_status iso_points_write_ply(const char *path, const iso_point_view *view, const char *comment,
                                iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
