/* hdf5_support: writes arrays into HDF5 files by libhdf5, and checks what is read of them. */
#include "hdf5_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "make_volumes.h"
#include "volume_support.h"

int hdf5_make_folder(void **state) {
    (void)state;
    mkdir(hdf5_folder, 0777);
    return 0;
}

float hdf5_value(int x, int y, int z, int component) {
    return (float)((7 * x + 3 * y + 11 * z + 29 * component) % 120);
}

/* ---- writing ---- */

hdf5_storage hdf5_plain(void) {
    return (hdf5_storage){
        .sizes = {HDF5_DEPTH, HDF5_HEIGHT, HDF5_WIDTH}, .rank = 3, .z = 0, .y = 1, .x = 2, .c = -1};
}

float *hdf5_make_values(const hdf5_storage *s, hsize_t *count) {
    *count = 1;
    for (int axis = 0; axis < s->rank; axis++) *count *= s->sizes[axis];
    float *values = malloc(*count * sizeof *values);
    for (hsize_t i = 0; i < *count; i++) {
        int at[5] = {0};
        hsize_t rest = i;
        for (int axis = s->rank - 1; axis >= 0; rest /= s->sizes[axis--])
            at[axis] = (int)(rest % s->sizes[axis]);
        values[i] = hdf5_value(at[s->x], at[s->y], at[s->z], s->c >= 0 ? at[s->c] : 0);
    }
    return values;
}

static herr_t add_filter(hid_t creation, int filter, hid_t type) {
    if (filter == H5Z_FILTER_SZIP) return H5Pset_szip(creation, H5_SZIP_NN_OPTION_MASK, 8);
    if (filter == H5Z_FILTER_NBIT) return H5Pset_nbit(creation);
    if (filter == H5Z_FILTER_SCALEOFFSET)
        return H5Pset_scaleoffset(creation,
                                  H5Tget_class(type) == H5T_FLOAT ? H5Z_SO_FLOAT_DSCALE : H5Z_SO_INT, 0);
    return H5Pset_filter(creation, filter, H5Z_FLAG_MANDATORY, 1, (unsigned[]){1});
}

hid_t hdf5_create_array(hid_t parent, const char *name, const hdf5_storage *s) {
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE), links = H5Pcreate(H5P_LINK_CREATE),
                type = s->type ? s->type : H5T_STD_U8LE;
    H5Pset_create_intermediate_group(links, 1);
    if (s->chunk[0]) H5Pset_chunk(creation, s->rank, s->chunk);
    const bool first = s->filter == H5Z_FILTER_NBIT || s->filter == H5Z_FILTER_SCALEOFFSET; /* of values */
    if (first) assert_true(add_filter(creation, s->filter, type) >= 0);
    if (s->shuffle) H5Pset_shuffle(creation);
    if (s->deflate) H5Pset_deflate(creation, 6);
    if (s->compact) H5Pset_layout(creation, H5D_COMPACT);
    if (s->filter && !first) assert_true(add_filter(creation, s->filter, type) >= 0);
    if (s->checksum) H5Pset_fletcher32(creation);
    const hid_t array = H5Dcreate2(parent, name, type, H5Screate_simple(s->rank, s->sizes, NULL), links,
                                   creation, H5P_DEFAULT);
    assert_true(array >= 0);
    return array;
}

hid_t hdf5_write_array(hid_t parent, const char *name, const hdf5_storage *s) {
    hsize_t count;
    const hid_t array = hdf5_create_array(parent, name, s);
    float *values = hdf5_make_values(s, &count);
    assert_true(H5Dwrite(array, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    free(values);
    return array;
}

hid_t hdf5_file_access(void) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    return access;
}

hid_t hdf5_begin(const char *name, bool latest) {
    const hid_t access = hdf5_file_access();
    if (latest) H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const hid_t file = H5Fcreate(vol_path(hdf5_folder, name, 0), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    assert_true(file >= 0);
    return file;
}

const char *hdf5_write_file(const char *name, const hdf5_storage *s, bool latest) {
    const hid_t file = hdf5_begin(name, latest);
    hdf5_write_array(file, "voxels", s);
    H5Fclose(file);
    return vol_path(hdf5_folder, name, 0);
}

/* ---- checking ---- */

void hdf5_check_voxels(const iso_volume *volume, int component) {
    const int *dims = iso_grid_dims(&volume->grid);
    assert_int_equal(dims[0], HDF5_WIDTH);
    assert_int_equal(dims[1], HDF5_HEIGHT);
    assert_int_equal(dims[2], HDF5_DEPTH);
    for (int z = 0; z < HDF5_DEPTH; z++)
        for (int y = 0; y < HDF5_HEIGHT; y++)
            for (int x = 0; x < HDF5_WIDTH; x++)
                if (iso_grid_at(&volume->grid, x, y, z) != hdf5_value(x, y, z, component))
                    fail_msg("voxel %d %d %d: %g, expected %g", x, y, z,
                             (double)iso_grid_at(&volume->grid, x, y, z),
                             (double)hdf5_value(x, y, z, component));
}

void hdf5_check_file(const char *path, const hdf5_storage *s) {
    const int components = s->c >= 0 ? (int)s->sizes[s->c] : 1;
    for (int component = 0; component < components; component++) {
        const iso_volume_opts opts = {.component = component};
        iso_volume volume = test_read_volume(path, &opts);
        assert_int_equal(volume.info.components, components);
        hdf5_check_voxels(&volume, component);
        iso_volume_free(&volume);
    }
}

void hdf5_check_chunk(const char *path) {
    const iso_volume_opts opts = {.mapped = true, .max_memory = 8 << 20};
    const iso_brick_box bricks = {{1, 0, 0}, {2, 1, 1}};
    iso_volume volume = test_read_volume(path, &opts);
    const iso_chunk_source source = iso_volume_source(volume.grid.rgrid);
    iso_grid_chunk chunk;
    iso_rgrid *grid = NULL;
    int first[3], end[3];
    assert_true(iso_grid_chunk_make(source.dims, &source.transform, &bricks, &chunk));
    assert_int_equal(source.read(source.context, &chunk, NULL, &grid, NULL), ISO_OK);
    iso_grid_chunk_voxels(&chunk, first, end);
    assert_int_equal(end[0], HDF5_WIDTH);
    const iso_grid view = {.rgrid = grid};
    for (int z = first[2]; z < end[2]; z++)
        for (int y = first[1]; y < end[1]; y++)
            for (int x = first[0]; x < end[0]; x++)
                if (iso_grid_at(&view, x - ISO_BRICK * chunk.origin[0], y, z) != hdf5_value(x, y, z, 0))
                    fail_msg("voxel %d %d %d of a chunk", x, y, z);
    iso_rgrid_destroy(grid);
    iso_volume_free(&volume);
}

/* ---- attributes, groups and axes ---- */

void hdf5_write_numbers(hid_t object, const char *name, const double *numbers, hsize_t count) {
    const hid_t space = H5Screate_simple(1, &count, NULL);
    const hid_t attribute = H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers);
}

void hdf5_write_text(hid_t object, const char *name, const char *text) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text));
    H5Awrite(H5Acreate2(object, name, type, H5Screate(H5S_SCALAR), H5P_DEFAULT, H5P_DEFAULT), type, text);
}

void hdf5_write_texts(hid_t object, const char *name, const char *const *texts, hsize_t count) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    const hid_t space = H5Screate_simple(1, &count, NULL);
    H5Awrite(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), type, texts);
}

hid_t hdf5_make_group(hid_t parent, const char *path) {
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t group = H5Gcreate2(parent, path, links, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(group >= 0);
    return group;
}

hid_t hdf5_write_axis(hid_t group, const char *name, int size, double first, double step, const char *unit) {
    const hsize_t count = (hsize_t)size;
    double values[64];
    for (int i = 0; i < size; i++) values[i] = first + i * step;
    const hid_t array = H5Dcreate2(group, name, H5T_IEEE_F64LE, H5Screate_simple(1, &count, NULL),
                                   H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(array, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    if (unit) hdf5_write_text(array, "units", unit);
    return array;
}

void hdf5_check_numbers(const char *what, const double *numbers, double x, double y, double z) {
    const double wanted[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (!(numbers[i] >= wanted[i] - 1e-9 && numbers[i] <= wanted[i] + 1e-9))
            fail_msg("%s %d is %.9g, expected %.9g", what, i, numbers[i], wanted[i]);
}
