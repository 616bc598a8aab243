/* coloring_settings: --surface-color-by as it is given, and --colormap, which surfaces share with lines,
 * glyphs and points. */
#ifndef ISO_APPS_COMMON_COLORING_SETTINGS_H
#define ISO_APPS_COMMON_COLORING_SETTINGS_H

#include "base/unit.h"
#include "scene/color_file.h"
#include "scene/cuts.h"

enum { ISO_COLORING_PATH = 1024 };

/* A colormap as it is given. */
typedef struct iso_colormap_choice {
    bool given;
    iso_colormap map;
    const char *file; /* of colours, used instead of `map`; borrowed; NULL: none */
} iso_colormap_choice;

/* Parses a name, or the path of a file: what has a dot or a slash, or is there. NULL: not given, viridis.
 * ISO_ERR_USAGE. */
iso_status iso_colormap_choice_parse(const char *value, iso_colormap_choice *map, iso_error *error);

/* Parses two numbers, the smaller one first; NULL: not given, NAN. ISO_ERR_USAGE. */
iso_status iso_range_parse(const char *value, double range[2], iso_error *error);
/* The same, or two shares of the numbers, such as 2%,98%, as fractions; else these are NAN. ISO_ERR_USAGE. */
iso_status iso_range_parse_shares(const char *value, double range[2], double shares[2], iso_error *error);

typedef struct iso_coloring_settings {
    const char *text; /* as it is given */
    iso_color_source source;
    char path[ISO_COLORING_PATH]; /* of a volume or a mesh; "": none */
    char rest[256];               /* what stands behind the path: an array, or an isovalue; "": nothing */
    double isovalue;              /* BY_DISTANCE; NAN: not given */
    iso_things things;            /* what is coloured; without names the isosurfaces */
    iso_colormap_choice map;
    double range[2]; /* NAN: to be found */
} iso_coloring_settings;

/* Parses VOLUME[:ARRAY], curvature, distance:FILE[:ISOVALUE], depth or normal, with @N,.. behind it.
 * ISO_ERR_USAGE. */
iso_status iso_coloring_settings_parse(const char *value, iso_coloring_settings *coloring, iso_error *error);

/* The file that is named, to be opened, if settings->path is not empty. Borrows the settings. */
iso_color_file iso_coloring_settings_file(const iso_coloring_settings *settings);

/* Sets the title of a bar: the name of what is shown, with its unit. */
void iso_coloring_settings_title(const iso_coloring_settings *settings, iso_world_unit world,
                                 iso_color_bar *bar);

#endif
