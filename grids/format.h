/* format: what each reader implements for grids/volume.c, which owns the order of things: info, memory check,
 * read.
 *
 * A reader never takes memory for voxels in `info`. In `read` it gets the info that `info` made (dims, type,
 * ...), makes the grid, and may add notes. C++ readers keep every entry inside grids/bridge_guard.hpp's
 * catch-all. A format whose library is not built in has an entry of format_none.c, without functions, for
 * which volume.c answers ISO_ERR_UNSUPPORTED.
 *
 * volume.c checks what `info` says (dims, directions, component), applies opts->spacing to info->transform
 * and fills `bytes` and `read_bytes` where they are left 0 (dense grid; nothing but the grid). */
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

/* Shared by readers. Dims from a header; ISO_ERR_FORMAT unless each is 1 .. 2^31-1. */
iso_status iso_format_dims(const char *path, const uint64_t dims[3], iso_volume_info *info, iso_error *error);

/* ISO_ERR_IO "... cancelled" when opts->progress asks for it. */
iso_status iso_format_progress(const char *path, const iso_volume_opts *opts, double fraction,
                               iso_error *error);

/* Size of a regular file; ISO_ERR_IO. */
iso_status iso_format_file_bytes(const char *path, uint64_t *bytes, iso_error *error);

/* ISO_ERR_IO "file: truncated: N of M bytes". */
iso_status iso_format_truncated(const char *path, uint64_t bytes, uint64_t wanted, iso_error *error);

/* The rgrid that info describes. With data: lent, as iso_rgrid_desc has it (also released on failure);
 * without: allocated. */
typedef struct iso_format_data {
    void *data;
    void (*release)(void *owner);
    void *owner;
} iso_format_data;
iso_status iso_format_create(const char *path, const iso_volume_info *info, const iso_format_data *lent,
                             iso_grid *grid, iso_error *error);

/* Fills info's component and components, and notes the choice when there are several. ISO_ERR_USAGE. */
iso_status iso_format_component(const char *path, const iso_volume_opts *opts, int components,
                                iso_volume_info *info, iso_error *error);

/* What the numbers in a file are. */
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

/* Whether it is stored as it is in the file. */
bool iso_scalar_is_stored(iso_scalar scalar);

typedef struct iso_scalar_source {
    const void *data;
    iso_scalar scalar;
    int components, component;
    bool swap;
} iso_scalar_source;

/* Copies `count` values of component `component` of `components` interleaved ones into `target` of `type`,
 * which is the scalar's stored type or float32, swapping bytes when `swap`. The data need not be aligned.
 * target == data is allowed when the scalar is `type` itself and components is 1. */
void iso_scalar_convert(const iso_scalar_source *source, size_t count, iso_type type, void *target);

#ifdef __cplusplus
}
#endif
#endif
