/* HDF5: where programs say that voxels lie, and what their values are: BigDataViewer's .xml, MINC, EMD,
 * dimension scales, ITK; and files that lack most of their chunks. Files are written by libhdf5. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <hdf5.h>

#include "file_support.h"
#include "grids/chunk_source.h"
#include "grids/volume/volume.h"
#include "hdf5_support.h"
#include "make_volumes.h"
#include "volume_support.h"

const char hdf5_folder[] = ISO_TEST_TMP "/hdf5_geometry";

/* ---- small pieces ---- */

static hid_t write_values(hid_t parent, const char *name, const double *values, int rank,
                          const hsize_t *sizes) {
    const hid_t space = rank ? H5Screate_simple(rank, sizes, NULL) : H5Screate(H5S_SCALAR);
    const hid_t array =
        H5Dcreate2(parent, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(array, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    return array;
}

static iso_volume read_file(const char *name) {
    return test_read_volume(vol_path(hdf5_folder, name, 0), NULL);
}

static void check_transform(const iso_transform *t, const double spacing[3], const double origin[3],
                            const double direction[9]) {
    hdf5_check_numbers("spacing", t->spacing, spacing[0], spacing[1], spacing[2]);
    hdf5_check_numbers("origin", t->origin, origin[0], origin[1], origin[2]);
    for (int row = 0; row < 3; row++)
        hdf5_check_numbers("direction", t->direction + 3 * row, direction[3 * row], direction[3 * row + 1],
                           direction[3 * row + 2]);
}

static const double straight[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, none[3] = {0, 0, 0};

/* ---- BigDataViewer ---- */

static void write_bdv(void) {
    hdf5_storage s = hdf5_plain();
    const double factors[2][3] = {{1, 1, 1}, {2, 2, 1}};
    s.type = H5T_STD_I16LE;
    const hid_t file = hdf5_begin("bdv.h5", false);
    hdf5_write_array(file, "t00000/s00/0/cells", &s);
    hdf5_write_array(file, "t00000/s00/1/cells", &s);
    hdf5_write_array(file, "t00000/s01/0/cells", &s);
    for (int setup = 0; setup < 2; setup++)
        write_values(hdf5_make_group(file, setup ? "s01" : "s00"), "resolutions", factors[0], 2,
                     (const hsize_t[]){2, 3});
    H5Fclose(file);
}

static void write_xml(const char *name, const char *unit, const char *transforms) {
    char text[4096];
    snprintf(text, sizeof text,
             "<?xml version=\"1.0\"?>\n<SpimData version=\"0.2\"><BasePath type=\"relative\">.</BasePath>"
             "<SequenceDescription><ImageLoader format=\"bdv.hdf5\"><hdf5 type=\"relative\"> bdv.h5 "
             "</hdf5></ImageLoader>"
             "<ViewSetups><ViewSetup><id>1</id><size>9 9 9</size><voxelSize><unit>mm</unit><size>5 5 "
             "5</size></voxelSize>"
             "</ViewSetup><ViewSetup>\n <id>0</id><size>9 9 9</size>\n"
             " <voxelSize><unit>%s</unit><size>0.7 0.8 2.8</size></voxelSize></ViewSetup></ViewSetups>"
             "<Timepoints type=\"range\"><first>0</first><last>0</last></Timepoints></SequenceDescription>"
             "<ViewRegistrations><ViewRegistration timepoint=\"0\" setup=\"1\"/>"
             "<ViewRegistration timepoint=\"0\" "
             "setup=\"0\">%s</ViewRegistration></ViewRegistrations></SpimData>\n",
             unit, transforms);
    vol_write_text(vol_path(hdf5_folder, name, 1), text);
}

#define AFFINE(numbers)                                                                                      \
    "<ViewTransform type=\"affine\"><Name>a</Name><affine>" numbers "</affine></ViewTransform>"

static void test_bigdataviewer(void **state) {
    (void)state;
    write_bdv();
    write_xml("bdv.xml", "um", AFFINE("0.7 0 0 0 0 0.8 0 0 0 0 2.8 0"));
    static const char *const names[] = {"bdv.h5", "bdv.xml"};
    for (int i = 0; i < 2; i++) { /* beside, and opened itself */
        iso_volume volume = read_file(names[i]);
        hdf5_check_voxels(&volume, 0);
        check_transform(&volume.info.transform, (const double[]){7e-4, 8e-4, 2.8e-3}, none, straight);
        iso_volume_free(&volume);
    }
    const iso_volume_opts coarse = {.level = 1};
    iso_volume volume = test_read_volume(vol_path(hdf5_folder, "bdv.xml", 0), &coarse);
    check_transform(&volume.info.transform, (const double[]){1.4e-3, 1.6e-3, 2.8e-3},
                    (const double[]){3.5e-4, 4e-4, 0}, straight);
    iso_volume_free(&volume);
    volume = read_file("bdv.xml:/t00000/s01/0/cells");
    check_transform(&volume.info.transform, (const double[]){5, 5, 5}, none, straight);
    iso_volume_free(&volume);

    /* a quarter turn about z and a shift, after the sizes of voxels */
    write_xml("bdv.xml", "mm", AFFINE("0 -1 0 10 1 0 0 20 0 0 1 30") AFFINE("0.7 0 0 0 0 0.8 0 0 0 0 2.8 1"));
    volume = read_file("bdv.h5");
    check_transform(&volume.info.transform, (const double[]){0.7, 0.8, 2.8}, (const double[]){10, 20, 31},
                    (const double[]){0, -1, 0, 1, 0, 0, 0, 0, 1});
    iso_volume_free(&volume);

    /* in voxels */
    write_xml("bdv.xml", "mm", AFFINE("1 0 0 3 0 1.1428571428571428 0 0 0 0 4 0"));
    volume = read_file("bdv.h5");
    check_transform(&volume.info.transform, (const double[]){0.7, 0.8, 2.8}, (const double[]){2.1, 0, 0},
                    straight);
    assert_true(test_has_note(&volume.info, "transforms are in voxels"));
    iso_volume_free(&volume);

    write_xml("bdv.xml", "pixel", "");
    volume = read_file("bdv.h5");
    check_transform(&volume.info.transform, (const double[]){0.7, 0.8, 2.8}, none, straight);
    assert_true(test_has_note(&volume.info, "only the ratios"));
    iso_volume_free(&volume);

    write_xml("bdv.xml", "mm", AFFINE("1 0 0 x"));
    test_expect_no_volume(vol_path(hdf5_folder, "bdv.h5", 0), NULL, ISO_ERR_FORMAT, NULL, "are not numbers");
    static const char other[] =
        "<SpimData><ImageLoader format=\"bdv.n5\"><n5>a</n5></ImageLoader></SpimData>";
    vol_write_text(vol_path(hdf5_folder, "bdv.xml", 0), other);
    test_expect_no_volume(vol_path(hdf5_folder, "bdv.xml", 0), NULL, ISO_ERR_UNSUPPORTED, NULL, "bdv.n5");
    volume = read_file("bdv.h5"); /* a file beside that is about other images */
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 1, 1, 1);
    iso_volume_free(&volume);
}

/* ---- MINC ---- */

static void write_space(hid_t dimensions, const char *name, double start, double step,
                        const double cosines[3]) {
    const double zero = 0;
    const hid_t axis = write_values(dimensions, name, &zero, 0, NULL);
    hdf5_write_text(axis, "units", "mm");
    hdf5_write_text(axis, "spacing", "regular__");
    hdf5_write_numbers(axis, "start", &start, 1);
    hdf5_write_numbers(axis, "step", &step, 1);
    hdf5_write_numbers(axis, "direction_cosines", cosines, 3);
}

static void write_minc(const char *name, const char *order, int slices, const double *low,
                       const double *high) {
    hdf5_storage s = hdf5_plain();
    const double range[2] = {0, 200}, angle = 0.3;
    const hsize_t count = (hsize_t)slices;
    const hid_t file = hdf5_begin(name, false), dimensions = hdf5_make_group(file, "minc-2.0/dimensions"),
                image = hdf5_make_group(file, "minc-2.0/image/0"),
                array = hdf5_write_array(image, "image", &s);
    hdf5_write_text(array, "dimorder", order);
    hdf5_write_numbers(array, "valid_range", range, 2);
    write_values(image, "image-min", low, slices > 0, &count);
    write_values(image, "image-max", high, slices > 0, &count);
    write_space(dimensions, "xspace", -5, 0.7, (const double[]){cos(angle), sin(angle), 0});
    write_space(dimensions, "yspace", -6, -0.8, (const double[]){-sin(angle), cos(angle), 0});
    write_space(dimensions, "zspace", -7, 2.8, (const double[]){0, 0, 1});
    H5Fclose(file);
}

static void test_minc(void **state) {
    (void)state;
    const double low = 10, high = 50, c = cos(0.3), d = sin(0.3);
    write_minc("one.mnc", "zspace,yspace,xspace", 0, &low, &high);
    iso_volume volume = read_file("one.mnc");
    assert_int_equal(volume.info.type, ISO_UINT8);
    hdf5_check_numbers("scale", (const double[]){volume.info.scale, volume.info.offset, 0}, 0.2, 10, 0);
    check_transform(&volume.info.transform, (const double[]){0.7, 0.8, 2.8},
                    (const double[]){5 * c - 6 * d, 5 * d + 6 * c, -7},
                    (const double[]){-c, -d, 0, -d, c, 0, 0, 0, 1});
    iso_volume_free(&volume);

    double lows[HDF5_DEPTH], highs[HDF5_DEPTH];
    for (int z = 0; z < HDF5_DEPTH; z++) {
        lows[z] = -z;
        highs[z] = 100 + z;
    }
    write_minc("slices.mnc", "zspace,yspace,xspace", HDF5_DEPTH, lows, highs);
    volume = read_file("slices.mnc");
    assert_int_equal(volume.info.type, ISO_FLOAT32);
    for (int z = 0; z < HDF5_DEPTH; z++) {
        const double wanted = -z + (double)hdf5_value(3, 4, z, 0) / 200 * (100 + 2 * z);
        assert_true(fabs((double)iso_grid_at(&volume.grid, 3, 4, z) - wanted) < 1e-4);
    }
    iso_volume_free(&volume);

    write_minc("time.mnc", "time,yspace,xspace", 0, &low, &high);
    test_expect_no_volume(vol_path(hdf5_folder, "time.mnc", 0), NULL, ISO_ERR_FORMAT, NULL, "\"time\"");
    write_minc("odd.mnc", "zspace,yspace,xspace", HDF5_DEPTH - 1, lows, highs);
    test_expect_no_volume(vol_path(hdf5_folder, "odd.mnc", 0), NULL, ISO_ERR_FORMAT, NULL, "image-max");
}

/* ---- coordinates ---- */

static void write_link(hid_t array, const hid_t scales[3]) {
    hvl_t lists[3];
    hobj_ref_t references[3];
    const hsize_t rank = 3;
    const hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ), space = H5Screate_simple(1, &rank, NULL);
    for (int i = 0; i < 3; i++) {
        char path[64];
        H5Iget_name(scales[i], path, sizeof path);
        H5Rcreate(&references[i], array, path, H5R_OBJECT, -1);
        lists[i] = (hvl_t){1, &references[i]};
    }
    const hid_t list = H5Acreate2(array, "DIMENSION_LIST", type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(list, type, lists) >= 0);
}

static void test_scales(void **state) {
    const hdf5_storage s = hdf5_plain();
    (void)state;
    hid_t file = hdf5_begin("scales.h5", true), array = hdf5_write_array(file, "density", &s);
    write_link(array, (const hid_t[]){hdf5_write_axis(file, "height", HDF5_DEPTH, 100, 10, "m"),
                                      hdf5_write_axis(file, "lat", HDF5_HEIGHT, 1, 3, "degrees_north"),
                                      hdf5_write_axis(file, "length", HDF5_WIDTH, 7, -2, NULL)});
    H5Fclose(file);
    iso_volume volume = read_file("scales.h5");
    check_transform(&volume.info.transform, (const double[]){2, 1, 1e4}, (const double[]){7, 0, 1e5},
                    (const double[]){-1, 0, 0, 0, 1, 0, 0, 0, 1});
    assert_true(test_has_note(&volume.info, "along y are in \"degrees_north\"") &&
                test_has_note(&volume.info, "unit of the coordinates along x"));
    iso_volume_free(&volume);

    file = hdf5_begin("emd.emd", false);
    const double group_type = 1, uneven[HDF5_DEPTH] = {0, 1, 3, 9, [HDF5_DEPTH - 1] = 22};
    const hid_t group = hdf5_make_group(file, "data/tomogram");
    hdf5_write_numbers(group, "emd_group_type", &group_type, 1);
    hdf5_write_array(group, "data", &s);
    hdf5_write_text(write_values(group, "dim1", uneven, 1, (const hsize_t[]){HDF5_DEPTH}), "units", "[u_m]");
    hdf5_write_axis(group, "dim2", 2, 0, 0.5, "[n_m]"); /* the first two */
    hdf5_write_axis(group, "dim3", HDF5_WIDTH, 0, 2, "A");
    H5Fclose(file);
    volume = read_file("emd.emd");
    for (int i = 0; i < 3; i++) {
        const double wanted = (const double[]){2e-7, 5e-7, 2e-3}[i];
        assert_true(fabs(volume.info.transform.spacing[i] / wanted - 1) < 1e-9);
    }
    assert_true(test_has_note(&volume.info, "along z are not evenly spaced and do not rise or fall"));
    iso_volume_free(&volume);

    file = hdf5_begin("old.nxs", false);
    array = hdf5_write_array(file, "counts", &s);
    hdf5_write_text(array, "axes", "[z,row:col]");
    hdf5_write_axis(file, "z", HDF5_DEPTH, 0, 2, "cm");
    hdf5_write_axis(file, "row", HDF5_HEIGHT, 0, 3, "millimeters");
    hdf5_write_axis(file, "col", HDF5_WIDTH, 0, 4, "mm");
    H5Fclose(file);
    volume = read_file("old.nxs");
    hdf5_check_numbers("spacing", volume.info.transform.spacing, 4, 3, 20);
    iso_volume_free(&volume);
}

/* Arrays whose axes are x, y and z in this order, by the names of dimensions or of EMD's. */
static void test_named_axes(void **state) {
    const hdf5_storage s = hdf5_plain();
    (void)state;
    hid_t file = hdf5_begin("named.h5", true);
    const hid_t array = hdf5_write_array(file, "density", &s);
    write_link(array, (const hid_t[]){hdf5_write_axis(file, "x", HDF5_DEPTH, 100, 10, "mm"),
                                      hdf5_write_axis(file, "y", HDF5_HEIGHT, 1, 3, "mm"),
                                      hdf5_write_axis(file, "z", HDF5_WIDTH, 7, -2, "mm")});
    H5Fclose(file);
    iso_volume volume = read_file("named.h5");
    check_transform(&volume.info.transform, (const double[]){2, 3, 10}, (const double[]){100, 1, 7},
                    (const double[]){0, 0, 1, 0, 1, 0, -1, 0, 0});
    iso_volume_free(&volume);

    file = hdf5_begin("named.emd", false);
    const double group_type = 1;
    const hid_t group = hdf5_make_group(file, "data/tomogram");
    hdf5_write_numbers(group, "emd_group_type", &group_type, 1);
    hdf5_write_array(group, "data", &s);
    for (int i = 0; i < 3; i++)
        hdf5_write_text(
            hdf5_write_axis(group, (const char *[]){"dim1", "dim2", "dim3"}[i], 2, 0, i + 1, "mm"), "name",
            (const char *[]){"y", "X", "z"}[i]);
    H5Fclose(file);
    volume = read_file("named.emd");
    check_transform(&volume.info.transform, (const double[]){3, 2, 1}, none,
                    (const double[]){0, 1, 0, 0, 0, 1, 1, 0, 0});
    iso_volume_free(&volume);
}

/* An attribute with distances in no known unit is named. */
static void test_unclear_distance(void **state) {
    const hdf5_storage s = hdf5_plain();
    const double resolution[3] = {40, 4, 4.5};
    (void)state;
    const hid_t file = hdf5_begin("unclear.h5", true);
    hdf5_write_numbers(hdf5_write_array(file, "raw", &s), "resolution", resolution, 3);
    H5Fclose(file);
    iso_volume volume = read_file("unclear.h5");
    assert_true(test_has_note(&volume.info, "its attribute resolution is 40 4 4.5 (--spacing X,Y,Z)"));
    iso_volume_free(&volume);
}

static void test_itk(void **state) {
    const hdf5_storage s = hdf5_plain();
    const double directions[9] = {0, 1, 0, -1, 0, 0, 0, 0, 1}, spacing[3] = {2, 3, 4}, origin[3] = {5, 6, 7};
    (void)state;
    const hid_t file = hdf5_begin("itk.h5", false), group = hdf5_make_group(file, "ITKImage/0");
    hdf5_write_array(group, "VoxelData", &s);
    write_values(group, "Spacing", spacing, 1, (const hsize_t[]){3});
    write_values(group, "Origin", origin, 1, (const hsize_t[]){3});
    write_values(group, "Directions", directions, 2, (const hsize_t[]){3, 3});
    H5Fclose(file);
    iso_volume volume = read_file("itk.h5");
    check_transform(&volume.info.transform, spacing, origin, (const double[]){0, -1, 0, 1, 0, 0, 0, 0, 1});
    iso_volume_free(&volume);
}

/* ---- absent chunks ---- */

/* Arrays of chunks of one voxel, of which none or three are stored: what it costs to read them does not
 * depend on how many there might be. */
static void test_mostly_absent(void **state) {
    (void)state;
    for (int latest = 0; latest < 2; latest++)
        for (int stored = 0; stored <= 3; stored += 3) {
            const hid_t file = hdf5_begin("voxels.h5", latest), creation = H5Pcreate(H5P_DATASET_CREATE);
            const unsigned char fill = 9, value = 200;
            const hsize_t side = latest ? 100 : 4000, sizes[3] = {side, side, side};
            const hid_t space = H5Screate_simple(3, sizes, NULL), one = H5Screate(H5S_SCALAR);
            H5Pset_chunk(creation, 3, (const hsize_t[]){1, 1, 1});
            H5Pset_fill_value(creation, H5T_NATIVE_UCHAR, &fill);
            const hid_t array =
                H5Dcreate2(file, "a", H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
            for (hsize_t i = 0; i < (hsize_t)stored; i++) {
                H5Sselect_elements(space, H5S_SELECT_SET, 1, (const hsize_t[]){50 + i, 60, 70});
                H5Dwrite(array, H5T_NATIVE_UCHAR, one, space, H5P_DEFAULT, &value);
            }
            H5Fclose(file);
            const iso_volume_opts opts = {.mapped = true, .max_memory = 64 << 20};
            iso_volume volume = test_read_volume(vol_path(hdf5_folder, "voxels.h5", 0), &opts);
            const iso_chunk_source source = iso_volume_source(volume.grid.rgrid);
            for (int z = 2; z < 6; z++) {
                const iso_brick_box box = {{3, 3, z}, {6, 6, z + 1}};
                iso_grid_chunk chunk;
                iso_rgrid *grid = NULL;
                float constant = 0;
                assert_true(iso_grid_chunk_make(source.dims, &source.transform, &box, &chunk));
                const bool is_constant = source.is_constant(source.context, &chunk, &constant);
                assert_int_equal(is_constant, stored == 0 || z != 3);
                assert_true(!is_constant || constant == 9);
                if (z != 3) continue;
                assert_int_equal(source.read(source.context, &chunk, NULL, &grid, NULL), ISO_OK);
                const int x = 70 - 16 * chunk.origin[0], y = 60 - 16 * chunk.origin[1],
                          at = 51 - 16 * chunk.origin[2];
                assert_true(iso_rgrid_at(grid, x, y, at) == (stored ? 200 : 9));
                assert_true(iso_rgrid_at(grid, x + 1, y, at) == 9);
                iso_rgrid_destroy(grid);
            }
            iso_volume_free(&volume);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bigdataviewer), cmocka_unit_test(test_minc),
        cmocka_unit_test(test_scales),        cmocka_unit_test(test_itk),
        cmocka_unit_test(test_named_axes),    cmocka_unit_test(test_unclear_distance),
        cmocka_unit_test(test_mostly_absent)};
    return cmocka_run_group_tests(tests, hdf5_make_folder, NULL);
}
