/* cap_style: what --cap says: how the cuts of solids are closed in pictures (scene/caps.h). */
#ifndef ISO_APPS_COMMON_CAP_STYLE_H
#define ISO_APPS_COMMON_CAP_STYLE_H

#include "base/c_linkage.h"
#include "base/status.h"
#include "scene/caps.h"

ISO_C_BEGIN

typedef enum iso_cap_kind {
    ISO_CAP_NONE,
    ISO_CAP_SURFACE, /* in the colour of the surface */
    ISO_CAP_COLOR,
    ISO_CAP_SLICE /* it shows the volume */
} iso_cap_kind;

typedef struct iso_cap_style {
    iso_cap_kind kind;
    iso_rgb color;    /* of COLOR */
    bool is_gray;     /* by the name that a colormap has, too */
    iso_colormap map; /* of SLICE */
} iso_cap_style;

/* Parses none, surface, a colour, slice or slice:COLORMAP; slice alone leaves the colormap as it is.
 * ISO_ERR_USAGE. */
iso_status iso_cap_style_parse(const char *text, iso_cap_style *style, iso_error *error);

ISO_C_END
#endif
