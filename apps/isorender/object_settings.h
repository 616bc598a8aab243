/* object_settings: the options of files that are drawn in the same picture as the isosurfaces: lines, glyphs
 * and meshes. An *object* is one such file. */
#ifndef ISO_APPS_ISORENDER_OBJECT_SETTINGS_H
#define ISO_APPS_ISORENDER_OBJECT_SETTINGS_H

#include "apps/common/coloring_settings.h"
#include "apps/common/options.h"
#include "scene/object_file.h"

enum {
    ISORENDER_OBJECTS = 32,
    ISORENDER_COLORINGS = 16
}; /* most of them in a picture; of --surface-color-by */

/* How lines are drawn. LINE: with the least width (--line-min-pixels) at any distance. */
typedef enum isorender_line_style {
    ISORENDER_STYLE_TUBE,
    ISORENDER_STYLE_RIBBON,
    ISORENDER_STYLE_LINE
} isorender_line_style;

/* The options for one object. Strings are borrowed from argv. */
typedef struct isorender_object_settings {
    iso_object_kind kind;
    const char *path;
    double radius;             /* mm; NAN: not given */
    const char *radius_column; /* the attribute with the radii; NULL: none */
    bool colored, by_direction;
    iso_rgb color;        /* if colored */
    double opacity;       /* 0 .. 1 */
    const char *color_by; /* the attribute with numbers to be coloured; NULL: none */
    iso_colormap_choice map;
    double range[2]; /* the numbers at both ends of the colormap; NAN: the smallest and the largest number, */
    double range_shares[2]; /* or those that these shares of all numbers do not exceed; NAN: not given */
    bool style_given;
    isorender_line_style style; /* of lines */
    iso_caps caps;              /* of tubes */
    iso_line_shading shading;   /* of tubes, by pull-push */
    bool glyph_given;
    iso_glyph glyph; /* of glyphs, if given */
    iso_glyph_projection projection;
    iso_space space;
    int every; /* 0: not given */
    iso_vector_field_opts field;
} isorender_object_settings;

/* The options as they are given: the n-th value belongs to the n-th object, of those of the option's kind,
 * and the last one to all that follow. Zero-initialise. */
typedef struct isorender_object_options {
    const char *paths[ISORENDER_OBJECTS];
    iso_object_kind kinds[ISORENDER_OBJECTS];
    int count;
    bool has_cloud; /* the input is a file of points, which comes before the objects in the order of values */
    /* by number of the lines */
    iso_texts tube_radii, line_colors, line_opacities, line_styles, line_shadings, caps;
    iso_texts glyph_radii, glyph_colors, glyph_opacities, glyphs, projections; /* by number of the glyphs */
    iso_texts mesh_colors, mesh_opacities;                                     /* by number of the mesh */
    /* of volumes of vectors, by the same numbers as those of lines, of glyphs, and of both */
    iso_texts streamlines, streamline_lengths, streamline_seeds, glyph_scales;
    iso_texts arrays, tensor_orders, leasts;
    int axial;
    iso_texts color_by, maps, ranges, every; /* by number of the cloud or the object that is no mesh; */
    int colorings;    /* of maps and ranges, those of this many values of --surface-color-by follow */
    iso_texts spaces; /* by number of the cloud or the object */
} isorender_object_options;

/* Sets `objects`, in the order of the command line, and `cloud`, which gets the settings of glyphs.
 * ISO_ERR_USAGE: a value that cannot be, more values of an option than there are objects it is for. */
iso_status isorender_objects_resolve(const isorender_object_options *options,
                                     isorender_object_settings objects[ISORENDER_OBJECTS],
                                     isorender_object_settings *cloud, iso_error *error);

/* The value of an option for number `number`, from 0, of the files that it is for; NULL: it is not given. */
const char *isorender_value_for(const iso_texts *texts, int number);
/* Parses the value of --OPTION, a colour; `others` ends the message with what else it could be (" nor ..").
 * NULL: the option is not given, and nothing is set. ISO_ERR_USAGE. */
iso_status isorender_parse_color(const char *option, const char *value, const char *others, bool *given,
                                 iso_rgb *color, iso_error *error);

/* Parses an opacity, 0 to 1 or 0% to 100%. ISO_ERR_USAGE. */
iso_status isorender_opacity(const char *value, double *opacity, iso_error *error);
/* The same as the value of an option; NULL leaves *opacity as it is. */
iso_status isorender_parse_opacity(const char *option, const char *value, double *opacity, iso_error *error);
/* ISO_ERR_USAGE: an option is given more often than there are files that it is for. objects: the options that
 * name those files, for the message. */
iso_status isorender_check_count(const char *option, const iso_texts *texts, const char *objects, int count,
                                 iso_error *error);

#endif
