/* stamp: a mesh as the solid of a brush (ISO_SOLID_STAMP), stored as distance fields of several resolutions,
 * or a picture of heights that weigh what a brush does (iso_brush.alpha), whose longest side extends from -1
 * to 1 and is scaled by the brush's radius; or voxels to freeze, which are where they are.
 *
 * A journal contains the distance fields or heights, not the mesh or picture. A stroke file therefore needs
 * no other file, and replays the same whichever version converted the mesh. */
#ifndef ISO_SCULPT_BRUSH_STAMP_H
#define ISO_SCULPT_BRUSH_STAMP_H

#include "base/c_linkage.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "grids/closing/closed_mesh.h"
#include "grids/hgrid.h"
#include "sculpt/brush/voxel_set.h"

ISO_C_BEGIN

/* ISO_STAMP_FIRST: voxels along the longest side in the coarsest level; each finer level has twice as many
 * (8, 16, .. 128). Detail below the finest voxels is lost. ISO_STAMP_NAME: size of the name in bytes. */
enum { ISO_STAMP_LEVELS = 5, ISO_STAMP_FIRST = 8, ISO_STAMP_NAME = 64 };

/* The largest width and height of a picture. */
enum { ISO_HEIGHTS_MOST = 256 };

/* A picture of heights. */
typedef struct iso_heights {
    int width, height; /* pixels */
    float *value;      /* 0 .. 1, within a border of zeros: (width + 2) x (height + 2), the upper row first;
                          multiples of 1 / 65535; NULL: the stamp is a mesh */
} iso_heights;

/* Reference-counted and immutable, so threads may share it. */
typedef struct iso_stamp {
    char name[ISO_STAMP_NAME];          /* the mesh's file name, for display */
    iso_hgrid *level[ISO_STAMP_LEVELS]; /* coarse to fine; levels in which nothing is inside are left out */
    int count;                          /* number of levels, at least 1; 0: it is a picture, or voxels */
    iso_heights heights;
    iso_voxel_set voxels;
    int owners; /* number of owners; changed atomically */
} iso_stamp;

/* Converts the solid that a mesh encloses. The stamp's name is the last component of `path`. Levels whose
 * voxels are too large for the mesh are left out. The pool is borrowed; NULL: the calling thread. Errors:
 * those of iso_level_set_from_mesh. */
iso_status iso_stamp_from_mesh(const char *path, const iso_closed_mesh *mesh, iso_pool *pool,
                               const iso_progress *progress, iso_stamp **stamp, iso_error *error);

/* Makes a stamp of a picture of width x height values, the upper row first. One that is larger than
 * ISO_HEIGHTS_MOST is reduced to means of squares of pixels. The name is the last component of `path`.
 * ISO_ERR_NOMEM. */
iso_status iso_stamp_from_picture(const char *path, int width, int height, const uint16_t *values,
                                  iso_stamp **stamp, iso_error *error);

/* Makes a stamp of voxels, whose bits it takes over, also when it fails. ISO_ERR_NOMEM. */
iso_status iso_stamp_from_voxels(const char *name, const iso_voxel_set *set, iso_stamp **stamp,
                                 iso_error *error);

/* Adds an owner; each owner calls iso_stamp_free. Both accept NULL and are thread-safe. */
iso_stamp *iso_stamp_share(iso_stamp *stamp);
void iso_stamp_free(iso_stamp *stamp);

/* Returns the finest level whose voxels are at least as large as the grid's when the stamp is scaled to a
 * brush of this radius (in voxels of the grid); if there is none, the coarsest level. Owned by the stamp. */
const iso_hgrid *iso_stamp_level(const iso_stamp *stamp, double radius_voxels);

/* Returns the levels of a mesh, the values of a picture, or runs of voxels, as base 64 text, for journals;
 * malloc'ed (free). NULL: out of memory. */
char *iso_stamp_text(const iso_stamp *stamp);
/* Makes a stamp from such a text; its distances are the same to the bit. ISO_ERR_FORMAT: the text is damaged;
 * ISO_ERR_NOMEM. */
iso_status iso_stamp_parse(const char *name, const char *text, iso_stamp **stamp, iso_error *error);
iso_status iso_stamp_parse_picture(const char *name, int width, int height, const char *text,
                                   iso_stamp **stamp, iso_error *error);
/* `frame`: a set without bits, within the bounds of limits.h. */
iso_status iso_stamp_parse_voxels(const char *name, const iso_voxel_set *frame, const char *text,
                                  iso_stamp **stamp, iso_error *error);

ISO_C_END
#endif
