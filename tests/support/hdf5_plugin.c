/* hdf5_plugin: a filter that inverts all bits. */
#include "hdf5_plugin.h"

#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <H5PLextern.h>

/* Takes a gigabyte, or fails. */
static size_t take_memory(size_t bytes) {
    enum { PIECE = 1 << 20, PIECES = 1024 };
    for (int pieces = 0; pieces < PIECES; pieces++) {
        void *piece = malloc(PIECE);
        if (!piece) return 0;
        memset(piece, 1, PIECE);
    }
    return bytes;
}

static size_t apply(unsigned flags, size_t count, const unsigned values[], size_t bytes, size_t *room,
                    void **buffer) {
    unsigned char *data = *buffer;
    (void)count, (void)values, (void)room;
    for (size_t i = 0; i < bytes; i++) data[i] = (unsigned char)~data[i];
    if (!(flags & H5Z_FLAG_REVERSE) || !bytes) return bytes;
    switch (data[0]) {
    case HDF5_PLUGIN_CRASHES:
        raise(SIGSEGV);
        return 0;
    case HDF5_PLUGIN_NEVER_ENDS:
        while (*(volatile unsigned char *)data) {
        }
        return 0;
    case HDF5_PLUGIN_FAILS:
        return 0;
    case HDF5_PLUGIN_TAKES_MEMORY:
        return take_memory(bytes);
    default:
        return bytes;
    }
}

static const H5Z_class2_t filter = {
    H5Z_CLASS_T_VERS, HDF5_PLUGIN_FILTER, 1, 1, "inverting filter of the tests", NULL, NULL, apply};

H5PL_type_t H5PLget_plugin_type(void) {
    return H5PL_TYPE_FILTER;
}

const void *H5PLget_plugin_info(void) {
    return &filter;
}
