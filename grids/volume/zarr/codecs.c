/* codecs: undoes the codecs that turn bytes into bytes: blosc, zstd, lz4, zlib, gzip and crc32c. The
 * decoded size is known beforehand, so that a chunk cannot become larger than its header says. */
#include <blosc.h>
#include <limits.h>
#include <lz4.h>
#include <string.h>
#include <zlib.h>
#include <zstd.h>

#include "base/crc32c.h"
#include "grids/volume/zarr/zarr.h"

static const struct {
    const char *name;
    iso_zarr_codec codec;
} codec_names[] = {{"blosc", ISO_ZARR_BLOSC}, {"zstd", ISO_ZARR_ZSTD}, {"lz4", ISO_ZARR_LZ4},
                   {"zlib", ISO_ZARR_ZLIB},   {"gzip", ISO_ZARR_GZIP}, {"crc32c", ISO_ZARR_CRC32C}};

bool iso_zarr_codec_of_name(const char *name, iso_zarr_codec *codec) {
    static const char prefix[] = "numcodecs.";
    if (strncmp(name, prefix, sizeof prefix - 1) == 0) name += sizeof prefix - 1;
    for (size_t i = 0; i < sizeof codec_names / sizeof *codec_names; i++)
        if (strcmp(name, codec_names[i].name) == 0) {
            *codec = codec_names[i].codec;
            return true;
        }
    return false;
}

const char *iso_zarr_codec_name(iso_zarr_codec codec) {
    for (size_t i = 0; i < sizeof codec_names / sizeof *codec_names; i++)
        if (codec_names[i].codec == codec) return codec_names[i].name;
    return "";
}

/* What a codec that was applied after another one may have added to incompressible bytes. */
static uint64_t slack(uint64_t bytes) {
    return bytes / 64 + 4096;
}

uint64_t iso_zarr_decode_room(uint64_t bytes) {
    return 2 * (bytes + slack(bytes));
}

/* Bytes to decode, and where to: at most `room` bytes. */
typedef struct step {
    const unsigned char *input;
    size_t size;
    unsigned char *target;
    size_t room, got;
} step;

/* Each returns NULL, or what is wrong. */
static const char damaged[] = "damaged", too_large[] = "decodes to more bytes than its array states";

static const char *decode_blosc(step *s) {
    size_t bytes;
    if (s->size > INT_MAX || blosc_cbuffer_validate(s->input, s->size, &bytes) != 0) return damaged;
    if (bytes > s->room) return too_large;
    const int got = blosc_decompress_ctx(s->input, s->target, s->room, 1);
    if (got < 0 || (size_t)got != bytes) return damaged;
    s->got = bytes;
    return NULL;
}

static const char *decode_zstd(step *s) {
    const unsigned long long stated = ZSTD_getFrameContentSize(s->input, s->size);
    if (stated == ZSTD_CONTENTSIZE_ERROR) return damaged;
    if (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated > s->room) return too_large;
    const size_t got = ZSTD_decompress(s->target, s->room, s->input, s->size);
    if (ZSTD_isError(got)) return damaged;
    s->got = got;
    return NULL;
}

static const char *decode_lz4(step *s) {
    if (s->size < 4 || s->size > INT_MAX) return damaged;
    const uint32_t bytes =
        s->input[0] | (uint32_t)s->input[1] << 8 | (uint32_t)s->input[2] << 16 | (uint32_t)s->input[3] << 24;
    if (bytes > s->room) return too_large;
    if (bytes > INT_MAX) return damaged;
    const int got =
        LZ4_decompress_safe((const char *)s->input + 4, (char *)s->target, (int)(s->size - 4), (int)bytes);
    if (got < 0 || (uint32_t)got != bytes) return damaged;
    s->got = bytes;
    return NULL;
}

/* zlib and gzip, also several members one after another. zlib counts in 32 bits. */
static const char *decode_zlib(step *s) {
    z_stream stream = {0};
    if (inflateInit2(&stream, 15 + 32) != Z_OK) return "out of memory";
    size_t read = 0;
    int code = Z_OK;
    const char *wrong = NULL;
    s->got = 0;
    while (!wrong && !(code == Z_STREAM_END && read == s->size)) {
        const size_t left = s->size - read, room = s->room - s->got;
        if (code == Z_STREAM_END) inflateReset(&stream);
        stream.next_in = (unsigned char *)(uintptr_t)(s->input + read);
        stream.avail_in = left < UINT_MAX ? (uInt)left : UINT_MAX;
        stream.next_out = s->target + s->got;
        stream.avail_out = room < UINT_MAX ? (uInt)room : UINT_MAX;
        code = inflate(&stream, Z_NO_FLUSH);
        const size_t taken = (size_t)(stream.next_in - s->input) - read,
                     put = (size_t)(stream.next_out - s->target) - s->got;
        read += taken;
        s->got += put;
        if (code != Z_OK && code != Z_STREAM_END)
            wrong = room == 0 && read < s->size ? too_large : damaged;
        else if (code == Z_OK && !taken && !put)
            wrong = damaged;
    }
    inflateEnd(&stream);
    return wrong;
}

static const char *decode_crc32c(step *s) {
    if (s->size < 4) return damaged;
    const size_t bytes = s->size - 4;
    const unsigned char *stored = s->input + bytes;
    const uint32_t sum =
        stored[0] | (uint32_t)stored[1] << 8 | (uint32_t)stored[2] << 16 | (uint32_t)stored[3] << 24;
    if (iso_crc32c(0, s->input, bytes) != sum) return "damaged: its checksum is wrong";
    if (bytes > s->room) return too_large;
    memcpy(s->target, s->input, bytes);
    s->got = bytes;
    return NULL;
}

static const char *decode_one(iso_zarr_codec codec, step *s) {
    switch (codec) {
    case ISO_ZARR_BLOSC:
        return decode_blosc(s);
    case ISO_ZARR_ZSTD:
        return decode_zstd(s);
    case ISO_ZARR_LZ4:
        return decode_lz4(s);
    case ISO_ZARR_CRC32C:
        return decode_crc32c(s);
    default:
        return decode_zlib(s);
    }
}

iso_status iso_zarr_decode(const iso_zarr_codecs *codecs, const char *name, const void *input, size_t size,
                           void *target, size_t bytes, void *room, iso_error *error) {
    const size_t half = (size_t)iso_zarr_decode_room(bytes) / 2;
    unsigned char *const halves[2] = {room, (unsigned char *)room + half};
    step s = {.input = input, .size = size};
    if (codecs->count == 0) {
        if (size == bytes) memcpy(target, input, bytes);
        s.got = size;
    }
    for (int i = codecs->count - 1; i >= 0; i--) {
        s.target = i ? halves[i % 2] : target;
        s.room = i ? half : bytes;
        const char *wrong = decode_one(codecs->codec[i], &s);
        if (wrong)
            return iso_fail(error, ISO_ERR_IO, "%s: %s (%s)", name, wrong,
                            iso_zarr_codec_name(codecs->codec[i]));
        s.input = s.target;
        s.size = s.got;
    }
    if (s.got == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated or damaged: it has %zu bytes of values instead of %zu",
                    name, s.got, bytes);
}
