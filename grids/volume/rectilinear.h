/* rectilinear: grids whose coordinates on each axis are a list, resampled to even steps. A reader sets
 * *opts->axes; volume.c resamples what it then reads. */
#ifndef ISO_GRIDS_VOLUME_RECTILINEAR_H
#define ISO_GRIDS_VOLUME_RECTILINEAR_H

#include "grids/volume/format.h"

typedef struct iso_rectilinear {
    double *axis[3]; /* the coordinates of the voxels, which rise (iso_alloc); NULL: they are even */
    int count[3];
} iso_rectilinear;

/* Makes the coordinates those of the cells' centres. */
void iso_rectilinear_take_cells(iso_rectilinear *r);

/* Sets info's spacing and, if steps are uneven, dims, type and a note: *even is false then. The step is the
 * smallest one on each axis or, where this makes more than four times as many voxels, the median. Unevenness
 * of a thousandth of a step, or of the rounding of floats, is none. ISO_ERR_FORMAT: coordinates that do not
 * rise, or so uneven that 2^31 steps are not enough; ISO_ERR_NOMEM. */
iso_status iso_rectilinear_describe(const char *path, const iso_rectilinear *r, iso_volume_info *info,
                                    bool *even, iso_error *error);

/* Makes the grid that `info` describes of the voxels at the coordinates, by linear interpolation along the
 * axes. A value next to one that is not finite is not finite either. ISO_ERR_NOMEM. */
iso_status iso_rectilinear_resample(const char *path, const iso_rectilinear *r, const iso_grid *from,
                                    const iso_volume_info *info, iso_pool *pool, iso_grid *to,
                                    iso_error *error);

void iso_rectilinear_free(iso_rectilinear *r);

#endif
