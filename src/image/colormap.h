/* colormap: maps numbers to colours. */
#ifndef ISO_IMAGE_COLORMAP_H
#define ISO_IMAGE_COLORMAP_H

#include "isopoint.h"

#define ISO_COLORMAPS(X)                                                                                     \
    X(VIRIDIS, "viridis")                                                                                    \
    X(INFERNO, "inferno")                                                                                    \
    X(TURBO, "turbo")                                                                                        \
    X(COOLWARM, "coolwarm")                                                                                  \
    X(GRAY, "gray")
typedef enum iso_colormap {
#define ISO_COLORMAP_ENUM(name, text) ISO_COLORMAP_##name,
    ISO_COLORMAPS(ISO_COLORMAP_ENUM)
#undef ISO_COLORMAP_ENUM
        ISO_COLORMAP_COUNT
} iso_colormap;

const char *iso_colormap_name(iso_colormap map);

/* Returns the colour of `at`, 0 (lowest) .. 1 (highest). Values outside are clamped; NaN is middle gray. */
iso_rgb iso_colormap_at(iso_colormap map, double at);

#endif
