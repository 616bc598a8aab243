/* format: what each reader implements for grids/volume.c, which owns the order of things: info, memory check,
 * read.
 *
 * A reader never takes memory for voxels in `info`. In `read` it gets the info that `info` made (dims, type,
 * ...), makes the grid, and may add notes. C++ readers keep every entry inside grids/bridge_guard.hpp's
 * catch-all. A library that is not built in is replaced by an entry of format_none.c that answers
 * ISO_ERR_UNSUPPORTED. */
#ifndef ISO_GRIDS_FORMAT_H
#define ISO_GRIDS_FORMAT_H

#include "grids/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_format {
    const char *name;    /* as in iso_volume_info.format */
    const char *library; /* for "built without ..." */
    iso_status (*info)(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                       iso_error *error);
    iso_status (*read)(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_grid *grid,
                       iso_error *error);
} iso_format;

extern const iso_format iso_format_vti, iso_format_vtk, iso_format_metaimage, iso_format_nrrd,
    iso_format_nifti, iso_format_dicom, iso_format_vdb, iso_format_raw;

/* Shared by readers: fills type from a file's scalar type when it is stored as it is; wider integers and
 * doubles become float32. Copies `count` values of component `component` of `components` interleaved ones
 * from `source` (element type named by iso_scalar) into `target` of `type`, swapping bytes when `swap`. */
typedef enum iso_scalar {
    ISO_SCALAR_UINT8,
    ISO_SCALAR_INT8,
    ISO_SCALAR_UINT16,
    ISO_SCALAR_INT16,
    ISO_SCALAR_UINT32,
    ISO_SCALAR_INT32,
    ISO_SCALAR_UINT64,
    ISO_SCALAR_INT64,
    ISO_SCALAR_FLOAT,
    ISO_SCALAR_DOUBLE
} iso_scalar;

size_t iso_scalar_size(iso_scalar scalar);
const char *iso_scalar_name(iso_scalar scalar);
iso_type iso_scalar_stored_type(iso_scalar scalar); /* int8 -> int16, 32/64-bit and double -> float32 */

typedef struct iso_scalar_source {
    const void *data;
    iso_scalar scalar;
    int components, component;
    bool swap;
} iso_scalar_source;

void iso_scalar_convert(const iso_scalar_source *source, size_t count, iso_type type, void *target);

#ifdef __cplusplus
}
#endif
#endif
