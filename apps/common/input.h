/* input: how a volume is read, as the options of apps/common/input_options.inc say it. isorender, isocompare
 * and isosculpt share the table, what it is stored in, and what is made of it. */
#ifndef ISO_APPS_COMMON_INPUT_H
#define ISO_APPS_COMMON_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "grids/volume/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* All zero: nothing was asked for. Strings are borrowed. A program's settings begin with one. */
typedef struct iso_input {
    const char *grid, *series;
    int component, has_raw, cropped, cropped_mm;
    iso_raw_layout raw;
    double spacing[3];   /* mm; 0: the file's */
    int crop[6];         /* with `cropped`: x0 x1 y0 y1 z0 z1, voxels, first and last */
    double crop_mm[6];   /* with `cropped_mm`: the same in world mm */
    uint64_t max_memory; /* bytes; 0: the default */
    int largest;         /* parts of the solid to keep (grids/parts/components.h); 0: all */
    double min_size;     /* mm3 of a part that is kept */
} iso_input;

/* Values of options. `settings` begins with an iso_input. */
iso_status iso_input_apply_raw(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_spacing(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_crop(void *settings, const char *value, iso_error *error);
iso_status iso_input_apply_crop_mm(void *settings, const char *value, iso_error *error);

/* ISO_ERR_USAGE when options contradict each other. */
iso_status iso_input_check(const iso_input *input, iso_error *error);

/* The first given option that only a volume has a use for ("--crop"), or NULL. */
const char *iso_input_volume_option(const iso_input *input);

/* How iso_volume_read reads it; pool and progress are left to the caller. Borrows `input`. */
iso_volume_opts iso_input_volume_opts(const iso_input *input);

/* The voxels that are wanted of a volume: all without a crop, --crop's, or, for --crop-mm, the smallest range
 * that holds every voxel whose position lies in the box. ISO_ERR_USAGE when --crop reaches outside, or
 * when the box holds no voxel. */
iso_status iso_input_box(const iso_input *input, const int dims[3], const iso_transform *transform,
                         int box[6], iso_error *error);
/* Cuts a grid down to them, if there is a crop; its transform moves along. */
iso_status iso_input_crop(const iso_input *input, const int box[6], iso_grid *grid, iso_error *error);

/* Reads and crops: as iso_volume_read and iso_input_box, whose texts then begin with the path. `opts` gives
 * files, pool and progress. */
iso_status iso_input_read(const char *path, const iso_input *input, const iso_volume_opts *opts,
                          iso_volume *volume, iso_error *error);

/* Whether parts of the solid are to be dropped. Reading does not do it: it takes an isovalue. */
bool iso_input_drops_parts(const iso_input *input);

/* What of it decides what is read, as lines "option=value", for a journal to keep; empty when nothing does.
 * ISO_ERR_USAGE when a name has line breaks, or it does not fit into `room` bytes. */
iso_status iso_input_write(const iso_input *input, char *text, size_t room, iso_error *error);
/* Back again; `text` is cut into the strings that `input` then borrows. ISO_ERR_FORMAT. */
iso_status iso_input_parse(char *text, iso_input *input, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
