/* image_stack: volumes in a folder of images, a slice each, in the natural order of their names: PNG and
 * JPEG. Slices follow one another along z; x is to the right and y downwards in an image. Colours and
 * opacities are components. Internal to grids/volume. */
#ifndef ISO_GRIDS_VOLUME_IMAGE_STACK_H
#define ISO_GRIDS_VOLUME_IMAGE_STACK_H

#include "grids/volume/format.h"
#include "grids/volume/slice_files.h"
#include "grids/volume/tiled.h"

/* What all slices have in common. */
typedef struct iso_image_layout {
    uint32_t width, height;
    iso_scalar scalar;
    int samples; /* values of a pixel */
} iso_image_layout;

/* What the header of an image says. */
typedef struct iso_image_header {
    iso_image_layout layout;
    double spacing[2]; /* mm; 0: not stated */
    uint64_t scratch;  /* bytes of memory that decoding takes beside its target */
    char note[96];     /* on what values are, if it is not empty */
} iso_image_header;

/* A kind of images. Both functions open the file; errors name it. */
typedef struct iso_image_codec {
    iso_slice_kind kind;
    iso_status (*header)(const char *path, iso_image_header *header, iso_error *error);
    /* Writes a component of all pixels, row by row, as values of the type that the layout's scalar is stored
     * as. ISO_ERR_IO if the header is not the `expected` one or decoding takes more than `scratch` bytes. */
    iso_status (*decode)(const char *path, const iso_image_layout *expected, uint64_t scratch, int component,
                         void *values, iso_error *error);
} iso_image_codec;

/* Whether a header still is what it was when the stack was opened. ISO_ERR_IO. */
iso_status iso_image_check_unchanged(const char *path, const iso_image_header *now,
                                     const iso_image_layout *expected, uint64_t scratch, iso_error *error);

/* The functions `info` and `open_tiled` of a format (grids/volume/format.h). The headers of all slices are
 * read; notes and distances are the first one's. A slice is a tile, and is decoded as a whole, also when the
 * volume stays in the files: the limit of memory must allow one. */
iso_status iso_image_stack_info(const iso_image_codec *codec, const char *path, const iso_volume_opts *opts,
                                iso_volume_info *info, iso_error *error);
iso_status iso_image_stack_open(const iso_image_codec *codec, const char *path, const iso_volume_opts *opts,
                                const iso_volume_info *info, iso_tiled *tiled, iso_error *error);

#endif
