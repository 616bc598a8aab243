/* make_zarr: writes small arrays of Zarr. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <blosc.h>
#include <cmocka.h>
#include <lz4.h>
#include <zlib.h>
#include <zstd.h>
#if ISO_HAVE_BZIP2
#include <bzlib.h>
#endif

#include "base/crc32c.h"
#include "file_support.h"
#include "grids/volume/volume.h"
#include "make_volumes.h"
#include "make_zarr.h"
#include "volume_support.h"

zarr_layout zarr_usual(int version) {
    return (zarr_layout){.version = version,
                         .shape = {2, 11, 13, 19},
                         .chunk = {1, 4, 5, 8},
                         .order = {0, 1, 2, 3},
                         .type = "i2",
                         .prefix = version == 3,
                         .separator = version == 3 ? '/' : '.',
                         .missing = -1,
                         .fill = "7"};
}

double zarr_value_at(const int at[ZARR_AXES]) {
    return (7 * at[3] + 3 * at[2] + 11 * at[1] + 29 * at[0]) % 120;
}

int zarr_size_of(const zarr_layout *l) {
    return l->type[1] - '0';
}

/* The bits of a whole number from 0 to 2047 as a float of 16 bits. */
static uint16_t half_of(int value) {
    int exponent = 0;
    while (value >> exponent > 1) exponent++;
    return value ? (uint16_t)((exponent + 15) << 10 | ((value << (10 - exponent)) & 1023)) : 0;
}

void zarr_store(const zarr_layout *l, double value, unsigned char *target) {
    const int size = zarr_size_of(l);
    const float real = (float)value;
    const int64_t integer = (int64_t)value;
    const uint16_t half = half_of((int)value);
    if (l->type[0] == 'f' && size == 2)
        memcpy(target, &half, sizeof half);
    else if (l->type[0] == 'f')
        memcpy(target, size == 4 ? (const void *)&real : (const void *)&value, (size_t)size);
    else
        memcpy(target, &integer, (size_t)size);
    for (int i = 0; l->big && i < size / 2; i++) {
        const unsigned char byte = target[i];
        target[i] = target[size - 1 - i];
        target[size - 1 - i] = byte;
    }
}

/* ---- writing */

unsigned char zarr_plain[ZARR_MOST], zarr_coded[ZARR_MOST];
static unsigned char shard[4 * ZARR_MOST];

/* Filters of integers, as numcodecs has them. */
static void apply_filters(const zarr_layout *l, size_t bytes) {
    const size_t size = (size_t)zarr_size_of(l), count = bytes / size;
    for (size_t i = count - 1; l->delta && i > 0; i--) {
        uint64_t own = 0, before = 0;
        memcpy(&own, zarr_plain + i * size, size);
        memcpy(&before, zarr_plain + (i - 1) * size, size);
        own -= before;
        memcpy(zarr_plain + i * size, &own, size);
    }
    if (!l->shuffle) return;
    for (size_t i = 0; i < count; i++)
        for (size_t byte = 0; byte < size; byte++) zarr_coded[byte * count + i] = zarr_plain[i * size + byte];
    memcpy(zarr_plain, zarr_coded, bytes);
}

static size_t fill_chunk(const zarr_layout *l, const int index[ZARR_AXES]) {
    int at[ZARR_AXES];
    size_t bytes = 0;
    int count[ZARR_AXES];
    for (int i = 0; i < ZARR_AXES; i++) count[i] = l->chunk[l->order[i]];
    for (int a = 0; a < count[0]; a++)
        for (int b = 0; b < count[1]; b++)
            for (int c = 0; c < count[2]; c++)
                for (int d = 0; d < count[3]; d++) {
                    const int inner[ZARR_AXES] = {a, b, c, d};
                    for (int i = 0; i < ZARR_AXES; i++)
                        at[l->order[i]] = index[l->order[i]] * l->chunk[l->order[i]] + inner[i];
                    zarr_store(l, zarr_value_at(at), zarr_plain + bytes);
                    bytes += (size_t)zarr_size_of(l);
                }
    apply_filters(l, bytes);
    return bytes;
}

static size_t deflate_chunk(size_t bytes, int window) {
    z_stream stream = {
        .next_in = zarr_plain, .avail_in = (uInt)bytes, .next_out = zarr_coded, .avail_out = ZARR_MOST};
    assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    return stream.total_out;
}

size_t zarr_code_chunk(const zarr_layout *l, size_t bytes) {
    size_t size = bytes;
    switch (l->coding) {
    case ZARR_ZLIB:
        size = deflate_chunk(bytes, 15);
        break;
    case ZARR_GZIP:
        size = deflate_chunk(bytes, 15 + 16);
        break;
    case ZARR_ZSTD:
        size = ZSTD_compress(zarr_coded, ZARR_MOST, zarr_plain, bytes, 3);
        break;
    case ZARR_LZ4:
        for (int i = 0; i < 4; i++) zarr_coded[i] = (unsigned char)(bytes >> 8 * i);
        size = 4 + (size_t)LZ4_compress_default((const char *)zarr_plain, (char *)zarr_coded + 4, (int)bytes,
                                                ZARR_MOST - 4);
        break;
    case ZARR_BLOSC:
        size = (size_t)blosc_compress_ctx(5, 1, (size_t)zarr_size_of(l), bytes, zarr_plain, zarr_coded,
                                          ZARR_MOST, l->compressor, 0, 1);
        break;
#if ISO_HAVE_BZIP2
    case ZARR_BZ2: {
        unsigned room = ZARR_MOST;
        assert_int_equal(
            BZ2_bzBuffToBuffCompress((char *)zarr_coded, &room, (char *)zarr_plain, (unsigned)bytes, 9, 0, 0),
            BZ_OK);
        size = room;
        break;
    }
#endif
    default:
        memcpy(zarr_coded, zarr_plain, bytes);
    }
    if (!l->checked) return size;
    const uint32_t sum = iso_crc32c(0, zarr_coded, size);
    for (int i = 0; i < 4; i++) zarr_coded[size + (size_t)i] = (unsigned char)(sum >> 8 * i);
    return size + 4;
}

static void chunk_name(const zarr_layout *l, const char *path, const int index[ZARR_AXES], char name[512]) {
    int length = snprintf(name, 512, "%s/%s", path, l->prefix ? "c" : "");
    for (int i = 0; i < ZARR_AXES; i++) {
        if (i || l->prefix) name[length++] = l->separator;
        name[length] = 0;
        mkdir(path, 0777);
        if (l->separator == '/' && (i || l->prefix)) {
            name[length] = 0;
            mkdir(name, 0777);
        }
        length += snprintf(name + length, (size_t)(512 - length), "%d", index[i]);
    }
}

void zarr_write_metadata(const zarr_layout *l, const char *path) {
    char text[4096], codecs[1024] = "", endian[64], file[600], filters[200] = "null";
    static const char *const names[ZARR_ALL_CODINGS] = {NULL, "zlib", "gzip", "zstd", "lz4", "blosc", "bz2"};
    const char *fill = l->fill_text ? l->fill_text : l->fill;
    char delta[100] = "", shuffle[100] = "";
    if (l->delta) snprintf(delta, sizeof delta, "{\"id\":\"delta\",\"dtype\":\"<%s\"}", l->type);
    if (l->shuffle)
        snprintf(shuffle, sizeof shuffle, "{\"id\":\"shuffle\",\"elementsize\":%d}", zarr_size_of(l));
    if (l->delta || l->shuffle)
        snprintf(filters, sizeof filters, "[%s%s%s]", delta, *delta && *shuffle ? "," : "", shuffle);
    snprintf(endian, sizeof endian, "{\"name\":\"bytes\",\"configuration\":{\"endian\":\"%s\"}}",
             l->big ? "big" : "little");
    if (l->version == 2) {
        if (names[l->coding]) snprintf(codecs, sizeof codecs, "{\"id\":\"%s\"}", names[l->coding]);
        snprintf(text, sizeof text,
                 "{\"zarr_format\":2,\"shape\":[%d,%d,%d,%d],\"chunks\":[%d,%d,%d,%d],\"dtype\":\"%c%s\","
                 "\"order\":\"%c\",\"fill_value\":%s,\"filters\":%s,\"compressor\":%s,"
                 "\"dimension_separator\":\"%c\"}",
                 l->shape[0], l->shape[1], l->shape[2], l->shape[3], l->chunk[0], l->chunk[1], l->chunk[2],
                 l->chunk[3], l->big ? '>' : '<', l->type, l->order[0] ? 'F' : 'C', fill, filters,
                 *codecs ? codecs : "null", l->separator);
        snprintf(file, sizeof file, "%s/.zarray", path);
        vol_write_text(file, text);
        return;
    }
    int length = 0;
    if (l->order[0] != 0 || l->order[1] != 1)
        length = snprintf(codecs, sizeof codecs,
                          "{\"name\":\"transpose\",\"configuration\":{\"order\":[%d,%d,%d,%d]}},",
                          l->order[0], l->order[1], l->order[2], l->order[3]);
    length += snprintf(codecs + length, sizeof codecs - (size_t)length, "%s", endian);
    if (l->shuffle)
        length += snprintf(codecs + length, sizeof codecs - (size_t)length,
                           ",{\"name\":\"numcodecs.shuffle\",\"configuration\":{\"elementsize\":%d}}",
                           zarr_size_of(l));
    if (names[l->coding])
        length += snprintf(
            codecs + length, sizeof codecs - (size_t)length, ",{\"name\":\"%s%s\",\"configuration\":{}}",
            l->coding == ZARR_LZ4 || l->coding == ZARR_ZLIB || l->coding == ZARR_BZ2 ? "numcodecs." : "",
            names[l->coding]);
    if (l->checked) snprintf(codecs + length, sizeof codecs - (size_t)length, ",{\"name\":\"crc32c\"}");
    char all[2048];
    int outer[ZARR_AXES];
    for (int i = 0; i < ZARR_AXES; i++) outer[i] = l->chunk[i] * (l->across[0] ? l->across[i] : 1);
    if (l->across[0])
        snprintf(all, sizeof all,
                 "{\"name\":\"sharding_indexed\",\"configuration\":{\"chunk_shape\":[%d,%d,%d,%d],\"codecs\":"
                 "[%s],\"index_codecs\":[{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}},"
                 "{\"name\":\"crc32c\"}],\"index_location\":\"%s\"}}",
                 l->chunk[0], l->chunk[1], l->chunk[2], l->chunk[3], codecs,
                 l->index_at_start ? "start" : "end");
    else
        snprintf(all, sizeof all, "%s", codecs);
    const char *kind = strcmp(l->type, "u1") == 0   ? "uint8"
                       : strcmp(l->type, "i1") == 0 ? "int8"
                       : strcmp(l->type, "u2") == 0 ? "uint16"
                       : strcmp(l->type, "i2") == 0 ? "int16"
                       : strcmp(l->type, "u4") == 0 ? "uint32"
                       : strcmp(l->type, "i8") == 0 ? "int64"
                       : strcmp(l->type, "f2") == 0 ? "float16"
                       : strcmp(l->type, "f4") == 0 ? "float32"
                                                    : "float64";
    snprintf(text, sizeof text,
             "{\"zarr_format\":3,\"node_type\":\"array\",\"shape\":[%d,%d,%d,%d],\"data_type\":\"%s\","
             "\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":[%d,%d,%d,%d]}},"
             "\"chunk_key_encoding\":{\"name\":\"%s\",\"configuration\":{\"separator\":\"%c\"}},"
             "\"fill_value\":%s,\"codecs\":[%s],\"dimension_names\":[\"c\",\"z\",\"y\",\"x\"]}",
             l->shape[0], l->shape[1], l->shape[2], l->shape[3], kind, outer[0], outer[1], outer[2], outer[3],
             l->prefix ? "default" : "v2", l->separator, fill, all);
    snprintf(file, sizeof file, "%s/zarr.json", path);
    vol_write_text(file, text);
}

int zarr_chunks_along(const zarr_layout *l, int axis) {
    return (l->shape[axis] - 1) / l->chunk[axis] + 1;
}

int zarr_number_of(const zarr_layout *l, const int index[ZARR_AXES]) {
    int number = 0;
    for (int i = 0; i < ZARR_AXES; i++) number = number * zarr_chunks_along(l, i) + index[i];
    return number;
}

static void put_entry(unsigned char *entry, uint64_t offset, uint64_t size) {
    for (int i = 0; i < 8; i++) {
        entry[i] = (unsigned char)(offset >> 8 * i);
        entry[8 + i] = (unsigned char)(size >> 8 * i);
    }
}

/* Writes the shard that begins at a chunk. */
static void write_shard(const zarr_layout *l, const char *path, const int first[ZARR_AXES]) {
    int all = 1, at[ZARR_AXES], place[ZARR_AXES];
    for (int i = 0; i < ZARR_AXES; i++) all *= l->across[i];
    const size_t index_bytes = 16 * (size_t)all + 4;
    unsigned char *entries = malloc(index_bytes);
    size_t used = l->index_at_start ? index_bytes : 0;
    for (int n = 0; n < all; n++) {
        bool inside = true;
        for (int i = ZARR_AXES - 1, rest = n; i >= 0; rest /= l->across[i], i--) {
            at[i] = first[i] + rest % l->across[i];
            inside &= at[i] < zarr_chunks_along(l, i);
        }
        put_entry(entries + 16 * n, UINT64_MAX, UINT64_MAX);
        if (!inside || zarr_number_of(l, at) == l->missing) continue;
        const size_t size = zarr_code_chunk(l, fill_chunk(l, at));
        memcpy(shard + used, zarr_coded, size);
        put_entry(entries + 16 * n, used, size);
        used += size;
    }
    const uint32_t sum = iso_crc32c(0, entries, index_bytes - 4);
    for (int i = 0; i < 4; i++) entries[index_bytes - 4 + (size_t)i] = (unsigned char)(sum >> 8 * i);
    memcpy(shard + (l->index_at_start ? 0 : used), entries, index_bytes);
    if (!l->index_at_start) used += index_bytes;
    free(entries);
    char name[512];
    for (int i = 0; i < ZARR_AXES; i++) place[i] = first[i] / l->across[i];
    chunk_name(l, path, place, name);
    spill(name, shard, used);
}

void zarr_write_array(const zarr_layout *l, const char *path) {
    char command[600], name[512];
    int at[ZARR_AXES];
    snprintf(command, sizeof command, "rm -rf %s && mkdir -p %s", path, path);
    assert_int_equal(system(command), 0);
    zarr_write_metadata(l, path);
    for (at[0] = 0; at[0] < zarr_chunks_along(l, 0); at[0]++)
        for (at[1] = 0; at[1] < zarr_chunks_along(l, 1); at[1]++)
            for (at[2] = 0; at[2] < zarr_chunks_along(l, 2); at[2]++)
                for (at[3] = 0; at[3] < zarr_chunks_along(l, 3); at[3]++) {
                    bool begins = true;
                    for (int i = 0; i < ZARR_AXES; i++) begins &= !l->across[0] || at[i] % l->across[i] == 0;
                    if (l->across[0] && begins) write_shard(l, path, at);
                    if (l->across[0] || zarr_number_of(l, at) == l->missing) continue;
                    const size_t size = zarr_code_chunk(l, fill_chunk(l, at));
                    chunk_name(l, path, at, name);
                    spill(name, zarr_coded, size);
                }
}

/* ---- reading */

bool zarr_is_missing(const zarr_layout *l, const int at[ZARR_AXES]) {
    int index[ZARR_AXES];
    for (int i = 0; i < ZARR_AXES; i++) index[i] = at[i] / l->chunk[i];
    return zarr_number_of(l, index) == l->missing;
}

void zarr_expect_array(const zarr_layout *l, const char *path) {
    for (int component = 0; component < l->shape[0]; component++) {
        const iso_volume_opts opts = {.component = component};
        iso_volume volume = test_read_volume(path, &opts);
        const int *dims = iso_grid_dims(&volume.grid);
        for (int i = 0; i < 3; i++) assert_int_equal(dims[i], l->shape[3 - i]);
        assert_int_equal(volume.info.components, l->shape[0]);
        int at[ZARR_AXES] = {component};
        for (at[1] = 0; at[1] < dims[2]; at[1]++)
            for (at[2] = 0; at[2] < dims[1]; at[2]++)
                for (at[3] = 0; at[3] < dims[0]; at[3]++) {
                    const double wanted = zarr_is_missing(l, at) ? atof(l->fill) : zarr_value_at(at);
                    const double got = (double)iso_grid_at(&volume.grid, at[3], at[2], at[1]);
                    if (got != wanted)
                        fail_msg("voxel %d %d %d of component %d: %g, expected %g", at[3], at[2], at[1],
                                 component, got, wanted);
                }
        iso_volume_free(&volume);
    }
}
