/* levels: a volume at full resolution, at half and at a quarter of it, to slide its isovalue through: which
 * of them a step of the hand extracts and draws is found by how long the steps before took. The coarser ones
 * have every second voxel of the finer, so that values stay what they are. */
#ifndef ISO_APPS_ISOSCULPT_VIEW_LOD_H
#define ISO_APPS_ISOSCULPT_VIEW_LOD_H

#include "extract/points/points.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISOSCULPT_LEVELS = 3 };

typedef struct isosculpt_lod isosculpt_lod;

/* Grid (its index is made) and pool are borrowed until destroy. Extracts the points of the level that it
 * begins with, so that the first step of a hand finds the memory that it needs. ISO_ERR_NOMEM. */
iso_status isosculpt_lod_create(iso_rgrid *grid, double isovalue, iso_pool *pool, isosculpt_lod **levels,
                                iso_error *error);
void isosculpt_lod_destroy(isosculpt_lod *levels); /* NULL is fine */

/* The points of an isovalue, on the level that is fast enough; valid until the next call. ISO_ERR_NOMEM. */
iso_status isosculpt_lod_update(isosculpt_lod *levels, double isovalue, iso_error *error);
iso_point_set *isosculpt_lod_points(const isosculpt_lod *levels);
int isosculpt_lod_level(const isosculpt_lod *levels); /* 0: full resolution */

/* How long a step took. */
void isosculpt_lod_record_times(isosculpt_lod *levels, double extract, double draw);

#ifdef __cplusplus
}
#endif
#endif
