/* colormap: linear interpolation between the colours of a table. */
#include "image/colormap.h"

#include <math.h>
#include <stdint.h>

enum { STEPS = 64 };

static const uint32_t tables[ISO_COLORMAP_GRAY][STEPS + 1] = {
#include "image/colormap_tables.inc"
};

const char *iso_colormap_name(iso_colormap map) {
#define COLORMAP_TEXT(name, text) text,
    static const char *const names[] = {ISO_COLORMAPS(COLORMAP_TEXT)};
#undef COLORMAP_TEXT
    return names[map];
}

static uint8_t mix(uint32_t low, uint32_t high, int shift, double part) {
    const double a = low >> shift & 255, b = high >> shift & 255;
    return (uint8_t)(a + (b - a) * part + 0.5);
}

iso_rgb iso_colormap_at(iso_colormap map, double at) {
    if (isnan(at)) return (iso_rgb){128, 128, 128};
    const double clamped = at < 0 ? 0 : at > 1 ? 1 : at;
    const uint8_t gray = (uint8_t)(clamped * 255 + 0.5);
    if (map == ISO_COLORMAP_GRAY) return (iso_rgb){gray, gray, gray};
    const int step = clamped < 1 ? (int)(clamped * STEPS) : STEPS - 1;
    const uint32_t low = tables[map][step], high = tables[map][step + 1];
    const double part = clamped * STEPS - step;
    return (iso_rgb){mix(low, high, 16, part), mix(low, high, 8, part), mix(low, high, 0, part)};
}
