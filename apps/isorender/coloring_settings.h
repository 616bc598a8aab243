/* coloring_settings: --surface-color-by as it is given, and --colormap, which surfaces share with lines,
 * glyphs and points. */
#ifndef ISO_APPS_ISORENDER_COLORING_SETTINGS_H
#define ISO_APPS_ISORENDER_COLORING_SETTINGS_H

#include "image/colormap.h"
#include "scene/coloring.h"
#include "scene/cuts.h"

enum { ISORENDER_COLORINGS = 16, ISORENDER_COLORING_PATH = 1024 };

/* A colormap as it is given. */
typedef struct isorender_colormap {
    bool given;
    iso_colormap map;
    const char *file; /* of colours, used instead of `map`; borrowed; NULL: none */
} isorender_colormap;

/* Parses a name, or the path of a file: what has a dot or a slash, or is there. NULL: not given, viridis.
 * ISO_ERR_USAGE. */
iso_status isorender_colormap_parse(const char *value, isorender_colormap *map, iso_error *error);

/* Parses two numbers, the smaller one first; NULL: not given, NAN. ISO_ERR_USAGE. */
iso_status isorender_range_parse(const char *value, double range[2], iso_error *error);

typedef struct isorender_coloring_settings {
    const char *text; /* as it is given */
    iso_color_source source;
    char path[ISORENDER_COLORING_PATH]; /* of a volume or a mesh; "": none */
    char rest[256];    /* what stands behind the path: an array, or an isovalue; "": nothing */
    double isovalue;   /* BY_DISTANCE; NAN: not given */
    iso_things things; /* what is coloured; without names the isosurfaces */
    isorender_colormap map;
    double range[2]; /* NAN: to be found */
} isorender_coloring_settings;

/* Parses VOLUME[:ARRAY], curvature, distance:FILE[:ISOVALUE], depth or normal, with @N,.. behind it.
 * ISO_ERR_USAGE. */
iso_status isorender_coloring_parse(const char *value, isorender_coloring_settings *coloring,
                                    iso_error *error);

#endif
