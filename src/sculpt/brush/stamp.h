/* stamp: a shape of its own for ISO_SOLID_STAMP, as distance fields of several sizes. Its longest side goes
 * from -1 to 1: a brush's radius scales it.
 *
 * A journal holds the fields themselves, not the mesh that they were made of: a stroke file needs no other
 * file, and plays the same whichever version made them. */
#ifndef ISO_SCULPT_BRUSH_STAMP_H
#define ISO_SCULPT_BRUSH_STAMP_H

#include "base/parallel.h"
#include "base/progress.h"
#include "grids/closing/closed_mesh.h"
#include "grids/hgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Voxels along the longest side: 8, 16, .. 128. What is finer than the last is lost. */
enum { ISO_STAMP_LEVELS = 5, ISO_STAMP_FIRST = 8, ISO_STAMP_NAME = 64 };

/* Shared; read only. */
typedef struct iso_stamp {
    char name[ISO_STAMP_NAME];          /* of the file, for people */
    iso_hgrid *level[ISO_STAMP_LEVELS]; /* ascending sizes; those in which nothing is left are not there */
    int count;                          /* of levels, 1 at least */
    int owners;                         /* atomic */
} iso_stamp;

/* Of the solid that a mesh encloses. As iso_level_set_from_mesh; levels whose voxels are too large for the
 * mesh are left out. The pool is borrowed; NULL: the calling thread. */
iso_status iso_stamp_from_mesh(const char *path, const iso_closed_mesh *mesh, iso_pool *pool,
                               const iso_progress *progress, iso_stamp **stamp, iso_error *error);

/* One more owner; each calls iso_stamp_free. NULL is fine. Thread-safe. */
iso_stamp *iso_stamp_share(iso_stamp *stamp);
void iso_stamp_free(iso_stamp *stamp);

/* The finest level that a brush of this radius (voxels) does not skip voxels of, else the coarsest. */
const iso_hgrid *iso_stamp_level(const iso_stamp *stamp, double radius);

/* As text (base 64) and back, to the bit. The text is malloc'ed (free); NULL: out of memory. */
char *iso_stamp_text(const iso_stamp *stamp);
/* ISO_ERR_FORMAT: that is no stamp; ISO_ERR_NOMEM. */
iso_status iso_stamp_parse(const char *name, const char *text, iso_stamp **stamp, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
