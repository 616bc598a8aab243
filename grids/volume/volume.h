/* volume: any volume file into a grid. The header is read first, so that its size is known before memory is
 * taken.
 *
 *   .vti                        VTK                       .nrrd .nhdr            our own
 *   DICOM (a folder or a file)  GDCM                      .nii .nii.gz .hdr/.img libnifti2
 *   .vdb                        OpenVDB                   legacy .vtk            our own
 *   raw                         our own, iso_raw_layout   .mha .mhd              our own
 *
 * What a file is follows from its content, and from its name where the content does not tell.
 *
 * Spacing, origin, direction and handedness are honoured; RAS files (NIfTI, some NRRD) are turned to LPS.
 * NIfTI slope and DICOM rescale become the grid's scale and offset. .vdb level sets with a uniform transform
 * become hgrids; every other grid an rgrid over its active bounding box. A format library that is not built
 * in gives ISO_ERR_UNSUPPORTED. Everything here is thread-safe on different files; callbacks come from the
 * calling thread. */
#ifndef ISO_GRIDS_VOLUME_VOLUME_H
#define ISO_GRIDS_VOLUME_VOLUME_H

#include <stdbool.h>
#include <stdint.h>

#include "base/file_set.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "grids/grid.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Parses WxHxD:TYPE[:ENDIAN[:OFFSET]]: TYPE uint8 int16 uint16 float (float32), ENDIAN little or big, both of
 * the last may be empty. ISO_ERR_USAGE says what is wrong. */
iso_status iso_raw_layout_parse(const char *text, iso_raw_layout *layout, iso_error *error);

/* The layout that the name of a file tells, as tooth_103x94x161_uint8.raw does: WxHxD, and behind or before
 * it uint8 uchar u8, int16 short i16, uint16 ushort u16, float32 float or f32; then be or big, unless it is
 * little-endian. The words are parted by _ - . or spaces. False: it tells none. */
bool iso_raw_layout_of_name(const char *path, iso_raw_layout *layout);

/* Bytes that a file of that layout has at least; UINT64_MAX when that is more than 64 bits can say. */
uint64_t iso_raw_layout_bytes(const iso_raw_layout *layout);

/* All zero means the default. Strings are borrowed for the call. */
typedef struct iso_volume_opts {
    /* The .vdb grid's name, NULL: the only one, or the first level set, or the first scalar one. The .vti or
     * .vtk array's name, NULL: the active scalars, or the first array. */
    const char *grid;
    const char
        *series;   /* DICOM: series instance UID, or its number (from 1) as listed by iso_volume_read_info */
    int component; /* which of several components, from 0 */
    const iso_raw_layout
        *raw;            /* read as raw, whatever the name; NULL: raw when iso_raw_layout_of_name says so, the
                          * file has just that size, and it is called .raw or is of no other format */
    double spacing[3];   /* > 0 overrides the file's spacing (mm) */
    uint64_t max_memory; /* bytes that the grid and reading it may take; 0: 80 % of iso_memory_available */
    iso_file_set *files; /* every file that is read, or will be, is added by iso_volume_read_info and
                            iso_volume_read; NULL is fine */
    iso_pool *pool;
    iso_progress_fn *progress; /* cancels: ISO_ERR_IO */
    void *progress_context;
} iso_volume_opts;

/* A volume in memory. iso_volume_free when done. */
typedef struct iso_volume {
    iso_volume_info info;
    iso_grid grid;
} iso_volume;

/* Reads only the header of `path` (a file or a DICOM folder). Errors: ISO_ERR_IO (missing, unreadable,
 * truncated), ISO_ERR_FORMAT (not a volume), ISO_ERR_UNSUPPORTED, ISO_ERR_USAGE (no such component, grid or
 * series), ISO_ERR_BRIDGE. Each text names the file. */
iso_status iso_volume_read_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_error *error);

/* The format, as in iso_volume_info, of a file that begins with these bytes; NULL when no format says so.
 * 1024 are enough. Raw files have no such bytes, and some files only their name. */
const char *iso_volume_format(const void *bytes, size_t count);

/* ISO_ERR_LIMIT when reading what `info` describes takes more than opts->max_memory. */
iso_status iso_volume_check_memory(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                   iso_error *error);

/* Reads the volume; a dense one comes with its index of bricks (iso_brick_index_of). Errors as above, and
 * ISO_ERR_LIMIT (over max_memory, checked from the header before anything is allocated) and ISO_ERR_NOMEM. A
 * file shorter than its header promises is ISO_ERR_IO in every format. */
iso_status iso_volume_read(const char *path, const iso_volume_opts *opts, iso_volume *volume,
                           iso_error *error);
void iso_volume_free(iso_volume *volume);

/* Adds a line to info->notes; beyond ISO_VOLUME_NOTES it is dropped. Arguments may hold any bytes. For
 * readers.
 */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void iso_volume_note(iso_volume_info *info, const char *format, ...);

#ifdef __cplusplus
}
#endif
#endif
