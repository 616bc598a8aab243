/* volume_settings: the options of further volumes (--volume), each of which is drawn as one isosurface in the
 * same picture. */
#ifndef ISO_APPS_ISORENDER_VOLUME_SETTINGS_H
#define ISO_APPS_ISORENDER_VOLUME_SETTINGS_H

#include "apps/common/options.h"
#include "isopoint.h"

enum { ISORENDER_VOLUMES = 16 }; /* in a picture, beside the input */

/* An isovalue as it is given. */
typedef struct isorender_isovalue {
    double value; /* physical, or standard deviations above the mean of the voxels; NaN: auto */
    bool sigma;   /* standard deviations */
} isorender_isovalue;

/* Parses a number, a number with "sigma" behind it, or "auto". */
bool isorender_parse_isovalue(const char *text, isorender_isovalue *isovalue);

/* What the options say of one volume. Strings are borrowed from argv. */
typedef struct isorender_volume_settings {
    const char *path;    /* NULL: that of the input */
    const char *channel; /* of the input (--channel), which is read as the input is; NULL: not a channel */
    isorender_isovalue isovalue; /* auto: it is chosen as that of the input */
    bool colored;
    iso_rgb color; /* if colored */
    double opacity;
    const char *grid; /* as --grid of the input; NULL: not given */
    int component;    /* as --component of the input */
} isorender_volume_settings;

/* The options as they are given: the n-th value belongs to the n-th volume, and the last one to all that
 * follow. Zero-initialise. */
typedef struct isorender_volume_options {
    const char *paths[ISORENDER_VOLUMES];
    int count;
    iso_texts isovalues, colors, opacities, grids, components;
} isorender_volume_options;

/* Sets options->count of `volumes`, in the order of the command line. ISO_ERR_USAGE: a value that cannot be,
 * more values of an option than there are volumes. */
iso_status isorender_volumes_resolve(const isorender_volume_options *options,
                                     isorender_volume_settings *volumes, iso_error *error);

#endif
