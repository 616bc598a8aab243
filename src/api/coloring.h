/* coloring: iso_color_by of isopoint.h and the paint of sculpts, as colorings of a scene. Internal to
 * src/api. */
#ifndef ISO_API_COLORING_H
#define ISO_API_COLORING_H

#include "api/internal.h"
#include "scene/coloring.h"
#include "scene/method.h"
#include "scene/painted.h"

/* The colorings of a picture. Zero-initialise; iso_api_colorings_end when done. */
typedef struct iso_api_colorings {
    iso_surface *const *surfaces; /* borrowed, as is all that is passed */
    const iso_color_by *given;
    int count;
    iso_coloring *made; /* NULL: none */
    iso_distance **distances;
    int surface_count;
    iso_painted *painted; /* by surface */
    iso_coloring *paint;
} iso_api_colorings;

/* ISO_ERR_USAGE: something that cannot be. */
iso_status iso_api_colorings_check(iso_surface *const *surfaces, int surface_count,
                                   const iso_render_opts *opts, const iso_renderer *renderer,
                                   iso_error *error);

/* The surfaces of a picture, how they are drawn, and their own colours. */
typedef struct iso_api_colored {
    iso_surface *const *surfaces;
    int count;
    const iso_renderer *renderer;
    bool translucent; /* one of them is */
    const iso_rgb *colors;
} iso_api_colored;

/* Sets the colorings of the surfaces, until iso_api_colorings_end; those of sculpts that have none are drawn
 * in their paint, if the method can do so. ISO_ERR_EMPTY: no surface to measure from; ISO_ERR_NOMEM. */
iso_status iso_api_colorings_begin(const iso_api_colored *what, const iso_render_opts *opts,
                                   const iso_view *view, iso_api_colorings *colorings, iso_error *error);
void iso_api_colorings_end(iso_api_colorings *colorings);

#endif
