/* points_io: writes and reads points as PLY.
 *
 * Binary little-endian PLY with per-vertex float properties x y z nx ny nz radius, world millimetres, normals
 * out of the solid, one comment naming the program; and uchar red green blue where points have colours.
 * Reading accepts ASCII and both binary byte orders, any scalar types, and skips further properties and
 * elements. Normals are normalized. Points with a normal that is zero or not finite, a position that is not
 * finite, or a radius that is not positive are dropped. Colours are read when all of red, green and blue are
 * there: integers as 0 .. 255, floats as 0 .. 1, clamped. */
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

/* Points read from a file: one span, with the identity transform (index coordinates are mm). Free with
 * iso_points_free. */
typedef struct iso_points {
    iso_surfel *surfels;
    float *radii;
    uint8_t (*colors)[3]; /* NULL when the file has none */
    iso_point_span span;
} iso_points;

/* Reads points. ISO_ERR_IO (missing, truncated), ISO_ERR_FORMAT (not PLY, no points; missing properties,
 * which the message names), ISO_ERR_LIMIT (more than max_memory bytes; 0: no limit), ISO_ERR_NOMEM. */
iso_status iso_points_read_ply(const char *path, uint64_t max_memory, iso_points *points, iso_error *error);
void iso_points_free(iso_points *points);
/* Returns a view of the points, which it borrows until iso_points_free. */
iso_point_view iso_points_view(const iso_points *points);

#ifdef __cplusplus
}
#endif
#endif
