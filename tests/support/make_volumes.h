/* make_volumes: writes small volume files of every format and encoding byte by byte, from the formats'
 * descriptions, so that tests depend on no other writer. */
#ifndef ISO_TESTS_MAKE_VOLUMES_H
#define ISO_TESTS_MAKE_VOLUMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "grids/volume/format.h"

typedef struct vol_spec {
    int dims[3];
    iso_scalar scalar;
    int components;
    bool big; /* big-endian, if the format allows both */
} vol_spec;

size_t vol_count(const vol_spec *spec); /* voxels */
/* The value that the file has for a component of a voxel: within the range of its type, and exact as a float.
 */
double vol_value(const vol_spec *spec, size_t voxel, int component);

/* A way to write a volume: to the `files` in a folder, of which the first is the one to open. */
typedef struct vol_kind {
    const char *name;
    const char *files[4];
    bool (*suits)(const vol_spec *spec); /* NULL: every spec */
    void (*write)(const struct vol_kind *kind, const char *folder, const vol_spec *spec);
    int variant;
    const char *needs; /* the format, as iso_volume_info names it */
} vol_kind;

extern const vol_kind vol_kinds[];
extern const size_t vol_kind_count;

/* folder/name, in a static buffer of its own for each `slot` 0 .. 3. */
const char *vol_path(const char *folder, const char *name, int slot);
void vol_write_bytes(const char *path, const void *bytes, size_t count);
void vol_write_text(const char *path, const char *text);
/* A whole file, malloced. */
unsigned char *vol_read_bytes(const char *path, size_t *count);

/* A NIfTI header of 352 (version 1) or 544 (version 2) bytes; fields by vol_nifti_set. */
typedef struct vol_nifti {
    unsigned char bytes[544];
    size_t count;
    int version;
    bool big;
} vol_nifti;
void vol_nifti_make(vol_nifti *header, int version, const vol_spec *spec);
typedef enum vol_nifti_field {
    VOL_NIFTI_SLOPE,
    VOL_NIFTI_INTER,
    VOL_NIFTI_UNITS,
    VOL_NIFTI_QFORM,
    VOL_NIFTI_SFORM,
    VOL_NIFTI_QUATERN, /* b c d, then the offsets x y z */
    VOL_NIFTI_SROW,    /* 12 */
    VOL_NIFTI_DIM,     /* 8 */
    VOL_NIFTI_PIXDIM,  /* 8 */
    VOL_NIFTI_TYPE,
    VOL_NIFTI_OFFSET
} vol_nifti_field;
void vol_nifti_set(vol_nifti *header, vol_nifti_field field, int index, double value);

/* Writes values in file order: components are interleaved or, when planar, one volume after the other. */
void vol_put_values(FILE *file, const vol_spec *spec, bool planar);

#endif
