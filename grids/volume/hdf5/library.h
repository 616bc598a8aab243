/* library: how the HDF5 reader uses libhdf5, in the child process: opening a file with a driver of our own,
 * errors, attributes. Identifiers are not closed, because the process ends soon. */
#ifndef ISO_GRIDS_VOLUME_HDF5_LIBRARY_H
#define ISO_GRIDS_VOLUME_HDF5_LIBRARY_H

#include <hdf5.h>

#include "grids/volume/hdf5/hdf5.h"

/* A file that libhdf5 reads through the driver. The driver opens this one file, for reading, and no other
 * that a link or a virtual dataset names. */
typedef struct iso_hdf5_file {
    const char *path;
    const char *xml; /* of BigDataViewer, beside the file; NULL: there is none */
    hid_t id;
    int descriptor;
    uint64_t bytes;
    bool opened, refused; /* refused: libhdf5 asked for another file */
    bool has_long_sizes;  /* sizes of objects are stored in 8 bytes, as nearly always */
    bool has_bad_heap;    /* a heap of texts that libhdf5 has asked for is damaged */
    /* While `locating`, values are not read: the place of the last ones that were asked for is kept. */
    bool locating;
    iso_hdf5_place place;
} iso_hdf5_file;

/* Opens a file and silences libhdf5. ISO_ERR_IO, ISO_ERR_FORMAT. */
iso_status iso_hdf5_open(const char *path, iso_hdf5_file *file, iso_error *error);

/* ISO_ERR_IO "path: what: ..." with libhdf5's innermost message; ISO_ERR_LIMIT when it had no memory. */
iso_status iso_hdf5_fail(const iso_hdf5_file *file, const char *what, iso_error *error);

/* Reads item `index` of an attribute of strings; an attribute of single characters is one string (Imaris).
 * False: there is none. */
bool iso_hdf5_text(hid_t object, const char *name, size_t index, char *text, size_t room);

/* Reads the numbers of an attribute, or of a text of numbers. Returns how many there are, at most `room`. */
size_t iso_hdf5_numbers(hid_t object, const char *name, double *numbers, size_t room);

/* Reads the numbers of a small dataset, in the order of the file; free. NULL: they are more than `most`,
 * none, or in another file. */
double *iso_hdf5_values(hid_t dataset, uint64_t most, uint64_t *count);

/* Opens the object at a path; negative: there is none. */
hid_t iso_hdf5_object(hid_t parent, const char *path);
hid_t iso_hdf5_group(hid_t parent, const char *path);
hid_t iso_hdf5_dataset(hid_t parent, const char *path);

/* Copies the path of an object in the file. */
void iso_hdf5_path_of(hid_t object, char path[ISO_HDF5_PATH]);

#endif
