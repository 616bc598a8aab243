/* npy_header: the header of NumPy's .npy files, versions 1 to 3 of the format: a Python dictionary that
 * names type, order and shape of one array. */
#ifndef ISO_GRIDS_VOLUME_NPY_HEADER_H
#define ISO_GRIDS_VOLUME_NPY_HEADER_H

#include "grids/volume/format.h"

enum {
    ISO_NPY_HEAD = 12,    /* bytes at the file's beginning, for iso_npy_begin */
    ISO_NPY_TEXT = 60000, /* the longest dictionary that is read */
    ISO_NPY_AXES = 32     /* as many as NumPy allows */
};

typedef struct iso_npy_header {
    size_t text_at, text_bytes; /* place and length of the dictionary; the numbers follow it */
    iso_scalar scalar;
    bool big_endian;
    bool fortran; /* the first index is the fastest one; else the last */
    int axes;
    uint64_t shape[ISO_NPY_AXES];
} iso_npy_header;

/* Whether the beginning of a file is that of an .npy file. */
bool iso_npy_is(const void *bytes, size_t count);

/* Finds the dictionary. ISO_ERR_FORMAT: not such a file; ISO_ERR_UNSUPPORTED: another version of the
 * format. */
iso_status iso_npy_begin(const char *path, const unsigned char head[ISO_NPY_HEAD], iso_npy_header *header,
                         iso_error *error);

/* Parses the dictionary, as a string. ISO_ERR_FORMAT; ISO_ERR_UNSUPPORTED: numbers of another type. */
iso_status iso_npy_parse(const char *path, const char *text, iso_npy_header *header, iso_error *error);

/* The number of axes of the array in a file; 0: it is none, or cannot be read. */
int iso_npy_axes(const char *path);

#endif
