/* input: the options of a user that say how a volume is read, reading a volume with them, and their text in
 * stroke files. The programs' tables of options (apps/common/input_options.inc) fill an iso_input. */
#ifndef ISO_GRIDS_VOLUME_INPUT_H
#define ISO_GRIDS_VOLUME_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "grids/volume/volume.h"

enum { ISO_LEVEL_AUTO = -1 };

/* All zero: default options. Strings are borrowed. A program's settings begin with an iso_input. */
typedef struct iso_input {
    const char *grid, *series;
    int component, has_raw, cropped, cropped_mm;
    const char
        *channel; /* number or name of the channel that is read instead of `component`; NULL: not given */
    /* The label of a segmentation that is opened instead of the values: its number, or a name in the file or
     * in `label_table`, which a stroke file does not keep (src/source/label.h); NULL: not given. */
    const char *label, *label_table;
    int level; /* of a multiscale image; ISO_LEVEL_AUTO: to be chosen by the program for its picture */
    iso_raw_layout raw;
    double spacing[3];   /* mm; 0: the file's */
    int crop[6];         /* with `cropped`: x0 x1 y0 y1 z0 z1, voxels, first and last */
    double crop_mm[6];   /* with `cropped_mm`: the same in world mm */
    uint64_t max_memory; /* bytes; 0: the default */
    int largest;         /* parts of the solid to keep (grids/parts/components.h); 0: all */
    double min_size;     /* mm3 of a part that is kept */
} iso_input;

/* Parse the value of an option. `settings` begins with an iso_input. ISO_ERR_USAGE. */
iso_status iso_input_apply_raw(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_spacing(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_level(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_crop(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_crop_mm(void *settings, const char *value, iso_error *error);

/* ISO_ERR_USAGE when options contradict each other. */
iso_status iso_input_check(const iso_input *input, iso_error *error);

/* Returns the first option given that only volumes have, such as "--crop"; NULL: none was given. For inputs
 * that are not volumes. */
const char *iso_input_volume_option(const iso_input *input);

/* Returns the options for iso_volume_read, with files, pool and progress unset. Borrows `input`. */
iso_volume_opts iso_input_volume_opts(const iso_input *input);

/* Computes the range of voxels that are kept, as x0 x1 y0 y1 z0 z1, first and last: all without a crop; those
 * of --crop; for --crop-mm the smallest range that contains every voxel whose position lies in the box.
 * ISO_ERR_USAGE: --crop extends beyond the volume, or no voxel lies in the box. */
iso_status iso_input_box(const iso_input *input, const int dims[3], const iso_transform *transform,
                         int box[6], iso_error *error);
/* Crops a grid to these voxels if the options ask for it; the voxels keep their world positions. */
iso_status iso_input_crop(const iso_input *input, const int box[6], iso_grid *grid, iso_error *error);

/* Reads and crops a volume. `opts` has the file set that all files read are added to, the thread pool and the
 * progress. Errors: those of iso_volume_read and iso_input_box; their messages begin with the path. */
iso_status iso_input_read(const char *path, const iso_input *input, const iso_volume_opts *opts,
                          iso_volume *volume, iso_error *error);

/* Returns whether --largest or --min-size is given. Parts are not dropped by reading, because that needs an
 * isovalue. */
bool iso_input_drops_parts(const iso_input *input);

/* Writes the options that decide which voxels are read as lines "option=value", for a journal; "" for default
 * options. ISO_ERR_USAGE when a name has line breaks, or the text does not fit into `room` bytes. */
iso_status iso_input_write(const iso_input *input, char *text, size_t room, iso_error *error);
/* Parses lines that iso_input_write has written. `text` is changed, and `input` borrows its strings from it.
 * ISO_ERR_FORMAT. */
iso_status iso_input_parse(char *text, iso_input *input, iso_error *error);

#endif
