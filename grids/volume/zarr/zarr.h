/* zarr: the types and functions of the Zarr reader: arrays of Zarr v2 and v3, and multiscale images of
 * OME-Zarr 0.4 and 0.5, in folders or on servers; and arrays of N5, which have other metadata, and
 * headers of chunks.
 *
 * metadata.c reads the JSON files of an array, ome.c those of an image, codecs.c undoes the codecs of a
 * chunk (Zarr's word for its tiles) by grids/volume/codecs.h, chunks.c finds them in files and shards,
 * and format_zarr.c is the reader (a module, with jansson, zlib, libblosc, libzstd and liblz4). All texts
 * of the metadata come from outside: every number is checked, and names of folders cannot lead out of the
 * image's folder.
 *
 * Specifications: zarr-specs.readthedocs.io (v2, v3 with its codecs), ngff.openmicroscopy.org (0.4, 0.5),
 * github.com/saalfeldlab/n5. */
#ifndef ISO_GRIDS_VOLUME_ZARR_ZARR_H
#define ISO_GRIDS_VOLUME_ZARR_ZARR_H

#include <jansson.h>

#include "base/memory.h"
#include "grids/volume/codecs.h"
#include "grids/volume/format.h"
#include "grids/volume/remote/remote.h"

enum { ISO_ZARR_AXES = 8, ISO_ZARR_CODECS = 8, ISO_ZARR_LEVELS = 32, ISO_ZARR_NAME = 64 };

/* ---- codecs ---- */

typedef struct iso_zarr_codec {
    iso_codec codec;
    const char *name; /* for messages */
    size_t element;   /* bytes of a value, for filters */
} iso_zarr_codec;

/* From bytes to bytes, in the order in which they were applied. */
typedef struct iso_zarr_codecs {
    iso_zarr_codec codec[ISO_ZARR_CODECS];
    int count;
} iso_zarr_codecs;

/* "blosc", ...; elements have one byte. False: `name` is none of them, or its library was not there. */
bool iso_zarr_codec_of_name(const char *name, iso_zarr_codec *codec);

/* The bytes that iso_zarr_decode needs beside `bytes` decoded ones. */
uint64_t iso_zarr_decode_room(uint64_t bytes);

/* Undoes the codecs: `input` must become exactly `bytes` bytes at `target`. `room`: memory for
 * iso_zarr_decode_room(bytes) bytes. `name`: of the chunk, for messages. ISO_ERR_IO: damaged, or of another
 * size; nothing is written behind the target. */
iso_status iso_zarr_decode(const iso_zarr_codecs *codecs, const char *name, const void *input, size_t size,
                           void *target, size_t bytes, void *room, iso_error *error);

/* ---- arrays ---- */

typedef struct iso_zarr_array {
    int version; /* of Zarr, 2 or 3 */
    int axes;
    uint64_t shape[ISO_ZARR_AXES];
    uint64_t chunk[ISO_ZARR_AXES]; /* elements of a chunk; of one within a shard, if there are shards */
    uint64_t shard[ISO_ZARR_AXES]; /* elements of a file: of a shard, or of a chunk */
    bool sharded, index_at_start;  /* the index of a shard is at the file's start, else at its end */
    int shard_order
        [ISO_ZARR_AXES];      /* the axes along which the chunks of a shard are numbered, slowest first */
    int order[ISO_ZARR_AXES]; /* the axes of a decoded chunk, slowest first */
    iso_scalar scalar;
    bool big_endian;
    double fill; /* value of chunks that are absent */
    iso_zarr_codecs codecs, index_codecs;
    char separator;                           /* between the numbers in names of chunks */
    bool has_prefix;                          /* names begin with "c" */
    char names[ISO_ZARR_AXES][ISO_ZARR_NAME]; /* of the axes, or empty */
    bool n5;                       /* an array of N5: chunks have headers (n5.c), and are named from x on */
    double spacing[ISO_ZARR_AXES]; /* mm; 0: not stated (n5) */
} iso_zarr_array;

/* Reads a JSON file, an object; json_decref when done. *json is NULL, without an error, if the file does not
 * exist. Integers become reals. ISO_ERR_IO, ISO_ERR_FORMAT; ISO_ERR_LIMIT: it is too long for metadata. */
iso_status iso_zarr_read_json(const char *folder, const char *name, const iso_volume_opts *opts,
                              json_t **json, iso_error *error);

/* Reads the metadata of the array in a folder: zarr.json, .zarray, or attributes.json of N5, which are added
 * to opts->files. *found: whether the folder has an array. ISO_ERR_IO, ISO_ERR_FORMAT: damaged, or of a kind
 * that is not supported. */
iso_status iso_zarr_read_array(const char *folder, const iso_volume_opts *opts, iso_zarr_array *array,
                               bool *found, iso_error *error);

/* Millimetres of a unit of length; 0: not one that is known. */
double iso_zarr_unit_in_mm(const char *unit);

/* A number of JSON within a range; false: it is anything else. */
bool iso_zarr_number(const json_t *json, double low, double high, double *out);

/* ---- images ---- */

/* A multiscale image: several arrays, coarser and coarser ones. */
typedef struct iso_zarr_image {
    int axes;
    char axis_names[ISO_ZARR_AXES][ISO_ZARR_NAME];
    char axis_types[ISO_ZARR_AXES][ISO_ZARR_NAME]; /* "space", "time", "channel", or empty */
    double units[ISO_ZARR_AXES];                   /* mm of the unit of an axis; 0: none is stated */
    int levels;
    char *paths[ISO_ZARR_LEVELS]; /* folders of the arrays */
    double scale[ISO_ZARR_LEVELS][ISO_ZARR_AXES], translation[ISO_ZARR_LEVELS][ISO_ZARR_AXES];
    bool has_scale;
    char name[ISO_VOLUME_TEXT], version[ISO_ZARR_NAME];
    iso_channels channels; /* of the member omero */
} iso_zarr_image;

/* Reads the metadata of the image in a folder; iso_zarr_image_free when done, also after an error. An image
 * of a bioformats2raw folder with one image is that image. *found: whether the folder has an image.
 * ISO_ERR_IO; ISO_ERR_FORMAT: damaged, or a folder of several images, which the message names. */
iso_status iso_zarr_read_image(const char *folder, const iso_volume_opts *opts, iso_zarr_image *image,
                               bool *found, iso_error *error);
void iso_zarr_image_free(iso_zarr_image *image);

/* ---- files ---- */

/* The files of chunks or shards that exist, of those that hold the voxels of one component. Zero `numbers`
 * and `count`; set the others. On a server, whose folders cannot be listed, all may exist. */
typedef struct iso_zarr_files {
    int space[3];                  /* the axes of x, y and z; -1: there is none */
    uint64_t counts[3];            /* files along x, y and z */
    uint64_t fixed[ISO_ZARR_AXES]; /* the number of the file on the other axes */
    iso_buffer numbers;            /* uint64_t, ascending; files are numbered along x, y and z */
    size_t count;
    bool may_all_exist;
} iso_zarr_files;

/* Lists the files of the array in `folder`, unless it is on a server; iso_zarr_files_free when done, also
 * after an error. ISO_ERR_IO: a folder cannot be read; ISO_ERR_NOMEM. */
iso_status iso_zarr_files_list(const char *folder, const iso_zarr_array *array, iso_zarr_files *files,
                               iso_error *error);
void iso_zarr_files_free(iso_zarr_files *files);
/* The first file from number `from` on; UINT64_MAX: there is none. */
uint64_t iso_zarr_files_next(const iso_zarr_files *files, uint64_t from);

/* ---- chunks ---- */

/* The chunks of an array, for several threads at once. */
typedef struct iso_zarr_chunks iso_zarr_chunks;

/* The bytes of the index of a shard; 0: there are no shards. */
uint64_t iso_zarr_index_bytes(const iso_zarr_array *array);

/* `remote`: of a folder on a server. `index_memory`: bytes for indices of shards, one of which is always
 * kept. `folder` and `array` are copied. ISO_ERR_NOMEM. */
iso_status iso_zarr_chunks_create(const char *folder, const iso_zarr_array *array, const iso_remote *remote,
                                  uint64_t index_memory, iso_zarr_chunks **chunks, iso_error *error);
void iso_zarr_chunks_destroy(iso_zarr_chunks *chunks);

/* The elements of a chunk, and the most bytes that one may take in its file: codecs do not make data much
 * larger. */
uint64_t iso_zarr_chunk_elements(const iso_zarr_array *array);
uint64_t iso_zarr_most_encoded(const iso_zarr_array *array);

/* The first of `count` chunks of a shard, in a row along an axis from `index` on, that the shard has, 0 ..
 * count - 1; count: none. A shard that cannot be read has all. */
uint64_t iso_zarr_next_in_shard(iso_zarr_chunks *chunks, const uint64_t index[ISO_ZARR_AXES], int axis,
                                uint64_t count);

/* Reads and decodes a chunk into `target`, iso_zarr_chunk_elements values of the array's scalar in the
 * file's order of bytes and axes. *absent: there is none, and nothing is written. Errors name the file and
 * the chunk. ISO_ERR_IO, ISO_ERR_NOMEM. */
iso_status iso_zarr_read_chunk(iso_zarr_chunks *chunks, const uint64_t index[ISO_ZARR_AXES], void *target,
                               bool *absent, iso_error *error);

/* n5.c: decodes a block of N5 into a chunk, whose elements beyond the block become 0. `room`: as for
 * iso_zarr_decode. ISO_ERR_IO: damaged, or of a kind that is not supported. */
iso_status iso_zarr_decode_block(const iso_zarr_array *array, const char *name, const void *encoded,
                                 size_t size, void *target, void *room, iso_error *error);

/* Adds the files of at most `most` chunks or shards to a set. Nothing is added if there are more, or on a
 * server. */
void iso_zarr_list_files(iso_zarr_chunks *chunks, uint64_t most, iso_file_set *files);

#endif
