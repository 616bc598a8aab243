/* Zarr: arrays of both versions, with every codec, order of memory, byte order and shards, give the same
 * voxels; OME-Zarr gives distances and levels; absent chunks have the fill value, damaged ones are errors
 * that name them. */
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

#include <cmocka.h>
#include <zlib.h>
#include <zstd.h>

#include "base/crc32c.h"
#include "file_support.h"
#include "grids/volume/tiled.h"
#include "grids/volume/volume.h"
#include "make_volumes.h"
#include "make_zarr.h"
#include "volume_support.h"

static const char folder[] = ISO_TEST_TMP "/zarr";

static void write_and_check(const zarr_layout *l) {
    char path[256];
    snprintf(path, sizeof path, "%s/array", folder);
    zarr_write_array(l, path);
    zarr_expect_array(l, path);
}

static void test_every_layout(void **state) {
    static const char *const types[] = {"u1", "i1", "u2", "i2", "u4", "i8", "f4", "f8", "f2"};
    static const int orders[][ZARR_AXES] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}};
    (void)state;
    for (int version = 2; version <= 3; version++)
        for (int kind = 0; kind < ZARR_CODINGS; kind++)
            for (int variant = 0; variant < 12; variant++) {
                zarr_layout l = zarr_usual(version);
                l.coding = (zarr_coding)kind;
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
            zarr_layout l = zarr_usual(version);
            l.type = types[variant % 7];
            l.coding = (zarr_coding)(variant % 5);
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
        zarr_layout l = zarr_usual(3);
        l.type = values[i].type;
        l.fill = values[i].fill;
        l.fill_text = values[i].text;
        l.missing = 5;
        write_and_check(&l);
    }
    for (size_t i = 0; i < sizeof nans / sizeof *nans; i++) {
        zarr_layout l = zarr_usual(3);
        int at[ZARR_AXES] = {0};
        l.type = nans[i][0];
        l.fill = nans[i][1];
        l.missing = 0;
        snprintf(path, sizeof path, "%s/array", folder);
        zarr_write_array(&l, path);
        iso_volume volume = test_read_volume(path, NULL);
        assert_true(zarr_is_missing(&l, at) && isnan(iso_grid_at(&volume.grid, 0, 0, 0)));
        assert_true(iso_grid_at(&volume.grid, 18, 12, 10) == 7 * 18 + 3 * 12 + 110 - 240);
        iso_volume_free(&volume);
    }
}

/* Chunk by chunk, with a cache too small for all. */
static void test_chunks(void **state) {
    (void)state;
    for (int sharded = 0; sharded < 2; sharded++) {
        zarr_layout l = zarr_usual(3);
        l.coding = ZARR_BLOSC;
        l.compressor = "zstd";
        l.missing = 5;
        if (sharded) memcpy(l.across, (const int[]){1, 2, 2, 2}, sizeof l.across);
        char path[256];
        snprintf(path, sizeof path, "%s/chunks", folder);
        zarr_write_array(&l, path);
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
        int at[ZARR_AXES] = {0};
        for (at[1] = 0; at[1] < 11; at[1]++)
            for (at[2] = 0; at[2] < 13; at[2]++)
                for (at[3] = 0; at[3] < 19; at[3]++)
                    assert_true((double)iso_rgrid_at(grid, at[3], at[2], at[1]) ==
                                (zarr_is_missing(&l, at) ? 7 : zarr_value_at(at)));
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
        zarr_layout l = zarr_usual(version);
        for (int i = 1; i < ZARR_AXES; i++) l.shape[i] >>= level;
        snprintf(name, sizeof name, "%s/%s", path, level ? "s1" : "s0");
        zarr_write_array(&l, name);
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
        zarr_expect_array(&(zarr_layout){.shape = {2, 11, 13, 19}, .chunk = {1, 4, 5, 8}, .missing = -1},
                          path);
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

static void expect_damage(const zarr_layout *l, const char *file, size_t keep, int flip, iso_status status,
                          const char *text) {
    char path[256], name[512];
    snprintf(path, sizeof path, "%s/damaged", folder);
    zarr_write_array(l, path);
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
    zarr_layout l = zarr_usual(2);
    expect_damage(&l, "0.1.1.1", 100, -1, ISO_ERR_IO, "100 bytes of values instead of 320");
    for (int kind = ZARR_ZLIB; kind < ZARR_CODINGS; kind++) {
        l.coding = (zarr_coding)kind;
        l.compressor = "lz4";
        expect_damage(&l, "0.1.1.1", 20, -1, ISO_ERR_IO, "damaged/0.1.1.1");
        expect_damage(&l, "0.1.1.1", 0, -1, ISO_ERR_IO, "damaged/0.1.1.1");
    }
    l = zarr_usual(3);
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
    for (int kind = ZARR_ZLIB; kind < ZARR_CODINGS; kind++) {
        zarr_layout l = zarr_usual(2);
        l.coding = (zarr_coding)kind;
        l.compressor = "zstd";
        snprintf(path, sizeof path, "%s/bomb", folder);
        zarr_write_array(&l, path);
        memset(zarr_plain, 0, ZARR_MOST);
        const size_t size = zarr_code_chunk(&l, ZARR_MOST / 2);
        snprintf(name, sizeof name, "%s/1.0.0.0", path);
        spill(name, zarr_coded, size);
        const iso_volume_opts second = {.component = 1};
        test_expect_no_volume(path, &second, ISO_ERR_IO, "1.0.0.0", "more bytes than its array states");
    }
    zarr_layout l = zarr_usual(2);
    for (int i = 1; i < ZARR_AXES; i++) l.shape[i] = l.chunk[i] = 20000;
    mkdir(path, 0777);
    zarr_write_metadata(&l, path);
    const iso_volume_opts small = {.max_memory = 1 << 24};
    test_expect_no_volume(path, &small, ISO_ERR_LIMIT, NULL, "--max-memory");
    l.shape[1] = l.shape[2] = l.shape[3] = 10;
    zarr_write_metadata(&l, path);
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
