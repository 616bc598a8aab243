/* exr_files: reads and writes OpenEXR pictures with OpenEXR's C++ library, which shares no code with the C
 * API that the library uses: reads what iso_exr_write wrote, and writes pictures of kinds that it does not
 * write. All functions return 0, or 1 on failure. */
#ifndef ISO_TESTS_EXR_FILES_H
#define ISO_TESTS_EXR_FILES_H

#include "base/c_linkage.h"

ISO_C_BEGIN

enum { EXR_PICTURE_CHANNELS = 5 };

typedef struct exr_picture {
    int min_x, min_y, width, height;
    const char *names[EXR_PICTURE_CHANNELS + 1]; /* up to a NULL */
    /* Value of a channel at pixel (x, y), counted from the window's corner. */
    float (*value)(int channel, int x, int y);
    int half, integers, tiled;
    int subsampled;  /* channels are sampled every so many pixels; 0 is 1 */
    int compression; /* OpenEXR's number */
} exr_picture;

int exr_write(const char *path, const exr_picture *picture);

/* A channel of 32-bit floats, width * height of them; the window must begin at 0. */
int exr_read(const char *path, const char *channel, int width, int height, float *values);
/* A channel of 32-bit unsigned integers, likewise. */
int exr_read_integers(const char *path, const char *channel, int width, int height, unsigned *values);
/* Reads a matrix attribute, row-major, for multiplication with row vectors. */
int exr_read_matrix(const char *path, const char *attribute, float matrix[16]);
int exr_read_float(const char *path, const char *attribute, float *value);
int exr_has_text(const char *path, const char *attribute, const char *text);

ISO_C_END
#endif
