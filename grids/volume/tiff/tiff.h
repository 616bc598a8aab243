/* tiff: the types and functions of the TIFF reader.
 *
 * A volume in TIFF is a file with an image for each slice, or a folder with a file for each slice. stack.c
 * lists the images in order and checks that they fit together, metadata.c reads what ImageJ and OME-TIFF
 * write into the image description, planes.c finds which image is which slice, pixels.c reads the values of
 * an image, and format_tiff.c is the reader (a module, with libtiff). */
#ifndef ISO_GRIDS_VOLUME_TIFF_TIFF_H
#define ISO_GRIDS_VOLUME_TIFF_TIFF_H

#include "grids/volume/module.h"
#include "grids/volume/slice_files.h"

/* ---- metadata ---- */

/* The axes of the images of a file, in the order in which they follow one another, fastest first. */
typedef enum iso_tiff_axis { ISO_TIFF_CHANNEL, ISO_TIFF_SLICE, ISO_TIFF_TIME, ISO_TIFF_AXES } iso_tiff_axis;

/* An element TiffData of OME: images of one file, one after another, that hold planes of a position, one
 * after another in the order of the axes. */
typedef struct iso_tiff_run {
    uint32_t position;
    uint32_t first[ISO_TIFF_AXES]; /* channel, slice and time of the first plane */
    uint32_t file;                 /* in the stack's list of files */
    uint32_t page;                 /* of the first plane's image in the file */
    uint32_t count;                /* of planes */
} iso_tiff_run;

typedef struct iso_tiff_metadata {
    iso_tiff_axis order[ISO_TIFF_AXES];
    uint32_t sizes[ISO_TIFF_AXES]; /* 0: not stated */
    uint32_t positions; /* of the stage, an element Pixels of OME each, as far as they have the sizes and the
                           order of the first one; at least 1 */
    iso_tiff_run *runs; /* where the planes are; none: images are in the order of the axes, positions last */
    size_t run_count, run_room;
    uint32_t images;       /* ImageJ: number of images in the file; 0: not stated */
    double spacing[3];     /* mm; 0: not stated */
    double unit;           /* ImageJ: length of the unit of the resolution tags, mm; 0: not stated */
    iso_channels channels; /* OME: of the first position, as far as it has elements Channel */
    const char *writer;    /* "ImageJ", "OME", or NULL: the description has no metadata */
} iso_tiff_metadata;

/* Parses the text of an ImageDescription tag of the first of `files`; NULL is fine. Numbers that make no
 * sense count as not stated. Runs are listed only of these files. iso_tiff_metadata_free when done, also
 * after an error. ISO_ERR_NOMEM. */
iso_status iso_tiff_metadata_parse(const char *description, const iso_slice_files *files,
                                   iso_tiff_metadata *metadata, iso_error *error);
void iso_tiff_metadata_free(iso_tiff_metadata *metadata);

/* ---- images ---- */

/* The layout of an image. All images of a stack have the same. */
typedef struct iso_tiff_layout {
    uint32_t width, height;
    iso_scalar scalar;
    uint16_t samples; /* values of a pixel */
    bool separate;    /* samples lie in planes of their own */
} iso_tiff_layout;

typedef struct iso_tiff_image {
    uint32_t file, page;
    uint64_t header; /* its position in the file, byte */
    bool differs;    /* its layout is not that of the stack */
} iso_tiff_image;

typedef struct iso_tiff_stack {
    iso_slice_files files;
    iso_tiff_image *images; /* in the order of files and pages */
    size_t count, room;
    iso_tiff_layout layout;
    iso_error different;        /* why the first image whose layout differs cannot be a slice */
    iso_tiff_metadata metadata; /* of the first image */
    double resolution[2];       /* mm between pixels along x and y; 0: not stated */
    uint64_t block_bytes;       /* the largest strip or tile */
    uint64_t contiguous;        /* ImageJ: only the first image has a header; byte at which the values of all
                                   images begin, one after another; 0: every image has a header */
    bool big_endian;            /* of contiguous values */
    bool lossy;                 /* an image is compressed by a method that changes values */
    size_t overviews;           /* images left out because they are reduced copies of others */
} iso_tiff_stack;

/* Lists the images of a file, or of the files of a folder in the natural order of their names (slice_2
 * before slice_10), and reads their headers. The files are added to opts->files. iso_tiff_stack_free when
 * done, also after an error. ISO_ERR_IO: a damaged or truncated file, also one whose chain of headers breaks
 * off or returns to an earlier one; ISO_ERR_FORMAT: images of different sizes or types, or of a type that is
 * not supported; ISO_ERR_NOMEM. Each text names the file. */
iso_status iso_tiff_stack_open(const char *path, const iso_volume_opts *opts, iso_tiff_stack *stack,
                               iso_error *error);
void iso_tiff_stack_free(iso_tiff_stack *stack);

/* ---- planes ---- */

/* Which images are the slices of the component that opts->component names. Channels are components; so are
 * the channels of further times and positions: sample s of channel c of time t at position p is component s
 * + samples * (c + channels * (t + times * p)). */
typedef struct iso_tiff_planes {
    uint64_t slices;
    int sample;           /* of each pixel */
    uint64_t first, step; /* numbers of images: of the first slice, and from one slice to the next */
} iso_tiff_planes;

/* Finds the planes by the stack's metadata, if its images are those that the metadata state, else every
 * image is a slice. With metadata that name the image of each plane, the stack's images are put into this
 * order, and others are removed. Sets info's dims, component and components, and adds notes of what is left
 * out. ISO_ERR_FORMAT: an image whose layout differs would be a slice; ISO_ERR_USAGE: no such component;
 * ISO_ERR_NOMEM. */
iso_status iso_tiff_planes_find(const char *path, const iso_volume_opts *opts, iso_tiff_stack *stack,
                                iso_tiff_planes *planes, iso_volume_info *info, iso_error *error);

/* ---- values ---- */

/* Opens a file for reading with libtiff; strips and tiles of more than `most` bytes (0: no limit) are
 * refused. libtiff's messages are kept for iso_tiff_fail and not printed. Close with iso_tiff_close.
 * ISO_ERR_IO. */
typedef struct iso_tiff_file iso_tiff_file;
iso_status iso_tiff_open(const char *path, uint64_t most, iso_tiff_file **file, iso_error *error);
/* The same for a file that is open for reading and writing, which is libtiff's when it has been opened. */
iso_status iso_tiff_open_to_change(const char *path, int descriptor, iso_tiff_file **file, iso_error *error);
void iso_tiff_close(iso_tiff_file *file);
struct tiff *iso_tiff_handle(iso_tiff_file *file);
/* Makes an image of this file the current one, in a time that does not depend on its number. ISO_ERR_IO. */
iso_status iso_tiff_set_image(iso_tiff_file *file, const iso_tiff_image *image, iso_error *error);
/* What libtiff only warned about although it changes the volume: a known tag whose values lie behind the end
 * of the file, or a chain of headers that returns to an earlier one. NULL: nothing. */
const char *iso_tiff_damage(const iso_tiff_file *file);
/* ISO_ERR_IO "file, image N: ..." with libtiff's last message, or `text` if it has none. */
iso_status iso_tiff_fail(const iso_tiff_file *file, uint32_t page, const char *text, iso_error *error);

/* A box of the pixels of an image. */
typedef struct iso_tiff_box {
    uint32_t x, y, width, height;
} iso_tiff_box;

/* The pixels of a strip (as wide as the image) or a tile of the current image, at most the image's height. */
void iso_tiff_block_size(iso_tiff_file *file, const iso_tiff_layout *layout, uint32_t *width,
                         uint32_t *height);

/* Reads one sample of a box of pixels of the current image of `file` into `target`, rows of box->width values
 * of `type` (iso_scalar_convert); pixels outside the image are left alone. `block` is memory for
 * stack->block_bytes bytes. ISO_ERR_IO. */
typedef struct iso_tiff_target {
    iso_tiff_box box;
    int sample;
    iso_type type;
    void *data;
} iso_tiff_target;
iso_status iso_tiff_read_box(iso_tiff_file *file, const iso_tiff_stack *stack, uint32_t page, void *block,
                             const iso_tiff_target *target, iso_error *error);

/* ---- rewrite ---- */

/* Whether iso_tiff_rewrite can write a stack again. */
bool iso_tiff_can_rewrite(const iso_tiff_stack *stack);
/* As iso_file_rewriter (grids/volume/module.h): blocks with changed values are compressed as they were. */
iso_status iso_tiff_rewrite(const char *path, const iso_volume_opts *opts, iso_row_changer *change,
                            void *context, FILE *stream, const iso_progress *progress, iso_error *error);

#endif
