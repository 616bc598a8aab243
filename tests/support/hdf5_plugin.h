/* hdf5_plugin: a filter that libhdf5 finds in the folder HDF5_PLUGIN_PATH. */
#ifndef ISO_TESTS_SUPPORT_HDF5_PLUGIN_H
#define ISO_TESTS_SUPPORT_HDF5_PLUGIN_H

enum { HDF5_PLUGIN_FILTER = 270 }; /* of the numbers that are free for tests */

/* A chunk whose first byte is one of these makes the filter misbehave while decoding. */
enum { HDF5_PLUGIN_CRASHES = 201, HDF5_PLUGIN_NEVER_ENDS, HDF5_PLUGIN_FAILS, HDF5_PLUGIN_TAKES_MEMORY };

#endif
