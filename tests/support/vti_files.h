/* vti_files: writes and reads .vti files by VTK's own writer and reader, for test_vti. All functions return
 * 0, or 1 on failure. */
#ifndef ISO_TESTS_VTI_FILES_H
#define ISO_TESTS_VTI_FILES_H

#include <stddef.h>

#include "base/c_linkage.h"

ISO_C_BEGIN

enum vti_flags {
    VTI_RAW = 1,        /* values appended as raw bytes; otherwise in base64 within their elements */
    VTI_COMPRESSED = 2, /* by zlib */
    VTI_HEADER_64 = 4,  /* otherwise numbers before arrays have 32 bits */
    VTI_BIG_ENDIAN = 8,
    VTI_CELL_DATA = 16,
    VTI_SECOND_ACTIVE = 32, /* the second array is the active scalars; otherwise the first */
    VTI_NONE_ACTIVE = 64,   /* no array is */
    VTI_TWO_PIECES = 128
};

typedef struct vti_spec {
    const char *type;     /* uint8 int8 int16 uint16 float double */
    const char *names[2]; /* of the arrays of random values; the second may be NULL */
    int components;
    int extent[6];
    double origin[3], spacing[3];
    double direction[9]; /* row-major */
    int flags;           /* vti_flags */
} vti_spec;

int vti_write(const char *path, const vti_spec *spec);

typedef struct vti_image {
    int dims[3];        /* points, or cells */
    double origin[3];   /* world position of the first point or cell centre */
    double steps[3][3]; /* from it to the next along each axis */
    double *values;     /* one component of the array, x fastest; free() */
} vti_image;

/* Reads one component of the array of a name; NULL: of the active scalars, or else of the first array. */
int vti_read(const char *path, const char *name, int component, vti_image *image);

ISO_C_END
#endif
