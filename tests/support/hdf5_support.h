/* hdf5_support: writes arrays into HDF5 files by libhdf5, and checks what is read of them. */
#ifndef ISO_TESTS_SUPPORT_HDF5_SUPPORT_H
#define ISO_TESTS_SUPPORT_HDF5_SUPPORT_H

#include <stdbool.h>

#include <hdf5.h>

#include "grids/volume/volume.h"

/* Where files are written; each test defines it. */
extern const char hdf5_folder[];
/* For cmocka. */
int hdf5_make_folder(void **state);

/* The usual voxels: integers from 0 to 119. */
enum {
    HDF5_WIDTH = 23,
    HDF5_HEIGHT = 17,
    HDF5_DEPTH = 12,
    HDF5_VOXELS = HDF5_WIDTH * HDF5_HEIGHT * HDF5_DEPTH
};
float hdf5_value(int x, int y, int z, int component);

/* How an array is stored. */
typedef struct hdf5_storage {
    hid_t type; /* 0: uint8 */
    hsize_t sizes[5];
    int rank;
    hsize_t chunk[5]; /* 0: in one piece */
    bool compact;     /* in the header */
    bool shuffle, deflate, checksum;
    int filter;     /* the number of a further one; 0: none */
    int x, y, z, c; /* which axis is which; c < 0: none */
} hdf5_storage;

hdf5_storage hdf5_plain(void);
/* The values in the order of the file, malloced. */
float *hdf5_make_values(const hdf5_storage *s, hsize_t *count);
hid_t hdf5_create_array(hid_t parent, const char *name, const hdf5_storage *s);
hid_t hdf5_write_array(hid_t parent, const char *name, const hdf5_storage *s);

/* Files are closed with everything in them. */
hid_t hdf5_file_access(void);
/* Creates a file in the folder; latest: with the newest structures of libhdf5. */
hid_t hdf5_begin(const char *name, bool latest);
/* A file with one array, "voxels". Returns its path: slot 0 of vol_path. */
const char *hdf5_write_file(const char *name, const hdf5_storage *s, bool latest);

/* Writes attributes: numbers; a string of fixed length, as h5py's numpy.bytes_; strings of variable length,
 * as h5py writes str. */
void hdf5_write_numbers(hid_t object, const char *name, const double *numbers, hsize_t count);
void hdf5_write_text(hid_t object, const char *name, const char *text);
void hdf5_write_texts(hid_t object, const char *name, const char *const *texts, hsize_t count);
hid_t hdf5_make_group(hid_t parent, const char *path);
/* Writes the coordinates of an axis: first, first + step, ..; without the attribute units if `unit` is NULL.
 */
hid_t hdf5_write_axis(hid_t group, const char *name, int size, double first, double step, const char *unit);

void hdf5_check_numbers(const char *what, const double *numbers, double x, double y, double z);
void hdf5_check_voxels(const iso_volume *volume, int component);
/* Reads a file and checks all voxels of all components. */
void hdf5_check_file(const char *path, const hdf5_storage *s);
/* Reads the volume as one that is larger than memory: a chunk in its middle, with its halo. */
void hdf5_check_chunk(const char *path);

#endif
