/* color_by: what the surfaces of a viewed volume are coloured by, as isorender colours them for
 * --surface-color-by, --colormap and --range. Knows nothing of windows. One thread at a time. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_COLOR_BY_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_COLOR_BY_H

#include "apps/isosculpt/viewport/viewport.h"
#include "base/c_linkage.h"
#include "scene/coloring.h"

ISO_C_BEGIN

enum { ISOSCULPT_COLOR_TEXT = 1400 };

typedef struct isosculpt_color_by {
    char
        what[ISOSCULPT_COLOR_TEXT]; /* as of --surface-color-by; "": the surfaces have colours of their own */
    char map[ISOSCULPT_COLOR_TEXT]; /* as of --colormap; "": the usual one */
    double range[2];                /* as of --range; NAN: found on the first surface */
    iso_coloring coloring;          /* with the range of the last picture at rest */
    iso_color_table table;          /* of a map that is a file */
    struct isosculpt_color_file *file; /* owned; NULL: it is none */
    double ranged_isovalue;            /* the surface that the range was found on; NAN: not found yet */
} isosculpt_color_by;

/* What the surfaces are coloured by; never NULL. */
const isosculpt_color_by *isosculpt_viewport_color_by(const isosculpt_viewport *viewport);

/* Sets what they are coloured by: "" (nothing), curvature, depth, normal, VOLUME[:ARRAY] or
 * distance:FILE[:ISOVALUE], which is read; the map: a name, the path of a file, or "" (the usual one); the
 * range: NAN: it is found. The next picture shows it. ISO_ERR_USAGE: not understood; ISO_ERR_NOMEM, and the
 * errors of reading a volume, a mesh or colours: what was set before stays. */
iso_status isosculpt_color_by_set(isosculpt_viewport *viewport, const char *what, iso_error *error);
iso_status isosculpt_color_by_set_map(isosculpt_viewport *viewport, const char *map, iso_error *error);
iso_status isosculpt_color_by_set_range(isosculpt_viewport *viewport, const double range[2],
                                        iso_error *error);

/* Finds the range, unless it is given or known; while the camera moves (`moving`) that of the last picture
 * stays. The surface is extracted. Errors of iso_coloring_find_surface_range. */
iso_status isosculpt_color_by_find_range(isosculpt_viewport *viewport, bool moving, iso_error *error);

/* Frees and forgets all that is set. */
void isosculpt_color_by_free(isosculpt_viewport *viewport);

ISO_C_END
#endif
