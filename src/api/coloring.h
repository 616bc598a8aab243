/* coloring: iso_color_by of isopoint.h, as colorings of a scene. Internal to src/api. */
#ifndef ISO_API_COLORING_H
#define ISO_API_COLORING_H

#include "api/internal.h"
#include "scene/coloring.h"
#include "scene/method.h"

/* The colorings of a picture. Zero-initialise; iso_api_colorings_end when done. */
typedef struct iso_api_colorings {
    iso_surface *const *surfaces; /* borrowed, as is all that is passed */
    const iso_color_by *given;
    int count;
    iso_coloring *made; /* NULL: none */
    iso_distance **distances;
} iso_api_colorings;

/* ISO_ERR_USAGE: something that cannot be. translucent: a surface is. */
iso_status iso_api_colorings_check(iso_surface *const *surfaces, int surface_count,
                                   const iso_render_opts *opts, const iso_renderer *renderer,
                                   bool translucent, iso_error *error);

/* Sets the colorings of the surfaces, until iso_api_colorings_end. ISO_ERR_EMPTY: no surface to measure from;
 * ISO_ERR_NOMEM. */
iso_status iso_api_colorings_begin(iso_surface *const *surfaces, const iso_render_opts *opts,
                                   const iso_view *view, iso_api_colorings *colorings, iso_error *error);
void iso_api_colorings_end(iso_api_colorings *colorings);

#endif
