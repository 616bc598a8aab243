/* levels: a volume at full resolution, at half and at a quarter of it, to slide its isovalue through: which
 * of them a step of the hand extracts and draws is found by how long the steps before took. The coarser ones
 * have every second voxel of the finer, so that values stay what they are. */
#ifndef ISO_APPS_ISOSCULPT_LEVELS_H
#define ISO_APPS_ISOSCULPT_LEVELS_H

#include "extract/points/points.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISOSCULPT_LEVELS = 3 };

typedef struct isosculpt_levels isosculpt_levels;

/* Grid (its index is made) and pool are borrowed until destroy. Extracts the points of the level that it
 * begins with, so that the first step of a hand finds the memory that it needs. ISO_ERR_NOMEM. */
iso_status isosculpt_levels_create(iso_rgrid *grid, double isovalue, iso_pool *pool,
                                   isosculpt_levels **levels, iso_error *error);
void isosculpt_levels_destroy(isosculpt_levels *levels); /* NULL is fine */

/* The points of an isovalue, on the level that is fast enough; valid until the next call. ISO_ERR_NOMEM. */
iso_status isosculpt_levels_update(isosculpt_levels *levels, double isovalue, iso_error *error);
iso_point_set *isosculpt_levels_points(const isosculpt_levels *levels);
int isosculpt_levels_now(const isosculpt_levels *levels); /* 0: full resolution */

/* How long a step took. */
void isosculpt_levels_took(isosculpt_levels *levels, double extract, double draw);

#ifdef __cplusplus
}
#endif
#endif
