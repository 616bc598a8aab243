/* dicom_files: writes the DICOM files that test_dicom reads back. */
#ifndef ISO_TESTS_DICOM_FILES_H
#define ISO_TESTS_DICOM_FILES_H

#include <stddef.h>

#include "base/c_linkage.h"

ISO_C_BEGIN

typedef enum dicom_syntax { DICOM_EXPLICIT, DICOM_IMPLICIT, DICOM_BIG } dicom_syntax;

/* One file; text fields NULL or empty: the element is left out. */
typedef struct dicom_spec {
    dicom_syntax syntax;
    const char *series, *description, *photometric; /* MONOCHROME2 when NULL */
    const char *position, *orientation, *spacing, *between, *thickness;
    const char *slope, *intercept, *instance, *acquisition, *temporal, *series_number;
    int columns, rows, samples, frames; /* samples and frames 0: 1; frames is written when above 0 */
    int allocated, stored, high, is_signed;
    const void *pixels; /* native order; NULL: no pixels and no image elements */
    /* Enhanced multi-frame: a position per frame, in functional groups with lengths or with delimiters. */
    const char *const *frame_positions;
    int delimited;
} dicom_spec;

/* Aborts the program when the file cannot be written. */
void dicom_write(const char *path, const dicom_spec *spec);

/* Rewrites the file at `path` with its pixels compressed, by GDCM: "rle", "jpeg" (lossless), "jpegls", "j2k"
 * (lossless). Returns 0, or 1 when GDCM cannot. */
int dicom_compress(const char *path, const char *how);

ISO_C_END
#endif
