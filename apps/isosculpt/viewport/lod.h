/* lod: a volume in three resolutions, for the time in which the user drags the isovalue. The points of one
 * level are extracted and drawn; how long that takes decides whether the next step uses a finer or a coarser
 * level. A coarser level holds every second voxel of the finer one, so that values are not changed by
 * averaging. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_LOD_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_LOD_H

#include "base/c_linkage.h"
#include "extract/points/points.h"

ISO_C_BEGIN

enum { ISOSCULPT_LOD_LEVELS = 3 }; /* full, half and quarter resolution */

typedef struct isosculpt_lod isosculpt_lod;

/* `grid` (its brick index is made) and `pool` are borrowed until destroy. The first level is chosen by the
 * number of voxels; its points are extracted here, so that the first step while dragging need not allocate
 * memory. ISO_ERR_NOMEM. */
iso_status isosculpt_lod_create(iso_rgrid *grid, double isovalue, iso_pool *pool, isosculpt_lod **lod,
                                iso_error *error);
void isosculpt_lod_destroy(isosculpt_lod *lod); /* NULL is fine */

/* Extracts the points of an isovalue (physical) on the current level; they are valid until the next call.
 * ISO_ERR_NOMEM. */
iso_status isosculpt_lod_update(isosculpt_lod *lod, double isovalue, iso_error *error);
iso_point_set *isosculpt_lod_points(const isosculpt_lod *lod); /* borrowed */

/* The same for a second isovalue, on the same level; its points are separate. */
iso_status isosculpt_lod_update_second(isosculpt_lod *lod, double isovalue, iso_error *error);
iso_point_set *isosculpt_lod_second_points(const isosculpt_lod *lod); /* borrowed */

int isosculpt_lod_level(const isosculpt_lod *lod); /* 0: full resolution */

/* Reports how many seconds the last step took; chooses the level of the next step. */
void isosculpt_lod_record_times(isosculpt_lod *lod, double extract, double draw);

ISO_C_END
#endif
