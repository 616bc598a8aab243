/* objects: lines, glyphs and meshes of further files that are drawn in the picture. */
#ifndef ISO_APPS_ISORENDER_OBJECTS_H
#define ISO_APPS_ISORENDER_OBJECTS_H

#include "apps/common/json.h"
#include "apps/isorender/object_settings.h"
#include "base/parallel.h"
#include "scene/object_file.h"

/* One file. Zero-initialise, isorender_object_free when done. */
typedef struct isorender_object {
    const isorender_object_settings *settings; /* borrowed; the path is NULL for the input itself */
    /* What the file holds, by settings->kind; lines and glyphs with the radii and colours that are drawn. */
    iso_object_file file;
    isorender_object_settings own; /* of lines and triangles of such a mesh: its own settings */
    const struct isorender_object
        *whole; /* the object whose file this one is a part of; NULL: it has its own */
    iso_gradient_glyphs_totals gradients; /* of --glyphs surface */
    iso_glyph glyph;                      /* of glyphs: the solid that is drawn */
    const char *color_by;   /* borrowed: the attribute with numbers to be coloured; NULL: none */
    iso_scene_object scene; /* what is drawn; nothing before isorender_object_prepare */
    iso_box bounds;         /* world box of what is drawn */
    bool has_bar;
    iso_color_bar bar;      /* the legend of its colours, if has_bar */
    iso_color_table colors; /* of the file that --colormap names, if it does */
} isorender_object;

/* Reads the file, adds it to `files`, and gives lines or glyphs the radii and colours that the settings say.
 * ISO_ERR_EMPTY: the file holds nothing; ISO_ERR_USAGE: it has no column of a name that was given; the errors
 * of iso_lines_read, iso_glyphs_read and iso_mesh_read. Messages name the file. */
iso_status isorender_object_read(isorender_object *object, const isorender_object_settings *settings,
                                 uint64_t max_memory, iso_file_set *files, iso_pool *pool, iso_error *error);

/* Gives lines or glyphs the radii and colours that the settings say. ISO_ERR_USAGE: no such column. */
iso_status isorender_object_style(isorender_object *object, iso_error *error);

/* Of lines in the picture: their least width, and by how much dropped vertices may move outlines. */
typedef struct isorender_line_pixels {
    double least, drop;
} isorender_line_pixels;

/* The lines as they are drawn, with the object's arrays; sets *opts. Ribbons have normals after
 * isorender_object_prepare. */
iso_lines isorender_object_lines(const isorender_object *object, const isorender_line_pixels *pixels,
                                 iso_shapes_opts *opts);

/* Prepares what was read for drawing, and finds its bounds. by_pullpush: lines are drawn by pull-push.
 * ISO_ERR_NOMEM. */
iso_status isorender_object_prepare(isorender_object *object, const isorender_line_pixels *pixels,
                                    bool by_pullpush, iso_error *error);

void isorender_object_free(isorender_object *object);

/* Returns the box of what is drawn, in coordinates along three world vectors, as iso_fit.bounds asks for it.
 */
iso_box isorender_object_bounds_along(const isorender_object *object, const iso_vec3 vectors[3]);

/* Adds an object to the report of --json: file, format, counts, box. */
void isorender_object_put(iso_json *json, const isorender_object *object);
/* Prints the same for --info, with the names and ranges of the columns. */
void isorender_object_info(const isorender_object *object);
/* Prints only the names and ranges of the columns. */
void isorender_object_info_columns(const isorender_object *object);

/* ---- object_gradients.c */

/* Whether the glyphs are those of --glyphs surface, which are made of the isosurfaces, not read. */
bool isorender_object_is_surface(const isorender_object_settings *settings);
/* Whether the glyphs of gradients will be coloured by a column. */
bool isorender_gradients_have_bar(const isorender_object_settings *settings);
/* Adds members about the gradients to the report of --json. */
void isorender_gradients_put(iso_json *json, const isorender_object *object);

/* ---- object_fields.c */

/* Returns the radius of streamlines for which none is given, mm. */
double isorender_field_radius(const isorender_object *object);
/* Adds members about the volume to the report of --json. */
void isorender_field_put(iso_json *json, const isorender_object *object);
/* Prints the lines of --info about the volume. */
void isorender_field_info(const isorender_object *object);

/* ---- object_branches.c */

/* Takes what a mesh in place of lines has become: tubes if there are any, else ribbons. */
void isorender_object_take_branches(isorender_object *object);

/* ---- object_colors.c */

/* Returns the attribute with a name, or NULL. */
const iso_attribute *isorender_attribute_find(const iso_attribute *attributes, int count, const char *name);

/* Computes the range of `count` numbers, or of the lengths of vectors if the attribute has several
 * components. Returns false if none is finite. */
bool isorender_attribute_range(const iso_attribute *attribute, size_t count, double range[2]);

/* Colours the elements as the settings say, in place of the colours of the file. */
iso_status isorender_object_color(isorender_object *object, iso_error *error);

#endif
