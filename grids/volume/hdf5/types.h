/* types: which types of values of HDF5 files are read, and as what. In the child process. */
#ifndef ISO_GRIDS_VOLUME_HDF5_TYPES_H
#define ISO_GRIDS_VOLUME_HDF5_TYPES_H

#include "grids/volume/hdf5/library.h"

/* Sets scalar, big_endian and element_bytes from the type of a dataset. Integers of other sizes than those of
 * iso_scalar get the smallest one that holds them, and by_library. False: the values are no numbers, or
 * numbers of a type that is not read, which array->special then says. */
bool iso_hdf5_read_type(hid_t dataset, iso_hdf5_array *array);

/* The type in memory as which libhdf5 is asked for the values of a dataset that iso_hdf5_read_type accepts:
 * the scalar's, in the machine's byte order. */
hid_t iso_hdf5_memory_type(hid_t dataset);

#endif
