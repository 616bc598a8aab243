/* volume: reads volume files of all formats into grids. The header is read first, so that the size is known
 * before memory is allocated.
 *
 *   .vti                        VTK                       .nrrd .nhdr            our own
 *   DICOM (a folder or a file)  GDCM                      .nii .nii.gz .hdr/.img libnifti2
 *   .vdb                        OpenVDB                   legacy .vtk            our own
 *   raw                         our own, iso_raw_layout   .mha .mhd              our own
 *   .tif .tiff (also a folder)  libtiff                 HDF5                   libhdf5
 *   Zarr, OME-Zarr (folders)    our own                 PNG (folders)          libpng
 *   .mrc .map                   our own                 .mgh .mgz              our own
 *   .mif .mih                   our own                 .cube, .dx             our own
 *   AFNI's .HEAD .BRIK          our own                 VASP's CHGCAR          our own
 *
 * The format is found from the content, and from the name if the content does not tell.
 *
 * Spacing, origin, direction and handedness are preserved; RAS files (NIfTI, some NRRD) are converted to LPS.
 * The slope of NIfTI and the rescale of DICOM become the grid's scale and offset. Level sets in .vdb files
 * with a uniform transform become hgrids, all other .vdb grids rgrids over their active bounding box. A
 * format whose library is not built in is ISO_ERR_UNSUPPORTED. Thread-safe for different files; callbacks are
 * called from the calling thread. */
#ifndef ISO_GRIDS_VOLUME_VOLUME_H
#define ISO_GRIDS_VOLUME_VOLUME_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "base/c_linkage.h"
#include "base/file_set.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "grids/chunk_source.h"
#include "grids/grid.h"
#include "isopoint.h"

ISO_C_BEGIN

/* Parses WxHxD:TYPE[:ENDIAN[:OFFSET]]. TYPE is uint8, int8, uint16, int16, uint32, int32, float32 (float) or
 * float64 (double), ENDIAN little or big; the last two may be empty. ISO_ERR_USAGE says what is wrong. */
iso_status iso_raw_layout_parse(const char *text, iso_raw_layout *layout, iso_error *error);

/* Finds the layout in the name of a file, such as tooth_103x94x161_uint8.raw: WxHxD, and before or after
 * it uint8 uchar u8, int8 i8, int16 short i16, uint16 ushort u16, int32 i32, uint32 u32, float32 float
 * f32, float64 double or f64, and for big-endian data be or big. Words are separated by _ - . or spaces.
 * False: the name has no layout. */
bool iso_raw_layout_of_name(const char *path, iso_raw_layout *layout);

/* The name of the layout's type, and the bytes of a number. */
const char *iso_raw_layout_type_name(const iso_raw_layout *layout);
size_t iso_raw_layout_number_bytes(const iso_raw_layout *layout);

/* The smallest size in bytes of a file with this layout; UINT64_MAX: it does not fit into 64 bits. */
uint64_t iso_raw_layout_bytes(const iso_raw_layout *layout);

/* The axes of the components of a volume of vectors or matrices, as far as the header tells. */
typedef struct iso_component_axes {
    double to_world[9]; /* row-major: a vector in the world (LPS) is to_world * its components */
    bool stated;        /* by the header; false: to_world is what is usual in the format */
    bool lower; /* symmetric matrices are stored as their lower triangle, row by row: xx yx yy zx zy zz */
} iso_component_axes;

/* What the file says of its channels, as far as it has them: OME-TIFF, OME-Zarr and Imaris do. Component c is
 * of channel c % count. */
enum { ISO_CHANNELS = 32, ISO_CHANNEL_NAME = 64 };
typedef struct iso_channel {
    char name[ISO_CHANNEL_NAME]; /* one line of printable UTF-8; empty: not stated */
    bool colored;                /* the file states `color` */
    iso_rgb color;
} iso_channel;
typedef struct iso_channels {
    int count; /* 0: nothing is stated */
    iso_channel items[ISO_CHANNELS];
} iso_channels;

/* The channel of a component; NULL: nothing is stated of it. */
const iso_channel *iso_channel_of(const iso_channels *channels, int component);
/* Finds the component that `text` means: a number below `components`, or the name of a channel, in either
 * case if no channel has it as it is written. ISO_ERR_USAGE: there is none, or several channels have the
 * name; the message lists what there is. */
iso_status iso_channels_find(const iso_channels *channels, int components, const char *text, int *component,
                             iso_error *error);

struct iso_format_place;
struct iso_rectilinear;

/* All zero means the default. Strings are borrowed for the call. */
typedef struct iso_volume_opts {
    /* The .vdb grid's name, NULL: the only one, or the first level set, or the first scalar one. The .vti or
     * .vtk array's name, NULL: the active scalars, or the first array. The path of an array of an HDF5 file,
     * as in FILE:/path; NULL: the one that the file is about by its conventions, or the only one. */
    const char *grid;
    const char
        *series;   /* DICOM: UID of a series, or number (from 1) as listed; ":2" behind it: 2nd acquisition */
    int component; /* which of several components, from 0 */
    /* The component is chosen as a channel: messages call it so, and no note says that there are others. */
    bool by_channel;
    iso_channels *channels; /* set from the header if not NULL */
    int level;              /* which level of a multiscale image, 0: the finest */
    /* Set from the header. Not NULL: the volume is read for its vectors: of a file with several grids or
     * arrays, one with as many components as vectors or matrices have is chosen if there is one. */
    iso_component_axes *component_axes;
    const iso_raw_layout
        *raw;            /* read as raw, whatever the name; NULL: raw when iso_raw_layout_of_name says so, the
                          * file has just that size, and it is called .raw or is of no other format */
    double spacing[3];   /* > 0 overrides the file's spacing (mm) */
    uint64_t max_memory; /* bytes that the grid and reading it may take; 0: 80 % of iso_memory_available */
    /* Voxels stay in the file, mapped (grids/volume/mapping.h) or in tiles (grids/volume/tiled.h), if
     * they are mappable, and do not count against max_memory then. The grid must not be written to, has no
     * index, and is read through iso_volume_source. */
    bool mapped;
    /* Set from the header if not NULL: whether the voxels can stay in the file. Those of nrrd, metaimage,
     * nifti, raw, legacy vtk, tiff, png, hdf5 and zarr files can, those of vti files if they lie there as
     * they are. */
    bool *mappable;
    struct iso_format_place *place; /* for readers only (grids/volume/format.h) */
    struct iso_rectilinear *axes;   /* for readers only (grids/volume/rectilinear.h) */
    const struct iso_remote
        *remote;         /* for readers only: of a path that is a URL (grids/volume/remote/remote.h) */
    int chunk_side;      /* voxels along the side of the chunks that will be read of tiles; 0: 128 */
    iso_file_set *files; /* every file that is read, or will be, is added by iso_volume_read_info and
                            iso_volume_read; NULL is fine */
    iso_pool *pool;
    bool count_values; /* count the values of integers while the index is made: a histogram will be asked for
                        * (iso_brick_index_with_counts) */
    iso_progress_fn *progress; /* cancels: ISO_ERR_IO */
    void *progress_context;
} iso_volume_opts;

/* A volume in memory. iso_volume_free when done. */
typedef struct iso_volume {
    iso_volume_info info;
    iso_grid grid;
} iso_volume;

/* The array's part of FILE:/array, within `path`. NULL: `path` names a file or a folder, or nothing. */
const char *iso_volume_array_of(const char *path);

/* Reads only the header of `path` (a file, a folder, or FILE:/array). Errors: ISO_ERR_IO (missing,
 * unreadable, truncated), ISO_ERR_FORMAT (not a volume), ISO_ERR_UNSUPPORTED, ISO_ERR_USAGE (no such
 * component, grid or series), ISO_ERR_BRIDGE. Each text names the file. */
iso_status iso_volume_read_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_error *error);

/* The format, as in iso_volume_info, of a file that begins with these bytes, of which 1024 are enough. NULL:
 * not recognised, as raw files and formats that only the name tells. */
const char *iso_volume_format(const void *bytes, size_t count);

/* From now on files that are opened may be on web servers (iso_file_set_fetcher): they are copied to the
 * cache (remote/remote.h). Volumes are read from there without this. */
void iso_volume_use_servers(void);

/* Whether files of this format need not hold all voxels: those in tiles that are absent have one value. */
bool iso_volume_may_be_sparse(const iso_volume_info *info);

/* The source of the chunks of a dense volume, which is borrowed: in memory, mapped or in tiles. */
iso_chunk_source iso_volume_source(const iso_rgrid *grid);

/* ISO_ERR_LIMIT: reading the volume that `info` describes takes more than opts->max_memory. */
iso_status iso_volume_check_memory(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                   iso_error *error);

/* Reads the volume; a dense grid has its index (iso_brick_index_of). Errors: those of iso_volume_read_info;
 * ISO_ERR_LIMIT: over max_memory, checked before anything is allocated; ISO_ERR_NOMEM. A file that is shorter
 * than its header says is ISO_ERR_IO in every format. */
iso_status iso_volume_read(const char *path, const iso_volume_opts *opts, iso_volume *volume,
                           iso_error *error);
void iso_volume_free(iso_volume *volume);

/* Adds a line to info->notes, or drops it if ISO_VOLUME_NOTES is exceeded. Arguments may contain any bytes.
 * For readers. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void iso_volume_note(iso_volume_info *info, const char *format, ...);

ISO_C_END
#endif
