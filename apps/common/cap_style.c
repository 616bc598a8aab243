/* cap_style: the words of --cap. */
#include "apps/common/cap_style.h"

#include <string.h>

#include "apps/common/options.h"

iso_status iso_cap_style_parse(const char *text, iso_cap_style *style, iso_error *error) {
    uint8_t rgb[3];
    style->kind = ISO_CAP_NONE;
    style->is_gray = false;
    if (strcmp(text, "none") == 0) return ISO_OK;
    style->kind = ISO_CAP_SURFACE;
    if (strcmp(text, "surface") == 0) return ISO_OK;
    style->kind = ISO_CAP_SLICE;
    if (strcmp(text, "slice") == 0) return ISO_OK;
    if (strncmp(text, "slice:", 6) == 0) return iso_colormap_find(text + 6, &style->map, error);
    style->kind = ISO_CAP_COLOR;
    if (!iso_parse_color(text, rgb))
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is not slice, slice:COLORMAP (%s), surface, none or a colour", text,
                        iso_colormap_names);
    style->is_gray = strcmp(text, "gray") == 0 || strcmp(text, "grey") == 0;
    style->color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return ISO_OK;
}
