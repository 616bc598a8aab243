/* codecs: undoes blosc, zstd, lz4, zlib, gzip, bzip2, shuffling and crc32c. */
#include "grids/volume/codecs.h"

#include <limits.h>
#include <string.h>
#include <zlib.h>

#include "base/crc32c.h"

#if ISO_HAVE_CODECS
#include <blosc.h>
#include <lz4.h>
#include <zstd.h>
#endif
#if ISO_HAVE_BZIP2
#include <bzlib.h>
#endif

/* Each function returns NULL, or what is wrong. */
static const char damaged[] = "damaged", too_large[] = "decodes to more bytes than its array states";

static uint32_t little(const unsigned char *bytes) {
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

#if ISO_HAVE_CODECS
static uint32_t big(const unsigned char *bytes) {
    return bytes[3] | (uint32_t)bytes[2] << 8 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[0] << 24;
}

/* A block of LZ4 that has exactly `bytes` bytes. */
static bool decode_lz4_block(const unsigned char *input, size_t size, unsigned char *target, size_t bytes) {
    if (size > INT_MAX || bytes > INT_MAX) return false;
    const int got = LZ4_decompress_safe((const char *)input, (char *)target, (int)size, (int)bytes);
    return got >= 0 && (size_t)got == bytes;
}

static const char *decode_lz4(iso_coded *s) {
    if (s->size < 4) return damaged;
    const uint32_t bytes = little(s->input);
    if (bytes > s->room) return too_large;
    if (!decode_lz4_block(s->input + 4, s->size - 4, s->target, bytes)) return damaged;
    s->got = bytes;
    return NULL;
}

/* All bytes (uint64) and those of a block (uint32), then blocks behind their sizes (uint32), all big-endian.
 * Blocks that would not become smaller are stored as they are. */
static const char *decode_lz4_blocks(iso_coded *s) {
    if (s->size < 12) return damaged;
    const uint64_t bytes = (uint64_t)big(s->input) << 32 | big(s->input + 4);
    const size_t most = big(s->input + 8);
    size_t at = 12;
    if (bytes > s->room) return too_large;
    if (bytes && !most) return damaged;
    for (s->got = 0; s->got < bytes;) {
        const size_t left = (size_t)bytes - s->got, block = left < most ? left : most;
        if (s->size - at < 4) return damaged;
        const size_t size = big(s->input + at);
        at += 4;
        if (size > s->size - at) return damaged;
        if (size == block)
            memcpy(s->target + s->got, s->input + at, size);
        else if (!decode_lz4_block(s->input + at, size, s->target + s->got, block))
            return damaged;
        at += size;
        s->got += block;
    }
    return NULL;
}

/* Blocks behind a header of 21 bytes: "LZ4Block", the method (high four bits; 1: stored as it is, 2: LZ4),
 * both sizes and a checksum (uint32, little-endian). The last one is empty. */
static const char *decode_lz4_stream(iso_coded *s) {
    enum { HEADER = 21, STORED = 1, PACKED = 2 };
    size_t at = 0;
    for (s->got = 0;;) {
        if (s->size - at < HEADER || memcmp(s->input + at, "LZ4Block", 8) != 0) return damaged;
        const int method = s->input[at + 8] >> 4;
        const size_t size = little(s->input + at + 9), bytes = little(s->input + at + 13);
        at += HEADER;
        if (!bytes) return NULL;
        if (size > s->size - at) return damaged;
        if (bytes > s->room - s->got) return too_large;
        if (method == STORED && size == bytes)
            memcpy(s->target + s->got, s->input + at, size);
        else if (method != PACKED || !decode_lz4_block(s->input + at, size, s->target + s->got, bytes))
            return damaged;
        at += size;
        s->got += bytes;
    }
}

static const char *decode_blosc(iso_coded *s) {
    size_t bytes;
    if (s->size > INT_MAX || blosc_cbuffer_validate(s->input, s->size, &bytes) != 0) return damaged;
    if (bytes > s->room) return too_large;
    const int got = blosc_decompress_ctx(s->input, s->target, s->room, 1);
    if (got < 0 || (size_t)got != bytes) return damaged;
    s->got = bytes;
    return NULL;
}

static const char *decode_zstd(iso_coded *s) {
    const unsigned long long stated = ZSTD_getFrameContentSize(s->input, s->size);
    if (stated == ZSTD_CONTENTSIZE_ERROR) return damaged;
    if (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated > s->room) return too_large;
    const size_t got = ZSTD_decompress(s->target, s->room, s->input, s->size);
    if (ZSTD_isError(got)) return damaged;
    s->got = got;
    return NULL;
}
#endif

/* zlib and gzip, also several members one after another. zlib counts in 32 bits. */
static const char *decode_zlib(iso_coded *s) {
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

#if ISO_HAVE_BZIP2
static const char *decode_bzip2(iso_coded *s) {
    unsigned got = s->room < UINT_MAX ? (unsigned)s->room : UINT_MAX;
    if (s->size > UINT_MAX) return damaged;
    const int code = BZ2_bzBuffToBuffDecompress((char *)s->target, &got, (char *)(uintptr_t)s->input,
                                                (unsigned)s->size, 0, 0);
    if (code != BZ_OK) return code == BZ_OUTBUFF_FULL ? too_large : damaged;
    s->got = got;
    return NULL;
}
#endif

/* The first bytes of all values, then the second ones, and so on; bytes that do not make up a value follow
 * unchanged. */
static const char *decode_shuffle(iso_coded *s) {
    const size_t size = s->element, count = s->size / size;
    if (s->size > s->room) return too_large;
    for (size_t byte = 0; byte < size; byte++) {
        const unsigned char *plane = s->input + byte * count;
        for (size_t i = 0; i < count; i++) s->target[i * size + byte] = plane[i];
    }
    memcpy(s->target + count * size, s->input + count * size, s->size - count * size);
    s->got = s->size;
    return NULL;
}

static const char *decode_delta(iso_coded *s) {
    const size_t size = s->element;
    uint64_t sum = 0;
    if (s->size > s->room) return too_large;
    if (size > sizeof sum || s->size % size) return damaged;
    for (size_t at = 0; at < s->size; at += size) {
        uint64_t difference = 0;
        memcpy(&difference, s->input + at, size);
        sum += difference;
        memcpy(s->target + at, &sum, size);
    }
    s->got = s->size;
    return NULL;
}

static const char *decode_crc32c(iso_coded *s) {
    if (s->size < 4) return damaged;
    const size_t bytes = s->size - 4;
    if (iso_crc32c(0, s->input, bytes) != little(s->input + bytes)) return "damaged: its checksum is wrong";
    if (bytes > s->room) return too_large;
    memcpy(s->target, s->input, bytes);
    s->got = bytes;
    return NULL;
}

bool iso_codec_is_built_in(iso_codec codec) {
    switch (codec) {
    case ISO_CODEC_BLOSC:
    case ISO_CODEC_ZSTD:
    case ISO_CODEC_LZ4:
    case ISO_CODEC_LZ4_BLOCKS:
    case ISO_CODEC_LZ4_STREAM:
        return ISO_HAVE_CODECS;
    case ISO_CODEC_BZIP2:
        return ISO_HAVE_BZIP2;
    default:
        return true;
    }
}

const char *iso_codec_undo(iso_codec codec, iso_coded *s) {
    switch (codec) {
#if ISO_HAVE_CODECS
    case ISO_CODEC_BLOSC:
        return decode_blosc(s);
    case ISO_CODEC_ZSTD:
        return decode_zstd(s);
    case ISO_CODEC_LZ4:
        return decode_lz4(s);
    case ISO_CODEC_LZ4_BLOCKS:
        return decode_lz4_blocks(s);
    case ISO_CODEC_LZ4_STREAM:
        return decode_lz4_stream(s);
#endif
#if ISO_HAVE_BZIP2
    case ISO_CODEC_BZIP2:
        return decode_bzip2(s);
#endif
    case ISO_CODEC_ZLIB:
        return decode_zlib(s);
    case ISO_CODEC_SHUFFLE:
        return decode_shuffle(s);
    case ISO_CODEC_DELTA:
        return decode_delta(s);
    case ISO_CODEC_CRC32C:
        return decode_crc32c(s);
    default:
        return "cannot be decoded: built without its library";
    }
}
