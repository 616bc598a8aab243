/* N5: every compression and type gives the voxels that were written; blocks at the end are smaller, absent
 * ones are 0, damaged ones are errors that name them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>
#include <lz4.h>

#include "file_support.h"
#include "make_volumes.h"
#include "make_zarr.h"
#include "volume_support.h"

static const char folder[] = ISO_TEST_TMP "/n5";

static void put_bytes(unsigned char *target, uint64_t value, int count, bool big) {
    for (int i = 0; i < count; i++) target[big ? count - 1 - i : i] = (unsigned char)(value >> 8 * i);
}

/* The stream of lz4-java: two blocks, the second one stored as it is, and an empty one. */
static size_t stream_lz4(size_t bytes) {
    size_t at = 0;
    for (int block = 0; block < 3; block++) {
        const size_t first = block ? bytes / 2 : 0, end = block ? bytes : bytes / 2;
        const size_t count = block == 2 ? 0 : end - first;
        size_t size = count;
        if (block == 0)
            size = (size_t)LZ4_compress_default((const char *)zarr_plain, (char *)zarr_coded + at + 21,
                                                (int)count, ZARR_MOST - 100);
        else
            memcpy(zarr_coded + at + 21, zarr_plain + first, count);
        memcpy(zarr_coded + at, "LZ4Block", 8);
        zarr_coded[at + 8] = block == 0 ? 0x25 : 0x15;
        put_bytes(zarr_coded + at + 9, size, 4, false);
        put_bytes(zarr_coded + at + 13, count, 4, false);
        at += 21 + size;
    }
    return at;
}

/* Writes the block of an index, which ends where the array ends. */
static void write_block(const zarr_layout *l, const char *path, const int index[ZARR_AXES]) {
    int at[ZARR_AXES], count[ZARR_AXES];
    size_t bytes = 0;
    unsigned char header[4 + 4 * ZARR_AXES] = {0, 0, 0, ZARR_AXES};
    char name[512], command[600];
    for (int i = 0; i < ZARR_AXES; i++) {
        const int left = l->shape[i] - index[i] * l->chunk[i];
        count[i] = left < l->chunk[i] ? left : l->chunk[i];
        put_bytes(header + 4 + 4 * (ZARR_AXES - 1 - i), (uint64_t)count[i], 4, true);
    }
    for (int n = 0; n < count[0] * count[1] * count[2] * count[3]; n++, bytes += (size_t)zarr_size_of(l)) {
        for (int i = ZARR_AXES - 1, rest = n; i >= 0; rest /= count[i--])
            at[i] = index[i] * l->chunk[i] + rest % count[i];
        zarr_store(l, zarr_value_at(at), zarr_plain + bytes);
    }
    const size_t size = l->coding == ZARR_LZ4 ? stream_lz4(bytes) : zarr_code_chunk(l, bytes);
    snprintf(command, sizeof command, "mkdir -p %s/%d/%d/%d", path, index[3], index[2], index[1]);
    assert_int_equal(system(command), 0);
    snprintf(name, sizeof name, "%s/%d/%d/%d/%d", path, index[3], index[2], index[1], index[0]);
    memmove(zarr_coded + sizeof header, zarr_coded, size);
    memcpy(zarr_coded, header, sizeof header);
    spill(name, zarr_coded, size + sizeof header);
}

static void write_n5(const zarr_layout *l, const char *path) {
    static const char *const names[ZARR_ALL_CODINGS] = {"raw", "gzip",  "gzip", "zstd",
                                                        "lz4", "blosc", "bzip2"};
    const char *kind = l->type[0] == 'f' ? "float" : l->type[0] == 'u' ? "uint" : "int";
    char text[1024], name[300];
    snprintf(name, sizeof name, "rm -rf %s && mkdir -p %s", path, path);
    assert_int_equal(system(name), 0);
    snprintf(
        text, sizeof text,
        "{\"dimensions\":[%d,%d,%d,%d],\"blockSize\":[%d,%d,%d,%d],\"dataType\":\"%s%d\",\"compression\":"
        "{\"type\":\"%s\"},\"axes\":[\"x\",\"y\",\"z\",\"c\"],\"resolution\":[4000,5,0.006,1],"
        "\"units\":[\"nm\",\"um\",\"mm\",\"\"]}",
        l->shape[3], l->shape[2], l->shape[1], l->shape[0], l->chunk[3], l->chunk[2], l->chunk[1],
        l->chunk[0], kind, 8 * zarr_size_of(l), names[l->coding]);
    snprintf(name, sizeof name, "%s/attributes.json", path);
    vol_write_text(name, text);
    int index[ZARR_AXES], all = 1;
    for (int i = 0; i < ZARR_AXES; i++) all *= zarr_chunks_along(l, i);
    for (int n = 0; n < all; n++) {
        for (int i = ZARR_AXES - 1, rest = n; i >= 0; rest /= zarr_chunks_along(l, i--))
            index[i] = rest % zarr_chunks_along(l, i);
        if (zarr_number_of(l, index) != l->missing) write_block(l, path, index);
    }
}

static void test_n5(void **state) {
    static const char *const types[] = {"u1", "i1", "u2", "i2", "u4", "i8", "f4", "f8"};
    char path[200], block[300];
    (void)state;
    snprintf(path, sizeof path, "%s/n5", folder);
    snprintf(block, sizeof block, "%s/0/1/1/0", path);
    for (int kind = 0; kind < ZARR_CODINGS; kind++)
        for (int variant = 0; variant < 3; variant++) {
            zarr_layout l = zarr_usual(2);
            l.coding = (zarr_coding)kind;
            l.compressor = "lz4";
            l.type = types[(variant + 3 * kind) % 8];
            l.big = true;
            l.chunk[0] = 1 + variant % 2;
            l.fill = "0";
            if (variant == 2) l.missing = 5;
            write_n5(&l, path);
            zarr_expect_array(&l, path);
            iso_volume volume = test_read_volume(path, NULL);
            const double *spacing = volume.info.transform.spacing;
            assert_true(fabs(spacing[0] - 4e-3) < 1e-9 && fabs(spacing[1] - 5e-3) < 1e-9 &&
                        fabs(spacing[2] - 6e-3) < 1e-9);
            iso_volume_free(&volume);
        }
    zarr_layout l = zarr_usual(2);
    size_t count;
    l.type = "i8"; /* more than the header is damaged if any is cut off */
    l.big = true;
    write_n5(&l, path);
    unsigned char *bytes = slurp(block, &count);
    for (size_t length = 0; length < count; length += 1 + length / 5) {
        spill(block, bytes, length);
        test_expect_no_volume(path, NULL, ISO_ERR_IO, "n5/0/1/1/0", "damaged");
    }
    for (int at = 1; at < 20; at++) { /* another kind, more axes, sizes that are too large */
        if (at == 4 || at == 2) continue;
        const unsigned char was = bytes[at];
        bytes[at] = (unsigned char)(was + 17);
        spill(block, bytes, count);
        test_expect_no_volume(path, NULL, ISO_ERR_IO, "n5/0/1/1/0", "damaged");
        bytes[at] = was;
    }
    free(bytes);
    snprintf(block, sizeof block, "%s/attributes.json", path);
    vol_write_text(block,
                   "{\"dimensions\":[4,4,4],\"blockSize\":[4,4,4],\"dataType\":\"int8\",\"compression\":"
                   "{\"type\":\"xz\"}}");
    test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, NULL, "xz");
    vol_write_text(block, "{\"n5\":\"2.0.0\"}");
    test_expect_no_volume(path, NULL, ISO_ERR_IO, NULL, "has no array");
}

/* A block may be smaller than the others anywhere: what it lacks is 0. */
static void test_small_block(void **state) {
    unsigned char block[4 + 4 * ZARR_AXES + 2 * 4 * 3 * 2] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0,
                                                              0, 3, 0, 0, 0, 2, 0, 0, 0, 1};
    char path[200], name[300];
    (void)state;
    snprintf(path, sizeof path, "%s/n5", folder);
    snprintf(name, sizeof name, "%s/1/1/1/0", path);
    zarr_layout l = zarr_usual(2);
    l.big = true;
    write_n5(&l, path);
    for (int i = 0; i < 4 * 3 * 2; i++) block[4 + 4 * ZARR_AXES + 2 * i + 1] = (unsigned char)(200 + i);
    spill(name, block, sizeof block);
    iso_volume volume = test_read_volume(path, NULL);
    for (int z = 0; z < l.chunk[1]; z++)
        for (int y = 0; y < l.chunk[2]; y++)
            for (int x = 0; x < l.chunk[3]; x++) {
                const bool inside = x < 4 && y < 3 && z < 2;
                assert_true(iso_grid_at(&volume.grid, 8 + x, 5 + y, 4 + z) ==
                            (inside ? 200 + x + 4 * y + 12 * z : 0));
            }
    iso_volume_free(&volume);
}

static int make_place(void **state) {
    (void)state;
    mkdir(folder, 0777);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_n5), cmocka_unit_test(test_small_block)};
    return cmocka_run_group_tests(tests, make_place, NULL);
}
