/* codecs: undoes the compressions of pieces of files whose decoded size is known: chunks of Zarr and HDF5.
 * So a piece cannot become larger than the header of its file says. Compiled into each module that needs it,
 * because libisopoint is not linked to these libraries. */
#ifndef ISO_GRIDS_VOLUME_CODECS_H
#define ISO_GRIDS_VOLUME_CODECS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum iso_codec {
    ISO_CODEC_BLOSC,
    ISO_CODEC_ZSTD,
    ISO_CODEC_LZ4,        /* of numcodecs: the size (uint32, little-endian), then a block */
    ISO_CODEC_LZ4_BLOCKS, /* of HDF5's filter 32004: several blocks */
    ISO_CODEC_LZ4_STREAM, /* of lz4-java, for N5: several blocks, whose checksums are not looked at */
    ISO_CODEC_ZLIB,       /* or gzip, also several of them one behind the other */
    ISO_CODEC_BZIP2,
    ISO_CODEC_SHUFFLE, /* bytes of values of `element` bytes are reordered */
    ISO_CODEC_DELTA, /* little-endian integers of `element` bytes: each is the difference to the one before */
    ISO_CODEC_CRC32C /* four bytes behind the others */
} iso_codec;

/* Bytes to decode, and where to: at most `room` bytes. */
typedef struct iso_coded {
    const unsigned char *input;
    size_t size;
    unsigned char *target;
    size_t room;
    size_t element; /* bytes of a value, from 1; for the codecs that say so */
    size_t got;     /* set: bytes at the target */
} iso_coded;

/* Whether the library of a codec was there when this was built. */
bool iso_codec_is_built_in(iso_codec codec);

/* Returns NULL, or what is wrong: "damaged", .. Nothing is written behind the room. For several threads. */
const char *iso_codec_undo(iso_codec codec, iso_coded *coded);

#endif
