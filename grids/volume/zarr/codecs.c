/* codecs: undoes the codecs of a chunk that turn bytes into bytes. */
#include <string.h>

#include "grids/volume/zarr/zarr.h"

bool iso_zarr_codec_of_name(const char *name, iso_zarr_codec *codec) {
    static const iso_zarr_codec codecs[] = {
        {ISO_CODEC_BLOSC, "blosc", 1},   {ISO_CODEC_ZSTD, "zstd", 1},       {ISO_CODEC_LZ4, "lz4", 1},
        {ISO_CODEC_ZLIB, "zlib", 1},     {ISO_CODEC_ZLIB, "gzip", 1},       {ISO_CODEC_BZIP2, "bz2", 1},
        {ISO_CODEC_CRC32C, "crc32c", 1}, {ISO_CODEC_SHUFFLE, "shuffle", 1}, {ISO_CODEC_DELTA, "delta", 1}};
    static const char prefix[] = "numcodecs.";
    if (strncmp(name, prefix, sizeof prefix - 1) == 0) name += sizeof prefix - 1;
    for (size_t i = 0; i < sizeof codecs / sizeof *codecs; i++)
        if (strcmp(name, codecs[i].name) == 0) {
            *codec = codecs[i];
            return iso_codec_is_built_in(codec->codec);
        }
    return false;
}

/* What a codec that was applied after another one may have added to incompressible bytes. */
static uint64_t slack(uint64_t bytes) {
    return bytes / 64 + 4096;
}

uint64_t iso_zarr_decode_room(uint64_t bytes) {
    return 2 * (bytes + slack(bytes));
}

iso_status iso_zarr_decode(const iso_zarr_codecs *codecs, const char *name, const void *input, size_t size,
                           void *target, size_t bytes, void *room, iso_error *error) {
    const size_t half = (size_t)iso_zarr_decode_room(bytes) / 2;
    unsigned char *const halves[2] = {room, (unsigned char *)room + half};
    iso_coded s = {.input = input, .size = size};
    if (codecs->count == 0) {
        if (size == bytes) memcpy(target, input, bytes);
        s.got = size;
    }
    for (int i = codecs->count - 1; i >= 0; i--) {
        s.target = i ? halves[i % 2] : target;
        s.room = i ? half : bytes;
        s.element = codecs->codec[i].element;
        const char *wrong = iso_codec_undo(codecs->codec[i].codec, &s);
        if (wrong) return iso_fail(error, ISO_ERR_IO, "%s: %s (%s)", name, wrong, codecs->codec[i].name);
        s.input = s.target;
        s.size = s.got;
    }
    if (s.got == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated or damaged: it has %zu bytes of values instead of %zu",
                    name, s.got, bytes);
}
