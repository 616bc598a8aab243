/* style: how a viewport's picture looks, set by options of isorender: of a scene that is opened, or of a look
 * (apps/common/looks.h). */
#ifndef ISO_APPS_ISOSCULPT_STYLE_H
#define ISO_APPS_ISOSCULPT_STYLE_H

#include "apps/isosculpt/viewport/viewport.h"
#include "base/c_linkage.h"

ISO_C_BEGIN

/* Whether the option is one that isosculpt_style_set takes. */
bool isosculpt_style_has(const char *option);

/* Sets what the option says: isovalue (only a second one), color, opacity, background, clip (adds a cut;
 * the camera is set before), cap, window, occlusion, shadow, outline, surface-color-by, colormap, range
 * or look. value: NULL: none. ISO_ERR_USAGE, ISO_ERR_LIMIT. */
iso_status isosculpt_style_set(isosculpt_viewport *viewport, const char *option, const char *value,
                               iso_error *error);

ISO_C_END
#endif
