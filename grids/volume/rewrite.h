/* rewrite: copies a volume file with some of its voxels changed. Everything else stays as it is: the header,
 * the type and order of the numbers, other components, what follows the voxels. */
#ifndef ISO_GRIDS_VOLUME_REWRITE_H
#define ISO_GRIDS_VOLUME_REWRITE_H

#include <stdio.h>

#include "base/progress.h"
#include "grids/volume/volume.h"

/* Checks whether a volume can be written again, and fills *info from its header, as iso_volume_read_info.
 * Formats whose voxels lie in one piece in one file can: .nii, .nrrd, .mha, .mgz and others, also compressed
 * by gzip, and .tif of any lossless compression, with values that are not scaled; and binary DICOM
 * segmentations (dicom/rewrite_bits.h). ISO_ERR_USAGE names the reason. */
iso_status iso_volume_rewrite_check(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                    iso_error *error);

/* Changes the voxels of a row. Those that are changed must get values that the file's type has. */
typedef void iso_rewrite_row(void *context, int y, int z, float *values);

/* Writes the file at `path` to `stream`, whose errors are the caller's to find (iso_sink_commit); `row` is
 * called for the rows in the order of the file. What was compressed by gzip is so again: the bytes are the
 * same once they are unpacked. Errors: those of iso_volume_rewrite_check; ISO_ERR_IO: damaged, truncated, or
 * cancelled. */
iso_status iso_volume_rewrite(const char *path, const iso_volume_opts *opts, iso_rewrite_row *row,
                              void *context, FILE *stream, const iso_progress *progress, iso_error *error);

#endif
