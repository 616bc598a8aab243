/* HDF5: every way of storage gives the same voxels, arrays are found by the conventions of several programs,
 * and damaged files end in one line. Files are written by libhdf5. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>
#include <hdf5.h>
#include <zlib.h>

#if ISO_HAVE_CODECS
#include <blosc.h>
#include <lz4.h>
#include <zstd.h>
#endif
#if ISO_HAVE_BZIP2
#include <bzlib.h>
#endif

#include "file_support.h"
#include "grids/volume/volume.h"
#include "hdf5_support.h"
#include "make_volumes.h"
#include "volume_support.h"

const char hdf5_folder[] = ISO_TEST_TMP "/hdf5";

/* ---- writing ---- */

/* An array of single characters, as Imaris writes text. */
static void write_characters(hid_t object, const char *name, const char *text) {
    const hsize_t count = strlen(text);
    const hid_t space = H5Screate_simple(1, &count, NULL);
    H5Awrite(H5Acreate2(object, name, H5T_C_S1, space, H5P_DEFAULT, H5P_DEFAULT), H5T_C_S1, text);
}

/* ---- storage ---- */

static void test_every_storage(void **state) {
    const hid_t types[] = {H5T_STD_U8LE,   H5T_STD_I8LE,   H5T_STD_U16LE, H5T_STD_U16BE, H5T_STD_I16LE,
                           H5T_STD_I32BE,  H5T_STD_U32LE,  H5T_STD_U64LE, H5T_STD_I64BE, H5T_IEEE_F32LE,
                           H5T_IEEE_F32BE, H5T_IEEE_F64LE, H5T_IEEE_F64BE};
    (void)state;
    for (size_t type = 0; type < sizeof types / sizeof *types; type++)
        for (int way = 0; way < 10; way++) {
            hdf5_storage s = hdf5_plain();
            s.type = types[type];
            if (way > 1) memcpy(s.chunk, (hsize_t[]){5, 7, way % 2 ? 8 : HDF5_WIDTH}, 3 * sizeof *s.chunk);
            s.deflate = way > 3;
            s.shuffle = way > 5;
            s.checksum = way > 7;
            const char *path = hdf5_write_file("storage.h5", &s, way % 2);
            hdf5_check_file(path, &s);
            hdf5_check_chunk(path);
        }
}

static void test_components(void **state) {
    const hdf5_storage ways[] = {
        {.sizes = {HDF5_DEPTH, HDF5_HEIGHT, HDF5_WIDTH, 3}, .rank = 4, .z = 0, .y = 1, .x = 2, .c = 3},
        {.sizes = {3, HDF5_DEPTH, HDF5_HEIGHT, HDF5_WIDTH}, .rank = 4, .z = 1, .y = 2, .x = 3, .c = 0},
        {.sizes = {1, 3, HDF5_DEPTH, HDF5_HEIGHT, HDF5_WIDTH}, .rank = 5, .z = 2, .y = 3, .x = 4, .c = 1},
        {.sizes = {1, HDF5_DEPTH, HDF5_HEIGHT, HDF5_WIDTH, 1}, .rank = 5, .z = 1, .y = 2, .x = 3, .c = -1}};
    (void)state;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        for (int chunked = 0; chunked < 2; chunked++) {
            hdf5_storage s = ways[i];
            for (int axis = 0; axis < s.rank && chunked; axis++) s.chunk[axis] = s.sizes[axis] < 7 ? 1 : 6;
            s.deflate = chunked;
            if (chunked && s.c == 3) s.chunk[3] = 2; /* two components in a chunk, then one */
            hdf5_check_file(hdf5_write_file("components.h5", &s, false), &s);
        }
}

/* An array in one piece that is read in several boxes, of which those at the end are smaller. */
static void test_boxes(void **state) {
    const hdf5_storage ways[] = {{.sizes = {19, 40, 300}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1},
                                 {.sizes = {19, 40, 300, 2}, .rank = 4, .z = 0, .y = 1, .x = 2, .c = 3},
                                 {.sizes = {2, 40, 40, 20}, .rank = 4, .z = 1, .y = 2, .x = 3, .c = 0}};
    (void)state;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        const iso_volume_opts opts = {.component = ways[i].c >= 0};
        iso_volume volume = test_read_volume(hdf5_write_file("boxes.h5", &ways[i], false), &opts);
        const int *dims = iso_grid_dims(&volume.grid);
        assert_int_equal(dims[0], ways[i].sizes[ways[i].x]);
        for (int z = 0; z < dims[2]; z++)
            for (int y = 0; y < dims[1]; y++)
                for (int x = 0; x < dims[0]; x++)
                    if (iso_grid_at(&volume.grid, x, y, z) != hdf5_value(x, y, z, opts.component))
                        fail_msg("way %zu, voxel %d %d %d", i, x, y, z);
        iso_volume_free(&volume);
    }
}

/* Whether a chunk is known to have the fill value without being read. */
static void check_constant(const char *array, bool wanted) {
    const iso_volume_opts opts = {.grid = array, .mapped = true, .max_memory = 8 << 20};
    const iso_brick_box bricks = {{0, 0, 0}, {1, 1, 1}};
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "absent.h5", 0), &opts);
    const iso_chunk_source source = iso_volume_source(volume.grid.rgrid);
    iso_grid_chunk chunk;
    float value = 0;
    assert_true(iso_grid_chunk_make(source.dims, &source.transform, &bricks, &chunk));
    assert_int_equal(source.is_constant(source.context, &chunk, &value), wanted);
    assert_true(!wanted || value == 9);
    iso_volume_free(&volume);
}

/* Chunks that were never written have the fill value. */
static void test_absent_chunks(void **state) {
    hdf5_storage s = hdf5_plain();
    const hsize_t start[3] = {5, 0, 8}, count[3] = {5, 7, 8};
    unsigned char fill = 9, values[5 * 7 * 8];
    (void)state;
    for (int latest = 0; latest < 2; latest++) {
        const hid_t file = hdf5_begin("absent.h5", latest), creation = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(creation, 3, (hsize_t[]){5, 7, 8});
        H5Pset_fill_value(creation, H5T_NATIVE_UCHAR, &fill);
        const hid_t space = H5Screate_simple(3, s.sizes, NULL);
        const hid_t array = H5Dcreate2(file, "a", H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
        H5Dcreate2(file, "b", H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
        memset(values, 200, sizeof values);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
        H5Dwrite(array, H5T_NATIVE_UCHAR, H5Screate_simple(3, count, NULL), space, H5P_DEFAULT, values);
        H5Fclose(file);
        iso_volume_opts opts = {.grid = "a"};
        iso_volume volume = test_read_volume(vol_path(hdf5_folder, "absent.h5", 0), &opts);
        assert_true(iso_grid_at(&volume.grid, 8, 0, 5) == 200 && iso_grid_at(&volume.grid, 15, 6, 9) == 200);
        assert_true(iso_grid_at(&volume.grid, 7, 0, 5) == 9 && iso_grid_at(&volume.grid, 22, 16, 11) == 9);
        iso_volume_free(&volume);
        check_constant("a", false);
        opts.grid = "/b"; /* nothing was ever written to it */
        volume = test_read_volume(vol_path(hdf5_folder, "absent.h5", 0), &opts);
        assert_true(iso_grid_at(&volume.grid, 0, 0, 0) == 9);
        iso_volume_free(&volume);
        check_constant("/b", true);
    }
}

/* The grid has the bytes of the same voxels in an .nrrd file, and the same place in the world. */
static void test_same_as_nrrd(void **state) {
    hdf5_storage s = hdf5_plain();
    char header[300], *nrrd = NULL;
    unsigned char voxels[HDF5_VOXELS];
    hsize_t count;
    (void)state;
    s.shuffle = s.deflate = true;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    const hid_t file = hdf5_begin("same.h5", false);
    hdf5_write_numbers(hdf5_write_array(file, "a", &s), "element_size_um", (double[]){2000, 1000, 500}, 3);
    H5Fclose(file);
    snprintf(header, sizeof header,
             "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nspace: left-posterior-superior\nspace "
             "directions: "
             "(0.5,0,0) (0,1,0) (0,0,2)\nspace origin: (0,0,0)\nencoding: raw\n\n",
             HDF5_WIDTH, HDF5_HEIGHT, HDF5_DEPTH);
    float *values = hdf5_make_values(&s, &count);
    for (int i = 0; i < HDF5_VOXELS; i++) voxels[i] = (unsigned char)values[i];
    nrrd = malloc(strlen(header) + HDF5_VOXELS);
    memcpy(nrrd, header, strlen(header));
    memcpy(nrrd + strlen(header), voxels, HDF5_VOXELS);
    spill(vol_path(hdf5_folder, "same.nrrd", 1), nrrd, strlen(header) + HDF5_VOXELS);
    iso_volume a = test_read_volume(vol_path(hdf5_folder, "same.h5", 0), NULL),
               b = test_read_volume(vol_path(hdf5_folder, "same.nrrd", 1), NULL);
    assert_int_equal(a.info.type, b.info.type);
    assert_memory_equal(a.grid.rgrid->data, b.grid.rgrid->data, HDF5_VOXELS);
    assert_memory_equal(&a.info.transform, &b.info.transform, sizeof a.info.transform);
    iso_volume_free(&a);
    iso_volume_free(&b);
    free(values);
    free(nrrd);
}

/* ---- which array ---- */

static void test_choice(void **state) {
    hdf5_storage s = hdf5_plain(), other = hdf5_plain();
    (void)state;
    other.sizes[0] = 3;
    hid_t file = hdf5_begin("choice.h5", false);
    hdf5_write_array(file, "group/voxels", &s);
    other.rank = 2;
    hdf5_write_array(file, "flat", &other);
    H5Fclose(file);
    const char *path = vol_path(hdf5_folder, "choice.h5", 0);
    hdf5_check_file(path, &s);
    file = H5Fopen(path, H5F_ACC_RDWR, hdf5_file_access());
    other.rank = 3;
    hdf5_write_array(file, "few", &other);
    H5Fclose(file);
    test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, NULL,
                          "/few: (3, 17, 23) uint8; /group/voxels: (12, 17, 23)");
    const iso_volume_opts named = {.grid = "/group/voxels"}, missing = {.grid = "none"};
    iso_volume volume = test_read_volume(path, &named);
    hdf5_check_voxels(&volume, 0);
    assert_int_equal(volume.info.item_count, 2);
    iso_volume_free(&volume);
    hdf5_check_file(vol_path(hdf5_folder, "choice.h5:/group/voxels", 1), &s);
    test_expect_no_volume(path, &missing, ISO_ERR_USAGE, NULL, "has no array /none");
    test_expect_no_volume(vol_path(hdf5_folder, "choice.h5:/few", 1), &named, ISO_ERR_USAGE, NULL,
                          "another one");
    test_expect_no_volume(vol_path(hdf5_folder, "choice.h5:/group", 1), NULL, ISO_ERR_USAGE, NULL,
                          "no array");
}

static void test_imaris(void **state) {
    hdf5_storage s = hdf5_plain();
    const char *const sizes[] = {"23", "17", "12"}, *const ends[] = {"22.5", "17", "34"};
    char name[64];
    (void)state;
    const hid_t file = hdf5_begin("imaris.ims", false), image = hdf5_make_group(file, "DataSetInfo/Image");
    for (int axis = 0; axis < 3; axis++) {
        snprintf(name, sizeof name, "ExtMin%d", axis);
        write_characters(image, name, axis == 2 ? "10" : axis == 0 ? "-.5" : "0");
        snprintf(name, sizeof name, "ExtMax%d", axis);
        write_characters(image, name, ends[axis]);
    }
    const hid_t described = hdf5_make_group(file, "DataSetInfo/Channel 1");
    write_characters(described, "Name", "GFP (488)");
    write_characters(described, "Color", "0.000 0.502 1.000");
    s.sizes[0] = s.sizes[1] = s.sizes[2] = 24; /* padded to whole chunks */
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    s.deflate = true;
    for (int c = 0; c < 2; c++) {
        snprintf(name, sizeof name, "DataSet/ResolutionLevel 0/TimePoint 0/Channel %d", c);
        const hid_t channel = hdf5_make_group(file, name);
        for (int axis = 0; axis < 3; axis++) {
            snprintf(name, sizeof name, "ImageSize%c", "XYZ"[axis]);
            write_characters(channel, name, sizes[axis]);
        }
        hdf5_write_array(channel, "Data", &s);
    }
    H5Fclose(file);
    iso_channels channels;
    const iso_volume_opts second = {.component = 1, .channels = &channels}, third = {.component = 2};
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "imaris.ims", 0), &second);
    assert_int_equal(channels.count, 2);
    assert_string_equal(channels.items[0].name, "");
    assert_false(channels.items[0].colored);
    assert_string_equal(channels.items[1].name, "GFP (488)");
    assert_true(channels.items[1].colored);
    assert_memory_equal(&channels.items[1].color, (&(iso_rgb){0, 128, 255}), sizeof(iso_rgb));
    hdf5_check_voxels(&volume, 0);
    assert_int_equal(volume.info.components, 2);
    assert_non_null(strstr(volume.info.name, "Channel 1"));
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 1e-3, 1e-3, 2e-3);
    hdf5_check_numbers("origin", volume.info.transform.origin, 0, 0.5e-3, 11e-3);
    iso_volume_free(&volume);
    test_expect_no_volume(vol_path(hdf5_folder, "imaris.ims", 0), &third, ISO_ERR_USAGE, NULL,
                          "no component 2");
}

static void test_bigdataviewer(void **state) {
    hdf5_storage s = hdf5_plain();
    const double factors[2][3] = {{1, 1, 1}, {2, 2, 1}};
    const hsize_t sizes[2] = {2, 3};
    (void)state;
    s.type = H5T_STD_I16LE;
    const hid_t file = hdf5_begin("bdv.h5", false);
    hdf5_write_array(file, "t00000/s00/0/cells", &s);
    hdf5_write_array(file, "t00000/s00/1/cells", &s);
    const hid_t table = H5Dcreate2(hdf5_make_group(file, "s00"), "resolutions", H5T_IEEE_F64LE,
                                   H5Screate_simple(2, sizes, NULL), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(table, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, factors);
    H5Fclose(file);
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "bdv.h5", 0), NULL);
    hdf5_check_voxels(&volume, 0);
    assert_int_equal(volume.info.type, ISO_UINT16);
    assert_true(test_has_note(&volume.info, "level 0 of 2") &&
                test_has_note(&volume.info, "only the ratios"));
    iso_volume_free(&volume);
    volume = test_read_volume(vol_path(hdf5_folder, "bdv.h5:/t00000/s00/1/cells", 0), NULL);
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 2, 2, 1);
    hdf5_check_numbers("origin", volume.info.transform.origin, 0.5, 0.5, 0);
    iso_volume_free(&volume);
    const iso_volume_opts second = {.level = 1}, third = {.level = 2};
    volume = test_read_volume(vol_path(hdf5_folder, "bdv.h5", 0), &second);
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 2, 2, 1);
    assert_true(test_has_note(&volume.info, "level 1 of 2"));
    iso_volume_free(&volume);
    test_expect_no_volume(vol_path(hdf5_folder, "bdv.h5", 0), &third, ISO_ERR_USAGE, NULL, "there are 2");
}

static void test_nexus(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    const hid_t file = hdf5_begin("nexus.nxs", true), entry = hdf5_make_group(file, "scan"),
                data = hdf5_make_group(entry, "sinogram"), good = hdf5_make_group(entry, "volume");
    hdf5_write_text(file, "default", "scan");
    hdf5_write_text(entry, "NX_class", "NXentry");
    hdf5_write_text(entry, "default", "volume");
    hdf5_write_text(data, "NX_class", "NXdata");
    hdf5_write_text(good, "NX_class", "NXdata");
    hdf5_write_text(good, "signal", "density");
    hdf5_write_texts(good, "axes", (const char *const[]){"depth", "row", "column"}, 3);
    hdf5_write_array(good, "density", &s);
    s.sizes[0] = 2;
    hdf5_write_array(good, "errors", &s);
    hdf5_write_axis(good, "depth", HDF5_DEPTH, 5, 2, "mm");
    hdf5_write_axis(good, "row", HDF5_HEIGHT + 1, 0, 3, "um"); /* the voxels' borders */
    hdf5_write_axis(good, "column", HDF5_WIDTH, 1, -4, "nm");
    H5Fclose(file);
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "nexus.nxs", 0), NULL);
    hdf5_check_voxels(&volume, 0);
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 4e-6, 3e-3, 2);
    hdf5_check_numbers("origin", volume.info.transform.origin, 1e-6, 1.5e-3, 5);
    hdf5_check_numbers("direction", volume.info.transform.direction, -1, 0, 0);
    iso_volume_free(&volume);
    hdf5_check_file(vol_path(hdf5_folder, "nexus.nxs:/scan/volume", 0), &s);
}

static void test_vtkhdf(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    const hid_t file = hdf5_begin("image.vtkhdf", false), root = hdf5_make_group(file, "VTKHDF");
    const hid_t points = hdf5_make_group(root, "PointData"), cells = hdf5_make_group(root, "CellData");
    hdf5_write_text(root, "Type", "ImageData");
    hdf5_write_numbers(root, "WholeExtent",
                       (double[]){4, 4 + HDF5_WIDTH - 1, 0, HDF5_HEIGHT - 1, -2, HDF5_DEPTH - 3}, 6);
    hdf5_write_numbers(root, "Origin", (double[]){1, 2, 3}, 3);
    hdf5_write_numbers(root, "Spacing", (double[]){0.5, 1, 2}, 3);
    hdf5_write_numbers(root, "Direction", (double[]){0, -1, 0, 1, 0, 0, 0, 0, 1}, 9);
    hdf5_write_texts(points, "Scalars", (const char *const[]){"rho"}, 1);
    hdf5_write_array(points, "rho", &s);
    s.sizes[2] = 2;
    hdf5_write_array(points, "aaa", &s);
    hdf5_write_array(cells, "cell", &s);
    H5Fclose(file);
    const char *path = vol_path(hdf5_folder, "image.vtkhdf", 0);
    iso_volume volume = test_read_volume(path, NULL);
    hdf5_check_voxels(&volume, 0);
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 0.5, 1, 2);
    hdf5_check_numbers("origin", volume.info.transform.origin, 1, 4, -1);
    iso_volume_free(&volume);
    const iso_volume_opts named = {.grid = "cell"};
    volume = test_read_volume(path, &named);
    hdf5_check_numbers("origin of cells", volume.info.transform.origin, 0.5, 4.25, 0);
    iso_volume_free(&volume);
    /* The length of a text in the heap is 64 more: after it come zeros, at which libhdf5 1.10 never ends. */
    size_t count;
    unsigned char *whole = slurp(path, &count), *heap = memmem(whole, count, "GCOL", 4);
    assert_non_null(heap);
    heap[24] ^= 64;
    path = vol_path(hdf5_folder, "heap.vtkhdf", 0);
    spill(path, whole, count);
    test_expect_no_volume(path, NULL, ISO_ERR_IO, NULL, "damaged: a heap with its texts");
    free(whole);
    const hid_t other = hdf5_begin("mesh.vtkhdf", false);
    hdf5_write_text(hdf5_make_group(other, "VTKHDF"), "Type", "UnstructuredGrid");
    H5Fclose(other);
    test_expect_no_volume(vol_path(hdf5_folder, "mesh.vtkhdf", 0), NULL, ISO_ERR_FORMAT, NULL,
                          "UnstructuredGrid");
}

/* ---- refused ---- */

static void test_other_files(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    hdf5_write_file("source.h5", &s, false);
    hid_t file = hdf5_begin("link.h5", false);
    H5Lcreate_external("source.h5", "/voxels", file, "voxels", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    const char *path = vol_path(hdf5_folder, "link.h5", 0);
    test_expect_no_volume(path, NULL, ISO_ERR_UNSUPPORTED, NULL, "name source.h5:/voxels");
    test_expect_no_volume(vol_path(hdf5_folder, "link.h5:/voxels", 1), NULL, ISO_ERR_UNSUPPORTED, NULL,
                          "source.h5");
    file = hdf5_begin("signal.h5", false); /* libhdf5 would follow the link by itself */
    const hid_t data = hdf5_make_group(file, "data");
    hdf5_write_text(data, "NX_class", "NXdata");
    hdf5_write_text(data, "signal", "voxels");
    H5Lcreate_external("source.h5", "/voxels", data, "voxels", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    path = vol_path(hdf5_folder, "signal.h5", 0);
    test_expect_no_volume(path, NULL, ISO_ERR_UNSUPPORTED, NULL, "name source.h5:/voxels");
    file = hdf5_begin("virtual.h5", true);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(3, s.sizes, NULL);
    H5Pset_virtual(creation, space, "source.h5", "/voxels", space);
    H5Dcreate2(file, "a", H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    H5Fclose(file);
    test_expect_no_volume(vol_path(hdf5_folder, "virtual.h5", 0), NULL, ISO_ERR_UNSUPPORTED, NULL, "virtual");
    file = hdf5_begin("external.h5", false);
    const hid_t outside = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(outside, "/etc/passwd", 0, HDF5_VOXELS);
    H5Dcreate2(file, "a", H5T_STD_U8LE, space, H5P_DEFAULT, outside, H5P_DEFAULT);
    H5Fclose(file);
    test_expect_no_volume(vol_path(hdf5_folder, "external.h5", 0), NULL, ISO_ERR_UNSUPPORTED, NULL,
                          "another file");
}

static void test_refused(void **state) {
    hdf5_storage s = hdf5_plain();
    const iso_volume_opts small = {.max_memory = 1000};
    (void)state;
    test_expect_no_volume(hdf5_write_file("limit.h5", &s, false), &small, ISO_ERR_LIMIT, NULL,
                          "--max-memory");
    s.rank = 2;
    test_expect_no_volume(hdf5_write_file("flat.h5", &s, false), NULL, ISO_ERR_FORMAT, NULL, "three axes");
}

/* A small file that claims a petabyte ends at the limit of memory. */
static void test_huge(void **state) {
    hdf5_storage s = hdf5_plain();
    const iso_volume_opts opts = {.max_memory = 64 << 20};
    (void)state;
    s.sizes[0] = s.sizes[1] = s.sizes[2] = 100000;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 64;
    const hid_t file = hdf5_begin("huge.h5", false);
    hdf5_create_array(file, "a", &s);
    H5Fclose(file);
    test_expect_no_volume(vol_path(hdf5_folder, "huge.h5", 0), &opts, ISO_ERR_LIMIT, NULL, "--max-memory");
}

static void test_truncated(void **state) {
    hdf5_storage s = hdf5_plain();
    size_t count;
    (void)state;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    s.deflate = true;
    char *bytes = slurp(hdf5_write_file("whole.h5", &s, false), &count);
    const char *cut = vol_path(hdf5_folder, "cut.h5", 0);
    for (size_t length = 8; length < count; length += 97) {
        spill(cut, bytes, length);
        test_expect_no_volume(cut, NULL, ISO_ERR_IO, NULL, "truncated");
    }
    free(bytes);
}

/* A chunk whose compressed bytes are damaged is named. */
static void test_damaged_chunk(void **state) {
    hdf5_storage s = hdf5_plain();
    size_t count;
    haddr_t address;
    hsize_t bytes;
    unsigned skipped;
    (void)state;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    s.deflate = true;
    const hid_t file = hdf5_begin("chunk.h5", false), array = hdf5_write_array(file, "voxels", &s);
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    H5Dget_chunk_info_by_coord(array, (hsize_t[]){8, 0, 16}, &skipped, &address, &bytes);
    H5Fclose(file);
    const char *path = vol_path(hdf5_folder, "chunk.h5", 0);
    unsigned char *whole = slurp(path, &count);
    memset(whole + address + 2, 0xff, bytes - 2);
    spill(path, whole, count);
    test_expect_no_volume(path, NULL, ISO_ERR_IO, NULL, "/voxels, the chunk at 8,0,16: damaged");
    free(whole);
}

/* Writes one chunk as it is given, and reads the file. */
static const char *write_raw_chunk(const hdf5_storage *s, uint32_t skipped, const void *bytes, size_t count) {
    const hid_t file = hdf5_begin("raw.h5", false), array = hdf5_create_array(file, "voxels", s);
    assert_true(H5Dwrite_chunk(array, H5P_DEFAULT, skipped, (hsize_t[]){0, 0, 0}, count, bytes) >= 0);
    H5Fclose(file);
    return vol_path(hdf5_folder, "raw.h5", 0);
}

/* Chunks to which filters were not applied, with too few values, and that unpack to more than a chunk. */
static void test_raw_chunks(void **state) {
    enum { CHUNK = 8 * 8 * 8, MANY = 1 << 20 };
    hdf5_storage s = {.sizes = {8, 8, 8}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1};
    unsigned char values[CHUNK], packed[4096], *zeros = calloc(MANY, 1);
    uLongf bytes = sizeof packed;
    (void)state;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    s.deflate = s.checksum = true;
    for (int i = 0; i < CHUNK; i++) values[i] = (unsigned char)(i % 251);
    iso_volume volume = test_read_volume(write_raw_chunk(&s, 3, values, CHUNK), NULL);
    assert_memory_equal(volume.grid.rgrid->data, values, CHUNK);
    iso_volume_free(&volume);
    compress(packed, &bytes, values, CHUNK - 1);
    test_expect_no_volume(write_raw_chunk(&s, 2, packed, bytes), NULL, ISO_ERR_IO, NULL,
                          "wrong number of bytes");
    bytes = sizeof packed;
    compress(packed, &bytes, zeros, MANY);
    test_expect_no_volume(write_raw_chunk(&s, 2, packed, bytes), NULL, ISO_ERR_IO, NULL, "0,0,0: damaged");
    values[9]++; /* the checksum is that of other values */
    memcpy(zeros, values, CHUNK);
    test_expect_no_volume(write_raw_chunk(&s, 1, zeros, CHUNK + 4), NULL, ISO_ERR_IO, NULL, "0,0,0: damaged");
    free(zeros);
}

static void test_damaged(void **state) {
    hdf5_storage s = hdf5_plain();
    (void)state;
    s.chunk[0] = s.chunk[1] = s.chunk[2] = 8;
    s.deflate = s.shuffle = true;
    test_read_damaged(hdf5_write_file("damaged.h5", &s, false), 8, 150, "damaged.h5");
    test_read_damaged(hdf5_write_file("damaged.h5", &s, true), 8, 150, "damaged.h5");
}

/* ---- filters of other projects, registered with libhdf5 while files are written ---- */

#if ISO_HAVE_CODECS
static void put_big(unsigned char *bytes, uint64_t value, int count) {
    for (int i = count - 1; i >= 0; i--, value >>= 8) bytes[i] = (unsigned char)value;
}

/* Blocks of 100 bytes; those that do not become smaller are stored as they are. */
static size_t pack_lz4(const unsigned char *data, size_t bytes, unsigned char *target) {
    enum { BLOCK = 100 };
    size_t at = 12;
    put_big(target, bytes, 8);
    put_big(target + 8, BLOCK, 4);
    for (size_t done = 0; done < bytes; done += BLOCK) {
        const int block = (int)(bytes - done < BLOCK ? bytes - done : BLOCK);
        int size =
            LZ4_compress_default((const char *)data + done, (char *)target + at + 4, block, BLOCK + 99);
        if (size >= block) memcpy(target + at + 4, data + done, (size_t)(size = block));
        put_big(target + at, (uint64_t)size, 4);
        at += 4 + (size_t)size;
    }
    return at;
}
#endif

static const char *const blosc_names[] = {"blosclz", "lz4", "zlib", "zstd"};
static int blosc_way;

static size_t pack(int filter, const void *data, size_t bytes, void *target, size_t room) {
#if ISO_HAVE_CODECS
    if (filter == 32001)
        return (size_t)blosc_compress_ctx(5, blosc_way % 3, 2, bytes, data, target, room,
                                          blosc_names[blosc_way % 4], 0, 1);
    if (filter == 32004) return pack_lz4(data, bytes, target);
    if (filter == 32015) return ZSTD_compress(target, room, data, bytes, 5);
#endif
#if ISO_HAVE_BZIP2
    unsigned size = (unsigned)room;
    if (filter == 307 &&
        BZ2_bzBuffToBuffCompress(target, &size, (char *)(uintptr_t)data, (unsigned)bytes, 9, 0, 0) == BZ_OK)
        return size;
#endif
    return 0;
}

static size_t apply_filter(int filter, size_t bytes, size_t *room, void **buffer) {
    const size_t most = 2 * bytes + 4096;
    void *packed = malloc(most);
    const size_t size = pack(filter, *buffer, bytes, packed, most);
    free(*buffer);
    *buffer = packed;
    *room = most;
    return size;
}

#define APPLY(number)                                                                                        \
    static size_t apply_##number(unsigned flags, size_t count, const unsigned values[], size_t bytes,        \
                                 size_t *room, void **buffer) {                                              \
        (void)flags, (void)count, (void)values;                                                              \
        return apply_filter(number, bytes, room, buffer);                                                    \
    }
APPLY(307)
APPLY(32001)
APPLY(32004)
APPLY(32015)

static void test_filters(void **state) {
    const H5Z_class2_t filters[] = {
        {H5Z_CLASS_T_VERS, 307, 1, 1, "bzip2", NULL, NULL, apply_307},
        {H5Z_CLASS_T_VERS, 32001, 1, 1, "blosc", NULL, NULL, apply_32001},
        {H5Z_CLASS_T_VERS, 32004, 1, 1, "lz4", NULL, NULL, apply_32004},
        {H5Z_CLASS_T_VERS, 32015, 1, 1, "zstd", NULL, NULL, apply_32015},
    };
    (void)state;
    for (int i = ISO_HAVE_BZIP2 ? 0 : 1; i < (ISO_HAVE_CODECS ? 4 : 1); i++) {
        assert_true(H5Zregister(&filters[i]) >= 0);
        for (int way = 0; way < 12; way++) {
            hdf5_storage s = hdf5_plain();
            size_t count, damaged = 0;
            s.type = way % 3 ? H5T_STD_U16LE : H5T_IEEE_F32BE;
            memcpy(s.chunk, (hsize_t[]){5, 7, 8}, 3 * sizeof *s.chunk);
            s.filter = filters[i].id;
            s.shuffle = way & 1;
            s.checksum = way & 2;
            blosc_way = way;
            const char *path = hdf5_write_file("filter.h5", &s, way & 4);
            hdf5_check_file(path, &s);
            hdf5_check_chunk(path);
            if (way) continue;
            /* damage behind the header is found, or changes values, and never reaches beyond a chunk */
            unsigned char *whole = slurp(path, &count);
            for (size_t at = 1024; at < count; at += (count - 1024) / 60) {
                iso_volume volume;
                iso_error error = {0};
                whole[at] ^= 0x55;
                spill(vol_path(hdf5_folder, "bent.h5", 1), whole, count);
                const iso_status status =
                    iso_volume_read(vol_path(hdf5_folder, "bent.h5", 1), NULL, &volume, &error);
                assert_true(status == ISO_OK || status == ISO_ERR_IO);
                if (status == ISO_OK) iso_volume_free(&volume);
                damaged += status != ISO_OK;
                whole[at] ^= 0x55;
            }
            assert_true(damaged > 0);
            free(whole);
        }
        H5Zunregister(filters[i].id);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_storage), cmocka_unit_test(test_components),
        cmocka_unit_test(test_boxes),         cmocka_unit_test(test_raw_chunks),
        cmocka_unit_test(test_absent_chunks), cmocka_unit_test(test_same_as_nrrd),
        cmocka_unit_test(test_choice),        cmocka_unit_test(test_imaris),
        cmocka_unit_test(test_bigdataviewer), cmocka_unit_test(test_nexus),
        cmocka_unit_test(test_vtkhdf),        cmocka_unit_test(test_other_files),
        cmocka_unit_test(test_refused),       cmocka_unit_test(test_huge),
        cmocka_unit_test(test_truncated),     cmocka_unit_test(test_damaged_chunk),
        cmocka_unit_test(test_filters),       cmocka_unit_test(test_damaged)};
    return cmocka_run_group_tests(tests, hdf5_make_folder, NULL);
}
