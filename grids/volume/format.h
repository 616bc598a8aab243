/* format: the interface of a file format's reader, and functions that readers share.
 *
 * grids/volume/volume.c calls `info`, checks the memory, and then calls `read` or, if the format has it,
 * `open_tiled`. `info` reads the header and allocates no memory for voxels. `read` gets the result of
 * `info` (dims, type, ...), creates the grid, and may add notes. C++ readers wrap every entry in the guard
 * of base/bridge_guard.hpp. Readers that need large libraries are modules (grids/volume/module.h),
 * whose names are in volume.c. A format whose library was missing when Isopoint was built has an entry
 * without functions (format_none.c): ISO_ERR_UNSUPPORTED.
 *
 * opts->files contains the file itself; `info` adds all others that `read` will open (iso_file_set_read),
 * before it can fail.
 *
 * volume.c checks the result of `info` (dims, directions, component), applies opts->spacing to
 * info->transform, and sets `bytes` and `read_bytes` if they are 0: to the size of a dense grid.
 *
 * `info` may set *opts->axes (never NULL for readers) to the voxels' coordinates, with info's dims as they
 * are in the file: volume.c resamples what `read` then reads, if they are uneven.
 *
 * If `info` sets *opts->place (never NULL for readers), volume.c reads or maps the voxels from there and does
 * not call `read`. A module could not do so: it has copies of this library's functions, and a grid is
 * recognised as mapped by the function that releases it. */
#ifndef ISO_GRIDS_VOLUME_FORMAT_H
#define ISO_GRIDS_VOLUME_FORMAT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "base/c_linkage.h"
#include "grids/volume/volume.h"

ISO_C_BEGIN

struct iso_tiled;

typedef struct iso_format {
    const char *name;    /* as in iso_volume_info.format */
    const char *library; /* the library of another project that reads it, for messages */
    const char *module;  /* the module with the functions; NULL: they are below */
    iso_status (*info)(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                       iso_error *error);
    /* NULL: `info` always sets opts->place. */
    iso_status (*read)(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_grid *grid,
                       iso_error *error);
    /* Instead of `read`, for formats whose voxels are in tiles (grids/volume/tiled.h). Gets the result of
     * `info`, and sets *tiled, whose context must not borrow from `opts`. */
    iso_status (*open_tiled)(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                             struct iso_tiled *tiled, iso_error *error);
} iso_format;

/* The formats of files (base/file_types.inc), of folders, and of files without a header. */
#define VOLUME(reader) extern const iso_format iso_format_##reader;
#define FILE_TYPE(name, extensions, magic, handlers) handlers
#include "base/file_types.inc"
extern const iso_format iso_format_png, iso_format_jpeg, iso_format_raw;

/* ISO_ERR_FORMAT: "path: holds a KIND, not an image", and how to make one of it. `kind` is as VTK's files
 * have it. */
iso_status iso_format_not_image(const char *path, const char *kind, iso_error *error);

/* Sets info's dims. ISO_ERR_FORMAT unless each is 1 .. 2^31-1. */
iso_status iso_format_dims(const char *path, const uint64_t dims[3], iso_volume_info *info, iso_error *error);

/* Sets info's transform: `steps` lead from a voxel to the next one on each axis, and `origin` is the first
 * one's centre; both in units of `unit` mm. */
void iso_format_transform(const iso_vec3 steps[3], const iso_vec3 *origin, double unit,
                          iso_volume_info *info);

/* The memory limit in bytes: opts->max_memory, by default 80 % of the available memory. */
uint64_t iso_format_memory_limit(const iso_volume_opts *opts);

/* ISO_ERR_LIMIT "path: needs N to read (what), limit is M (--max-memory)" if `bytes` exceed the limit. For
 * readers that find out only while reading how much memory they need. */
iso_status iso_format_check_memory(const char *path, const iso_volume_opts *opts, uint64_t bytes,
                                   const char *what, iso_error *error);

/* Reports progress. ISO_ERR_IO "... cancelled": opts->progress cancels. */
iso_status iso_format_progress(const char *path, const iso_volume_opts *opts, double fraction,
                               iso_error *error);

/* The size of a regular file, as iso_file_open returns it. ISO_ERR_IO. */
iso_status iso_format_file_bytes(const char *path, uint64_t *bytes, iso_error *error);

/* ISO_ERR_IO "file: truncated: N of M bytes". */
iso_status iso_format_truncated(const char *path, uint64_t bytes, uint64_t wanted, iso_error *error);

/* Whether opts->component_axes prefers arrays or grids with so many components: three are vectors, six,
 * seven (a mask and six) and nine are matrices. */
static inline bool iso_format_are_vectors(uint64_t components) {
    return components == 3 || components == 6 || components == 7 || components == 9;
}

/* Creates the rgrid that `info` describes. `lent`: voxels in memory, as in iso_rgrid_desc, released also
 * when it fails; NULL: the voxels are allocated. */
typedef struct iso_format_data {
    void *data;
    void (*release)(void *owner);
    void *owner;
} iso_format_data;
iso_status iso_format_create(const char *path, const iso_volume_info *info, const iso_format_data *lent,
                             iso_grid *grid, iso_error *error);

/* Sets info's component and components; adds a note if there are several, unless opts->component_axes asks
 * for all of them. ISO_ERR_USAGE: no such component. */
iso_status iso_format_component(const char *path, const iso_volume_opts *opts, int components,
                                iso_volume_info *info, iso_error *error);

/* The types of numbers in files. */
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
    ISO_SCALAR_DOUBLE,
    ISO_SCALAR_HALF /* 16 bits (IEEE 754), only in Zarr, HDF5 and TIFF */
} iso_scalar;

size_t iso_scalar_size(iso_scalar scalar);
const char *iso_scalar_name(iso_scalar scalar);
iso_type
iso_scalar_stored_type(iso_scalar scalar); /* int8 -> int16; half, double, 32 and 64 bits -> float32 */

/* The type that legacy VTK files call `word`, in any case; false: they have no such type of number. */
bool iso_scalar_of_vtk(const char *word, iso_scalar *scalar);

/* Whether the stored type is the type in the file. */
bool iso_scalar_is_stored(iso_scalar scalar);

typedef struct iso_scalar_source {
    const void *data;
    iso_scalar scalar;
    int components, component;
    bool swap;
} iso_scalar_source;

/* Copies `count` values of one of several interleaved components to `target`, converted to `type`: the
 * scalar's stored type or float32. `swap`: the bytes of each value are in reverse order. The data need not
 * be aligned. target may equal data if the scalar is of this type and there is one component. */
void iso_scalar_convert(const iso_scalar_source *source, size_t count, iso_type type, void *target);
/* Sets `count` values of a type, which are aligned. */
void iso_scalar_fill(iso_type type, float value, void *target, size_t count);

/* Reads exactly the next `bytes` bytes of the voxels, in file order, or fails. */
typedef iso_status iso_format_fill(void *context, void *target, size_t bytes, iso_error *error);

typedef struct iso_format_stream {
    iso_format_fill *fill;
    void *context;
    iso_scalar scalar;
    int components, component; /* interleaved ones */
    bool swap;
    /* Optional: returns the file whose next `bytes` bytes, from its current position on, are those that
     * `fill` would read next, and takes them as read; NULL: they are compressed, or in several files. */
    FILE *(*plain)(void *context, uint64_t bytes);
} iso_format_stream;

/* Creates the grid that `info` describes and fills it from the stream, reporting progress. With
 * opts->mapped the voxels are mapped. */
iso_status iso_format_read_stream(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  const iso_format_stream *stream, iso_grid *grid, iso_error *error);

/* Adds the memory that iso_format_read_stream takes beside the grid to read_bytes. Needs dims and type. */
void iso_format_stream_room(const iso_format_stream *stream, iso_volume_info *info);

/* Where voxels lie in a file as they are, or in a file that gzip has compressed, or as text. */
enum { ISO_FORMAT_PATH = 4096 };
typedef struct iso_format_place {
    bool known;                /* the rest is set */
    bool swap;                 /* as in iso_format_stream */
    int components, component; /* of the values there, if `components` is above 0; else info's */
    bool separate;             /* each component is a volume behind the one before it; false: interleaved */
    bool gzip;                 /* the whole file is compressed, and `position` is in the unpacked one */
    bool text;                 /* numbers between white space, stored as `scalar` */
    bool bits;                 /* uint8 0 or 1, eight of them in a byte, the first one the highest bit */
    iso_scalar scalar;         /* of each of info->components components */
    uint64_t position;         /* of the first byte in the file, or behind `plain` in the unpacked one */
    uint64_t plain;            /* with gzip: bytes of the file in front of what is compressed */
    bool by_module;            /* neither known nor told: the format's module writes the file again */
    bool told; /* not known, for `read` does more than reading what lies there; the rest is for
                  iso_volume_rewrite */
    char file[ISO_FORMAT_PATH]; /* where the voxels are; empty: in the file with the header */
} iso_format_place;

/* iso_volume_read_info that also finds where the voxels are: neither known nor told if they are not in one
 * piece. `place` may be NULL. */
iso_status iso_volume_find_place(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                 iso_format_place *place, iso_error *error);

/* Sets *opts->place: the voxels are numbers in text, from the current position of `file` on, stored as
 * floats. */
iso_status iso_format_text_voxels(const char *path, FILE *file, const iso_volume_opts *opts,
                                  iso_volume_info *info, iso_error *error);
/* Sets *opts->place, and the types of numbers that follow from it. */
void iso_format_set_place(const iso_format_place *place, const iso_volume_opts *opts, iso_volume_info *info);

/* iso_format_stream_room and iso_format_read_stream for voxels at a place. ISO_ERR_IO: the file is too short,
 * damaged, or unreadable. */
void iso_format_place_room(const iso_format_place *place, iso_volume_info *info);
iso_status iso_format_read_place(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                 const iso_format_place *place, iso_grid *grid, iso_error *error);

/* Reads up to *count bytes from the beginning of a file, or, if `gzip` says that it is compressed, of what is
 * packed in it. ISO_ERR_IO. */
iso_status iso_format_read_head(const char *path, void *bytes, size_t *count, bool *gzip, iso_error *error);
/* Unpacks the beginning of a gzip file as far as `count` bytes of it and `room` allow; returns the number of
 * bytes, 0 if it is none. */
size_t iso_gzip_head(const void *packed, size_t count, void *bytes, size_t room);

/* Unpacks a zlib or gzip stream from the current position of `file`, which is borrowed; `total` bytes are
 * expected, `path` is for messages. Destroy with iso_inflater_destroy. */
typedef struct iso_inflater iso_inflater;
iso_status iso_inflater_create(const char *path, FILE *file, uint64_t total, iso_inflater **inflater,
                               iso_error *error);
/* The same for a bare stream of deflate, as in ZIP archives. */
iso_status iso_inflater_create_bare(const char *path, FILE *file, uint64_t total, iso_inflater **inflater,
                                    iso_error *error);
/* Reads the next bytes, fewer only at the end of the stream. ISO_ERR_IO: damaged or truncated. */
iso_status iso_inflater_read(iso_inflater *inflater, void *target, size_t bytes, size_t *got,
                             iso_error *error);
/* Reads exactly the next bytes. ISO_ERR_IO: damaged, truncated, or the stream ends before. */
iso_status iso_inflater_fill(iso_inflater *inflater, void *target, size_t bytes, iso_error *error);
/* Checks the checksum after the last byte, as far as it is there. `more`, if not NULL: whether the stream
 * goes on instead. ISO_ERR_IO. */
iso_status iso_inflater_finish(iso_inflater *inflater, bool *more, iso_error *error);
void iso_inflater_destroy(iso_inflater *inflater);

/* The same for bzip2, through libbz2. ISO_ERR_UNSUPPORTED: it is not built in. */
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

/* Chooses an array: opts->grid, else the active one, else the first; arrays of points before those of
 * cells. With opts->component_axes, arrays of vectors or matrices come first, those of bytes, which are
 * colours, last of these. Sets everything in info that follows from the choice; the transform must be set.
 * Cells become voxels at their centres. */
iso_status iso_format_take_array(const char *path, const iso_volume_opts *opts, const iso_format_image *image,
                                 iso_volume_info *info, int *chosen, iso_error *error);

/* Parses `count` numbers of a text file to values of type `scalar` at `target`, clamped to its range. They
 * are separated by white space and characters of `separators`. False: the file ends before, or has anything
 * else. */
bool iso_format_read_numbers(FILE *file, const char *separators, iso_scalar scalar, size_t count,
                             void *target);

/* The path of a file that a header names relative to its own folder, malloc'ed (free). NULL: out of memory.
 */
char *iso_format_beside(const char *header, const char *name);

/* Reads a text of at most `most` bytes, for which zeros follow (iso_free). ISO_ERR_FORMAT: it is longer;
 * ISO_ERR_IO, ISO_ERR_NOMEM. */
iso_status iso_format_load_text(const char *path, uint64_t most, char **text, size_t *bytes,
                                iso_error *error);

/* The length of a unit in mm, such as "um", "micron" or "inch", in any case; 0: it is no unit of length. */
double iso_format_unit(const char *name);

/* dims[0] * dims[1] * dims[2] * each; UINT64_MAX: it does not fit into 64 bits. */
uint64_t iso_format_size(const int dims[3], uint64_t each);

/* Reads on behind the next end of line, or to the end of the file. */
void iso_format_skip_line(FILE *file);

ISO_C_END
#endif
