/* rewrite_bits: a DICOM segmentation (SEG) written again with voxels of its labels changed, as
 * grids/volume/rewrite.h does for other files. */
#ifndef ISO_GRIDS_VOLUME_DICOM_REWRITE_BITS_H
#define ISO_GRIDS_VOLUME_DICOM_REWRITE_BITS_H

#include "grids/volume/rewrite.h"

/* Checks whether a DICOM file can be written again: a segmentation of type BINARY that is not compressed.
 * ISO_ERR_USAGE names the reason; errors of reading its header. */
iso_status iso_dicom_rewrite_check(const char *path, iso_error *error);

/* As iso_volume_rewrite. Bits of frames are changed in place and all other bytes stay: a voxel that gets a
 * label leaves the segment that was seen there, and those of greater numbers, which would hide it.
 * ISO_ERR_USAGE: a voxel gets a label in a slice in which its segment has no frame. */
iso_status iso_dicom_rewrite(const char *path, iso_rewrite_row *row, void *context, FILE *stream,
                             const iso_progress *progress, iso_error *error);

#endif
