/* slice_files: volumes in a folder with a file for each slice, as stacks of TIFF, PNG or JPEG images are:
 * which files are the slices, and how far apart voxels are when files do not state it. */
#ifndef ISO_GRIDS_VOLUME_SLICE_FILES_H
#define ISO_GRIDS_VOLUME_SLICE_FILES_H

#include <stdbool.h>
#include <stdint.h>

#include "grids/volume/volume.h"

typedef enum iso_slice_kind { ISO_SLICES_TIFF, ISO_SLICES_PNG, ISO_SLICES_JPEG } iso_slice_kind;

/* Whether a folder has a file whose name is that of such a slice: it has an extension of that kind, in
 * either case, and does not begin with a dot. False also if the folder cannot be read. */
bool iso_slice_files_exist(const char *folder, iso_slice_kind kind);

typedef struct iso_slice_files {
    char **paths; /* owned, as the array is */
    uint32_t count;
} iso_slice_files;

/* Lists the slices of a folder in the natural order of their names (slice_2 before slice_10), or `path`
 * itself if it is no folder. iso_slice_files_free when done, also after an error. ISO_ERR_IO: the folder
 * cannot be read; ISO_ERR_NOMEM. */
iso_status iso_slice_files_list(const char *path, iso_slice_kind kind, iso_slice_files *files,
                                iso_error *error);
void iso_slice_files_free(iso_slice_files *files);

/* Sets info's spacing: `stated` by the files, mm; 0: not stated. Pixels without a distance are 1 mm apart,
 * and unitless; slices without one are as far apart as pixels. Both are noted, unless opts->spacing has
 * them. */
void iso_slice_files_set_spacing(const double stated[3], const iso_volume_opts *opts, iso_volume_info *info);

#endif
