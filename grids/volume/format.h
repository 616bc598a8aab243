/* format: what each reader implements for grids/volume/volume.c, which owns the order of things: info, memory
 * check, read.
 *
 * A reader never takes memory for voxels in `info`. In `read` it gets the info that `info` made (dims, type,
 * ...), makes the grid, and may add notes. C++ readers keep every entry inside
 * grids/volume/bridge_guard.hpp's catch-all. The readers of large libraries are modules
 * (grids/volume/module.h), of which volume.c knows the names. A format whose library was not there when this
 * one was built has an entry of format_none.c, without functions, for which volume.c answers
 * ISO_ERR_UNSUPPORTED.
 *
 * The file that was asked for is in opts->files already; a reader's `info` adds the others that `read` will
 * open (iso_file_set_read, before it can fail).
 *
 * volume.c checks what `info` says (dims, directions, component), applies opts->spacing to info->transform
 * and fills `bytes` and `read_bytes` where they are left 0 (dense grid; nothing but the grid). */
#ifndef ISO_GRIDS_VOLUME_FORMAT_H
#define ISO_GRIDS_VOLUME_FORMAT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "grids/volume/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_format {
    const char *name;    /* as in iso_volume_info.format */
    const char *library; /* of another project, that reads it: for messages */
    const char *module;  /* in which the functions are; NULL: they are here */
    iso_status (*info)(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                       iso_error *error);
    iso_status (*read)(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_grid *grid,
                       iso_error *error);
} iso_format;

extern const iso_format iso_format_vtk, iso_format_metaimage, iso_format_nrrd, iso_format_nifti,
    iso_format_dicom, iso_format_raw;

/* Shared by readers. Dims from a header; ISO_ERR_FORMAT unless each is 1 .. 2^31-1. */
iso_status iso_format_dims(const char *path, const uint64_t dims[3], iso_volume_info *info, iso_error *error);

/* Bytes that reading may take: opts->max_memory, or by default 80 % of what is available. */
uint64_t iso_format_memory_limit(const iso_volume_opts *opts);

/* ISO_ERR_LIMIT "path: needs N to read (what), limit is M (--max-memory)" when `bytes` are more than that.
 * For readers that learn only while they read how much it takes. */
iso_status iso_format_check_memory(const char *path, const iso_volume_opts *opts, uint64_t bytes,
                                   const char *what, iso_error *error);

/* ISO_ERR_IO "... cancelled" when opts->progress asks for it. */
iso_status iso_format_progress(const char *path, const iso_volume_opts *opts, double fraction,
                               iso_error *error);

/* Opens a file that holds voxels or their header, and tells its size (bytes may be NULL). Every file that a
 * header can name is opened here: what is not a regular file (a pipe, a socket, a device, a folder) is
 * ISO_ERR_IO at once, without waiting. Close with fclose. */
iso_status iso_format_open(const char *path, FILE **stream, uint64_t *bytes, iso_error *error);

/* Size of a file that iso_format_open would open; ISO_ERR_IO. */
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

/* Where a reader's voxels come from, in file order: fills exactly `bytes` bytes or fails. */
typedef iso_status iso_format_fill(void *context, void *target, size_t bytes, iso_error *error);

typedef struct iso_format_stream {
    iso_format_fill *fill;
    void *context;
    iso_scalar scalar;
    int components, component; /* interleaved ones */
    bool swap;
} iso_format_stream;

/* Makes info's grid and fills it from the stream, reporting progress. */
iso_status iso_format_read_stream(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  const iso_format_stream *stream, iso_grid *grid, iso_error *error);

/* Adds to read_bytes what iso_format_read_stream takes beside the grid. Needs dims and type. */
void iso_format_stream_room(const iso_format_stream *stream, iso_volume_info *info);

/* Unpacks a zlib or gzip stream that begins where `file` stands; `total` bytes are expected. The file is
 * borrowed, `path` names it. Destroy with iso_inflater_destroy. */
typedef struct iso_inflater iso_inflater;
iso_status iso_inflater_create(const char *path, FILE *file, uint64_t total, iso_inflater **inflater,
                               iso_error *error);
/* The next bytes, fewer only at the stream's end; ISO_ERR_IO when it is damaged or cut off. */
iso_status iso_inflater_read(iso_inflater *inflater, void *target, size_t bytes, size_t *got,
                             iso_error *error);
/* The next bytes; ISO_ERR_IO also when the stream ends. */
iso_status iso_inflater_fill(iso_inflater *inflater, void *target, size_t bytes, iso_error *error);
/* After the last byte: whether the checksum, as far as it is there, is right. */
iso_status iso_inflater_finish(iso_inflater *inflater, iso_error *error);
void iso_inflater_destroy(iso_inflater *inflater);

/* The same for bzip2, of libbz2. ISO_ERR_UNSUPPORTED when it is not built in. */
typedef struct iso_bunzip iso_bunzip;
iso_status iso_bunzip_create(const char *path, FILE *file, uint64_t total, iso_bunzip **bunzip,
                             iso_error *error);
iso_status iso_bunzip_read(iso_bunzip *bunzip, void *target, size_t bytes, size_t *got, iso_error *error);
void iso_bunzip_destroy(iso_bunzip *bunzip);

/* Arrays of numbers over the points or cells of an image (.vti, legacy .vtk). */
typedef struct iso_format_array {
    char name[ISO_VOLUME_TEXT];
    iso_scalar scalar;
    uint64_t components, tuples;
    bool cells, active; /* active: the file calls them its scalars */
} iso_format_array;

typedef struct iso_format_image {
    uint64_t points[3];
    const iso_format_array *arrays;
    int count;
} iso_format_image;

/* Chooses an array: opts->grid, else the active one, else the first; of points rather than of cells. Fills
 * everything in info that follows from it; the transform must be set. Cells become voxels at their centres.
 */
iso_status iso_format_take_array(const char *path, const iso_volume_opts *opts, const iso_format_image *image,
                                 iso_volume_info *info, int *chosen, iso_error *error);

/* Parses `count` numbers from a text file into native values of `scalar` at target (clamped to its range).
 * Between them are white space and characters of `separators`. False when the file ends before, or something
 * else stands there. */
bool iso_format_read_numbers(FILE *file, const char *separators, iso_scalar scalar, size_t count,
                             void *target);

/* `name` as a header at `header` names it: relative to the header's folder. NULL without memory; free(). */
char *iso_format_beside(const char *header, const char *name);

/* Bytes of dims[0] * dims[1] * dims[2] * each; UINT64_MAX when that is more than 64 bits. */
uint64_t iso_format_size(const int dims[3], uint64_t each);

/* Reads on behind the next end of line, or to the end of the file. */
void iso_format_skip_line(FILE *file);

#ifdef __cplusplus
}
#endif
#endif
