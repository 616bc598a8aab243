/* hdf5: the types and functions of the HDF5 reader.
 *
 * libhdf5 is not thread-safe, and damaged files make it crash or take any amount of time and memory. It is
 * therefore used only in a child process with limits (guard.c), and only to find out what a file contains
 * (describe.c, with conventions.c and library.c) and where the chunks of an array lie (places.c). The child
 * leaves its results in shared memory. chunk.c reads the chunks and unpacks them, without libhdf5, in any
 * number of threads. Arrays with filters or types that chunk.c does not know are decoded by libhdf5, one
 * chunk after the other, in a child process that stays (decoder.c). format_hdf5.c is the reader, in a
 * module. */
#ifndef ISO_GRIDS_VOLUME_HDF5_HDF5_H
#define ISO_GRIDS_VOLUME_HDF5_HDF5_H

#include "grids/volume/format.h"

enum { ISO_HDF5_AXES = 8, ISO_HDF5_FILTERS = 8, ISO_HDF5_PATH = 1024, ISO_HDF5_SPECIAL = 120 };

/* Filters by their registered numbers. */
enum {
    ISO_HDF5_DEFLATE = 1,
    ISO_HDF5_SHUFFLE = 2,
    ISO_HDF5_FLETCHER32 = 3,
    ISO_HDF5_BZIP2 = 307,
    ISO_HDF5_LZF = 32000,
    ISO_HDF5_BLOSC = 32001,
    ISO_HDF5_LZ4 = 32004,
    ISO_HDF5_ZSTD = 32015
};

/* An array of a file that can be read as voxels. Axes are in the order of the file, slowest first. Values
 * that lie in one piece are read in boxes, which count as chunks. */
typedef struct iso_hdf5_array {
    char path[ISO_HDF5_PATH]; /* in the file */
    int rank;
    uint64_t sizes[ISO_HDF5_AXES], chunk[ISO_HDF5_AXES];
    uint64_t at[ISO_HDF5_AXES]; /* the index that is read on axes that are not x, y or z */
    int xyz[3];                 /* the axes of the array that are x, y and z */
    iso_scalar scalar;
    bool big_endian;
    unsigned char fill[8];   /* the value of chunks that are not in the file, in the machine's byte order */
    bool chunked, allocated; /* false: in one piece; nothing is in the file, all values are `fill` */
    uint64_t stored;         /* chunks that are in the file, also those of other components */
    uint64_t address;        /* of values in one piece, in the file */
    int filter_count;
    int filters[ISO_HDF5_FILTERS];  /* in the order in which they were applied */
    uint64_t element_bytes;         /* the size of a value of the scalar */
    bool by_library;                /* libhdf5 decodes and converts the values */
    char special[ISO_HDF5_SPECIAL]; /* why: "integers of 12 bits in 2 bytes, filter 5 (nbit)" */
} iso_hdf5_array;

/* Scales of slices along z: a value is scale[z] * stored + offset[z]. */
enum { ISO_HDF5_SLICES = 1 << 14 };
typedef struct iso_hdf5_slices {
    int count; /* 0: there are none */
    double scale[ISO_HDF5_SLICES], offset[ISO_HDF5_SLICES];
} iso_hdf5_slices;

/* Positions of voxels along x, y and z that are not evenly spaced, in mm from the first voxel; they rise. */
enum { ISO_HDF5_POSITIONS = 1 << 14 };
typedef struct iso_hdf5_positions {
    int count[3]; /* 0: the axis is evenly spaced */
    double at[3][ISO_HDF5_POSITIONS];
} iso_hdf5_positions;

/* Where a chunk lies in the file. */
typedef struct iso_hdf5_place {
    uint64_t number; /* of the chunk, along x, y and z */
    uint64_t address;
    uint32_t bytes;
    uint32_t skipped; /* filters that were not applied to it, a bit for each */
} iso_hdf5_place;

/* ---- BigDataViewer's .xml ---- */

/* What it says about the image of a setup at a time. */
typedef struct iso_bdv_view {
    bool has_size, has_affine;
    double size[3]; /* of a voxel, above 0 */
    char unit[32];  /* of `size` */
    /* From indices of voxels to positions, in rows of four numbers. In `unit`, or in multiples of a voxel. */
    double affine[12];
} iso_bdv_view;

bool iso_bdv_is_xml(const char *path);
/* The path of the HDF5 file with the images (free). ISO_ERR_UNSUPPORTED: they are in no such file;
 * ISO_ERR_IO, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_bdv_file(const char *xml, char **path, iso_error *error);
/* ISO_ERR_FORMAT: its numbers are none; ISO_ERR_IO, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_bdv_read_view(const char *xml, unsigned time, unsigned setup, iso_bdv_view *view,
                             iso_error *error);

/* ---- in the child process ---- */

/* Chooses an array by opts->grid and the conventions of the file, and describes it. Sets of `info` what a
 * format's reader sets, the scales of slices, if they differ, and positions that are not evenly spaced.
 * ISO_ERR_IO: damaged; ISO_ERR_FORMAT: not HDF5, no array of numbers with three axes, or several without a
 * choice, which are listed; ISO_ERR_UNSUPPORTED: a filter, or values in other files; ISO_ERR_USAGE: no such
 * array or component; ISO_ERR_LIMIT. opts->channels, if it is not NULL, must be shared with the parent.
 * `xml`: the .xml of BigDataViewer that belongs to the file, or NULL. Leaves the file open: the process ends.
 */
iso_status iso_hdf5_describe(const char *path, const char *xml, const iso_volume_opts *opts,
                             iso_volume_info *info, iso_hdf5_array *array, iso_hdf5_slices *slices,
                             iso_hdf5_positions *positions, iso_error *error);

/* Finds the chunks that hold voxels and are in the file, in the order of their numbers; `places` has room for
 * array->stored, and *count becomes how many there are. ISO_ERR_IO. */
iso_status iso_hdf5_find_places(const char *path, const iso_hdf5_array *array, const int dims[3],
                                iso_hdf5_place *places, uint64_t *count, iso_error *error);

/* As iso_number_reader (grids/volume/module.h). */
iso_status iso_hdf5_read_numbers(const char *path, const char *array, uint64_t count, double *numbers,
                                 iso_error *error);

/* ---- the child process ---- */

/* A child process that does some work. */
typedef struct iso_hdf5_child {
    void (*work)(void *context);
    void *context;
    uint64_t memory;        /* bytes that it may take beside what this process has */
    int seconds;            /* of processor time that it may take */
    bool stays;             /* it does not end with the thread that starts it, and has to end by itself */
    volatile int *finished; /* in shared memory; set to 1 when the work is done */
    int id;                 /* of the process; 0: none */
} iso_hdf5_child;

/* Starts the process. Its output is lost. ISO_ERR_NOMEM: no process can be started. */
iso_status iso_hdf5_start_child(const char *path, iso_hdf5_child *child, iso_error *error);
/* Waits for the end of the process. Returns whether its work is done; if not, `reason` says why. */
bool iso_hdf5_end_child(iso_hdf5_child *child, char reason[ISO_HDF5_SPECIAL]);
/* In the child: so many seconds of processor time from now on. */
void iso_hdf5_allow_seconds(int seconds);

/* Runs `work` in a child process, which may take `memory` bytes beside what this process has, and `seconds`
 * of processor time. *finished must be in shared memory; it is set when the work is done. Output of the child
 * is lost. ISO_ERR_IO "path: ...": it crashed or took too long; ISO_ERR_NOMEM: no process can be started. */
iso_status iso_hdf5_guard(const char *path, uint64_t memory, int seconds, void (*work)(void *context),
                          void *context, volatile int *finished, iso_error *error);

/* Memory of zeros that is shared with child processes; NULL: none. iso_hdf5_unshare. */
void *iso_hdf5_share(size_t bytes);
void iso_hdf5_unshare(void *memory, size_t bytes);

/* ---- chunks ---- */

/* The numbers of chunks along x, y and z that hold the voxels, and their sizes in voxels. */
void iso_hdf5_chunk_grid(const iso_hdf5_array *array, const int dims[3], int counts[3], int voxels[3]);
/* counts[0] * counts[1] * counts[2]; UINT64_MAX: it does not fit into 64 bits. */
uint64_t iso_hdf5_chunk_count(const iso_hdf5_array *array, const int dims[3]);
/* The first element on each axis of the chunk with this number along x, y and z. */
void iso_hdf5_chunk_start(const iso_hdf5_array *array, const int index[3], uint64_t start[ISO_HDF5_AXES]);
/* The size in bytes of an unpacked chunk; UINT64_MAX: it does not fit into 64 bits. */
uint64_t iso_hdf5_chunk_bytes(const iso_hdf5_array *array);
/* The memory that iso_hdf5_read_chunk needs for unpacking. */
uint64_t iso_hdf5_chunk_room(const iso_hdf5_array *array);
/* "/path, the chunk at 0,64,64", for messages. */
enum { ISO_HDF5_CHUNK_NAME = 200 + ISO_HDF5_AXES * 24 };
void iso_hdf5_name_chunk(const iso_hdf5_array *array, const int index[3], char text[ISO_HDF5_CHUNK_NAME]);

typedef struct iso_hdf5_decoder iso_hdf5_decoder;

/* An array whose chunks are read. */
typedef struct iso_hdf5_source {
    const char *path; /* for messages */
    int descriptor;
    uint64_t file_bytes;
    iso_hdf5_array array;
    int dims[3];
    int counts[3], voxels[3];     /* iso_hdf5_chunk_grid */
    const iso_hdf5_place *places; /* of the chunks in the file, by their numbers; NULL: values in one piece */
    uint64_t place_count;
    iso_hdf5_slices *slices; /* owned (free); NULL: there are none */
    /* iso_hdf5_decode_chunk if the array is decoded by libhdf5, else NULL. */
    iso_status (*decode)(iso_hdf5_decoder *decoder, const int index[3], void *values, iso_error *error);
    iso_hdf5_decoder *decoder;
} iso_hdf5_source;

/* Reads and unpacks a chunk into voxels[0] * voxels[1] * voxels[2] values of the array's stored type
 * (iso_scalar_stored_type; floats if slices have scales), x fastest; those outside of the volume are
 * undefined. `room` has iso_hdf5_chunk_room bytes. For several threads. ISO_ERR_IO names the file, the array
 * and the chunk. */
iso_status iso_hdf5_read_chunk(const iso_hdf5_source *source, const int index[3], void *room, void *target,
                               iso_error *error);
/* Whether a filter can be undone without libhdf5. */
bool iso_hdf5_knows_filter(int filter);
/* The first chunk from chunk `from` on that is in the file, by its number along x, y and z; UINT64_MAX: there
 * is none. The values of chunks that are not in the file are the array's fill value. */
uint64_t iso_hdf5_next_stored(const iso_hdf5_source *source, uint64_t from);
/* The fill value, as a value of the stored type. */
float iso_hdf5_fill_value(const iso_hdf5_array *array);

/* ---- chunks that libhdf5 decodes ---- */

/* The memory that decoding takes: a chunk in shared memory, and what libhdf5 needs for its filters. */
uint64_t iso_hdf5_decoder_bytes(const iso_hdf5_array *array);

/* Starts the process that decodes the chunks of a source, which is borrowed. ISO_ERR_NOMEM. */
iso_status iso_hdf5_decoder_create(const iso_hdf5_source *source, iso_hdf5_decoder **decoder,
                                   iso_error *error);
void iso_hdf5_decoder_destroy(iso_hdf5_decoder *decoder);

/* Gives the values of a chunk as the scalar of the array, in the machine's byte order and the order of the
 * file; those outside of the array are undefined. For several threads, which wait for each other. ISO_ERR_IO
 * names the file, the array and the chunk, also if libhdf5 crashes; ISO_ERR_LIMIT; ISO_ERR_NOMEM. */
iso_status iso_hdf5_decode_chunk(iso_hdf5_decoder *decoder, const int index[3], void *values,
                                 iso_error *error);

#endif
