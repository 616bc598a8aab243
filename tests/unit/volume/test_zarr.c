/* Zarr: arrays of both versions, with every codec, order of memory, byte order and shards, give the same
 * voxels; OME-Zarr gives distances and levels; absent chunks have the fill value, damaged ones are errors
 * that name them. */
#define _GNU_SOURCE
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
#include "grids/volume/tiled.h"
#include "grids/volume/volume.h"
#include "make_volumes.h"
#include "volume_support.h"

static const char folder[] = ISO_TEST_TMP "/zarr";

enum { AXES = 4, MOST_BYTES = 1 << 20 }; /* c z y x */

typedef enum coding { PLAIN, ZLIB, GZIP, ZSTD, LZ4, BLOSC, BZ2, ALL_CODINGS } coding;
enum { CODINGS = ISO_HAVE_BZIP2 ? ALL_CODINGS : BZ2 };

/* How an array is written. */
typedef struct layout {
    int version;
    int shape[AXES], chunk[AXES], across[AXES]; /* across: chunks of a shard; 0: no shards */
    int order[AXES];                            /* the axes of a chunk in memory, slowest first */
    const char *type;                           /* "u1", "i2", "f4", .. */
    bool big, prefix, checked, index_at_start;
    char separator;
    coding coding;
    const char *compressor; /* of blosc */
    int missing;            /* the number of a chunk that is not written; -1: none */
    const char *fill;
    const char *fill_text; /* how the metadata have it; NULL: as it is */
    bool delta, shuffle;   /* filters; delta only in version 2 */
} layout;

static layout usual(int version) {
    return (layout){.version = version,
                    .shape = {2, 11, 13, 19},
                    .chunk = {1, 4, 5, 8},
                    .order = {0, 1, 2, 3},
                    .type = "i2",
                    .prefix = version == 3,
                    .separator = version == 3 ? '/' : '.',
                    .missing = -1,
                    .fill = "7"};
}

static double value_at(const int at[AXES]) {
    return (7 * at[3] + 3 * at[2] + 11 * at[1] + 29 * at[0]) % 120;
}

static int size_of(const layout *l) {
    return l->type[1] - '0';
}

/* The bits of a whole number from 0 to 2047 as a float of 16 bits. */
static uint16_t half_of(int value) {
    int exponent = 0;
    while (value >> exponent > 1) exponent++;
    return value ? (uint16_t)((exponent + 15) << 10 | ((value << (10 - exponent)) & 1023)) : 0;
}

static void store(const layout *l, double value, unsigned char *target) {
    const int size = size_of(l);
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

static unsigned char plain[MOST_BYTES], coded[MOST_BYTES], shard[4 * MOST_BYTES];

/* Filters of integers, as numcodecs has them. */
static void apply_filters(const layout *l, size_t bytes) {
    const size_t size = (size_t)size_of(l), count = bytes / size;
    for (size_t i = count - 1; l->delta && i > 0; i--) {
        uint64_t own = 0, before = 0;
        memcpy(&own, plain + i * size, size);
        memcpy(&before, plain + (i - 1) * size, size);
        own -= before;
        memcpy(plain + i * size, &own, size);
    }
    if (!l->shuffle) return;
    for (size_t i = 0; i < count; i++)
        for (size_t byte = 0; byte < size; byte++) coded[byte * count + i] = plain[i * size + byte];
    memcpy(plain, coded, bytes);
}

static size_t fill_chunk(const layout *l, const int index[AXES]) {
    int at[AXES];
    size_t bytes = 0;
    int count[AXES];
    for (int i = 0; i < AXES; i++) count[i] = l->chunk[l->order[i]];
    for (int a = 0; a < count[0]; a++)
        for (int b = 0; b < count[1]; b++)
            for (int c = 0; c < count[2]; c++)
                for (int d = 0; d < count[3]; d++) {
                    const int inner[AXES] = {a, b, c, d};
                    for (int i = 0; i < AXES; i++)
                        at[l->order[i]] = index[l->order[i]] * l->chunk[l->order[i]] + inner[i];
                    store(l, value_at(at), plain + bytes);
                    bytes += (size_t)size_of(l);
                }
    apply_filters(l, bytes);
    return bytes;
}

static size_t deflate_chunk(size_t bytes, int window) {
    z_stream stream = {.next_in = plain, .avail_in = (uInt)bytes, .next_out = coded, .avail_out = MOST_BYTES};
    assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    return stream.total_out;
}

static size_t code_chunk(const layout *l, size_t bytes) {
    size_t size = bytes;
    switch (l->coding) {
    case ZLIB:
        size = deflate_chunk(bytes, 15);
        break;
    case GZIP:
        size = deflate_chunk(bytes, 15 + 16);
        break;
    case ZSTD:
        size = ZSTD_compress(coded, MOST_BYTES, plain, bytes, 3);
        break;
    case LZ4:
        for (int i = 0; i < 4; i++) coded[i] = (unsigned char)(bytes >> 8 * i);
        size = 4 + (size_t)LZ4_compress_default((const char *)plain, (char *)coded + 4, (int)bytes,
                                                MOST_BYTES - 4);
        break;
    case BLOSC:
        size = (size_t)blosc_compress_ctx(5, 1, (size_t)size_of(l), bytes, plain, coded, MOST_BYTES,
                                          l->compressor, 0, 1);
        break;
#if ISO_HAVE_BZIP2
    case BZ2: {
        unsigned room = MOST_BYTES;
        assert_int_equal(
            BZ2_bzBuffToBuffCompress((char *)coded, &room, (char *)plain, (unsigned)bytes, 9, 0, 0), BZ_OK);
        size = room;
        break;
    }
#endif
    default:
        memcpy(coded, plain, bytes);
    }
    if (!l->checked) return size;
    const uint32_t sum = iso_crc32c(0, coded, size);
    for (int i = 0; i < 4; i++) coded[size + (size_t)i] = (unsigned char)(sum >> 8 * i);
    return size + 4;
}

static void chunk_name(const layout *l, const char *path, const int index[AXES], char name[512]) {
    int length = snprintf(name, 512, "%s/%s", path, l->prefix ? "c" : "");
    for (int i = 0; i < AXES; i++) {
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

static void write_metadata(const layout *l, const char *path) {
    char text[4096], codecs[1024] = "", endian[64], file[600], filters[200] = "null";
    static const char *const names[ALL_CODINGS] = {NULL, "zlib", "gzip", "zstd", "lz4", "blosc", "bz2"};
    const char *fill = l->fill_text ? l->fill_text : l->fill;
    char delta[100] = "", shuffle[100] = "";
    if (l->delta) snprintf(delta, sizeof delta, "{\"id\":\"delta\",\"dtype\":\"<%s\"}", l->type);
    if (l->shuffle) snprintf(shuffle, sizeof shuffle, "{\"id\":\"shuffle\",\"elementsize\":%d}", size_of(l));
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
        length +=
            snprintf(codecs + length, sizeof codecs - (size_t)length,
                     ",{\"name\":\"numcodecs.shuffle\",\"configuration\":{\"elementsize\":%d}}", size_of(l));
    if (names[l->coding])
        length += snprintf(
            codecs + length, sizeof codecs - (size_t)length, ",{\"name\":\"%s%s\",\"configuration\":{}}",
            l->coding == LZ4 || l->coding == ZLIB || l->coding == BZ2 ? "numcodecs." : "", names[l->coding]);
    if (l->checked) snprintf(codecs + length, sizeof codecs - (size_t)length, ",{\"name\":\"crc32c\"}");
    char all[2048];
    int outer[AXES];
    for (int i = 0; i < AXES; i++) outer[i] = l->chunk[i] * (l->across[0] ? l->across[i] : 1);
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

static int chunks_along(const layout *l, int axis) {
    return (l->shape[axis] - 1) / l->chunk[axis] + 1;
}

static int number_of(const layout *l, const int index[AXES]) {
    int number = 0;
    for (int i = 0; i < AXES; i++) number = number * chunks_along(l, i) + index[i];
    return number;
}

static void put_entry(unsigned char *entry, uint64_t offset, uint64_t size) {
    for (int i = 0; i < 8; i++) {
        entry[i] = (unsigned char)(offset >> 8 * i);
        entry[8 + i] = (unsigned char)(size >> 8 * i);
    }
}

/* Writes the shard that begins at a chunk. */
static void write_shard(const layout *l, const char *path, const int first[AXES]) {
    int all = 1, at[AXES], place[AXES];
    for (int i = 0; i < AXES; i++) all *= l->across[i];
    const size_t index_bytes = 16 * (size_t)all + 4;
    unsigned char *entries = malloc(index_bytes);
    size_t used = l->index_at_start ? index_bytes : 0;
    for (int n = 0; n < all; n++) {
        bool inside = true;
        for (int i = AXES - 1, rest = n; i >= 0; rest /= l->across[i], i--) {
            at[i] = first[i] + rest % l->across[i];
            inside &= at[i] < chunks_along(l, i);
        }
        put_entry(entries + 16 * n, UINT64_MAX, UINT64_MAX);
        if (!inside || number_of(l, at) == l->missing) continue;
        const size_t size = code_chunk(l, fill_chunk(l, at));
        memcpy(shard + used, coded, size);
        put_entry(entries + 16 * n, used, size);
        used += size;
    }
    const uint32_t sum = iso_crc32c(0, entries, index_bytes - 4);
    for (int i = 0; i < 4; i++) entries[index_bytes - 4 + (size_t)i] = (unsigned char)(sum >> 8 * i);
    memcpy(shard + (l->index_at_start ? 0 : used), entries, index_bytes);
    if (!l->index_at_start) used += index_bytes;
    free(entries);
    char name[512];
    for (int i = 0; i < AXES; i++) place[i] = first[i] / l->across[i];
    chunk_name(l, path, place, name);
    spill(name, shard, used);
}

static void write_array(const layout *l, const char *path) {
    char command[600], name[512];
    int at[AXES];
    snprintf(command, sizeof command, "rm -rf %s && mkdir -p %s", path, path);
    assert_int_equal(system(command), 0);
    write_metadata(l, path);
    for (at[0] = 0; at[0] < chunks_along(l, 0); at[0]++)
        for (at[1] = 0; at[1] < chunks_along(l, 1); at[1]++)
            for (at[2] = 0; at[2] < chunks_along(l, 2); at[2]++)
                for (at[3] = 0; at[3] < chunks_along(l, 3); at[3]++) {
                    bool begins = true;
                    for (int i = 0; i < AXES; i++) begins &= !l->across[0] || at[i] % l->across[i] == 0;
                    if (l->across[0] && begins) write_shard(l, path, at);
                    if (l->across[0] || number_of(l, at) == l->missing) continue;
                    const size_t size = code_chunk(l, fill_chunk(l, at));
                    chunk_name(l, path, at, name);
                    spill(name, coded, size);
                }
}

/* ---- reading */

static bool is_missing(const layout *l, const int at[AXES]) {
    int index[AXES];
    for (int i = 0; i < AXES; i++) index[i] = at[i] / l->chunk[i];
    return number_of(l, index) == l->missing;
}

static void expect_array(const layout *l, const char *path) {
    for (int component = 0; component < l->shape[0]; component++) {
        const iso_volume_opts opts = {.component = component};
        iso_volume volume = test_read_volume(path, &opts);
        const int *dims = iso_grid_dims(&volume.grid);
        for (int i = 0; i < 3; i++) assert_int_equal(dims[i], l->shape[3 - i]);
        assert_int_equal(volume.info.components, l->shape[0]);
        int at[AXES] = {component};
        for (at[1] = 0; at[1] < dims[2]; at[1]++)
            for (at[2] = 0; at[2] < dims[1]; at[2]++)
                for (at[3] = 0; at[3] < dims[0]; at[3]++) {
                    const double wanted = is_missing(l, at) ? atof(l->fill) : value_at(at);
                    const double got = (double)iso_grid_at(&volume.grid, at[3], at[2], at[1]);
                    if (got != wanted)
                        fail_msg("voxel %d %d %d of component %d: %g, expected %g", at[3], at[2], at[1],
                                 component, got, wanted);
                }
        iso_volume_free(&volume);
    }
}

static void write_and_check(const layout *l) {
    char path[256];
    snprintf(path, sizeof path, "%s/array", folder);
    write_array(l, path);
    expect_array(l, path);
}

static void test_every_layout(void **state) {
    static const char *const types[] = {"u1", "i1", "u2", "i2", "u4", "i8", "f4", "f8", "f2"};
    static const int orders[][AXES] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}};
    (void)state;
    for (int version = 2; version <= 3; version++)
        for (int kind = 0; kind < CODINGS; kind++)
            for (int variant = 0; variant < 12; variant++) {
                layout l = usual(version);
                l.coding = (coding)kind;
                l.compressor = (const char *const[]){"blosclz", "lz4", "lz4hc", "zlib", "zstd"}[variant % 5];
                l.type = types[(variant + kind) % 9];
                l.big = variant % 2;
                l.separator = variant % 3 ? '/' : '.';
                memcpy(l.order, orders[variant % (version == 2 ? 2 : 3)], sizeof l.order);
                l.chunk[0] = 1 + variant % 2;
                if (variant % 4 == 0) l.missing = 5;
                if (version == 3) {
                    l.checked = variant % 3 == 1;
                    l.prefix = variant % 5 != 0;
                    l.index_at_start = variant % 2;
                    if (variant >= 6) memcpy(l.across, (const int[]){1, 2, 3, 2}, sizeof l.across);
                }
                write_and_check(&l);
            }
}

/* Filters before the compressor. */
static void test_filters(void **state) {
    static const char *const types[] = {"u1", "i1", "u2", "i2", "u4", "i8", "f4"};
    (void)state;
    for (int version = 2; version <= 3; version++)
        for (int variant = 0; variant < 21; variant++) {
            layout l = usual(version);
            l.type = types[variant % 7];
            l.coding = (coding)(variant % 5);
            l.delta = version == 2 && variant % 7 != 6 && variant % 3 != 1;
            l.shuffle = variant % 3 != 0;
            write_and_check(&l);
        }
}

/* Fill values that are written as the bits of numbers, and as words. */
static void test_fill_values(void **state) {
    static const struct {
        const char *type, *text, *fill;
    } values[] = {{"f4", "\"0x40e00000\"", "7"},   {"f8", "\"0x401C000000000000\"", "7"},
                  {"f2", "\"0x4700\"", "7"},       {"f2", "\"0x0001\"", "5.9604644775390625e-08"},
                  {"f4", "\"-Infinity\"", "-inf"}, {"f2", "\"0x7c00\"", "inf"},
                  {"f4", "\"0x80000000\"", "0"}};
    static const char *const nans[][2] = {
        {"f4", "\"NaN\""}, {"f4", "\"0x7fc00000\""}, {"f8", "\"0x7ff8000000000001\""}, {"f2", "\"0xfe01\""}};
    char path[256];
    (void)state;
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        layout l = usual(3);
        l.type = values[i].type;
        l.fill = values[i].fill;
        l.fill_text = values[i].text;
        l.missing = 5;
        write_and_check(&l);
    }
    for (size_t i = 0; i < sizeof nans / sizeof *nans; i++) {
        layout l = usual(3);
        int at[AXES] = {0};
        l.type = nans[i][0];
        l.fill = nans[i][1];
        l.missing = 0;
        snprintf(path, sizeof path, "%s/array", folder);
        write_array(&l, path);
        iso_volume volume = test_read_volume(path, NULL);
        assert_true(is_missing(&l, at) && isnan(iso_grid_at(&volume.grid, 0, 0, 0)));
        assert_true(iso_grid_at(&volume.grid, 18, 12, 10) == 7 * 18 + 3 * 12 + 110 - 240);
        iso_volume_free(&volume);
    }
}

/* Chunk by chunk, with a cache too small for all. */
static void test_chunks(void **state) {
    (void)state;
    for (int sharded = 0; sharded < 2; sharded++) {
        layout l = usual(3);
        l.coding = BLOSC;
        l.compressor = "zstd";
        l.missing = 5;
        if (sharded) memcpy(l.across, (const int[]){1, 2, 2, 2}, sizeof l.across);
        char path[256];
        snprintf(path, sizeof path, "%s/chunks", folder);
        write_array(&l, path);
        const iso_volume_opts opts = {.mapped = true, .max_memory = 1 << 20};
        iso_volume volume = {0};
        assert_int_equal(iso_volume_read(path, &opts, &volume, NULL), ISO_OK);
        assert_true(iso_tiled_is(volume.grid.rgrid));
        const iso_chunk_source source = iso_volume_source(volume.grid.rgrid);
        const iso_brick_box box = {{0, 0, 0}, {2, 1, 1}};
        iso_grid_chunk chunk;
        iso_rgrid *grid = NULL;
        assert_true(iso_grid_chunk_make(source.dims, &source.transform, &box, &chunk));
        assert_int_equal(source.read(source.context, &chunk, NULL, &grid, NULL), ISO_OK);
        int at[AXES] = {0};
        for (at[1] = 0; at[1] < 11; at[1]++)
            for (at[2] = 0; at[2] < 13; at[2]++)
                for (at[3] = 0; at[3] < 19; at[3]++)
                    assert_true((double)iso_rgrid_at(grid, at[3], at[2], at[1]) ==
                                (is_missing(&l, at) ? 7 : value_at(at)));
        iso_rgrid_destroy(grid);
        iso_volume_free(&volume);
    }
}

/* ---- OME-Zarr */

static const char axes[] =
    "[{\"name\":\"c\",\"type\":\"channel\"},{\"name\":\"z\",\"type\":\"space\",\"unit\":"
    "\"micrometer\"},{\"name\":\"y\",\"type\":\"space\",\"unit\":\"nanometer\"},"
    "{\"name\":\"x\",\"type\":\"space\",\"unit\":\"millimeter\"}]";

static void write_image(const char *path, int version, const char *second) {
    char text[4096], scales[2048];
    snprintf(scales, sizeof scales,
             "\"multiscales\":[{\"version\":\"0.4\",\"name\":\"leaf\",\"axes\":%s,\"datasets\":[{\"path\":"
             "\"s0\",\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[1,2,500,0.25]},"
             "{\"type\":\"translation\",\"translation\":[0,10,20000,1]}]},{\"path\":\"%s\","
             "\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[1,4,1000,0.5]}]}],"
             "\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[1,3,1,1]}]}]",
             axes, second);
    snprintf(text, sizeof text,
             version == 2 ? "{%s}"
                          : "{\"zarr_format\":3,\"node_type\":\"group\","
                            "\"attributes\":{\"ome\":{\"version\":\"0.5\",%s}}}",
             scales);
    char name[512];
    snprintf(name, sizeof name, "rm -rf %s && mkdir -p %s", path, path);
    assert_int_equal(system(name), 0);
    for (int level = 0; level < 2; level++) {
        layout l = usual(version);
        for (int i = 1; i < AXES; i++) l.shape[i] >>= level;
        snprintf(name, sizeof name, "%s/%s", path, level ? "s1" : "s0");
        write_array(&l, name);
    }
    snprintf(name, sizeof name, "%s/%s", path, version == 2 ? ".zattrs" : "zarr.json");
    vol_write_text(name, text);
    snprintf(name, sizeof name, "%s/.zgroup", path);
    if (version == 2) vol_write_text(name, "{\"zarr_format\":2}");
}

static void expect_numbers(const double got[3], double x, double y, double z) {
    const double wanted[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (!(fabs(got[i] - wanted[i]) <= 1e-12 * (1 + fabs(wanted[i]))))
            fail_msg("number %d is %.17g, expected %.17g", i, got[i], wanted[i]);
}

static void test_images(void **state) {
    char path[256];
    (void)state;
    for (int version = 2; version <= 3; version++) {
        snprintf(path, sizeof path, "%s/image.ome.zarr", folder);
        write_image(path, version, "s1");
        expect_array(&(layout){.shape = {2, 11, 13, 19}, .chunk = {1, 4, 5, 8}, .missing = -1}, path);
        iso_volume volume = test_read_volume(path, NULL);
        expect_numbers(volume.info.transform.spacing, 0.25, 500e-6, 6e-3);
        expect_numbers(volume.info.transform.origin, 1, 20e-3, 30e-3);
        assert_string_equal(volume.info.name, "leaf");
        assert_false(test_has_note(&volume.info, "level"));
        iso_volume_free(&volume);
        const iso_volume_opts coarse = {.level = 1}, none = {.level = 2};
        volume = test_read_volume(path, &coarse);
        assert_int_equal(volume.info.dims[0], 9);
        expect_numbers(volume.info.transform.spacing, 0.5, 1000e-6, 12e-3);
        assert_true(test_has_note(&volume.info, "level 1 of 2"));
        iso_volume_free(&volume);
        test_expect_no_volume(path, &none, ISO_ERR_USAGE, "image.ome.zarr", "no level 2");
    }
}

/* Names that lead out of the image's folder. */
static void test_paths_stay_below(void **state) {
    static const char *const bad[] = {"../array", "/etc", "a/../../array", "", ".", "a//b", "s1/"};
    char path[256];
    (void)state;
    snprintf(path, sizeof path, "%s/outside", folder);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_image(path, 2 + (int)(i % 2), bad[i]);
        const iso_volume_opts second = {.level = 1};
        test_expect_no_volume(path, &second, ISO_ERR_FORMAT, "outside", "no folder below it");
    }
}

/* ---- bad files */

static void expect_damage(const layout *l, const char *file, size_t keep, int flip, iso_status status,
                          const char *text) {
    char path[256], name[512];
    snprintf(path, sizeof path, "%s/damaged", folder);
    write_array(l, path);
    snprintf(name, sizeof name, "%s/%s", path, file);
    size_t count;
    char *bytes = slurp(name, &count);
    if (flip >= 0) bytes[(size_t)flip < count ? (size_t)flip : count - 1] ^= 0x55;
    spill(name, bytes, keep < count ? keep : count);
    free(bytes);
    test_expect_no_volume(path, NULL, status, file, text);
}

static void test_damaged_chunks(void **state) {
    (void)state;
    layout l = usual(2);
    expect_damage(&l, "0.1.1.1", 100, -1, ISO_ERR_IO, "100 bytes of values instead of 320");
    for (int kind = ZLIB; kind < CODINGS; kind++) {
        l.coding = (coding)kind;
        l.compressor = "lz4";
        expect_damage(&l, "0.1.1.1", 20, -1, ISO_ERR_IO, "damaged/0.1.1.1");
        expect_damage(&l, "0.1.1.1", 0, -1, ISO_ERR_IO, "damaged/0.1.1.1");
    }
    l = usual(3);
    l.checked = true;
    expect_damage(&l, "c/0/1/1/1", 9999, 7, ISO_ERR_IO, "checksum");
    memcpy(l.across, (const int[]){1, 3, 3, 3}, sizeof l.across);
    expect_damage(&l, "c/0/0/0/0", 9999, 40, ISO_ERR_IO, "chunk 0: damaged: its checksum");
    expect_damage(&l, "c/0/0/0/0", 99999, 99999, ISO_ERR_IO, "index of the shard");
    expect_damage(&l, "c/0/0/0/0", 50, -1, ISO_ERR_IO, "truncated");
}

/* A chunk that decodes to more than its array states, and arrays that state more than the limit. */
static void test_bombs(void **state) {
    char path[256], name[512];
    (void)state;
    for (int kind = ZLIB; kind < CODINGS; kind++) {
        layout l = usual(2);
        l.coding = (coding)kind;
        l.compressor = "zstd";
        snprintf(path, sizeof path, "%s/bomb", folder);
        write_array(&l, path);
        memset(plain, 0, MOST_BYTES);
        const size_t size = code_chunk(&l, MOST_BYTES / 2);
        snprintf(name, sizeof name, "%s/1.0.0.0", path);
        spill(name, coded, size);
        const iso_volume_opts second = {.component = 1};
        test_expect_no_volume(path, &second, ISO_ERR_IO, "1.0.0.0", "more bytes than its array states");
    }
    layout l = usual(2);
    for (int i = 1; i < AXES; i++) l.shape[i] = l.chunk[i] = 20000;
    mkdir(path, 0777);
    write_metadata(&l, path);
    const iso_volume_opts small = {.max_memory = 1 << 24};
    test_expect_no_volume(path, &small, ISO_ERR_LIMIT, NULL, "--max-memory");
    l.shape[1] = l.shape[2] = l.shape[3] = 10;
    write_metadata(&l, path);
    test_expect_no_volume(path, &small, ISO_ERR_LIMIT, NULL, "--max-memory");
}

static void expect_text_refused(const char *text, const char *reason) {
    char path[256], name[512];
    snprintf(path, sizeof path, "%s/text", folder);
    mkdir(path, 0777);
    snprintf(name, sizeof name, "%s/.zarray", path);
    vol_write_text(name, text);
    test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, "text", reason);
}

static void test_bad_metadata(void **state) {
    static const char whole[] = "{\"zarr_format\":2,\"shape\":[8,8,8],\"chunks\":[4,4,4],\"dtype\":\"<i2\","
                                "\"order\":\"C\",\"fill_value\":0,\"filters\":null,\"compressor\":null}";
    static const struct {
        const char *from, *to, *reason;
    } changes[] = {{"[8,8,8]", "[8,8,-8]", "shape"},
                   {"[8,8,8]", "[8]", "shape"},
                   {"[8,8,8]", "[1e300,8,8]", "shape"},
                   {"[4,4,4]", "[4,4]", "chunks"},
                   {"[4,4,4]", "[0,4,4]", "chunks"},
                   {"[4,4,4]", "[4,4.5,4]", "chunks"},
                   {"[4,4,4]", "[1000000000,1000000000,1000000000]", "larger than any memory"},
                   {"<i2", "<c8", "dtype"},
                   {"\"<i2\"", "[[\"a\",\"<i2\"]]", "dtype"},
                   {"\"C\"", "\"D\"", "order"},
                   {"_value\":0", "_value\":\"x\"", "fill_value"},
                   {"_value\":0", "_value\":1e6", "fill_value"},
                   {"_value\":0", "_value\":\"0x0007\"", "fill_value"},
                   {"filters\":null", "filters\":[{\"id\":\"delta\"}]", "delta"},
                   {"filters\":null", "filters\":[{\"id\":\"delta\",\"dtype\":\"<f4\"}]", "delta"},
                   {"filters\":null", "filters\":[{\"id\":\"shuffle\",\"elementsize\":0}]", "shuffle"},
                   {"filters\":null", "filters\":[{\"id\":\"fixedscaleoffset\"}]", "fixedscaleoffset"},
                   {"compressor\":null", "compressor\":{\"id\":\"lzma\"}", "lzma"},
                   {"compressor\":null", "compressor\":{}", "codec"},
                   {"format\":2", "format\":1", "zarr_format"},
                   {"{", "[", "JSON"}};
    (void)state;
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        char text[1024];
        const char *place = strstr(whole, changes[i].from);
        assert_non_null(place);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(place - whole), whole, changes[i].to,
                 place + strlen(changes[i].from));
        expect_text_refused(text, changes[i].reason);
    }
    for (size_t length = 0; length < sizeof whole - 1; length++) {
        char text[1024];
        snprintf(text, sizeof text, "%.*s", (int)length, whole);
        expect_text_refused(text, "text");
    }
}

static int make_place(void **state) {
    (void)state;
    mkdir(folder, 0777);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_layout),   cmocka_unit_test(test_chunks),
        cmocka_unit_test(test_images),         cmocka_unit_test(test_paths_stay_below),
        cmocka_unit_test(test_damaged_chunks), cmocka_unit_test(test_bombs),
        cmocka_unit_test(test_bad_metadata),   cmocka_unit_test(test_filters),
        cmocka_unit_test(test_fill_values)};
    return cmocka_run_group_tests(tests, make_place, NULL);
}
