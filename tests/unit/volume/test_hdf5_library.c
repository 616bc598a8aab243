/* HDF5 arrays that libhdf5 decodes: filters that only it can undo (its own and those of plugins), and types
 * that only it converts. They give the same voxels as other arrays, damaged chunks are named, and what nobody
 * can decode is refused by name. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/parallel.h"
#include "check_support.h"
#include "file_support.h"
#include "hdf5_plugin.h"
#include "hdf5_support.h"
#include "make_volumes.h"
#include "volume_support.h"

const char hdf5_folder[] = ISO_TEST_TMP "/hdf5_library";

static void put_in_chunks(hdf5_storage *s) {
    memcpy(s->chunk, (hsize_t[]){5, 7, 8}, 3 * sizeof *s->chunk);
}

static void expect_note(const char *path, const char *words) {
    iso_volume_info info;
    iso_error error = {0};
    assert_int_equal(iso_volume_read_info(path, NULL, &info, &error), ISO_OK);
    if (!test_has_note(&info, words) || !test_has_note(&info, "libhdf5 decodes it, one chunk at a time"))
        fail_msg("no note with %s", words);
}

static bool can_encode(int filter) {
    unsigned flags = 0;
    const bool can = H5Zget_filter_info(filter, &flags) >= 0 && flags & H5Z_FILTER_CONFIG_ENCODE_ENABLED;
    if (!can) print_message("SKIP: libhdf5 has no encoder for filter %d\n", filter);
    return can;
}

/* ---- types ---- */

/* A float with a sign, an exponent and a fraction of these bits. */
static hid_t make_float(hid_t like, size_t exponent, size_t fraction, size_t bias) {
    const hid_t type = H5Tcopy(like);
    H5Tset_fields(type, exponent + fraction, fraction, exponent, 0, fraction);
    H5Tset_size(type, (exponent + fraction + 1) / 8);
    H5Tset_ebias(type, bias);
    return type;
}

static hid_t make_half(bool big) {
    return make_float(big ? H5T_IEEE_F32BE : H5T_IEEE_F32LE, 5, 10, 15);
}

/* An integer of `bits` bits from bit `offset` on. */
static hid_t make_integer(hid_t like, size_t bytes, size_t bits, size_t offset) {
    const hid_t type = H5Tcopy(like);
    H5Tset_size(type, bytes);
    H5Tset_precision(type, bits);
    H5Tset_offset(type, offset);
    return type;
}

static void test_filters(void **state) {
    const struct {
        int filter;
        const char *name;
    } filters[] = {{H5Z_FILTER_SZIP, "szip"}, {H5Z_FILTER_NBIT, "nbit"}, {H5Z_FILTER_SCALEOFFSET, "scaleo"}};
    const hid_t types[] = {H5T_STD_U8LE,  H5T_STD_I8LE,   H5T_STD_U16BE,  H5T_STD_I32LE,
                           H5T_STD_U64LE, H5T_IEEE_F32BE, H5T_IEEE_F64LE, make_half(true)};
    (void)state;
    for (size_t i = 0; i < sizeof filters / sizeof *filters; i++) {
        if (!can_encode(filters[i].filter)) continue;
        for (size_t type = 0; type < sizeof types / sizeof *types; type++) {
            hdf5_storage s = hdf5_plain();
            s.type = types[type];
            s.filter = filters[i].filter;
            if (s.filter == H5Z_FILTER_SCALEOFFSET && H5Tget_size(s.type) == 2 &&
                H5Tget_class(s.type) == H5T_FLOAT)
                continue; /* libhdf5 offers it for float and double */
            put_in_chunks(&s);
            s.checksum = type & 1;
            s.deflate = type & 2 && s.filter != H5Z_FILTER_SZIP;
            const char *path = hdf5_write_file("filter.h5", &s, type & 4);
            hdf5_check_file(path, &s);
            hdf5_check_chunk(path);
            expect_note(path, filters[i].name);
        }
    }
}

/* Components are read of chunks that have several of them. */
static void test_components(void **state) {
    hdf5_storage s = {
        .sizes = {HDF5_DEPTH, HDF5_HEIGHT, HDF5_WIDTH, 3}, .rank = 4, .z = 0, .y = 1, .x = 2, .c = 3};
    (void)state;
    memcpy(s.chunk, (hsize_t[]){5, 7, 8, 2}, 4 * sizeof *s.chunk);
    s.filter = H5Z_FILTER_NBIT;
    hdf5_check_file(hdf5_write_file("components.h5", &s, false), &s);
}

static void test_half(void **state) {
    (void)state;
    for (int way = 0; way < 8; way++) {
        iso_volume_info info;
        hdf5_storage s = hdf5_plain();
        s.type = make_half(way & 1);
        if (way > 1) put_in_chunks(&s);
        s.shuffle = s.deflate = way > 3;
        if (way > 5) s.filter = H5Z_FILTER_NBIT;
        const char *path = hdf5_write_file("half.h5", &s, false);
        hdf5_check_file(path, &s);
        hdf5_check_chunk(path);
        assert_int_equal(iso_volume_read_info(path, NULL, &info, NULL), ISO_OK);
        assert_string_equal(info.file_type, "half");
        assert_int_equal(test_has_note(&info, "libhdf5 decodes"), way > 5);
    }
}

static void test_integers(void **state) {
    const struct {
        hid_t type;
        const char *file_type;
    } types[] = {
        {make_integer(H5T_STD_U16LE, 2, 12, 0), "uint16"}, {make_integer(H5T_STD_U16BE, 2, 12, 3), "uint16"},
        {make_integer(H5T_STD_I32LE, 4, 8, 11), "int8"},   {make_integer(H5T_STD_U32LE, 3, 24, 0), "uint32"},
        {make_integer(H5T_STD_I32BE, 3, 24, 0), "int32"},  {make_integer(H5T_STD_U64BE, 5, 33, 7), "uint64"},
        {make_integer(H5T_STD_I64LE, 16, 60, 20), "int64"}};
    (void)state;
    for (size_t type = 0; type < sizeof types / sizeof *types; type++)
        for (int way = 0; way < 4; way++) {
            hdf5_storage s = hdf5_plain();
            iso_volume_info info;
            s.type = types[type].type;
            if (way > 0) put_in_chunks(&s);
            s.deflate = s.shuffle = way == 2;
            if (way == 3) s.filter = H5Z_FILTER_NBIT;
            const char *path = hdf5_write_file("integers.h5", &s, way & 1);
            hdf5_check_file(path, &s);
            hdf5_check_chunk(path);
            expect_note(path, "integers of");
            assert_int_equal(iso_volume_read_info(path, NULL, &info, NULL), ISO_OK);
            assert_string_equal(info.file_type, types[type].file_type);
        }
}

/* A value of an array of 8 x 8 x 8, of which the first chunk is written. */
static void check_extremes(const hid_t type, const hid_t memory_type, const void *values, const void *fill,
                           const float wanted[4]) {
    const hid_t file = hdf5_begin("extremes.h5", false), creation = H5Pcreate(H5P_DATASET_CREATE);
    const hid_t space = H5Screate_simple(3, (hsize_t[]){8, 8, 8}, NULL);
    H5Pset_chunk(creation, 3, (hsize_t[]){4, 8, 8});
    assert_true(H5Pset_fill_value(creation, memory_type, fill) >= 0);
    const hid_t array = H5Dcreate2(file, "a", type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, (hsize_t[]){0, 0, 0}, NULL, (hsize_t[]){1, 1, 3}, NULL);
    assert_true(H5Dwrite(array, memory_type, H5Screate_simple(1, (hsize_t[]){3}, NULL), space, H5P_DEFAULT,
                         values) >= 0);
    H5Fclose(file);
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "extremes.h5", 0), NULL);
    for (int i = 0; i < 3; i++) assert_true(iso_grid_at(&volume.grid, i, 0, 0) == wanted[i]);
    assert_true(iso_grid_at(&volume.grid, 3, 0, 0) == wanted[3]);
    assert_true(iso_grid_at(&volume.grid, 7, 7, 7) == wanted[3]); /* of a chunk that is absent */
    iso_volume_free(&volume);
}

static void test_extremes(void **state) {
    const int numbers[3] = {-2048, -1, 2047}, minus = -7;
    const float reals[3] = {-65504, INFINITY, 0x1p-24f}, half = 0.5f;
    const unsigned char bits[3] = {0, 31, 9}, few = 5;
    (void)state;
    check_extremes(make_integer(H5T_STD_I16BE, 2, 12, 2), H5T_NATIVE_INT, numbers, &minus,
                   (float[]){-2048, -1, 2047, -7});
    check_extremes(make_half(false), H5T_NATIVE_FLOAT, reals, &half,
                   (float[]){-65504, INFINITY, 0x1p-24f, 0.5f});
    check_extremes(make_half(true), H5T_NATIVE_FLOAT, reals, &half,
                   (float[]){-65504, INFINITY, 0x1p-24f, 0.5f});
    check_extremes(make_integer(H5T_STD_B16LE, 2, 5, 4), H5T_NATIVE_B8, bits, &few, (float[]){0, 31, 9, 5});
    check_extremes(H5T_STD_B8LE, H5T_NATIVE_B8, bits, &few, (float[]){0, 31, 9, 5});
}

static void test_compact(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    s.compact = true;
    for (int type = 0; type < 3; type++) {
        s.type = type == 0 ? H5T_STD_U8LE : type == 1 ? H5T_STD_I16BE : make_half(true);
        const char *path = hdf5_write_file("compact.h5", &s, type & 1);
        hdf5_check_file(path, &s);
        hdf5_check_chunk(path);
        expect_note(path, "compact");
    }
}

/* BigDataViewer stores uint16 as int16: values above 32767 are negative in the file. */
static void test_changed_type(void **state) {
    hdf5_storage s = hdf5_plain();
    short values[HDF5_VOXELS];
    (void)state;
    for (int i = 0; i < HDF5_VOXELS; i++) values[i] = (short)(i * 16 - 32768);
    s.type = H5T_STD_I16LE;
    s.filter = H5Z_FILTER_NBIT;
    put_in_chunks(&s);
    const hid_t file = hdf5_begin("bdv.h5", false), links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t array = hdf5_create_array(file, "t00000/s00/0/cells", &s);
    H5Dwrite(array, H5T_NATIVE_SHORT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    const hid_t table =
        H5Dcreate2(file, "s00/resolutions", H5T_IEEE_F64LE, H5Screate_simple(2, (hsize_t[]){1, 3}, NULL),
                   links, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(table, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, (double[]){1, 1, 1});
    H5Fclose(file);
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "bdv.h5", 0), NULL);
    assert_int_equal(volume.info.type, ISO_UINT16);
    assert_memory_equal(volume.grid.rgrid->data, values, sizeof values);
    iso_volume_free(&volume);
}

/* ---- a plugin ---- */

static const char *write_plugin_file(int trigger_z, unsigned char trigger) {
    hdf5_storage s = {.sizes = {12, 8, 8}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1};
    unsigned char values[12 * 8 * 8];
    memset(values, 1, sizeof values);
    if (trigger_z >= 0) values[trigger_z * 8 * 8] = trigger;
    memcpy(s.chunk, (hsize_t[]){4, 8, 8}, 3 * sizeof *s.chunk);
    s.filter = HDF5_PLUGIN_FILTER;
    const hid_t file = hdf5_begin("plugin.h5", false), array = hdf5_create_array(file, "voxels", &s);
    assert_true(H5Dwrite(array, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Fclose(file);
    return vol_path(hdf5_folder, "plugin.h5", 0);
}

static void test_plugin(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    put_in_chunks(&s);
    s.filter = HDF5_PLUGIN_FILTER;
    s.deflate = true;
    const char *path = hdf5_write_file("plugin.h5", &s, false);
    hdf5_check_file(path, &s);
    hdf5_check_chunk(path);
    expect_note(path, "filter 270");
}

/* A filter that crashes, never ends, fails, or takes all memory costs the chunk, which is named. */
static void test_bad_plugin(void **state) {
    (void)state;
    test_expect_no_volume(write_plugin_file(4, HDF5_PLUGIN_CRASHES), NULL, ISO_ERR_IO, NULL,
                          "/voxels, the chunk at 4,0,0: damaged: libhdf5 cannot read it");
    test_expect_no_volume(write_plugin_file(8, HDF5_PLUGIN_NEVER_ENDS), NULL, ISO_ERR_IO, NULL,
                          "/voxels, the chunk at 8,0,0: damaged: libhdf5 takes too long");
    test_expect_no_volume(write_plugin_file(0, HDF5_PLUGIN_FAILS), NULL, ISO_ERR_IO, NULL,
                          "/voxels, the chunk at 0,0,0 is damaged or truncated");
#ifndef ADDRESS_SANITIZER /* which does not survive a limit of memory */
    test_expect_no_volume(write_plugin_file(0, HDF5_PLUGIN_TAKES_MEMORY), NULL, ISO_ERR_IO, NULL,
                          "/voxels, the chunk at 0,0,0");
#endif
}

static iso_status read_layer(const iso_chunk_source *source, int z, iso_error *error) {
    const iso_brick_box bricks = {{0, 0, z}, {1, 1, z + 1}};
    iso_grid_chunk chunk;
    iso_rgrid *grid = NULL;
    assert_true(iso_grid_chunk_make(source->dims, &source->transform, &bricks, &chunk));
    const iso_status status = source->read(source->context, &chunk, NULL, &grid, error);
    iso_rgrid_destroy(grid);
    return status;
}

/* After a crash other chunks can be read. */
static void test_goes_on(void **state) {
    enum { SIDE = 80 };
    hdf5_storage s = {.sizes = {SIDE, 8, 8}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1};
    const iso_volume_opts opts = {.mapped = true, .max_memory = 8 << 20};
    static unsigned char values[SIDE * 8 * 8];
    iso_error error = {0};
    (void)state;
    values[48 * 8 * 8] = HDF5_PLUGIN_CRASHES;
    memcpy(s.chunk, (hsize_t[]){16, 8, 8}, 3 * sizeof *s.chunk);
    s.filter = HDF5_PLUGIN_FILTER;
    const hid_t file = hdf5_begin("goes_on.h5", false), array = hdf5_create_array(file, "voxels", &s);
    H5Dwrite(array, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Fclose(file);
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "goes_on.h5", 0), &opts);
    const iso_chunk_source source = iso_volume_source(volume.grid.rgrid);
    for (int turn = 0; turn < 3; turn++) {
        assert_int_equal(read_layer(&source, 0, &error), ISO_OK);
        assert_int_equal(read_layer(&source, 3, &error), ISO_ERR_IO);
        assert_non_null(strstr(error.text, "the chunk at 48,0,0"));
    }
    iso_volume_free(&volume);
    assert_true(waitpid(-1, NULL, WNOHANG) < 0 && errno == ECHILD); /* no process is left */
}

/* A file that gets shorter while it is open has no values behind its end. */
static void test_shortened(void **state) {
    hdf5_storage s = {.sizes = {80, 8, 8}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1, .chunk = {16, 8, 8}};
    const iso_volume_opts opts = {.mapped = true, .max_memory = 8 << 20};
    iso_error error = {0};
    (void)state;
    struct stat status;
    s.type = H5T_STD_U16LE;
    s.filter = H5Z_FILTER_NBIT;
    const char *path = hdf5_write_file("shortened.h5", &s, false);
    iso_volume volume = test_read_volume(path, &opts);
    const iso_chunk_source source = iso_volume_source(volume.grid.rgrid);
    assert_int_equal(read_layer(&source, 0, &error), ISO_OK);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(truncate(path, status.st_size - 100), 0);
    assert_int_equal(read_layer(&source, 2, &error), ISO_OK);
    assert_int_equal(read_layer(&source, 4, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "/voxels, the chunk at 64,0,0 is damaged or truncated"));
    iso_volume_free(&volume);
}

/* ---- threads, memory ---- */

static void test_threads(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    put_in_chunks(&s);
    s.filter = H5Z_FILTER_SCALEOFFSET;
    const char *path = hdf5_write_file("threads.h5", &s, false);
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(4, &pool, NULL), ISO_OK);
    const iso_volume_opts opts = {.pool = pool};
    for (int turn = 0; turn < 5; turn++) {
        iso_volume volume = test_read_volume(path, &opts);
        hdf5_check_voxels(&volume, 0);
        iso_volume_free(&volume);
    }
    iso_pool_destroy(pool);
    assert_true(waitpid(-1, NULL, WNOHANG) < 0 && errno == ECHILD);
}

static uint64_t bytes_to_read(const hdf5_storage *s) {
    iso_volume_info info;
    iso_error error = {0};
    assert_int_equal(iso_volume_read_info(hdf5_write_file("memory.h5", s, false), NULL, &info, &error),
                     ISO_OK);
    return info.read_bytes;
}

/* What libhdf5 needs counts: four chunks more than without it. */
static void test_memory(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    s.sizes[0] = s.sizes[1] = s.sizes[2] = s.chunk[0] = s.chunk[1] = s.chunk[2] = 64;
    s.deflate = true;
    const uint64_t without = bytes_to_read(&s);
    s.deflate = false;
    s.filter = H5Z_FILTER_NBIT;
    const uint64_t with = bytes_to_read(&s);
    assert_int_equal(with - without, 4 * 64 * 64 * 64);
    const iso_volume_opts less = {.max_memory = with - 1}, enough = {.max_memory = with};
    const char *path = vol_path(hdf5_folder, "memory.h5", 0);
    test_expect_no_volume(path, &less, ISO_ERR_LIMIT, NULL, "--max-memory");
    iso_volume volume = test_read_volume(path, &enough);
    iso_volume_free(&volume);
    const iso_volume_opts mapped = {.mapped = true, .max_memory = 4 * 64 * 64 * 64 - 1};
    test_expect_no_volume(path, &mapped, ISO_ERR_LIMIT, NULL, "--max-memory");
}

/* ---- refused ---- */

static size_t apply_nothing(unsigned flags, size_t count, const unsigned values[], size_t bytes, size_t *room,
                            void **buffer) {
    (void)flags, (void)count, (void)values, (void)room, (void)buffer;
    return bytes;
}

static void test_refused(void **state) {
    const H5Z_class2_t unknown = {H5Z_CLASS_T_VERS, 299, 1, 1, "unknown", NULL, NULL, apply_nothing};
    const struct {
        hid_t type;
        const char *words;
    } types[] = {{make_float(H5T_IEEE_F32LE, 8, 7, 127), "/voxels has floats of 2 bytes, with 8 bits"},
                 {make_float(H5T_IEEE_F64BE, 8, 15, 127), "floats of 3 bytes, with 8 bits"},
                 {H5T_NATIVE_LDOUBLE, "/voxels has floats of 16 bytes"},
                 {make_integer(H5T_STD_I64LE, 16, 70, 0), "/voxels has integers of 70 bits in 16 bytes"}};
    hdf5_storage s = hdf5_plain();
    (void)state;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        s.type = types[i].type;
        test_expect_no_volume(hdf5_write_file("refused.h5", &s, false), NULL, ISO_ERR_UNSUPPORTED, NULL,
                              types[i].words);
        test_expect_no_volume(vol_path(hdf5_folder, "refused.h5:/voxels", 1), NULL, ISO_ERR_UNSUPPORTED,
                              "refused.h5", types[i].words);
    }
    hid_t file = H5Fopen(vol_path(hdf5_folder, "refused.h5", 0), H5F_ACC_RDWR, hdf5_file_access());
    s.type = H5T_STD_U8LE;
    hdf5_write_array(file, "z", &s); /* the only one that can be read is read */
    H5Fclose(file);
    hdf5_check_file(vol_path(hdf5_folder, "refused.h5", 0), &s);
    assert_true(H5Zregister(&unknown) >= 0);
    put_in_chunks(&s);
    s.filter = 299;
    const char *path = hdf5_write_file("unknown.h5", &s, false);
    H5Zunregister(299);
    test_expect_no_volume(path, NULL, ISO_ERR_UNSUPPORTED, NULL, "filter 299, which neither");
}

/* ---- damaged ---- */

/* Writes one chunk as it is given, and reads the file. */
static void expect_damaged(int filter, const void *bytes, size_t count) {
    hdf5_storage s = {.sizes = {8, 8, 8}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1, .chunk = {8, 8, 8}};
    s.type = H5T_STD_I32LE;
    s.filter = filter;
    const hid_t file = hdf5_begin("raw.h5", false), array = hdf5_create_array(file, "voxels", &s);
    assert_true(H5Dwrite_chunk(array, H5P_DEFAULT, 0, (hsize_t[]){0, 0, 0}, count, bytes) >= 0);
    H5Fclose(file);
    iso_volume volume;
    iso_error error = {0};
    const char *path = vol_path(hdf5_folder, "raw.h5", 0);
    const iso_status status = iso_volume_read(path, NULL, &volume, &error);
    if (status == ISO_OK) iso_volume_free(&volume); /* any bits can be values */
    if (status != ISO_OK && (status != ISO_ERR_IO || !strstr(error.text, "/voxels, the chunk at 0,0,0")))
        fail_msg("%s", error.text);
}

static void test_damaged_chunks(void **state) {
    static const int filters[] = {H5Z_FILTER_SZIP, H5Z_FILTER_NBIT, H5Z_FILTER_SCALEOFFSET};
    unsigned char bytes[256];
    (void)state;
    for (size_t i = 0; i < sizeof filters / sizeof *filters; i++) {
        if (!can_encode(filters[i])) continue;
        for (uint32_t turn = 0; turn < 30; turn++) {
            for (uint32_t at = 0; at < sizeof bytes; at++)
                bytes[at] = turn ? (unsigned char)test_hash(turn * 1000 + at) : 0xff;
            expect_damaged(filters[i], bytes, turn % 5 ? sizeof bytes : turn + 1);
        }
    }
}

/* A checksum behind the filter finds any damage. */
static void test_damaged_chunk(void **state) {
    hdf5_storage s = hdf5_plain();
    size_t count;
    haddr_t address;
    hsize_t bytes;
    unsigned skipped;
    (void)state;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    s.filter = H5Z_FILTER_NBIT;
    s.checksum = true;
    const hid_t file = hdf5_begin("chunk.h5", false), array = hdf5_write_array(file, "voxels", &s);
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    H5Dget_chunk_info_by_coord(array, (hsize_t[]){8, 0, 16}, &skipped, &address, &bytes);
    H5Fclose(file);
    const char *path = vol_path(hdf5_folder, "chunk.h5", 0);
    char *whole = slurp(path, &count);
    whole[address + 5] ^= 4;
    spill(path, whole, count);
    test_expect_no_volume(path, NULL, ISO_ERR_IO, NULL,
                          "/voxels, the chunk at 8,0,16 is damaged or truncated: data error detected by");
    whole[address + 5] ^= 4;
    for (size_t length = 8; length < count; length += 997) {
        spill(path, whole, length);
        test_expect_no_volume(path, NULL, ISO_ERR_IO, NULL, "truncated");
    }
    free(whole);
}

static void test_damaged(void **state) {
    static const int filters[] = {H5Z_FILTER_SZIP, H5Z_FILTER_NBIT, H5Z_FILTER_SCALEOFFSET};
    (void)state;
    for (size_t i = 0; i < sizeof filters / sizeof *filters; i++) {
        hdf5_storage s = hdf5_plain();
        if (!can_encode(filters[i])) continue;
        put_in_chunks(&s);
        s.type = H5T_STD_U16LE;
        s.filter = filters[i];
        test_read_damaged(hdf5_write_file("damaged.h5", &s, i & 1), 8, 60, "damaged.h5");
    }
}

int main(void) {
    setenv("HDF5_PLUGIN_PATH", ISO_TEST_HDF5_PLUGINS, 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_filters),        cmocka_unit_test(test_components),
        cmocka_unit_test(test_half),           cmocka_unit_test(test_integers),
        cmocka_unit_test(test_extremes),       cmocka_unit_test(test_compact),
        cmocka_unit_test(test_changed_type),   cmocka_unit_test(test_plugin),
        cmocka_unit_test(test_bad_plugin),     cmocka_unit_test(test_goes_on),
        cmocka_unit_test(test_shortened),      cmocka_unit_test(test_threads),
        cmocka_unit_test(test_memory),         cmocka_unit_test(test_refused),
        cmocka_unit_test(test_damaged_chunks), cmocka_unit_test(test_damaged_chunk),
        cmocka_unit_test(test_damaged)};
    return cmocka_run_group_tests(tests, hdf5_make_folder, NULL);
}
